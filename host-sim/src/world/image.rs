//! Grey images as numbers: from a PGM or PNG file to one sample per pixel, top row first.
//!
//! A sample is the sum of the pixel's colour channels, so averaging loses nothing.
//! `sample / full` is the shade, from 0 (black) to 1 (white).

use std::fs;
use std::path::Path;
use thiserror::Error;

use super::{pgm, png_file};

/// Most pixels of an image: a map of 200 × 200 m at 2.5 cm.
pub const MAX_PIXELS: usize = 64_000_000;

/// A decoded image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Sum of the colour channels of each pixel, row by row from the top.
    pub samples: Vec<u32>,
    /// Sample of a white pixel.
    pub full: u32,
    /// Number of colour channels in the sum: 1 for grey, 3 for colour.
    pub channels: u32,
    /// True for each pixel that is not fully opaque; empty if the image has no alpha.
    pub transparent: Vec<bool>,
}

/// Why an image cannot be read.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum ImageError {
    /// Missing or unreadable.
    #[error("{0}; paths are relative to the world file")]
    Unreadable(String),
    /// Neither PGM nor PNG.
    #[error("neither PGM (P2, P5) nor PNG; convert it to one of them")]
    UnknownFormat,
    /// Fewer pixels than the header promises.
    #[error("truncated, {found} of {expected} pixels; copy the whole file")]
    Truncated {
        /// Pixels the header promises.
        expected: usize,
        /// Pixels there are.
        found: usize,
    },
    /// The header claims samples of 16 bits, but there are only as many bytes as pixels.
    #[error(
        "its header claims samples of 16 bits (a greatest value above 255), but it holds one byte \
         a pixel; set the greatest value to 255, or save it with 16 bits"
    )]
    OneByteSamples,
    /// The file ends before its pixels, or before its trailer.
    #[error("truncated; copy the whole file")]
    EndsEarly,
    /// More pixels than the header promises.
    #[error("more data than the {expected} pixels of its header; correct the width and height")]
    Surplus {
        /// Pixels the header promises.
        expected: usize,
    },
    /// A header or content that makes no sense.
    #[error("damaged, {0}; save the image anew")]
    Malformed(String),
    /// No pixels at all, or more than [`MAX_PIXELS`].
    #[error("{width} x {height} pixels; save it with 1 to {MAX_PIXELS} pixels")]
    Size {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
    },
}

impl Image {
    /// Reads a PGM or PNG file; its first bytes tell the format.
    ///
    /// # Errors
    /// As [`ImageError`].
    pub fn load(path: &Path) -> Result<Self, ImageError> {
        let bytes = fs::read(path).map_err(|e| ImageError::Unreadable(e.to_string()))?;
        Self::decode(&bytes)
    }

    /// Decodes a PGM or PNG image.
    ///
    /// # Errors
    /// As [`ImageError`].
    pub fn decode(bytes: &[u8]) -> Result<Self, ImageError> {
        if bytes.starts_with(b"P2") || bytes.starts_with(b"P5") {
            pgm::decode(bytes)
        } else if bytes.starts_with(b"\x89PNG") {
            png_file::decode(bytes)
        } else {
            Err(ImageError::UnknownFormat)
        }
    }

    /// Checks that the size is supported, and returns the number of pixels.
    ///
    /// # Errors
    /// [`ImageError::Size`].
    pub(super) fn check_size(width: usize, height: usize) -> Result<usize, ImageError> {
        width
            .checked_mul(height)
            .filter(|pixels| (1..=MAX_PIXELS).contains(pixels))
            .ok_or(ImageError::Size { width, height })
    }

    /// Returns true if this pixel (counted from the top left) is not fully opaque.
    #[must_use]
    pub fn is_transparent(&self, index: usize) -> bool {
        self.transparent.get(index).copied().unwrap_or(false)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::{Rng, SeedableRng};

    fn png() -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 5, 4);
        encoder.set_color(png::ColorType::Rgba);
        let mut writer = encoder.write_header().expect("header");
        writer.write_image_data(&[77; 80]).expect("data");
        drop(writer);
        bytes
    }

    #[test]
    fn a_damaged_image_is_refused_or_read() {
        let mut rng = ChaCha8Rng::seed_from_u64(12);
        let whole: [&[u8]; 3] = [
            b"P5 5 4 255\n01234567890123456789",
            b"P2 2 2 9\n# grey\n1 2 3 4\n",
            &png(),
        ];
        let (mut read, mut refused) = (0, 0);
        for round in 0..30_000 {
            let mut bytes = whole[round % 3].to_vec();
            for _ in 0..1 + rng.next_u32() % 3 {
                let at = rng.next_u32() as usize % bytes.len();
                match rng.next_u32() % 3 {
                    0 => bytes[at] = rng.next_u32() as u8,
                    1 => bytes.truncate(at.max(1)),
                    _ => bytes.insert(at, rng.next_u32() as u8),
                }
            }
            match Image::decode(&bytes) {
                Ok(image) => {
                    assert_eq!(image.samples.len(), image.width * image.height);
                    assert!(image.samples.iter().all(|sample| *sample <= image.full));
                    read += 1;
                }
                Err(error) => {
                    assert!(!error.to_string().contains('\n'), "{error}");
                    refused += 1;
                }
            }
        }
        assert!(read > 1000 && refused > 10_000, "{read} {refused}");
    }
}

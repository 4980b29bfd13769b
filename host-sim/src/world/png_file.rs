//! PNG files of any colour type and depth, as sums of their colour channels.
//!
//! `map_server` averages the channels of a pixel, and so does [`Image`], which has their sum and
//! number. Departs from `map_server`, which also averages the alpha channel in and so turns an
//! opaque unknown grey (205) into free space. Here alpha says only if the map knows the pixel.

use png::{BitDepth, ColorType, Decoder, DecodingError, Transformations};
use std::io::Cursor;

use super::image::{Image, ImageError};

/// Decodes a whole file.
pub(super) fn decode(bytes: &[u8]) -> Result<Image, ImageError> {
    let mut decoder = Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(|e| explain(&e))?;
    let (width, height) = (reader.info().width as usize, reader.info().height as usize);
    let pixels = Image::check_size(width, height)?;
    let size = reader
        .output_buffer_size()
        .ok_or(ImageError::Size { width, height })?;
    let mut data = vec![0; size];
    let frame = reader.next_frame(&mut data).map_err(|e| explain(&e))?;
    // The trailer is read too: a file that ends after its last row is still truncated.
    reader.finish().map_err(|e| explain(&e))?;
    let (channels, alpha) = match frame.color_type {
        ColorType::Grayscale => (1, false),
        ColorType::GrayscaleAlpha => (1, true),
        ColorType::Rgb => (3, false),
        ColorType::Rgba => (3, true),
        ColorType::Indexed => {
            return Err(ImageError::Malformed("a palette that is not one".into()));
        }
    };
    let wide = frame.bit_depth == BitDepth::Sixteen;
    let white = if wide { 65_535 } else { 255 };
    let bytes_each = if wide { 2 } else { 1 };
    let pixel_bytes = bytes_each * (channels + usize::from(alpha));
    let mut image = Image {
        width,
        height,
        samples: Vec::with_capacity(pixels),
        full: white * channels as u32,
        channels: channels as u32,
        transparent: Vec::new(),
    };
    for pixel in data.chunks_exact(pixel_bytes).take(pixels) {
        let (colour, opacity) = pixel.split_at(channels * bytes_each);
        image
            .samples
            .push(colour.chunks_exact(bytes_each).map(channel).sum());
        if alpha {
            image.transparent.push(channel(opacity) < white);
        }
    }
    Ok(image)
}

/// The value of a channel's bytes, high byte first.
fn channel(bytes: &[u8]) -> u32 {
    bytes.iter().fold(0, |v, byte| v << 8 | u32::from(*byte))
}

/// Converts the decoder's error; a file that ends early has an error of its own.
fn explain(error: &DecodingError) -> ImageError {
    match error {
        DecodingError::IoError(e) if e.kind() == std::io::ErrorKind::UnexpectedEof => {
            ImageError::EndsEarly
        }
        other => ImageError::Malformed(other.to_string().replace('\n', " ")),
    }
}

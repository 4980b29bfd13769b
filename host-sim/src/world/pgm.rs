//! Portable grey maps, plain (P2) and raw (P5), of 8 or 16 bits.
//!
//! `P5 <width> <height> <maxval><one white space><samples>`; `#` starts a comment up to the end of
//! the line. Raw samples have one byte if maxval < 256, else two, high byte first.

use super::image::{Image, ImageError};

/// Decodes a whole file.
pub(super) fn decode(bytes: &[u8]) -> Result<Image, ImageError> {
    let plain = bytes.get(1) == Some(&b'2');
    let mut reader = Reader { bytes, at: 2 };
    let width = reader.number("width")?;
    let height = reader.number("height")?;
    let full = reader.number("greatest value")?;
    if !(1..=65_535).contains(&full) {
        return Err(ImageError::Malformed(format!(
            "its greatest value is {full}, not 1 to 65535"
        )));
    }
    let pixels = Image::check_size(width, height)?;
    let samples = if plain {
        reader.plain(pixels)?
    } else {
        reader.raw(pixels, full > 255)?
    };
    if let Some(sample) = samples.iter().find(|sample| **sample > full as u32) {
        return Err(ImageError::Malformed(format!(
            "a sample of {sample} is above its greatest value of {full}"
        )));
    }
    Ok(Image {
        width,
        height,
        samples,
        full: full as u32,
        channels: 1,
        transparent: Vec::new(),
    })
}

/// The bytes, and the position of the reader in them.
struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Reader<'_> {
    fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }

    fn skip_blanks(&mut self) {
        while let Some(byte) = self.peek() {
            if byte == b'#' {
                while self.peek().is_some_and(|b| b != b'\n') {
                    self.at += 1;
                }
            } else if !byte.is_ascii_whitespace() {
                return;
            } else {
                self.at += 1;
            }
        }
    }

    /// Reads a decimal number; `None` if something else or nothing follows.
    fn digits(&mut self) -> Option<usize> {
        self.skip_blanks();
        let start = self.at;
        let mut value = 0_usize;
        while let Some(digit) = self.peek().filter(u8::is_ascii_digit) {
            value = value
                .saturating_mul(10)
                .saturating_add(usize::from(digit - b'0'));
            self.at += 1;
        }
        (self.at > start).then_some(value)
    }

    fn number(&mut self, what: &str) -> Result<usize, ImageError> {
        self.digits()
            .ok_or_else(|| ImageError::Malformed(format!("no {what} in its header")))
    }

    fn plain(&mut self, pixels: usize) -> Result<Vec<u32>, ImageError> {
        let mut samples = Vec::with_capacity(pixels.min(self.bytes.len()));
        while samples.len() < pixels {
            match self.digits() {
                Some(value) => samples.push(u32::try_from(value).unwrap_or(u32::MAX)),
                None if self.peek().is_none() => {
                    return Err(ImageError::Truncated {
                        expected: pixels,
                        found: samples.len(),
                    });
                }
                None => {
                    return Err(ImageError::Malformed(format!(
                        "pixel {} is not a number",
                        samples.len()
                    )));
                }
            }
        }
        self.skip_blanks();
        self.check_end(pixels)?;
        Ok(samples)
    }

    fn raw(&mut self, pixels: usize, wide: bool) -> Result<Vec<u32>, ImageError> {
        self.at += 1;
        let size = if wide { 2 } else { 1 };
        let data = self.bytes.get(self.at..).unwrap_or_default();
        let trailing = data.iter().rev().take_while(|b| b.is_ascii_whitespace());
        if wide && (pixels..=pixels + trailing.count()).contains(&data.len()) {
            return Err(ImageError::OneByteSamples);
        }
        let Some(data) = data.get(..pixels * size) else {
            return Err(ImageError::Truncated {
                expected: pixels,
                found: data.len() / size,
            });
        };
        self.at += data.len();
        while self.peek().is_some_and(|byte| byte.is_ascii_whitespace()) {
            self.at += 1;
        }
        self.check_end(pixels)?;
        Ok(data
            .chunks_exact(size)
            .map(|bytes| {
                bytes
                    .iter()
                    .fold(0, |value, byte| value << 8 | u32::from(*byte))
            })
            .collect())
    }

    fn check_end(&self, expected: usize) -> Result<(), ImageError> {
        if self.at < self.bytes.len() {
            return Err(ImageError::Surplus { expected });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(bytes: &[u8]) -> Result<Vec<u32>, ImageError> {
        decode(bytes).map(|image| image.samples)
    }

    #[test]
    fn it_reads_plain_and_raw_of_both_widths_with_comments() {
        assert_eq!(
            samples(b"P2 # x\n3 1 # y\n9\n0 # z\n4\n9\n"),
            Ok(vec![0, 4, 9])
        );
        assert_eq!(samples(b"P5\n2 1\n255\n\x00\xfe"), Ok(vec![0, 254]));
        assert_eq!(
            samples(b"P5\n2 1\n65535\n\x01\x02\xff\xff"),
            Ok(vec![258, 65535])
        );
        // The first sample may look like white space or a comment.
        assert_eq!(samples(b"P5 2 1 255 \n#"), Ok(vec![10, 35]));
    }

    #[test]
    fn one_byte_samples_under_a_header_of_two_bytes_are_named() {
        for bytes in [
            &b"P5 3 1 65535\n\x01\x02\x03"[..],
            b"P5 3 1 1000\n\x01\x02\x03\n",
        ] {
            assert_eq!(samples(bytes), Err(ImageError::OneByteSamples));
        }
    }

    #[test]
    fn every_error_is_named() {
        use ImageError::{Malformed, Size, Surplus, Truncated};
        assert_eq!(
            samples(b"P5 2 2 255\n\x01\x02\x03"),
            Err(Truncated {
                expected: 4,
                found: 3
            })
        );
        assert_eq!(
            samples(b"P5 2 1 65535\n\x01\x02\x03"),
            Err(Truncated {
                expected: 2,
                found: 1
            })
        );
        assert_eq!(
            samples(b"P2 2 2 255\n1 2"),
            Err(Truncated {
                expected: 4,
                found: 2
            })
        );
        assert_eq!(
            samples(b"P5 1 1 255\n\x01\x02"),
            Err(Surplus { expected: 1 })
        );
        assert_eq!(
            samples(b"P5 0 4 255\n"),
            Err(Size {
                width: 0,
                height: 4
            })
        );
        let huge = samples(b"P5 99999999999 99999999999999999999999 255\n");
        assert!(matches!(huge, Err(Size { .. })), "{huge:?}");
        for bad in [
            &b"P5 x"[..],
            b"P5",
            b"P2 2 1 255 1 x",
            b"P5 1 1 0\n\x00",
            b"P5 1 1 70000\n\x00\x00",
            b"P2 1 1 7 8",
        ] {
            assert!(matches!(samples(bad), Err(Malformed(_))), "{bad:?}");
        }
    }
}

//! Consistent overhead byte stuffing: it encodes bytes without zeros, so that a zero can end a
//! frame.
//!
//! A run of n − 1 non-zero bytes and the zero after it become the code n and the run. A run of 254
//! bytes without a zero has code 255. The end of the frame stands for a last zero. The cost is one
//! byte, and one more for every 254 bytes after the first 254.
//!
//! Both directions are total functions: no input makes them panic. The linker proves this for the
//! receive path of the image (`firmware/stm32f405/examples/panic_free.rs`).
//!
//! S. Cheshire and M. Baker, "Consistent Overhead Byte Stuffing", IEEE/ACM Transactions on
//! Networking 7(2), 1999.

/// The output has no room for another byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Full;

/// Encoder that takes one byte at a time.
///
/// Invariant: `out[code_at]` is reserved for the code of the open run. The bytes of that run fill
/// `out[code_at + 1..at]`.
#[derive(Debug)]
pub(crate) struct Stuffer<'a> {
    out: &'a mut [u8],
    code_at: usize,
    at: usize,
}

impl<'a> Stuffer<'a> {
    /// Starts a frame at the beginning of `out`.
    #[must_use]
    pub(crate) fn new(out: &'a mut [u8]) -> Self {
        Self {
            out,
            code_at: 0,
            at: 1,
        }
    }

    /// Adds a byte.
    ///
    /// # Errors
    /// [`Full`] if `out` ends.
    pub(crate) fn push(&mut self, byte: u8) -> Result<(), Full> {
        if self.at - self.code_at == 255 {
            self.close()?;
        }
        if byte == 0 {
            return self.close();
        }
        *self.out.get_mut(self.at).ok_or(Full)? = byte;
        self.at += 1;
        Ok(())
    }

    /// Ends the frame with its delimiter and returns its length.
    ///
    /// # Errors
    /// [`Full`] if `out` ends.
    pub(crate) fn finish(mut self) -> Result<usize, Full> {
        self.close()?;
        *self.out.get_mut(self.code_at).ok_or(Full)? = 0;
        Ok(self.at)
    }

    fn close(&mut self) -> Result<(), Full> {
        let code = (self.at - self.code_at) as u8;
        *self.out.get_mut(self.code_at).ok_or(Full)? = code;
        self.code_at = self.at;
        self.at += 1;
        Ok(())
    }
}

/// Decodes `buffer`, which holds a frame without its delimiter, in place.
///
/// Returns the length of the result, or `None` if `buffer` is not a stuffed frame.
#[must_use]
pub(crate) fn unstuff(buffer: &mut [u8]) -> Option<usize> {
    let (mut from, mut to) = (0, 0);
    while let Some(&code) = buffer.get(from) {
        let end = from + usize::from(code);
        if code == 0 || end > buffer.len() {
            return None;
        }
        from += 1;
        while from < end {
            // There is no zero inside: receivers split at zeros. If there were one, the checksum
            // would find it.
            *buffer.get_mut(to)? = *buffer.get(from)?;
            (from, to) = (from + 1, to + 1);
        }
        if code != 255 && from < buffer.len() {
            *buffer.get_mut(to)? = 0;
            to += 1;
        }
    }
    Some(to)
}

#[cfg(test)]
mod tests {
    use std::vec;
    use std::vec::Vec;

    use proptest::prelude::*;

    use super::{Full, Stuffer, unstuff};

    fn stuffed(data: &[u8]) -> Vec<u8> {
        let mut out = vec![0xaa; data.len() + data.len() / 254 + 3];
        let mut stuffer = Stuffer::new(&mut out);
        data.iter().for_each(|byte| stuffer.push(*byte).unwrap());
        let length = stuffer.finish().unwrap();
        out.truncate(length);
        out
    }

    fn unstuffed(frame: &[u8]) -> Option<Vec<u8>> {
        let mut buffer = frame.to_vec();
        let length = unstuff(&mut buffer)?;
        buffer.truncate(length);
        Some(buffer)
    }

    fn run(from: u8, to: u8) -> Vec<u8> {
        (from..=to).collect()
    }

    #[test]
    fn examples_of_the_paper() {
        for (data, frame) in [
            (vec![], vec![1, 0]),
            (vec![0], vec![1, 1, 0]),
            (vec![0, 0], vec![1, 1, 1, 0]),
            (vec![0x11, 0x22, 0, 0x33], vec![3, 0x11, 0x22, 2, 0x33, 0]),
            (vec![0x11, 0, 0, 0], vec![2, 0x11, 1, 1, 1, 0]),
            (run(1, 254), [vec![255], run(1, 254), vec![0]].concat()),
            (
                run(1, 255),
                [vec![255], run(1, 254), vec![2, 255, 0]].concat(),
            ),
            (
                run(0, 255),
                [vec![1, 255], run(1, 254), vec![2, 255, 0]].concat(),
            ),
            (
                [run(1, 254), vec![0]].concat(),
                [vec![255], run(1, 254), vec![1, 1, 0]].concat(),
            ),
        ] {
            assert_eq!(stuffed(&data), frame);
            assert_eq!(unstuffed(&frame[..frame.len() - 1]), Some(data));
        }
    }

    #[test]
    fn invalid_stuffing_is_none() {
        assert_eq!(unstuffed(&[2]), None);
        assert_eq!(unstuffed(&[0]), None);
        assert_eq!(unstuffed(&[1, 3, 7]), None);
        assert_eq!(unstuffed(&[255, 1, 2]), None);
    }

    #[test]
    fn full_output_is_an_error() {
        for room in 0..6 {
            let mut out = vec![0; room];
            let mut stuffer = Stuffer::new(&mut out);
            let pushed: Result<(), Full> =
                [1, 2, 0, 3].iter().try_for_each(|byte| stuffer.push(*byte));
            let finished = pushed.and_then(|()| stuffer.finish());
            assert_eq!(finished, Err(Full), "room {room}");
        }
    }

    proptest! {
        #[test]
        fn agrees_with_another_codec(data in prop::collection::vec(
            prop_oneof![Just(0u8), Just(1), any::<u8>()], 0..1200)
        ) {
            let ours = stuffed(&data);
            let body = &ours[..ours.len() - 1];
            prop_assert!(!body.contains(&0));
            prop_assert!(ours.len() <= data.len() + 2 + data.len().saturating_sub(1) / 254);
            prop_assert_eq!(cobs::decode_vec(body).ok(), Some(data.clone()));
            prop_assert_eq!(unstuffed(&cobs::encode_vec(&data)), Some(data.clone()));
            prop_assert_eq!(unstuffed(body), Some(data));
        }

        #[test]
        fn no_bytes_make_it_panic(data in prop::collection::vec(any::<u8>(), 0..600)) {
            let mut buffer = data.clone();
            if let Some(length) = unstuff(&mut buffer) {
                prop_assert!(length < data.len().max(1));
            }
        }
    }
}

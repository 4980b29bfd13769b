//! A cache of lines of the flash: fully associative, the least recently used line goes first.
//!
//! Invariant: `slot_of[line]` is the slot whose `line_in` is `line`, or [`NOWHERE`].

use crate::flash::FLASH_LINES;

const NOWHERE: u8 = u8::MAX;

/// `N` lines, fewer than 255.
#[derive(Debug)]
pub(crate) struct Lines<const N: usize> {
    slot_of: Vec<u8>,
    line_in: [Option<u32>; N],
    used_at: [u64; N],
    /// Number of uses so far.
    uses: u64,
}

impl<const N: usize> Lines<N> {
    /// Makes an empty cache.
    pub(crate) fn new() -> Self {
        const { assert!(N > 0 && N < NOWHERE as usize) };
        Self {
            slot_of: vec![NOWHERE; FLASH_LINES],
            line_in: [None; N],
            used_at: [0; N],
            uses: 0,
        }
    }

    fn slot(&self, line: u32) -> Option<usize> {
        let slot = self.slot_of.get(line as usize).copied()?;
        (slot != NOWHERE).then_some(usize::from(slot))
    }

    /// Returns true if the line is there.
    pub(crate) fn has(&self, line: u32) -> bool {
        self.slot(line).is_some()
    }

    /// Uses a line. Returns true if it is there.
    pub(crate) fn hit(&mut self, line: u32) -> bool {
        let Some(slot) = self.slot(line) else {
            return false;
        };
        self.uses += 1;
        self.used_at[slot] = self.uses;
        true
    }

    /// Enters a line that is not there, in place of the one that was not used for longest.
    pub(crate) fn enter(&mut self, line: u32) {
        let Some(place) = self.slot_of.get_mut(line as usize) else {
            return;
        };
        let oldest = (0..N).min_by_key(|&slot| self.used_at[slot]).unwrap_or(0);
        *place = oldest as u8;
        if let Some(gone) = self.line_in[oldest].replace(line) {
            self.slot_of[gone as usize] = NOWHERE;
        }
        self.uses += 1;
        self.used_at[oldest] = self.uses;
    }
}

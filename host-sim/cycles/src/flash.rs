//! The flash of an STM32F405 at 168 MHz behind its ART accelerator (RM0090, 3.5): lines of 16
//! bytes, five wait states, prefetch of the next line, 64 lines of instructions, 8 lines of data.
//!
//! The array reads one line at a time and takes `1 + WAIT_STATES` cycles for it. The core gets a
//! line in the cycle in which it comes. A line that came by prefetch enters the cache when the core
//! uses it; RM0090 leaves that open, and `docs/CYCLES.md` has the measurement that decided. A
//! prefetch under way is not given up. Unit of time: cycles, from any origin, never falling.

use crate::lines::Lines;

/// Cycles by which a read of the array is longer than one cycle.
pub const WAIT_STATES: u64 = 5;
/// Bytes of a line.
pub const LINE_BYTES: u32 = 16;
/// Address of the first byte.
pub const FLASH_START: u32 = 0x0800_0000;
/// Size of the flash, bytes.
pub const FLASH_BYTES: u32 = 1 << 20;
/// Number of its lines.
pub const FLASH_LINES: usize = (FLASH_BYTES / LINE_BYTES) as usize;
/// Lines of instructions in the accelerator.
pub const CODE_LINES: usize = 64;
/// Lines of data in the accelerator.
pub const DATA_LINES: usize = 8;
/// Cycles by which a core that runs straight asks for a line before it needs it.
pub const AHEAD: u64 = 2;

/// Returns the line that has `address`; `None` outside of the flash.
#[must_use]
pub const fn line_of(address: u32) -> Option<u32> {
    let offset = address.wrapping_sub(FLASH_START);
    if offset < FLASH_BYTES {
        Some(offset / LINE_BYTES)
    } else {
        None
    }
}

/// The flash and its accelerator.
#[derive(Debug)]
pub struct Flash {
    code: Lines<CODE_LINES>,
    data: Lines<DATA_LINES>,
    /// The line from which the core fetches.
    current: Option<u32>,
    /// The line that was prefetched last, or is being prefetched.
    next: Option<u32>,
    /// When the core can use that line.
    next_comes: u64,
    /// When the array has read what was asked so far.
    free: u64,
}

impl Default for Flash {
    fn default() -> Self {
        Self {
            code: Lines::new(),
            data: Lines::new(),
            current: None,
            next: None,
            next_comes: 0,
            free: 0,
        }
    }
}

impl Flash {
    /// Reads a line from the array as soon as it is free. Returns the cycle in which the line
    /// comes.
    fn read(&mut self, now: u64) -> u64 {
        let comes = now.max(self.free) + WAIT_STATES;
        self.free = comes + 1;
        comes
    }

    /// Fetches instructions from a line at time `now`. `straight` says that the core has asked for
    /// the line ahead of its need. Returns the cycles that the core waits.
    pub fn fetch(&mut self, line: u32, straight: bool, now: u64) -> u64 {
        if self.current == Some(line) {
            return 0;
        }
        self.current = Some(line);
        let mut wait = 0;
        if !self.code.hit(line) {
            let is_next = self.next == Some(line);
            let comes = if is_next {
                self.next_comes
            } else {
                self.read(now)
            };
            wait = comes.saturating_sub(now);
            self.code.enter(line);
        }
        if straight {
            wait = wait.saturating_sub(AHEAD);
        }
        self.prefetch(line + 1, now + wait);
        wait
    }

    fn prefetch(&mut self, line: u32, now: u64) {
        if self.next != Some(line) && !self.code.has(line) {
            self.next_comes = self.read(now);
            self.next = Some(line);
        }
    }

    /// Reads data from a line at time `now`. Returns the cycles that the core waits.
    pub fn load(&mut self, line: u32, now: u64) -> u64 {
        if self.data.hit(line) {
            return 0;
        }
        let wait = self.read(now) - now;
        self.data.enter(line);
        wait
    }
}

#[cfg(test)]
mod tests {
    use super::{FLASH_BYTES, FLASH_START, Flash, LINE_BYTES, line_of};

    #[test]
    fn a_loop_waits_once() {
        let mut flash = Flash::default();
        assert_eq!(flash.fetch(7, false, 0), 5);
        // The next line comes six cycles after the first, and the core asks ahead.
        assert_eq!(flash.fetch(8, true, 5 + 4), 0);
        for turn in 1..10 {
            let now = 100 * turn;
            let waits = flash.fetch(7, false, now) + flash.fetch(8, true, now + 4);
            assert_eq!(waits, 0);
        }
    }

    #[test]
    fn the_oldest_of_65_lines_is_gone() {
        let mut flash = Flash::default();
        for line in 0..65 {
            // Every other line, so that the prefetched one is never used.
            assert_eq!(flash.fetch(2 * line, false, u64::from(line) * 100), 5);
        }
        assert_eq!(flash.fetch(2 * 64, false, 20_000), 0);
        assert_eq!(flash.fetch(2, false, 20_100), 0);
        assert_eq!(flash.fetch(0, false, 20_200), 5);
    }

    #[test]
    fn eight_lines_of_data_stay() {
        let mut flash = Flash::default();
        let mut loads = |now: u64, lines: core::ops::Range<u32>| -> Vec<u64> {
            lines
                .map(|line| flash.load(line, now + 100 * u64::from(line)))
                .collect()
        };
        assert_eq!(loads(0, 0..8), [5; 8]);
        assert_eq!(loads(10_000, 0..8), [0; 8]);
        assert_eq!(loads(20_000, 8..9), [5]);
        assert_eq!(loads(30_000, 0..1), [5]);
    }

    #[test]
    fn data_waits_for_a_prefetch_under_way() {
        let mut flash = Flash::default();
        assert_eq!(flash.fetch(0, false, 0), 5);
        // The array reads line 1 from cycle 6 to cycle 11, so it is free 4 cycles later.
        assert_eq!(flash.load(900, 8), 4 + 5);
    }

    #[test]
    fn only_the_flash_has_lines() {
        assert_eq!(line_of(FLASH_START), Some(0));
        assert_eq!(line_of(FLASH_START + LINE_BYTES), Some(1));
        assert_eq!(line_of(FLASH_START + FLASH_BYTES), None);
        assert_eq!(line_of(0x2000_0000), None);
        assert_eq!(line_of(FLASH_START - 1), None);
    }
}

//! The second look: whether a frontier that no path leads to is tried again at the end.
//!
//! What is in the way may have come and may be gone. So the exploration ends only if the second
//! looks showed less than [`LEAST_MORE_CELLS`] more for [`PATIENCE_MS`]. Each that shows more shows
//! more of a finite map, so there is a last one.
//!
//! While it waits the robot turns on the spot. Otherwise it may stand with its back to what is in
//! the way, and never see that it has gone. Measured: docs/MEASURED.md, "Wait at the end", "A robot
//! that waits turns about".
//!
//! Units: map cells, milliseconds.

use crate::clock::since;

/// What second looks must have shown, so that the wait begins anew: 1 m².
const LEAST_MORE_CELLS: u32 = 100;
/// Time for which the robot waits that what is in the way goes, milliseconds.
const PATIENCE_MS: u32 = 30_000;

/// The state of the second look.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SecondLook {
    /// When the wait began.
    since_ms: u32,
    /// Known cells at that time.
    known_cells: u32,
}

impl SecondLook {
    /// Makes the state at the start.
    pub(crate) const fn new() -> Self {
        Self {
            since_ms: 0,
            known_cells: 0,
        }
    }

    /// Returns true if there is another second look now that no path is left.
    pub(crate) const fn begins(&mut self, known_cells: u32, time_ms: u32) -> bool {
        if known_cells >= self.known_cells.saturating_add(LEAST_MORE_CELLS) {
            (self.known_cells, self.since_ms) = (known_cells, time_ms);
        }
        since(time_ms, self.since_ms) < PATIENCE_MS
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_waits_for_a_while_and_ends_if_nothing_more_was_seen() {
        let mut look = SecondLook::new();
        assert!(look.begins(5_000, 1_000));
        assert!(look.begins(5_099, 1_000 + PATIENCE_MS - 1));
        assert!(!look.begins(5_099, 1_000 + PATIENCE_MS));
        assert!(look.begins(5_100, 90_000), "1 m² more");
        assert!(!look.begins(5_199, 190_000));
    }
}

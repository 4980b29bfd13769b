//! The second look: whether a frontier that no path leads to is tried again at the end.
//!
//! What is in the way may have come and may be gone. So the exploration ends only if the last
//! second look showed less than [`LEAST_MORE_CELLS`] more, or if no path was found for
//! [`PATIENCE_MS`]. Each second look shows more of a finite map, so there is a last one.
//!
//! Units: map cells, milliseconds.

/// What a second look must have shown, so that there is another: 1 m².
const LEAST_MORE_CELLS: u32 = 100;
/// Time for which the robot waits that what is in the way goes, milliseconds.
const PATIENCE_MS: u32 = 10_000;

/// The state of the second look.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SecondLook {
    /// When no path was left, and none was found since.
    waits_since_ms: Option<u32>,
    /// Known cells at the last second look.
    known_cells: u32,
}

impl SecondLook {
    /// Makes the state at the start.
    pub(crate) const fn new() -> Self {
        Self {
            waits_since_ms: None,
            known_cells: 0,
        }
    }

    /// Notes that there is a path again.
    pub(crate) const fn note_path(&mut self) {
        self.waits_since_ms = None;
    }

    /// Returns true if there is another second look now that no path is left.
    pub(crate) fn begins(&mut self, known_cells: u32, time_ms: u32) -> bool {
        if let Some(since_ms) = self.waits_since_ms {
            return time_ms.wrapping_sub(since_ms) < PATIENCE_MS;
        }
        let shows_more = known_cells >= self.known_cells.saturating_add(LEAST_MORE_CELLS);
        self.known_cells = known_cells;
        self.waits_since_ms = shows_more.then_some(time_ms);
        shows_more
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_waits_for_a_while_and_ends_if_nothing_more_was_seen() {
        let mut look = SecondLook::new();
        assert!(look.begins(5_000, 1_000));
        assert!(look.begins(5_000, 1_000 + PATIENCE_MS - 1));
        assert!(!look.begins(5_000, 1_000 + PATIENCE_MS));
        look.note_path();
        assert!(!look.begins(5_099, 60_000), "the path showed too little");
        assert!(look.begins(5_199, 90_000), "this one showed 1 m²");
        look.note_path();
        assert!(look.begins(5_299, 120_000));
    }
}

//! Dead ends: the poses from which a roll-out is known to touch.
//!
//! The field draws roll-outs together, so most of those that fail end at the same obstacle. A
//! roll-out fails as soon as it comes into a cell that an earlier one went through before it
//! failed: the rest of the way is known. Cells are those of the search, 3 cm × 3 cm × 7.5°, once
//! for the robot's front ahead and once for its back.
//!
//! ```text
//! h = factor · key + 1 mod 2¹⁹  a bijection, because the factor is odd
//! entry[h / 256] = h mod 256   0: empty
//! ```
//!
//! A newer cell replaces an older one. A search that finds nothing ends earlier by it (measured:
//! docs/MEASURED.md, "Dead ends of roll-outs").
//!
//! Invariant: a cell is known only if it was noted. A forgotten cell costs another roll-out.
//! Units: metres, radians; robot frame at the start.

use crate::drive::hull::Place;
use crate::drive::motion::{DIRECTIONS, MOTIONS, cell_of};
use crate::grid::at;

/// Cells to each side of the start within which poses are noted: a search reaches 22 cells, and a
/// roll-out of [`ROLL_M`](super::roll_out::ROLL_M) leaves it by at most 15.
const REACH: i32 = 32;
/// Bits of a key: the fewest that hold all cells within reach, both ways round.
const KEY_BITS: u32 = 19;
/// Bits of an entry. The others choose it: there are as many entries as the scratch has room for.
const ENTRY_BITS: u32 = 8;
/// An odd number with many bits, so that cells beside each other have entries apart.
const FACTOR: u32 = 0x9e3b5;
/// Words of memory, four entries each.
pub(super) const WORDS: usize = (1 << (KEY_BITS - ENTRY_BITS)) / 4;
const _CHECKS: () = assert!(
    (2 * REACH) * (2 * REACH) * DIRECTIONS * 2 <= 1 << KEY_BITS,
    "every cell has a key"
);

/// The dead ends of a search, in the scratch memory.
#[derive(Debug)]
pub(super) struct DeadEnds<'a>(pub(super) &'a mut [u32]);

impl DeadEnds<'_> {
    /// Forgets all.
    pub(super) fn clear(&mut self) {
        self.0.fill(0);
    }

    /// Returns true if the field is known to lead into an obstacle from a pose, with the robot's
    /// front ahead or its back.
    pub(super) fn has(&self, place: Place, backwards: bool) -> bool {
        key(place, backwards).is_some_and(|key| {
            let (word, below) = place_of(key);
            key & 0xff != 0 && at(self.0, word) >> below & 0xff == key & 0xff
        })
    }

    /// Notes the poses of a roll-out that failed.
    pub(super) fn note(&mut self, from: Place, motions: &[u8], backwards: bool) {
        let mut place = from;
        self.note_one(place, backwards);
        for motion in motions
            .iter()
            .filter_map(|&it| MOTIONS.get(usize::from(it)))
        {
            place = place.after(motion.length_m, motion.turn_rad);
            self.note_one(place, backwards);
        }
    }

    fn note_one(&mut self, place: Place, backwards: bool) {
        let Some(key) = key(place, backwards) else {
            return;
        };
        let (word, below) = place_of(key);
        if let Some(word) = self.0.get_mut(word) {
            *word = *word & !(0xff << below) | (key & 0xff) << below;
        }
    }
}

/// Returns the scrambled key of a pose's cell; `None` beyond the reach.
#[inline(never)]
fn key(place: Place, backwards: bool) -> Option<u32> {
    let [x, y, direction] = cell_of(place);
    let is_near = |at: i32| (-REACH..REACH).contains(&at);
    if !is_near(x) || !is_near(y) {
        return None;
    }
    let cell = ((y + REACH) * 2 * REACH + x + REACH) * DIRECTIONS + direction;
    let key = 2 * cell as u32 + u32::from(backwards);
    Some(key.wrapping_mul(FACTOR).wrapping_add(1) & ((1 << KEY_BITS) - 1))
}

/// Returns the word of a key's entry, and the bits below the entry.
const fn place_of(key: u32) -> (usize, u32) {
    let entry = key >> ENTRY_BITS;
    (entry as usize / 4, entry % 4 * ENTRY_BITS)
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;
    use crate::drive::motion::{BACKWARD, FORWARD, LENGTH_M, TURN_RAD};

    /// Returns the pose of a cell's middle, for every `apart`th cell of both ways round.
    fn poses(apart: i32) -> impl Iterator<Item = (Place, bool)> {
        let cells = (2 * REACH) * (2 * REACH) * DIRECTIONS;
        (0..cells).step_by(apart as usize).map(|cell| {
            let (column, row) = (
                cell / DIRECTIONS % (2 * REACH),
                cell / DIRECTIONS / (2 * REACH),
            );
            let place = Place {
                x_m: LENGTH_M * (column - REACH) as f32,
                y_m: LENGTH_M * (row - REACH) as f32,
                yaw_rad: TURN_RAD * (cell % DIRECTIONS) as f32,
            };
            (place, cell % 2 == 0)
        })
    }

    #[test]
    fn every_cell_has_a_key_of_its_own() {
        let mut keys = HashSet::new();
        for (place, _) in poses(1) {
            for backwards in [false, true] {
                assert!(keys.insert(key(place, backwards).expect("within reach")));
            }
        }
    }

    /// A set without collisions is the oracle: nothing is known that it does not have.
    #[test]
    fn nothing_is_known_that_was_not_noted_and_the_last_is() {
        let mut words = std::vec![0; WORDS];
        let mut dead_ends = DeadEnds(&mut words);
        let mut noted = HashSet::new();
        for (place, backwards) in poses(37) {
            dead_ends.note(place, &[], backwards);
            noted.insert(key(place, backwards));
            let is_kept = key(place, backwards).is_some_and(|key| key & 0xff != 0);
            assert_eq!(dead_ends.has(place, backwards), is_kept);
        }
        for (place, backwards) in poses(1) {
            assert!(!dead_ends.has(place, backwards) || noted.contains(&key(place, backwards)));
        }
    }

    #[test]
    fn the_places_of_a_roll_out_are_noted_one_by_one() {
        let mut words = std::vec![0; WORDS];
        let mut dead_ends = DeadEnds(&mut words);
        let from = Place::default();
        dead_ends.note(from, &[FORWARD; 5], false);
        for k in 0..=5 {
            assert!(
                dead_ends.has(from.after(LENGTH_M * k as f32, 0.0), false),
                "{k}"
            );
        }
        assert!(!dead_ends.has(from.after(6.0 * LENGTH_M, 0.0), false));
        assert!(
            !dead_ends.has(from, true),
            "the other way round is not known"
        );
        dead_ends.note(from, &[BACKWARD; 2], true);
        assert!(dead_ends.has(from.after(-LENGTH_M, 0.0), true));
        for beyond_m in [2.0, -2.0] {
            let beyond = from.after(beyond_m, 0.0);
            dead_ends.note(beyond, &[], false);
            assert!(
                !dead_ends.has(beyond, false),
                "beyond the reach nothing is noted"
            );
        }
    }
}

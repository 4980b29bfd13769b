//! Candidates: frontier cells near each other, of which the nearest by path stands for all.
//!
//! A wave from the robot adds frontier cells, the nearest first. A cell joins a candidate that is
//! at most [`GROUP_CELLS`] away along either axis, or else is the next candidate. The list lies in
//! lent memory. What does not fit is dropped.
//!
//! Invariant: the candidates of a piece of the skeleton are in the order of their steps.
//!
//! Units: sites of the skeleton's plane; coarse steps of 20 cm.

use core::ops::Range;

use crate::grid::{Site, at};

/// A frontier cell at most this far from a candidate along either axis belongs to it, coarse cells.
const GROUP_CELLS: u16 = 5;
/// Capacity. Two candidates are more than 1 m apart along an axis, and a map has 2,560 m² with the
/// pool of an image. Those that do not fit are not judged.
const MOST: usize = 512;
/// Words of a candidate.
const EACH: usize = 2;
/// Words that the list needs.
pub(crate) const WORDS: usize = MOST * EACH;

/// Frontier cells near each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Candidate {
    /// The nearest one, and the steps to it.
    pub(crate) site: Site,
    pub(crate) steps: u16,
    /// Number of cells that the wave met.
    pub(crate) cells: u16,
}

impl Candidate {
    fn words(self) -> [u32; EACH] {
        let pair = |high: u16, low: u16| u32::from(high) << 16 | u32::from(low);
        [pair(self.site.x, self.site.y), pair(self.steps, self.cells)]
    }

    fn from_words([site, counts]: [u32; EACH]) -> Self {
        let pair = |word: u32| ((word >> 16) as u16, word as u16);
        let ((x, y), (steps, cells)) = (pair(site), pair(counts));
        Self {
            site: Site { x, y },
            steps,
            cells,
        }
    }

    fn has(&self, site: Site) -> bool {
        self.site.x.abs_diff(site.x) <= GROUP_CELLS && self.site.y.abs_diff(site.y) <= GROUP_CELLS
    }
}

/// The list of candidates, the nearest first.
#[derive(Debug)]
pub(crate) struct Candidates<'a> {
    words: &'a mut [u32],
    len: usize,
}

impl<'a> Candidates<'a> {
    /// Begins a list in lent memory, [`WORDS`] long.
    pub(crate) const fn new(words: &'a mut [u32]) -> Self {
        Self { words, len: 0 }
    }

    /// Returns the number of candidates.
    pub(crate) const fn len(&self) -> usize {
        self.len
    }

    /// Adds a frontier cell, which is no nearer than those before. Returns true if it is the first
    /// of a candidate.
    pub(crate) fn add(&mut self, site: Site, steps: u32) -> bool {
        let used = self.words.get_mut(..self.len * EACH).unwrap_or_default();
        // A wave finds neighbours soon after one another, so the last candidates come first.
        let mut listed = used.as_chunks_mut().0.iter_mut().rev();
        if let Some(near) = listed.find(|words| Candidate::from_words(**words).has(site)) {
            let candidate = Candidate::from_words(*near);
            let cells = candidate.cells.saturating_add(1);
            *near = Candidate { cells, ..candidate }.words();
            return false;
        }
        let candidate = Candidate {
            site,
            // The longest way in the map has fewer.
            steps: u16::try_from(steps).unwrap_or(u16::MAX),
            cells: 1,
        };
        let room = self.words.get_mut(self.len * EACH..(self.len + 1) * EACH);
        let fits = room.is_some();
        if let Some(room) = room {
            room.copy_from_slice(&candidate.words());
            self.len += 1;
        }
        fits
    }

    /// Returns the candidates at these places.
    pub(crate) fn range(&self, places: Range<usize>) -> impl Iterator<Item = Candidate> {
        (places.start..places.end.min(self.len)).map(|place| self.get(place))
    }

    fn get(&self, place: usize) -> Candidate {
        Candidate::from_words([0, 1].map(|k| at(self.words, place * EACH + k)))
    }
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::{Candidate, Candidates, GROUP_CELLS, MOST, WORDS};
    use crate::grid::Site;

    fn site(x: usize, y: usize) -> Site {
        Site {
            x: x as u16,
            y: y as u16,
        }
    }

    #[test]
    fn the_nearest_of_cells_near_each_other_stands_for_them() {
        let mut words = [7; WORDS];
        let mut list = Candidates::new(&mut words);
        for (x, steps) in [(100, 3), (300, 4), (105, 5), (95, 6), (106, 7)] {
            list.add(site(x, 50), steps);
        }
        let found: Vec<_> = list.range(0..9).collect();
        let group = |x, steps, cells| Candidate {
            site: site(x, 50),
            steps,
            cells,
        };
        assert_eq!(
            found,
            [group(100, 3, 3), group(300, 4, 1), group(106, 7, 1)]
        );
        assert_eq!(list.range(1..2).count(), 1);
    }

    #[test]
    fn a_full_list_drops_the_farthest() {
        let mut words = [0; WORDS];
        let mut list = Candidates::new(&mut words);
        let apart = usize::from(GROUP_CELLS) + 1;
        for k in 0..MOST + 3 {
            list.add(site(k % 32 * apart, k / 32 * apart), k as u32);
        }
        assert_eq!(list.len(), MOST);
        assert!(list.range(0..MOST).zip(0..).all(|(it, k)| it.steps == k));
    }
}

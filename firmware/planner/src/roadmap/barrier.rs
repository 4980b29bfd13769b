//! A barrier: cells taken out of a plane for a while.

use heapless::Vec;

use crate::grid::{PlaneMut, Site};

/// A blocker for a wave: up to `N` cells of the skeleton, cleared until it is lowered.
///
/// A wave cannot enter a cell that is clear, so the robot's cells or a wall across the path stop it
/// \[Jorge15, steps 3 and 5\]. Invariant: every cell of the barrier was set before and is clear
/// now.
#[derive(Debug)]
#[must_use = "lower it, or the skeleton stays cut"]
pub struct Barrier<const N: usize> {
    cleared: Vec<Site, N>,
}

impl<const N: usize> Barrier<N> {
    /// Clears `cells` in the plane. Cells that are clear already, or outside, stay as they are.
    ///
    /// # Errors
    /// If more than `N` of them are set. The plane is then as it was.
    pub fn raise(
        plane: &mut PlaneMut<'_>,
        cells: impl IntoIterator<Item = Site>,
    ) -> Result<Self, BarrierFull> {
        let mut barrier = Self {
            cleared: Vec::new(),
        };
        for cell in cells {
            if plane.clear(cell) && barrier.cleared.push(cell).is_err() {
                plane.set(cell);
                barrier.lower(plane);
                return Err(BarrierFull);
            }
        }
        Ok(barrier)
    }

    /// Sets the cells again.
    pub fn lower(self, plane: &mut PlaneMut<'_>) {
        for cell in self.cleared {
            plane.set(cell);
        }
    }
}

/// The error of more cells than a barrier holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BarrierFull;

impl core::fmt::Display for BarrierFull {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("a barrier has no room for so many skeleton cells: use a larger one")
    }
}

impl core::error::Error for BarrierFull {}

#[cfg(test)]
mod tests {
    use super::{Barrier, BarrierFull};
    use crate::grid::{PlaneMut, Site, TileKey, Tiling};

    fn keys() -> [TileKey; 1] {
        [TileKey::of(0, 0).unwrap()]
    }

    fn row() -> [Site; 3] {
        let Site { x, y } = keys()[0].least();
        [2, 3, 4].map(|columns| Site { x: x + columns, y })
    }

    #[test]
    fn a_barrier_lowered_leaves_no_trace() {
        let (keys, mut words) = (keys(), [0b10111, 0, 0, 0, 0, 0, 0, 0]);
        let before = words;
        let mut plane = PlaneMut::new(Tiling::new(&keys), &mut words).unwrap();
        let barrier = Barrier::<2>::raise(&mut plane, row()).unwrap();
        assert_eq!(plane.words_mut()[0], 0b00011);
        barrier.lower(&mut plane);
        assert_eq!(words, before, "bit 3 was clear before");
    }

    #[test]
    fn a_barrier_too_small_is_not_raised() {
        let (keys, mut words) = (keys(), [0b11111; 8]);
        let mut plane = PlaneMut::new(Tiling::new(&keys), &mut words).unwrap();
        let error = Barrier::<2>::raise(&mut plane, row()).unwrap_err();
        assert_eq!(error, BarrierFull);
        assert_eq!(words, [0b11111; 8]);
    }
}

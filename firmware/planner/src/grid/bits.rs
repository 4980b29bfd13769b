//! Word-parallel operations on small squares of cells: up to 64 columns, one `u64` a row.
//!
//! Bit k of a row is column k. Outside the square everything reads 0, so what is wanted at a tile's rim needs a halo.
//! Each operation has a naive twin among its tests.
//!
//! Units: cells.

use core::ops::Range;

use crate::grid::Site;

/// Greatest reach of [`dilate`] in cells, along a row or a column.
pub const MAX_REACH: usize = 4;

/// Which cells count as adjacent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Adjacency {
    /// Those that share a side.
    Four,
    /// Those that share a side or a corner.
    Eight,
}

/// Where a flood ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FloodHit {
    /// The target cell that was met; the lowest row, then the lowest column, of those at the same number of steps.
    pub site: Site,
    /// Steps from the nearest seed to it.
    pub steps: u16,
}

/// Set every cell whose centre is nearer than √`radius2` cells to a set one: dx² + dy² < `radius2`.
///
/// `radius2` is at most 25, so that the reach is at most [`MAX_REACH`]; more counts as 25.
pub fn dilate<const N: usize>(rows: &mut [u64; N], radius2: u32) {
    let reaches = reaches(radius2);
    let mut wide = [0_u64; N];
    for (y, &row) in rows.iter().enumerate().filter(|(_, row)| **row != 0) {
        let spread = spread(row);
        for (dy, reach) in reaches.iter().enumerate() {
            let Some(grown) = reach.and_then(|reach| spread.get(reach)) else {
                break;
            };
            for near in [y.checked_sub(dy), Some(y + dy)].into_iter().flatten() {
                if let Some(out) = wide.get_mut(near) {
                    *out |= grown;
                }
            }
        }
    }
    *rows = wide;
}

/// For each row distance, the greatest column distance with dx² + dy² < `radius2`, if there is one.
fn reaches(radius2: u32) -> [Option<usize>; MAX_REACH + 1] {
    core::array::from_fn(|dy| {
        (0..=MAX_REACH)
            .rev()
            .find(|dx| ((dx * dx + dy * dy) as u32) < radius2)
    })
}

/// A row grown sideways by 0 to [`MAX_REACH`] cells.
fn spread(row: u64) -> [u64; MAX_REACH + 1] {
    let mut grown = row;
    core::array::from_fn(|reach| {
        grown |= (row << reach) | (row >> reach);
        grown
    })
}

/// Flood `mask` from the cells of `seeds` in it, step by step, until a cell of `targets` is met.
///
/// `seeds` becomes what was reached: all of it when nothing was met. A seed that is a target is met at step 0.
/// A target outside `mask` cannot be met.
pub fn flood<const N: usize>(
    mask: &[u64; N],
    seeds: &mut [u64; N],
    targets: &[u64; N],
    adjacency: Adjacency,
) -> Option<FloodHit> {
    for (seed, mask) in seeds.iter_mut().zip(mask) {
        *seed &= mask;
    }
    let eight = adjacency == Adjacency::Eight;
    // The rows that changed in the last step: only they and those beside them can change in the next.
    let mut changed = 0..N;
    let mut steps = 0;
    while !changed.is_empty() {
        if let Some(site) = first_common(seeds, targets, changed.clone()) {
            return Some(FloodHit { site, steps });
        }
        let wider = changed.start.saturating_sub(1)..(changed.end + 1).min(N);
        changed = if eight {
            grow::<N, true>(mask, seeds, wider)
        } else {
            grow::<N, false>(mask, seeds, wider)
        };
        steps += 1;
    }
    None
}

/// One step of a flood in some of the rows; the span of those that changed, empty if none did.
fn grow<const N: usize, const EIGHT: bool>(
    mask: &[u64; N],
    reached: &mut [u64; N],
    rows: Range<usize>,
) -> Range<usize> {
    let mut changed = N..0;
    let mut above = row(reached, rows.start.wrapping_sub(1));
    let mut here = row(reached, rows.start);
    for y in rows {
        let below = row(reached, y + 1);
        let sides = here << 1 | here >> 1;
        let near = if EIGHT {
            let column = above | below;
            column | column << 1 | column >> 1 | sides
        } else {
            above | below | sides
        };
        let grown = near & row(mask, y) & !here;
        if grown != 0 {
            if let Some(out) = reached.get_mut(y) {
                *out = here | grown;
            }
            changed = changed.start.min(y)..y + 1;
        }
        (above, here) = (here, below);
    }
    changed
}

#[inline]
fn row(rows: &[u64], y: usize) -> u64 {
    rows.get(y).copied().unwrap_or(0)
}

/// The first cell, row by row, that both have in some of the rows.
fn first_common(one: &[u64], other: &[u64], mut rows: Range<usize>) -> Option<Site> {
    rows.find_map(|y| {
        let common = row(one, y) & row(other, y);
        (common != 0).then(|| Site {
            x: common.trailing_zeros() as u16,
            y: y as u16,
        })
    })
}

/// The places of a word's bits, least first.
pub(crate) fn ones(mut word: u32) -> impl Iterator<Item = u32> {
    core::iter::from_fn(move || {
        let place = (word != 0).then(|| word.trailing_zeros());
        word &= word.wrapping_sub(1);
        place
    })
}

/// The places of a row's bits, least first.
pub(crate) fn ones64(mut row: u64) -> impl Iterator<Item = u32> {
    core::iter::from_fn(move || {
        let place = (row != 0).then(|| row.trailing_zeros());
        row &= row.wrapping_sub(1);
        place
    })
}

/// Half a row's resolution: bit k of the result is set if any of columns 2 k and 2 k + 1 of either row is.
#[must_use]
pub fn halve_or(upper: u64, lower: u64) -> u32 {
    let both = upper | lower;
    u32::from(halve(both as u32)) | u32::from(halve((both >> 32) as u32)) << 16
}

/// Bits 2 k and 2 k + 1 joined into bit k.
fn halve(word: u32) -> u16 {
    let mut bits = (word | word >> 1) & 0x5555_5555;
    bits = (bits | bits >> 1) & 0x3333_3333;
    bits = (bits | bits >> 2) & 0x0f0f_0f0f;
    bits = (bits | bits >> 4) & 0x00ff_00ff;
    (bits | bits >> 8) as u16
}

#[cfg(test)]
mod tests {
    use std::collections::VecDeque;
    use std::vec;
    use std::vec::Vec;

    use super::{Adjacency, FloodHit, dilate, flood, halve_or};
    use crate::grid::Site;

    /// A xorshift generator.
    struct Rng(u64);

    impl Rng {
        fn next(&mut self) -> u64 {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
            self.0
        }

        /// Rows with some 1 in 2^`sparsity` cells set.
        fn rows<const N: usize>(&mut self, sparsity: u32) -> [u64; N] {
            core::array::from_fn(|_| (0..sparsity).fold(u64::MAX, |bits, _| bits & self.next()))
        }
    }

    fn get(rows: &[u64], x: i32, y: i32) -> bool {
        (0..64).contains(&x) && rows.get(y as usize).is_some_and(|row| row >> x & 1 == 1)
    }

    #[test]
    fn a_disc_of_three_cells_as_drawn() {
        let mut rows = [0_u64; 7];
        rows[3] = 1 << 3;
        dilate(&mut rows, 9);
        let expected = [
            0b000_0000, 0b011_1110, 0b011_1110, 0b011_1110, 0b011_1110, 0b011_1110, 0b000_0000,
        ];
        assert_eq!(rows, expected, "(3, 0) is not nearer than 3, (2, 2) is");
    }

    #[test]
    fn dilation_equals_its_definition() {
        let mut rng = Rng(7);
        for radius2 in 0..=25 {
            for sparsity in [3, 6, 9] {
                let rows: [u64; 41] = rng.rows(sparsity);
                let mut grown = rows;
                dilate(&mut grown, radius2);
                for y in 0..41 {
                    for x in 0..64 {
                        let near = (-5..=5).any(|dy| {
                            (-5..=5).any(|dx| {
                                dx * dx + dy * dy < radius2 as i32 && get(&rows, x + dx, y + dy)
                            })
                        });
                        assert_eq!(get(&grown, x, y), near, "({x}, {y}), radius² {radius2}");
                    }
                }
            }
        }
    }

    /// Steps from the nearest seed inside the mask.
    fn steps(mask: &[u64], seeds: &[u64], adjacency: Adjacency) -> Vec<Option<u16>> {
        let mut steps = vec![None; mask.len() * 64];
        let mut queue = VecDeque::new();
        for (i, steps) in steps.iter_mut().enumerate() {
            let (x, y) = ((i % 64) as i32, (i / 64) as i32);
            if get(mask, x, y) && get(seeds, x, y) {
                *steps = Some(0);
                queue.push_back(i);
            }
        }
        while let Some(i) = queue.pop_front() {
            let (x, y) = ((i % 64) as i32, (i / 64) as i32);
            for (dy, dx) in (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dy, dx))) {
                let side = dx * dy == 0;
                let near = ((y + dy) * 64 + x + dx) as usize;
                if (side || adjacency == Adjacency::Eight)
                    && get(mask, x + dx, y + dy)
                    && steps[near].is_none()
                {
                    steps[near] = steps[i].map(|s: u16| s + 1);
                    queue.push_back(near);
                }
            }
        }
        steps
    }

    fn check_flood(rng: &mut Rng, adjacency: Adjacency, density: u32) -> bool {
        let mask: [u64; 24] = rng.rows::<24>(density).map(|row| !row);
        let mut seeds: [u64; 24] = rng.rows(8);
        let targets: [u64; 24] = rng.rows(9);
        let steps = steps(&mask, &seeds, adjacency);
        let nearest = (0..steps.len())
            .filter(|i| targets[i / 64] >> (i % 64) & 1 == 1)
            .filter_map(|i| Some((steps[i]?, i)))
            .min();
        let expected = nearest.map(|(steps, i)| FloodHit {
            site: Site {
                x: (i % 64) as u16,
                y: (i / 64) as u16,
            },
            steps,
        });
        assert_eq!(flood(&mask, &mut seeds, &targets, adjacency), expected);
        let until = expected.map_or(u16::MAX, |met| met.steps);
        for (i, steps) in steps.iter().enumerate() {
            let reached = seeds[i / 64] >> (i % 64) & 1 == 1;
            assert_eq!(reached, steps.is_some_and(|s| s <= until), "cell {i}");
        }
        expected.is_some_and(|met| met.steps > 2)
    }

    #[test]
    fn flood_meets_the_nearest_target_by_steps() {
        let mut rng = Rng(9);
        for adjacency in [Adjacency::Four, Adjacency::Eight] {
            let far = (0..300)
                .filter(|k| check_flood(&mut rng, adjacency, 1 + k % 3))
                .count();
            assert!(far > 10, "only {far} floods went three steps or more");
        }
    }

    #[test]
    fn flood_without_a_target_reaches_all_it_can() {
        let mut mask = [u64::MAX; 5];
        mask[2] = 0;
        let mut seeds = [0, 1 << 63, 1, 0, 0];
        let met = flood(&mask, &mut seeds, &[0; 5], Adjacency::Eight);
        assert_eq!(met, None);
        assert_eq!(seeds, [u64::MAX, u64::MAX, 0, 0, 0]);
    }

    #[test]
    fn half_the_resolution_joins_two_by_two_cells() {
        let mut rng = Rng(5);
        for _ in 0..200 {
            let [upper, lower] = rng.rows(2);
            let half = halve_or(upper, lower);
            for k in 0..32 {
                let any = (upper | lower) >> (2 * k) & 3 != 0;
                assert_eq!(half >> k & 1 == 1, any, "column {k}");
            }
        }
    }
}

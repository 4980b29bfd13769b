//! Floods over squares of cells: one `u64` a row, bit k is column k, cells that share a side are
//! adjacent.
//!
//! [`reach`] finds every cell that can be reached; it fills whole runs of a row at once.
//! [`nearest`] finds the first target and counts the steps to it; it grows by one cell at a time,
//! so it cannot fill runs. The flood of the whole map (`roadmap::reachability`) is a third one: it
//! works in instalments on rows of several `u32`, and 64-bit words would double its cost on a
//! 32-bit core.
//!
//! Units: cells.

use core::ops::Range;

use crate::grid::{Site, at, inside_mut};

/// Returns the seeds and all cells of `open` that a path of open cells joins to a seed.
///
/// A seed may lie outside `open`. N is at most 64.
pub(crate) fn reach<const N: usize>(open: &[u64; N], seeds: &[u64; N]) -> [u64; N] {
    let mut reached = *seeds;
    spread(open, &mut reached);
    reached
}

/// Adds all cells of `open` that a path of open cells joins to one of those reached: [`reach`] in
/// place.
pub(crate) fn spread<const N: usize>(open: &[u64; N], reached: &mut [u64; N]) {
    const { assert!(N > 0 && N <= 64, "a row needs a bit of `awake`") };
    let all = u64::MAX >> (64 - N);
    // Rows that may still grow. A row that grew wakes its two neighbours.
    let mut awake = all;
    while awake != 0 {
        let y = awake.trailing_zeros() as usize;
        awake &= awake - 1;
        let (here, open) = (at(reached, y), at(open, y));
        let beside = at(reached, y.wrapping_sub(1)) | at(reached, y + 1);
        let seeds = here | (beside & open);
        let grown = seeds | fill(open, open & (seeds | seeds << 1 | seeds >> 1));
        if let Some(row) = inside_mut(reached, y)
            && *row != grown
        {
            *row = grown;
            awake |= (0b101 << y) >> 1;
            awake &= all;
        }
    }
}

/// Returns every run of `mask` that holds one of `seeds` (a subset of `mask`), whole.
fn fill(mask: u64, seeds: u64) -> u64 {
    let backward = fill_upward(mask.reverse_bits(), seeds.reverse_bits());
    fill_upward(mask, seeds) | backward.reverse_bits()
}

/// Fills from each seed to the high end of its run: a carry that starts at a seed clears the run's
/// bits up to its end.
fn fill_upward(mask: u64, seeds: u64) -> u64 {
    mask & !mask.wrapping_add(seeds) | seeds
}

/// The target that a flood met first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct FloodHit {
    /// The target cell. Of targets at the same number of steps it is the one with the lowest row,
    /// then with the lowest column.
    pub(crate) site: Site,
    /// Steps from the nearest seed to it.
    pub(crate) steps: u16,
}

/// Floods `open` from the cells of `seeds` in it, step by step, until the flood meets a cell of
/// `targets`.
///
/// `seeds` becomes the cells reached so far: all that can be reached if the result is `None`. A
/// seed that is a target is met at step 0. A target outside `open` is never met.
pub(crate) fn nearest<const N: usize>(
    open: &[u64; N],
    seeds: &mut [u64; N],
    targets: &[u64; N],
) -> Option<FloodHit> {
    for (seed, open) in seeds.iter_mut().zip(open) {
        *seed &= open;
    }
    // The rows that changed in the last step. Only they and their neighbours can change in the
    // next.
    let mut changed = 0..N;
    let mut steps = 0;
    while !changed.is_empty() {
        if let Some(site) = first_common(seeds, targets, changed.clone()) {
            return Some(FloodHit { site, steps });
        }
        let wider = changed.start.saturating_sub(1)..(changed.end + 1).min(N);
        changed = grow(open, seeds, wider);
        steps += 1;
    }
    None
}

/// Grows a flood by one step in some of the rows. Returns the span of the rows that changed.
pub(crate) fn grow<const N: usize>(
    open: &[u64; N],
    reached: &mut [u64; N],
    rows: Range<usize>,
) -> Range<usize> {
    let mut changed = N..0;
    let mut above = at(reached, rows.start.wrapping_sub(1));
    let mut here = at(reached, rows.start);
    for y in rows {
        let below = at(reached, y + 1);
        let grown = (above | below | here << 1 | here >> 1) & at(open, y) & !here;
        if grown != 0 {
            if let Some(out) = inside_mut(reached, y) {
                *out = here | grown;
            }
            changed = changed.start.min(y)..y + 1;
        }
        (above, here) = (here, below);
    }
    changed
}

/// Returns the first cell, row by row, that both have in some of the rows.
fn first_common(one: &[u64], other: &[u64], mut rows: Range<usize>) -> Option<Site> {
    rows.find_map(|y| {
        let common = at(one, y) & at(other, y);
        (common != 0).then(|| Site {
            x: common.trailing_zeros() as u16,
            y: y as u16,
        })
    })
}

#[cfg(test)]
mod tests {
    use std::collections::VecDeque;
    use std::vec;
    use std::vec::Vec;

    use super::{FloodHit, fill, nearest, reach};
    use crate::grid::Site;
    use crate::grid::bits::tests::{Rng, get};

    /// Side of the field's window.
    const SIDE: usize = 61;

    #[test]
    fn a_run_fills_from_any_of_its_seeds() {
        assert_eq!(fill(0b0111_0110, 0b0010_0000), 0b0111_0000);
        assert_eq!(fill(0b0111_0110, 0b0101_0010), 0b0111_0110);
        assert_eq!(fill(0b0111_0110, 0), 0);
        let row = (1 << SIDE) - 1;
        assert_eq!(fill(row, 1 << 30), row);
    }

    #[test]
    fn a_meander_is_reached_to_its_end_and_a_cell_behind_a_corner_is_not() {
        // Columns 0, 2, 4 .. are corridors, joined alternately at the top and at the bottom.
        let even = 0x1555_5555_5555_5555_u64;
        let mut open = [even; SIDE];
        open[0] |= 0x0888_8888_8888_8888;
        open[SIDE - 1] |= 0x0222_2222_2222_2222;
        let mut seeds = [0; SIDE];
        seeds[0] = 1;
        assert_eq!(reach(&open, &seeds), open);

        // Cells that touch only at a corner are not adjacent.
        let mut open = [0; SIDE];
        open[10] = 0b0111;
        open[11] = 0b1000;
        let mut seeds = [0; SIDE];
        seeds[10] = 0b0001;
        let reached = reach(&open, &seeds);
        assert_eq!((reached[10], reached[11]), (0b0111, 0));
    }

    #[test]
    fn a_seed_outside_the_open_cells_reaches_those_beside_it() {
        let mut open = [0; SIDE];
        open[3] = 0b1_0110;
        let mut seeds = [0; SIDE];
        seeds[3] = 0b0_1000;
        seeds[4] = 0b0_1000;
        assert_eq!(reach(&open, &seeds)[3], 0b1_1110);
        assert_eq!(reach(&open, &seeds)[4], 0b0_1000);
    }

    #[test]
    fn no_seed_reaches_nothing() {
        let open = [(1 << SIDE) - 1; SIDE];
        assert_eq!(reach(&open, &[0; SIDE]), [0; SIDE]);
    }

    /// Steps from the nearest seed inside the mask, by a queue.
    fn steps(mask: &[u64], seeds: &[u64]) -> Vec<Option<u16>> {
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
            for (dx, dy) in [(1, 0), (-1, 0), (0, 1), (0, -1)] {
                let near = ((y + dy) * 64 + x + dx) as usize;
                if get(mask, x + dx, y + dy) && steps[near].is_none() {
                    steps[near] = steps[i].map(|s: u16| s + 1);
                    queue.push_back(near);
                }
            }
        }
        steps
    }

    fn check_floods(rng: &mut Rng, density: u32) -> bool {
        let open: [u64; 24] = rng.rows::<24>(density).map(|row| !row);
        let mut seeds: [u64; 24] = rng.rows(8);
        let targets: [u64; 24] = rng.rows(9);
        let steps = steps(&open, &seeds);
        let first = (0..steps.len())
            .filter(|i| targets[i / 64] >> (i % 64) & 1 == 1)
            .filter_map(|i| Some((steps[i]?, i)))
            .min();
        let expected = first.map(|(steps, i)| FloodHit {
            site: Site {
                x: (i % 64) as u16,
                y: (i / 64) as u16,
            },
            steps,
        });
        let inside = core::array::from_fn(|y| seeds[y] & open[y]);
        let all = reach(&open, &inside);
        assert_eq!(nearest(&open, &mut seeds, &targets), expected);
        let until = expected.map_or(u16::MAX, |met| met.steps);
        for (i, steps) in steps.iter().enumerate() {
            let is_in = |rows: &[u64; 24]| rows[i / 64] >> (i % 64) & 1 == 1;
            assert_eq!(is_in(&all), steps.is_some(), "cell {i}");
            assert_eq!(is_in(&seeds), steps.is_some_and(|s| s <= until), "cell {i}");
        }
        expected.is_some_and(|met| met.steps > 2)
    }

    #[test]
    fn floods_agree_with_a_queue() {
        let mut rng = Rng(9);
        let far = (0..300)
            .filter(|k| check_floods(&mut rng, 1 + k % 3))
            .count();
        assert!(far > 10, "only {far} floods went three steps or more");
    }

    #[test]
    fn a_flood_without_a_target_reaches_all_it_can() {
        let mut open = [u64::MAX; 5];
        open[2] = 0;
        let mut seeds = [0, 1 << 63, 1, 0, 0];
        let met = nearest(&open, &mut seeds, &[0; 5]);
        assert_eq!(met, None);
        assert_eq!(seeds, [u64::MAX, u64::MAX, 0, 0, 0]);
    }
}

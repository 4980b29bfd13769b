//! Word-parallel operations on small squares of cells: up to 64 columns, one `u64` a row.
//!
//! Bit k of a row is column k. Outside the square everything reads 0, so what is wanted at a tile's rim needs a halo.
//! Each operation has a naive twin among its tests.
//!
//! Units: cells.

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
pub struct Met {
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
) -> Option<Met> {
    for (seed, mask) in seeds.iter_mut().zip(mask) {
        *seed &= mask;
    }
    let mut steps = 0;
    loop {
        if let Some(site) = first_common(seeds, targets) {
            return Some(Met { site, steps });
        }
        if !grow(mask, seeds, adjacency) {
            return None;
        }
        steps += 1;
    }
}

/// One step of a flood; whether anything was added.
fn grow<const N: usize>(mask: &[u64; N], reached: &mut [u64; N], adjacency: Adjacency) -> bool {
    let mut added = 0;
    let mut above = 0;
    for y in 0..N {
        let here = row(reached, y);
        let below = row(reached, y + 1);
        let open = row(mask, y) & !here;
        if open != 0 && above | here | below != 0 {
            let grown = match adjacency {
                Adjacency::Four => above | below | here << 1 | here >> 1,
                Adjacency::Eight => {
                    let column = above | here | below;
                    column | column << 1 | column >> 1
                }
            } & open;
            if let Some(out) = reached.get_mut(y) {
                *out |= grown;
            }
            added |= grown;
        }
        above = here;
    }
    added != 0
}

#[inline]
fn row(rows: &[u64], y: usize) -> u64 {
    rows.get(y).copied().unwrap_or(0)
}

fn first_common(one: &[u64], other: &[u64]) -> Option<Site> {
    let common = one.iter().zip(other).map(|(a, b)| a & b);
    let (y, bits) = (0_u16..).zip(common).find(|(_, bits)| *bits != 0)?;
    Some(Site {
        x: bits.trailing_zeros() as u16,
        y,
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

//! The join of two versions of a tile: what two robots know together.
//!
//! ```text
//! equal epochs      per cell the greater of unknown < free < obstacle < negative
//! different epochs  the cells of the greater epoch, its unknown cells filled from the other
//! different eras    the cells of the greater era: a correction replaced the other's
//! ```
//!
//! X ≤ Y if the epochs are equal and no cell of X is greater, or if X has the lower epoch and Y
//! knows every cell that X knows, or if X is of an earlier era. A join is commutative and
//! idempotent, and no less than both. The order is finite. So however packets are lost, doubled or
//! late: members that go on to exchange tiles that differ end with equal maps.
//!
//! A cell whose class goes down (an obstacle that became free) is only kept by a greater epoch, and
//! one that becomes unknown by a greater era.
//!
//! Units: cells; a word holds the 32 cells of a row.

use crate::map::tile::{Cells, Plane};
use crate::map::versions::ERA;

/// Returns the words of a row that two versions of equal epochs know together: per cell the greater
/// class.
const fn greater([low, high]: [u32; 2], [other_low, other_high]: [u32; 2]) -> [u32; 2] {
    let from_one = low & (high | !other_high);
    let from_other = other_low & (other_high | !high);
    [from_one | from_other, high | other_high]
}

/// Returns a row with its unknown cells filled from another one.
const fn filled([low, high]: [u32; 2], [other_low, other_high]: [u32; 2]) -> [u32; 2] {
    let unknown = !(low | high);
    [low | other_low & unknown, high | other_high & unknown]
}

/// Returns the join of a row of the epoch `epoch` with a row of the epoch `other_epoch`.
pub(super) const fn join_row(
    (epoch, row): (u16, [u32; 2]),
    (other_epoch, other): (u16, [u32; 2]),
) -> [u32; 2] {
    let is_later = epoch > other_epoch;
    let (later, earlier) = if is_later { (row, other) } else { (other, row) };
    if epoch == other_epoch {
        greater(row, other)
    } else if epoch / ERA == other_epoch / ERA {
        filled(later, earlier)
    } else {
        later
    }
}

/// Returns a hash of a tile's cells that begins with `salt`.
///
/// ```text
/// h ← (rotl(h, 5) xor word) · 0x9e3779b1, over the low plane and then the high plane
/// ```
///
/// It is called from four places, so it is not inlined.
#[inline(never)]
pub(crate) fn hash(planes: [&Plane; 2], salt: u32) -> u32 {
    let mix = |hash: u32, word: &u32| (hash.rotate_left(5) ^ word).wrapping_mul(0x9e37_79b1);
    let hash = planes.into_iter().flatten().fold(salt, mix);
    hash ^ hash >> 16
}

/// Returns the row of some cells.
pub(super) fn row_of([low, high]: &Cells, row: usize) -> [u32; 2] {
    [low, high].map(|plane| plane.get(row).copied().unwrap_or(0))
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::{ERA, join_row};

    type Version = (u16, [u32; 2]);

    fn join(one: Version, other: Version) -> Version {
        (one.0.max(other.0), join_row(one, other))
    }

    /// The class of a cell as a number: unknown < free < obstacle < negative.
    fn cell((_, [low, high]): Version, k: u32) -> u32 {
        low >> k & 1 | (high >> k & 1) << 1
    }

    fn is_below(one: Version, other: Version) -> bool {
        (0..32).all(|k| {
            let (a, b) = (cell(one, k), cell(other, k));
            match one.0.cmp(&other.0) {
                core::cmp::Ordering::Less => one.0 / ERA < other.0 / ERA || a == 0 || b != 0,
                core::cmp::Ordering::Equal => a <= b,
                core::cmp::Ordering::Greater => false,
            }
        })
    }

    /// The join, cell by cell.
    fn twin(one: Version, other: Version) -> Vec<u32> {
        let class = |k| {
            let (a, b) = (cell(one, k), cell(other, k));
            match one.0.cmp(&other.0) {
                core::cmp::Ordering::Equal => a.max(b),
                core::cmp::Ordering::Greater if one.0 / ERA > other.0 / ERA => a,
                core::cmp::Ordering::Less if one.0 / ERA < other.0 / ERA => b,
                core::cmp::Ordering::Greater if a != 0 => a,
                core::cmp::Ordering::Less if b == 0 => a,
                _ => b,
            }
        };
        (0..32).map(class).collect()
    }

    #[test]
    fn a_join_is_an_upper_bound_in_any_order_and_as_often_as_one_likes() {
        let mut seed = 9_u32;
        let mut random = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            seed ^ seed >> 15
        };
        for _ in 0..20_000 {
            let [one, other] = [(); 2].map(|()| {
                (
                    [0, 1, 2, ERA, ERA + 1, 2 * ERA][random() as usize % 6],
                    [random() | random(), random() & random()],
                )
            });
            let joined = join(one, other);
            let cells: Vec<u32> = (0..32).map(|k| cell(joined, k)).collect();
            assert_eq!(cells, twin(one, other), "{one:x?} {other:x?}");
            assert_eq!(joined, join(other, one));
            assert_eq!(joined, join(joined, one));
            assert_eq!(joined, join(joined, joined));
            assert!(is_below(one, joined) && is_below(other, joined));
            assert!(
                !is_below(joined, one) || joined == one,
                "the order is antisymmetric"
            );
        }
    }
}

//! The cells that a subiteration deletes, 32 at a time \[GuoHall89\].
//!
//! A set cell with neighbours p2 (north) … p9 (north-west, clockwise) is deleted if
//!
//! ```text
//! C = ¬p2∧(p3∨p4) + ¬p4∧(p5∨p6) + ¬p6∧(p7∨p8) + ¬p8∧(p9∨p2) = 1    one way round
//! 2 ≤ min(N1, N2) ≤ 3,  N1 = (p9∨p2)+(p3∨p4)+(p5∨p6)+(p7∨p8),
//!                       N2 = (p2∨p3)+(p4∨p5)+(p6∨p7)+(p8∨p9)   no end, not inside
//! first subiteration:   (p6∨p7∨¬p9)∧p8 = 0                      in the west, or a corner there
//! second subiteration:  (p2∨p3∨¬p5)∧p4 = 0                      in the east, or a corner there
//! ```
//!
//! Counting with bit masks takes some 70 operations. The conjunction of all conditions is a
//! function of eight bits with few true points. Split by p8 and p4 it takes 31 operations, see
//! [`neighbourhoods_deleted`]; the tests compare it with the definition at all 256 neighbourhoods.
//! The second subiteration is the first one turned by 180°.
//!
//! North is towards row 0, east towards greater columns.

use crate::grid::{Shape, triple};

/// Returns the cells of a word that the first (or second) subiteration deletes.
#[inline(always)]
pub(super) fn deletions<const SECOND: bool>(shape: Shape, words: &[u32], index: u32) -> u32 {
    let (per_row, rows) = (shape.words_per_row() as u32, shape.rows() as u32);
    let row = index / per_row;
    let sides = sides(index - row * per_row, per_row);
    if row.wrapping_sub(1) < rows.wrapping_sub(2)
        && let Some([above, here, below]) = rows_around(per_row, words, index)
    {
        return judge::<SECOND>(above, here, below, sides);
    }
    deletions_at_end::<SECOND>(shape, words, index, sides)
}

/// Returns the three words around an index in each of three rows; `None` where memory ends.
#[inline(always)]
fn rows_around(per_row: u32, words: &[u32], index: u32) -> Option<[&[u32; 3]; 3]> {
    let per_row = per_row as usize;
    // The bound of the type lets the compiler see that the last row's check covers the others.
    let from = usize::from(index as u16).checked_sub(per_row + 1)?;
    let three = |from: usize| words.get(from..from + 3)?.first_chunk::<3>();
    let below = three(from + 2 * per_row)?;
    Some([three(from)?, three(from + per_row)?, below])
}

/// [`deletions`] for a word in the first or the last row, or at an end of memory.
#[inline(never)]
fn deletions_at_end<const SECOND: bool>(
    shape: Shape,
    words: &[u32],
    index: u32,
    sides: u32,
) -> u32 {
    let (index, per_row) = (index as usize, shape.words_per_row());
    let triple = |index: usize| {
        if index < shape.words() {
            triple(words, index)
        } else {
            [0; 3]
        }
    };
    let above = triple(index.wrapping_sub(per_row));
    judge::<SECOND>(&above, &triple(index), &triple(index + per_row), sides)
}

/// The eight neighbours of 32 cells.
#[derive(Clone, Copy, Debug)]
struct Neighbourhood {
    north: u32,
    north_east: u32,
    east: u32,
    south_east: u32,
    south: u32,
    south_west: u32,
    west: u32,
    north_west: u32,
}

/// Returns bit 31 if word `word` of a row has one on its left, and bit 0 if it has one on its
/// right.
#[inline(always)]
const fn sides(word: u32, per_row: u32) -> u32 {
    let (left, right) = (word.wrapping_neg(), (word + 1).wrapping_sub(per_row));
    left & 1 << 31 | right >> 31
}

/// Returns the cells of the middle word that the first (or second) subiteration deletes.
///
/// The words on the left count if bit 31 of `sides` is set, those on the right if bit 0 is. It is
/// not inlined and has few arguments: inlined, it runs out of registers.
#[inline(never)]
fn judge<const SECOND: bool>(
    [above_left, north, above_right]: &[u32; 3],
    [left, here, right]: &[u32; 3],
    [below_left, south, below_right]: &[u32; 3],
    sides: u32,
) -> u32 {
    let (north, here, south) = (*north, *here, *south);
    if here == 0 {
        return 0;
    }
    let (east, west) = (eastern(here, right & sides), western(here, left & sides));
    // A cell with all four sides set has C = 0.
    if here & !(north & south & east & west) == 0 {
        return 0;
    }
    let around = Neighbourhood {
        north,
        north_east: eastern(north, above_right & sides),
        east,
        south_east: eastern(south, below_right & sides),
        south,
        south_west: western(south, below_left & sides),
        west,
        north_west: western(north, above_left & sides),
    };
    here & if SECOND {
        neighbourhoods_deleted(around.turned())
    } else {
        neighbourhoods_deleted(around)
    }
}

/// Returns each cell's eastern neighbour.
#[inline(always)]
const fn eastern(here: u32, right: u32) -> u32 {
    here >> 1 | right << 31
}

/// Returns each cell's western neighbour.
#[inline(always)]
const fn western(here: u32, left: u32) -> u32 {
    here << 1 | left >> 31
}

impl Neighbourhood {
    /// Returns the neighbourhood turned by 180°.
    #[inline(always)]
    const fn turned(self) -> Self {
        Self {
            north: self.south,
            north_east: self.south_west,
            east: self.west,
            south_east: self.north_west,
            south: self.north,
            south_west: self.north_east,
            west: self.east,
            north_west: self.south_east,
        }
    }
}

/// Returns the cells, if set, that the first subiteration deletes.
#[inline(always)]
const fn neighbourhoods_deleted(around: Neighbourhood) -> u32 {
    let Neighbourhood {
        north: n,
        north_east: ne,
        east: e,
        south_east: se,
        south: s,
        south_west: sw,
        west: w,
        north_west: nw,
    } = around;
    let south_sides = s | sw;
    // West clear, east set.
    let turn = s & !nw;
    let without_north = turn | (se & ne & !(nw | sw));
    let with_east = without_north | (n & (turn | !sw));
    // West and east clear: the three cells of one side.
    let three_north = n & nw & ne & !(south_sides | se);
    let three_south = s & se & sw & !(n | nw | ne);
    let without_west = (with_east & e) | ((three_north | three_south) & !e);
    // West set: a north-western corner.
    let with_west = n & nw & !south_sides & (e | !se);
    (with_west & w) | (without_west & !w)
}

#[cfg(test)]
mod tests {
    use super::{Neighbourhood, neighbourhoods_deleted, sides};

    /// The definition term by term; p\[0\] is p2.
    fn deletes(p: [bool; 8], second: bool) -> bool {
        let [p2, p3, p4, p5, p6, p7, p8, p9] = p;
        let c = [
            !p2 && (p3 || p4),
            !p4 && (p5 || p6),
            !p6 && (p7 || p8),
            !p8 && (p9 || p2),
        ];
        let n1 = [p9 || p2, p3 || p4, p5 || p6, p7 || p8];
        let n2 = [p2 || p3, p4 || p5, p6 || p7, p8 || p9];
        let count = |terms: [bool; 4]| terms.into_iter().filter(|t| *t).count();
        let n = count(n1).min(count(n2));
        let m = if second {
            (p2 || p3 || !p5) && p4
        } else {
            (p6 || p7 || !p9) && p8
        };
        count(c) == 1 && (2..=3).contains(&n) && !m
    }

    #[test]
    fn words_at_the_ends_of_a_row_have_one_side() {
        assert_eq!(sides(0, 1), 0);
        assert_eq!([sides(0, 2), sides(1, 2)], [1, 1 << 31]);
        let inner = 1 << 31 | 1;
        assert_eq!([sides(1, 3), sides(15, 31), sides(29, 31)], [inner; 3]);
    }

    #[test]
    fn the_short_form_is_the_definition_at_all_256_neighbourhoods() {
        for code in 0..256_u32 {
            let p = core::array::from_fn(|k| code >> k & 1 == 1);
            let bit = |k: usize| if p[k] { u32::MAX } else { 0 };
            let around = Neighbourhood {
                north: bit(0),
                north_east: bit(1),
                east: bit(2),
                south_east: bit(3),
                south: bit(4),
                south_west: bit(5),
                west: bit(6),
                north_west: bit(7),
            };
            let all = |yes: bool| if yes { u32::MAX } else { 0 };
            assert_eq!(
                neighbourhoods_deleted(around),
                all(deletes(p, false)),
                "first, {code:08b}"
            );
            let turned = neighbourhoods_deleted(around.turned());
            assert_eq!(turned, all(deletes(p, true)), "second, {code:08b}");
        }
    }
}

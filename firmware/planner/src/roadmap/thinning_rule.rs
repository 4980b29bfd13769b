//! The cells that a subiteration deletes, 32 at a time [GuoHall89].
//!
//! A set cell with neighbours p2 (north) … p9 (north-west, clockwise) is deleted when
//!
//! ```text
//! C = ¬p2∧(p3∨p4) + ¬p4∧(p5∨p6) + ¬p6∧(p7∨p8) + ¬p8∧(p9∨p2) = 1        one way round it
//! 2 ≤ min(N1, N2) ≤ 3,  N1 = (p9∨p2)+(p3∨p4)+(p5∨p6)+(p7∨p8),
//!                       N2 = (p2∨p3)+(p4∨p5)+(p6∨p7)+(p8∨p9)            neither an end nor inside
//! first subiteration:   (p6∨p7∨¬p9)∧p8 = 0                              on the west, or a corner there
//! second subiteration:  (p2∨p3∨¬p5)∧p4 = 0                              on the east, or a corner there
//! ```
//!
//! Counting with bit masks takes some 70 operations. The conjunction of all conditions is a function of eight bits with
//! few true points; split by p8 and p4 it takes 31, written out in [`deletions`] and compared with the definition at
//! all 256 neighbourhoods by the tests. The second subiteration is the first one turned by 180°.
//!
//! North is towards row 0, east towards greater columns.

use core::num::NonZeroU32;

use crate::grid::{Region, Shape, triple};

/// Where the words of a region are in its plane.
///
/// Words of the region are counted row by row. All numbers are below 2¹⁶, the most words a plane has.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patch {
    /// Index of the region's first word.
    origin: u32,
    /// Words in a row, less one: zeros are a patch of nothing.
    more_per_row: u32,
    rows: u32,
    /// Words from a row to the next.
    stride: u16,
}

impl Patch {
    /// Of nothing.
    pub(super) const NONE: Self = Self {
        origin: 0,
        more_per_row: 0,
        rows: 0,
        stride: 0,
    };

    pub(super) const fn new(shape: Shape, region: Region) -> Self {
        let stride = shape.words_per_row() as u16;
        let (more_per_row, rows) = match (region.words as u32).checked_sub(1) {
            Some(more) => (more, region.rows as u32),
            None => (0, 0),
        };
        Self {
            origin: region.first_row as u32 * stride as u32 + region.first_word as u32,
            more_per_row,
            rows,
            stride,
        }
    }

    pub(super) const fn words_per_row(&self) -> u32 {
        self.per_row().get()
    }

    const fn per_row(&self) -> NonZeroU32 {
        NonZeroU32::MIN.saturating_add(self.more_per_row)
    }

    /// Words in the region.
    pub(super) const fn size(&self) -> usize {
        (self.rows * self.per_row().get()) as usize
    }

    /// Where word number `count` is in the plane.
    #[inline(always)]
    pub(super) fn index(&self, count: u32) -> usize {
        let gap = u32::from(self.stride) - self.per_row().get();
        (self.origin + count + count / self.per_row() * gap) as usize
    }

    /// The cells of word number `count` that the first (or second) subiteration deletes.
    #[inline(always)]
    pub(super) fn deletions<const SECOND: bool>(&self, words: &[u32], count: u32) -> u32 {
        let row = count / self.per_row();
        let word = count - row * self.per_row().get();
        let sides = sides(word, self.per_row().get());
        let index = self.origin + word + row * u32::from(self.stride);
        if row.wrapping_sub(1) < self.rows.wrapping_sub(2)
            && let Some([above, here, below]) = self.rows_around(words, index)
        {
            return judge::<SECOND>(above, here, below, sides);
        }
        self.deletions_at_end::<SECOND>(words, row, word, sides)
    }

    /// The three words around an index, in three rows; `None` where memory ends.
    #[inline(always)]
    fn rows_around<'a>(&self, words: &'a [u32], index: u32) -> Option<[&'a [u32; 3]; 3]> {
        let stride = usize::from(self.stride);
        // The bound of the type lets the compiler see that the last row's check covers the others.
        let from = usize::from(index as u16).checked_sub(stride + 1)?;
        let three = |from: usize| words.get(from..from + 3)?.first_chunk::<3>();
        let below = three(from + 2 * stride)?;
        Some([three(from)?, three(from + stride)?, below])
    }

    /// The same for a word in the first or the last row, or at an end of memory.
    #[inline(never)]
    fn deletions_at_end<const SECOND: bool>(
        &self,
        words: &[u32],
        row: u32,
        word: u32,
        sides: u32,
    ) -> u32 {
        let triple = |row: u32| {
            if row < self.rows {
                let index = self.origin + word + row * u32::from(self.stride);
                triple(words, index as usize)
            } else {
                [0; 3]
            }
        };
        let above = triple(row.wrapping_sub(1));
        judge::<SECOND>(&above, &triple(row), &triple(row + 1), sides)
    }
}

/// The eight neighbours of 32 cells.
#[derive(Clone, Copy, Debug)]
struct GroundModel {
    north: u32,
    north_east: u32,
    east: u32,
    south_east: u32,
    south: u32,
    south_west: u32,
    west: u32,
    north_west: u32,
}

/// Bit 31 if word `word` of a row has one on its left, bit 0 if it has one on its right.
#[inline(always)]
const fn sides(word: u32, per_row: u32) -> u32 {
    let (left, right) = (word.wrapping_neg(), (word + 1).wrapping_sub(per_row));
    left & 1 << 31 | right >> 31
}

/// The cells of the middle word that the first (or second) subiteration deletes.
///
/// The words on the left count if bit 31 of `sides` is set, those on the right if bit 0 is. A function apart, with few
/// arguments: inlined, it runs out of registers.
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
    let around = GroundModel {
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
        deletions(around.turned())
    } else {
        deletions(around)
    }
}

/// Each cell's eastern neighbour.
#[inline(always)]
const fn eastern(here: u32, right: u32) -> u32 {
    here >> 1 | right << 31
}

/// Each cell's western neighbour.
#[inline(always)]
const fn western(here: u32, left: u32) -> u32 {
    here << 1 | left >> 31
}

impl GroundModel {
    /// Seen from the other side: turned by 180°.
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

/// Where the first subiteration deletes a set cell.
#[inline(always)]
const fn deletions(around: GroundModel) -> u32 {
    let GroundModel {
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
    use super::{GroundModel, deletions, sides};

    /// The definition, word for word; p[0] is p2.
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
            let around = GroundModel {
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
                deletions(around),
                all(deletes(p, false)),
                "first, {code:08b}"
            );
            let turned = deletions(around.turned());
            assert_eq!(turned, all(deletes(p, true)), "second, {code:08b}");
        }
    }
}

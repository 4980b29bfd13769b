//! The cells that a subiteration deletes, 32 at a time [Guo & Hall 1989].
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

use crate::grid::triple;

/// Which neighbours of a word lie outside of what is thinned, and read 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edges {
    pub(super) top: bool,
    pub(super) bottom: bool,
    pub(super) left: bool,
    pub(super) right: bool,
}

/// The eight neighbours of 32 cells.
#[derive(Clone, Copy, Debug)]
struct Around {
    north: u32,
    north_east: u32,
    east: u32,
    south_east: u32,
    south: u32,
    south_west: u32,
    west: u32,
    north_west: u32,
}

/// The cells of word `index` that the first (or second) subiteration deletes, in rows of `per_row` words.
#[inline(always)]
pub(super) fn deletions_at<const SECOND: bool>(
    words: &[u32],
    index: usize,
    per_row: usize,
    edges: Edges,
) -> u32 {
    let [left, here, right] = sides(triple(words, index), edges);
    if here == 0 {
        return 0;
    }
    let [above_left, north, above_right] = if edges.top {
        [0; 3]
    } else {
        sides(triple(words, index - per_row), edges)
    };
    let [below_left, south, below_right] = if edges.bottom {
        [0; 3]
    } else {
        sides(triple(words, index + per_row), edges)
    };
    let (east, west) = (eastern(here, right), western(here, left));
    // A cell with all four sides set has C = 0.
    if here & !(north & south & east & west) == 0 {
        return 0;
    }
    let around = Around {
        north,
        north_east: eastern(north, above_right),
        east,
        south_east: eastern(south, below_right),
        south,
        south_west: western(south, below_left),
        west,
        north_west: western(north, above_left),
    };
    here & if SECOND {
        deletions(around.turned())
    } else {
        deletions(around)
    }
}

#[inline(always)]
fn sides([left, here, right]: [u32; 3], edges: Edges) -> [u32; 3] {
    [
        if edges.left { 0 } else { left },
        here,
        if edges.right { 0 } else { right },
    ]
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

impl Around {
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
const fn deletions(around: Around) -> u32 {
    let Around {
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
    use super::{Around, deletions};

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
    fn the_short_form_is_the_definition_at_all_256_neighbourhoods() {
        for code in 0..256_u32 {
            let p = core::array::from_fn(|k| code >> k & 1 == 1);
            let bit = |k: usize| if p[k] { u32::MAX } else { 0 };
            let around = Around {
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

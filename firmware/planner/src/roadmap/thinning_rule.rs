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

use crate::grid::Block;

/// Returns the cells of word k of a page that the first (or second) subiteration deletes.
pub(super) fn deletions(block: &Block, k: usize, second: bool) -> u32 {
    let here = block.word(k);
    if here == 0 {
        return 0;
    }
    let mut around = block.neighbours(k);
    if second {
        // By 180°: they go round the cell.
        around.rotate_left(4);
    }
    here & neighbourhoods_deleted(around)
}

/// Returns the cells, if set, that the first subiteration deletes, from their neighbours: north,
/// north-east, and so on round.
#[inline(always)]
const fn neighbourhoods_deleted([n, ne, e, se, s, sw, w, nw]: [u32; 8]) -> u32 {
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
    use super::neighbourhoods_deleted;

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
    fn the_short_form_is_the_definition_at_all_256_neighbourhoods() {
        for code in 0..256_u32 {
            let p = core::array::from_fn(|k| code >> k & 1 == 1);
            let bit = |k: usize| if p[k] { u32::MAX } else { 0 };
            let mut around: [u32; 8] = core::array::from_fn(bit);
            let all = |yes: bool| if yes { u32::MAX } else { 0 };
            assert_eq!(
                neighbourhoods_deleted(around),
                all(deletes(p, false)),
                "first, {code:08b}"
            );
            around.rotate_left(4);
            let turned = neighbourhoods_deleted(around);
            assert_eq!(turned, all(deletes(p, true)), "second, {code:08b}");
        }
    }
}

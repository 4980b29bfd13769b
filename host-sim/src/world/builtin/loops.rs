//! Worlds of corridors 2 m wide that close loops, of published sizes: A and B \[Jorge15, IV\], and
//! adjacent loops, nested loops and a floor \[Maffei14\]. The papers give the lengths of the loops;
//! this file chooses their places.
//!
//! A loop runs along the middle of the corridor around a block: a block of w × h metres makes a
//! loop of 2 (w + h) + 8 m.

use super::super::canvas::Canvas;
use super::super::occupancy::{Class, Occupancy};

/// Width of the corridors, metres.
const CORRIDOR_M: f64 = 2.0;
/// Thickness of the outer wall, metres.
const WALL_M: f64 = 0.2;

/// A block: its lower left corner, counted from the inside of the outer wall, and its sides.
type Block = [f64; 4];

/// Four adjacent loops of 44, 46, 58 and 78 m.
const A: [Block; 4] = [
    [2.0, 2.0, 10.0, 8.0],
    [14.0, 2.0, 11.0, 8.0],
    [29.0, 2.0, 3.0, 22.0],
    [2.0, 12.0, 23.0, 12.0],
];

/// Three adjacent loops of 72 m in a row.
const B: [Block; 3] = [
    [2.0, 2.0, 16.0, 16.0],
    [20.0, 2.0, 16.0, 16.0],
    [38.0, 2.0, 16.0, 16.0],
];

/// Three adjacent loops of 72 m, each beside both others.
const ADJACENT: [Block; 3] = [
    [2.0, 2.0, 20.0, 12.0],
    [24.0, 2.0, 20.0, 12.0],
    [13.0, 16.0, 20.0, 12.0],
];

/// The block of a loop of 88 m, and inside of it the block of a loop of 48 m.
const NESTED: [Block; 2] = [[2.0, 2.0, 24.0, 16.0], [7.0, 7.0, 14.0, 6.0]];

/// Blocks of loops of 90 m and 60 m along a floor.
const FLOOR: [Block; 2] = [[9.3, 2.0, 32.0, 9.0], [43.3, 2.0, 17.0, 9.0]];

/// Draws Ouroboros A.
pub(super) fn a() -> Occupancy {
    blocks([34.0, 26.0], &A).finish()
}

/// Draws Ouroboros B.
pub(super) fn b() -> Occupancy {
    blocks([56.0, 20.0], &B).finish()
}

/// Draws the adjacent loops.
pub(super) fn adjacent() -> Occupancy {
    blocks([46.0, 30.0], &ADJACENT).finish()
}

/// Draws the nested loops: a passage through the block of the outer loop leads to the inner one.
pub(super) fn nested() -> Occupancy {
    let mut plan = blocks([28.0, 20.0], &NESTED[..1]);
    ring(&mut plan, NESTED[1]);
    floor(&mut plan, [1.0, 9.0, 7.0, 11.0]);
    plan.finish()
}

/// Draws the floor: at both ends it has a hall with doors to the corridors.
pub(super) fn floor_72() -> Occupancy {
    let mut plan = blocks([72.0, 13.0], &FLOOR);
    floor(&mut plan, [0.0, 2.0, 7.0, 11.0]);
    floor(&mut plan, [6.9, 5.9, 7.4, 7.1]);
    floor(&mut plan, [62.6, 0.0, 72.0, 8.0]);
    floor(&mut plan, [62.2, 3.4, 62.7, 4.6]);
    floor(&mut plan, [64.0, 8.3, 72.0, 13.0]);
    floor(&mut plan, [67.0, 7.9, 68.0, 8.4]);
    plan.finish()
}

/// A plan of this inner size: all wall, except for the corridors around the blocks.
fn blocks([width, height]: [f64; 2], blocks: &[Block]) -> Canvas {
    let around = 2.0 * WALL_M;
    let mut plan = Canvas::new(width + around, height + around, Class::Wall);
    for &[x, y, w, h] in blocks {
        let c = CORRIDOR_M;
        floor(&mut plan, [x - c, y - c, x + w + c, y + h + c]);
    }
    for block in blocks {
        stand(&mut plan, *block);
    }
    plan
}

/// A corridor around a block.
fn ring(plan: &mut Canvas, [x, y, w, h]: Block) {
    let c = CORRIDOR_M;
    floor(plan, [x - c, y - c, x + w + c, y + h + c]);
    stand(plan, [x, y, w, h]);
}

fn stand(plan: &mut Canvas, [x, y, w, h]: Block) {
    plan.block([x, y, x + w, y + h].map(|m| m + WALL_M));
}

fn floor(plan: &mut Canvas, corners: [f64; 4]) {
    plan.floor(corners.map(|m| m + WALL_M));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_loops_have_their_published_lengths() {
        let length = |[_, _, w, h]: &Block| (2.0 * (w + h) + 4.0 * CORRIDOR_M).round() as u32;
        assert_eq!(A.each_ref().map(length), [44, 46, 58, 78]);
        assert_eq!(B.each_ref().map(length), [72; 3]);
        assert_eq!(ADJACENT.each_ref().map(length), [72; 3]);
        assert_eq!(NESTED.each_ref().map(length), [88, 48]);
        assert_eq!(FLOOR.each_ref().map(length), [90, 60]);
    }

    /// A corridor between blocks is as wide as one along the outer wall, so two loops side by side
    /// share it.
    #[test]
    fn blocks_are_one_corridor_apart() {
        for blocks in [&A[..], &B, &ADJACENT, &FLOOR] {
            for (k, one) in blocks.iter().enumerate() {
                for other in &blocks[k + 1..] {
                    let gap = |low: usize| {
                        let first = if one[low] < other[low] { one } else { other };
                        one[low].max(other[low]) - first[low] - first[low + 2]
                    };
                    let apart = gap(0).max(gap(1));
                    assert!(apart >= CORRIDOR_M - 1e-9, "{one:?} {other:?}: {apart}");
                }
            }
        }
    }
}

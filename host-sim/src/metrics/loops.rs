//! Closed loops: how many of the world's loops the robot drove all the way round, on its true path.
//!
//! A loop goes round an *island*: an 8-connected set of cells that the robot's centre cannot reach,
//! and that does not touch the world's border. It counts if the perimeter of the island's bounding
//! box is at least [`LEAST_M`]. The loop is closed if the angle of the path about a cell of the
//! island, full turns included, has spanned
//!
//! ```text
//! max φ − min φ ≥ 0.97 · 2π
//! ```
//!
//! Between the two extremes the robot went round the island and came back, except for the last 3 %:
//! the planner recognises a place from 1 m away. The island is connected and the path never enters
//! it, so any of its cells serves; the one nearest to the middle is used.

use core::f64::consts::TAU;

use super::CellSet;
use crate::world::{GridCell, World};

/// Least perimeter of an island's bounding box for its loop to count, metres.
pub const LEAST_M: f64 = 10.0;
/// Share of a turn that closes a loop.
const CLOSED: f64 = 0.97;

/// Loops of a world, and those that a path closed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Loops {
    /// Number of loops of the world.
    pub of: u32,
    /// Number of loops that the robot closed.
    pub closed: u32,
}

impl Loops {
    /// Counts the loops of `world` around islands in `reach`, and those that a path of points x, y
    /// closes.
    #[must_use]
    pub fn judge(world: &World, reach: &CellSet, path: &[[f64; 2]]) -> Self {
        let islands = islands(world, reach);
        let closed = islands.iter().filter(|middle| is_round(**middle, path));
        Self {
            closed: closed.count() as u32,
            of: islands.len() as u32,
        }
    }
}

/// Returns true if a path goes round a point.
fn is_round([x0, y0]: [f64; 2], path: &[[f64; 2]]) -> bool {
    let mut bearings = path.iter().map(|[x, y]| (y - y0).atan2(x - x0));
    let Some(mut last) = bearings.next() else {
        return false;
    };
    let (mut turned, mut least, mut most) = (0.0, 0.0_f64, 0.0_f64);
    for bearing in bearings {
        let turn = bearing - last;
        turned += turn - (turn / TAU).round() * TAU;
        (least, most) = (least.min(turned), most.max(turned));
        last = bearing;
    }
    most - least >= CLOSED * TAU
}

/// One cell of each island whose loop counts.
fn islands(world: &World, reach: &CellSet) -> Vec<[f64; 2]> {
    let grid = world.occupancy();
    let (width, height) = (grid.width() as i64, grid.height() as i64);
    let mut seen = vec![false; grid.width() * grid.height()];
    let mut islands = Vec::new();
    for (j, i) in (0..height).flat_map(|j| (0..width).map(move |i| (j, i))) {
        let piece = piece(world, reach, GridCell { i, j }, &mut seen);
        let span = |along: fn(&GridCell) -> i64| {
            let least = piece.iter().map(along).min().unwrap_or(0);
            (least, piece.iter().map(along).max().unwrap_or(0))
        };
        let ((west, east), (south, north)) = (span(|cell| cell.i), span(|cell| cell.j));
        let inside = west > 0 && south > 0 && east < width - 1 && north < height - 1;
        let around_m = 2.0 * ((east - west + north - south + 2) as f64) * grid.resolution_m();
        if inside && around_m >= LEAST_M {
            let off_middle = |cell: &&GridCell| {
                let (di, dj) = (2 * cell.i - west - east, 2 * cell.j - south - north);
                di * di + dj * dj
            };
            islands.extend(
                piece
                    .iter()
                    .min_by_key(off_middle)
                    .map(|cell| grid.centre(*cell)),
            );
        }
    }
    islands
}

/// The unreachable cells that are connected with a cell; empty if they were seen before.
fn piece(world: &World, reach: &CellSet, from: GridCell, seen: &mut [bool]) -> Vec<GridCell> {
    let grid = world.occupancy();
    let mut piece = Vec::new();
    let mut waiting = vec![from];
    while let Some(cell) = waiting.pop() {
        let Some(index) = grid.index(cell).filter(|index| !seen[*index]) else {
            continue;
        };
        if reach.contains(cell) {
            continue;
        }
        seen[index] = true;
        piece.push(cell);
        waiting.extend((-1..=1).flat_map(|dj| {
            (-1..=1).map(move |di| GridCell {
                i: cell.i + di,
                j: cell.j + dj,
            })
        }));
    }
    piece
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::RADIUS_M;

    fn judged(world: &str, corners: &[[f64; 2]]) -> (u32, u32) {
        let world = World::builtin(world).expect("built in");
        let reach = CellSet::reach(&world, world.starts()[0], RADIUS_M);
        let path: Vec<[f64; 2]> = corners
            .windows(2)
            .flat_map(|pair| {
                let ([x0, y0], [x1, y1]) = (pair[0], pair[1]);
                (0..100).map(move |k| {
                    let t = f64::from(k) / 100.0;
                    [x0 + t * (x1 - x0), y0 + t * (y1 - y0)]
                })
            })
            .collect();
        let loops = Loops::judge(&world, &reach, &path);
        (loops.closed, loops.of)
    }

    #[test]
    fn a_ring_is_closed_by_driving_all_the_way_round() {
        let round = [
            [3.0, 1.1],
            [19.3, 1.1],
            [19.3, 15.3],
            [1.1, 15.3],
            [1.1, 1.1],
            [3.0, 1.1],
        ];
        assert_eq!(judged("loop", &round), (1, 1));
        let mut short = round[..4].to_vec();
        short.push([1.1, 4.0]);
        assert_eq!(judged("loop", &short), (0, 1), "a corner is missing");
        // To every corner and back again.
        let mut back = round[..4].to_vec();
        back.extend(round[..4].iter().rev());
        assert_eq!(judged("loop", &back), (0, 1));
        // One half in one direction, back, and the other half in the other direction.
        let halves = [[10.0, 1.1], [19.3, 1.1], [19.3, 15.3], [10.0, 15.3]];
        let mut halves = halves.to_vec();
        halves.extend([
            [19.3, 15.3],
            [19.3, 1.1],
            [1.1, 1.1],
            [1.1, 15.3],
            [10.0, 15.3],
        ]);
        assert_eq!(judged("loop", &halves), (1, 1));
    }

    #[test]
    fn a_world_without_islands_has_no_loops() {
        assert_eq!(judged("empty-hall", &[[2.0, 2.0], [9.0, 9.0]]), (0, 0));
    }
}

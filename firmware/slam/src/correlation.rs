//! The correlative search: at which shift and turn do most ends of a scan lie on walls?
//!
//! ```text
//! score(dx, dy, turn) = Σ over ends of near(end + (dx, dy))     near: on a wall 4, beside 2, at a corner 1
//! ```
//!
//! Two stages. A coarse plane holds the greatest `near` of the 4 × 4 cells that begin at a cell, so
//! its score bounds all 16 shifts of a block: blocks that cannot beat the best are left out. Turns
//! go from the middle outwards, and the first of equal scores is taken.
//!
//! Units: cells of 10 cm, radians.

use crate::grid::{CELL_M, Frame, Grid, cell};
use crate::pose::Pose;
use crate::scan::Scan;

/// From one turn to the next, radians: a cell at 8 m.
const TURN_RAD: f32 = 0.012;
/// Cells along a block.
const BLOCK: i32 = 4;
/// Points of an end on a wall.
const ON: u8 = 4;
/// Fewest ends of a scan that is searched.
const LEAST_ENDS: usize = 20;
/// Ends that are enough for a search.
const ENDS: usize = 90;
/// Least share of all points.
const LEAST_SHARE: f32 = 0.5;

/// The planes of a search: points of each cell, and the most of a block that begins at it.
#[derive(Clone, Debug)]
pub struct Planes<const SIDE: usize> {
    fine: [[u8; SIDE]; SIDE],
    coarse: [[u8; SIDE]; SIDE],
    origin: (i32, i32),
}

/// How far to search.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach {
    pub(crate) way_m: f32,
    pub(crate) turn_rad: f32,
}

impl<const SIDE: usize> Planes<SIDE> {
    /// Returns empty planes.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            fine: [[0; SIDE]; SIDE],
            coarse: [[0; SIDE]; SIDE],
            origin: (0, 0),
        }
    }

    /// Reads the walls of a grid.
    fn read(&mut self, grid: &Grid<SIDE>, middle: &Pose) {
        let half = SIDE as i32 / 2;
        self.origin = (cell(middle.x_m) - half, cell(middle.y_m) - half);
        self.fine.as_flattened_mut().fill(0);
        let last = SIDE as i32 - 1;
        for (y, x) in (1..last).flat_map(|y| (1..last).map(move |x| (y, x))) {
            if grid.is_occupied(self.origin.0 + x, self.origin.1 + y) {
                for (dy, dx) in (-1..=1).flat_map(|dy: i32| (-1..=1).map(move |dx: i32| (dy, dx))) {
                    let points = ON >> (dx.abs() + dy.abs());
                    if let Some(near) = get_mut(&mut self.fine, x + dx, y + dy) {
                        *near = (*near).max(points);
                    }
                }
            }
        }
        self.coarsen();
    }

    /// Makes the coarse plane: first the most of four columns, then of four rows.
    fn coarsen(&mut self) {
        for (out, row) in self.coarse.iter_mut().zip(&self.fine) {
            for (x, out) in out.iter_mut().enumerate() {
                let four = row.iter().skip(x).take(BLOCK as usize);
                *out = four.copied().max().unwrap_or(0);
            }
        }
        for y in 0..SIDE {
            let (_, below) = self.coarse.split_at_mut(y);
            if let Some((row, after)) = below.split_first_mut() {
                for other in after.iter().take(BLOCK as usize - 1) {
                    for (out, other) in row.iter_mut().zip(other) {
                        *out = (*out).max(*other);
                    }
                }
            }
        }
    }

    /// Returns the pose around `middle` at which most ends of a scan lie on walls of a grid; `None`
    /// if fewer than half of all points are reached anywhere.
    pub(crate) fn search<const BEAMS: usize>(
        &mut self,
        grid: &Grid<SIDE>,
        scan: &Scan<BEAMS>,
        middle: &Pose,
        reach: Reach,
    ) -> Option<Pose> {
        let hits = scan.hits().count();
        if hits < LEAST_ENDS {
            return None;
        }
        self.read(grid, middle);
        let stride = (hits / ENDS).max(1);
        let most = u32::from(ON) * hits.div_ceil(stride) as u32;
        let mut best = (0, *middle);
        let turns = libm::ceilf(reach.turn_rad / TURN_RAD) as i32;
        let cells = libm::ceilf(reach.way_m / CELL_M) as i32;
        for k in 0..=2 * turns {
            let turn = if k % 2 == 0 { k / 2 } else { -(k + 1) / 2 };
            let pose = Pose {
                yaw_rad: middle.yaw_rad + turn as f32 * TURN_RAD,
                ..*middle
            };
            self.search_turn(scan, stride, &pose, cells, &mut best);
        }
        (best.0 as f32 >= LEAST_SHARE * most as f32).then_some(best.1)
    }

    /// Searches all shifts of one turn.
    fn search_turn<const BEAMS: usize>(
        &self,
        scan: &Scan<BEAMS>,
        stride: usize,
        pose: &Pose,
        cells: i32,
        best: &mut (u32, Pose),
    ) {
        let frame = Frame::of(pose);
        let mut ends: heapless::Vec<(i32, i32), BEAMS> = heapless::Vec::new();
        for beam in scan.hits().step_by(stride) {
            let [x_m, y_m] = frame.point(beam.end);
            // There is room for each beam of the scan.
            let _ = ends.push((cell(x_m) - self.origin.0, cell(y_m) - self.origin.1));
        }
        let blocks = || (-cells..=cells).step_by(BLOCK as usize);
        for (y, x) in blocks().flat_map(|y| blocks().map(move |x| (y, x))) {
            if score(&self.coarse, &ends, x, y) <= best.0 {
                continue;
            }
            for (dy, dx) in (0..BLOCK).flat_map(|dy| (0..BLOCK).map(move |dx| (dy, dx))) {
                let points = score(&self.fine, &ends, x + dx, y + dy);
                if points > best.0 {
                    let at = Pose {
                        x_m: pose.x_m + (x + dx) as f32 * CELL_M,
                        y_m: pose.y_m + (y + dy) as f32 * CELL_M,
                        ..*pose
                    };
                    *best = (points, at);
                }
            }
        }
    }
}

impl<const SIDE: usize> Default for Planes<SIDE> {
    fn default() -> Self {
        Self::new()
    }
}

/// Returns the points of shifted ends.
fn score<const SIDE: usize>(
    plane: &[[u8; SIDE]; SIDE],
    ends: &[(i32, i32)],
    dx: i32,
    dy: i32,
) -> u32 {
    let points = ends.iter().map(|&(x, y)| {
        let row = plane.get((y + dy) as usize);
        row.and_then(|row| row.get((x + dx) as usize))
            .map_or(0, |&points| u32::from(points))
    });
    points.sum()
}

fn get_mut<const SIDE: usize>(plane: &mut [[u8; SIDE]; SIDE], x: i32, y: i32) -> Option<&mut u8> {
    plane.get_mut(y as usize)?.get_mut(x as usize)
}

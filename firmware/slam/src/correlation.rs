//! The correlative search: at which shift and turn do most ends of a scan lie on walls?
//!
//! ```text
//! score(dx, dy, turn) = Σ over ends of near(end + (dx, dy))
//! near                = 4 on a wall, 2 beside one, 1 at its corner
//! ```
//!
//! Two stages. A coarse plane holds the greatest `near` of the 4 × 4 cells that begin at a cell, so
//! its score bounds all 16 shifts of a block: blocks that cannot beat the best are left out. Turns
//! go from the middle outwards, and the first of equal scores is taken.
//!
//! Units: cells of 10 cm, radians.

use heapless::Vec;

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
/// Another place fits if it has so great a share of the best one's points, and lies farther off
/// than so many cells.
const ALIKE: f32 = 0.9;
const ELSEWHERE: i32 = 5;

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

/// The place of a search among those that fit nearly as well.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Alike {
    pub(crate) pose: Pose,
    /// No place elsewhere fits.
    pub(crate) is_only: bool,
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
        let cells = reach.cells();
        for pose in reach.turns(middle) {
            let ends = self.ends(scan, stride, &pose);
            for (x, y) in blocks(cells) {
                if score(&self.coarse, &ends, x, y) > best.0 {
                    self.search_block(&ends, (x, y), &pose, &mut best);
                }
            }
        }
        (best.0 as f32 >= LEAST_SHARE * most as f32).then_some(best.1)
    }

    /// Returns the place nearest to `middle` that fits nearly as well as the one that the last
    /// search found: that one itself, if it is the only one.
    pub(crate) fn nearest_alike<const BEAMS: usize>(
        &self,
        scan: &Scan<BEAMS>,
        middle: &Pose,
        reach: Reach,
        found: &Pose,
    ) -> Alike {
        let stride = (scan.hits().count() / ENDS).max(1);
        let ends = self.ends(scan, stride, found);
        let enough = (ALIKE * score(&self.fine, &ends, 0, 0) as f32) as u32;
        let off = |at: f32, from: f32| cell(at) - cell(from);
        let own = (off(found.x_m, middle.x_m), off(found.y_m, middle.y_m));
        let mut nearest = (own.0 * own.0 + own.1 * own.1, *found);
        let mut is_only = true;
        let cells = reach.cells();
        for pose in reach.turns(middle) {
            let ends = self.ends(scan, stride, &pose);
            let alike = |&(x, y): &(i32, i32)| score(&self.coarse, &ends, x, y) > enough;
            for (x, y) in blocks(cells).filter(alike) {
                for (x, y) in block().map(|(dx, dy)| (x + dx, y + dy)) {
                    if score(&self.fine, &ends, x, y) <= enough {
                        continue;
                    }
                    is_only &= (x - own.0).abs().max((y - own.1).abs()) <= ELSEWHERE;
                    if x * x + y * y < nearest.0 {
                        nearest = (x * x + y * y, shifted(&pose, (x, y)));
                    }
                }
            }
        }
        Alike {
            pose: if is_only { *found } else { nearest.1 },
            is_only,
        }
    }

    /// Returns the cells of a scan's ends in the planes.
    fn ends<const BEAMS: usize>(
        &self,
        scan: &Scan<BEAMS>,
        stride: usize,
        pose: &Pose,
    ) -> Vec<(i32, i32), BEAMS> {
        let frame = Frame::of(pose);
        let ends = scan.hits().step_by(stride).map(|beam| {
            let [x_m, y_m] = frame.point(beam.end);
            (cell(x_m) - self.origin.0, cell(y_m) - self.origin.1)
        });
        ends.collect()
    }

    /// Searches the shifts of a block.
    fn search_block(
        &self,
        ends: &[(i32, i32)],
        (x, y): (i32, i32),
        pose: &Pose,
        best: &mut (u32, Pose),
    ) {
        for (dx, dy) in block() {
            let points = score(&self.fine, ends, x + dx, y + dy);
            if points > best.0 {
                *best = (points, shifted(pose, (x + dx, y + dy)));
            }
        }
    }
}

impl Reach {
    fn cells(self) -> i32 {
        libm::ceilf(self.way_m / CELL_M) as i32
    }

    /// Returns a pose at each turn, from the middle outwards.
    fn turns(self, middle: &Pose) -> impl Iterator<Item = Pose> {
        let turns = libm::ceilf(self.turn_rad / TURN_RAD) as i32;
        (0..=2 * turns).map(move |k| {
            let turn = if k % 2 == 0 { k / 2 } else { -(k + 1) / 2 };
            Pose {
                yaw_rad: middle.yaw_rad + turn as f32 * TURN_RAD,
                ..*middle
            }
        })
    }
}

fn shifted(pose: &Pose, (x, y): (i32, i32)) -> Pose {
    Pose {
        x_m: pose.x_m + x as f32 * CELL_M,
        y_m: pose.y_m + y as f32 * CELL_M,
        ..*pose
    }
}

/// Returns the blocks of the shifts that a search takes.
fn blocks(cells: i32) -> impl Iterator<Item = (i32, i32)> {
    let steps = move || (-cells..=cells).step_by(BLOCK as usize);
    steps().flat_map(move |y| steps().map(move |x| (x, y)))
}

/// Returns the shifts of a block.
fn block() -> impl Iterator<Item = (i32, i32)> {
    (0..BLOCK).flat_map(|dy| (0..BLOCK).map(move |dx| (dx, dy)))
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

//! The ground that the robot covers: a rectangle or a disc, tested exactly against the world's
//! solid cells.
//!
//! The nearest points of two convex shapes that do not overlap include a corner of one of them,
//! so the gap between the rectangle and a cell is the least over the eight corners. The shapes
//! overlap unless one of their four edge directions separates them. The distance field only skips
//! the test where nothing can be near.
//!
//! The rectangle of a leaning robot is the shadow of its box: the bottom corners move in and the
//! top corners move out. A leaning disc covers the disc around that shadow's middle which has half
//! of its longer side as radius. Walls count as higher than the robot. Metres.

use super::other::OtherRobot;
use super::pose::{PlanarFrame, Pose};
use crate::world::{GridCell, World};

/// Greatest clearance that is measured, metres.
pub const FARTHEST_M: f64 = 1.0;

/// A rectangle around the robot's centre, or a disc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footprint {
    /// Half its length, along the heading, metres.
    pub half_length_m: f64,
    /// Half its width, metres.
    pub half_width_m: f64,
    /// Height of the body over that rectangle, metres.
    pub height_m: f64,
    /// True for the disc in the rectangle, which is then a square.
    pub is_round: bool,
}

/// The rectangle at a pose, with its centre as the origin of its frame.
#[derive(Clone, Copy)]
struct Placed {
    half: [f64; 2],
    frame: PlanarFrame,
    /// Radius of the disc that takes the rectangle's place.
    radius_m: Option<f64>,
}

impl Footprint {
    /// The Pioneer 3-AT: 0.508 m long, 0.497 m wide, its deck 0.277 m high.
    pub const PIONEER_3AT: Self = Self::rectangle(0.508, 0.497, 0.277);

    /// A rectangle of this length and width under a body of this height, metres.
    #[must_use]
    pub const fn rectangle(length_m: f64, width_m: f64, height_m: f64) -> Self {
        Self {
            half_length_m: 0.5 * length_m,
            half_width_m: 0.5 * width_m,
            height_m,
            is_round: false,
        }
    }

    /// A disc of this radius under a body of this height, metres.
    #[must_use]
    pub const fn disc(radius_m: f64, height_m: f64) -> Self {
        Self {
            half_length_m: radius_m,
            half_width_m: radius_m,
            height_m,
            is_round: true,
        }
    }

    /// Distance from the centre to the farthest point of the outline, metres.
    #[must_use]
    pub fn circumradius_m(&self) -> f64 {
        if self.is_round {
            return self.half_length_m;
        }
        (self.half_length_m * self.half_length_m + self.half_width_m * self.half_width_m).sqrt()
    }

    /// Returns true if the footprint overlaps a solid cell.
    #[must_use]
    pub fn overlaps(&self, world: &World, pose: &Pose) -> bool {
        let reach_m = self.reach_m(pose);
        let cell = world.occupancy().cell_at(pose.x_m, pose.y_m);
        if world.distance().from_anywhere_m(cell) > reach_m {
            return false;
        }
        let placed = self.place(pose);
        solid_cells(world, pose, reach_m).any(|square| placed.overlaps(square))
    }

    /// Metres between the footprint's outline and the nearest solid cell: 0 if they overlap, and at
    /// most [`FARTHEST_M`].
    #[must_use]
    pub fn clearance_m(&self, world: &World, pose: &Pose) -> f64 {
        let placed = self.place(pose);
        let mut nearest_m = FARTHEST_M;
        for square in solid_cells(world, pose, FARTHEST_M + self.reach_m(pose)) {
            if placed.overlaps(square) {
                return 0.0;
            }
            nearest_m = nearest_m.min(placed.gap_m(square));
        }
        nearest_m
    }

    /// Returns true if the footprint overlaps no solid cell while it turns on the spot all the way
    /// round, on level ground: its corners sweep a circle.
    #[must_use]
    pub fn can_turn(&self, world: &World, pose: &Pose) -> bool {
        let radius_m = self.circumradius_m();
        let middle = [pose.x_m, pose.y_m];
        solid_cells(world, pose, radius_m).all(|square| point_to_box(middle, square) >= radius_m)
    }

    /// A lower bound of [`Self::clearance_m`] for the cost of one look-up.
    #[must_use]
    pub fn clearance_bound_m(&self, world: &World, pose: &Pose) -> f64 {
        let cell = world.occupancy().cell_at(pose.x_m, pose.y_m);
        world.distance().from_anywhere_m(cell) - self.reach_m(pose)
    }

    /// Returns true if the footprint at a pose overlaps another robot's.
    #[must_use]
    pub fn touches(&self, pose: &Pose, other: &OtherRobot) -> bool {
        let reach_m = self.reach_m(pose) + other.footprint().reach_m(other.pose());
        if pose.distance_m(other.pose()) > reach_m {
            return false;
        }
        self.place(pose)
            .meets(&other.footprint().place(other.pose()))
    }

    /// Metres between the footprints of two robots, seen from above: 0 if they overlap, and at
    /// most [`FARTHEST_M`].
    #[must_use]
    pub fn gap_m(&self, pose: &Pose, other: &OtherRobot) -> f64 {
        let reach_m = self.reach_m(pose) + other.footprint().reach_m(other.pose());
        if pose.distance_m(other.pose()) > reach_m + FARTHEST_M {
            return FARTHEST_M;
        }
        let placed = self.place(pose);
        let theirs = other.footprint().place(other.pose());
        if placed.meets(&theirs) {
            return 0.0;
        }
        placed
            .between_m(&theirs)
            .min(theirs.between_m(&placed))
            .min(FARTHEST_M)
    }

    /// The gap from the hull at a pose to a disc, seen from above; 0 if they overlap.
    #[must_use]
    pub fn gap_to_disc_m(&self, pose: &Pose, middle_m: [f64; 2], radius_m: f64) -> f64 {
        (self.place(pose).off_m(middle_m) - radius_m).max(0.0)
    }

    /// The part of a ray from `from` along `(ahead, left)` that lies over the hull of a robot on
    /// level ground: its beginning and its end, in lengths of that vector; `None` if it passes by.
    #[must_use]
    pub fn crossing_m(&self, from: [f64; 2], along: [f64; 2]) -> Option<[f64; 2]> {
        let [enter, leave] = if self.is_round {
            disc_crossing(self.half_length_m, from, along)?
        } else {
            let halves = [self.half_length_m, self.half_width_m];
            box_crossing(halves, from, along)?
        };
        (leave >= 0.0).then_some([enter.max(0.0), leave])
    }

    /// Distance from the pose to the farthest corner of the shadow, or more, metres.
    fn reach_m(&self, pose: &Pose) -> f64 {
        if pose.pitch_rad == 0.0 && pose.roll_rad == 0.0 {
            return self.circumradius_m();
        }
        // That of the box, also for a disc: it is only a bound.
        let [[x0, x1], [y0, y1]] = self.shadow(pose);
        let (a, b) = (x1.max(-x0), y1.max(-y0));
        (a * a + b * b).sqrt()
    }

    /// Extent of the leaning box's shadow along the heading and across it, `[least, greatest]`,
    /// metres.
    ///
    /// A corner (±a, ±b, 0 or h) of the box lies, with `Ry(pitch) Rx(roll)`, at
    /// `x = ±a cos p ± b sin p sin r + h sin p cos r` and `y = ±b cos r − h sin r`.
    fn shadow(&self, pose: &Pose) -> [[f64; 2]; 2] {
        let (cos_p, sin_p) = (libm::cos(pose.pitch_rad), libm::sin(pose.pitch_rad));
        let (cos_r, sin_r) = (libm::cos(pose.roll_rad), libm::sin(pose.roll_rad));
        let along = self.half_length_m * cos_p + self.half_width_m * (sin_p * sin_r).abs();
        let across = self.half_width_m * cos_r;
        let nose = self.height_m * sin_p * cos_r;
        let lean = -self.height_m * sin_r;
        [
            [nose.min(0.0) - along, nose.max(0.0) + along],
            [lean.min(0.0) - across, lean.max(0.0) + across],
        ]
    }

    fn place(&self, pose: &Pose) -> Placed {
        let [[x0, x1], [y0, y1]] = self.shadow(pose);
        let (x, y) = (0.5 * (x0 + x1), 0.5 * (y0 + y1));
        let half = [0.5 * (x1 - x0), 0.5 * (y1 - y0)];
        Placed {
            half,
            frame: pose.planar_frame().shifted([x, y]),
            radius_m: self.is_round.then(|| half[0].max(half[1])),
        }
    }
}

/// Where a ray enters and leaves a disc around the origin.
pub(super) fn disc_crossing(radius_m: f64, from: [f64; 2], along: [f64; 2]) -> Option<[f64; 2]> {
    let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
    let (square, half) = (dot(along, along), dot(from, along));
    let outside = dot(from, from) - radius_m * radius_m;
    if square == 0.0 {
        return (outside <= 0.0).then_some([f64::NEG_INFINITY, f64::INFINITY]);
    }
    let root = half * half - square * outside;
    (root >= 0.0).then(|| [-root.sqrt(), root.sqrt()].map(|root| (root - half) / square))
}

/// Where a ray enters and leaves a rectangle around the origin.
fn box_crossing(halves: [f64; 2], from: [f64; 2], along: [f64; 2]) -> Option<[f64; 2]> {
    let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
    for (half, (from, along)) in halves.into_iter().zip(from.into_iter().zip(along)) {
        if along == 0.0 {
            if from.abs() > half {
                return None;
            }
            continue;
        }
        let ends = [-half, half].map(|side| (side - from) / along);
        enter = enter.max(ends[0].min(ends[1]));
        leave = leave.min(ends[0].max(ends[1]));
    }
    (enter <= leave).then_some([enter, leave])
}

impl Placed {
    /// The rectangle's corners in the world.
    fn corners(&self) -> [[f64; 2]; 4] {
        let [a, b] = self.half;
        [[a, b], [-a, b], [-a, -b], [a, -b]].map(|corner| self.frame.to_world(corner))
    }

    /// Distance from a point to the shape; 0 inside.
    fn off_m(&self, point: [f64; 2]) -> f64 {
        let ([a, b], local) = (self.half, self.frame.to_local(point));
        match self.radius_m {
            Some(radius_m) => {
                (local[0] * local[0] + local[1] * local[1])
                    .sqrt()
                    .max(radius_m)
                    - radius_m
            }
            None => point_to_box(local, [-a, -b, a, b]),
        }
    }

    /// The gap to another shape if one of them is a disc, negative if they overlap.
    fn disc_gap_m(&self, other: &Self) -> Option<f64> {
        let middle = other.frame.to_world([0.0; 2]);
        match (self.radius_m, other.radius_m) {
            (None, None) => None,
            (_, Some(radius_m)) => Some(self.off_m(middle) - radius_m),
            (Some(_), None) => other.disc_gap_m(self),
        }
    }

    /// Returns true if no edge direction of either shape separates them.
    fn overlaps(&self, [x0, y0, x1, y1]: [f64; 4]) -> bool {
        if let Some(radius_m) = self.radius_m {
            let middle = self.frame.to_world([0.0; 2]);
            return point_to_box(middle, [x0, y0, x1, y1]) < radius_m;
        }
        let corners = self.corners();
        let (low, high) = spread(corners.map(|c| c[0]));
        if high <= x0 || low >= x1 {
            return false;
        }
        let (low, high) = spread(corners.map(|c| c[1]));
        if high <= y0 || low >= y1 {
            return false;
        }
        let square = square_corners([x0, y0, x1, y1]).map(|c| self.frame.to_local(c));
        (0..2).all(|axis| {
            let (low, high) = spread(square.map(|c| c[axis]));
            high > -self.half[axis] && low < self.half[axis]
        })
    }

    /// Returns true if no edge direction of either rectangle separates them.
    fn meets(&self, other: &Self) -> bool {
        if let Some(gap_m) = self.disc_gap_m(other) {
            return gap_m < 0.0;
        }
        let parted = |by: &Self, corners: [[f64; 2]; 4]| {
            let local = corners.map(|corner| by.frame.to_local(corner));
            (0..2).any(|axis| {
                let (low, high) = spread(local.map(|corner| corner[axis]));
                high <= -by.half[axis] || low >= by.half[axis]
            })
        };
        !parted(self, other.corners()) && !parted(other, self.corners())
    }

    /// Least distance from a corner of another rectangle to this one.
    fn between_m(&self, other: &Self) -> f64 {
        if let Some(gap_m) = self.disc_gap_m(other) {
            return gap_m;
        }
        let [a, b] = self.half;
        let corners = other.corners().map(|corner| self.frame.to_local(corner));
        let gaps = corners.map(|corner| point_to_box(corner, [-a, -b, a, b]));
        gaps.into_iter().fold(f64::INFINITY, f64::min)
    }

    /// Distance between shapes that do not overlap.
    fn gap_m(&self, square: [f64; 4]) -> f64 {
        let [x0, y0, x1, y1] = square;
        let [a, b] = self.half;
        if let Some(radius_m) = self.radius_m {
            return point_to_box(self.frame.to_world([0.0; 2]), square) - radius_m;
        }
        let to_rectangle = square_corners(square)
            .map(|corner| point_to_box(self.frame.to_local(corner), [-a, -b, a, b]));
        let to_square = self.corners().map(|c| point_to_box(c, [x0, y0, x1, y1]));
        to_rectangle
            .into_iter()
            .chain(to_square)
            .fold(f64::INFINITY, f64::min)
    }
}

/// The least and the greatest of four numbers.
fn spread(values: [f64; 4]) -> (f64, f64) {
    values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
            (low.min(*v), high.max(*v))
        })
}

fn square_corners([x0, y0, x1, y1]: [f64; 4]) -> [[f64; 2]; 4] {
    [[x0, y0], [x1, y0], [x1, y1], [x0, y1]]
}

fn point_to_box([x, y]: [f64; 2], [x0, y0, x1, y1]: [f64; 4]) -> f64 {
    let dx = (x0 - x).max(x - x1).max(0.0);
    let dy = (y0 - y).max(y - y1).max(0.0);
    (dx * dx + dy * dy).sqrt()
}

/// Solid cells, as [x0, y0, x1, y1], that come within `reach_m` of a pose along both axes.
fn solid_cells(world: &World, pose: &Pose, reach_m: f64) -> impl Iterator<Item = [f64; 4]> {
    let grid = world.occupancy();
    let low = grid.cell_at(pose.x_m - reach_m, pose.y_m - reach_m);
    let high = grid.cell_at(pose.x_m + reach_m, pose.y_m + reach_m);
    (low.j..=high.j)
        .flat_map(move |j| (low.i..=high.i).map(move |i| GridCell { i, j }))
        .filter(|cell| grid.is_solid(*cell))
        .map(|cell| {
            let [x, y] = grid.centre(cell);
            let half = 0.5 * grid.resolution_m();
            [x - half, y - half, x + half, y + half]
        })
}

#[cfg(test)]
mod tests;

//! The survey: both scans into the elevation window, as heights, obstacles and drops.
//!
//! P is the end of a beam, at height z. K is the measured ground nearest before P on the beam: a
//! gap g away over ground. dh is the rise from K to P. The first case that holds decides:
//!
//! | condition | result |
//! | --- | --- |
//! | `dh > climb g + tolerance`, and P is `h_obs` above the kernel's mean ĥ | obstacle (a) |
//! | `dh > climb g + tolerance`, ĥ is unknown, and P nearer than `d_obs` | obstacle (b) |
//! | `dh < h_hole`, and the beam is too gentle to tell rim from slope | possible drop behind K |
//! | `dh < h_hole`, and both the beam and the line from K to P are steep | drop behind K |
//! | P is below the slope at K, carried on, and a steep beam just passes over K | drop behind K |
//! | the same, with a possible brow at K and an exact attitude | possible drop behind K |
//!
//! A drop is marked on the unmeasured cells behind K, over at most `drop_depth_m`, and it ends
//! before P. Then P is measured as ground if K is near enough. Three cases do not measure P: an
//! obstacle, a rise of a level beam that is too steep for ground, and a hole (a drop with
//! `dh < h_hole`), where P gets neither a height nor a mark. A P that rises too steeply before a
//! known obstacle is the obstacle's foot, and its height goes to the obstacle's cell.
//!
//! Departs from \[Maffei20, III-B\] in three ways:
//!
//! 1. Obstacle (a) must also be steep, because level beams meet every slope that rises.
//! 2. The paper's rule for holes, `h − h_robot < h_hole`, makes a hole of everything behind the
//!    brow of a long slope, and misses a drop of 0.2 m, which tips a 3-AT over. A beam over a rim
//!    tells the two apart. Behind a brow the ground bends down before the beam loses it, so the
//!    slope at K, carried on, predicts P. Behind a rim it does not. A brow that bends quickly looks
//!    like a low rim until the slope behind it is measured, so it gives a possible drop.
//! 3. The paper's ray from P back to the robot ends at K here. Nearer ground is measured. If the
//!    beam passes high over K, it says nothing of a rim there.
//!
//! No laser sees the disc around the start, so the robot's own plane is measured there.
//!
//! Units: metres; slopes are tangents.

use core::iter;

use crate::config::{Config, GroundTuning, KERNEL_CELLS, UnevenGround};
use crate::geometry::{CELL_M, Cell, Point};
use crate::ground::attitude_filter::AttitudeFilter;
use crate::ground::drop_inference;
use crate::ground::elevation::{Elevation, WINDOW_SIDE};
use crate::ground::ray::{Attitude, Mount, Ray};
use crate::input::{Input, has_company, informative_range_mm};
use crate::math;
use crate::robot::LaserMount;

/// Least distance from the robot to the window's border, metres.
const WINDOW_RADIUS_M: f32 = (WINDOW_SIDE / 2 - 1) as f32 * CELL_M;

/// The measured ground nearest before the end of a beam, K.
#[derive(Clone, Copy, Debug)]
struct LastGround {
    /// Length over ground from the laser, metres.
    s_m: f32,
    height_m: f32,
}

/// The survey of one step's scans.
#[derive(Debug)]
pub(crate) struct Survey<'a, 'm> {
    elevation: &'a mut Elevation<'m>,
    ground: &'a UnevenGround,
    tuning: &'m GroundTuning,
    attitude: Attitude,
    robot: Point,
    robot_z_m: f32,
    /// Distance along a beam within which heights are measured, metres.
    reach_m: f32,
    /// Difference of two heights that errors of the attitude alone explain, metres.
    slack_m: f32,
}

impl<'a, 'm> Survey<'a, 'm> {
    /// Starts a survey from the pose of the input, and moves the window there.
    pub(crate) fn new(
        elevation: &'a mut Elevation<'m>,
        ground: &'a UnevenGround,
        input: &Input<'_>,
    ) -> Self {
        elevation.follow(input.pose.point().cell());
        Self {
            tuning: elevation.tuning,
            elevation,
            ground,
            attitude: Attitude::of(&input.pose),
            robot: input.pose.point(),
            robot_z_m: input.pose.z_m,
            reach_m: f32::INFINITY,
            slack_m: 0.0,
        }
    }

    /// Sets the reach and the slack from the attitude filter.
    pub(crate) fn with_attitude(mut self, filter: &AttitudeFilter) -> Self {
        self.reach_m = filter.reach_m(self.tuning);
        self.slack_m = filter.slack_m(self.tuning);
        self
    }

    /// Enters both scans. `is_first` marks the first survey of a session.
    pub(crate) fn run(&mut self, config: &Config, input: &Input<'_>, is_first: bool) {
        if is_first {
            self.mark_robot_plane(self.tuning.blind_radius_m);
        }
        self.mark_robot_plane(config.tuning.map.stand_radius_m);
        // The level laser is judged by the ground that the tilted laser measures.
        for level in [false, true] {
            for (laser, ranges_mm) in config.lasers.iter().zip(input.scans) {
                if laser.is_level() == level {
                    self.scan(laser, ranges_mm);
                }
            }
        }
        drop_inference::infer_drops(self.elevation, self.ground, self.robot.cell(), self.slack_m);
    }

    /// Measures the robot's own plane as ground within a radius.
    fn mark_robot_plane(&mut self, radius_m: f32) {
        let reach = math::floor(radius_m / CELL_M) + 1;
        let middle = self.robot.cell();
        for y in middle.y - reach..=middle.y + reach {
            for x in middle.x - reach..=middle.x + reach {
                let cell = Cell { x, y };
                let centre = cell.centre();
                if centre.distance2(self.robot) <= radius_m * radius_m {
                    self.elevation
                        .mark_wheel_contact(cell, self.attitude.plane_m(centre));
                }
            }
        }
    }

    fn scan(&mut self, laser: &LaserMount, ranges_mm: &[u16]) {
        let attitude = self.attitude;
        let mount = Mount::new(&attitude, laser);
        let is_level = laser.is_level();
        for number in 0..ranges_mm.len() {
            let limit = laser.range_limit_mm;
            let Some(range) = informative_range_mm(ranges_mm, number, limit) else {
                continue;
            };
            let Some(ray) = attitude.ray(&mount, number, f32::from(range.min(limit)) * 1e-3) else {
                continue;
            };
            if range < limit {
                self.process_return(&ray, is_level, has_company(ranges_mm, number));
            } else if !is_level {
                self.process_no_return(&ray);
            }
        }
    }

    /// Enters a beam that hit something. `has_company`: a beam beside it ended about as far.
    fn process_return(&mut self, ray: &Ray, is_level: bool, has_company: bool) {
        let z_m = ray.height_m(ray.length_m);
        let last = self.last_ground(ray, ray.length_m);
        let (gap_m, rise_m) = (ray.length_m - last.s_m, z_m - last.height_m);
        if rise_m > self.ground.climb * gap_m + self.tuning.height_tolerance_m {
            let is_obstacle = self.is_obstacle(ray, z_m);
            if is_obstacle && has_company {
                self.elevation
                    .mark_obstacle(ray.hit_cell(self.tuning.hit_depth_m));
            }
            if is_obstacle || is_level {
                return;
            }
        } else if self.may_be_rim(ray, &last, gap_m, rise_m) {
            self.mark_possible_drops(ray, &last);
        } else if self.is_rim(ray, &last, gap_m, rise_m) {
            let is_hole = rise_m < self.ground.hole_m;
            // A brow that bends as quickly looks the same until the slope behind it is measured.
            let may_be_brow =
                gap_m > self.tuning.min_brow_gap_m && -rise_m < self.ground.climb * gap_m;
            if is_hole || !may_be_brow || self.slack_m > 0.0 {
                self.mark_drops(ray, &last, ray.length_m);
            } else {
                self.mark_possible_drops(ray, &last);
            }
            if is_hole {
                return;
            }
        }
        self.measure(ray, is_level, gap_m, rise_m);
    }

    /// Measures P as ground if K is near enough, or if a tilted beam met a climbable slope.
    fn measure(&mut self, ray: &Ray, is_level: bool, gap_m: f32, rise_m: f32) {
        let climb_m = self.ground.climb * gap_m;
        let is_linked =
            gap_m <= self.tuning.max_ground_gap_m || (!is_level && rise_m.abs() <= climb_m);
        if !is_linked {
            return;
        }
        let foot = (rise_m > climb_m + self.tuning.wall_foot_m)
            .then(|| self.wall_foot(ray))
            .flatten();
        let cell = foot.unwrap_or_else(|| ray.end().cell());
        let z_m = ray.height_m(ray.length_m);
        if ray.length_m < self.reach_m {
            self.elevation.measure(cell, z_m);
        } else if ray.length_m < self.tuning.low_confidence_reach * self.reach_m {
            self.elevation.measure_low_confidence(cell, z_m);
        }
    }

    /// Enters a tilted beam that hit nothing. If it should have met ground in the window, there is
    /// a drop.
    fn process_no_return(&mut self, ray: &Ray) {
        let (ux, uy) = ray.along;
        if !self.is_steep(ray) {
            return;
        }
        let closing = self.attitude.rise(ux, uy) - ray.slope;
        let above_m = ray.from_z_m - self.attitude.plane_m(ray.from);
        if above_m > closing * WINDOW_RADIUS_M {
            return;
        }
        let expected_m = above_m / closing;
        let last = self.last_ground(ray, expected_m + self.tuning.drop_depth_m);
        if self.is_grazing(ray, &last, self.tuning.grazing_m) {
            self.mark_drops(ray, &last, f32::INFINITY);
        }
    }

    /// Returns K, the measured ground nearest before the length `end_m` of a beam and not in the
    /// cell there; the ground under the robot if there is none.
    fn last_ground(&self, ray: &Ray, end_m: f32) -> LastGround {
        let heights = self.elevation.read();
        let end = ray.at(end_m).cell();
        let mut s_m = end_m.min(window_m(ray)) - 0.5 * CELL_M;
        while s_m > self.tuning.min_ground_m {
            let cell = ray.at(s_m).cell();
            if cell != end
                && let Some(height_m) = heights.height_m(cell)
            {
                return LastGround { s_m, height_m };
            }
            s_m -= CELL_M;
        }
        LastGround {
            s_m: self.tuning.robot_ground_m,
            height_m: self.robot_z_m,
        }
    }

    /// Returns the cell of the obstacle at the beam's end, if one is known there. The beam met its
    /// foot, which must not raise the ground before it.
    fn wall_foot(&self, ray: &Ray) -> Option<Cell> {
        let heights = self.elevation.read();
        let hit = ray.hit_cell(self.tuning.hit_depth_m);
        let next = ray.at(ray.length_m + CELL_M).cell();
        (heights.is_obstacle(hit, self.tuning) || heights.is_obstacle(next, self.tuning))
            .then_some(hit)
    }

    /// Returns true if a steep P is obstacle (a) or (b).
    fn is_obstacle(&self, ray: &Ray, z_m: f32) -> bool {
        match self.kernel_mean(ray.end().cell()) {
            Some(mean_m) => z_m - mean_m > self.ground.obstacle_m,
            None => ray.length_m < self.ground.near_m,
        }
    }

    /// Returns ĥ, the mean height of the kernel's samples, metres; `None` if too few are measured.
    fn kernel_mean(&self, cell: Cell) -> Option<f32> {
        let heights = self.elevation.read();
        let half = KERNEL_CELLS as i32 / 2;
        let stride = self.tuning.kernel_stride_cells;
        let (mut sum_m, mut count, mut all) = (0.0, 0_u16, 0_u16);
        for dy in (-half..half).step_by(stride) {
            for dx in (-half..half).step_by(stride) {
                all += 1;
                if let Some(height_m) = heights.height_m(cell.offset(dx, dy)) {
                    sum_m += height_m;
                    count += 1;
                }
            }
        }
        (count * self.tuning.kernel_divisor >= all).then(|| sum_m / f32::from(count))
    }

    /// Returns true if there is a rim at K: the beam just passes over K, and P lies lower than the
    /// slope at K predicts.
    fn is_rim(&self, ray: &Ray, last: &LastGround, gap_m: f32, rise_m: f32) -> bool {
        if rise_m > -self.tuning.min_drop_m
            || gap_m < self.tuning.min_drop_gap_m
            || !self.is_steep(ray)
        {
            return false;
        }
        if rise_m < self.ground.hole_m
            && -rise_m > self.tuning.steep_share * self.ground.climb * gap_m
        {
            return self.elevation.read().count(ray.at(last.s_m).cell()) > 1;
        }
        let slope = self.slope_at(ray, last);
        // An obstacle rises steeply up to K and casts a shadow behind it.
        slope < self.ground.climb
            && rise_m < slope * gap_m - self.tuning.min_drop_m - self.tuning.max_bend * gap_m
            && self.is_grazing(ray, last, self.tuning.grazing_m)
    }

    /// Returns true if there may be a rim at K, and the beam is too gentle to tell it from a slope.
    fn may_be_rim(&self, ray: &Ray, last: &LastGround, gap_m: f32, rise_m: f32) -> bool {
        rise_m < self.ground.hole_m
            && !self.is_steep(ray)
            && -rise_m > self.tuning.possible_steep_share * self.ground.climb * gap_m
            && self.is_grazing(ray, last, self.tuning.possible_grazing_m)
    }

    /// Returns true if K was measured more than once and the beam passes less than `limit_m` above
    /// it.
    fn is_grazing(&self, ray: &Ray, last: &LastGround, limit_m: f32) -> bool {
        let cell = ray.at(last.s_m).cell();
        self.elevation.read().count(cell) > 1 && ray.height_m(last.s_m) - last.height_m < limit_m
    }

    /// Returns true if the beam comes down so steeply that ground hidden behind K must be too steep
    /// to drive on. A gentler beam also passes over slopes.
    fn is_steep(&self, ray: &Ray) -> bool {
        -ray.slope > self.tuning.steep_share * self.ground.climb
    }

    /// Returns the slope of the ground along the beam up to K, at least the steepest descent.
    fn slope_at(&self, ray: &Ray, last: &LastGround) -> f32 {
        let back = ray.at(last.s_m - self.tuning.slope_base_m).cell();
        let slope = match self.elevation.read().height_m(back) {
            Some(height_m) => (last.height_m - height_m) / self.tuning.slope_base_m,
            None => self.attitude.rise(ray.along.0, ray.along.1),
        };
        slope.max(-self.ground.climb)
    }

    /// Marks possible drops on the unmeasured cells behind K.
    fn mark_possible_drops(&mut self, ray: &Ray, last: &LastGround) {
        for cell in cells_behind(ray, last, ray.length_m, self.tuning.drop_depth_m) {
            self.elevation.mark_possible_drop(cell);
        }
    }

    /// Marks drops on the unmeasured cells behind K and before the length `end_m`.
    fn mark_drops(&mut self, ray: &Ray, last: &LastGround, end_m: f32) {
        for cell in cells_behind(ray, last, end_m, self.tuning.drop_depth_m) {
            self.elevation.mark_drop(cell);
        }
    }
}

/// Returns the cells of a beam behind K, over at most `depth_m`, in the window and before the
/// length `end_m`.
fn cells_behind(
    ray: &Ray,
    last: &LastGround,
    end_m: f32,
    depth_m: f32,
) -> impl Iterator<Item = Cell> {
    let to_m = (last.s_m + depth_m).min(end_m - CELL_M).min(window_m(ray));
    iter::successors(Some(last.s_m + CELL_M), |s_m| Some(s_m + CELL_M))
        .take_while(move |&s_m| s_m <= to_m)
        .map(|s_m| ray.at(s_m).cell())
}

/// Returns the length that a beam from the robot surely runs in the window, metres.
fn window_m(ray: &Ray) -> f32 {
    let (x, y) = (ray.along.0.abs(), ray.along.1.abs());
    WINDOW_RADIUS_M / if x > y { x } else { y }
}

#[cfg(test)]
mod tests;

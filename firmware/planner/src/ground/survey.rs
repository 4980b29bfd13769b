//! Both scans into the elevation window: heights where beams met ground, marks where they met what stands, and marks where the ground is
//! gone.
//!
//! A beam that ends in P is judged by the ground K measured nearest before it, `g` away over ground and `dh` lower:
//!
//! | case | it is |
//! | --- | --- |
//! | steeper than the climb, and `z − ĥ > h_obs` | obstacle (a): it stands over the mean ground ĥ of the kernel |
//! | steeper than the climb, ĥ not known yet, nearer than `d_obs` | obstacle (b) |
//! | below what the ground at K leads to expect, and the beam just passes over K | a rim at K: what lies between is gone |
//! | that, and `dh < h_hole` | gone, P itself as well |
//! | that, but far enough behind K and no lower than a slope that may be climbed leads, by a sure attitude | a rim at K is suspected |
//! | `dh < h_hole`, but the beam comes down no more steeply than a slope may | a rim at K is suspected ([`super::suspicion`]) |
//! | else, with K near enough | ground; of what rises too steeply before what stands, the foot of that |
//!
//! Departs from [Maffei20, III-B] in three ways. (1) Obstacle (a) must also be steep, because level beams meet every slope that
//! rises. (2) The paper's rule for holes, `h − h_robot < h_hole`, calls everything behind the brow of a long slope a hole, and misses a
//! drop of 0.2 m, which fells a 3-AT. A beam over a rim tells the two apart: behind a brow the ground bends down before the beam loses it, so that
//! the slope at K, carried on, foretells P; behind a rim it does not. A brow that bends quickly is like a low rim until the slope behind it is
//! measured, so that is suspected. (3) A ray back from P ends at K: what lies nearer is measured,
//! and where it is not (the beam passes high over K) nothing is said of a rim that nobody saw.
//!
//! GroundModel the start lies a disc that no laser ever sees; there the robot's own plane is taken for measured. Units: metres.

use crate::config::Config;
use crate::config::KERNEL_CELLS;
use crate::config::UnevenGround;
use crate::geometry::{CELL_M, Cell, Point};
use crate::ground::attitude_filter::AttitudeFilter;
use crate::ground::drop_inference;
use crate::ground::elevation::{Elevation, WINDOW_SIDE};
use crate::ground::ray::{Attitude, Mount, Ray};
use crate::input::Input;
use crate::input::has_company;
use crate::input::informative_range_mm;
use crate::math;
use crate::robot::LaserMount;
use crate::robot::is_level;

/// Radius around the start that the tilted beams never see, metres: they meet level ground at 1.39 m from the robot's centre.
const BLIND_M: f32 = 1.35;
/// The wheels stand on what is nearer than this, metres.
const WHEELS_M: f32 = 0.25;
/// Errors of a height, from attitude, range and the cell's own extent, metres.
const HEIGHT_TOLERANCE_M: f32 = 0.10;
/// What rises more steeply than may be climbed, and by so much more, is no ground, metres.
const WALL_FOOT_M: f32 = 0.03;
/// From one sample of a beam's way over ground to the next, metres.
const SAMPLE_M: f32 = CELL_M;
/// Farther than this from the robot the window may end, metres.
const WITHIN_M: f32 = (WINDOW_SIDE / 2 - 1) as f32 * CELL_M;
/// A level beam's end is ground if ground was measured this near before it, metres: otherwise it may be a wall.
const MAX_GROUND_GAP_M: f32 = 0.45;
/// Drops less deep are none, metres.
const MIN_DROP_M: f32 = 0.08;
/// A beam passes just over K if it is no higher above it than this, metres.
const GRAZING_M: f32 = 0.15;
/// How far the slope at K is measured back, metres.
const BASE_M: f32 = 0.3;
/// The slope at K carried on foretells P to a part of the way this large.
const BEND: f32 = 0.15;
/// A beam is steep enough to tell a rim from a slope if it comes down by this part of the climb.
const STEEP: f32 = 0.85;
/// A beam that comes down by at least this part of the climb, and not steeply enough to tell, leaves a suspicion.
const POSSIBLE_STEEP: f32 = 0.3;
/// And if it passes no higher over K than this, metres: K was measured long before, and from elsewhere.
const POSSIBLE_GRAZING_M: f32 = 0.3;
/// Behind a brow of a slope that may be climbed a beam meets no ground that lies so much lower than its bend tells any nearer than this, metres.
const CREST_M: f32 = 0.45;
/// Behind a rim so much is marked, metres; what lies farther behind may be seen from elsewhere.
const DROP_DEPTH_M: f32 = 0.6;
/// What a beam meets begins where the beam ends and lies behind: so much farther on it is marked, metres, three deviations of a range.
pub const BEHIND_M: f32 = 0.03;
/// Ground is glimpsed so many times as far off as it is measured.
const LOW_CONFIDENCE_REACH: f32 = 2.0;
/// The share of the kernel that must be measured for its mean to count.
const KERNEL_SHARE: u16 = 8;

/// Ground measured before the end of a beam.
#[derive(Clone, Copy, Debug)]
struct LastGround {
    /// Over ground, from the laser.
    s_m: f32,
    height_m: f32,
}

/// The two scans of a step on their way into the window.
#[derive(Debug)]
pub struct Survey<'a, 'm> {
    elevation: &'a mut Elevation<'m>,
    ground: &'a UnevenGround,
    attitude: Attitude,
    robot: Point,
    robot_z_m: f32,
    /// Heights are measured within this distance, metres.
    reach_m: f32,
    /// Two heights may differ by so much for errors of the attitude alone, metres.
    slack_m: f32,
}

impl<'a, 'm> Survey<'a, 'm> {
    /// A survey from where the input says that the robot is.
    #[must_use]
    pub fn new(
        elevation: &'a mut Elevation<'m>,
        ground: &'a UnevenGround,
        input: &Input<'_>,
    ) -> Self {
        elevation.follow(input.pose.point().cell());
        Self {
            elevation,
            ground,
            attitude: Attitude::of(&input.pose),
            robot: input.pose.point(),
            robot_z_m: input.pose.z_m,
            reach_m: f32::INFINITY,
            slack_m: 0.0,
        }
    }

    /// The survey of an attitude that is filtered so far.
    #[must_use]
    pub fn with_attitude(mut self, filter: &AttitudeFilter) -> Self {
        self.reach_m = filter.reach_m();
        self.slack_m = filter.slack_m();
        self
    }

    /// Take everything in. `first` is the first survey of a session.
    pub fn run(&mut self, config: &Config, input: &Input<'_>, first: bool) {
        if first {
            self.mark_robot_plane(BLIND_M);
        }
        self.mark_robot_plane(WHEELS_M);
        // The tilted laser measures the ground by which the level one is judged.
        for level in [false, true] {
            for (laser, ranges_mm) in config.lasers.iter().zip(input.scans) {
                if is_level(laser) == level {
                    self.scan(laser, ranges_mm);
                }
            }
        }
        drop_inference::infer_drops(self.elevation, self.ground, self.robot.cell(), self.slack_m);
    }

    /// The robot's own plane is ground within a radius.
    fn mark_robot_plane(&mut self, radius_m: f32) {
        let reach = math::floor(radius_m / CELL_M) + 1;
        let middle = self.robot.cell();
        for y in middle.y - reach..=middle.y + reach {
            for x in middle.x - reach..=middle.x + reach {
                let cell = Cell { x, y };
                let centre = cell.centre();
                let (dx, dy) = (centre.x_m - self.robot.x_m, centre.y_m - self.robot.y_m);
                if dx * dx + dy * dy <= radius_m * radius_m {
                    self.elevation
                        .mark_wheel_contact(cell, self.attitude.plane_m(centre));
                }
            }
        }
    }

    fn scan(&mut self, laser: &LaserMount, ranges_mm: &[u16]) {
        let attitude = self.attitude;
        let mount = Mount::new(&attitude, laser);
        let level = is_level(laser);
        for number in 0..ranges_mm.len() {
            let limit = laser.range_limit_mm;
            let Some(range) = informative_range_mm(ranges_mm, number, limit) else {
                continue;
            };
            let Some(ray) = attitude.ray(&mount, number, f32::from(range.min(limit)) * 1e-3) else {
                continue;
            };
            if range < limit {
                let sure = has_company(ranges_mm, number);
                self.process_return(&ray, (level, sure));
            } else if !level {
                self.process_no_return(&ray);
            }
        }
    }

    /// A beam that met something; `sure` if the one beside it met something about as far.
    fn process_return(&mut self, ray: &Ray, (level, sure): (bool, bool)) {
        let z_m = ray.height_m(ray.length_m);
        let cell = ray.at(ray.length_m).cell();
        let last = self.last_ground(ray, ray.length_m);
        let (gap_m, rise_m) = (ray.length_m - last.s_m, z_m - last.height_m);
        if rise_m > self.ground.climb * gap_m + HEIGHT_TOLERANCE_M {
            let is_obstacle = self.is_obstacle(ray, cell, z_m);
            if is_obstacle && sure {
                self.elevation
                    .mark_obstacle(ray.at(ray.length_m + BEHIND_M).cell());
            }
            if is_obstacle || level {
                return;
            }
        } else if self.may_be_rim(ray, &last, gap_m, rise_m) {
            self.mark_possible_drops(ray, last.s_m, ray.length_m);
        } else if self.is_rim(ray, &last, gap_m, rise_m) {
            let to_m = (last.s_m + DROP_DEPTH_M).min(ray.length_m - SAMPLE_M);
            let is_hole = rise_m < self.ground.hole_m;
            // A brow that bends as quickly looks the same until the slope behind it is measured.
            let is_crest = gap_m > CREST_M && -rise_m < self.ground.climb * gap_m;
            if is_hole || !is_crest || self.slack_m > 0.0 {
                self.mark_drops(ray, last.s_m, to_m);
            } else {
                self.mark_possible_drops(ray, last.s_m, ray.length_m);
            }
            if is_hole {
                return;
            }
        }
        let cell = if rise_m > self.ground.climb * gap_m + WALL_FOOT_M {
            self.wall_foot(ray).unwrap_or(cell)
        } else {
            cell
        };
        let linked =
            gap_m <= MAX_GROUND_GAP_M || (!level && rise_m.abs() <= self.ground.climb * gap_m);
        if linked && ray.length_m < self.reach_m {
            self.elevation.measure(cell, z_m);
        } else if linked && ray.length_m < LOW_CONFIDENCE_REACH * self.reach_m {
            self.elevation.measure_low_confidence(cell, z_m);
        }
    }

    /// A tilted beam that came back from nothing, though the ground should be near: there is none.
    fn process_no_return(&mut self, ray: &Ray) {
        let (ux, uy) = ray.along;
        if !self.is_steep(ray) {
            return;
        }
        let closing = self.attitude.rise(ux, uy) - ray.slope;
        let above_m = ray.from_z_m - self.attitude.plane_m(ray.from);
        if closing < 0.1 || above_m > closing * WITHIN_M {
            return;
        }
        let expected_m = above_m / closing;
        let last = self.last_ground(ray, expected_m + DROP_DEPTH_M);
        if self.is_grazing(ray, &last, GRAZING_M) {
            self.mark_drops(ray, last.s_m, last.s_m + DROP_DEPTH_M);
        }
    }

    /// The ground measured nearest before a length of a beam, the cell there left out; the robot's own if there is none.
    fn last_ground(&self, ray: &Ray, from_m: f32) -> LastGround {
        let heights = self.elevation.read();
        let end = ray.at(from_m).cell();
        let mut s_m = from_m.min(window_m(ray)) - 0.5 * SAMPLE_M;
        while s_m > 0.2 {
            let cell = ray.at(s_m).cell();
            if cell != end
                && let Some(height_m) = heights.height_m(cell)
            {
                return LastGround { s_m, height_m };
            }
            s_m -= SAMPLE_M;
        }
        LastGround {
            s_m: 0.1,
            height_m: self.robot_z_m,
        }
    }

    /// The cell of what stands where a beam ends, if something is known to stand there: the beam met its foot, which raises no ground before it.
    fn wall_foot(&self, ray: &Ray) -> Option<Cell> {
        let heights = self.elevation.read();
        let behind = |far_m: f32| ray.at(ray.length_m + far_m).cell();
        let stands = heights.is_obstacle(behind(BEHIND_M)) || heights.is_obstacle(behind(CELL_M));
        stands.then(|| behind(BEHIND_M))
    }

    /// Obstacle (a) or (b), of something steep.
    fn is_obstacle(&self, ray: &Ray, cell: Cell, z_m: f32) -> bool {
        match self.kernel_mean(cell) {
            Some(mean_m) => z_m - mean_m > self.ground.obstacle_m,
            None => ray.length_m < self.ground.near_m,
        }
    }

    /// ĥ: mean height of the kernel's measured cells, every second one of every second row, if there are enough.
    fn kernel_mean(&self, cell: Cell) -> Option<f32> {
        let heights = self.elevation.read();
        let half = KERNEL_CELLS as i32 / 2;
        let (mut sum_m, mut count, mut all) = (0.0, 0_u16, 0_u16);
        for dy in (-half..half).step_by(2) {
            for dx in (-half..half).step_by(2) {
                all += 1;
                let near = Cell {
                    x: cell.x + dx,
                    y: cell.y + dy,
                };
                if let Some(height_m) = heights.height_m(near) {
                    sum_m += height_m;
                    count += 1;
                }
            }
        }
        (count * KERNEL_SHARE >= all).then(|| sum_m / f32::from(count))
    }

    /// Whether the ground falls away at K: the beam just passes over it, and P lies lower than the slope there foretells.
    fn is_rim(&self, ray: &Ray, last: &LastGround, gap_m: f32, rise_m: f32) -> bool {
        if rise_m > -MIN_DROP_M || gap_m < 1.5 * SAMPLE_M || !self.is_steep(ray) {
            return false;
        }
        if rise_m < self.ground.hole_m && -rise_m > STEEP * self.ground.climb * gap_m {
            return self.elevation.read().count(ray.at(last.s_m).cell()) > 1;
        }
        let slope = self.slope_at(ray, last);
        // What rises steeply up to K is a thing that stands, and casts a shadow.
        slope < self.ground.climb
            && is_bent(slope, gap_m, rise_m)
            && self.is_grazing(ray, last, GRAZING_M)
    }

    /// Whether the ground may fall away at K, and the beam comes down too gently to tell.
    fn may_be_rim(&self, ray: &Ray, last: &LastGround, gap_m: f32, rise_m: f32) -> bool {
        rise_m < self.ground.hole_m
            && !self.is_steep(ray)
            && -rise_m > POSSIBLE_STEEP * self.ground.climb * gap_m
            && self.is_grazing(ray, last, POSSIBLE_GRAZING_M)
    }

    /// Whether a beam passes no higher than this over K, which is sure.
    fn is_grazing(&self, ray: &Ray, last: &LastGround, most_m: f32) -> bool {
        let cell = ray.at(last.s_m).cell();
        self.elevation.read().count(cell) > 1 && ray.height_m(last.s_m) - last.height_m < most_m
    }

    /// Whether ground that a beam does not see behind K must be too steep to drive on: a beam that comes down more gently passes over
    /// slopes too.
    fn is_steep(&self, ray: &Ray) -> bool {
        -ray.slope > STEEP * self.ground.climb
    }

    /// The slope of the ground along a beam up to K.
    fn slope_at(&self, ray: &Ray, last: &LastGround) -> f32 {
        let back = ray.at(last.s_m - BASE_M).cell();
        let most = self.ground.climb;
        let slope = match self.elevation.read().height_m(back) {
            Some(height_m) => (last.height_m - height_m) / BASE_M,
            None => self.attitude.rise(ray.along.0, ray.along.1).min(0.9 * most),
        };
        slope.max(-most)
    }

    /// What was never measured behind K may be gone.
    fn mark_possible_drops(&mut self, ray: &Ray, from_m: f32, end_m: f32) {
        let to_m = (from_m + DROP_DEPTH_M)
            .min(end_m - SAMPLE_M)
            .min(window_m(ray));
        let mut s_m = from_m + SAMPLE_M;
        while s_m <= to_m {
            self.elevation.mark_possible_drop(ray.at(s_m).cell());
            s_m += SAMPLE_M;
        }
    }

    /// What was never measured between two lengths of a beam is gone.
    fn mark_drops(&mut self, ray: &Ray, from_m: f32, to_m: f32) {
        let to_m = to_m.min(window_m(ray));
        let mut s_m = from_m + SAMPLE_M;
        while s_m <= to_m {
            self.elevation.mark_drop(ray.at(s_m).cell());
            s_m += SAMPLE_M;
        }
    }
}

/// Whether P lies lower than the slope at K foretells.
fn is_bent(slope: f32, gap_m: f32, rise_m: f32) -> bool {
    rise_m < slope * gap_m - MIN_DROP_M - BEND * gap_m
}

/// How far a beam runs in the window at the least.
fn window_m(ray: &Ray) -> f32 {
    let (x, y) = (ray.along.0.abs(), ray.along.1.abs());
    WITHIN_M / if x > y { x } else { y }
}

#[cfg(test)]
mod tests;

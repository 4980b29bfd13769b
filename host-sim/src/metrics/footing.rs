//! Where a robot can stand and go on uneven ground, within its limits: positions, and the ground it covers from them.
//!
//! A state is a map cell of 10 cm and one of [`HEADINGS`] headings. It is *sound* if no wall comes nearer than the radius to the
//! cell's centre, the stance there is within the slopes for that heading, nothing touches belly or bumpers, and no edge beyond the limits lies
//! within a wheel's radius before or behind a wheel. From a sound state the robot goes forwards or backwards to the next cell
//! along its heading, or turns to the next heading, where the state there is sound and no wheel goes up or down
//! by more than its limit on the way. An edge that could be gone down but not up again is not used. So a slope that may be climbed but not crossed is reached where there is room to take it head-on.
//!
//! *Covered* ground: cells within the radius of a position that was reached, which are gentle themselves. Departs from the measure of flat
//! worlds, which counts what can be seen from there: over drops and slopes two planar lasers see what lies in their planes by
//! chance only. Metres, radians.

use fieldline_planner::geometry::Cell;

use super::coverage::{MAP_CELL_M, centre_m};
use super::frame::Frame;
use super::gentle::{is_gentle, level};
use super::reach::START_SLACK_M;
use crate::robot::{
    Limits, Pose, fall_along_m, ground_m, is_aground, resting, rise_along_m, wheels,
};
use crate::world::{Start, World};

/// Headings of a state, all around.
pub const HEADINGS: usize = 16;
/// Cells to the next one along each heading of the first quarter.
const STEPS: [[i32; 2]; 4] = [[1, 0], [2, 1], [1, 1], [1, 2]];
/// What was reached and covered.
#[derive(Clone, Debug)]
pub struct Footing {
    frame: Frame,
    /// Headings in which each cell was reached, one bit each.
    reached: Vec<u16>,
    covered: Vec<bool>,
}

impl Footing {
    /// Everything from a start.
    #[must_use]
    pub fn new(world: &World, start: Start, radius_m: f64, limits: &Limits) -> Self {
        let frame = Frame::of(world);
        let mut flood = Flood::new(world, start, (radius_m, limits), frame);
        flood.run();
        let reached = flood.reached;
        let covered = covered(world, &frame, &reached, (radius_m, limits));
        Self {
            frame,
            reached,
            covered,
        }
    }

    /// The cells that this is about.
    #[must_use]
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// Can the robot's centre get to a cell?
    #[must_use]
    pub fn reaches(&self, cell: Cell) -> bool {
        self.frame
            .index(cell)
            .is_some_and(|index| self.reached[index] != 0)
    }

    /// Can it in one of the headings, counted counter-clockwise from east?
    #[must_use]
    pub fn reaches_heading(&self, cell: Cell, heading: usize) -> bool {
        let index = self.frame.index(cell);
        index.is_some_and(|index| self.reached[index] >> (heading % HEADINGS) & 1 == 1)
    }

    /// Is a cell covered?
    #[must_use]
    pub fn covers(&self, cell: Cell) -> bool {
        self.frame
            .index(cell)
            .is_some_and(|index| self.covered[index])
    }
}

/// The search.
struct Flood<'w> {
    world: &'w World,
    limits: &'w Limits,
    frame: Frame,
    start: Start,
    /// No wall is too near.
    open: Vec<bool>,
    /// So level all around that every heading is sound if the cell is open.
    level: Vec<bool>,
    reached: Vec<u16>,
    /// States whose soundness is known, and those that are sound.
    asked: Vec<u16>,
    sound: Vec<u16>,
    waiting: Vec<(usize, usize)>,
}

impl<'w> Flood<'w> {
    fn new(
        world: &'w World,
        start: Start,
        (radius_m, limits): (f64, &'w Limits),
        frame: Frame,
    ) -> Self {
        let open = (0..frame.len()).map(|index| {
            let [x, y] = centre_m(frame.cell(index));
            let place = world.occupancy().cell_at(x, y);
            let (dx, dy) = (x - start.x_m, y - start.y_m);
            !world.occupancy().is_solid(place)
                && (world.distance().from_centre_m(place) >= radius_m - 1e-9
                    || dx * dx + dy * dy <= START_SLACK_M * START_SLACK_M)
        });
        Self {
            world,
            limits,
            frame,
            start,
            open: open.collect(),
            level: level(world, &frame, limits),
            reached: vec![0; frame.len()],
            asked: vec![0; frame.len()],
            sound: vec![0; frame.len()],
            waiting: Vec::new(),
        }
    }

    fn run(&mut self) {
        self.begin();
        while let Some((index, heading)) = self.waiting.pop() {
            for to in [heading + 1, heading + HEADINGS - 1] {
                self.turn(index, heading, to % HEADINGS);
            }
            for sign in [1, -1] {
                self.drive(index, heading, sign);
            }
        }
    }

    /// Where the robot is put down counts as sound, in all headings that are so and in its own.
    fn begin(&mut self) {
        let cell = |m: f64| (m / MAP_CELL_M).floor() as i32;
        let start = Cell {
            x: cell(self.start.x_m),
            y: cell(self.start.y_m),
        };
        let step = core::f64::consts::TAU / HEADINGS as f64;
        let own = (self.start.yaw_rad / step).round() as i64;
        let own = own.rem_euclid(HEADINGS as i64) as usize;
        if let Some(index) = self.frame.index(start) {
            self.enter(index, own);
        }
    }

    fn enter(&mut self, index: usize, heading: usize) {
        if self.reached[index] >> heading & 1 == 0 {
            self.reached[index] |= 1 << heading;
            self.waiting.push((index, heading));
        }
    }

    fn turn(&mut self, index: usize, from: usize, to: usize) {
        if self.reached[index] >> to & 1 == 1 || !self.is_sound(index, to) {
            return;
        }
        let centre = centre_m(self.frame.cell(index));
        if self.level[index] || self.passes(&pose(centre, from), &pose(centre, to)) {
            self.enter(index, to);
        }
    }

    fn drive(&mut self, index: usize, heading: usize, sign: i32) {
        let [dx, dy] = step_along(heading);
        let here = self.frame.cell(index);
        let there = Cell {
            x: here.x + sign * dx,
            y: here.y + sign * dy,
        };
        let Some(next) = self.frame.index(there) else {
            return;
        };
        if self.reached[next] >> heading & 1 == 1 || !self.is_sound(next, heading) {
            return;
        }
        let (a, b) = (centre_m(here), centre_m(there));
        let middle = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
        let long = dx.abs() + dy.abs() > 2;
        let poses = [a, middle, b].map(|centre| pose(centre, heading));
        let passes = self.level[index] && self.level[next]
            || ((!long || self.is_sound_at(&poses[1]))
                && self.passes(&poses[0], &poses[1])
                && self.passes(&poses[1], &poses[2]));
        if passes {
            self.enter(next, heading);
        }
    }

    fn is_sound(&mut self, index: usize, heading: usize) -> bool {
        if !self.open[index] || self.level[index] {
            return self.open[index];
        }
        if self.asked[index] >> heading & 1 == 0 {
            self.asked[index] |= 1 << heading;
            let pose = pose(centre_m(self.frame.cell(index)), heading);
            if self.is_sound_at(&pose) {
                self.sound[index] |= 1 << heading;
            }
        }
        self.sound[index] >> heading & 1 == 1
    }

    /// Everything but the walls.
    fn is_sound_at(&self, planar: &Pose) -> bool {
        let wheels = wheels(planar);
        let Some(heights_m) = ground_m(self.world, &wheels) else {
            return false;
        };
        let stance = resting(planar, heights_m);
        if !self
            .limits
            .holds_attitude(stance.pitch_rad, stance.roll_rad)
        {
            return false;
        }
        let along = [libm::cos(planar.yaw_rad), libm::sin(planar.yaw_rad)];
        let edges = (0..4).any(|k| {
            [along, along.map(|v| -v)].into_iter().any(|along| {
                let (point, height_m) = (wheels[k], heights_m[k]);
                rise_along_m(self.world, point, along, height_m) > self.limits.step_m
                    || fall_along_m(self.world, point, along, height_m) > self.limits.drop_m
            })
        });
        !edges && !is_aground(self.world, &stance, self.limits)
    }

    /// No wheel goes up or down too much from one pose to the other.
    fn passes(&self, from: &Pose, to: &Pose) -> bool {
        let heights = [from, to].map(|pose| ground_m(self.world, &wheels(pose)));
        let [Some(from_m), Some(to_m)] = heights else {
            return false;
        };
        from_m.iter().zip(&to_m).all(|(from_m, to_m)| {
            to_m - from_m <= self.limits.step_m && from_m - to_m <= self.limits.drop_m
        })
    }
}

fn pose([x_m, y_m]: [f64; 2], heading: usize) -> Pose {
    Pose {
        x_m,
        y_m,
        yaw_rad: heading as f64 * core::f64::consts::TAU / HEADINGS as f64,
        ..Pose::default()
    }
}

/// Cells to the next one along a heading.
fn step_along(heading: usize) -> [i32; 2] {
    let [mut dx, mut dy] = STEPS[heading % 4];
    for _ in 0..heading / 4 {
        (dx, dy) = (-dy, dx);
    }
    [dx, dy]
}

/// Gentle cells within the radius of a reached one.
fn covered(
    world: &World,
    frame: &Frame,
    reached: &[u16],
    (radius_m, limits): (f64, &Limits),
) -> Vec<bool> {
    let cells = (radius_m / MAP_CELL_M).ceil() as i32;
    let offsets: Vec<[i32; 2]> = (-cells..=cells)
        .flat_map(|y| (-cells..=cells).map(move |x| [x, y]))
        .filter(|[x, y]| f64::from(x * x + y * y).sqrt() * MAP_CELL_M <= radius_m + 1e-9)
        .collect();
    let mut near = vec![false; frame.len()];
    for index in (0..frame.len()).filter(|index| reached[*index] != 0) {
        let cell = frame.cell(index);
        for [dx, dy] in &offsets {
            let beside = Cell {
                x: cell.x + dx,
                y: cell.y + dy,
            };
            if let Some(beside) = frame.index(beside) {
                near[beside] = true;
            }
        }
    }
    (0..frame.len())
        .map(|index| near[index] && is_gentle(world, frame.cell(index), limits))
        .collect()
}

#[cfg(test)]
mod tests;

//! Positions that a robot can reach on uneven ground within its limits, and the ground it covers.
//!
//! A state is a map cell of 10 cm and one of [`HEADINGS`] headings. It is *sound* if
//! - no wall is nearer to the cell's centre than the radius,
//! - the stance there is within the slopes for that heading,
//! - nothing touches belly or bumpers, and
//! - no edge beyond the limits lies within a wheel's radius before or behind a wheel.
//!
//! From a sound state the robot drives forwards or backwards to the next cell along its heading, or
//! turns to the next heading. The next state must be sound too, and no wheel may go up or down by
//! more than its limit on the way. An edge that the robot can go down and not up again is not used.
//! So a slope that it can climb and cannot cross is reached where there is room to take it head-on.
//!
//! *Covered* ground is gentle cells within the radius of a reached position. In a flat world
//! coverage counts what the lasers can see instead. On drops and slopes that would be chance: two
//! planar lasers see only what lies in their planes. Metres, radians.

use fieldline_planner::geometry::Cell;

use super::cell_area::CellArea;
use super::coverage::{MAP_CELL_M, centre_m};
use super::gentle::{is_gentle, level};
use super::reach::is_open;
use crate::robot::{
    Limits, Pose, fall_along_m, ground_m, is_aground, resting, rise_along_m, wheels,
};
use crate::world::{Start, World};

/// Number of headings of a state.
pub const HEADINGS: usize = 16;
/// Offset to the next cell along each heading of the first quarter, cells.
const STEPS: [[i32; 2]; 4] = [[1, 0], [2, 1], [1, 1], [1, 2]];

/// The states that a robot reaches, and the cells that it covers.
#[derive(Clone, Debug)]
pub struct Footing {
    area: CellArea,
    /// Headings in which each cell is reached, one bit per heading.
    reached: Vec<u16>,
    covered: Vec<bool>,
}

impl Footing {
    /// Searches all states from a start.
    #[must_use]
    pub fn new(world: &World, start: Start, radius_m: f64, limits: &Limits) -> Self {
        let area = CellArea::of(world);
        let mut search = Search::new(world, start, (radius_m, limits), area);
        search.run();
        let reached = search.reached;
        let covered = covered(world, &area, &reached, (radius_m, limits));
        Self {
            area,
            reached,
            covered,
        }
    }

    /// The map cells of the world.
    #[must_use]
    pub fn area(&self) -> &CellArea {
        &self.area
    }

    /// Returns true if the robot's centre reaches a cell.
    #[must_use]
    pub fn reaches(&self, cell: Cell) -> bool {
        self.area
            .index(cell)
            .is_some_and(|index| self.reached[index] != 0)
    }

    /// Returns true if the robot covers a cell.
    #[must_use]
    pub fn covers(&self, cell: Cell) -> bool {
        self.area
            .index(cell)
            .is_some_and(|index| self.covered[index])
    }
}

/// The search over states.
struct Search<'w> {
    world: &'w World,
    limits: &'w Limits,
    area: CellArea,
    start: Start,
    /// True for each cell that is far enough from walls.
    open: Vec<bool>,
    /// True for each cell whose ground is so level all around that every heading is sound if the
    /// cell is open.
    level: Vec<bool>,
    reached: Vec<u16>,
    /// States whose soundness was computed.
    asked: Vec<u16>,
    /// States that are sound, of those in `asked`.
    sound: Vec<u16>,
    waiting: Vec<(usize, usize)>,
}

impl<'w> Search<'w> {
    fn new(
        world: &'w World,
        start: Start,
        (radius_m, limits): (f64, &'w Limits),
        area: CellArea,
    ) -> Self {
        let open = (0..area.len()).map(|index| {
            let [x, y] = centre_m(area.cell(index));
            let cell = world.occupancy().cell_at(x, y);
            is_open(world, start, radius_m, (cell, [x, y]))
        });
        Self {
            world,
            limits,
            area,
            start,
            open: open.collect(),
            level: level(world, &area, limits),
            reached: vec![0; area.len()],
            asked: vec![0; area.len()],
            sound: vec![0; area.len()],
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

    /// Enters the start in its own heading, which counts as sound.
    fn begin(&mut self) {
        let cell = |m: f64| (m / MAP_CELL_M).floor() as i32;
        let start = Cell {
            x: cell(self.start.x_m),
            y: cell(self.start.y_m),
        };
        let step = core::f64::consts::TAU / HEADINGS as f64;
        let own = (self.start.yaw_rad / step).round() as i64;
        let own = own.rem_euclid(HEADINGS as i64) as usize;
        if let Some(index) = self.area.index(start) {
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
        let centre = centre_m(self.area.cell(index));
        if self.level[index] || self.passes(&pose(centre, from), &pose(centre, to)) {
            self.enter(index, to);
        }
    }

    fn drive(&mut self, index: usize, heading: usize, sign: i32) {
        let [dx, dy] = step_along(heading);
        let here = self.area.cell(index);
        let Some(next) = self.area.beside(here, [sign * dx, sign * dy]) else {
            return;
        };
        if self.reached[next] >> heading & 1 == 1 || !self.is_sound(next, heading) {
            return;
        }
        let (a, b) = (centre_m(here), centre_m(self.area.cell(next)));
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
            let pose = pose(centre_m(self.area.cell(index)), heading);
            if self.is_sound_at(&pose) {
                self.sound[index] |= 1 << heading;
            }
        }
        self.sound[index] >> heading & 1 == 1
    }

    /// Checks everything except the walls.
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

    /// Returns true if no wheel goes up or down too much from one pose to the other.
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

/// Offset to the next cell along a heading, cells.
fn step_along(heading: usize) -> [i32; 2] {
    let [mut dx, mut dy] = STEPS[heading % 4];
    for _ in 0..heading / 4 {
        (dx, dy) = (-dy, dx);
    }
    [dx, dy]
}

/// Gentle cells within the radius of a reached cell.
fn covered(
    world: &World,
    area: &CellArea,
    reached: &[u16],
    (radius_m, limits): (f64, &Limits),
) -> Vec<bool> {
    let cells = (radius_m / MAP_CELL_M).ceil() as i32;
    let offsets: Vec<[i32; 2]> = (-cells..=cells)
        .flat_map(|y| (-cells..=cells).map(move |x| [x, y]))
        .filter(|[x, y]| f64::from(x * x + y * y).sqrt() * MAP_CELL_M <= radius_m + 1e-9)
        .collect();
    let mut near = vec![false; area.len()];
    for index in (0..area.len()).filter(|index| reached[*index] != 0) {
        let cell = area.cell(index);
        for offset in &offsets {
            if let Some(beside) = area.beside(cell, *offset) {
                near[beside] = true;
            }
        }
    }
    (0..area.len())
        .map(|index| near[index] && is_gentle(world, area.cell(index), limits))
        .collect()
}

#[cfg(test)]
mod tests;

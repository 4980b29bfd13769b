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

use super::coverage::{MAP_CELL_M, Truth, centre_m, truth};
use super::frame::Frame;
use super::reach::START_SLACK_M;
use crate::robot::{
    Limits, Pose, fall_along_m, ground_m, is_aground, resting, rise_along_m, wheels,
};
use crate::world::{Start, World};

/// Headings of a state, all around.
pub const HEADINGS: usize = 16;
/// Cells to the next one along each heading of the first quarter.
const STEPS: [[i32; 2]; 4] = [[1, 0], [2, 1], [1, 1], [1, 2]];
/// Distance over which the slope of a cell is taken, metres.
const SLOPE_M: f64 = 0.1;
/// How far from its centre the ground under a robot matters, cells.
const NEAR_CELLS: i32 = 4;

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

/// Is a cell's own ground within the limits: free of walls, no steeper than the climb, without an edge?
#[must_use]
pub fn is_gentle(world: &World, cell: Cell, limits: &Limits) -> bool {
    let [x, y] = centre_m(cell);
    let Some(here_m) = world.ground_m(x, y) else {
        return false;
    };
    let inside = |x: f64, y: f64| {
        let grid = world.occupancy();
        grid.index(grid.cell_at(x, y)).is_some()
    };
    // Beyond the border the ground is taken as level; a hole inside is an edge.
    let beside = |dx: f64, dy: f64| match world.ground_m(x + dx, y + dy) {
        None if inside(x + dx, y + dy) => f64::NAN,
        height_m => height_m.unwrap_or(here_m),
    };
    let d = SLOPE_M;
    let gx = (beside(d, 0.0) - beside(-d, 0.0)) / (2.0 * d);
    let gy = (beside(0.0, d) - beside(0.0, -d)) / (2.0 * d);
    let edge_m = limits.step_m.max(limits.drop_m);
    let smooth = (0..8).all(|k| {
        let bearing = f64::from(k) * core::f64::consts::FRAC_PI_4;
        let rise_m = beside(d * libm::cos(bearing), d * libm::sin(bearing)) - here_m;
        rise_m.abs() <= edge_m
    });
    // Comparisons with the NaN of a hole are false.
    smooth
        && (gx * gx + gy * gy).sqrt() <= libm::tan(limits.climb_rad) + 1e-9
        && truth(world, cell) == Truth::Free
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

/// Cells around which the ground rises by so little that neither slope nor edge can be beyond the limits.
fn level(world: &World, frame: &Frame, limits: &Limits) -> Vec<bool> {
    // Over the wheel base and over the track, a little less for what lies between the points looked at.
    let slopes = [
        0.268 * libm::tan(limits.climb_rad),
        0.394 * libm::tan(limits.side_rad),
    ];
    let little_m = 0.8
        * slopes[0]
            .min(slopes[1])
            .min(limits.step_m)
            .min(limits.drop_m);
    let spans = spans_m(world, frame);
    let across = widened(&spans, frame, [1, 0]);
    let around = widened(&across, frame, [0, 1]);
    around
        .into_iter()
        .map(|[low_m, high_m]| high_m - low_m <= little_m)
        .collect()
}

/// Least and greatest height of each cell; endless at a hole.
fn spans_m(world: &World, frame: &Frame) -> Vec<[f64; 2]> {
    let points: Vec<[f64; 2]> = (0..25)
        .map(|k| [k % 5, k / 5].map(|k| f64::from(k) * 0.25 * MAP_CELL_M))
        .collect();
    (0..frame.len())
        .map(|index| {
            let cell = frame.cell(index);
            let corner = [cell.x, cell.y].map(|k| f64::from(k) * MAP_CELL_M);
            points.iter().fold(
                [f64::INFINITY, f64::NEG_INFINITY],
                |[low, high], [x, y]| match world.ground_m(corner[0] + x, corner[1] + y) {
                    Some(z) => [low.min(z), high.max(z)],
                    None => [f64::NEG_INFINITY, f64::INFINITY],
                },
            )
        })
        .collect()
}

/// Spans over all cells within [`NEAR_CELLS`] along an axis; beyond the frame there is nothing.
fn widened(spans: &[[f64; 2]], frame: &Frame, [ax, ay]: [i32; 2]) -> Vec<[f64; 2]> {
    (0..frame.len())
        .map(|index| {
            let cell = frame.cell(index);
            (-NEAR_CELLS..=NEAR_CELLS)
                .filter_map(|k| {
                    frame.index(Cell {
                        x: cell.x + k * ax,
                        y: cell.y + k * ay,
                    })
                })
                .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], other| {
                    [low.min(spans[other][0]), high.max(spans[other][1])]
                })
        })
        .collect()
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
mod tests {
    use super::*;
    use crate::world::{Class, Elevation, GridCell, Occupancy};

    /// 10 × 6 m of ground, sampled every 5 cm, with a start at (1, 3) looking east.
    fn world(height_m: impl Fn(f64, f64) -> f64) -> (World, Start) {
        let size = [200, 120];
        let elevation = Elevation::from_fn(size, 0.05, [0.0, 0.0], height_m);
        let start = Start {
            x_m: 1.0,
            y_m: 3.0,
            yaw_rad: 0.0,
        };
        let floor = Occupancy::filled(size[0], size[1], 0.05, [0.0, 0.0], Class::Free);
        (World::uneven("test", floor, elevation, vec![start]), start)
    }

    fn footing(height_m: impl Fn(f64, f64) -> f64, limits: &Limits) -> Footing {
        let (world, start) = world(height_m);
        Footing::new(&world, start, 0.3, limits)
    }

    fn cell(x_m: f64, y_m: f64) -> Cell {
        let of = |m: f64| (m / MAP_CELL_M).floor() as i32;
        Cell {
            x: of(x_m),
            y: of(y_m),
        }
    }

    /// A plane that rises eastwards from x = 3 to x = 7 and is level on both sides, rounded over half a metre.
    fn ramp(degrees: f64) -> impl Fn(f64, f64) -> f64 {
        let grade = degrees.to_radians().tan();
        let soft = |t: f64| {
            if t < 0.0 {
                0.0
            } else if t < 0.5 {
                t * t
            } else {
                t - 0.25
            }
        };
        move |x: f64, _| grade * (soft(x - 3.0) - soft(x - 6.5))
    }

    #[test]
    fn level_ground_is_reached_up_to_the_radius_and_covered_whole() {
        let footing = footing(|_, _| 0.4, &Limits::WORKING);
        // Centres from 0.35 to 9.65 m and from 0.35 to 5.65 m.
        let reached = (0..footing.frame().len())
            .filter(|index| footing.reaches(footing.frame().cell(*index)))
            .count();
        assert_eq!(reached, 94 * 54);
        assert!(footing.covers(cell(0.15, 3.0)) && footing.covers(cell(5.0, 0.05)));
        assert!((0..HEADINGS).all(|k| footing.reaches_heading(cell(5.0, 3.0), k)));
    }

    #[test]
    fn a_slope_that_can_be_climbed_but_not_crossed_is_taken_head_on() {
        let gentle = footing(ramp(12.0), &Limits::WORKING);
        assert!((0..HEADINGS).all(|k| gentle.reaches_heading(cell(5.0, 3.0), k)));
        let steep = footing(ramp(18.0), &Limits::WORKING);
        assert!(steep.reaches(cell(9.0, 3.0)), "the top");
        let headings: Vec<usize> = (0..HEADINGS)
            .filter(|k| steep.reaches_heading(cell(5.0, 3.0), *k))
            .collect();
        // A slope of 18° crossed at an angle φ rolls by atan(tan 18° sin φ): 12.9° at 45°, 16.7° at 67.5°.
        assert_eq!(headings, [0, 1, 2, 6, 7, 8, 9, 10, 14, 15]);
        let closed = footing(ramp(23.0), &Limits::WORKING);
        assert!(!closed.reaches(cell(5.0, 3.0)) && !closed.reaches(cell(9.0, 3.0)));
        let wider = Limits::WORKING.changed("climb=25").expect("limits");
        assert!(footing(ramp(23.0), &wider).reaches(cell(9.0, 3.0)));
    }

    #[test]
    fn an_edge_is_crossed_where_it_is_low_enough() {
        let kerb = |height_m: f64| move |x: f64, _| if x > 5.0 { height_m } else { 0.0 };
        for (height_m, passes) in [(0.05, true), (0.10, false), (-0.05, true), (-0.3, false)] {
            let footing = footing(kerb(height_m), &Limits::WORKING);
            assert_eq!(footing.reaches(cell(8.0, 3.0)), passes, "{height_m}");
            assert_eq!(footing.covers(cell(8.0, 3.0)), passes, "{height_m}");
            assert!(footing.covers(cell(4.6, 3.0)), "{height_m}");
        }
    }

    #[test]
    fn no_wheel_comes_nearer_to_a_hole_than_its_radius_and_its_rim_is_not_gentle() {
        let hole = |x: f64, y: f64| {
            if (x - 5.0).abs() < 1.0 && (y - 3.0).abs() < 1.0 {
                f64::NAN
            } else {
                0.0
            }
        };
        let footing = footing(hole, &Limits::WORKING);
        // The front axle is 0.134 m ahead of the centre; surface ends within a sample of 4.0.
        assert!(!footing.reaches_heading(cell(3.85, 3.0), 0));
        assert!(footing.reaches_heading(cell(3.65, 3.0), 0));
        assert!(footing.reaches(cell(8.0, 3.0)) && !footing.covers(cell(5.0, 3.0)));
        let (world, _) = world(hole);
        assert!(!is_gentle(&world, cell(3.95, 3.0), &Limits::WORKING));
        assert!(is_gentle(&world, cell(3.75, 3.0), &Limits::WORKING));
    }

    #[test]
    fn walls_keep_their_distance_as_on_the_flat() {
        let (world, start) = world(|_, _| 0.0);
        let mut grid = world.occupancy().clone();
        // A wall with a gap of 0.7 m in its middle.
        for j in (0..120).filter(|j| !(53..67).contains(j)) {
            grid.set(GridCell { i: 100, j }, Class::Wall);
        }
        let elevation = world.elevation().expect("uneven").clone();
        let world = World::uneven("wall", grid, elevation, vec![start]);
        assert!(Footing::new(&world, start, 0.3, &Limits::WORKING).reaches(cell(8.0, 3.0)));
        assert!(!Footing::new(&world, start, 0.4, &Limits::WORKING).reaches(cell(8.0, 3.0)));
    }
}

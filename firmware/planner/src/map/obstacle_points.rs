//! Obstacle points: returns of the level laser near the robot, finer than map cells.
//!
//! A door of 0.65 m leaves 8 cm on each side of a Pioneer 3-AT, less than a map cell. So the
//! planner keeps points within `reach_m`, also after they leave the field of view. A point is the
//! mean of its returns:
//!
//! ```text
//! p ← p + (r − p) / n,    n = min(returns so far, max_returns)
//! ```
//!
//! Without the mean, the nearest of many returns of a wall would count, and it is two or three
//! sigma too near. The planner removes a point
//! - if a beam passes through its place;
//! - if the robot stands on it;
//! - if it leaves the view with one return only, because a false return could not be disproved
//!   later;
//! - if it is out of view where another robot is, because that one drives on while nobody looks;
//! - if it is out of reach. The reach behind the robot is shorter, because the robot only turns and
//!   backs out there.
//!
//! A *felt* point is where the hull met something that the laser does not see. No beam removes it.
//! The next contact does, because one thing holds the robot at a time: a robot that is held ahead
//! and then behind is not in a trap but, say, pushed, or on wheels that slip (measured:
//! docs/MEASURED.md, "Felt points of an earlier contact").
//!
//! What a turning robot feels lies on all four sides, and only one of them is true. Such points are
//! a *trap*: a wedged robot removes them (measured: docs/MEASURED.md, "Felt points that a wedged
//! robot removes").
//!
//! An *unseen* point lies beside the hull of a robot that starts. Nothing tells that there is room:
//! the robot may stand on its dock, or in a corner. So it drives straight ahead, where the laser
//! has looked, until a turn on the spot sweeps no unseen point. Unseen points go as others do: when
//! a beam passes or the robot leaves them behind. A robot that is wedged among them removes them,
//! because it has to try.
//!
//! Invariants: at most `MAX_POINTS` points, of which the farthest gives way; as many counts as
//! points.
//! Units: metres, odometry frame.

use heapless::Vec;

use crate::config::{Config, MapTuning, Tuning};
use crate::geometry::{CELL_M, Cell, Point, Pose, RobotFrame};
use crate::grid::bits::ones;
use crate::input::{has_company, informative_range_mm};
use crate::map::integrate::{level_beams, sensor_point};
use crate::map::{Class, Tiles};
use crate::math;
use crate::robot::{LaserMount, RobotShape};

/// Greatest number of points.
pub(crate) const MAX_POINTS: usize = 256;
/// The count of a felt point.
pub(crate) const FELT: u8 = 0;
/// The count of an unseen point: more than any number of returns.
pub(crate) const UNSEEN: u8 = u8::MAX;
/// Distance of an unseen point from the hull, metres. A robot with less room cannot move off
/// without a touch.
const UNSEEN_M: f32 = 0.03;
/// Greatest distance between two unseen points, metres.
const UNSEEN_EVERY_M: f32 = 0.05;

/// The obstacle points around the robot.
#[derive(Debug, Default)]
pub struct ObstaclePoints {
    points: Vec<Point, MAX_POINTS>,
    /// Number of returns of each point, up to `max_returns`; or [`FELT`], or [`UNSEEN`].
    returns: Vec<u8, MAX_POINTS>,
    /// The felt points lie around the robot, and may hold it where nothing is.
    is_trap: bool,
}

impl ObstaclePoints {
    /// Creates an empty store.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            points: Vec::new(),
            returns: Vec::new(),
            is_trap: false,
        }
    }

    /// Removes all points.
    pub fn clear(&mut self) {
        self.points.clear();
        self.returns.clear();
    }

    /// Returns the points.
    #[must_use]
    pub fn points(&self) -> &[Point] {
        &self.points
    }

    /// Returns the points with their counts.
    pub(crate) fn counted(&self) -> impl Iterator<Item = (Point, u8)> + '_ {
        self.points
            .iter()
            .copied()
            .zip(self.returns.iter().copied())
    }

    /// Takes over points with their counts, for a robot at `centre`. They are no trap.
    pub(crate) fn take_over(&mut self, centre: Point, counted: impl Iterator<Item = (Point, u8)>) {
        self.clear();
        self.is_trap = false;
        counted.for_each(|(point, returns)| self.insert(centre, point, returns));
    }

    /// Enters a scan of the level laser, taken at `pose`. `is_robot` tells at which points another
    /// robot may be.
    pub fn update(
        &mut self,
        config: &Config,
        pose: &Pose,
        (laser, ranges_mm): (&LaserMount, &[u16]),
        is_robot: impl Fn(Point) -> bool,
    ) {
        let tuning = &config.tuning.map;
        self.remove_stale(config, pose, (laser, ranges_mm), is_robot);
        for beam in level_beams(pose, laser, ranges_mm, tuning).filter(|beam| beam.hit) {
            let end = beam.end();
            if within_reach(tuning, pose, end) && has_company(ranges_mm, beam.number) {
                self.add_return(tuning, pose.point(), end);
            }
        }
    }

    /// Removes the points that the scan or the robot disproves, and those out of reach.
    fn remove_stale(
        &mut self,
        config: &Config,
        pose: &Pose,
        (laser, ranges_mm): (&LaserMount, &[u16]),
        is_robot: impl Fn(Point) -> bool,
    ) {
        let tuning = &config.tuning.map;
        let from = sensor_point(pose, laser);
        let mut index = 0;
        while let (Some(&point), Some(&returns)) = (self.points.get(index), self.returns.get(index))
        {
            let stays = within_reach(tuning, pose, point)
                && !is_inside(config, pose, point)
                && (returns == FELT
                    || match visibility((pose, from), laser, ranges_mm, point, tuning.through_m) {
                        Visibility::Hit => true,
                        Visibility::Through => false,
                        Visibility::Unseen => returns > 1 && !is_robot(point),
                    });
            if stays {
                index += 1;
            } else {
                self.remove(index);
            }
        }
    }

    /// Enters a return: into the mean of the first point near it, or as a new point.
    fn add_return(&mut self, tuning: &MapTuning, centre: Point, end: Point) {
        let same_m = tuning.same_point_m;
        let near = |&&mut point: &&mut Point| {
            (point.x_m - end.x_m).abs() < same_m && point.distance2(end) < same_m * same_m
        };
        let known = self.points.iter_mut().zip(&mut self.returns);
        let mut known = known.filter(|(point, _)| near(point));
        if let Some((point, returns)) = known.next() {
            let before = if *returns == UNSEEN { 0 } else { *returns };
            *returns = (before + 1).min(tuning.max_returns);
            let part = 1.0 / f32::from(*returns);
            point.x_m += part * (end.x_m - point.x_m);
            point.y_m += part * (end.y_m - point.y_m);
        } else {
            self.insert(centre, end, 1);
        }
    }

    /// Enters unseen points all around the hull of a robot at `pose`.
    pub(crate) fn surround(&mut self, pose: &Pose, robot: &RobotShape) {
        let frame = RobotFrame::of(pose);
        let (x_m, y_m) = (
            robot.half_length_m + UNSEEN_M,
            robot.half_width_m + UNSEEN_M,
        );
        let ends = side(x_m).flat_map(|x| [(x, y_m), (x, -y_m)]);
        let outline = ends.chain(side(y_m).flat_map(|y| [(x_m, y), (-x_m, y)]));
        for (x_m, y_m) in outline {
            self.insert(pose.point(), frame.to_map(Point { x_m, y_m }), UNSEEN);
        }
    }

    /// Returns true if a robot at `pose` that turns on the spot would sweep an unseen point.
    pub(crate) fn is_surrounded(&self, pose: &Pose, robot: &RobotShape) -> bool {
        let reach_m = robot.half_diagonal_m + UNSEEN_M;
        let is_near = |point: &Point| point.distance2(pose.point()) < reach_m * reach_m;
        let mut counted = self.points.iter().zip(&self.returns);
        counted.any(|(point, &returns)| returns == UNSEEN && is_near(point))
    }

    /// Enters the points where the hull of a robot at `centre` met something, in place of those of
    /// the contact before. They are a trap if they lie around it.
    pub(crate) fn feel(&mut self, centre: Point, felt: impl Iterator<Item = Point>, is_trap: bool) {
        self.remove_counted(|returns| returns == FELT);
        self.is_trap = is_trap;
        felt.for_each(|point| self.insert(centre, point, FELT));
    }

    /// Removes the points of a trap, and the unseen ones that surround a robot at `pose`. Returns
    /// true if there were any.
    pub(crate) fn open_trap(&mut self, pose: &Pose, robot: &RobotShape) -> bool {
        let is_trap = core::mem::replace(&mut self.is_trap, false);
        let is_surrounded = self.is_surrounded(pose, robot);
        self.remove_counted(|returns| match returns {
            UNSEEN => is_surrounded,
            returns => returns == FELT && is_trap,
        })
    }

    /// Removes the points with these counts. Returns true if there were any.
    fn remove_counted(&mut self, of: impl Fn(u8) -> bool) -> bool {
        let before = self.points.len();
        let mut index = 0;
        while let Some(&returns) = self.returns.get(index) {
            if of(returns) {
                self.remove(index);
            } else {
                index += 1;
            }
        }
        self.points.len() < before
    }

    fn remove(&mut self, index: usize) {
        self.points.swap_remove(index);
        self.returns.swap_remove(index);
    }

    /// Inserts a point; in a full store it replaces the farthest one, if that is farther.
    fn insert(&mut self, centre: Point, point: Point, returns: u8) {
        if self.points.is_full() {
            let farther = |best: (usize, f32), (k, &point): (usize, &Point)| {
                let far = point.distance2(centre);
                if far > best.1 { (k, far) } else { best }
            };
            let (farthest, far) = self.points.iter().enumerate().fold((0, 0.0), farther);
            if far < point.distance2(centre) {
                return;
            }
            self.remove(farthest);
        }
        // There is room now.
        let _ = self.points.push(point);
        let _ = self.returns.push(returns);
    }
}

/// Returns places from -`half_m` to `half_m`, at most [`UNSEEN_EVERY_M`] apart.
fn side(half_m: f32) -> impl Iterator<Item = f32> {
    let parts = math::floor(2.0 * half_m / UNSEEN_EVERY_M) + 1;
    (0..=parts).map(move |k| half_m * (2.0 * k as f32 / parts as f32 - 1.0))
}

/// Returns the centres of the obstacle cells within the reach behind: [`ObstaclePoints`] may never
/// have met them, or may have dropped them.
pub(crate) fn obstacle_cells<const TILES: usize, const SLOTS: usize>(
    tiles: &Tiles<TILES, SLOTS>,
    robot: Point,
    tuning: &MapTuning,
) -> impl Iterator<Item = Point> {
    let obstacles = |x, y| tiles.row(x, y).obstacle();
    cells_around(robot, tuning, obstacles).map(|cell| {
        let corner = cell.corner();
        Point {
            x_m: corner.x_m + 0.5 * CELL_M,
            y_m: corner.y_m + 0.5 * CELL_M,
        }
    })
}

/// Returns the centres of the cells around the robot that it must not touch on uneven ground:
/// obstacles, negative obstacles and unknown cells that border on free cells.
pub(crate) fn border_cells<const TILES: usize, const SLOTS: usize>(
    tiles: &Tiles<TILES, SLOTS>,
    robot: Point,
    tuning: &MapTuning,
) -> impl Iterator<Item = Point> {
    let rims = |x, y| {
        let free = |dy: i32| tiles.row(x - 1, y + dy).free();
        let here = free(0);
        (here | here >> 2 | free(-1) >> 1 | free(1) >> 1) & !(here >> 1)
    };
    cells_around(robot, tuning, rims).map(Cell::centre)
}

/// Returns the `border_cells`, each with its own margin, metres. An obstacle may begin before its
/// cell, because a hit is marked `hit_depth_m` behind the beam's end.
pub fn inflated_border_cells<const TILES: usize, const SLOTS: usize>(
    tiles: &Tiles<TILES, SLOTS>,
    robot: Point,
    tuning: &Tuning,
) -> impl Iterator<Item = (Point, f32)> {
    let hit_depth_m = tuning.ground.hit_depth_m;
    border_cells(tiles, robot, &tuning.map).map(move |at| match tiles.class(at.cell()) {
        Class::Obstacle => (at, hit_depth_m),
        _ => (at, 0.0),
    })
}

/// Returns the cells that `of` sets in the square of the reach behind: bit k of `of(x, y)` is cell
/// (x + k, y). The reach is at most 15 cells, so that a row is a word.
fn cells_around<F: Fn(i32, i32) -> u64>(
    robot: Point,
    tuning: &MapTuning,
    of: F,
) -> impl Iterator<Item = Cell> + use<F> {
    let reach = math::floor(tuning.reach_behind_m / CELL_M).min(15);
    let Cell { x, y } = robot.cell();
    let (x, across) = (x - reach, (1 << (2 * reach + 1)) - 1);
    (y - reach..=y + reach).flat_map(move |y| {
        let row = of(x, y) as u32 & across;
        ones(row).map(move |k| Cell { x: x + k as i32, y })
    })
}

/// Returns true if a point is within reach of the robot.
fn within_reach(tuning: &MapTuning, pose: &Pose, point: Point) -> bool {
    let is_ahead = pose.to_robot(point).x_m > 0.0;
    let reach_m = if is_ahead {
        tuning.reach_m
    } else {
        tuning.reach_behind_m
    };
    point.distance2(pose.point()) < reach_m * reach_m
}

/// Returns true if a point lies inside the robot's rectangle by more than `same_point_m`.
fn is_inside(config: &Config, pose: &Pose, point: Point) -> bool {
    let (robot, inside_m) = (&config.robot, config.tuning.map.same_point_m);
    let Point { x_m, y_m } = pose.to_robot(point);
    x_m.abs() < robot.half_length_m - inside_m && y_m.abs() < robot.half_width_m - inside_m
}

/// The evidence of a scan about the place of a point.
enum Visibility {
    /// A beam ended there.
    Hit,
    /// A beam passed through.
    Through,
    /// The place is out of view, or hidden behind something nearer.
    Unseen,
}

/// Returns the visibility of a point from the sensor at `from`, by the two beams beside it. At a
/// corner one beam may meet the point or nothing while the other passes.
fn visibility(
    (pose, from): (&Pose, Point),
    laser: &LaserMount,
    ranges_mm: &[u16],
    point: Point,
    through_m: f32,
) -> Visibility {
    let (dx, dy) = (point.x_m - from.x_m, point.y_m - from.y_m);
    let bearing = math::wrap(math::atan2(dy, dx) - pose.yaw_rad - laser.first_bearing_rad);
    let right = math::floor(bearing / laser.bearing_step_rad);
    if right < 0 || right + 1 >= ranges_mm.len() as i32 {
        return Visibility::Unseen;
    }
    let distance = math::sqrt(dx * dx + dy * dy);
    let beyond = |index: usize| {
        informative_range_mm(ranges_mm, index, laser.range_limit_mm)
            .map(|range| f32::from(range) * 1e-3 - distance)
    };
    let beyond = [beyond(right as usize), beyond(right as usize + 1)];
    if beyond
        .iter()
        .flatten()
        .any(|beyond| beyond.abs() <= through_m)
    {
        Visibility::Hit
    } else if beyond
        .iter()
        .all(|beyond| beyond.is_some_and(|beyond| beyond > through_m))
    {
        Visibility::Through
    } else {
        Visibility::Unseen
    }
}

#[cfg(test)]
mod tests;

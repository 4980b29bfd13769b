//! How another robot's map lies in this robot's map.
//!
//! A *sample* is up to [`MOST_CELLS`] obstacle cells of several tiles of the other map. It is
//! matched as a scan is:
//!
//! ```text
//! points = the sample, seen from where this robot would be in the other map
//! search = the shift and the turn at which most points lie on obstacles of the own map  (`search`)
//! pose   = align(own map, points), from there                                       (`alignment`)
//! ```
//!
//! One tile may fit several places: a wall, a corner. A sample of several tiles seldom does, and it
//! holds the yaw better. It counts only if no other place is nearly as good. A cell beside two
//! others of a straight wall measures across the wall only.
//!
//! Units: metres, radians; map cells inside the alignment.

use crate::config::LocaliseTuning;
use crate::geometry::{CELL_M, Cell, Point, Pose};
use crate::grid::bits::ones;
use crate::localise::alignment::{Unobserved, align};
use crate::localise::scan_points::{ScanPoint, ScanPoints};
use crate::localise::search::{APART, Peak, peak};
use crate::localise::symmetric::Symmetric;
use crate::localise::{carry, in_cells, to_cells, to_metres};
use crate::map::{Class, Tiles};
use crate::math;

/// Greatest number of cells of a sample: as many as a search counts.
pub(crate) const MOST_CELLS: usize = 63;
/// Greatest number of a tile's cells in a sample, so that it has four tiles at least.
const MOST_OF_TILE: usize = 15;
/// Cells along a tile's side.
const SIDE: i32 = 32;
/// Information of a cell as a share of that of a beam. The cells of a wall share the error of its
/// row.
const CELL_SHARE: f32 = 0.2;
/// Turn from one try of a search to the next, radians: 1°, a cell at 5.7 m.
const SEARCH_RAD: f32 = 0.0175;
/// Greatest number of tries to either side.
const MOST_TURNS: f32 = 15.0;
/// Greatest standard deviation of the sample's place, metres: the search reaches twice as far.
const MOST_SD_M: f32 = 0.8;
/// Share of the cells that must lie on obstacles where they fit best.
const LEAST_HITS: f32 = 0.5;
/// Most of them that may do so elsewhere, as a share.
const MOST_SECOND: f32 = 0.75;
/// Share of the cells on known ground that must lie within a cell of an obstacle in the end, and of
/// all cells that must have floor before them. Something may have moved between the two maps.
const LEAST_NEAR: f32 = 0.85;

/// The low and the high plane of a tile's cells.
type Cells = [[u32; SIDE as usize]; 2];

/// What a sample of another map says.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Overlap {
    /// Nothing: it fits several places, or none that the own map knows.
    Silent,
    /// It contradicts the map.
    Contradicted,
    /// It fits one place.
    Matched {
        /// This robot's pose in its own map, if the one in the other map is right.
        pose: Pose,
        /// The covariance of that.
        covariance: Symmetric,
    },
}

/// The directions in which the floor before a wall may lie.
const FRONTS: [(i32, i32); 4] = [(-1, 0), (1, 0), (0, -1), (0, 1)];
/// Distance of a cell that is before a wall in both maps, cells.
const BEFORE: i32 = 2;

/// A cell of a sample in a word: column, row, the direction of the floor before it, and if the wall
/// is straight there.
#[derive(Clone, Copy)]
struct Packed(u32);

impl Packed {
    const BITS: u32 = 14;
    const BIAS: i32 = 1 << 13;

    fn new(cell: Cell, front: u32, is_straight: bool) -> Self {
        let [x, y] = [cell.x, cell.y].map(|k| (k + Self::BIAS) as u32 & ((1 << Self::BITS) - 1));
        let rest = front | u32::from(is_straight) << 2;
        Self(x | y << Self::BITS | rest << (2 * Self::BITS))
    }

    fn cell(self) -> Cell {
        let of = |word: u32| (word & ((1 << Self::BITS) - 1)) as i32 - Self::BIAS;
        Cell {
            x: of(self.0),
            y: of(self.0 >> Self::BITS),
        }
    }

    fn front(self) -> (i32, i32) {
        let front = (self.0 >> (2 * Self::BITS) & 3) as usize;
        FRONTS.get(front).copied().unwrap_or_default()
    }

    /// Returns a cell on the floor before the wall.
    fn before(self) -> Cell {
        let (x, y) = self.front();
        self.cell().offset(BEFORE * x, BEFORE * y)
    }

    /// Returns the normal of the wall; `None` at an end and at a corner.
    fn normal(self) -> Option<(f32, f32)> {
        let is_straight = self.0 >> (2 * Self::BITS + 2) & 1 == 1;
        let (x, y) = self.front();
        is_straight.then_some((x as f32, y as f32))
    }
}

/// Returns true if a cell of a sample is of this tile.
pub(crate) fn is_of_tile(word: u32, tile: (i32, i32)) -> bool {
    let Cell { x, y } = Packed(word).cell();
    (x.div_euclid(SIDE), y.div_euclid(SIDE)) == tile
}

/// Adds obstacle cells of a tile to a sample, evenly among those before which the own map has
/// floor. Both sides of a wall look alike, so a wall that the robots saw from two sides must not
/// count.
pub(crate) fn add_tile(
    (column, row): (i32, i32),
    [low, high]: &Cells,
    is_floor: impl Fn(Cell) -> bool,
    mut add: impl FnMut(u32),
) {
    let words = |row: usize| {
        let words = low.get(row).zip(high.get(row));
        words.map_or([0; 2], |(low, high)| [low & !high, high & !low])
    };
    let row_cells = |y: usize| {
        let rows = [
            y.checked_sub(1).map_or([0; 2], words),
            words(y),
            words(y + 1),
        ];
        let [_, standing] = words(y);
        let cells = ones(standing).filter_map(move |x| {
            let cell = Cell {
                x: column * SIDE + x as i32,
                y: row * SIDE + y as i32,
            };
            front(rows, x).map(|(front, is_straight)| Packed::new(cell, front, is_straight))
        });
        cells.filter(|packed| is_floor(packed.before()))
    };
    let count: usize = (0..low.len()).map(|y| row_cells(y).count()).sum();
    let stride = count.div_ceil(MOST_OF_TILE).max(1);
    let cells = (0..low.len()).flat_map(row_cells);
    cells.step_by(stride).for_each(|packed| add(packed.0));
}

/// Returns the direction of the floor beside an obstacle cell, as an index of [`FRONTS`], and true
/// if the wall is straight there; `None` without floor. Each row has its free cells and its
/// obstacles.
fn front(rows: [[u32; 2]; 3], column: u32) -> Option<(u32, bool)> {
    let around = |row: [u32; 2]| row.map(|word| (u64::from(word) << 1 >> column & 7) as u32);
    let [[below, wall_below], [here, wall_here], [above, wall_above]] = rows.map(around);
    let is_level = wall_here == 0b111;
    let is_upright = wall_below & wall_above & 0b010 != 0;
    let floors = [
        (here & 0b001 != 0, is_upright && !is_level),
        (here & 0b100 != 0, is_upright && !is_level),
        (below & 0b010 != 0, is_level && !is_upright),
        (above & 0b010 != 0, is_level && !is_upright),
    ];
    let mut found = (0..).zip(floors).filter(|(_, (is_floor, _))| *is_floor);
    let (front, (_, is_straight)) = found.next()?;
    Some((front, is_straight))
}

/// Matches a sample. The robot is at `there` in the other map, and at `here` in its own one, with
/// this covariance.
#[inline(never)]
pub(crate) fn overlap<const TILES: usize, const SLOTS: usize>(
    tiles: &Tiles<TILES, SLOTS>,
    sample: &[u32],
    (there, here): (&Pose, &Pose),
    covariance: &Symmetric,
    tuning: &LocaliseTuning,
) -> Overlap {
    let tuning = &LocaliseTuning {
        slip_gap: f32::INFINITY,
        ..tuning.weighted(CELL_SHARE)
    };
    let mut points = ScanPoints::new();
    see(sample, there, &mut points);
    let Some(information) = to_cells(covariance).inverse() else {
        return Overlap::Silent;
    };
    let Some(start) = search(tiles, &points, here, covariance) else {
        return Overlap::Silent;
    };
    let prior = (in_cells(here), &information);
    let found = align(tiles, &points, prior, in_cells(&start), tuning);
    let (near, counted) = found.agreement.counts();
    if f32::from(near) < LEAST_NEAR * f32::from(counted) {
        return Overlap::Contradicted;
    }
    let [x, y, yaw_rad] = found.pose;
    let pose = Pose {
        x_m: x * CELL_M,
        y_m: y * CELL_M,
        yaw_rad,
        ..*here
    };
    let is_floor = |&&word: &&u32| {
        let before = there.to_robot(Packed(word).before().centre());
        tiles.class(pose.to_map(before).cell()) == Class::Free
    };
    let floors = sample.iter().filter(is_floor).count();
    if (floors as f32) < LEAST_NEAR * sample.len() as f32 {
        return Overlap::Contradicted;
    }
    let is_held = found.unobserved == Unobserved::Nothing;
    let Some(covariance) = found.information.inverse().filter(|_| is_held) else {
        return Overlap::Silent;
    };
    Overlap::Matched {
        pose,
        covariance: to_metres(&covariance),
    }
}

/// Writes a sample as points in the frame of a robot. They are too many to return by value.
fn see(sample: &[u32], robot: &Pose, points: &mut ScanPoints) {
    let (sin, cos) = math::sin_cos(robot.yaw_rad);
    for &word in sample.iter().take(MOST_CELLS) {
        let packed = Packed(word);
        let point = ScanPoint {
            end: robot.to_robot(packed.cell().centre()),
            normal: packed
                .normal()
                .map(|(x, y)| (cos * x + sin * y, cos * y - sin * x)),
        };
        // There is room: see MOST_CELLS.
        let _ = points.push(point);
    }
}

/// Returns the standard deviation of a place, if `covariance` is that of a motion about the robot.
pub(crate) fn sd_m(covariance: &Symmetric, robot: Point, place: Point) -> f32 {
    let shift = Point {
        x_m: place.x_m - robot.x_m,
        y_m: place.y_m - robot.y_m,
    };
    let p = carry(covariance, shift);
    math::sqrt(p.xx.max(p.yy))
}

/// Searches shifts and turns for the only one at which many points lie on obstacles. The sample
/// turns about its middle. Returns the robot's pose there.
#[inline(never)]
fn search<const TILES: usize, const SLOTS: usize>(
    tiles: &Tiles<TILES, SLOTS>,
    points: &ScanPoints,
    here: &Pose,
    covariance: &Symmetric,
) -> Option<Pose> {
    let count = points.len() as f32;
    let sum = points
        .iter()
        .fold((0.0, 0.0), |(x, y), it| (x + it.end.x_m, y + it.end.y_m));
    let middle = Point {
        x_m: sum.0 / count,
        y_m: sum.1 / count,
    };
    let place = here.to_map(middle);
    if sd_m(covariance, here.point(), place) > MOST_SD_M {
        return None;
    }
    let half = 3.0 * math::sqrt(covariance.tt) / SEARCH_RAD;
    let half = math::floor(half.min(MOST_TURNS)) + 1;
    let turned = |turns: i32| {
        let pose = Pose {
            x_m: 0.0,
            y_m: 0.0,
            yaw_rad: math::wrap(here.yaw_rad + turns as f32 * SEARCH_RAD),
            ..*here
        };
        let arm = pose.to_map(middle);
        Pose {
            x_m: place.x_m - arm.x_m,
            y_m: place.y_m - arm.y_m,
            ..pose
        }
    };
    let (mut best, mut second, mut at) = (Peak::default(), 0, *here);
    for turns in -half..=half {
        let pose = turned(turns);
        let found = peak(tiles, points, &pose);
        let (x, y) = found.shift;
        let off = (x - best.shift.0).abs().max((y - best.shift.1).abs());
        second = second.max(found.second);
        if off > APART {
            second = second.max(found.hits.min(best.hits));
        }
        if found.hits > best.hits {
            best = found;
            at = Pose {
                x_m: pose.x_m + x as f32 * CELL_M,
                y_m: pose.y_m + y as f32 * CELL_M,
                ..pose
            };
        }
    }
    let (hits, second) = (best.hits as f32, second as f32);
    (second <= MOST_SECOND * hits && hits >= LEAST_HITS * count).then_some(at)
}

#[cfg(test)]
mod tests;

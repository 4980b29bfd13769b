//! A scan into the map: every beam frees the cells it went through and marks the cell it ended in.
//!
//! The level laser carries occupancy: its beams run in the plane. The tilted laser marks what stands higher than
//! `STEP_M` above the robot's ground, and frees nothing, because its beams run above the cells they cross.
//! Cells are visited by Amanatides–Woo traversal.
//!
//! Robustness, each rule with its reason:
//! - a beam does not erode an obstacle within `GUARD_M` of its own end: at a grazing angle it runs through the wall's
//!   own cells first;
//! - a lone no-return between two returns is a dropout, and a no-return stops at the first obstacle: it must not tunnel;
//! - near the robot beams are denser than cells, so only every second (fourth) frees cells there, and only every fourth beam is
//!   evidence for what is free already.
//!
//! Units: metres, radians; ranges in millimetres.

use super::Map;
use super::tiles::{Class, Cursor, NoRoom};
use crate::config::Laser;
use crate::geometry::{CELL_M, Cell, Point, Pose};
use crate::math;
use crate::planner::{INVALID_MM, NO_RETURN_MM};

/// An obstacle's least height above the robot's ground for the tilted laser, metres: above the 3-AT's ground clearance
/// and three sigma of an attitude error of 1° at the tilted beam's reach.
pub const STEP_M: f32 = 0.15;
/// Length before a beam's end in which it does not erode obstacles, metres.
const GUARD_M: f32 = 0.35;
/// A laser tilted less than this is level, radians.
const LEVEL_RAD: f32 = 0.05;

/// One beam in the plane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Beam {
    /// Where it starts.
    pub(crate) from: Point,
    /// Unit direction.
    pub(crate) direction: (f32, f32),
    /// Its length, metres.
    pub(crate) length_m: f32,
    /// It ended on something.
    pub(crate) hit: bool,
    /// Which of the sweep it is.
    pub(crate) number: usize,
    /// Nearer than this another beam frees the cells, metres.
    free_from_m: f32,
}

impl Beam {
    /// Its end.
    pub(crate) fn end(&self) -> Point {
        Point {
            x_m: self.from.x_m + self.direction.0 * self.length_m,
            y_m: self.from.y_m + self.direction.1 * self.length_m,
        }
    }
}

/// The sensor's place in the plane.
pub(crate) fn sensor_point(pose: &Pose, laser: &Laser) -> Point {
    let (sin, cos) = math::sin_cos(pose.yaw_rad);
    Point {
        x_m: pose.x_m + laser.x_m * cos - laser.y_m * sin,
        y_m: pose.y_m + laser.x_m * sin + laser.y_m * cos,
    }
}

/// Whether the laser sweeps the level plane.
#[must_use]
pub fn is_level(laser: &Laser) -> bool {
    laser.pitch_rad.abs() < LEVEL_RAD
}

/// The range of beam `i` if it says anything: not if it is invalid, nor if it is a dropout, a lone no-return between two
/// returns.
pub(crate) fn informative_range_mm(ranges_mm: &[u16], i: usize, limit_mm: u16) -> Option<u16> {
    let range = *ranges_mm.get(i)?;
    let returned = |k: Option<usize>| {
        k.and_then(|k| ranges_mm.get(k))
            .is_none_or(|&range| range != INVALID_MM && range < limit_mm)
    };
    let dropout = range >= limit_mm && returned(i.checked_sub(1)) && returned(Some(i + 1));
    (range != INVALID_MM && !dropout).then_some(range)
}

/// The level laser's beams that carry information.
pub(crate) fn level_beams<'a>(
    pose: &Pose,
    laser: &'a Laser,
    ranges_mm: &'a [u16],
) -> impl Iterator<Item = Beam> + 'a {
    let from = sensor_point(pose, laser);
    let first = pose.yaw_rad + laser.first_bearing_rad;
    (0..ranges_mm.len()).filter_map(move |i| {
        let limit = laser.range_limit_mm;
        let range = informative_range_mm(ranges_mm, i, limit)?;
        let missing = range >= limit;
        let (sin, cos) = math::sin_cos(first + i as f32 * laser.bearing_step_rad);
        let length_m = if missing {
            f32::from(limit)
        } else {
            f32::from(range)
        } * 1e-3;
        let dense_to_mm = match i & 3 {
            0 => 0,
            2 => 1_400,
            _ => 2_800,
        };
        // A no-return goes through all its cells where a neighbour met something: one of them may be an obstacle, which ends it.
        let beyond = |k: Option<usize>| {
            k.and_then(|k| ranges_mm.get(k))
                .is_none_or(|&beside| beside > dense_to_mm)
        };
        let sure = !missing || (beyond(i.checked_sub(1)) && beyond(Some(i + 1)));
        let free_from_m = if sure {
            f32::from(dense_to_mm) * 1e-3
        } else {
            0.0
        };
        Some(Beam {
            from,
            direction: (cos, sin),
            length_m,
            hit: !missing,
            number: i,
            free_from_m,
        })
    })
}

/// Visit the cells along a beam from `from_m` on, each with the distance at which the beam leaves it, until the visitor
/// says stop. The last cell is the one that holds the beam's end.
fn traverse(beam: &Beam, from_m: f32, mut visit: impl FnMut(Cell, f32) -> bool) {
    let start = Point {
        x_m: beam.from.x_m + beam.direction.0 * from_m,
        y_m: beam.from.y_m + beam.direction.1 * from_m,
    };
    let mut cell = start.cell();
    let axis = |position: f32, index: i32, direction: f32| {
        if direction > 1e-6 {
            (
                1,
                ((index + 1) as f32 * CELL_M - position) / direction,
                CELL_M / direction,
            )
        } else if direction < -1e-6 {
            (
                -1,
                (index as f32 * CELL_M - position) / direction,
                -CELL_M / direction,
            )
        } else {
            (0, f32::MAX, 0.0)
        }
    };
    let (step_x, mut next_x, every_x) = axis(start.x_m, cell.x, beam.direction.0);
    let (step_y, mut next_y, every_y) = axis(start.y_m, cell.y, beam.direction.1);
    let length = beam.length_m - from_m;
    loop {
        let leaves = if next_x < next_y { next_x } else { next_y };
        if !visit(cell, leaves + from_m) || leaves >= length {
            return;
        }
        if next_x < next_y {
            cell.x += step_x;
            next_x += every_x;
        } else {
            cell.y += step_y;
            next_y += every_y;
        }
    }
}

impl<const TILES: usize, const SLOTS: usize> Map<TILES, SLOTS> {
    /// Enter one scan of `laser`, taken at `pose`. What there is no room for sets [`Map::out_of_box`] or [`Map::pool_full`].
    pub fn integrate(&mut self, pose: &Pose, laser: &Laser, ranges_mm: &[u16]) {
        if is_level(laser) {
            for beam in level_beams(pose, laser, ranges_mm) {
                self.free_along(&beam);
            }
            for beam in level_beams(pose, laser, ranges_mm) {
                if beam.hit {
                    self.hit(beam.end().cell());
                }
            }
        } else {
            self.mark_standing(pose, laser, ranges_mm);
        }
    }

    /// The robot stands here, so a disc of `radius_m` around it is free.
    pub fn free_footprint(&mut self, centre: Point, radius_m: f32) {
        let (middle, reach) = (centre.cell(), math::floor(radius_m / CELL_M) + 1);
        for y in middle.y - reach..=middle.y + reach {
            for x in middle.x - reach..=middle.x + reach {
                let cell = Cell { x, y };
                let (dx, dy) = (
                    cell.centre().x_m - centre.x_m,
                    cell.centre().y_m - centre.y_m,
                );
                if dx * dx + dy * dy <= radius_m * radius_m
                    && self.tiles.class(cell) == Class::Unknown
                {
                    self.store(cell, Class::Free);
                }
            }
        }
    }

    fn free_along(&mut self, beam: &Beam) {
        if beam.length_m <= beam.free_from_m {
            return;
        }
        let mut cursor = Cursor::default();
        let guard_from_m = if beam.hit {
            beam.length_m - GUARD_M
        } else {
            f32::MAX
        };
        // Free cells are passed again and again; every fourth beam is witness enough.
        let witness = beam.number & 3 == 0;
        traverse(beam, beam.free_from_m, |cell, leaves_m| {
            if beam.hit && leaves_m >= beam.length_m {
                return false;
            }
            match self.tiles.class_at(&mut cursor, cell) {
                Class::Free if !witness => true,
                Class::Obstacle | Class::Negative if leaves_m > guard_from_m => true,
                class => self.pass(cell, class) && (beam.hit || class.is_open()),
            }
        });
    }

    /// A beam went through a cell; false where there is no room to note it.
    fn pass(&mut self, cell: Cell, class: Class) -> bool {
        let now = if self.evidence.covers(cell) {
            self.evidence.pass(cell, class)
        } else if class == Class::Unknown {
            Class::Free
        } else {
            class
        };
        now == class || self.store(cell, now)
    }

    fn hit(&mut self, cell: Cell) {
        let class = self.tiles.class(cell);
        let now = if self.evidence.covers(cell) {
            self.evidence.hit(cell, class)
        } else {
            Class::Obstacle
        };
        if now != class {
            self.store(cell, now);
        }
    }

    /// Store, remembering what there was no room for; false if there was none.
    fn store(&mut self, cell: Cell, class: Class) -> bool {
        match self.tiles.set(cell, class) {
            Ok(()) => true,
            Err(NoRoom::Box) => {
                self.out_of_box = true;
                false
            }
            Err(NoRoom::Pool) => {
                self.pool_full = true;
                false
            }
        }
    }

    fn mark_standing(&mut self, pose: &Pose, laser: &Laser, ranges_mm: &[u16]) {
        let from = sensor_point(pose, laser);
        let (sin_tilt, cos_tilt) = math::sin_cos(laser.pitch_rad + pose.pitch_rad);
        let (sin_roll, _) = math::sin_cos(pose.roll_rad);
        let (sin_yaw, cos_yaw) = math::sin_cos(pose.yaw_rad);
        for (i, &range) in ranges_mm.iter().enumerate() {
            if range == INVALID_MM || range == NO_RETURN_MM || range >= laser.range_limit_mm {
                continue;
            }
            let (sin, cos) =
                math::sin_cos(laser.first_bearing_rad + i as f32 * laser.bearing_step_rad);
            let range_m = f32::from(range) * 1e-3;
            let (ahead, left) = (range_m * cos * cos_tilt, range_m * sin);
            let height = laser.z_m - range_m * cos * sin_tilt + left * sin_roll;
            if height > STEP_M {
                let end = Point {
                    x_m: from.x_m + ahead * cos_yaw - left * sin_yaw,
                    y_m: from.y_m + ahead * sin_yaw + left * cos_yaw,
                };
                self.hit(end.cell());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::traverse;
    use super::*;

    fn beam(x_m: f32, y_m: f32, angle: f32, length_m: f32) -> Beam {
        let (sin, cos) = math::sin_cos(angle);
        Beam {
            from: Point { x_m, y_m },
            direction: (cos, sin),
            length_m,
            hit: true,
            number: 0,
            free_from_m: 0.0,
        }
    }

    /// Every cell that the segment passes more than a hair inside of must be visited, by dense sampling.
    #[test]
    fn the_traversal_visits_every_cell_of_the_segment_in_order() {
        for k in 0..200 {
            let b = beam(
                0.013 * k as f32,
                -0.7 + 0.01 * k as f32,
                0.17 * k as f32,
                0.05 + 0.02 * k as f32,
            );
            let mut cells = std::vec::Vec::new();
            traverse(&b, 0.0, |cell, _| {
                cells.push(cell);
                true
            });
            for pair in cells.windows(2) {
                assert_eq!(
                    (pair[0].x - pair[1].x).abs() + (pair[0].y - pair[1].y).abs(),
                    1
                );
            }
            let mut at = 0;
            for i in 0..=2000 {
                let s = b.length_m * i as f32 / 2000.0;
                let p = Point {
                    x_m: b.from.x_m + b.direction.0 * s,
                    y_m: b.from.y_m + b.direction.1 * s,
                };
                let inside = |v: f32| (v / CELL_M - (v / CELL_M).round()).abs() > 1e-3;
                if inside(p.x_m) && inside(p.y_m) {
                    while at < cells.len() && cells[at] != p.cell() {
                        at += 1;
                    }
                    assert!(at < cells.len(), "beam {k} misses {:?}", p.cell());
                }
            }
        }
    }
}

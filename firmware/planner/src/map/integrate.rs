//! Scan integration on flat ground: a beam frees the cells that it crosses and marks the cell in
//! which it ends.
//!
//! Beams of the level laser run in the plane, so they free and mark. Beams of the tilted laser run
//! above the cells that they cross, so they free nothing; they mark ends higher than
//! `tilted_obstacle_m` above the robot's ground.
//!
//! - A beam does not erode an obstacle within `guard_m` of its own end, because at a grazing angle
//!   it crosses the wall's own cells first.
//! - A lone no-return between two returns is a dropout and frees nothing.
//! - A no-return stops at the first obstacle, so that it does not tunnel through a wall.
//! - Where the beams of a step are longer together than [`MOST_BEAMS_M`], only a share of them
//!   frees cells, in turn, so that a step's time has a bound.
//! - Near the robot beams are denser than cells. So only every second or fourth beam frees cells
//!   there, and only every fourth beam is evidence for a cell that is free already.
//!
//! Units: metres, radians; ranges in millimetres.

#[cfg(test)]
mod tests;

use crate::config::{Config, MapTuning};
use crate::geometry::{CELL_M, Cell, Point, Pose};
use crate::grid::Class;
use crate::input::{INVALID_MM, Input, NO_RETURN_MM, informative_range_mm};
use crate::map::Map;
use crate::map::arrivals::came;
use crate::map::evidence::Evidence;
use crate::map::tiles::{NoRoom, TileMut};
use crate::map::traversal::Traversal;
use crate::math;
use crate::robot::LaserMount;

/// Most metres of beams that free cells in a step: 181 beams of 12 m, and what rounding adds.
const MOST_BEAMS_M: u32 = 2_200;

/// The share of the beams that frees cells in a step: every `every`-th one, from `phase` on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Share {
    every: usize,
    phase: usize,
}

impl Share {
    /// All beams.
    #[cfg(test)]
    pub(crate) const ALL: Self = Self { every: 1, phase: 0 };

    /// Returns the share of a step. The phases follow one another with the periods.
    pub(crate) fn of(config: &Config, input: &Input<'_>) -> Self {
        let lasers = config.lasers.iter().zip(input.scans);
        let metres = |(laser, ranges_mm): (&LaserMount, &[u16])| {
            let length_mm = |&range: &u16| u32::from(range.min(laser.range_limit_mm));
            ranges_mm.iter().map(length_mm).sum::<u32>() / 1_000
        };
        let level = lasers.filter(|(laser, _)| laser.is_level());
        let all_m: u32 = level.map(metres).sum();
        let every = all_m.div_ceil(MOST_BEAMS_M).max(1);
        let period = input.time_ms / config.period_ms().max(1);
        Self {
            every: every as usize,
            phase: (period % every) as usize,
        }
    }

    const fn has(self, number: usize) -> bool {
        number % self.every == self.phase
    }
}

/// A beam in the plane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Beam {
    /// The sensor's point.
    pub(crate) from: Point,
    /// Unit direction.
    pub(crate) direction: (f32, f32),
    /// Length, metres.
    pub(crate) length_m: f32,
    /// True if the beam ended on something.
    pub(crate) hit: bool,
    /// Number in the sweep.
    pub(crate) number: usize,
    /// Length from which on the beam frees cells, metres; other beams free the nearer ones.
    free_from_m: f32,
}

impl Beam {
    /// Returns the beam's end.
    pub(crate) fn end(&self) -> Point {
        self.at(self.length_m)
    }

    /// Returns the point at a length along the beam.
    fn at(&self, along_m: f32) -> Point {
        Point {
            x_m: self.from.x_m + self.direction.0 * along_m,
            y_m: self.from.y_m + self.direction.1 * along_m,
        }
    }

    /// Returns true if the beam is evidence for free cells. Every fourth beam is, because many
    /// beams pass the same free cell.
    const fn is_counted(&self) -> bool {
        self.number & 3 == 0
    }
}

/// Returns the sensor's point in the plane.
pub(crate) fn sensor_point(pose: &Pose, laser: &LaserMount) -> Point {
    pose.to_map(Point {
        x_m: laser.x_m,
        y_m: laser.y_m,
    })
}

/// Returns the beams of the level laser that carry information.
pub(crate) fn level_beams<'a>(
    pose: &Pose,
    laser: &'a LaserMount,
    ranges_mm: &'a [u16],
    tuning: &MapTuning,
) -> impl Iterator<Item = Beam> + use<'a> {
    let from = sensor_point(pose, laser);
    let second_from_mm = tuning.second_beam_from_mm;
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
            2 => second_from_mm,
            _ => 2 * second_from_mm,
        };
        // If a neighbour met something nearer, a no-return may meet an obstacle there, which ends
        // it. So it crosses all its cells.
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

impl<const TILES: usize, const SLOTS: usize> Map<TILES, SLOTS> {
    /// Enters a scan of `laser`, taken at `pose`. A cell without room sets [`Map::out_of_box`] or
    /// [`Map::pool_full`].
    pub(crate) fn integrate(
        &mut self,
        tuning: &MapTuning,
        pose: &Pose,
        (laser, ranges_mm): (&LaserMount, &[u16]),
        share: Share,
    ) {
        if laser.is_level() {
            let beams = level_beams(pose, laser, ranges_mm, tuning);
            for beam in beams.filter(|beam| share.has(beam.number)) {
                self.free_along(tuning, &beam);
            }
            for beam in level_beams(pose, laser, ranges_mm, tuning) {
                if beam.hit {
                    self.hit(tuning, beam.end().cell());
                }
            }
        } else {
            self.mark_tilted_hits(tuning, pose, laser, ranges_mm);
        }
    }

    /// Frees the cells that a beam of the level laser crossed up to `length_m`, whatever it met
    /// there.
    pub(crate) fn free_view(
        &mut self,
        tuning: &MapTuning,
        pose: &Pose,
        laser: &LaserMount,
        (number, length_m): (usize, f32),
    ) {
        let bearing =
            pose.yaw_rad + laser.first_bearing_rad + number as f32 * laser.bearing_step_rad;
        let (sin, cos) = math::sin_cos(bearing);
        let beam = Beam {
            from: sensor_point(pose, laser),
            direction: (cos, sin),
            length_m,
            hit: false,
            number,
            free_from_m: 0.0,
        };
        self.free_along(tuning, &beam);
    }

    /// Frees the unknown cells in a disc of `radius_m` around the robot, because it stands there.
    pub(crate) fn free_footprint(&mut self, centre: Point, radius_m: f32) {
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

    #[inline(never)]
    fn free_along(&mut self, tuning: &MapTuning, beam: &Beam) {
        let from_m = beam.free_from_m;
        let (start, length_m) = (beam.at(from_m), beam.length_m - from_m);
        if length_m <= 0.0 {
            return;
        }
        let mut traversal = Traversal::new(start, beam.direction, length_m, beam.hit);
        let mut goes_on = true;
        while goes_on && !traversal.is_over() {
            let tile = traversal.tile();
            if let Some(goes) = self.cross_compact(&mut traversal, beam.hit) {
                goes_on = goes;
                continue;
            }
            goes_on = match self.tiles.open(tile) {
                Ok(cells) => {
                    let pass = TilePass {
                        tuning,
                        evidence: &mut self.evidence,
                        cells,
                        tile,
                        guard_from_m: length_m - tuning.guard_m,
                        stops_at_obstacle: !beam.hit,
                    };
                    if beam.is_counted() {
                        pass.run::<true>(&mut traversal)
                    } else {
                        pass.run::<false>(&mut traversal)
                    }
                }
                Err(no_room) => {
                    self.record_failure(no_room);
                    false
                }
            };
        }
    }

    fn hit(&mut self, tuning: &MapTuning, cell: Cell) {
        let class = self.tiles.class(cell);
        let now = if self.evidence.covers(cell) {
            self.evidence.hit(cell, class, tuning)
        } else {
            came(class)
        };
        if now != class {
            self.store(cell, now);
        }
    }

    /// Stores a class; records a lack of room.
    pub(super) fn store(&mut self, cell: Cell, class: Class) {
        if let Err(no_room) = self.tiles.set(cell, class) {
            self.record_failure(no_room);
        }
    }

    /// Records a lack of room.
    pub(super) const fn record_failure(&mut self, no_room: NoRoom) {
        match no_room {
            NoRoom::Box => self.out_of_box = true,
            NoRoom::Pool => self.pool_full = true,
            // The next beams will find it.
            NoRoom::Later => {}
        }
    }

    fn mark_tilted_hits(
        &mut self,
        tuning: &MapTuning,
        pose: &Pose,
        laser: &LaserMount,
        ranges_mm: &[u16],
    ) {
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
            if height > tuning.tilted_obstacle_m {
                let end = Point {
                    x_m: from.x_m + ahead * cos_yaw - left * sin_yaw,
                    y_m: from.y_m + ahead * sin_yaw + left * cos_yaw,
                };
                self.hit(tuning, end.cell());
            }
        }
    }
}

/// The passage of a beam through a tile.
struct TilePass<'a> {
    tuning: &'a MapTuning,
    evidence: &'a mut Evidence,
    cells: TileMut<'a>,
    tile: (i32, i32),
    /// Length from which on the beam does not erode obstacles, metres.
    guard_from_m: f32,
    /// The beam met nothing, so it ends at the first obstacle and does not erode it.
    stops_at_obstacle: bool,
}

impl TilePass<'_> {
    /// Frees the cells of the tile. Returns true if the beam continues in the next tile.
    #[inline(never)]
    fn run<const COUNTS: bool>(mut self, traversal: &mut Traversal) -> bool {
        traversal.cross_tile(|row, bit, leaves_m| {
            if !self.cells.is_free(row, bit) {
                return self.pass(row, bit, leaves_m);
            }
            if COUNTS {
                let cell = Traversal::cell(self.tile, row, bit);
                if self.evidence.covers(cell) {
                    self.evidence.pass_free(cell, self.tuning);
                }
            }
            true
        })
    }

    /// Passes a cell that is not free. Returns true if the beam continues.
    #[inline(never)]
    fn pass(&mut self, row: usize, bit: u32, leaves_m: f32) -> bool {
        let class = self.cells.class(row, bit);
        if !class.is_open() && !self.stops_at_obstacle && leaves_m > self.guard_from_m {
            return true;
        }
        let cell = Traversal::cell(self.tile, row, bit);
        let now = if self.evidence.covers(cell) {
            self.evidence.pass(cell, class, self.tuning)
        } else if class == Class::Unknown {
            Class::Free
        } else {
            class
        };
        if now != class {
            self.cells.set(row, bit, now);
        }
        class.is_open() || !self.stops_at_obstacle
    }
}

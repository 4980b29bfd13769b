//! Scans of any shape in the form of the wire: turned right, cleaned, and reduced to sectors.
//!
//! The wire has at most [`MAX_BEAMS`] ranges a scan. A lidar with m beams is cut into sectors of
//! `g = ⌈m / MAX_BEAMS⌉` neighbouring beams; `⌈m / g⌉` sectors go on the wire, each at the middle
//! of its beams. No beam is left out:
//!
//! | beams of a sector | sector |
//! | --- | --- |
//! | at least one return | the nearest return, or the mean of its surface |
//! | all without return | [`NO_RETURN_MM`]: free up to the range |
//! | else | [`INVALID_MM`]: no information |
//!
//! | reading, metres | beam |
//! | --- | --- |
//! | NaN, negative, −∞, 0 | no information |
//! | below the least range | no information |
//! | within the mask, or the point lies in the robot's hull | no information |
//! | from the least range to below the greatest | return, to the nearest millimetre |
//! | the greatest range or more, +∞ | no return |
//!
//! The greatest range is that of the lidar, at most what the wire can say. A scan with another
//! number of beams than promised is taken as spread evenly over the same field. So
//! [`Sectors::fold`] is total: every list of numbers is a scan of the announced laser.
//!
//! A sector stands at its middle. A wall that is seen askew is nearer at one end of the sector than
//! in its middle, so the nearest return alone would thicken it. With r the nearest and s the step,
//! returns up to
//!
//! ```text
//! r (1 + 2 s (g − 1))
//! ```
//!
//! count as one surface with it: a plane up to 63° askew, whose tangent is 2. The sector has their
//! mean. So a nearest return is never lost, and never farther than that. A return may be
//! `(g − 1)/2` beams aside of where it was. Metres, radians; codes in millimetres.

use fieldline_protocol::message::{INVALID_MM, Laser, MAX_BEAMS, NO_RETURN_MM, Scan};
use fixed::types::{I4F12, I16F16};

use super::footprint::Footprint;
use super::lidar::Lidar;

/// Greatest range that the wire can say, metres.
pub const FARTHEST_RANGE_M: f64 = (NO_RETURN_MM - 1) as f64 / 1000.0;

/// Tangent of the angle up to which a plane is one surface.
const ASKEW: f64 = 2.0;

/// A lidar's beams, as the wire has them.
#[derive(Clone, Debug, PartialEq)]
pub struct Sectors {
    laser: Laser,
    /// Beams that the lidar promises.
    promised: usize,
    /// Beams of a sector.
    group: usize,
    /// Share of the nearest range up to which returns behind it are its surface.
    depth: f64,
    is_reversed: bool,
    least_m: f64,
    most_m: f64,
    /// What a beam at a position can meet of the robot itself.
    own: Vec<Own>,
}

/// What a beam can meet of the robot itself.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Own {
    /// Nothing.
    Clear,
    /// Something at once.
    Masked,
    /// Its hull, between two ranges, metres.
    Hull([f64; 2]),
}

/// A reading, by the table.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Reading {
    Nothing,
    NoReturn,
    /// Metres.
    Return(f64),
}

/// What the beams of a sector say.
#[derive(Clone, Copy, Debug, Default)]
struct Sector {
    /// The nearest return, metres.
    nearest_m: Option<f64>,
    /// Sum and number of the returns of its surface.
    surface: (f64, u32),
    /// Some beam has no return.
    is_free: bool,
    /// Some beam has no information, so the sector is not free.
    is_unknown: bool,
}

impl Sectors {
    /// Cuts a lidar on a robot with this hull into sectors.
    #[must_use]
    pub fn new(lidar: &Lidar, hull: &Footprint) -> Self {
        let promised = lidar.beams.max(1);
        let group = promised.div_ceil(MAX_BEAMS);
        let most_m = lidar.most_m.min(FARTHEST_RANGE_M);
        let (right_rad, step_rad) = (lidar.rightmost_rad(), lidar.step_rad);
        let middle = 0.5 * (group - 1) as f64 * step_rad;
        let [x, y, z] = lidar.position_m.map(I4F12::saturating_from_num::<f64>);
        let laser = Laser {
            x,
            y,
            z,
            pitch: I4F12::saturating_from_num(lidar.pitch_rad),
            first_bearing: I16F16::saturating_from_num(right_rad + middle),
            bearing_step: I16F16::saturating_from_num(step_rad * group as f64),
            beams: promised.div_ceil(group) as u16,
            range_limit_mm: (most_m * 1000.0).round() as u16,
            turn_time_ms: (lidar.turn_time_s * 1000.0).round() as u16,
            newest_first: lidar.is_newest_right(),
        };
        let mut sectors = Self {
            laser,
            promised,
            group,
            depth: ASKEW * step_rad * (group - 1) as f64,
            is_reversed: lidar.is_reversed(),
            least_m: lidar.least_m,
            most_m,
            own: Vec::new(),
        };
        sectors.own = (0..promised)
            .map(|position| sectors.own_at(position, lidar, hull))
            .collect();
        sectors
    }

    /// The laser to announce.
    #[must_use]
    pub const fn laser(&self) -> &Laser {
        &self.laser
    }

    /// Number of beams that a scan should have.
    #[must_use]
    pub const fn promised(&self) -> usize {
        self.promised
    }

    /// Number of neighbouring beams that one range of the wire stands for.
    #[must_use]
    pub const fn group(&self) -> usize {
        self.group
    }

    /// Returns true if the lidar tells its beams from left to right.
    #[must_use]
    pub const fn is_reversed(&self) -> bool {
        self.is_reversed
    }

    /// Bearing on the robot of a position, radians: of beam number `position` from the right. It
    /// follows from the announced laser, so it has the wire's rounding.
    #[must_use]
    pub fn bearing_rad(&self, position: usize) -> f64 {
        let first: f64 = self.laser.first_bearing.to_num();
        let step: f64 = self.laser.bearing_step.to_num();
        let group = self.group as f64;
        first - 0.5 * (group - 1.0) / group * step + step / group * position as f64
    }

    /// Direction of a beam in the robot's frame, of length 1.
    #[must_use]
    pub fn direction(&self, position: usize) -> [f64; 3] {
        let bearing = self.bearing_rad(position);
        let pitch: f64 = self.laser.pitch.to_num();
        let (cos, sin) = (libm::cos(bearing), libm::sin(bearing));
        [cos * libm::cos(pitch), sin, -cos * libm::sin(pitch)]
    }

    /// Returns a scan for the wire. `ranges_m` are the readings in the lidar's own order, in
    /// metres.
    #[must_use]
    pub fn fold(&self, ranges_m: &[f64]) -> Scan {
        let mut sectors = vec![Sector::default(); usize::from(self.laser.beams)];
        let readings = || {
            let pairs = self.pairs(ranges_m.len());
            pairs.map(|(position, beam)| {
                (position / self.group, self.read(position, ranges_m[beam]))
            })
        };
        for (sector, reading) in readings() {
            sectors[sector].note(reading);
        }
        for (sector, reading) in readings() {
            sectors[sector].gather(reading, self.depth);
        }
        Scan {
            ranges_mm: sectors.iter().map(Sector::code).collect(),
        }
    }

    /// Returns position and range, in metres, of every beam of a scan that met something.
    pub fn returns<'a>(&'a self, ranges_m: &'a [f64]) -> impl Iterator<Item = (usize, f64)> + 'a {
        self.pairs(ranges_m.len()).filter_map(|(position, beam)| {
            let range_m = ranges_m[beam];
            let reading = self.read(position, range_m);
            matches!(reading, Reading::Return(_)).then_some((position, range_m))
        })
    }

    /// Positions and beams that belong together. Every beam has a position, and every position a
    /// beam, unless there are no beams.
    fn pairs(&self, beams: usize) -> impl Iterator<Item = (usize, usize)> {
        let promised = self.promised;
        let count = if beams == 0 { 0 } else { beams.max(promised) };
        let is_reversed = self.is_reversed;
        // The k-th of `count` equal parts of the field has its middle in one of `parts`.
        let place = move |k: usize, parts: usize| (2 * k + 1) * parts / (2 * count);
        (0..count).map(move |k| {
            let beam = place(k, beams);
            let beam = if is_reversed { beams - 1 - beam } else { beam };
            (place(k, promised), beam)
        })
    }

    /// Reads one beam by the table.
    fn read(&self, position: usize, range_m: f64) -> Reading {
        let is_own = match self.own[position] {
            Own::Clear => false,
            Own::Masked => true,
            Own::Hull([from_m, to_m]) => (from_m..=to_m).contains(&range_m),
        };
        // The comparison is false for NaN.
        if is_own || !(range_m > 0.0 && range_m >= self.least_m) {
            Reading::Nothing
        } else if range_m >= self.most_m {
            Reading::NoReturn
        } else {
            Reading::Return(range_m)
        }
    }

    /// Returns what a beam can meet of the robot.
    fn own_at(&self, position: usize, lidar: &Lidar, hull: &Footprint) -> Own {
        if lidar.is_masked(self.bearing_rad(position)) {
            return Own::Masked;
        }
        let [x, y, _] = lidar.position_m;
        let [ahead, left, _] = self.direction(position);
        let crossing = || hull.crossing_m([x, y], [ahead, left]);
        let crossing = lidar.ignores_hull.then(crossing).flatten();
        crossing.map_or(Own::Clear, Own::Hull)
    }
}

impl Sector {
    /// Takes one of its beams.
    fn note(&mut self, reading: Reading) {
        match reading {
            Reading::Nothing => self.is_unknown = true,
            Reading::NoReturn => self.is_free = true,
            Reading::Return(range_m) => {
                let nearest_m = self.nearest_m.unwrap_or(range_m);
                self.nearest_m = Some(nearest_m.min(range_m));
            }
        }
    }

    /// Takes a return that lies on the surface of the nearest one: at most that share behind it.
    fn gather(&mut self, reading: Reading, depth: f64) {
        if let (Reading::Return(range_m), Some(nearest_m)) = (reading, self.nearest_m)
            && range_m <= nearest_m * (1.0 + depth)
        {
            self.surface.0 += range_m;
            self.surface.1 += 1;
        }
    }

    /// Returns its code.
    fn code(&self) -> u16 {
        match (self.surface, self.is_free, self.is_unknown) {
            ((sum_m, count @ 1..), ..) => {
                let millimetres = (sum_m / f64::from(count) * 1000.0).round() as u16;
                millimetres.clamp(INVALID_MM + 1, NO_RETURN_MM - 1)
            }
            (_, true, false) => NO_RETURN_MM,
            _ => INVALID_MM,
        }
    }
}

#[cfg(test)]
mod tests;

//! Scans: ends of beams in the robot's frame, each with the normal of the surface that it met.
//!
//! A normal stands on a run of up to nine neighbours that are nearer than 0.3 m to the end and lie
//! on one line. Without such a run the end is a corner, or a thing of its own, and has none.
//!
//! A range of 0 is no reading. A range of [`Laser::most_m`] and more met nothing: the beam is free
//! up to there.
//!
//! Units: millimetres where a name says so, else metres; radians. The robot's frame has x forward
//! and y left.

use heapless::Vec;

use crate::pose::{sin_cos, sqrt};

/// Greatest distance of a neighbour on the same surface, metres.
const NEAR_M: f32 = 0.3;
/// Greatest number of neighbours to one side.
const SIDE: usize = 4;
/// Least length of a surface with a normal, metres.
const LEAST_M: f32 = 0.12;
/// Greatest distance of a neighbour from the surface's line, metres.
const STRAIGHT_M: f32 = 0.04;

/// Most lasers of a robot.
pub const LASERS: usize = 2;

/// A level laser: where it is, and where its beams point. Beam i points at first + i·step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Laser {
    /// Metres ahead of the robot's centre.
    pub x_m: f32,
    /// Metres to the left of it.
    pub y_m: f32,
    /// Direction of the first beam from straight ahead, radians.
    pub first_rad: f32,
    /// From one beam to the next, radians.
    pub step_rad: f32,
    /// Number of beams; 0 for a laser that is not there.
    pub beams: usize,
    /// Range from which on a beam met nothing, metres.
    pub most_m: f32,
}

impl Laser {
    /// A laser that is not there.
    pub const NONE: Self = Self {
        x_m: 0.0,
        y_m: 0.0,
        first_rad: 0.0,
        step_rad: 0.0,
        beams: 0,
        most_m: 0.0,
    };
}

/// The end of a beam.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Beam {
    /// Where the beam begins, in the robot's frame, metres.
    pub(crate) origin: [f32; 2],
    /// In the robot's frame, metres.
    pub(crate) end: [f32; 2],
    /// Something stands at the end.
    pub(crate) hit: bool,
    /// Unit vector across the surface at the end, in the robot's frame.
    pub(crate) normal: Option<[f32; 2]>,
}

/// The beams of all lasers, at most `BEAMS`.
#[derive(Clone, Debug, Default)]
pub(crate) struct Scan<const BEAMS: usize> {
    pub(crate) beams: Vec<Beam, BEAMS>,
}

/// Returns the difference of two points.
fn apart([a, b]: [f32; 2], [c, d]: [f32; 2]) -> [f32; 2] {
    [a - c, b - d]
}

fn length([x, y]: [f32; 2]) -> f32 {
    sqrt(x * x + y * y)
}

impl<const BEAMS: usize> Scan<BEAMS> {
    /// Reads the ranges of the lasers, one laser after the other. Beams beyond `BEAMS` are left
    /// out.
    pub(crate) fn of(lasers: &[Laser; LASERS], ranges_mm: &[u16]) -> Self {
        let mut scan = Self::default();
        let mut rest = ranges_mm;
        for laser in lasers {
            let (own, others) = rest.split_at(laser.beams.min(rest.len()));
            scan.read(laser, own);
            rest = others;
        }
        for k in 0..scan.beams.len() {
            let normal = scan.normal(k);
            if let Some(beam) = scan.beams.get_mut(k) {
                beam.normal = normal;
            }
        }
        scan
    }

    /// Reads the ranges of a laser.
    fn read(&mut self, laser: &Laser, ranges_mm: &[u16]) {
        for (k, &range_mm) in ranges_mm.iter().enumerate() {
            if range_mm == 0 {
                continue;
            }
            let range_m = f32::from(range_mm) * 1e-3;
            let (sin, cos) = sin_cos(laser.first_rad + k as f32 * laser.step_rad);
            let reach_m = range_m.min(laser.most_m);
            let is_full = self.beams.push(Beam {
                origin: [laser.x_m, laser.y_m],
                end: [laser.x_m + reach_m * cos, laser.y_m + reach_m * sin],
                hit: range_m < laser.most_m,
                normal: None,
            });
            if is_full.is_err() {
                return;
            }
        }
    }

    /// Returns the ends where something stands.
    pub(crate) fn hits(&self) -> impl Iterator<Item = &Beam> {
        self.beams.iter().filter(|beam| beam.hit)
    }

    /// Returns the normal of the surface at an end.
    fn normal(&self, k: usize) -> Option<[f32; 2]> {
        let beam = self.beams.get(k).filter(|beam| beam.hit)?;
        let is_beside = |other: &&Beam| other.hit && length(apart(other.end, beam.end)) < NEAR_M;
        let (before, after) = self.beams.split_at_checked(k)?;
        let right = before.iter().rev().take(SIDE).take_while(is_beside).count();
        let left = after
            .iter()
            .skip(1)
            .take(SIDE)
            .take_while(is_beside)
            .count();
        let run = self.beams.get(k - right..=k + left)?;
        let (first, last) = (run.first()?.end, run.last()?.end);
        let along = apart(last, first);
        let length_m = length(along);
        if length_m < LEAST_M || run.len() < 3 {
            return None;
        }
        let normal = [-along[1] / length_m, along[0] / length_m];
        let off = |beam: &Beam| {
            let [x, y] = apart(beam.end, first);
            (x * normal[0] + y * normal[1]).abs()
        };
        run.iter()
            .all(|beam| off(beam) < STRAIGHT_M)
            .then_some(normal)
    }
}

#[cfg(test)]
mod tests {
    use super::{Laser, Scan};

    const LASER: Laser = Laser {
        x_m: 0.1,
        y_m: 0.0,
        first_rad: -core::f32::consts::FRAC_PI_2,
        step_rad: core::f32::consts::PI / 180.0,
        beams: 181,
        most_m: 8.0,
    };

    /// A wall 2 m ahead of the laser; beams to the sides meet nothing.
    fn wall() -> Scan<181> {
        let ranges: std::vec::Vec<u16> = (0..181)
            .map(|k| {
                let angle = (f64::from(k) - 90.0).to_radians();
                let range = 2000.0 / angle.cos();
                if (0.0..=20_000.0).contains(&range) {
                    range as u16
                } else {
                    20_000
                }
            })
            .collect();
        Scan::of(&[LASER, Laser::NONE], &ranges)
    }

    #[test]
    fn a_wall_has_its_normal_and_a_beam_without_an_end_has_none() {
        let scan = wall();
        let [x, y] = scan.beams[90].end;
        assert!((x - 2.1).abs() < 1e-3 && y.abs() < 1e-3);
        let normal = scan.beams[90].normal.unwrap();
        assert!(normal[0].abs() > 0.999, "{normal:?}");
        let hits = scan.hits().count();
        assert!((140..181).contains(&hits), "{hits}");
        assert!(scan.beams[0].normal.is_none() && !scan.beams[0].hit);
    }

    #[test]
    fn a_reading_of_zero_is_none_and_too_many_are_left_out() {
        let scan: Scan<4> = Scan::of(&[LASER, Laser::NONE], &[1000, 0, 1000, 1000, 1000, 1000]);
        assert_eq!(scan.beams.len(), 4);
    }

    #[test]
    fn the_beams_of_a_second_laser_begin_at_its_own_place() {
        let ahead = Laser { beams: 2, ..LASER };
        let back = Laser {
            x_m: -0.2,
            first_rad: core::f32::consts::PI,
            beams: 1,
            ..LASER
        };
        let scan: Scan<4> = Scan::of(&[ahead, back], &[1000, 2000, 3000, 4000]);
        let [right, _, behind] = scan.beams[..] else {
            panic!("{:?}", scan.beams);
        };
        assert_eq!(right.origin, [0.1, 0.0]);
        assert_eq!(behind.origin, [-0.2, 0.0]);
        assert!((right.end[1] + 1.0).abs() < 1e-5 && (behind.end[0] + 3.2).abs() < 1e-5);
    }
}

//! A scan as a particle filter takes it: ends of beams in the robot's frame.
//!
//! The surface normal at an end is that of the line through its neighbours, if they lie on one.
//! With it a match does not pull a wall along itself.
//!
//! Units: metres in the robot's frame; millimetres where a name says so.

use fieldline_protocol::message::{INVALID_MM, Laser};

/// Neighbours on each side that a normal looks at.
const NEIGHBOURS: usize = 4;
/// Greatest distance of a neighbour, metres.
const NEAR_M: f64 = 0.3;
/// Least length of the line, metres.
const LEAST_M: f64 = 0.12;
/// Greatest distance of a neighbour from the line, metres.
const STRAIGHT_M: f64 = 0.04;

/// One beam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Beam {
    /// Its end; at the laser's limit if nothing returned it.
    pub end: [f64; 2],
    /// Something returned it.
    pub hit: bool,
    /// The unit normal of the surface that it met, if its neighbours show one.
    pub normal: Option<[f64; 2]>,
}

/// One scan of a level laser.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Scan {
    /// The laser.
    pub origin: [f64; 2],
    /// The beams that tell anything, in the order of their bearings.
    pub beams: Vec<Beam>,
}

impl Scan {
    /// Reads the ranges of a laser.
    pub(super) fn of(laser: &Laser, ranges_mm: &[u16]) -> Self {
        let origin = [laser.x.to_num::<f64>(), laser.y.to_num::<f64>()];
        let first: f64 = laser.first_bearing.to_num();
        let step: f64 = laser.bearing_step.to_num();
        let beams = (0..).zip(ranges_mm).filter_map(|(number, &range_mm)| {
            if range_mm == INVALID_MM {
                return None;
            }
            let bearing = first + step * f64::from(number);
            // The code for no return is greater than any limit.
            let range_m = f64::from(range_mm.min(laser.range_limit_mm)) * 1e-3;
            Some(Beam {
                end: [
                    origin[0] + libm::cos(bearing) * range_m,
                    origin[1] + libm::sin(bearing) * range_m,
                ],
                hit: range_mm < laser.range_limit_mm,
                normal: None,
            })
        });
        let mut beams: Vec<Beam> = beams.collect();
        for number in 0..beams.len() {
            beams[number].normal = normal(&beams, number);
        }
        Self { origin, beams }
    }
}

/// Returns the normal at the end of a beam.
fn normal(beams: &[Beam], number: usize) -> Option<[f64; 2]> {
    let beam = beams[number];
    if !beam.hit {
        return None;
    }
    let is_near =
        |other: &&Beam| other.hit && length([0, 1].map(|k| other.end[k] - beam.end[k])) < NEAR_M;
    let before = beams[..number]
        .iter()
        .rev()
        .take(NEIGHBOURS)
        .take_while(is_near)
        .count();
    let after = beams[number + 1..]
        .iter()
        .take(NEIGHBOURS)
        .take_while(is_near)
        .count();
    if before + after < 2 {
        return None;
    }
    let line = &beams[number - before..=number + after];
    let (from, to) = (line.first()?.end, line.last()?.end);
    let along = [to[0] - from[0], to[1] - from[1]];
    let length_m = length(along);
    if length_m < LEAST_M {
        return None;
    }
    let normal = [-along[1] / length_m, along[0] / length_m];
    let off = |end: [f64; 2]| (end[0] - from[0]) * normal[0] + (end[1] - from[1]) * normal[1];
    line.iter()
        .all(|beam| off(beam.end).abs() < STRAIGHT_M)
        .then_some(normal)
}

fn length([x, y]: [f64; 2]) -> f64 {
    (x * x + y * y).sqrt()
}

#[cfg(test)]
mod tests {
    use fieldline_protocol::message::NO_RETURN_MM;

    use super::*;
    use crate::robot::laser;

    #[test]
    fn beams_without_information_are_left_out_and_those_without_a_return_end_at_the_limit() {
        let mut ranges = [2_000; 181];
        (ranges[0], ranges[90]) = (INVALID_MM, NO_RETURN_MM);
        let scan = Scan::of(&laser::level(), &ranges);
        assert_eq!(scan.beams.len(), 180);
        let ahead = scan.beams[89];
        assert!(!ahead.hit && (ahead.end[0] - 12.1).abs() < 1e-3 && ahead.end[1].abs() < 1e-2);
        assert_eq!(ahead.normal, None);
        assert!(scan.beams[0].hit);
    }

    #[test]
    fn a_wall_has_its_normal_and_a_lone_end_none() {
        // A wall 2 m to the left; the beam ahead meets a post.
        let range = |degrees: i32| match degrees {
            1..=90 => (2_000.0 / f64::from(degrees).to_radians().sin()).min(11_000.0) as u16,
            0 => 3_000,
            _ => NO_RETURN_MM,
        };
        let ranges: Vec<u16> = (-90..=90).map(range).collect();
        let scan = Scan::of(&laser::level(), &ranges);
        let [x, y] = scan.beams[150].normal.expect("a wall");
        assert!(x.abs() < 0.02 && y.abs() > 0.999, "{x} {y}");
        assert_eq!(scan.beams[90].normal, None);
    }
}

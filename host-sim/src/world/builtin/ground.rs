//! The ground of the uneven worlds: the four scenarios of \[Maffei20, fig. 4\], drawn from their
//! descriptions, and five courses. The files of the worlds describe them.
//!
//! The ground is a function of x and y, sampled every 5 cm at the centres of the plan's cells; so a
//! sheer face is 5 cm wide. Only sums, products, comparisons, square roots and `libm` are used: the
//! same bits on every machine. Ground for driving stays within
//! [`crate::robot::Limits::WORKING`]; other ground is far beyond these limits. Metres.

use core::f64::consts::{FRAC_1_SQRT_2, TAU};

use serde::Deserialize;

use super::super::canvas::roughness;
use super::super::elevation::Elevation;
use super::super::occupancy::Occupancy;
use super::Place;

/// A ground, named as its world.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Ground {
    Slope,
    Holes,
    Building,
    Cliff,
    Spiral,
    Kerbs,
    Waves,
    Pass,
    Causeway,
}

impl Ground {
    /// The ground under a plan, with the world's places.
    pub(super) fn over(self, plan: &Occupancy, places: &[Place]) -> Elevation {
        let size = [plan.width(), plan.height()];
        let height_m = |x, y| match self {
            Self::Slope => slope(x, y),
            Self::Holes => holes(places, x, y),
            Self::Building => building(x, y),
            Self::Cliff => cliff(places, x, y),
            Self::Spiral => spiral(x, y),
            Self::Kerbs => kerbs(places, x, y),
            Self::Waves => waves(x, y),
            Self::Pass => pass(x, y),
            Self::Causeway => causeway(places, x, y),
        };
        Elevation::from_fn(size, plan.resolution_m(), plan.origin_m(), height_m)
    }
}

fn slope(x: f64, y: f64) -> f64 {
    // The slope is turned a little, so that it lies along no axis of the grid.
    let along = x + 0.18 * (y - 12.0) - 11.2;
    // Its grade is along a direction that leans by 0.18.
    let stretch = (1.0_f64 + 0.18 * 0.18).sqrt();
    1.8 * (1.0 - ramp(along / stretch, 7.0, 1.0)) + bumps(x, y, 0.04)
}

fn holes(places: &[Place], x: f64, y: f64) -> f64 {
    let hole = (places.iter().map(|hole| within([x, y], hole.extent_m))).sum::<f64>();
    // Distance from the corner's diagonal; it grows towards the corner.
    let inwards = (x - y - 11.0) * FRAC_1_SQRT_2;
    bumps(x, y, 0.12) + 1.3 * ramp(inwards, 5.8, 1.0) - 1.6 * hole
}

fn building(x: f64, y: f64) -> f64 {
    // The ground in the building and around it is level.
    let (dx, dy) = ((x - 13.5).abs() - 3.5, (y - 15.0).abs() - 3.0);
    let away = (dx.max(dy) / 2.0).clamp(0.0, 1.0);
    bumps(x, y, 0.15) * away
}

fn cliff(places: &[Place], x: f64, y: f64) -> f64 {
    let [hole, hill, cliff] = [0, 1, 2].map(|k: usize| &places[k]);
    let plateau = if y < 6.4 {
        ramp(x - 11.6, 6.8, 1.0)
    } else {
        f64::from(u8::from(
            x > cliff.point_m[0] + 0.6 * roughness(0.4 * y, 3.0),
        ))
    };
    let (dx, dy) = (x - hill.point_m[0], y - hill.point_m[1]);
    let hill = (2.1 - (dx * dx + dy * dy).sqrt() * 0.84).max(0.0);
    let hole = within([x, y], hole.extent_m);
    bumps(x, y, 0.06) + 1.5 * plateau + hill - 1.3 * hole
}

/// In polar coordinates around the middle, with u the number of turns inwards from the outer edge,
///
/// ```text
/// u = (R − r) / pitch − θ / 2π      height of the road of turn n:  rise (n + θ / 2π)
/// ```
fn spiral(x: f64, y: f64) -> f64 {
    /// Distance of the road's beginning from the middle, and from one turn to the next.
    const RADIUS_M: f64 = 11.0;
    const PITCH_M: f64 = 3.2;
    /// Share of the pitch that is road.
    const ROAD: f64 = 2.2 / 3.2;
    let (dx, dy) = (x - 13.0, y - 13.0);
    let angle = libm::atan2(dy, dx) / TAU;
    let angle = angle - angle.floor();
    let turns = (RADIUS_M - (dx * dx + dy * dy).sqrt()) / PITCH_M - angle;
    let turn = turns.floor();
    let road = |turn: f64| 2.0 * (turn + angle).clamp(0.0, 2.25);
    // Within a turn's band the road comes first, then the face up to the next turn.
    let face = ((turns - turn - ROAD) / (1.0 - ROAD)).max(0.0);
    road(turn) + face * (road(turn + 1.0) - road(turn)) + bumps(x, y, 0.02)
}

fn kerbs(places: &[Place], x: f64, y: f64) -> f64 {
    // Height of each island, and length of the ramp onto it; infinite for none.
    let heights = [
        (0.05, f64::INFINITY),
        (0.1, f64::INFINITY),
        (0.2, 1.6),
        (0.4, 2.4),
    ];
    let island = |(place, (height_m, length_m)): (&Place, (f64, f64))| {
        let top = height_m * within([x, y], place.extent_m);
        if length_m.is_infinite() {
            return top;
        }
        let [west, south, ..] = place.extent_m;
        let middle = west + 0.5 * 3.6;
        let aside = within(
            [x, 0.0],
            [middle - 0.5 * 1.8, -1.0, middle + 0.5 * 1.8, 1.0],
        );
        let up = ((y - south + length_m) / length_m).clamp(0.0, 1.0);
        let on_ramp = f64::from(u8::from(y < south));
        top + height_m * up * aside * on_ramp
    };
    places.iter().zip(heights).map(island).sum()
}

fn waves(x: f64, y: f64) -> f64 {
    let first = libm::sin(TAU * (x + 0.3 * y) / 12.0);
    let second = libm::sin(TAU * (y - 0.2 * x) / 9.0 + 1.0);
    0.3 * first + 0.2 * second
}

fn pass(x: f64, y: f64) -> f64 {
    /// Distance from the ridge's middle to its foot.
    const FOOT_M: f64 = 4.5;
    let away = (x - 13.0).abs();
    let ridge = 2.4 * ((FOOT_M - away) / 2.5).clamp(0.0, 1.0);
    let t = (1.0 - away / FOOT_M).clamp(0.0, 1.0);
    let saddle = 0.6 * t * t * (3.0 - 2.0 * t);
    // The walls of the pass rise within 0.8 m.
    let aside = (((y - 6.0).abs() - 1.5) / 0.8).clamp(0.0, 1.0);
    saddle + (ridge - saddle) * aside + bumps(x, y, 0.04)
}

fn causeway(places: &[Place], x: f64, y: f64) -> f64 {
    let [west, _, east, _] = places[0].extent_m;
    if x < west || x > east {
        return bumps(x, y, 0.03);
    }
    let aside = y - places[0].point_m[1];
    if aside.abs() < 1.2 {
        // One wave of a cosine, so that the causeway is level where it joins the ground.
        let along = (x - west) / (east - west);
        let arch = 0.5 - 0.5 * libm::cos(TAU * along);
        bumps(x, y, 0.03) + 0.35 * arch
    } else if aside > 0.0 {
        -3.0
    } else {
        f64::NAN
    }
}

/// Bumps of up to ± `height_m`: features of about 4 m, slopes of about `30 height_m` degrees.
fn bumps(x: f64, y: f64, height_m: f64) -> f64 {
    height_m * roughness(0.25 * x, 0.25 * y)
}

/// A ramp from 0 to 1 for t from 0 to `length`: straight, with both ends rounded over `soft`. The
/// grade between is `1 / (length − soft)`.
fn ramp(t: f64, length: f64, soft: f64) -> f64 {
    // Integral of a grade that grows to 1 over `soft`.
    let foot = |t: f64| {
        if t <= 0.0 {
            0.0
        } else if t < soft {
            0.5 * t * t / soft
        } else {
            t - 0.5 * soft
        }
    };
    (foot(t) - foot(t - (length - soft))) / (length - soft)
}

/// 1 inside of a rectangle and 0 outside.
fn within([x, y]: [f64; 2], [x0, y0, x1, y1]: [f64; 4]) -> f64 {
    f64::from(u8::from(x > x0 && x < x1 && y > y0 && y < y1))
}

#[cfg(test)]
mod tests;

//! Drawn fences: star-shaped bounds and triangles that are no-go, around a world's first start.
//!
//! Corner k of n is drawn at the angle `turn + 2π·k/n` from the middle. Units: radians, metres of
//! the world's frame.

use core::f64::consts::TAU;

use host_sim::fence::Fence;
use host_sim::robot::{Footprint, Pose};
use host_sim::world::{Start, World};

use crate::random::Random;

/// Draws fences until the robot may stand at the world's first start.
///
/// # Panics
/// If the world has no start.
pub fn around(world: &World, mut draw: impl FnMut(&Start) -> Fence) -> Fence {
    let start = world.starts()[0];
    let pose = Pose {
        x_m: start.x_m,
        y_m: start.y_m,
        yaw_rad: start.yaw_rad,
        ..Pose::default()
    };
    loop {
        let fence = draw(&start);
        let may_stand = fence.check_start(&Footprint::PIONEER_3AT, &pose);
        if fence.check().is_ok() && may_stand.is_ok() {
            return fence;
        }
    }
}

/// Draws the corners of bounds: seven around the start, 2.5 to 9 m from it.
pub fn bounds(random: &mut Random, start: &Start) -> Vec<[f64; 2]> {
    star(random, start, 0.0, (2.5, 9.0), 7)
}

/// Draws the corners of up to three triangles within 4 m of the start along each axis.
pub fn no_go(random: &mut Random, start: &Start) -> Vec<Vec<[f64; 2]>> {
    let triangles = 0..random.below(4);
    triangles
        .map(|_| star(random, start, 4.0, (0.1, 1.5), 3))
        .collect()
}

/// Draws a star-shaped polygon whose middle is at most `off_m` from the start along each axis.
fn star(
    random: &mut Random,
    start: &Start,
    off_m: f64,
    (least_m, most_m): (f64, f64),
    corners: u32,
) -> Vec<[f64; 2]> {
    let mut off = || off_m * (2.0 * random.unit() - 1.0);
    let (x, y) = (start.x_m + off(), start.y_m + off());
    let turn = random.angle();
    let corner = |k: u32| {
        let angle = turn + TAU * f64::from(k) / f64::from(corners);
        let reach = least_m + (most_m - least_m) * random.unit();
        [x + reach * angle.cos(), y + reach * angle.sin()]
    };
    (0..corners).map(corner).collect()
}

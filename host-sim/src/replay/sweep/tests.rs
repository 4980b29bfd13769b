//! Drives through a built-in world, ray-cast by the simulator, read without their sweep.

use super::super::carmen;
use super::*;
use crate::robot;
use crate::world::{Ray, World};

/// A lidar: first angle and step in degrees, and beams.
type Sweep = (f64, f64, usize);

/// Ranges from a pose with a lidar at the robot's centre, metres; infinite beyond 8 m.
fn ranges(world: &World, pose: &robot::Pose, (first, step, beams): Sweep) -> Vec<f64> {
    let range = |beam: usize| {
        let (sin, cos) = (pose.yaw_rad + (first + step * beam as f64).to_radians()).sin_cos();
        let ray = Ray {
            origin_m: [pose.x_m, pose.y_m, 0.4],
            direction: [cos, sin, 0.0],
        };
        world
            .cast(&ray, 8.0)
            .map_or(f64::INFINITY, |hit| hit.range_m)
    };
    (0..beams).map(range).collect()
}

/// A drive of `steps` on an arc that turns by `turn_deg` a step and advances by 5 cm; in the first
/// form, which does not tell the sweep.
fn drive(sweep: Sweep, turn_deg: f64, steps: u32) -> Log {
    let world = World::builtin("office").expect("a built-in world");
    let mut pose = world.starts()[0].pose();
    let mut text = String::new();
    for step in 0..steps {
        let ranges = ranges(&world, &pose, sweep);
        let words: Vec<String> = ranges.iter().map(|range| format!("{range:.3}")).collect();
        let (x, y, yaw) = (pose.x_m, pose.y_m, pose.yaw_rad);
        let at = format!("{x} {y} {yaw}");
        text += &format!(
            "FLASER {} {} {at} {at} {step} host {step}\n",
            sweep.2,
            words.join(" ")
        );
        pose.yaw_rad = wrap(yaw + turn_deg.to_radians());
        pose.x_m += 0.05 * pose.yaw_rad.cos();
        pose.y_m += 0.05 * pose.yaw_rad.sin();
    }
    carmen::log("drive.log", &text).expect("a log")
}

#[track_caller]
fn is_read_as(sweep: Sweep, expected: Sweep, by: By) {
    let mut log = drive(sweep, 4.0, 90);
    assert_eq!(find("drive.log", &mut log), Ok(by), "{sweep:?}");
    for scan in &log.scans {
        let found = (
            scan.beams.first_rad.to_degrees(),
            scan.beams.step_rad.to_degrees(),
        );
        let off = (found.0 - expected.0)
            .abs()
            .max((found.1 - expected.1).abs());
        assert!(off < 1e-6, "{sweep:?} as {found:?}");
    }
}

#[test]
fn a_turning_robot_tells_the_field_of_view() {
    for sweep in [
        (-90.0, 0.5, 360),
        (-90.0, 0.5, 361),
        (-90.0, 1.0, 180),
        (-90.0, 1.0, 181),
        (-180.0, 1.0, 360),
        (-180.0, 2.0, 180),
        (-180.0, 0.8, 450),
        (0.0, 1.0, 360),
        (-135.0, 0.5, 541),
        (0.0, -1.0, 360),
        (180.0, -0.8, 450),
    ] {
        is_read_as(sweep, sweep, By::Scans);
    }
}

#[test]
fn without_a_turn_only_counts_of_carmen_have_a_field_of_view() {
    for beams in [180, 181, 361] {
        let mut log = drive((-90.0, 0.5, beams), 0.0, 20);
        assert_eq!(find("drive.log", &mut log), Ok(By::Count));
        assert_eq!(log.scans[0].beams, Beams::half_turn(beams));
    }
    let mut log = drive((-180.0, 1.0, 360), 0.0, 20);
    let error = find("drive.log", &mut log).expect_err("it does not turn");
    for word in [
        "drive.log:1: ",
        "--laser -90,0.5,360,12 for 180°",
        "--laser -180,1,360,12 for a whole turn",
        "--robot FILE",
    ] {
        assert!(error.contains(word), "no {word:?} in {error}");
    }
}

#[test]
fn a_laser_behind_that_is_not_told_as_such_looks_back() {
    let mut log = drive((90.0, 1.0, 181), 4.0, 90);
    log.form = Form::Rlaser;
    assert_eq!(find("drive.log", &mut log), Ok(By::Scans));
    assert!((log.scans[0].beams.first_rad - FRAC_PI_2).abs() < 1e-9);
}

//! The whole simulator: repeatable runs, walls, stale commands, odometry errors.

use fieldline_protocol::message::Strategy;
use fixed::types::I4F12;

use super::*;
use crate::robot::{OdometryModel, OdometryNoise};

fn twist(linear: f64, angular: f64) -> Option<Twist> {
    let velocity = Velocity {
        linear_mps: linear,
        angular_radps: angular,
    };
    Some(velocity.to_wire())
}

fn office() -> World {
    World::builtin("office").expect("built in")
}

#[test]
fn the_same_seed_gives_the_same_run() {
    let world = office();
    let run = |seed| {
        let config = SimConfig {
            seed,
            odometry: OdometryModel::Noisy(OdometryNoise::default()),
            ..SimConfig::default()
        };
        let mut sim = Simulator::new(&world, config).expect("fits");
        let mut seen = Vec::new();
        for step in 0..40 {
            seen.push(sim.observe());
            sim.drive(twist(0.4, if step % 9 < 4 { 0.7 } else { -0.6 }));
        }
        (seen, sim.odometry.pose().x_m.to_bits())
    };
    assert_eq!(run(5), run(5));
    assert_ne!(run(5).0, run(6).0);
}

#[test]
fn a_wall_stops_the_robot_and_counts_once() {
    let world = office();
    let mut sim = Simulator::new(&world, SimConfig::default()).expect("fits");
    for _ in 0..300 {
        sim.drive(twist(0.7, 0.0));
    }
    assert_eq!(sim.safety().collisions, 1);
    assert_eq!(sim.safety().min_clearance_m, 0.0);
    // The corridor ends at x = 24.2, the robot's nose is 0.254 ahead.
    let nose_m = sim.pose().x_m + 0.254;
    assert!((24.19..24.2).contains(&nose_m), "{nose_m}");
    assert!((sim.path_length_m() - (sim.pose().x_m - 12.0)).abs() < 1e-9);
    // Back off and hit it again: another contact.
    for speed in [-0.3, 0.5] {
        for _ in 0..20 {
            sim.drive(twist(speed, 0.0));
        }
    }
    assert_eq!(sim.safety().collisions, 2);
}

#[test]
fn silence_stops_the_robot_after_the_stale_limit() {
    let world = office();
    let mut sim = Simulator::new(&world, SimConfig::default()).expect("fits");
    for _ in 0..10 {
        sim.drive(twist(0.25, 0.0));
    }
    sim.drive(None);
    // The last command still counts after 400 ms.
    assert!((sim.velocity().linear_mps - 0.25).abs() < 1e-9);
    sim.drive(None);
    assert!((sim.velocity().linear_mps - 0.19).abs() < 1e-9);
    sim.drive(None);
    sim.drive(None);
    sim.drive(None);
    assert_eq!(sim.velocity(), Velocity::default());
}

#[test]
fn a_corner_that_swings_into_a_wall_is_a_collision() {
    // 0.6 m wide: the robot can drive through and cannot turn.
    let rows: Vec<String> = (0..32)
        .map(|j| if (10..22).contains(&j) { "." } else { "#" }.repeat(40))
        .collect();
    let rows: Vec<&str> = rows.iter().map(String::as_str).collect();
    let picture = World::picture("tube", 0.05, &rows);
    let start = crate::world::Start {
        x_m: 0.5,
        y_m: 0.8,
        yaw_rad: 0.0,
    };
    let world = World::flat("tube", picture.occupancy().clone(), vec![start]);
    let mut sim = Simulator::new(&world, SimConfig::default()).expect("fits");
    for _ in 0..10 {
        sim.drive(twist(0.25, 0.0));
    }
    assert_eq!(sim.safety().collisions, 0);
    assert!((sim.safety().min_clearance_m - 0.0515).abs() < 1e-9);
    for _ in 0..5 {
        sim.drive(twist(0.0, 0.0));
    }
    for _ in 0..10 {
        sim.drive(twist(0.0, 1.0));
    }
    assert_eq!(sim.safety().collisions, 1);
    // The corners touch where 0.254 sin φ + 0.2485 cos φ = 0.3: φ = 0.231 rad.
    let yaw = sim.pose().yaw_rad;
    assert!((0.22..0.231).contains(&yaw), "{yaw}");
    assert!(sim.in_contact());
}

#[test]
fn the_error_of_the_odometry_is_measured() {
    let world = World::builtin("hall").expect("built in");
    let drive = |odometry| {
        let config = SimConfig {
            odometry,
            ..SimConfig::default()
        };
        let mut sim = Simulator::new(&world, config).expect("fits");
        let mut errors_m = Vec::new();
        for _ in 0..200 {
            errors_m.push(sim.pose().distance_m(sim.odometry.pose()));
            sim.observe();
            sim.drive(twist(0.5, 0.25));
        }
        let mean_m = errors_m.iter().sum::<f64>() / 200.0;
        let max_m = errors_m.into_iter().fold(0.0, f64::max);
        (*sim.pose(), *sim.odometry.pose(), mean_m, max_m)
    };
    let (truth, believed, _, max_m) = drive(OdometryModel::Truth);
    assert_eq!((truth, max_m), (believed, 0.0));
    let noisy = OdometryModel::Noisy(OdometryNoise::default());
    let (same_truth, believed, mean_m, max_m) = drive(noisy);
    assert_eq!(truth, same_truth);
    assert!(truth.distance_m(&believed) > 0.01);
    assert!(mean_m > 0.0 && mean_m < max_m);
    assert!(max_m < 2.0);
}

#[test]
fn a_robot_that_drives_into_a_hole_falls_once_and_stays() {
    let image = crate::world::Image {
        width: 40,
        height: 20,
        samples: (0..800).map(|k| u32::from(k % 40 < 20)).collect(),
        full: 1,
        channels: 1,
        transparent: Vec::new(),
    };
    let scale = crate::world::HeightScale {
        z_min_m: 2.0,
        z_max_m: 3.0,
        no_data: Some(0),
    };
    let ground = crate::world::Elevation::from_image(&image, scale, 0.1, [0.0, 0.0]);
    let floor = crate::world::Occupancy::filled(40, 20, 0.1, [0.0, 0.0], crate::world::Class::Free);
    let start = crate::world::Start {
        x_m: 0.5,
        y_m: 1.0,
        yaw_rad: 0.0,
    };
    let world = World::uneven("rim", floor, ground, vec![start]);
    let mut sim = Simulator::new(&world, SimConfig::default()).expect("stands");
    assert_eq!(sim.pose().z_m, 2.0);
    // Heights on the wire count from the start.
    assert_eq!(sim.observe().pose.z, 0);
    for _ in 0..60 {
        sim.drive(twist(0.5, 0.0));
    }
    assert_eq!((sim.safety().falls, sim.safety().collisions), (1, 0));
    // The last samples lie at 1.95 m, the front axle is 0.134 m ahead.
    let axle_m = sim.pose().x_m + 0.134;
    assert!((1.94..1.951).contains(&axle_m), "{axle_m}");
    let fallen = *sim.pose();
    sim.drive(twist(-0.5, 0.0));
    assert_eq!(*sim.pose(), fallen);
}

#[test]
fn the_start_message_announces_what_is_simulated() {
    let world = office();
    let sim = Simulator::new(&world, SimConfig::default()).expect("fits");
    let start = sim.start_message(Strategy::Frontier);
    assert_eq!(start.robot_radius_mm, 300);
    assert_eq!((start.lasers[0].beams, start.lasers[1].beams), (181, 181));
    assert_eq!(start.lasers[0].range_limit_mm, 12_000);
    assert_eq!(start.lasers[0].pitch, 0);
    let close = |number: I4F12, to: f64| (number.to_num::<f64>() - to).abs() < 2.5e-4;
    assert!(close(start.lasers[0].x, 0.10) && close(start.lasers[0].z, 0.40));
    assert!(close(start.lasers[1].x, 0.15) && close(start.lasers[1].z, 0.45));
    assert!(close(start.lasers[1].pitch, 20.0_f64.to_radians()));
    assert!(close(start.max_linear, 0.7) && close(start.max_angular, 140.0_f64.to_radians()));
    // Braking is stronger than the acceleration of 0.3 m/s²; the message has the lesser of both,
    // rounded down.
    assert_eq!(start.linear_accel, I4F12::from_bits(1228));
    assert_eq!(start.angular_accel, I4F12::from_bits(7148));
    assert_eq!(start.period_ms, 200);
}

#[test]
fn a_start_that_does_not_exist_is_named() {
    let config = SimConfig {
        start: 9,
        ..SimConfig::default()
    };
    let world = office();
    let error = Simulator::new(&world, config).expect_err("three starts");
    assert_eq!(
        error.to_string(),
        "office: robots[9]: the world has only 3 starts; give --start a number below 3"
    );
}

#[test]
fn truth_starts_in_the_world_frame() {
    let world = office();
    let mut sim = Simulator::new(&world, SimConfig::default()).expect("fits");
    let seen = sim.observe();
    assert_eq!(seen.pose.x.to_num::<f64>(), 12.0);
    assert_eq!(seen.pose.y.to_num::<f64>(), 7.0);
    assert_eq!(seen.scans.len(), 2);
    assert_eq!(seen.scans[0].ranges_mm.len(), 181);
    // Straight ahead, the tilted laser hits the ground at 0.45 m / sin 20°.
    let ground = f64::from(seen.scans[1].ranges_mm[90]) / 1000.0;
    assert!(
        (ground - 0.45 / 20.0_f64.to_radians().sin()).abs() < 0.05,
        "{ground}"
    );
}

//! Speed of the simulator: rays per second and simulated seconds per second, on one core.
//!
//! `cargo bench -p host-sim --bench simulator [WORLD..]` prints a table of the built-in worlds, or
//! of the named ones. A fixed sequence spreads the poses over the world. The robot drives a fixed
//! pattern without a planner.

use core::hint::black_box;
use std::time::Instant;

use host_sim::robot::{LaserNoise, LaserScanner, Pose, Source, Velocity, laser};
use host_sim::sim::{SimConfig, Simulator};
use host_sim::world::{World, builtins};

/// Number of sweeps of a measurement.
const SWEEPS: usize = 3000;
/// Number of control periods of a measurement.
const PERIODS: u32 = 3000;

fn main() {
    let named: Vec<String> = std::env::args()
        .skip(1)
        .filter(|argument| !argument.starts_with("--"))
        .collect();
    let names = if named.is_empty() {
        builtins()
            .iter()
            .map(|world| world.name.to_owned())
            .collect()
    } else {
        named
    };
    println!(
        "{:<18} {:>14} {:>14} {:>16}",
        "world", "level Mray/s", "tilted Mray/s", "x real time"
    );
    for name in names {
        match World::open(&name) {
            Ok(world) => println!(
                "{:<18} {:>14.2} {:>14.2} {:>16.0}",
                world.name(),
                rays(&world, &laser::level()),
                rays(&world, &laser::tilted()),
                real_time(&world)
            ),
            Err(error) => eprintln!("{error}"),
        }
    }
}

/// Poses on free floor, spread by the golden section.
fn poses(world: &World) -> Vec<Pose> {
    let [width, height] = world.size_m();
    let [x0, y0] = world.occupancy().origin_m();
    (0..)
        .map(|k| {
            let k = f64::from(k);
            Pose {
                x_m: x0 + width * (k * 0.754_877_666).fract(),
                y_m: y0 + height * (k * 0.569_840_291).fract(),
                yaw_rad: k,
                ..Pose::default()
            }
        })
        .filter(|pose| !world.is_solid(pose.x_m, pose.y_m))
        .take(SWEEPS)
        .collect()
}

/// Millions of rays per second, with noise.
fn rays(world: &World, laser: &fieldline_protocol::message::Laser) -> f64 {
    let sources = [Source::LevelRange, Source::LevelFault];
    let mut scanner = LaserScanner::new(laser, LaserNoise::default(), 1, sources);
    let poses = poses(world);
    let start = Instant::now();
    let beams: usize = poses
        .iter()
        .map(|pose| black_box(scanner.scan(world, pose)).ranges_mm.len())
        .sum();
    beams as f64 / start.elapsed().as_secs_f64() / 1e6
}

/// Simulated seconds per second: both lasers, drive, collisions, metrics.
fn real_time(world: &World) -> f64 {
    let Ok(mut sim) = Simulator::new(world, SimConfig::default()) else {
        return 0.0;
    };
    let start = Instant::now();
    for period in 0..PERIODS {
        black_box(sim.observe());
        let velocity = Velocity {
            linear_mps: if period % 40 < 20 { 0.4 } else { -0.4 },
            angular_radps: if period % 30 < 15 { 0.6 } else { -0.6 },
        };
        sim.drive(Some(velocity.to_wire()));
    }
    sim.time_s() / start.elapsed().as_secs_f64()
}

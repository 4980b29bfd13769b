//! Ends of an exploration: the world is larger than the map's box, or the robot starts inside a
//! wall.

use fieldline_protocol::message::{Fault, Observation, Status, Strategy, Twist};
use fieldline_tests::worlds;
use host_sim::link::Link;
use host_sim::link::direct::Direct;
use host_sim::link::loopback::loopback;
use host_sim::report::Report;
use host_sim::robot::{LaserNoise, LaserScanner, Pose, Source, laser};
use host_sim::sim::{SimConfig, Simulator};
use host_sim::trial::mission::{Mission, explore};
use host_sim::world::{Start, World};

/// Side of a drawn cell, metres.
const CELL_M: f64 = 0.2;
/// A box of 4 × 4 tiles of 3.2 m.
const BOX: Option<(u8, u8)> = Some((4, 4));

/// Draws a room of 11.6 × 11.6 m, which fills most of a 4 × 4 box, and a yard east of it, which
/// lies outside the box. The wall between has an opening of `opening` cells opposite the robot.
fn room_and_yard(opening: usize) -> World {
    let rows: Vec<String> = (0..64)
        .map(|row: usize| {
            let gap = row >= 30 && row < 30 + opening;
            match row {
                0..2 | 60.. => "#".repeat(104),
                _ if gap => format!("##{}{}##", ".".repeat(58), ".".repeat(42)),
                _ => format!("##{}##{}##", ".".repeat(58), ".".repeat(40)),
            }
        })
        .collect();
    let rows: Vec<&str> = rows.iter().map(String::as_str).collect();
    let start = Start {
        x_m: 3.0,
        y_m: 6.5,
        yaw_rad: 0.0,
    };
    let plan = World::picture("yard", CELL_M, &rows).occupancy().clone();
    World::flat("room-and-yard", plan, vec![start])
}

fn explored(world: &World, box_tiles: Option<(u8, u8)>) -> Report {
    let mission = Mission {
        box_tiles,
        ..Mission::default()
    };
    let run = explore(&mission, world, &mut Direct::new(), &mut ());
    run.expect("the start is free").0
}

fn words(report: &Report) -> (&str, &str) {
    (&report.outcome.status, &report.outcome.reason)
}

/// The robot sees the yard through a slit of 0.2 m and does not fit through it. Everything that it
/// can reach is explored.
#[test]
fn space_seen_outside_the_box_through_a_slit_is_no_fault() {
    let report = explored(&room_and_yard(1), BOX);
    let left = &report.outcome.residual_frontiers;
    assert_eq!(words(&report), ("finished", "explored"), "{left:?}");
    assert!(
        left.iter()
            .all(|frontier| frontier.reason != "out-of-bounds"),
        "{left:?}"
    );
    assert_eq!(report.safety.collisions, 0);
}

/// A door of 1.2 m leads to the same yard, and the map has no space for it.
#[test]
fn a_door_out_of_the_box_is_a_fault_and_is_listed() {
    let report = explored(&room_and_yard(6), BOX);
    let left = &report.outcome.residual_frontiers;
    assert_eq!(words(&report), ("fault", "out-of-box"), "{left:?}");
    assert!(
        left.iter()
            .any(|frontier| frontier.reason == "out-of-bounds" && frontier.x_m > 12.0),
        "{left:?}"
    );
    assert_eq!(report.safety.collisions, 0);
    let roomy = explored(&room_and_yard(6), None);
    assert_eq!(
        words(&roomy),
        ("finished", "explored"),
        "the default box has space for the yard"
    );
}

/// Every beam of a robot in the middle of a wall ends at once. The simulator refuses such a start;
/// a device must notice it itself.
#[test]
fn a_robot_that_starts_inside_a_wall_says_so_and_stands() {
    let rows = ["##########"; 10];
    let solid = World::picture("solid", 0.5, &rows);
    let pose = Pose {
        x_m: 2.5,
        y_m: 2.5,
        ..Pose::default()
    };
    let sources = [
        (laser::level(), [Source::LevelRange, Source::LevelFault]),
        (laser::tilted(), [Source::TiltedRange, Source::TiltedFault]),
    ];
    let scans = sources.map(|(laser, sources)| {
        LaserScanner::new(&laser, LaserNoise::default(), 0, sources).scan(&solid, &pose)
    });
    let observation = Observation {
        pose: pose.to_wire(),
        scans: scans.into_iter().collect(),
        ..Observation::default()
    };
    let office = worlds::builtin("office");
    let simulator = Simulator::new(&office, SimConfig::default()).expect("the start is free");
    let start = simulator.start_message(Strategy::Frontier, (20, 20));
    let links: [Box<dyn Link>; 2] = [Box::new(Direct::new()), Box::new(loopback())];
    for mut link in links {
        link.control(&fieldline_protocol::message::Control::Start(start.clone()))
            .expect("the session is allowed");
        // The fault stays.
        for time_ms in [0, 200, 400] {
            let observation = Observation {
                time_ms,
                ..observation.clone()
            };
            let command = link.observe(&observation).expect("the device answers");
            assert_eq!(
                (command.status, command.velocity),
                (Status::Fault(Fault::StartBlocked), Twist::default())
            );
        }
    }
}

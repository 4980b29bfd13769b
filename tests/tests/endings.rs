//! How an exploration ends where the map has no room for what is seen, and where the robot wakes inside something.

use fieldline_protocol::message::{Fault, Observation, Status, Strategy, Twist};
use fieldline_tests::runs::Unseen;
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

/// A room of 11.6 × 11.6 m that takes nearly the whole of a 4 × 4 box, and a yard east of it that lies beyond. The wall
/// between has an opening of `opening` cells across from the robot.
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
    let run = explore(&mission, world, &mut Direct::new(), &mut Unseen);
    run.expect("the start is free").0
}

fn words(report: &Report) -> (&str, &str) {
    (&report.outcome.status, &report.outcome.reason)
}

/// The yard is seen through a slit of 0.2 m, and the robot cannot go there: all that it can reach is explored.
#[test]
fn what_is_seen_beyond_the_box_through_a_slit_is_no_fault() {
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

/// Through a door of 1.2 m the same yard is a place to go, and the map has no room for it.
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
    assert_eq!(words(&roomy), ("finished", "explored"), "with room for it");
}

/// Every beam of a robot in the middle of a wall ends at once. The simulator would not put it there, a device must know.
#[test]
fn a_robot_that_wakes_inside_a_wall_says_so_and_does_not_move() {
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
            .expect("a session");
        // And again: it does not come round.
        for time_ms in [0, 200, 400] {
            let observation = Observation {
                time_ms,
                ..observation.clone()
            };
            let command = link.observe(&observation).expect("a command");
            assert_eq!(
                (command.status, command.velocity),
                (Status::Fault(Fault::StartBlocked), Twist::default())
            );
        }
    }
}

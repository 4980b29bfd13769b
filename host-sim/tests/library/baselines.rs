//! Whole runs of the baselines: they finish without a collision, end with the right reason, and
//! repeat for the same seed.

use host_sim::baseline::bvp_papers::{Precision, Relaxation};
use host_sim::baseline::{Bvp, BvpPapers, GreedyFrontier, Session};
use host_sim::link::{Link, LinkError};
use host_sim::report::Report;
use host_sim::trial::Record;
use host_sim::trial::mission::{self, Mission};
use host_sim::world::World;

use fieldline_protocol::message::{Control, FIELD_SIDE, Finish, Observation, Status};

const BASELINES: [&str; 3] = ["bvp", "bvp-papers", "greedy-frontier"];

fn planner(name: &str) -> Box<dyn Link> {
    match name {
        "bvp" => Box::new(Session::new(Bvp::new())),
        "bvp-papers" => Box::new(Session::new(BvpPapers::new(Relaxation::DEFAULT))),
        _ => Box::new(Session::new(GreedyFrontier::default())),
    }
}

fn explore(name: &str, world: &str, seed: u64) -> (Report, Record) {
    begin(name, world, seed, 3_600_000)
}

/// As [`explore`], for a simulated time.
fn begin(name: &str, world: &str, seed: u64, time_limit_ms: u32) -> (Report, Record) {
    let mission = Mission {
        strategy: name.into(),
        seed,
        time_limit_ms,
        ..Mission::default()
    };
    let world = World::builtin(world).expect("a built-in world");
    mission::explore(&mission, &world, planner(name).as_mut(), &mut ()).expect("it begins")
}

#[test]
fn they_explore_rooms_behind_doors_without_a_collision() {
    for name in ["bvp", "greedy-frontier"] {
        let (report, record) = explore(name, "narrow-doors", 0);
        assert!(report.explored(), "{name}: {:?}", report.outcome);
        assert_eq!(report.safety.collisions, 0, "{name}");
        assert!(
            report.coverage.fraction > 0.98,
            "{name}: {:?}",
            report.coverage
        );
        assert_eq!(report.debug.map_matches_mirror, Some(true), "{name}");
        assert_eq!(record.window.is_some(), name == "bvp");
    }
}

#[test]
fn the_same_seed_repeats_a_run_and_another_one_changes_it() {
    for name in BASELINES {
        // The sweeps of the stored field take a minute of the machine for a whole run.
        let time_limit_ms = if name == "bvp-papers" {
            20_000
        } else {
            3_600_000
        };
        let digest = |seed| begin(name, "loop", seed, time_limit_ms).0.digest;
        assert_eq!(digest(3), digest(3), "{name}");
        assert_ne!(digest(3), digest(4), "{name}");
    }
}

#[test]
fn unreachable_places_end_with_their_reason() {
    for name in BASELINES {
        let (boxed_in, _) = explore(name, "boxed-in", 1);
        assert_eq!(boxed_in.outcome.reason, "boxed-in", "{name}");
        let (left, _) = explore(name, "unreachable-room", 1);
        assert_eq!(left.outcome.reason, "explored", "{name}");
        assert_eq!(left.safety.collisions, 0, "{name}");
    }
}

#[test]
fn the_record_has_the_field_around_the_robot() {
    let (_, record) = explore("bvp", "loop", 0);
    let window = record.window.expect("the last field");
    assert_eq!(window.q.len(), FIELD_SIDE * FIELD_SIDE);
    assert!(window.q.iter().all(|q| (0.0..=1.0).contains(q)));
}

/// \[Jorge15\] says of its world C that the potential flattens there and the robot stops.
#[test]
fn a_stored_field_ends_flat_and_says_so() {
    let relaxation = Relaxation {
        precision: Precision::F32,
        ..Relaxation::DEFAULT
    };
    let mission = Mission {
        strategy: "bvp-papers".into(),
        relaxation,
        ..Mission::default()
    };
    let world = World::builtin("ouroboros-c").expect("a built-in world");
    let mut session = Session::new(BvpPapers::new(relaxation));
    let (report, _) = mission::explore(&mission, &world, &mut session, &mut ()).expect("it begins");
    assert_eq!(report.outcome.status, "finished");
    assert_eq!(report.outcome.reason, "nothing-attracts");
    assert!(!report.explored() && report.coverage.fraction < 0.5);
    let told = report.relaxation.expect("how it was relaxed");
    assert_eq!((told.sweeps, told.precision.as_str()), (100, "f32"));
    let (solved, _) = explore("bvp", "ouroboros-c", 0);
    assert!(solved.explored() && solved.relaxation.is_none());
}

/// A session answers requests in the wrong order as the device does.
#[test]
fn a_session_follows_the_rules_of_the_device() {
    for name in BASELINES {
        let mut link = planner(name);
        let refused = link.observe(&Observation::default());
        assert!(matches!(refused, Err(LinkError::Refused(_))), "{name}");
        assert!(link.control(&Control::Pause).is_err(), "{name}");
        let start = start();
        assert_eq!(
            link.control(&Control::Start(start.clone())),
            Ok(Status::Exploring)
        );
        let mut bad = start;
        bad.robot_radius_mm = 0;
        assert!(link.control(&Control::Start(bad)).is_err(), "{name}");
        assert_eq!(link.control(&Control::Pause), Ok(Status::Paused));
        let stands = link.observe(&Observation::default()).expect("an answer");
        assert_eq!(stands.velocity, Default::default(), "{name}");
        assert_eq!(link.control(&Control::Resume), Ok(Status::Exploring));
        let stopped = Status::Finished(Finish::Stopped);
        assert_eq!(link.control(&Control::Stop), Ok(stopped), "{name}");
        assert_eq!(link.control(&Control::Reset), Ok(Status::Idle), "{name}");
        assert_eq!(link.tile(0, 0), Ok(None), "{name}");
    }
}

fn start() -> fieldline_protocol::message::Start {
    use fieldline_protocol::message::Strategy;
    use host_sim::sim::{SimConfig, Simulator};
    let world = World::builtin("loop").expect("a built-in world");
    let simulator = Simulator::new(&world, SimConfig::default()).expect("the start is free");
    simulator.start_message(Strategy::Frontier)
}

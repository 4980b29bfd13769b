use std::boxed::Box;

use super::*;
use crate::config::Config;
use crate::geometry::{Pose, Twist};
use crate::input::Input;
use crate::planner::{Correction, Workspace, step};
use crate::robot::LaserMount;

const CLEAR: [u16; 181] = [6_000; 181];

fn config() -> Config {
    Config::builder(crate::RobotShape::PIONEER_3AT)
        .laser(LaserMount::level(0.10, 0.40))
        .build()
        .expect("a Pioneer 3-AT")
}

/// A device that was reset, with its map given back by correction 3.
fn given_back() -> (Config, Box<State<16, 40>>, Box<Workspace>) {
    let config = config();
    let (mut state, mut workspace) = (Box::new(State::new()), Box::new(Workspace::new()));
    state.reset(&config);
    let correction = Correction {
        epoch: 3,
        x_m: 1.0,
        ..Correction::default()
    };
    state.begin_correction(&correction).expect("the first one");
    state.finish_correction(&config, &mut workspace);
    (config, state, workspace)
}

/// A point beside the hull, and a straight way.
fn recall() -> Recall {
    let beside = RecalledPoint {
        x_mm: 0,
        y_mm: 320,
        returns: 8,
    };
    Recall {
        epoch: 3,
        from: Point { x_m: 4.0, y_m: 2.0 },
        points: [beside].into_iter().collect(),
        track_end: Some([5.0, 2.0, 0.0]),
        track: [[100, 0, 0], [50, 0, 0]].into_iter().collect(),
    }
}

fn at(x_m: f32) -> Input<'static> {
    Input {
        time_ms: 0,
        pose: Pose {
            x_m,
            y_m: 2.0,
            ..Pose::default()
        },
        velocity: Twist::default(),
        scans: [&CLEAR, &[]],
    }
}

#[test]
fn a_device_that_was_told_knows_it_in_its_first_step() {
    let (config, mut state, mut workspace) = given_back();
    assert_eq!(
        state.recall(&config, &recall()).map(|it| it.closed),
        Ok(true)
    );
    assert_eq!(
        state.recall(&config, &recall()).map(|it| it.closed),
        Ok(true),
        "again"
    );
    step(&config, &mut state, &mut workspace, at(4.0), &mut ());
    let points = state.ground.points().expect("flat ground");
    let place = Point {
        x_m: 4.0,
        y_m: 2.32,
    };
    assert!(points.points().iter().any(|it| it.distance_m(place) < 1e-3));
    assert!(
        !state
            .ground
            .is_surrounded(&state.localiser.odom(), &config.robot)
    );
    assert!(state.drive.came_past(Point { x_m: 4.5, y_m: 2.0 }, 0.01));
    assert!(!state.drive.came_past(Point { x_m: 4.3, y_m: 2.0 }, 0.01));
}

#[test]
fn a_device_that_was_told_nothing_takes_its_surroundings_for_unseen() {
    let (config, mut state, mut workspace) = given_back();
    step(&config, &mut state, &mut workspace, at(4.0), &mut ());
    assert!(
        state
            .ground
            .is_surrounded(&state.localiser.odom(), &config.robot)
    );
}

#[test]
fn a_recall_that_comes_too_early_too_late_or_is_absurd_changes_nothing() {
    let told = |state: &State<16, 40>| {
        (
            state.ground.points().map(|it| it.points().len()),
            state.drive.track().end(),
        )
    };
    let (config, mut state, mut workspace) = given_back();
    let before = told(&state);
    let other = |change: fn(&mut Recall)| {
        let mut recall = recall();
        change(&mut recall);
        recall
    };
    let absurd = [
        other(|it| it.from.x_m = f32::NAN),
        other(|it| it.from.y_m = 2e4),
        other(|it| it.track_end = Some([0.0, f32::INFINITY, 0.0])),
        other(|it| it.track_end = Some([0.0, 0.0, f32::NAN])),
        other(|it| it.points[0].returns = 0),
        other(|it| it.points[0].returns = 9),
    ];
    for recall in absurd {
        assert_eq!(
            state.recall(&config, &recall),
            Err(CorrectionError::Unusable),
            "{recall:?}"
        );
    }
    for epoch in [0, 2, 4] {
        let recall = Recall { epoch, ..recall() };
        assert_eq!(
            state.recall(&config, &recall),
            Err(CorrectionError::NotOpen)
        );
    }
    state
        .begin_correction(&Correction {
            epoch: 5,
            tiles: 1,
            ..Correction::default()
        })
        .expect("a greater epoch");
    let open = Recall {
        epoch: 5,
        ..recall()
    };
    assert_eq!(state.recall(&config, &open), Err(CorrectionError::NotOpen));
    assert_eq!(told(&state), before);

    let (config, mut state, _) = given_back();
    step(&config, &mut state, &mut workspace, at(4.0), &mut ());
    let before = told(&state);
    assert_eq!(
        state.recall(&config, &recall()),
        Err(CorrectionError::NotOpen)
    );
    assert_eq!(told(&state), before);
}

/// The robot drives as it is told, beside a wall to the right.
#[cfg(feature = "internals")]
#[test]
fn the_hosts_copy_tells_what_the_device_knows() {
    let config = config();
    let mut state = Box::new(State::<16, 40>::new());
    let mut workspace = Box::new(Workspace::new());
    state.reset(&config);
    let mut copy = Surroundings::new();
    let (mut told, mut pose, mut most) = (Twist::default(), at(0.0).pose, 0);
    for k in 0..20 {
        let mut ranges = CLEAR;
        for (beam, range) in ranges.iter_mut().enumerate() {
            let bearing = (beam as f32 - 90.0).to_radians() + pose.yaw_rad;
            let beside_m = pose.y_m + 0.1 * pose.yaw_rad.sin() - 1.3;
            let far_m = beside_m / (-bearing.sin()).max(1e-3);
            *range = (1000.0 * far_m).min(6_000.0) as u16;
        }
        let input = Input {
            time_ms: 200 * k,
            pose,
            velocity: told,
            scans: [&ranges, &[]],
        };
        let output = step(&config, &mut state, &mut workspace, input, &mut ());
        assert!(output.status.goes_on(), "step {k}: {:?}", output.status);
        told = output.velocity;
        let in_map = state.location().pose.0;
        let odom = state.localiser.odom();
        copy.observe(
            &config,
            (
                &Input {
                    pose: in_map,
                    ..input
                },
                &odom,
            ),
            true,
        );
        let known = known_by(&state);
        assert_eq!(copy.recall(0, &odom), known, "step {k}");
        let measured = known.points.iter().filter(|it| it.returns != UNSEEN);
        most = most.max(measured.count());
        pose.x_m += 0.2 * told.linear_mps * pose.yaw_rad.cos();
        pose.y_m += 0.2 * told.linear_mps * pose.yaw_rad.sin();
        pose.yaw_rad += 0.2 * told.angular_radps;
    }
    assert!(most > 10, "{most} points of the wall");
    assert!(copy.recall(0, &state.localiser.odom()).track_end.is_some());
}

//! Tests of the track.

use std::vec::Vec;

use super::*;

/// Short, so that the recorded poses are dense enough to compare others with.
const PERIOD_S: f32 = 0.02;

/// Drives these velocities from the origin, one a period. Returns the poses, the last one last.
fn driven(twists: impl Iterator<Item = Twist>) -> Vec<Pose> {
    let mut poses = std::vec![Pose::default()];
    for twist in twists {
        poses.push(moved(poses.last().unwrap(), twist));
    }
    poses
}

fn moved(pose: &Pose, twist: Twist) -> Pose {
    let (length, turn) = (twist.linear_mps * PERIOD_S, twist.angular_radps * PERIOD_S);
    let (sin, cos) = math::sin_cos(pose.yaw_rad + 0.5 * turn);
    Pose {
        x_m: pose.x_m + length * cos,
        y_m: pose.y_m + length * sin,
        yaw_rad: math::wrap(pose.yaw_rad + turn),
        ..*pose
    }
}

/// Curves, a turn on the spot, a piece backwards: fewer poses than a track keeps.
fn winding() -> Vec<Pose> {
    driven((0..740).map(|k| match k {
        0..250 => Twist {
            linear_mps: 0.3,
            angular_radps: 0.6 * math::sin_cos(0.02 * k as f32).0,
        },
        250..370 | 500..560 => Twist {
            linear_mps: 0.0,
            angular_radps: -0.6,
        },
        370..500 => Twist {
            linear_mps: -0.15,
            angular_radps: 0.2,
        },
        _ => Twist {
            linear_mps: 0.1,
            angular_radps: -0.3,
        },
    }))
}

fn distance_m(a: &Pose, b: &Pose) -> f32 {
    a.point().distance_m(b.point())
}

#[test]
fn a_robot_that_goes_back_stays_on_its_track_and_arrives_where_it_began() {
    let poses = winding();
    let mut track = Track::new();
    poses.iter().for_each(|pose| track.record(pose));
    let mut pose = *poses.last().unwrap();
    let mut steps = 0;
    while let Some(twist) = track.back(&pose, PERIOD_S) {
        let most = 1.0 + 1e-6;
        assert!(twist.linear_mps.abs() <= BACK_MPS * most, "{twist:?}");
        assert!(twist.angular_radps.abs() <= BACK_RADPS * most, "{twist:?}");
        pose = moved(&pose, twist);
        steps += 1;
        assert!(steps < 10_000);
        let near = |it: &&Pose| {
            distance_m(it, &pose) < 0.03 && math::wrap(it.yaw_rad - pose.yaw_rad).abs() < 0.1
        };
        assert!(poses.iter().any(|it| near(&it)), "{pose:?}");
    }
    assert!(distance_m(&pose, &poses[0]) < 0.02, "{pose:?}");
}

#[test]
fn a_retreat_leaves_its_place_by_the_way_of_a_robot_that_moved() {
    let forward = Twist {
        linear_mps: 0.3,
        angular_radps: 0.0,
    };
    let turn = Twist {
        linear_mps: 0.0,
        angular_radps: 0.6,
    };
    // The turn on the spot is no way.
    let poses = driven((0..300).map(|k| if k < 200 { forward } else { turn }));
    let mut track = Track::new();
    poses.iter().for_each(|pose| track.record(pose));
    let begin = *poses.last().unwrap();
    track.begin_retreat();
    let mut pose = begin;
    while !track.has_left() {
        let twist = track.back(&pose, PERIOD_S).expect("the track is longer");
        pose = moved(&pose, twist);
    }
    let far_m = distance_m(&begin, &pose);
    // A straight piece is left as a whole.
    assert!((LEAVE_M..LEAVE_M + 0.52).contains(&far_m), "{far_m} m");
    let mut short = Track::new();
    short.record(&begin);
    short.begin_retreat();
    assert!(short.has_left(), "there is no way back");
}

#[test]
fn a_track_passes_where_the_robot_was_and_nowhere_else() {
    let poses = winding();
    let mut track = Track::new();
    poses.iter().for_each(|pose| track.record(pose));
    for pose in &poses {
        assert!(track.passes(pose.point(), STEP_M), "{pose:?}");
        let aside = pose.to_map(Point { x_m: 0.0, y_m: 0.4 });
        let far_m = poses.iter().map(|it| it.point().distance_m(aside));
        let far_m = far_m.fold(f32::INFINITY, f32::min);
        assert!(track.passes(aside, far_m + STEP_M), "{aside:?}");
        assert!(!track.passes(aside, far_m - 0.01), "{aside:?}");
    }
    assert!(!Track::new().passes(Point::default(), 10.0));
}

#[test]
fn rounding_errors_do_not_add_up() {
    let poses = winding();
    let mut track = Track::new();
    let mut recorded = Vec::new();
    for pose in &poses {
        let (before, next) = (track.last, track.next);
        track.record(pose);
        if track.last != before {
            if track.next == next {
                // It is straight on from the pose before, in place of which it is kept.
                recorded.pop();
            }
            recorded.push(*pose);
        }
    }
    for pose in recorded.iter().rev() {
        let place = track.place(pose).unwrap();
        assert!(
            place.x_m.abs() < 2.1e-3 && place.y_m.abs() < 1e-3,
            "{place:?}"
        );
        assert!(place.yaw_rad.abs() < 6e-3, "{place:?}");
        track.drop_last();
    }
}

fn at(x_m: f32, yaw_rad: f32) -> Pose {
    Pose {
        x_m,
        yaw_rad,
        ..Pose::default()
    }
}

#[test]
fn a_jump_begins_a_new_track_and_a_long_one_loses_its_beginning() {
    let mut track = Track::new();
    for k in 0..300 {
        track.record(&at(0.051 * k as f32, 0.1 * (k % 2) as f32));
    }
    assert_eq!(usize::from(track.len), MOST);
    let last = at(40.0, 0.0);
    track.record(&last);
    assert_eq!((track.len, track.last[0]), (0, 40.0));
    assert!(track.back(&last, PERIOD_S).is_none());
}

/// A lane as narrow as the robot may be much longer than a track of poses 5 cm apart.
#[test]
fn the_whole_of_a_long_straight_way_is_kept() {
    let mut track = Track::new();
    (0..300).for_each(|k| track.record(&at(0.051 * k as f32, 0.004 * (k % 3) as f32)));
    assert!(usize::from(track.len) < MOST);
    while track.len > 0 {
        track.drop_last();
    }
    assert!(track.last[0].abs() < 0.01, "{}", track.last[0]);
}

const FORWARD: Twist = Twist {
    linear_mps: 0.3,
    angular_radps: 0.0,
};
const BACKWARD: Twist = Twist {
    linear_mps: -0.15,
    angular_radps: 0.0,
};

/// The robot is moved along these velocities; returns the length of the way back, metres.
fn way_back_m(twists: impl Iterator<Item = Twist>) -> f32 {
    let mut track = Track::new();
    driven(twists).iter().for_each(|pose| track.record(pose));
    (1..=track.len).fold(0.0, |sum, back| {
        let [dx, dy, _] = metres(track.difference(back));
        sum + math::sqrt(dx * dx + dy * dy)
    })
}

/// 6 m on, then 5 m back in two goes with a piece on between them.
#[test]
fn a_robot_that_drove_to_and_fro_goes_back_the_way_it_came_in() {
    let far_m = way_back_m((0..2_000).map(|k| match k {
        0..1_000 => FORWARD,
        1_000..1_700 => BACKWARD,
        1_700..1_800 => FORWARD,
        _ => BACKWARD,
    }));
    // 6 - 2.1 + 0.6 - 0.6 m.
    assert!((3.7..4.1).contains(&far_m), "{far_m} m");
}

#[test]
fn a_loop_is_forgotten_once_the_robot_is_back_on_its_track() {
    let circle = Twist {
        linear_mps: 0.3,
        angular_radps: math::PI / 3.0,
    };
    let far_m = way_back_m((0..600).map(|k| match k {
        0..200 => FORWARD,
        200..500 => circle,
        _ => BACKWARD,
    }));
    // 1.2 - 0.3 m.
    assert!((0.85..0.97).contains(&far_m), "{far_m} m");
}

//! Tests of the front end, in drawn worlds.

use std::boxed::Box;
use std::vec::Vec;

use super::{Config, Slam};
use crate::motion::Motion;
use crate::pose::{Pose, wrap};
use crate::scan::Laser;
use crate::workspace::Workspace;

const BEAMS: usize = 181;
const LASER: Laser = Laser {
    x_m: 0.1,
    y_m: 0.0,
    first_rad: -core::f32::consts::FRAC_PI_2,
    step_rad: core::f32::consts::PI / 180.0,
    beams: BEAMS,
    most_m: 10.0,
};

type Small = Slam<400, 64, BEAMS>;
type Room = Workspace<400, 256>;

/// A wall from one point to another, metres.
pub(super) type Wall = [f32; 4];

/// Numbers in −1..1 from a seed.
pub(super) struct Noise(pub(super) u32);

impl Noise {
    pub(super) fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.0 >> 8) as f32 / (1 << 23) as f32 - 1.0
    }
}

/// The four walls of a box.
pub(super) fn walls(x0: f32, y0: f32, x1: f32, y1: f32) -> [Wall; 4] {
    [
        [x0, y0, x1, y0],
        [x1, y0, x1, y1],
        [x1, y1, x0, y1],
        [x0, y1, x0, y0],
    ]
}

/// A corridor of 2 m round a block, with pillars at uneven distances.
fn ring() -> Vec<Wall> {
    let mut all: Vec<Wall> = Vec::new();
    all.extend(walls(0.0, 0.0, 20.0, 12.0));
    all.extend(walls(2.0, 2.0, 18.0, 10.0));
    for (x, y) in [
        (3.1, 0.0),
        (7.4, 1.7),
        (12.9, 0.0),
        (19.6, 3.0),
        (18.0, 7.3),
    ] {
        all.extend(walls(x, y, x + 0.4, y + 0.3));
    }
    for (x, y) in [
        (15.2, 10.0),
        (9.9, 11.7),
        (4.4, 10.0),
        (0.0, 8.1),
        (1.7, 4.7),
    ] {
        all.extend(walls(x, y, x + 0.3, y + 0.3));
    }
    all
}

/// Returns the ranges of a scan, with noise of 1 cm.
fn cast(world: &[Wall], pose: &Pose, noise: &mut Noise) -> Vec<u16> {
    let [ox, oy] = pose.point([LASER.x_m, LASER.y_m]);
    let range = |k: usize| {
        let angle = pose.yaw_rad + LASER.first_rad + k as f32 * LASER.step_rad;
        let (dx, dy) = (angle.cos(), angle.sin());
        let meets = world.iter().filter_map(|&[x0, y0, x1, y1]| {
            let (wx, wy) = (x1 - x0, y1 - y0);
            let det = wx * dy - wy * dx;
            let (px, py) = (x0 - ox, y0 - oy);
            let (t, u) = ((wx * py - wy * px) / det, (dx * py - dy * px) / det);
            (det != 0.0 && t > 0.0 && (0.0..=1.0).contains(&u)).then_some(t)
        });
        meets.fold(60.0, f32::min)
    };
    let noisy = (0..BEAMS).map(|k| range(k) + 0.01 * noise.next());
    noisy.map(|range_m| (range_m * 1000.0) as u16).collect()
}

/// Returns the poses of a robot that drives along a line of points in steps of 10 cm, and turns on
/// the spot in steps of 0.1 rad.
pub(super) fn drive(points: &[[f32; 2]]) -> Vec<Pose> {
    let mut poses: Vec<Pose> = Vec::new();
    let mut yaw = 0.0_f32;
    for pair in points.windows(2) {
        let (dx, dy) = (pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]);
        let turn = wrap(dy.atan2(dx) - yaw);
        let turns = (turn.abs() / 0.1).ceil() as usize;
        for k in 1..=turns {
            let yaw_rad = yaw + turn * k as f32 / turns as f32;
            poses.push(Pose {
                x_m: pair[0][0],
                y_m: pair[0][1],
                yaw_rad,
            });
        }
        yaw = dy.atan2(dx);
        let steps = (dx.hypot(dy) / 0.1) as usize;
        poses.extend((0..steps).map(|k| {
            let part = k as f32 / steps as f32;
            Pose {
                x_m: pair[0][0] + part * dx,
                y_m: pair[0][1] + part * dy,
                yaw_rad: yaw,
            }
        }));
    }
    poses
}

/// Returns odometry along poses: turns are too long by a share, and every step errs a little.
pub(super) fn odometry(poses: &[Pose], scale: f32, noise: &mut Noise) -> Vec<Pose> {
    let mut odom = Vec::from([poses[0]]);
    for pair in poses.windows(2) {
        let step = pair[0].between(&pair[1]);
        let moved = Pose {
            x_m: step.x_m * (1.0 + 0.5 * scale),
            yaw_rad: step.yaw_rad * (1.0 + scale) + 0.004 * noise.next(),
            ..step
        };
        odom.push(odom.last().unwrap().compose(&moved));
    }
    odom
}

/// The poses of a run, and what became of them.
pub(super) struct Run {
    pub(super) slam: Box<Small>,
    pub(super) live: Vec<Pose>,
    end: Vec<Pose>,
    /// The scan that each keyframe is.
    pub(super) key_scans: Vec<usize>,
}

fn run(world: &[Wall], poses: &[Pose], odom: &[Pose], seed: u32) -> Run {
    run_among(world, |_, _| Vec::new(), poses, odom, seed)
}

/// Runs with people, whose places are given for the number of a pose and the pose.
pub(super) fn run_among(
    world: &[Wall],
    people: impl Fn(usize, &Pose) -> Vec<[f32; 2]>,
    poses: &[Pose],
    odom: &[Pose],
    seed: u32,
) -> Run {
    let config = Config::new(LASER, Motion::WHEELS);
    let mut slam: Box<Small> = Box::new(Slam::new(config));
    let mut room: Box<Room> = Box::default();
    let mut noise = Noise(seed);
    let (mut live, mut hung, mut key_scans) = (Vec::new(), Vec::new(), Vec::new());
    for (number, (pose, odom)) in poses.iter().zip(odom).enumerate() {
        let legs = people(number, pose).into_iter();
        let legs = legs.flat_map(|[x, y]| walls(x - 0.15, y - 0.15, x + 0.15, y + 0.15));
        let around: Vec<Wall> = world.iter().copied().chain(legs).collect();
        let ranges = cast(&around, pose, &mut noise);
        let seen = slam.observe(odom, None, &ranges, &mut room);
        live.push(seen.pose);
        if seen.key == key_scans.len() {
            key_scans.push(number);
        }
        hung.push((seen.key, seen.from_key));
    }
    slam.finish(&mut room);
    let end = hung
        .iter()
        .map(|(key, from)| slam.pose(*key).unwrap().compose(from));
    Run {
        live,
        end: end.collect(),
        slam,
        key_scans,
    }
}

/// Returns the mean distance of poses, metres.
fn error_m(poses: &[Pose], truth: &[Pose]) -> f32 {
    let apart = poses
        .iter()
        .zip(truth)
        .map(|(a, b)| a.between(b).length_m());
    apart.sum::<f32>() / poses.len() as f32
}

/// Twice round the ring: the second round closes on the first, and all poses are better for it.
#[test]
fn a_robot_that_comes_back_closes_the_loop_and_corrects_its_past() {
    let corners = [[1.0, 1.0], [19.0, 1.0], [19.0, 11.0], [1.0, 11.0]];
    let points: Vec<[f32; 2]> = corners.iter().cycle().take(9).copied().collect();
    let poses = drive(&points);
    for seed in 1..3 {
        let odom = odometry(&poses, 0.02, &mut Noise(seed));
        let dead_m = error_m(&odom, &poses);
        let run = run(&ring(), &poses, &odom, seed);
        let (live_m, end_m) = (error_m(&run.live, &poses), error_m(&run.end, &poses));
        let counts = run.slam.counts();
        assert!(dead_m > 0.6, "odometry errs by {dead_m} m");
        assert!(counts.closed >= 4, "{counts:?}");
        assert!(
            end_m < 0.15 && live_m < 0.3,
            "live {live_m} m, end {end_m} m, {counts:?}"
        );
    }
}

/// Returns the numbers of closures on a way of one round and a bit.
fn closures(config: Config, closes: bool) -> Vec<usize> {
    let poses = drive(&[
        [1.0, 1.0],
        [19.0, 1.0],
        [19.0, 11.0],
        [1.0, 11.0],
        [1.0, 1.0],
        [9.0, 1.0],
    ]);
    let odom = odometry(&poses, 0.02, &mut Noise(1));
    let mut slam: Box<Small> = Box::new(Slam::new(config));
    slam.set_closing(closes);
    let (mut room, mut noise): (Box<Room>, _) = (Box::default(), Noise(1));
    let steps = poses.iter().zip(&odom);
    let counts = steps.map(|(pose, odom)| {
        slam.observe(odom, None, &cast(&ring(), pose, &mut noise), &mut room);
        slam.counts().closed
    });
    counts.collect()
}

#[test]
fn a_closure_needs_a_second_one_and_leave_to_close() {
    let config = Config::new(LASER, Motion::WHEELS);
    let first = |counts: &[usize]| counts.iter().copied().find(|count| *count > 0);
    assert_eq!(first(&closures(config, true)), Some(2));
    let mut alone = config;
    alone.rules.agreement = false;
    assert_eq!(first(&closures(alone, true)), Some(1));
    assert_eq!(first(&closures(config, false)), None);
}

/// Two equal corridors side by side, joined by a hall: the second one is no return to the first.
#[test]
fn an_equal_corridor_beside_the_first_closes_no_loop() {
    let mut world: Vec<Wall> = Vec::new();
    world.extend([
        [0.0, 0.0, 0.0, 22.0],
        [0.0, 22.0, 6.0, 22.0],
        [6.0, 22.0, 6.0, 0.0],
        [0.0, 0.0, 6.0, 0.0],
    ]);
    // The wall between them, as thick as 2 m.
    world.extend(walls(2.0, 0.0, 4.0, 20.0));
    for y in [3.0, 7.0, 12.5] {
        world.extend(walls(0.0, y, 0.3, y + 0.4));
        world.extend(walls(4.0, y, 4.3, y + 0.4));
    }
    let poses = drive(&[[1.0, 1.0], [1.0, 21.0], [5.0, 21.0], [5.0, 1.0]]);
    for seed in 1..4 {
        let odom = odometry(&poses, 0.03, &mut Noise(seed));
        let run = run(&world, &poses, &odom, seed);
        assert_eq!(run.slam.counts().closed, 0, "seed {seed}");
        assert!(error_m(&run.live, &poses) < 0.6, "seed {seed}");
    }
}

#[test]
fn a_full_graph_goes_on_by_odometry_and_says_so() {
    let config = Config::new(LASER, Motion::WHEELS);
    let mut slam: Slam<3, 4, BEAMS> = Slam::new(config);
    let mut room: Box<Workspace<3, 256>> = Box::default();
    let world = ring();
    let poses = drive(&[[1.0, 1.0], [6.0, 1.0]]);
    let mut noise = Noise(1);
    let mut full = Vec::new();
    for pose in &poses {
        let ranges = cast(&world, pose, &mut noise);
        let seen = slam.observe(pose, None, &ranges, &mut room);
        full.push(seen.is_full);
        assert!(seen.pose.between(pose).length_m() < 0.1, "{pose:?}");
    }
    assert_eq!((full.first(), full.last()), (Some(&false), Some(&true)));
    assert_eq!(slam.counts().keyframes, 3);
}

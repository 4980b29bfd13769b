use super::*;
use crate::world::{Class, Occupancy};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

const ROBOT: Footprint = Footprint::PIONEER_3AT;

fn random_world(rng: &mut ChaCha8Rng) -> World {
    let mut grid = Occupancy::filled(60, 50, 0.06, [-1.0, 0.5], Class::Free);
    for _ in 0..8 {
        let cell = GridCell {
            i: i64::from(rng.next_u32() % 60),
            j: i64::from(rng.next_u32() % 50),
        };
        grid.set(cell, Class::Wall);
    }
    World::flat("random", grid, Vec::new())
}

fn upright(x_m: f64, y_m: f64, yaw_rad: f64) -> Pose {
    Pose {
        x_m,
        y_m,
        yaw_rad,
        ..Pose::default()
    }
}

/// Least distance between points spread over the outlines and insides of both, 0.02 m apart.
fn sampled_m(world: &World, pose: &Pose) -> f64 {
    let placed = ROBOT.place(pose);
    let mut nearest = FARTHEST_M;
    for square in solid_cells(world, pose, FARTHEST_M + 0.4) {
        for a in -13..=13 {
            for b in -13..=13 {
                let (x, y) = (
                    f64::from(a) / 13.0 * placed.half[0],
                    f64::from(b) / 13.0 * placed.half[1],
                );
                let point = placed.frame.to_world([x, y]);
                nearest = nearest.min(point_to_box(point, square));
            }
        }
    }
    nearest
}

#[test]
fn clearance_is_what_sampling_finds() {
    let mut rng = ChaCha8Rng::seed_from_u64(31);
    let (mut touching, mut near, mut far) = (0, 0, 0);
    for _ in 0..15 {
        let world = random_world(&mut rng);
        for _ in 0..16 {
            let mut uniform = |low: f64, high: f64| {
                low + (high - low) * f64::from(rng.next_u32()) / f64::from(u32::MAX)
            };
            let pose = upright(uniform(-1.0, 2.6), uniform(0.5, 3.5), uniform(-4.0, 4.0));
            let exact = ROBOT.clearance_m(&world, &pose);
            let sampled = sampled_m(&world, &pose);
            // Samples are at most 14 mm from any point of the rectangle.
            assert!(exact <= sampled + 1e-12, "{pose:?}: {exact} > {sampled}");
            assert!(sampled <= exact + 0.0138, "{pose:?}: {exact}, {sampled}");
            assert_eq!(ROBOT.overlaps(&world, &pose), exact == 0.0);
            assert!(ROBOT.clearance_bound_m(&world, &pose) <= exact.max(0.0));
            touching += u32::from(exact == 0.0);
            near += u32::from(exact > 0.0 && exact < 0.2);
            far += u32::from(exact >= 0.2);
        }
    }
    assert!(
        touching > 30 && near > 30 && far > 5,
        "{touching} {near} {far}"
    );
}

#[test]
fn the_gap_between_two_robots_is_what_sampling_finds() {
    let mut rng = ChaCha8Rng::seed_from_u64(33);
    let mut uniform =
        |low: f64, high: f64| low + (high - low) * f64::from(rng.next_u32()) / f64::from(u32::MAX);
    let (mut touching, mut apart) = (0, 0);
    for _ in 0..300 {
        let here = upright(0.0, 0.0, uniform(-3.0, 3.0));
        let other = OtherRobot::new(
            ROBOT,
            upright(uniform(-1.0, 1.0), uniform(-1.0, 1.0), uniform(-3.0, 3.0)),
        );
        let (ours, theirs) = (ROBOT.place(&here), ROBOT.place(other.pose()));
        let mut sampled = f64::INFINITY;
        for a in -13..=13 {
            for b in -13..=13 {
                let share = [f64::from(a) / 13.0, f64::from(b) / 13.0];
                let point = theirs
                    .frame
                    .to_world([share[0] * theirs.half[0], share[1] * theirs.half[1]]);
                let [x, y] = ours.half;
                let local = ours.frame.to_local(point);
                sampled = sampled.min(point_to_box(local, [-x, -y, x, y]));
            }
        }
        let gap_m = ROBOT.gap_m(&here, &other);
        assert!(
            gap_m <= sampled + 1e-12 && sampled <= gap_m + 0.0138,
            "{gap_m} {sampled}"
        );
        assert_eq!(ROBOT.touches(&here, &other), gap_m == 0.0);
        touching += u32::from(gap_m == 0.0);
        apart += u32::from(gap_m > 0.0);
    }
    assert!(touching > 50 && apart > 50, "{touching} {apart}");
}

#[test]
fn a_door_just_wider_than_the_robot_lets_it_pass_straight_only() {
    // A gap of 0.6 m at y in [0.7, 1.3].
    let mut grid = Occupancy::filled(60, 40, 0.05, [0.0, 0.0], Class::Free);
    for j in (0..14).chain(26..40) {
        for i in 28..32 {
            grid.set(GridCell { i, j }, Class::Wall);
        }
    }
    let world = World::flat("door", grid, Vec::new());
    let clearance = ROBOT.clearance_m(&world, &upright(1.5, 1.0, 0.0));
    assert!((clearance - (0.3 - 0.2485)).abs() < 1e-9, "{clearance}");
    assert!(ROBOT.overlaps(&world, &upright(1.5, 1.0, 0.6)));
    assert!(!ROBOT.overlaps(&world, &upright(1.5, 1.0, 0.1)));
    // At a lean of 20° to the right the deck extends by 0.277 sin 20° and the side moves in.
    let leaning = Pose {
        roll_rad: 20.0_f64.to_radians(),
        ..upright(1.5, 1.0, 0.0)
    };
    let out = 0.2485 * 20.0_f64.to_radians().cos() + 0.277 * 20.0_f64.to_radians().sin();
    assert!(out > 0.3 && ROBOT.overlaps(&world, &leaning));
    let aside = Pose {
        y_m: 1.04,
        ..leaning
    };
    let clearance = ROBOT.clearance_m(&world, &aside);
    assert!((clearance - (0.34 - out)).abs() < 1e-9, "{clearance}");
}

/// Every corner of the rotated box lies in the shadow, and a corner touches each of its sides.
#[test]
fn the_shadow_is_the_box_seen_from_above() {
    let mut rng = ChaCha8Rng::seed_from_u64(32);
    for _ in 0..200 {
        let mut angle = || (f64::from(rng.next_u32()) / f64::from(u32::MAX) - 0.5) * 1.2;
        let pose = Pose {
            pitch_rad: angle(),
            roll_rad: angle(),
            ..Pose::default()
        };
        let [forward, left, up] = pose.axes();
        let mut reached = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for k in 0..8 {
            let sign = |bit: u32| if k >> bit & 1 == 1 { 1.0 } else { -1.0 };
            let (a, b) = (sign(0) * ROBOT.half_length_m, sign(1) * ROBOT.half_width_m);
            let h = 0.5 * (1.0 + sign(2)) * ROBOT.height_m;
            for (axis, [low, high]) in reached.iter_mut().enumerate() {
                let place = a * forward[axis] + b * left[axis] + h * up[axis];
                (*low, *high) = (low.min(place), high.max(place));
            }
        }
        for (ours, exact) in ROBOT.shadow(&pose).iter().zip(&reached) {
            assert!((ours[0] - exact[0]).abs() < 1e-12 && (ours[1] - exact[1]).abs() < 1e-12);
        }
    }
}

const DISC: Footprint = Footprint::disc(0.2, 0.3);

/// Points of a disc around the origin, 0.02 m apart.
fn disc_points(radius_m: f64) -> impl Iterator<Item = [f64; 2]> {
    let steps = (radius_m / 0.02).round() as i32;
    let share = move |k: i32| 0.02 * f64::from(k);
    let all =
        (-steps..=steps).flat_map(move |a| (-steps..=steps).map(move |b| [share(a), share(b)]));
    let rim = (0..90).map(move |k| {
        let angle = core::f64::consts::TAU * f64::from(k) / 90.0;
        [radius_m * angle.cos(), radius_m * angle.sin()]
    });
    all.filter(move |[x, y]| x * x + y * y <= radius_m * radius_m)
        .chain(rim)
}

#[test]
fn the_clearance_of_a_disc_is_what_sampling_finds() {
    let mut rng = ChaCha8Rng::seed_from_u64(35);
    let (mut touching, mut apart) = (0, 0);
    for _ in 0..15 {
        let world = random_world(&mut rng);
        for _ in 0..16 {
            let mut uniform = |low: f64, high: f64| {
                low + (high - low) * f64::from(rng.next_u32()) / f64::from(u32::MAX)
            };
            let pose = upright(uniform(-1.0, 2.6), uniform(0.5, 3.5), uniform(-4.0, 4.0));
            let exact = DISC.clearance_m(&world, &pose);
            let mut sampled = FARTHEST_M;
            for square in solid_cells(&world, &pose, FARTHEST_M + 0.2) {
                for [x, y] in disc_points(0.2) {
                    sampled = sampled.min(point_to_box([pose.x_m + x, pose.y_m + y], square));
                }
            }
            assert!(exact <= sampled + 1e-12, "{pose:?}: {exact} > {sampled}");
            assert!(sampled <= exact + 0.0145, "{pose:?}: {exact}, {sampled}");
            assert_eq!(DISC.overlaps(&world, &pose), exact == 0.0);
            assert!(DISC.clearance_bound_m(&world, &pose) <= exact);
            touching += u32::from(exact == 0.0);
            apart += u32::from(exact > 0.0);
        }
    }
    assert!(touching > 20 && apart > 20, "{touching} {apart}");
}

#[test]
fn the_gap_between_a_disc_and_another_hull_is_what_sampling_finds() {
    let mut rng = ChaCha8Rng::seed_from_u64(36);
    let mut uniform =
        |low: f64, high: f64| low + (high - low) * f64::from(rng.next_u32()) / f64::from(u32::MAX);
    let (mut touching, mut apart) = (0, 0);
    for k in 0..300 {
        let (mine, theirs) = [(DISC, ROBOT), (ROBOT, DISC), (DISC, DISC)][k % 3];
        let here = upright(0.0, 0.0, uniform(-3.0, 3.0));
        let there = upright(uniform(-1.0, 1.0), uniform(-1.0, 1.0), uniform(-3.0, 3.0));
        let gap_m = mine.gap_m(&here, &OtherRobot::new(theirs, there));
        // One of the two is a disc: sample it.
        let (disc, other, hull) = if mine.is_round {
            (here, there, theirs)
        } else {
            (there, here, mine)
        };
        let to_hull =
            |[x, y]: [f64; 2]| hull.gap_to_disc_m(&other, [disc.x_m + x, disc.y_m + y], 0.0);
        let sampled = disc_points(0.2).map(to_hull).fold(FARTHEST_M, f64::min);
        assert!(gap_m <= sampled + 1e-12, "{gap_m} {sampled}");
        assert!(sampled <= gap_m + 0.0145, "{gap_m} {sampled}");
        assert_eq!(
            mine.touches(&here, &OtherRobot::new(theirs, there)),
            gap_m == 0.0
        );
        touching += u32::from(gap_m == 0.0);
        apart += u32::from(gap_m > 0.0);
    }
    assert!(touching > 30 && apart > 30, "{touching} {apart}");
}

#[test]
fn a_ray_crosses_the_hull_where_its_points_lie_in_it() {
    let mut rng = ChaCha8Rng::seed_from_u64(37);
    let mut uniform =
        |low: f64, high: f64| low + (high - low) * f64::from(rng.next_u32()) / f64::from(u32::MAX);
    let mut crossings = 0;
    for k in 0..400 {
        let hull = [ROBOT, DISC][k % 2];
        let (from, angle) = ([uniform(-0.5, 0.5), uniform(-0.5, 0.5)], uniform(-3.2, 3.2));
        let along = [angle.cos(), angle.sin()];
        let crossing = hull.crossing_m(from, along);
        crossings += u32::from(crossing.is_some());
        for step in 0..120 {
            let range_m = 0.01 * f64::from(step) + 0.003;
            let point = [0, 1].map(|axis| from[axis] + range_m * along[axis]);
            let depth = hull.gap_to_disc_m(&Pose::default(), point, 0.0);
            let is_within = crossing.is_some_and(|[a, b]| (a..=b).contains(&range_m));
            assert_eq!(is_within, depth == 0.0, "{from:?} {angle} {range_m}");
        }
    }
    assert!((100..390).contains(&crossings), "{crossings}");
}

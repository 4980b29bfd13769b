//! Scans of lidars that turn in rooms of known walls, cast in f64 beam by beam.
//!
//! Every scene is cast from the true pose of each beam, and judged by what one instant would have
//! shown. Units: metres, radians, milliseconds.

mod scene;

use std::vec::Vec;

use super::{MOST_MS, Moved};
use crate::geometry::Pose;
use crate::input::{INVALID_MM, NO_RETURN_MM};
use crate::robot::LaserMount;
use scene::{Dice, at_once, cast, config, end_in_f64, moved, narrow, off_walls, round, scan};

/// The walls of a room are straight, whatever the robot does while its lidar turns.
#[test]
fn walls_seen_while_turning_and_driving_are_straight() {
    let mut dice = Dice(1);
    let mut skewed: f64 = 0.0;
    for round_number in 0..200 {
        let laser = LaserMount {
            newest_first: round_number % 2 == 0,
            turn_time_ms: [100, 200][round_number / 2 % 2],
            ..round()
        };
        let now = [
            dice.within(-2.5, 2.5),
            dice.within(-1.5, 1.5),
            dice.within(-3.0, 3.0),
        ];
        let twist = [dice.within(-0.7, 0.7), dice.within(-2.0, 2.0)];
        let raw = scan(&laser, now, twist);
        let config = config(laser);
        let moved = moved(&config, now, twist).expect("the robot moved");
        let found = at_once(&config, &raw, Some(&moved));
        let (off_m, holes) = off_walls(&laser, now, &found);
        // The first beam and the last one have no neighbour, so they are half a step aside.
        let seam = off_m[2] < 0.03 && off_m[0] < 0.11;
        assert!(seam, "{:?} at {now:?} {twist:?}", &off_m[..3]);
        // What the turn of the robot took from the lidar's was seen by no beam.
        let turn = twist[1].abs() * 1e-3 * f64::from(laser.turn_time_ms);
        let unseen = (turn / f64::from(laser.bearing_step_rad)).ceil() as usize;
        assert!(
            holes <= unseen + 6,
            "{holes} of {unseen} at {now:?} {twist:?}"
        );
        skewed = skewed.max(off_walls(&laser, now, &raw).0[0]);
    }
    assert!(skewed > 1.0, "the scenes test something: {skewed}");
}

/// Beside the corners, ranges are those of a scan of one instant, in f64.
#[test]
fn ranges_are_those_of_one_instant() {
    let mut dice = Dice(2);
    let (mut sum_m, mut count) = (0.0, 0);
    for _ in 0..100 {
        let laser = round();
        let now = [
            dice.within(-2.0, 2.0),
            dice.within(-1.0, 1.0),
            dice.within(-3.0, 3.0),
        ];
        let twist = [dice.within(-0.7, 0.7), dice.within(-2.0, 2.0)];
        let config = config(laser);
        let moved = moved(&config, now, twist);
        let found = at_once(&config, &scan(&laser, now, twist), moved.as_ref());
        for (number, &range_mm) in found.iter().enumerate() {
            if range_mm == INVALID_MM {
                continue;
            }
            let truth_m = cast(&laser, now, number);
            let beside = [number.saturating_sub(1), number + 1];
            let bends = beside.map(|beside| (cast(&laser, now, beside) - truth_m).abs());
            let off_m = (1e-3 * f64::from(range_mm) - truth_m).abs();
            // A corner that lies between two beams is cut by their chord.
            assert!(off_m < 0.03 + bends[0].max(bends[1]), "{number}: {off_m}");
            (sum_m, count) = (sum_m + off_m, count + 1);
        }
    }
    let mean_m = sum_m / f64::from(count);
    assert!(mean_m < 0.006 && count > 16_000, "{mean_m} {count}");
}

#[test]
fn a_scan_of_one_instant_or_of_a_robot_that_stands_is_untouched() {
    let (now, twist) = ([0.5, 0.2, 1.0], [0.4, 0.8]);
    let raw = scan(&round(), now, twist);
    let still = config(LaserMount {
        turn_time_ms: 0,
        ..round()
    });
    let motion = moved(&still, now, twist);
    assert_eq!(at_once(&still, &raw, motion.as_ref()), raw);
    let turns = config(round());
    assert_eq!(moved(&turns, now, [0.0; 2]), None);
    assert_eq!(at_once(&turns, &raw, None), raw);
    assert_ne!(at_once(&turns, &raw, motion.as_ref()), raw);
}

#[test]
fn a_slow_robot_changes_nothing_but_rounding() {
    let (now, twist) = ([0.5, 0.2, 1.0], [1e-4, 1e-4]);
    let config = config(round());
    let raw = scan(&round(), now, twist);
    let moved = moved(&config, now, twist).expect("it moved");
    let found = at_once(&config, &raw, Some(&moved));
    for (found, raw) in found.iter().zip(&raw) {
        assert!(found.abs_diff(*raw) <= 1, "{found} {raw}");
    }
}

/// A robot that turns with its lidar sees less than a turn, one that turns against it sees more.
#[test]
fn what_no_beam_saw_has_no_information() {
    let now = [0.0, 0.0, 0.0];
    for (rate, newest_first, unseen) in [
        (1.0, false, 0),
        (-1.0, false, 6),
        (1.0, true, 6),
        (-1.0, true, 0),
    ] {
        let laser = LaserMount {
            newest_first,
            ..round()
        };
        let config = config(laser);
        let twist = [0.0, rate];
        let moved = moved(&config, now, twist);
        let found = at_once(&config, &scan(&laser, now, twist), moved.as_ref());
        let holes = off_walls(&laser, now, &found).1;
        assert!(
            holes.abs_diff(unseen) <= 1,
            "{rate} {newest_first}: {holes}"
        );
    }
}

/// Nothing came back beside a wall: the wall moves, and so does what is free.
#[test]
fn a_no_return_never_covers_a_return() {
    let mut dice = Dice(3);
    for _ in 0..300 {
        let laser = LaserMount {
            range_limit_mm: dice.within(500.0, 16_382.0) as u16,
            newest_first: dice.next() < 0.5,
            ..round()
        };
        let raw: Vec<u16> = (0..180)
            .map(|_| match dice.next() {
                it if it < 0.3 => NO_RETURN_MM,
                it if it < 0.4 => INVALID_MM,
                _ => dice.within(1.0, f64::from(laser.range_limit_mm)) as u16,
            })
            .collect();
        let (now, twist) = ([0.0; 3], [dice.within(-0.7, 0.7), dice.within(-2.4, 2.4)]);
        let config = config(laser);
        let Some(moved) = moved(&config, now, twist) else {
            continue;
        };
        let found = at_once(&config, &raw, Some(&moved));
        for (number, &range_mm) in raw.iter().enumerate() {
            let is_return = range_mm != INVALID_MM && range_mm < laser.range_limit_mm;
            let (at, range_m) = end_in_f64(&laser, twist, number, range_mm);
            let (nearest, limit_m) = (at.round(), f64::from(laser.range_limit_mm) * 1e-3);
            let is_sure = (at - nearest).abs() < 0.49 && range_m < limit_m - 2e-3;
            if is_return && is_sure {
                let place = nearest.rem_euclid(180.0) as usize;
                let there = found[place];
                // It lies on a chord to a neighbour at most.
                let beside = [(number + 179) % 180, (number + 1) % 180];
                let beside = beside.map(|it| end_in_f64(&laser, twist, it, raw[it]).1);
                let most_mm = 1e3 * range_m.max(beside[0]).max(beside[1]) + 2.0;
                let is_covered = there == INVALID_MM || there == NO_RETURN_MM;
                assert!(
                    !is_covered && f64::from(there) <= most_mm,
                    "{number}: {there}"
                );
            }
        }
    }
}

/// No numbers make it panic, and a scan keeps its number of beams.
#[test]
fn it_is_total() {
    let mut dice = Dice(4);
    let steps = [1e-6, 1e-3, 0.02, 0.5, 6.2];
    for round_number in 0..4_000 {
        let beams = 1 + (180.0 * dice.next()) as u16;
        let most = 6.2 / f64::from(beams);
        let laser = LaserMount {
            x_m: dice.within(-2.0, 2.0) as f32,
            y_m: dice.within(-2.0, 2.0) as f32,
            first_bearing_rad: dice.within(-6.2, 6.2) as f32,
            bearing_step_rad: most.min(steps[round_number % 5]) as f32,
            beams,
            range_limit_mm: 1 + (16_381.0 * dice.next()) as u16,
            turn_time_ms: 1 + (499.0 * dice.next()) as u16,
            newest_first: dice.next() < 0.5,
            ..LaserMount::level(0.0, 0.3)
        };
        let config = config(laser);
        let raw: Vec<u16> = (0..beams)
            .map(|_| match dice.next() {
                it if it < 0.2 => NO_RETURN_MM,
                it if it < 0.3 => INVALID_MM,
                it if it < 0.4 => (65_535.0 * dice.next()) as u16,
                it if it < 0.6 => 1,
                _ => 2_000 + (100.0 * dice.next()) as u16,
            })
            .collect();
        let far = if dice.next() < 0.5 { 10_000.0 } else { 0.3 };
        let now = narrow([
            dice.within(-far, far),
            dice.within(-far, far),
            dice.within(-4.0, 4.0),
        ]);
        let then = Pose {
            x_m: now.x_m + dice.within(-0.3, 0.3) as f32,
            y_m: now.y_m + dice.within(-0.3, 0.3) as f32,
            yaw_rad: now.yaw_rad + dice.within(-1.0, 1.0) as f32,
            ..now
        };
        let elapsed_ms = 1 + (f64::from(MOST_MS) * dice.next()) as u32;
        let then_ms = u32::MAX - 200;
        let now_ms = then_ms.wrapping_add(elapsed_ms);
        let moved = Moved::between(&config, &(then_ms, then), &(now_ms, now));
        let found = at_once(&config, &raw, moved.as_ref());
        assert_eq!(found.len(), raw.len());
        let is_code = |it: &u16| *it < laser.range_limit_mm || *it == NO_RETURN_MM;
        assert!(moved.is_none() || found.iter().all(is_code), "{found:?}");
    }
}

/// Time and motion that tell nothing of the way between two reports.
#[test]
fn a_motion_that_no_robot_makes_is_none() {
    let config = config(round());
    let at = |x_m: f32, yaw_rad: f32| Pose {
        x_m,
        yaw_rad,
        ..Pose::default()
    };
    let between = |ms: u32, to: Pose| {
        Moved::between(
            &config,
            &(500, at(0.0, 0.0)),
            &(500_u32.wrapping_add(ms), to),
        )
    };
    assert!(between(200, at(0.14, 0.4)).is_some());
    assert!(between(MOST_MS, at(0.7, 0.4)).is_some());
    assert_eq!(between(MOST_MS + 1, at(0.7, 0.4)), None);
    assert_eq!(between(0, at(0.14, 0.4)), None);
    // Backwards is nearly the whole range of the clock.
    assert_eq!(between(u32::MAX, at(0.14, 0.4)), None);
    assert_eq!(
        between(200, at(0.3, 0.0)),
        None,
        "twice the greatest speed is 0.28 m"
    );
    assert_eq!(between(200, at(0.0, 1.0)), None);
    assert_eq!(between(200, at(0.0, 0.0)), None, "it stands");
}

//! When a goal is dropped, a passage blocked, and how long the robot stood.

use super::*;

const NEAR: Cell = Cell { x: 10, y: 0 };
const FAR: Cell = Cell { x: 90, y: 0 };

/// Returns the first verdict other than "go on", and its time, for a robot that moves 0.5 m in
/// a round of half a second.
fn verdict(mut round: impl FnMut(u32) -> (Cell, u32)) -> (u32, Verdict) {
    let mut progress = ProgressChecker::new();
    for k in 0..1_000 {
        let at = Point {
            x_m: 0.5 * k as f32,
            y_m: 0.0,
        };
        progress.note_motion(at, 500 * k);
        let (goal, steps) = round(k);
        let verdict = progress.judge(goal, steps, 500 * k);
        if verdict != Verdict::GoOn {
            return (500 * k, verdict);
        }
    }
    (u32::MAX, Verdict::GoOn)
}

#[test]
fn a_goal_that_comes_nearer_is_followed_for_ever() {
    let (_, last) = verdict(|k| (FAR, 2_000 - k));
    assert_eq!(last, Verdict::GoOn);
}

#[test]
fn a_goal_that_comes_no_nearer_is_dropped() {
    let (when_ms, last) = verdict(|_| (FAR, 40));
    assert_eq!(last, Verdict::Drop(ResidualReason::NoProgress));
    assert_eq!(when_ms, NO_PROGRESS_MS + 500);
}

/// Returns the first verdict other than "go on", and its time, for a robot at a reached goal
/// that moves so far in a round of half a second.
fn at_goal(moves_m: f32) -> (u32, Verdict) {
    let mut progress = ProgressChecker::new();
    let verdicts = (0..100).map(|k| {
        let at = Point {
            x_m: moves_m * k as f32,
            y_m: 0.0,
        };
        progress.note_motion(at, 500 * k);
        (500 * k, progress.judge(NEAR, 2, 500 * k))
    });
    let mut other = verdicts.filter(|&(_, verdict)| verdict != Verdict::GoOn);
    other.next().expect("a verdict")
}

#[test]
fn a_goal_that_is_reached_is_looked_at_and_dropped() {
    let (when_ms, last) = at_goal(0.0);
    assert_eq!(last, Verdict::Drop(ResidualReason::Unobservable));
    assert_eq!(when_ms, LOOK_MS + 500);
}

#[test]
fn a_frontier_that_recedes_before_the_robot_is_followed_for_longer() {
    let (when_ms, last) = at_goal(0.5);
    assert_eq!(last, Verdict::Drop(ResidualReason::NoProgress));
    assert_eq!(when_ms, NO_PROGRESS_MS + 500);
}

/// Neither comes nearer than it was the first time.
#[test]
fn a_robot_drawn_to_and_fro_gives_up_both_goals() {
    let (when_ms, last) = verdict(|k| match k / 4 % 2 {
        0 => (NEAR, 30 - k % 4),
        _ => (FAR, 30 - k % 4),
    });
    assert_eq!(last, Verdict::Drop(ResidualReason::NoProgress));
    assert!(when_ms < 3 * NO_PROGRESS_MS, "{when_ms} ms");
}

/// It came near a goal, did something else, and has to come from farther off now.
#[test]
fn a_goal_is_begun_anew_once_the_map_has_grown() {
    let gives_up = |grown_cells: u32| {
        let mut progress = ProgressChecker::new();
        progress.note_known(5_000);
        progress.judge(FAR, 10, 0);
        progress.note_known(5_000 + grown_cells);
        let mut verdicts = (1..40).map(|k| {
            let x_m = 0.5 * k as f32;
            progress.note_motion(Point { x_m, y_m: 0.0 }, 500 * k);
            progress.judge(FAR, 90 - k, 500 * k)
        });
        verdicts.any(|verdict| verdict == Verdict::Drop(ResidualReason::NoProgress))
    };
    assert!(gives_up(GROWTH_CELLS - 1));
    assert!(!gives_up(GROWTH_CELLS));
}

/// A pose, and so a goal, may be anywhere that a message can say.
#[test]
fn goals_are_apart_however_far_they_are() {
    let far = |x: i32| Cell { x, y: -x };
    let mut progress = ProgressChecker::new();
    progress.judge(far(327_679), 40, 500);
    progress.forget(far(-327_680));
    assert_eq!(progress.attempts.len(), 1);
    progress.forget(far(327_675));
    assert!(progress.attempts.is_empty());
}

/// The way that is left is not blamed for the time that the blocked one took.
#[test]
fn after_a_passage_the_way_back_has_all_its_time() {
    let mut progress = ProgressChecker::new();
    for time_ms in [STANDING_MS - 300, STANDING_MS] {
        progress.note_closed();
        assert_eq!(progress.judge(FAR, 40, time_ms), Verdict::GoOn);
    }
    progress.note_closed();
    progress.note_blocked(STANDING_MS);
    assert_eq!(progress.passages_here(), 1);
    let blocked_again_ms = STANDING_MS + u32::from(CLOSED_MS);
    for time_ms in [blocked_again_ms - 500, blocked_again_ms - 1] {
        progress.note_closed();
        assert_eq!(progress.judge(FAR, 90, time_ms), Verdict::GoOn);
    }
    assert_eq!(progress.judge(FAR, 90, 2 * STANDING_MS), Verdict::GoOn);
    let late_ms = 2 * STANDING_MS + 1;
    assert_eq!(progress.judge(FAR, 90, late_ms), Verdict::BlockAhead);
}

#[test]
fn a_robot_that_has_stood_for_long_may_fail_once_more_at_its_next_try() {
    let fails = |stood_ms: u32, moves_m: f32| {
        let mut progress = ProgressChecker::new();
        progress.judge(FAR, 40, stood_ms);
        progress.begin_next_try();
        let at = Point {
            x_m: moves_m,
            y_m: 0.0,
        };
        progress.note_motion(at, stood_ms);
        let failures = (1..=STUCK_PASSAGES).find(|_| {
            progress.note_blocked(stood_ms);
            progress.is_stuck()
        });
        failures.expect("it is stuck at last")
    };
    assert_eq!(fails(LONG_STANDING_MS, 0.0), 3);
    assert_eq!(fails(LONG_STANDING_MS + 1, 0.0), 1);
    assert_eq!(fails(LONG_STANDING_MS + 1, 2.0 * MOVED_M), 3, "it can move");
}

#[test]
fn a_closed_path_is_blocked_in_time_however_long_a_round_takes() {
    for round_ms in [400, 1_000, MOST_ROUND_MS] {
        let mut progress = ProgressChecker::new();
        let rounds = u32::from(CLOSED_MS).div_ceil(round_ms);
        for k in 1..=rounds {
            progress.note_closed();
            let verdict = progress.judge(FAR, 40, k * round_ms);
            assert_eq!(verdict == Verdict::BlockUnreachable, k == rounds, "{k}");
        }
    }
}

#[test]
fn a_goal_behind_a_blocked_passage_is_begun_anew() {
    let mut progress = ProgressChecker::new();
    for k in 0..20 {
        progress.judge(FAR, 40, 500 * k);
    }
    progress.forget(FAR);
    for k in 20..40 {
        progress.stood_ms = 500 * k;
        assert_eq!(progress.judge(FAR, 60, 500 * k), Verdict::GoOn);
    }
}

#[test]
fn a_robot_stands_since_its_last_move_whatever_is_blocked() {
    let mut progress = ProgressChecker::new();
    let here = Point { x_m: 1.0, y_m: 0.0 };
    let mut blocked = 0;
    for k in 1..=100 {
        progress.note_motion(here, 500 * k);
        blocked += u32::from(progress.judge(FAR, 40, 500 * k) == Verdict::BlockAhead);
        assert_eq!(progress.standing_ms(500 * k), 500 * (k - 1));
    }
    assert_eq!(blocked, 3, "one in 14 s");
    progress.note_motion(Point { x_m: 1.4, y_m: 0.0 }, 60_000);
    assert_eq!(progress.standing_ms(61_000), 1_000);
}

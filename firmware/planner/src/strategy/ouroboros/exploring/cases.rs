//! What is asserted of the explorations of [`super`].

use std::string::String;

use crate::config::LoopLimits;
use crate::map::Class;
use crate::path::RoundOutcome;
use crate::strategy::ouroboros::exploring::Exploration;
use crate::strategy::ouroboros::exploring::worlds::{ADJACENT, NESTED, ROOMS, THREE_LOOPS, TREES};
use crate::strategy::ouroboros::{Closed, Tally};

/// Limits for worlds that are as small as the robot's sight.
const SMALL: LoopLimits = LoopLimits {
    least_m: 10.0,
    most_m: 120.0,
    most_per_frontier: 10.0,
    detour: 2.0,
    slack_m: 20.0,
};

/// Asserts that the robot goes round every digit, and that nothing is left unknown.
#[track_caller]
fn assert_closes_all(world: &str) {
    let mut exploration = Exploration::new(world, SMALL);
    exploration.run();
    let islands: String = exploration.turned.keys().collect();
    assert_eq!(exploration.rounded(), islands, "\n{}", exploration.drawn());
    assert_eq!(exploration.unknown(), 0, "\n{}", exploration.drawn());
    assert!(exploration.strategy.tally().closed > 0);
}

#[test]
fn loops_in_a_row_of_halls_are_closed() {
    assert_closes_all(THREE_LOOPS);
}

#[test]
#[ignore = "known to fail: the middle one of three adjacent loops is not closed"]
fn known_red_every_adjacent_loop_is_closed() {
    assert_closes_all(ADJACENT);
}

/// The loops on both sides of the middle one are closed, and their marks leave no tractor point for
/// it.
#[test]
fn adjacent_loops_do_not_trap_the_robot() {
    let mut exploration = Exploration::new(ADJACENT, SMALL);
    exploration.run();
    let drawn = exploration.drawn();
    assert_eq!(exploration.rounded(), "13", "\n{drawn}");
    assert_eq!(exploration.unknown(), 0, "\n{drawn}");
    assert!(exploration.strategy.tally().closed >= 2);
}

#[test]
fn nested_loops_are_closed() {
    assert_closes_all(NESTED);
}

#[test]
fn rooms_without_a_loop_do_not_hold_the_robot() {
    let mut exploration = Exploration::new(ROOMS, LoopLimits::default());
    exploration.run();
    assert_eq!(exploration.unknown(), 0, "\n{}", exploration.drawn());
    let most = 2 * exploration
        .world
        .iter()
        .flatten()
        .filter(|c| **c == '.')
        .count();
    assert!(
        exploration.path.len() < most,
        "{} cells",
        exploration.path.len()
    );
}

#[test]
fn small_obstacles_make_no_loop_and_everything_is_seen() {
    let mut exploration = Exploration::new(TREES, LoopLimits::default());
    exploration.run();
    assert_eq!(exploration.unknown(), 0, "\n{}", exploration.drawn());
}

#[test]
fn a_tractor_point_that_falls_on_an_obstacle_is_gone_and_its_loop_with_it() {
    let mut exploration = Exploration::new(ADJACENT, LoopLimits::default());
    exploration.see();
    let mut time_ms = 0;
    while exploration.strategy.shield().is_none() {
        time_ms += 800;
        assert_ne!(
            exploration.plan(time_ms),
            RoundOutcome::Nothing,
            "no loop was begun"
        );
        exploration.go();
    }
    let tractor = exploration.strategy.tractor().unwrap();
    // The map is replaced: at the tractor point there is an obstacle of 0.6 m now.
    for part in (-2..4).flat_map(|dy| (-2..4).map(move |dx| (dx, dy))) {
        let cell = tractor.offset(part.0, part.1);
        exploration.tiles.set(cell, Class::Obstacle).unwrap();
    }
    let _ = exploration.plan(time_ms + 800);
    assert_eq!(exploration.strategy.tractor(), None);
    assert_eq!(exploration.strategy.shield(), None);
    assert_eq!(exploration.strategy.tally().closed, 0, "it was not reached");
    assert!(
        !exploration.strategy.closed_regions().is_closed(tractor),
        "nor is anything marked"
    );
    assert!(
        !exploration.frontier.path().is_empty(),
        "the robot goes on exploring"
    );
}

#[test]
fn a_loop_that_is_not_worth_closing_is_not_begun() {
    let limits = LoopLimits {
        least_m: 500.0,
        ..LoopLimits::default()
    };
    let mut exploration = Exploration::new(ADJACENT, limits);
    exploration.run();
    assert_eq!(exploration.strategy.tally(), Tally::default());
    assert_eq!(exploration.unknown(), 0);
}

#[test]
fn a_loop_that_takes_too_long_is_given_up() {
    // A loop round a block is 20 m and more; half of that is too far here.
    let limits = LoopLimits {
        detour: 0.2,
        slack_m: 2.0,
        ..SMALL
    };
    let mut exploration = Exploration::new(ADJACENT, limits);
    exploration.run();
    let tally = exploration.strategy.tally();
    assert!(tally.given_up > 0, "{tally:?}");
    let kinds = exploration.closed_kinds();
    assert!(kinds.contains(&Closed::GivenUp), "{kinds:?}");
    assert_eq!(kinds.contains(&Closed::Loop), tally.closed > 0, "{kinds:?}");
    assert_eq!(exploration.unknown(), 0, "it went on all the same");
}

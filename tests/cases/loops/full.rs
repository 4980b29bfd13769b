//! Cases that take hours: `tests/run --full` runs them.

use crate::sides::{Fork, assert_follows_preference};
use crate::{closed, impatience, limits, patrol, slam, uneven};

#[test]
#[ignore = "takes hours: 420 runs; tests/run --full runs it"]
fn loops_of_every_start_are_closed_on_the_way() {
    closed::check_every_start("loops-full");
}

#[test]
#[ignore = "takes minutes: 120 runs; tests/run --full runs it"]
fn rails_with_and_without_impatience() {
    impatience::check_every_start("impatience-full");
}

#[test]
#[ignore = "takes long: 210 runs; tests/run --full runs it"]
fn loops_with_and_without_limits() {
    limits::check_every_start("loop-limits-full");
}

#[test]
#[ignore = "takes a quarter of an hour: 90 runs; tests/run --full runs it"]
fn closed_loops_correct_the_map_of_five_starts() {
    slam::check_five_starts("slam-full");
}

#[test]
#[ignore = "takes long: 15 patrols of half an hour; tests/run --full runs it"]
fn a_patrol_from_every_start_visits_every_rail() {
    patrol::check_every_start("patrol-full");
}

#[test]
#[ignore = "takes long: 24 runs; tests/run --full runs it"]
fn loops_of_more_starts_keep_off_holes_and_drops() {
    uneven::check(
        "loops-uneven-full",
        &["slope", "holes", "building", "cliff"],
        3,
    );
}

#[test]
#[ignore = "takes long: 300 runs; tests/run --full runs it"]
fn at_a_t_the_robot_turns_to_the_openings_in_95_of_100() {
    assert_follows_preference(Fork::T, 100, 95);
}

#[test]
#[ignore = "takes long: 300 runs; tests/run --full runs it"]
fn at_a_cross_the_robot_turns_to_the_openings_in_95_of_100() {
    assert_follows_preference(Fork::Cross, 100, 95);
}

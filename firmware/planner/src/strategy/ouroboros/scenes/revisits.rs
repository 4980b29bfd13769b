//! Revisits of a robot that has nothing left to explore; see [`super`]. `o` is a closed region.

use std::vec::Vec;

use crate::config::{LoopLimits, Tuning};
use crate::geometry::Cell;
use crate::strategy::ouroboros::closed_regions::{Closed, ClosedRegions};
use crate::strategy::ouroboros::revisit::{self, Found, Revisit};
use crate::strategy::ouroboros::scenes::{Memory, SLOTS, Scene, TUNING, at};

/// Two loops side by side, and a corridor that ends; the left loop was closed.
const RIGHT_LOOP_OPEN: &str = "
    ########################################################################
    #ooooooooooooooooo.....................................................#
    #oooooooooooooooo>.....................................................#
    #ooooooooooooooooo.....................................................#
    #ooo##########ooo##################################################...##
    #ooo##########ooo##################################################...##
    #ooo##########ooo##################################################...##
    #ooo##########ooo##################################################...##
    #ooo##########ooo##################################################...##
    #ooo##########ooo##################################################...##
    #ooo##########ooo##################################################...##
    #ooo##########ooo##################################################...##
    #ooo##########ooo##################################################...##
    #ooo##########ooo##################################################...##
    #ooo##########ooo##################################################...##
    #ooo##########ooo##################################################...##
    #ooooooooooooooooo.....................................................#
    #ooooooooooooooooo.....................................................#
    #ooooooooooooooooo.....................................................#
    ########################################################################";

/// As above, with a wall on the right block's far side: two corridors that end.
const NO_RIGHT_LOOP: &str = "
    ########################################################################
    #ooooooooooooooooo.....................................................#
    #oooooooooooooooo>.....................................................#
    #ooooooooooooooooo.....................................................#
    #ooo##########ooo#######################################################
    #ooo##########ooo#######################################################
    #ooo##########ooo#######################################################
    #ooo##########ooo#######################################################
    #ooo##########ooo#######################################################
    #ooo##########ooo#######################################################
    #ooo##########ooo#######################################################
    #ooo##########ooo#######################################################
    #ooo##########ooo#######################################################
    #ooo##########ooo#######################################################
    #ooo##########ooo#######################################################
    #ooo##########ooo#######################################################
    #ooooooooooooooooo.....................................................#
    #ooooooooooooooooo.....................................................#
    #ooooooooooooooooo.....................................................#
    ########################################################################";

/// The open stretch of the right loop is too short for a tractor point behind the robot.
const LITTLE_LEFT: &str = "
    ########################################################################
    #oooooooooooooooooooooooooooooooooooooooooooooooooooooooooooooooooooooo#
    #oooooooooooooooo>ooooooooooooooooooooooooooooooooooooooooooooooooooooo#
    #oooooooooooooooooooooooooooooooooooooooooooooooooooooooooooooooooooooo#
    #ooo##########ooo##################################################...##
    #ooo##########ooo##################################################...##
    #ooo##########ooo##################################################...##
    #ooo##########ooo##################################################...##
    #ooo##########ooo##################################################...##
    #ooo##########ooo##################################################...##
    #ooo##########ooo##################################################...##
    #ooo##########ooo##################################################...##
    #ooo##########ooo##################################################...##
    #ooo##########ooo##################################################...##
    #ooo##########ooo##################################################...##
    #ooo##########ooo##################################################...##
    #oooooooooooooooooooooooooooooooooooooooooooooooooooooooooooooooooooooo#
    #oooooooooooooooooooooooooooooooooooooooooooooooooooooooooooooooooooooo#
    #oooooooooooooooooooooooooooooooooooooooooooooooooooooooooooooooooooooo#
    ########################################################################";

/// The closed regions of the picture.
fn regions(scene: &Scene) -> ClosedRegions<SLOTS> {
    let mut regions = ClosedRegions::new();
    let centres = scene.centres();
    for (y, row) in scene.picture.iter().enumerate() {
        for (x, &character) in row.iter().enumerate() {
            if matches!(character, 'o' | '>') && centres.is_centre(at(x, y)) {
                regions.add_pending(at(x, y), TUNING.near_cells);
            }
        }
    }
    regions.close_pending(Closed::Loop);
    regions
}

/// The goals of all revisits, one after the other, each settled as if the robot had been there.
fn revisits(scene: &mut Scene, regions: &mut ClosedRegions<SLOTS>) -> Vec<Cell> {
    let mut memory = Memory::new();
    let mut places = Vec::new();
    // Every call that finds nothing closes a branch at least, so there is an end.
    for _ in 0..40 {
        let mut round = scene.round();
        match revisit::find(&mut round, regions, &mut memory.lend()) {
            Found::Place(place) => {
                revisit::settle(&round, regions, place);
                places.push(place);
            }
            Found::NotHere => {}
            Found::None => return places,
        }
    }
    panic!("revisits without end: {places:?}");
}

#[test]
fn the_goal_is_the_middle_of_a_stretch_that_the_robot_only_saw() {
    let mut scene = Scene::parse(RIGHT_LOOP_OPEN);
    let mut regions = regions(&scene);
    let places = revisits(&mut scene, &mut regions);
    // The open cells go all round the right block, but a corner of the skeleton parts them: the
    // goal is in the longer half.
    let [place] = places[..] else {
        panic!("one revisit: {places:?}");
    };
    assert!(
        place.x > at(40, 0).x && scene.centres().is_centre(place),
        "{place:?}"
    );
    assert_eq!(
        regions.closed(place),
        Some(Closed::GivenUp),
        "it is not looked at again"
    );
}

#[test]
fn there_is_no_revisit_where_there_is_no_loop() {
    let mut scene = Scene::parse(NO_RIGHT_LOOP);
    let mut regions = regions(&scene);
    assert_eq!(revisits(&mut scene, &mut regions), []);
}

#[test]
fn there_is_no_revisit_for_a_few_metres() {
    let mut scene = Scene::parse(LITTLE_LEFT);
    let mut regions = regions(&scene);
    assert_eq!(revisits(&mut scene, &mut regions), []);
}

#[test]
fn there_is_no_revisit_to_a_loop_that_is_not_worth_closing() {
    let mut scene = Scene::parse(RIGHT_LOOP_OPEN);
    scene.limits = LoopLimits {
        most_m: 15.0,
        ..LoopLimits::default()
    };
    let mut regions = regions(&scene);
    assert_eq!(revisits(&mut scene, &mut regions), []);
}

#[test]
fn there_is_no_revisit_with_no_branches() {
    let mut scene = Scene::parse(RIGHT_LOOP_OPEN);
    let mut regions = regions(&scene);
    let mut tuning = Tuning::DEFAULT;
    tuning.ouroboros.most_branches = 0;
    let mut round = scene.round();
    round.tuning = &tuning;
    let found = revisit::find(&mut round, &mut regions, &mut Memory::new().lend());
    assert!(matches!(found, Found::None), "{found:?}");
    // The same scene has one.
    assert_eq!(revisits(&mut scene, &mut regions).len(), 1);
}

#[test]
fn a_revisit_is_given_up_when_the_robot_has_driven_too_far() {
    let limits = LoopLimits::default();
    let mut revisit = Revisit::to(at(5, 5));
    let steps = 100;
    assert!(!revisit.is_over(steps, &limits));
    let most_m = limits.slack_m + limits.detour * steps as f32 * 0.2;
    let mut strides = 0;
    while !revisit.is_over(steps, &limits) {
        revisit.budget.note(0.5, 0.0);
        strides += 1;
    }
    let driven_m = 0.5 * strides as f32;
    assert!((driven_m - most_m).abs() <= 1.0, "{driven_m} m of {most_m}");
}

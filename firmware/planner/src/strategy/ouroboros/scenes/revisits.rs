//! Where a robot is sent that has nothing left to explore; see [`super`].
//!
//! `o` is where it closed a loop.

use std::vec::Vec;

use crate::config::LoopLimits;
use crate::geometry::Cell;
use crate::strategy::ouroboros::closed_regions::Marks;
use crate::strategy::ouroboros::revisit::{self, Errand, Found};
use crate::strategy::ouroboros::scenes::{Memory, SLOTS, Scene, at};

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

/// The same way, but the right block's far side is a wall: two corridors that end.
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

/// What was only seen of the right loop is too short for a tractor point behind the robot.
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

/// Marks where the picture has them.
fn marks(scene: &Scene) -> Marks<SLOTS> {
    let mut marks = Marks::new();
    marks.reset((8, 6));
    let ground = scene.ground();
    for (y, row) in scene.picture.iter().enumerate() {
        for (x, &character) in row.iter().enumerate() {
            if matches!(character, 'o' | '>') && ground.is_centre(at(x, y)) {
                marks.note(at(x, y));
            }
        }
    }
    marks.keep();
    marks
}

/// Every place the robot is sent to, one after the other, each settled as if the robot had been there.
fn errands(scene: &mut Scene, marks: &mut Marks<SLOTS>) -> Vec<Cell> {
    let mut memory = Memory::new();
    let mut places = Vec::new();
    // Every call that finds nothing marks a branch at least, so this comes to an end.
    for _ in 0..40 {
        let mut round = scene.round();
        match revisit::find(&mut round, marks, &mut memory.lend()) {
            Found::Place(place) => {
                revisit::settle(&round, marks, place);
                places.push(place);
            }
            Found::NotHere => {}
            Found::None => return places,
        }
    }
    panic!("errands without end: {places:?}");
}

#[test]
fn the_robot_is_sent_to_the_middle_of_what_it_only_saw_of_a_loop() {
    let mut scene = Scene::parse(RIGHT_LOOP_OPEN);
    let mut marks = marks(&scene);
    let places = errands(&mut scene, &mut marks);
    // From mark to mark it is all round the right block, but the skeleton's corner parts it: the longer half has the errand.
    let [place] = places[..] else {
        panic!("one errand: {places:?}");
    };
    assert!(
        place.x > at(40, 0).x && scene.ground().is_centre(place),
        "{place:?}"
    );
    assert!(marks.is_marked(place), "it is not looked at again");
}

#[test]
fn there_is_no_errand_where_there_is_no_loop() {
    let mut scene = Scene::parse(NO_RIGHT_LOOP);
    let mut marks = marks(&scene);
    assert_eq!(errands(&mut scene, &mut marks), []);
}

#[test]
fn there_is_no_errand_for_a_few_metres() {
    let mut scene = Scene::parse(LITTLE_LEFT);
    let mut marks = marks(&scene);
    assert_eq!(errands(&mut scene, &mut marks), []);
}

#[test]
fn there_is_no_errand_to_a_loop_that_is_not_worth_it() {
    let mut scene = Scene::parse(RIGHT_LOOP_OPEN);
    scene.limits = LoopLimits {
        most_m: 15.0,
        ..LoopLimits::default()
    };
    let mut marks = marks(&scene);
    assert_eq!(errands(&mut scene, &mut marks), []);
}

#[test]
fn an_errand_is_given_up_when_the_robot_has_come_too_far() {
    let limits = LoopLimits::default();
    let mut errand = Errand::to(at(5, 5));
    let steps = 100;
    assert!(!errand.is_over(steps, &limits));
    let most_m = limits.slack_m + limits.detour * steps as f32 * 0.2;
    let mut strides = 0;
    while !errand.is_over(steps, &limits) {
        errand.detour.note(0.5, 0.0);
        strides += 1;
    }
    let come_m = 0.5 * strides as f32;
    assert!((come_m - most_m).abs() <= 1.0, "{come_m} m of {most_m}");
}

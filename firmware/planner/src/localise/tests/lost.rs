//! Robots that were carried: through a furnished room, and through a hall that looks the same from
//! its other end.

use std::vec::Vec;

use super::{Scene, Solid, furnished, room};
use crate::localise::Quality;

/// Steps of a whole search, and some more.
const SEARCH: u32 = 260;
/// Steps of the search with the turns that odometry allows.
const NEAR_SEARCH: u32 = 50;

/// A hall with boxes. Half a turn maps it to itself.
fn hall() -> Vec<Solid> {
    let mut solids = room([-4.5, 4.5, -2.7, 2.7]);
    let boxes = [
        [-3.6, -3.0, 1.6, 2.0],
        [-2.3, -1.9, 1.0, 2.1],
        [-1.2, -0.6, 1.5, 1.8],
        [0.6, 1.5, 1.9, 2.7],
        [2.0, 2.3, 1.2, 1.7],
        [3.2, 3.6, 0.8, 2.2],
    ];
    for [x0, x1, y0, y1] in boxes {
        solids.extend([[x0, x1, y0, y1], [-x1, -x0, -y1, -y0]]);
    }
    solids
}

/// A robot that has looked about at places 1.4 m apart to the left, and looks to the right.
fn seen(solids: Vec<Solid>, places: u32) -> Scene {
    let mut scene = Scene::new(solids);
    for _ in 0..places {
        scene.turn(20);
        for _ in 0..14 {
            scene.step((0.1, 0.0), (0.1, 0.0));
        }
        scene.turn(20);
    }
    scene
}

impl Scene {
    /// Turns for this number of steps; forty are a whole turn.
    fn turn(&mut self, steps: u32) {
        for _ in 0..steps {
            self.step((0.0, 0.157_08), (0.0, 0.157_08));
        }
    }
}

#[test]
fn a_robot_that_is_carried_and_turned_is_found() {
    let mut scene = seen(furnished(), 1);
    scene.truth = [2.4, -1.6, 2.3];
    scene.stand(3);
    assert_eq!(scene.quality(), Quality::Lost);
    scene.stand(SEARCH);
    scene.assert_found();
}

/// From 2.8 m left of the middle to 1.9 m right of it. The place from which the hall looks the same
/// is only 0.9 m from where the robot was, half a turn away.
#[test]
fn a_robot_that_slid_far_is_not_turned_about() {
    let mut scene = seen(hall(), 2);
    scene.step((4.7, 0.0), (0.0, 0.0));
    scene.stand(2);
    assert_eq!(scene.quality(), Quality::Lost);
    scene.stand(NEAR_SEARCH);
    scene.assert_found();
}

#[test]
fn of_two_places_that_fit_alike_none_is_taken() {
    let mut scene = seen(hall(), 2);
    scene.truth = [0.4, -0.3, 1.6];
    scene.stand(SEARCH);
    assert_eq!(scene.quality(), Quality::Lost);
    assert!(scene.localiser.has_given_up());
}

/// The walls of a room stand 0.4 m nearer than the map has them, as those of a fold that the map
/// was made to forget.
#[test]
fn what_the_map_forgot_contradicts_no_place() {
    for is_expected in [false, true] {
        let mut scene = Scene::new(room([-3.0, 3.0, -2.5, 2.5]));
        scene.turn(40);
        scene.solids = room([-2.6, 2.6, -2.1, 2.1]);
        if is_expected {
            let tuning = &scene.config.tuning.localise;
            scene.localiser.expect_contradiction(tuning);
        }
        scene.stand(2);
        assert_eq!(scene.localiser.may_enter(), is_expected);
        if is_expected {
            scene.turn(40);
            scene.stand(30);
            scene.assert_found();
        }
    }
}

//! The choice by gain over cost: turning about, levels, what is worth its trip.

use core::f32::consts::PI;

use super::*;

#[test]
fn of_equal_gains_the_nearer_wins_unless_the_robot_must_turn_about() {
    let [west, east] = ENDS;
    let goal = |yaw_rad| next(&mut by_gain(0.0, yaw_rad), &mut Frontier::new(), None);
    assert!(is_at(goal(PI), west), "ahead, 4 m");
    assert!(is_at(goal(0.5 * PI), west), "to either side: 4 m of 6 m");
    assert!(is_at(goal(0.0), east), "6 m ahead, 4 m behind");
}

#[test]
fn the_greater_gain_wins_if_the_way_is_as_long() {
    // What is known beyond the eastern end is not gained there.
    let mut tiles = corridor();
    for x in 62..92 {
        for y in -30..=30 {
            tiles.set(Cell { x, y }, Class::Obstacle).expect("room");
        }
    }
    let heights = slope(&tiles);
    let mut scene = Scene {
        order: Order::Gain { worth: 0.0 },
        ..Scene::new(tiles, heights)
    };
    let goal = next(&mut scene, &mut Frontier::new(), None);
    assert!(is_at(goal, ENDS[0]), "{goal}");
}

#[test]
fn the_present_goal_is_kept_until_another_is_clearly_better() {
    let [west, east] = ENDS;
    let mut scene = by_gain(0.0, 0.0);
    let mut frontier = Frontier::new();
    assert!(is_at(next(&mut scene, &mut frontier, None), east));
    // Alone, the western end would win by less than 30 %.
    scene.yaw_rad = 0.35 * PI;
    let alone = next(&mut scene, &mut Frontier::new(), None);
    assert!(is_at(alone, west), "{alone}");
    assert!(is_at(next(&mut scene, &mut frontier, None), east));
    scene.yaw_rad = PI;
    assert!(is_at(next(&mut scene, &mut frontier, None), west));
}

#[test]
fn a_level_counts_as_way_in_the_order_by_gain() {
    let [west, east] = ENDS;
    let goal = |reference_m| next(&mut by_gain(0.0, PI), &mut Frontier::new(), reference_m);
    assert!(is_at(goal(None), west));
    assert!(is_at(goal(Some(0.0)), east), "0.9 m lower counts as 40 m");
    assert!(is_at(goal(Some(-0.9)), west), "it is on the robot's level");
}

/// The corridor, with unexplored pockets of 1.2 m at its ends.
fn corridor_with_pockets() -> Box<Tiles<24, 64>> {
    let mut tiles = corridor();
    let [west, east] = ENDS;
    let mut wall = |x, y| tiles.set(Cell { x, y }, Class::Obstacle).expect("room");
    for x in (west - 12..west).chain(east..east + 12) {
        [-HALF, HALF].into_iter().for_each(|y| wall(x, y));
    }
    for y in -HALF..=HALF {
        [west - 12, east + 11].into_iter().for_each(|x| wall(x, y));
    }
    tiles
}

#[test]
fn an_open_goal_is_worth_every_trip() {
    let mut scene = by_gain(7.0, 0.0);
    assert!(is_at(next(&mut scene, &mut Frontier::new(), None), ENDS[1]));
}

#[test]
fn what_is_not_worth_the_trip_is_left_and_listed() {
    let tiles = corridor_with_pockets();
    let heights = slope(&tiles);
    let mut scene = Scene {
        order: Order::Gain { worth: 7.0 },
        ..Scene::new(tiles, heights)
    };
    let mut frontier = Frontier::new();
    scene.replan(&mut frontier, None, 64 * 8);
    assert!(frontier.path().is_empty());
    let left = frontier.residual_frontiers();
    let reasons: vec::Vec<_> = left.iter().map(|left| left.reason).collect();
    assert_eq!(reasons, [ResidualReason::NotWorthIt; 2], "one at each end");
    // It is no longer left once a trip costs less.
    scene.order = Order::Gain { worth: 0.1 };
    assert!(is_at(next(&mut scene, &mut frontier, None), ENDS[1]));
    assert!(frontier.residual_frontiers().is_empty());
}

#[test]
fn by_gain_too_a_path_across_other_levels_gives_way_to_one_on_the_goals() {
    let northmost = |dip_m, pairs| {
        let tiles = corridor_with_a_way_round();
        let heights = dip(&tiles, dip_m);
        let mut frontier = Frontier::new();
        let mut scene = Scene {
            order: Order::Gain { worth: 0.0 },
            ..Scene::new(tiles, heights)
        };
        scene.replan(&mut frontier, Some(0.0), pairs);
        assert!(frontier.path().goal().x >= 76, "the only frontier");
        let cells = frontier.path().cells().iter();
        cells.map(|cell| cell.y).max().expect("a path")
    };
    let room = 64 * 8;
    assert!(northmost(0.0, room) < 8, "level ground: straight on");
    assert!(northmost(1.5, room) > 30, "round a dip of 1.5 m");
    assert!(northmost(1.5, 1) < 8, "no memory for a second way");
}

//! Which of two frontiers is gone to: a corridor with one at each end.

use std::boxed::Box;
use std::vec;

use crate::config::UnevenGround;
use crate::field::local_grid::LocalGrid;
use crate::geometry::{Cell, Point};
use crate::grid::Site;
use crate::ground::elevation::{Elevation, WINDOW_CELLS};
use crate::map::{Class, Tiles};
use crate::path::goal_cost::GoalCost;
use crate::path::height_levels::{HeightLevels, LevelCost};
use crate::path::residual_frontiers::ResidualFrontiers;
use crate::path::{PlanningContext, PlanningScratch, RoundOutcome};
use crate::roadmap::configuration_space::Footprint;
use crate::roadmap::skeleton::{Skeleton, Space};
use crate::strategy::frontier::Frontier;

/// Half the width of the corridor, cells.
const HALF: i32 = 8;
/// Where it ends: nearer in the west.
const ENDS: [i32; 2] = [-40, 60];

fn corridor() -> Box<Tiles<24, 64>> {
    let mut tiles = Box::<Tiles<24, 64>>::default();
    tiles.reset(8, 8);
    let [west, east] = ENDS;
    for x in west..east {
        for y in -HALF..=HALF {
            let class = if y.abs() == HALF {
                Class::Obstacle
            } else {
                Class::Free
            };
            tiles.set(Cell { x, y }, class).expect("room");
        }
    }
    tiles
}

/// Level ground, but for a slope that leads down from `x` = −10 to the west.
fn storeys(tiles: &Tiles<24, 64>) -> Box<HeightLevels<24>> {
    let (mut heights, mut marks) = (vec![0; 2 * WINDOW_CELLS], vec![0; WINDOW_CELLS]);
    let mut origin = Cell::default();
    let mut storeys = Box::<HeightLevels<24>>::default();
    for middle in (-40..=60).step_by(20) {
        let mut window = Elevation::new(&mut heights, &mut marks, &mut origin);
        window.follow(Cell { x: middle, y: 0 });
        for x in middle - 32..middle + 32 {
            for y in -HALF..=HALF {
                let below = (-10 - x).max(0);
                window.measure(Cell { x, y }, -0.03 * below as f32);
            }
        }
        storeys.note(&window.read(), tiles);
    }
    storeys
}

/// The x of the goal that a robot at x = 0 takes, where its storey is so high; without heights for `None`.
fn goal(storey_m: Option<f32>) -> i32 {
    goals([storey_m])[0]
}

/// The x of the goals that it takes one after the other, if its storey changes.
fn goals<const N: usize>(storeys_m: [Option<f32>; N]) -> [i32; N] {
    let tiles = corridor();
    let storeys = storeys(&tiles);
    let disc = Footprint::new(0.3);
    let mut topology = Box::new(Skeleton::<64>::new());
    topology.reset(Space::KnownFree);
    while !topology.advance(&tiles, &disc, u32::MAX) {}
    let (mut residues, mut ring) = (vec![[0; 2]; 64 * 8], vec![0; 1024]);
    let mut view = LocalGrid::new();
    let mut frontier = Frontier::new();
    let robot = Point {
        x_m: 0.05,
        y_m: 0.05,
    };
    storeys_m.map(|storey_m| {
        let known = PlanningContext {
            topology: &topology,
            tiles: &tiles,
            disc: &disc,
            levels: storey_m.map(|storey_m| LevelCost {
                heights: &storeys,
                ground: &UnevenGround::TABLE_I,
                reference_m: storey_m,
            }),
        };
        let lent = PlanningScratch {
            residues: &mut residues,
            ring: &mut ring,
            view: &mut view,
        };
        assert_eq!(frontier.replan(&known, robot, 0, lent), RoundOutcome::Path);
        frontier.path().goal().x
    })
}

#[test]
fn the_nearer_goal_waits_if_it_lies_on_another_storey() {
    let [west, east] = ENDS;
    let near = |x: i32, end: i32| (x - end).abs() <= 3;
    assert!(near(goal(None), west), "nearest first");
    assert!(
        near(goal(Some(0.0)), east),
        "0.9 m lower counts for 40 m of way"
    );
    assert!(near(goal(Some(-0.9)), west), "it is the robot's storey");
    assert!(near(goal(Some(-0.45)), west), "as far off as the other one");
}

#[test]
fn a_goal_is_not_left_for_the_storeys_on_the_way_to_it() {
    let [west, east] = ENDS;
    let all_near = |goals: [i32; 3], end: i32| goals.iter().all(|goal| (goal - end).abs() <= 3);
    // To a fresh eye the second storey's goal is the other one each time.
    let from_above = goals([0.0, -0.45, 0.0].map(Some));
    assert!(all_near(from_above, east), "{from_above:?}");
    let from_below = goals([-0.9, 0.0, 0.0].map(Some));
    assert!(all_near(from_below, west), "{from_below:?}");
}

/// A corridor to the east, closed in the west, and a way round from x = 4 to 60 cells, 4 m to the north.
fn corridor_with_a_way_round() -> Box<Tiles<24, 64>> {
    let mut tiles = Box::<Tiles<24, 64>>::default();
    tiles.reset(8, 8);
    let is_free = |x: i32, y: i32| {
        let straight = (-4..80).contains(&x) && y.abs() < 6;
        let aside = (-4..8).contains(&x) || (54..66).contains(&x);
        straight
            || (aside && (0..46).contains(&y))
            || (-4..66).contains(&x) && (34..46).contains(&y)
    };
    for (x, y) in (-5..80).flat_map(|x| (-6..47).map(move |y| (x, y))) {
        let class = if is_free(x, y) {
            Class::Free
        } else {
            Class::Obstacle
        };
        tiles.set(Cell { x, y }, class).expect("room");
    }
    tiles
}

/// Level ground, but for a dip in the corridor.
fn dip(tiles: &Tiles<24, 64>, dip_m: f32) -> Box<HeightLevels<24>> {
    let (mut heights, mut marks) = (vec![0; 2 * WINDOW_CELLS], vec![0; WINDOW_CELLS]);
    let mut origin = Cell::default();
    let mut storeys = Box::<HeightLevels<24>>::default();
    for middle in (0..=80).step_by(20) {
        let mut window = Elevation::new(&mut heights, &mut marks, &mut origin);
        window.follow(Cell { x: middle, y: 20 });
        for (x, y) in (middle - 32..middle + 32).flat_map(|x| (-8..48).map(move |y| (x, y))) {
            let is_dip = (16..40).contains(&x) && y < 16;
            window.measure(Cell { x, y }, if is_dip { -dip_m } else { 0.0 });
        }
        storeys.note(&window.read(), tiles);
    }
    storeys
}

/// How far north the path to the frontier in the east leads, cells, with memory for so many pairs behind the wave.
fn northmost(dip_m: f32, pairs: usize) -> i32 {
    let tiles = corridor_with_a_way_round();
    let storeys = dip(&tiles, dip_m);
    let disc = Footprint::new(0.3);
    let mut topology = Box::new(Skeleton::<64>::new());
    topology.reset(Space::KnownFree);
    while !topology.advance(&tiles, &disc, u32::MAX) {}
    let known = PlanningContext {
        topology: &topology,
        tiles: &tiles,
        disc: &disc,
        levels: Some(LevelCost {
            heights: &storeys,
            ground: &UnevenGround::TABLE_I,
            reference_m: 0.0,
        }),
    };
    let words = topology.frame().shape.words();
    let (mut residues, mut ring) = (vec![[0; 2]; words + pairs], vec![0; 1024]);
    let mut view = LocalGrid::new();
    let lent = PlanningScratch {
        residues: &mut residues,
        ring: &mut ring,
        view: &mut view,
    };
    let robot = Point {
        x_m: 0.05,
        y_m: 0.05,
    };
    let mut frontier = Frontier::new();
    assert_eq!(frontier.replan(&known, robot, 0, lent), RoundOutcome::Path);
    assert!(frontier.path().goal().x >= 76, "the only frontier");
    let cells = frontier.path().cells().iter();
    cells.map(|cell| cell.y).max().expect("a path")
}

#[test]
fn a_path_by_another_storey_gives_way_to_one_that_keeps_to_its_own() {
    let room = 64 * 8;
    assert!(northmost(0.0, room) < 8, "level ground: straight on");
    assert!(northmost(0.5, room) < 8, "half a metre is no other storey");
    assert!(northmost(1.5, room) > 30, "round a dip of 1.5 m");
    assert!(northmost(1.5, 1) < 8, "no memory for a second way");
}

/// The frontier cells of each cost class with the class's delay, with a cache of so many words.
fn costs(words: usize) -> vec::Vec<(u32, vec::Vec<Site>)> {
    let tiles = corridor();
    let storeys = storeys(&tiles);
    let disc = Footprint::new(0.3);
    let mut topology = Box::new(Skeleton::<64>::new());
    topology.reset(Space::KnownFree);
    while !topology.advance(&tiles, &disc, u32::MAX) {}
    let context = PlanningContext {
        topology: &topology,
        tiles: &tiles,
        disc: &disc,
        levels: Some(LevelCost {
            heights: &storeys,
            ground: &UnevenGround::TABLE_I,
            reference_m: 0.0,
        }),
    };
    let mut cache = vec![u32::MAX; words];
    let given_up = ResidualFrontiers::new();
    let cost = GoalCost::new(&context, &given_up, None, &mut cache).expect("it was published");
    let sites = |class| cost.sites(class).collect();
    let delays = cost.delays();
    delays.map(|(class, delay)| (delay, sites(class))).collect()
}

#[test]
fn costs_that_the_cache_has_no_room_for_are_the_same() {
    let all = costs(100);
    assert!(all.len() > 1, "{all:?}");
    assert!(all.is_sorted_by_key(|(delay, _)| *delay));
    let count: usize = all.iter().map(|(_, sites)| sites.len()).sum();
    assert!(count > 6, "more than a word holds: {count}");
    for words in 0..2 {
        assert_eq!(costs(words), all, "{words} words");
    }
}

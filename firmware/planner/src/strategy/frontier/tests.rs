//! The choice between two frontiers, in a corridor with one at each end, and the path to a frontier
//! across other height levels.

mod gain;

use core::f32::consts::FRAC_PI_2;
use std::boxed::Box;
use std::vec;

use crate::config::{LoopLimits, Order, Tuning, UnevenGround};
use crate::field::local_grid::LocalGrid;
use crate::geometry::{Cell, Point, Pose};
use crate::ground::elevation::tests::OwnedWindow;
use crate::map::{Class, Tiles};
use crate::path::blocked_passages::BlockedPassages;
use crate::path::height_levels::{HeightLevels, LevelCost};
use crate::path::utility::GoalOrder;
use crate::path::{PlanningContext, PlanningScratch, RoundOutcome};
use crate::roadmap::configuration_space::Footprint;
use crate::roadmap::skeleton::{Skeleton, Space};
use crate::status::ResidualReason;
use crate::strategy::frontier::Frontier;

/// Half the width of the corridor, cells.
const HALF: i32 = 8;
/// The ends of the corridor: the western one is nearer.
const ENDS: [i32; 2] = [-40, 60];

fn corridor() -> Box<Tiles<24, 64>> {
    let mut tiles = Box::<Tiles<24, 64>>::default();
    tiles.reset();
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

/// Measures the heights of the cells in rows `ys`, from windows around `middle` in all columns.
fn measured(
    tiles: &Tiles<24, 64>,
    middle: impl Iterator<Item = Cell>,
    ys: core::ops::Range<i32>,
    height_m: impl Fn(Cell) -> f32,
) -> Box<HeightLevels<24>> {
    let mut owned = OwnedWindow::new(Cell::default());
    let mut levels = Box::<HeightLevels<24>>::default();
    for middle in middle {
        let mut window = owned.write();
        window.follow(middle);
        for x in middle.x - 32..middle.x + 32 {
            for y in ys.clone() {
                let cell = Cell { x, y };
                window.measure(cell, height_m(cell));
            }
        }
        levels.note(&window.read(), tiles);
    }
    levels
}

/// Level ground, with a slope that leads down to the west from x = −10.
fn slope(tiles: &Tiles<24, 64>) -> Box<HeightLevels<24>> {
    let middles = (-40..=60).step_by(20).map(|x| Cell { x, y: 0 });
    measured(tiles, middles, -HALF..HALF + 1, |cell| {
        -0.03 * (-10 - cell.x).max(0) as f32
    })
}

/// Level ground, with a dip in the corridor.
fn dip(tiles: &Tiles<24, 64>, dip_m: f32) -> Box<HeightLevels<24>> {
    let middles = (0..=80).step_by(20).map(|x| Cell { x, y: 20 });
    measured(tiles, middles, -8..48, |Cell { x, y }| {
        let is_dip = (16..40).contains(&x) && y < 16;
        if is_dip { -dip_m } else { 0.0 }
    })
}

/// A map with its skeleton and heights, and a robot at x = y = 0.
struct Scene {
    tiles: Box<Tiles<24, 64>>,
    heights: Box<HeightLevels<24>>,
    skeleton: Box<Skeleton<64>>,
    footprint: Footprint,
    blocked: BlockedPassages,
    limits: LoopLimits,
    order: Order,
    yaw_rad: f32,
    came_through_blocked: bool,
    openings_were_tried: bool,
}

impl Scene {
    fn new(tiles: Box<Tiles<24, 64>>, heights: Box<HeightLevels<24>>) -> Self {
        let footprint = Footprint::new(0.3);
        let mut skeleton = Box::new(Skeleton::<64>::new());
        skeleton.reset(Space::KnownFree);
        while !skeleton.advance(&tiles, &footprint, &mut [0; 64 * 8], u32::MAX) {}
        Self {
            tiles,
            heights,
            skeleton,
            footprint,
            blocked: BlockedPassages::new(),
            limits: LoopLimits::default(),
            order: Order::ALL,
            yaw_rad: 0.0,
            came_through_blocked: false,
            openings_were_tried: false,
        }
    }

    /// The inputs of a round from a reference height; without height levels for `None`.
    fn context(&mut self, reference_m: Option<f32>) -> PlanningContext<'_, 24, 64> {
        let skeleton = &mut self.skeleton;
        PlanningContext {
            blocked: &self.blocked,
            pose: Pose {
                x_m: 0.05,
                y_m: 0.05,
                yaw_rad: self.yaw_rad,
                ..Pose::default()
            },
            order: GoalOrder::new(self.order, &Tuning::DEFAULT.order),
            levels: reference_m.map(|reference_m| LevelCost {
                heights: &self.heights,
                ground: &UnevenGround::TABLE_I,
                reference_m,
            }),
            came_through_blocked: self.came_through_blocked,
            openings_were_tried: self.openings_were_tried,
            ..PlanningContext::on(skeleton, &self.tiles, &self.footprint, &self.limits)
        }
    }

    /// Plans a round, with memory for so many pairs behind the wave.
    fn replan(&mut self, frontier: &mut Frontier, reference_m: Option<f32>, pairs: usize) {
        let context = self.context(reference_m);
        let words = context.skeleton.tiling().words();
        let (mut residues, mut queue) = (vec![[0; 2]; words + pairs], vec![0; 1024]);
        let scratch = PlanningScratch {
            residues: &mut residues,
            queue: &mut queue,
            local_grid: &mut LocalGrid::new(),
        };
        let outcome = frontier.replan(&context, scratch);
        let has_path = !frontier.path().is_empty();
        assert_eq!(outcome == RoundOutcome::Path, has_path);
    }
}

/// A corridor that is planned by gain, for a robot with this heading.
fn by_gain(worth: f32, yaw_rad: f32) -> Scene {
    let tiles = corridor();
    let heights = slope(&tiles);
    Scene {
        order: Order::Gain { worth },
        yaw_rad,
        ..Scene::new(tiles, heights)
    }
}

/// The x of the goal after a round.
fn next(scene: &mut Scene, frontier: &mut Frontier, reference_m: Option<f32>) -> i32 {
    scene.replan(frontier, reference_m, 64 * 8);
    frontier.path().goal().x
}

#[test]
fn a_robot_that_only_looks_goes_on_once_it_has_moved() {
    let mut scene = by_gain(0.0, 0.0);
    let mut frontier = Frontier::new();
    frontier.only_look();
    scene.replan(&mut frontier, None, 64 * 8);
    assert!(frontier.path().is_empty(), "it stands");
    let aside = Point { x_m: 2.0, y_m: 0.0 };
    frontier.progress.note_motion(aside, 1_000);
    assert!(is_at(next(&mut scene, &mut frontier, None), ENDS[1]));
}

#[test]
fn a_robot_waits_from_a_second_look_until_there_is_a_path() {
    let mut scene = by_gain(0.0, 0.0);
    let mut frontier = Frontier::new();
    assert!(!frontier.is_waiting());
    frontier.look_again();
    assert!(frontier.is_waiting());
    scene.replan(&mut frontier, None, 64 * 8);
    assert!(!frontier.path().is_empty() && !frontier.is_waiting());
    frontier.look_again();
    frontier.go_on();
    assert!(!frontier.is_waiting(), "a patrol does not wait");
}

/// What the ends of the corridor show is worth 0.25 m²/m, and not 100 m²/m.
#[test]
fn an_opening_is_worth_any_trip_until_it_was_tried() {
    for (worth, were_tried, goes) in [
        (100.0, false, true),
        (100.0, true, false),
        (0.25, true, true),
    ] {
        let mut scene = by_gain(worth, 0.0);
        scene.openings_were_tried = were_tried;
        let mut frontier = Frontier::new();
        scene.replan(&mut frontier, None, 64 * 8);
        assert_eq!(!frontier.path().is_empty(), goes, "{worth}, {were_tried}");
    }
}

/// The passage is 0.6 m to the east of the robot.
#[test]
fn no_path_begins_behind_a_blocked_passage() {
    let [west, east] = ENDS;
    let mut scene = by_gain(0.0, 0.0);
    let mut frontier = Frontier::new();
    assert!(is_at(next(&mut scene, &mut frontier, None), east));
    (0..2).for_each(|k| frontier.blocked.block(Cell { x: 6, y: 4 * k - 2 }));
    frontier.path.clear();
    scene.blocked = frontier.blocked.clone();
    frontier.cut(&mut scene.skeleton);
    let goal = next(&mut scene, &mut frontier, None);
    assert!(is_at(goal, west), "{goal}");
}

/// Both ends of the corridor are cut off.
#[test]
fn without_a_path_the_robot_goes_back_through_what_it_came_through_before_it_tries_all_again() {
    let mut scene = by_gain(0.0, 0.0);
    let mut frontier = Frontier::new();
    for (x, y) in [6, -6].into_iter().flat_map(|x| [-2, 2].map(|y| (x, y))) {
        frontier.blocked.block(Cell { x, y });
    }
    scene.blocked = frontier.blocked.clone();
    frontier.cut(&mut scene.skeleton);
    scene.came_through_blocked = true;
    scene.replan(&mut frontier, None, 64 * 8);
    assert!(frontier.goes_back() && !frontier.has_second_chance());
    scene.came_through_blocked = false;
    scene.replan(&mut frontier, None, 64 * 8);
    assert!(!frontier.goes_back() && frontier.has_second_chance());
}

fn is_at(goal: i32, end: i32) -> bool {
    (goal - end).abs() <= 3
}

/// The x of the goals that the robot takes one after the other, at these reference heights.
fn goals<const N: usize>(references_m: [Option<f32>; N]) -> [i32; N] {
    let tiles = corridor();
    let heights = slope(&tiles);
    let mut scene = Scene {
        // Both ends are to one side.
        yaw_rad: FRAC_PI_2,
        ..Scene::new(tiles, heights)
    };
    let mut frontier = Frontier::new();
    references_m.map(|reference_m| {
        scene.replan(&mut frontier, reference_m, 64 * 8);
        frontier.path().goal().x
    })
}

#[test]
fn the_nearer_goal_waits_if_it_lies_on_another_level() {
    let [west, east] = ENDS;
    let goes_to = |reference_m, end: i32| (goals([reference_m])[0] - end).abs() <= 3;
    assert!(goes_to(None, west), "nearest first");
    assert!(goes_to(Some(0.0), east), "0.9 m lower counts as 40 m");
    assert!(goes_to(Some(-0.9), west), "it is on the robot's level");
    assert!(goes_to(Some(-0.45), west), "as far off as the other one");
}

#[test]
fn a_goal_is_not_left_for_the_levels_on_the_way_to_it() {
    let [west, east] = ENDS;
    let all_near = |goals: [i32; 3], end: i32| goals.iter().all(|goal| (goal - end).abs() <= 3);
    // Without the present goal's reference, the second height's goal would be the other one.
    let from_above = goals([0.0, -0.45, 0.0].map(Some));
    assert!(all_near(from_above, east), "{from_above:?}");
    let from_below = goals([-0.9, 0.0, 0.0].map(Some));
    assert!(all_near(from_below, west), "{from_below:?}");
}

/// A corridor to the east, closed in the west, and a way round from x = 4 to 60 cells, 4 m to the
/// north.
fn corridor_with_a_way_round() -> Box<Tiles<24, 64>> {
    let mut tiles = Box::<Tiles<24, 64>>::default();
    tiles.reset();
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

/// How far north the path to the frontier in the east leads, cells, with memory for so many pairs
/// behind the wave.
fn northmost(dip_m: f32, pairs: usize) -> i32 {
    let tiles = corridor_with_a_way_round();
    let heights = dip(&tiles, dip_m);
    let mut frontier = Frontier::new();
    Scene::new(tiles, heights).replan(&mut frontier, Some(0.0), pairs);
    assert!(frontier.path().goal().x >= 76, "the only frontier");
    let cells = frontier.path().cells().iter();
    cells.map(|cell| cell.y).max().expect("a path")
}

#[test]
fn a_path_across_other_levels_gives_way_to_one_on_the_goals() {
    let room = 64 * 8;
    assert!(northmost(0.0, room) < 8, "level ground: straight on");
    assert!(northmost(0.5, room) < 8, "0.5 m is no other level");
    assert!(northmost(1.5, room) > 30, "round a dip of 1.5 m");
    assert!(northmost(1.5, 1) < 8, "no memory for a second way");
}

//! Corrections of small maps, drawn: `.` free, `#` wall, blank unknown; least y first.

use std::boxed::Box;
use std::string::String;
use std::vec::Vec;

use super::*;
use crate::config::ConfigBuilder;
use crate::geometry::{Cell, Pose, Twist};
use crate::grid::Class;
use crate::input::Input;
use crate::planner::{Output, step};
use crate::robot::{LaserMount, RobotShape};
use crate::status::{ResidualReason, Status};

type Small = State<16, 64>;

/// A planner and its memory.
struct Bench {
    config: Config,
    state: Box<Small>,
    workspace: Box<Workspace>,
}

/// Two rooms: one in tile (0, 0), one in tile (1, 0).
const ROOMS: [&str; 4] = [
    "#######   #######",
    "#.....#   #.....#",
    "#.....#   #.....#",
    "#######   #######",
];
/// The room of tile (0, 0) three cells to the right.
const MOVED: [&str; 4] = [
    "   #######   ",
    "   #.....#   ",
    "   #.....#   ",
    "   #######   ",
];
/// Column of the first sign of [`ROOMS`], and row.
const AT: Cell = Cell { x: 22, y: 8 };

fn class_of(sign: char) -> Class {
    match sign {
        '.' => Class::Free,
        '#' => Class::Obstacle,
        _ => Class::Unknown,
    }
}

fn builder() -> ConfigBuilder {
    Config::builder(RobotShape::PIONEER_3AT).laser(LaserMount::level(0.10, 0.40))
}

impl Bench {
    fn new(config: Config) -> Self {
        let mut state = Box::new(Small::new());
        state.reset(&config);
        Self {
            config,
            state,
            workspace: Box::new(Workspace::new()),
        }
    }

    /// A planner that knows the two rooms.
    fn with_rooms() -> Self {
        let mut bench = Self::new(builder().build().expect("valid"));
        for tile in [0, 1] {
            let planes = planes(ROOMS, AT.x - 32 * tile);
            bench.state.map.replace((tile, 0), &planes, false);
        }
        bench
    }

    fn begin(&mut self, epoch: u16, tiles: u16) -> Result<CorrectionProgress, CorrectionError> {
        self.state.begin_correction(&Correction {
            epoch,
            x_m: 1.0,
            tiles,
            ..Correction::default()
        })
    }

    fn tile(&mut self, tile: &CorrectedTile) -> Result<(), CorrectionError> {
        self.state.correct_tile(&mut self.workspace, tile)
    }

    fn finish(&mut self) -> CorrectionProgress {
        let Self {
            config,
            state,
            workspace,
        } = self;
        state.finish_correction(config, workspace)
    }

    fn step(&mut self, time_ms: u32) -> Output {
        let ranges_mm = [2_000; 181];
        let input = Input {
            time_ms,
            pose: Pose::default(),
            velocity: Twist::default(),
            scans: [&ranges_mm, &[]],
        };
        let Self {
            config,
            state,
            workspace,
        } = self;
        step(config, state, workspace, input, &mut ())
    }

    fn drawn(&self, columns: i32) -> Vec<String> {
        let sign = |cell: Cell| match self.state.map.class(cell) {
            Class::Free => '.',
            Class::Obstacle | Class::Negative => '#',
            Class::Unknown => ' ',
        };
        let row = |y: i32| (0..columns).map(|x| sign(AT.offset(x, y))).collect();
        (0..4).map(row).collect()
    }
}

/// Returns a tile of a picture that begins in this column.
fn planes(picture: [&str; 4], column: i32) -> [[u32; 32]; 2] {
    let mut planes = [[0; 32]; 2];
    for (y, row) in (AT.y as usize..).zip(picture) {
        for (x, sign) in (column..)
            .zip(row.chars())
            .filter(|(x, _)| (0..32).contains(x))
        {
            let class = class_of(sign) as u32;
            planes[0][y] |= (class & 1) << x;
            planes[1][y] |= (class >> 1) << x;
        }
    }
    planes
}

/// Returns the last cell of the block of 2 × 2 cells that holds a cell.
fn block(cell: Cell) -> Cell {
    Cell {
        x: cell.x | 1,
        y: cell.y | 1,
    }
}

/// Tile (0, 0) with the room of [`MOVED`], and its shift.
fn moved() -> CorrectedTile {
    CorrectedTile {
        tile: (0, 0),
        shift: (3, 1),
        planes: planes(MOVED, AT.x),
        trail: [0; 16],
    }
}

#[test]
fn a_tile_is_replaced_and_its_marks_go_with_it() {
    let mut bench = Bench::with_rooms();
    let [here, beside] = [AT.offset(1, 1), AT.offset(12, 1)];
    let (given_up, _) = bench.state.strategy.frontier.given_up_mut();
    given_up.give_up(here, ResidualReason::NoProgress);
    given_up.give_up(beside, ResidualReason::Unreachable);
    for cell in [here, beside] {
        bench.state.map.mark_trail(cell);
    }
    bench.begin(1, 1).expect("it is the first one");
    bench.tile(&moved()).expect("it is open");
    assert_eq!(bench.state.frontiers()[0].cell, here, "not before the end");
    assert!(bench.finish().closed);

    // The picture of tile (0, 0) ends with its last column, and tile (1, 0) is as it was.
    let expected = [
        "   #######  #####",
        "   #.....#  ....#",
        "   #.....#  ....#",
        "   #######  #####",
    ];
    let drawn = bench.drawn(17);
    for (drawn, expected) in drawn.iter().zip(expected) {
        assert_eq!(drawn[..10], expected[..10]);
        assert_eq!(drawn[12..], expected[12..]);
    }
    let cells: Vec<Cell> = bench.state.frontiers().iter().map(|it| it.cell).collect();
    assert_eq!(cells, [here.offset(3, 1), beside]);
    let trail = |tile| bench.state.map.trail(tile).collect::<Vec<Cell>>();
    assert_eq!(trail((0, 0)), [block(here.offset(3, 1))]);
    assert_eq!(trail((1, 0)), [block(beside)]);
}

#[test]
fn the_pose_goes_by_the_motion_and_odometry_stays() {
    let mut bench = Bench::with_rooms();
    bench.step(0);
    let odom = bench.state.localiser.odom();
    bench
        .state
        .begin_correction(&Correction {
            epoch: 7,
            x_m: 1.0,
            y_m: -2.0,
            yaw_rad: 0.5,
            tiles: 0,
        })
        .expect("it is the first one");
    assert_eq!(bench.state.location().pose.0, Pose::default());
    assert_eq!(bench.state.map_epoch(), 0);
    bench.finish();
    let pose = bench.state.location().pose.0;
    assert_eq!([pose.x_m, pose.y_m, pose.yaw_rad], [1.0, -2.0, 0.5]);
    assert_eq!(bench.state.localiser.odom(), odom);
    assert_eq!(bench.state.map_epoch(), 7);
}

#[test]
fn the_robot_stands_and_enters_nothing_while_a_correction_is_open() {
    let mut bench = Bench::with_rooms();
    bench.begin(1, 1).expect("it is the first one");
    let edits = bench.state.map.tiles().edits();
    for k in 0..20 {
        let output = bench.step(200 * k);
        assert_eq!(output.velocity, Twist::default());
        assert_eq!(output.status, Status::Exploring);
    }
    assert_eq!(bench.state.map.tiles().edits(), edits);
    bench.tile(&moved()).expect("it is open");
    bench.finish();
    // The scan is entered again, and within half a second the robot may move.
    let moves =
        |bench: &mut Bench, k: u32| bench.step(4_000 + 200 * k).velocity != Twist::default();
    assert!((0..3).any(|k| moves(&mut bench, k)));
    assert_ne!(bench.state.map.tiles().edits(), edits);
}

#[test]
fn a_correction_begins_ends_and_is_answered_once() {
    let mut bench = Bench::with_rooms();
    let progress = |next: u16, closed: bool| CorrectionProgress {
        epoch: 5,
        next,
        closed,
    };
    assert_eq!(bench.begin(5, 2), Ok(progress(0, false)));
    bench.tile(&moved()).expect("it is open");
    assert_eq!(bench.begin(5, 2), Ok(progress(1, false)), "again");
    assert_eq!(bench.finish(), progress(1, false), "a tile is missing");
    bench
        .tile(&CorrectedTile::default())
        .expect("the second one");
    assert_eq!(
        bench.tile(&moved()),
        Err(CorrectionError::NotOpen),
        "a third"
    );
    for _ in 0..2 {
        assert_eq!(bench.finish(), progress(2, true));
        assert_eq!(bench.state.correction_progress(5), Ok(progress(2, true)));
    }
    assert_eq!(bench.begin(5, 2), Ok(progress(2, true)), "late");
    for epoch in [0, 4] {
        assert_eq!(bench.begin(epoch, 0), Err(CorrectionError::NotOpen));
    }
    assert_eq!(
        bench.state.correction_progress(6),
        Err(CorrectionError::NotOpen)
    );
    assert_eq!(bench.state.location().pose.0.x_m, 1.0, "moved once");
}

#[test]
fn of_an_abandoned_correction_only_its_tiles_stay() {
    let mut bench = Bench::with_rooms();
    bench.begin(1, 2).expect("it is the first one");
    bench.tile(&moved()).expect("it is open");
    bench.begin(2, 0).expect("it is newer");
    assert!(bench.finish().closed);
    assert_eq!(bench.state.location().pose.0.x_m, 1.0, "moved once");
    assert_eq!(bench.drawn(10)[0], MOVED[0][..10]);
}

#[test]
fn a_correction_that_cannot_be_is_refused_and_changes_nothing() {
    let mut bench = Bench::with_rooms();
    assert_eq!(bench.begin(1, 513), Err(CorrectionError::Unusable));
    for [x_m, y_m, yaw_rad] in [
        [10_001.0, 0.0, 0.0],
        [0.0, -10_001.0, 0.0],
        [f32::NAN, 0.0, 0.0],
        [0.0, 0.0, f32::NAN],
    ] {
        let correction = Correction {
            epoch: 1,
            x_m,
            y_m,
            yaw_rad,
            tiles: 0,
        };
        let refused = bench.state.begin_correction(&correction);
        assert_eq!(refused, Err(CorrectionError::Unusable), "{correction:?}");
    }
    assert_eq!(
        bench.finish(),
        CorrectionProgress {
            epoch: 0,
            next: 0,
            closed: true
        }
    );
    assert_eq!(bench.tile(&moved()), Err(CorrectionError::NotOpen));
    assert_eq!(bench.drawn(17), ROOMS);
}

#[test]
fn a_session_begins_without_a_correction() {
    let mut bench = Bench::with_rooms();
    bench.begin(9, 1).expect("it is the first one");
    let config = bench.config.clone();
    bench.state.reset(&config);
    assert_eq!(bench.state.map_epoch(), 0);
    assert_eq!(bench.tile(&moved()), Err(CorrectionError::NotOpen));
    assert!(bench.begin(1, 0).is_ok());
}

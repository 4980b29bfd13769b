//! Scenes: each rule of a loop as a picture.
//!
//! A character is a coarse cell, row 0 (the least y) on top: `#` obstacle, `.` free, `?` never measured, `T` the tractor
//! point, and the robot with its heading `>`, `<`, `v` (towards greater y) or `^`. In what comes back, `b` and `f` are the loop road's back and
//! front, `=` the shield, `+` other centre cells. The robot is a point, so it fits wherever there is no obstacle.

use core::f32::consts::{FRAC_PI_2, PI};
use std::string::String;
use std::vec::Vec;

use super::Round;
use super::detour::Limits;
use super::ground::Ground;
use super::loop_road::{LoopRoad, build_shield};
use super::shield::{Flaw, Shield};
use crate::clearance::Disc;
use crate::geometry::{Cell, Pose};
use crate::grid::Site;
use crate::map::{Class, Tiles};
use crate::skeleton::Residues;
use crate::skeleton::branches::surroundings;
use crate::strategy::frontier::Lent;
use crate::topology::{Space, Topology};
use crate::view::View;

pub(super) const TILES: usize = 30;
pub(super) const SLOTS: usize = 48;
/// Radius of a robot that is a point.
pub(super) const POINT_M: f32 = 0.05;

/// The map, skeleton and robot of a picture.
pub(super) struct Scene {
    picture: Vec<Vec<char>>,
    pub(super) tiles: Tiles<TILES, SLOTS>,
    pub(super) topology: Topology<SLOTS>,
    pub(super) disc: Disc,
    pub(super) pose: Pose,
    limits: Limits,
}

/// The coarse cell at a column and row of the picture.
pub(super) fn at(x: usize, y: usize) -> Cell {
    Cell {
        x: 2 * x as i32,
        y: 2 * y as i32,
    }
}

/// A pose in the middle of a coarse cell.
pub(super) fn pose_in(cell: Cell, yaw_rad: f32) -> Pose {
    let middle = Cell {
        x: cell.x + 1,
        y: cell.y + 1,
    }
    .corner();
    Pose {
        x_m: middle.x_m,
        y_m: middle.y_m,
        yaw_rad,
        ..Pose::default()
    }
}

/// The cell so many cells behind a robot.
fn behind(pose: &Pose, cells: i32) -> Cell {
    let (sin, cos) = crate::math::sin_cos(pose.yaw_rad);
    let back = |at: i32, along: f32| at - (along * cells as f32) as i32;
    let here = pose.point().cell();
    Cell {
        x: back(here.x, cos),
        y: back(here.y, sin),
    }
}

/// Memory of a wave.
pub(super) struct Memory {
    residues: Vec<[u32; 2]>,
    ring: Vec<u32>,
    view: View,
}

impl Memory {
    pub(super) fn new() -> Self {
        Self {
            residues: std::vec![[0; 2]; SLOTS * 8],
            ring: std::vec![0; 256],
            view: View::new(),
        }
    }

    pub(super) fn lend(&mut self) -> Lent<'_> {
        Lent {
            residues: &mut self.residues,
            ring: &mut self.ring,
            view: &mut self.view,
        }
    }
}

impl Scene {
    pub(super) fn parse(picture: &str) -> Self {
        let picture: Vec<Vec<char>> = picture
            .split_whitespace()
            .map(|row| row.chars().collect())
            .collect();
        let mut tiles = Tiles::new();
        tiles.reset(8, 6);
        let mut pose = Pose::default();
        for (y, row) in picture.iter().enumerate() {
            for (x, &character) in row.iter().enumerate() {
                let yaw_rad = match character {
                    '>' => 0.0,
                    'v' => FRAC_PI_2,
                    '<' => PI,
                    '^' => -FRAC_PI_2,
                    _ => f32::NAN,
                };
                if !yaw_rad.is_nan() {
                    pose = pose_in(at(x, y), yaw_rad);
                }
                let class = match character {
                    '#' => Class::Obstacle,
                    '?' => continue,
                    _ => Class::Free,
                };
                for part in super::ground::quarters(at(x, y)) {
                    tiles.set(part, class).unwrap();
                }
            }
        }
        let disc = Disc::new(POINT_M);
        let mut topology = Topology::new();
        topology.reset(Space::NotObstacle { anchored: true });
        while !topology.advance(&tiles, &disc, u32::MAX) {}
        Self {
            picture,
            tiles,
            topology,
            disc,
            pose,
            limits: Limits::default(),
        }
    }

    fn find(&self, character: char) -> Option<Cell> {
        let rows = self.picture.iter().enumerate();
        rows.flat_map(|(y, row)| row.iter().enumerate().map(move |(x, c)| (x, y, *c)))
            .find(|(.., c)| *c == character)
            .map(|(x, y, _)| at(x, y))
    }

    pub(super) fn round(&mut self) -> Round<'_, TILES, SLOTS> {
        Round {
            topology: &mut self.topology,
            tiles: &self.tiles,
            disc: &self.disc,
            pose: self.pose,
            time_ms: 0,
            limits: &self.limits,
        }
    }

    pub(super) fn ground(&self) -> Ground<'_, TILES, SLOTS> {
        Ground {
            tiles: &self.tiles,
            disc: &self.disc,
            frame: self.topology.frame(),
            way: self.topology.skeleton().unwrap(),
        }
    }

    /// The loop road to the tractor point, the cells of its back and front, and the shield across it.
    fn look(&mut self, previous: Option<&Shield>) -> Option<Found> {
        let tractor = self.find('T').unwrap();
        let pose = self.pose;
        let mut memory = Memory::new();
        let mut round = self.round();
        let robot = round
            .nearest(pose.point().cell(), &mut memory.lend())
            .unwrap();
        let goal = round.nearest(tractor, &mut memory.lend()).unwrap();
        round
            .propagate(goal, surroundings(robot), None, &mut memory.lend())
            .unwrap();
        let ground = self.ground();
        let residues = Residues::new(ground.frame.shape, &mut memory.residues).unwrap();
        let came = behind(&pose, 10);
        let road = LoopRoad::find(&ground, &residues, (robot, came))?;
        let walk = |head: Site| -> Vec<Cell> {
            let sites = core::iter::once(head).chain(residues.descent(head));
            sites.map(|site| ground.frame.cell(site)).collect()
        };
        assert_eq!(walk(road.back).len() + 1, road.back_steps as usize);
        assert_eq!(walk(road.front).len() + 1, road.front_steps as usize);
        Some(Found {
            back: walk(road.back),
            front: walk(road.front),
            shield: build_shield(&ground, road.back(&residues), pose.point().cell()),
        })
    }

    /// The picture of what [`Self::look`] finds.
    fn drawn(&mut self, previous: Option<&Shield>) -> String {
        let found = self.look(previous);
        let ground = self.ground();
        let mark = |cell: Cell, seen: char| {
            let on = |cells: &[Cell]| cells.contains(&cell);
            if !matches!(seen, '.' | '?') {
                return seen;
            }
            match &found {
                Some(found) if found.shield.is_some_and(|shield| shield.holds(cell)) => '=',
                Some(found) if on(&found.back) => 'b',
                Some(found) if on(&found.front) => 'f',
                _ if ground.is_centre(cell) => '+',
                _ => seen,
            }
        };
        let rows = self.picture.iter().enumerate().map(|(y, row)| {
            let cells = row.iter().enumerate();
            cells.map(|(x, &seen)| mark(at(x, y), seen)).collect()
        });
        rows.collect::<Vec<String>>().join("\n")
    }
}

/// What a look finds.
struct Found {
    back: Vec<Cell>,
    front: Vec<Cell>,
    shield: Option<Shield>,
}

#[track_caller]
fn assert_picture(drawn: &str, expected: &str) {
    let expected: Vec<&str> = expected.split_whitespace().collect();
    assert!(drawn == expected.join("\n"), "\n{drawn}\n");
}

const RING: &str = "
    #########################
    #.......................#
    #.......................#
    #....T.......>..........#
    #.......................#
    #.......................#
    #.....#############.....#
    #.....#############.....#
    #.....#############.....#
    #.......................#
    #.......................#
    #.......................#
    #.......................#
    #.......................#
    #########################";

const NO_LOOP: &str = "
    #########################
    #.......................#
    #.......................#
    #....T.......>..........#
    #.......................#
    #.......................#
    #.....#############.....#
    #.....#############.....#
    #.....#############.....#
    #.......................#
    #........###............#
    #........###............#
    #........###............#
    #........###............#
    #########################";

const UNKNOWN_LOOP: &str = "
    ###############??????????
    #.............?.........?
    #.............?.........?
    #....T.......>..........?
    #.......................?
    #.......................?
    #.....########??????????
    #.....#??????????????????
    #.....#??????????????????
    ???.??????????????????????
    ?????????????????????????";

const OPEN_END: &str = "
    ################...............
    ...............................
    ...............................
    ......T......>.................
    ...............................
    ...............................
    ...............................
    ...............................
    ...............................
    ...............................
    ...............................
    ...............................
    ...............................
    ...............................
    ...............................
    ...............................
    ...............................
    ...............................
    ....#####......................
    ....#####......................
    ....#####......................
    ...............................
    ...............................
    ...............................
    ...............................
    ...............................
    ...............................
    ...............................
    ...............................
    ...............................
    ...............................
    ...............................
    ...............................
    ...............................
    ###############################";

const UNEXPLORED_END: &str = "
    #########################
    #.......................#
    #.......................#
    #....T.......>..........#
    #.......................#
    #?????????..............#
    #?????????????????......#
    #.....#############.....#
    #.....#############.....#
    #.....#############.....#
    #.......................#
    #.......................#
    #.......................#
    #.......................#
    #.......................#
    #########################";

const FORK: &str = "
    ###########################
    #.........................#
    #.........................#
    #.....................#...#
    #...#####............##...#
    #...#####...........###...#
    #..T......>.........###...#
    #...................###...#
    #...####............###...#
    #...####.............##...#
    #.........................#
    #.........................#
    #.........................#
    ###########################";

const TWO_LOOPS: &str = "
    ###################################
    #.................................#
    #.................................#
    #....T.......>....................#
    #.................................#
    #.................................#
    #.....########.....#########......#
    #.....########.....#########......#
    #.....########.....#########......#
    #.................................#
    #.................................#
    #.................................#
    #.................................#
    #.................................#
    ###################################";

#[test]
fn pictures() {
    for picture in [
        RING,
        NO_LOOP,
        UNKNOWN_LOOP,
        OPEN_END,
        UNEXPLORED_END,
        FORK,
        TWO_LOOPS,
    ] {
        std::println!("{}\n", Scene::parse(picture).drawn(None));
    }
}

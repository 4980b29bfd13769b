//! Scenes: each rule of a loop as a picture.
//!
//! A character is a coarse cell, row 0 (the least y) on top: `#` obstacle, `.` free, `?` never
//! measured, `T` the tractor point, and the robot with its heading `>`, `<`, `v` (towards greater
//! y) or `^`. In a result, `b` and `f` are the loop road's back and front, `=` the shield, `+`
//! other centre cells. The robot is a point, so it fits wherever there is no obstacle.

mod loop_roads;
mod revisits;
mod walls;

use core::f32::consts::{FRAC_PI_2, PI};
use std::string::String;
use std::vec::Vec;

use crate::config::{LoopLimits, OuroborosTuning};
use crate::field::local_grid::LocalGrid;
use crate::geometry::{Cell, Pose};
use crate::grid::Site;
use crate::map::{Class, Tiles};
use crate::path::blocked_passages::NONE;
use crate::path::nearest::Centres;
use crate::path::{PlanningContext, PlanningScratch};
use crate::roadmap::Residues;
use crate::roadmap::branches::surroundings;
use crate::roadmap::configuration_space::Footprint;
use crate::roadmap::skeleton::{Skeleton, Space};
use crate::strategy::ouroboros::closing::spread_ahead_of;
use crate::strategy::ouroboros::loop_road::{LoopRoad, back_to_shield, build_shield};
use crate::strategy::ouroboros::shield::{Flaw, Shield};

pub(super) const TILES: usize = 30;
pub(super) const SLOTS: usize = 48;
/// The defaults.
pub(super) const TUNING: OuroborosTuning = OuroborosTuning::DEFAULT;
/// Radius of a robot that is a point.
pub(super) const POINT_M: f32 = 0.05;

/// The map, skeleton and robot of a picture.
pub(super) struct Scene {
    picture: Vec<Vec<char>>,
    pub(super) tiles: Tiles<TILES, SLOTS>,
    pub(super) skeleton: Skeleton<SLOTS>,
    pub(super) footprint: Footprint,
    pub(super) pose: Pose,
    limits: LoopLimits,
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
    let middle = cell.offset(1, 1).corner();
    Pose {
        x_m: middle.x_m,
        y_m: middle.y_m,
        yaw_rad,
        ..Pose::default()
    }
}

/// Returns true if a cell is on the shield.
pub(super) fn has_cell(shield: &Shield, cell: Cell) -> bool {
    shield.cells().any(|on| on == cell)
}

/// The cell this many cells behind a robot.
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
    queue: Vec<u32>,
    local_grid: LocalGrid,
}

impl Memory {
    pub(super) fn new() -> Self {
        Self {
            residues: std::vec![[0; 2]; SLOTS * 8],
            queue: std::vec![0; 2048],
            local_grid: LocalGrid::new(),
        }
    }

    pub(super) fn lend(&mut self) -> PlanningScratch<'_> {
        PlanningScratch {
            residues: &mut self.residues,
            queue: &mut self.queue,
            local_grid: &mut self.local_grid,
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
        tiles.reset();
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
                for part in at(x, y).quarters() {
                    tiles.set(part, class).unwrap();
                }
            }
        }
        let footprint = Footprint::new(POINT_M);
        let mut skeleton = Skeleton::new();
        skeleton.reset(Space::NotObstacle);
        while !skeleton.advance(&tiles, &footprint, &mut [0; SLOTS * 8], u32::MAX) {}
        Self {
            picture,
            tiles,
            skeleton,
            footprint,
            pose,
            limits: LoopLimits::default(),
        }
    }

    fn find(&self, character: char) -> Option<Cell> {
        let rows = self.picture.iter().enumerate();
        rows.flat_map(|(y, row)| row.iter().enumerate().map(move |(x, c)| (x, y, *c)))
            .find(|(.., c)| *c == character)
            .map(|(x, y, _)| at(x, y))
    }

    pub(super) fn round(&mut self) -> PlanningContext<'_, TILES, SLOTS> {
        let (skeleton, tiles) = (&mut self.skeleton, &self.tiles);
        PlanningContext {
            pose: self.pose,
            ..PlanningContext::on(skeleton, tiles, &self.footprint, &self.limits)
        }
    }

    pub(super) fn centres(&self) -> Centres<'_, TILES, SLOTS> {
        Centres::of(&self.skeleton, &self.tiles, &self.footprint, &NONE).unwrap()
    }

    /// Looks for the loop road to the tractor point and for the shield across it.
    fn look(&mut self) -> Option<Found> {
        let mut memory = Memory::new();
        let robot = self.spread(self.find('T').unwrap(), &mut memory);
        let (centres, pose) = (self.centres(), self.pose);
        let residues = Residues::new(centres.cells.tiling(), &mut memory.residues).unwrap();
        let road = LoopRoad::find(&centres, &residues, (robot, behind(&pose, 10)))?;
        let walk = |head: Site| -> Vec<Cell> {
            let sites = core::iter::once(head).chain(residues.descent(head));
            sites.map(|site| centres.frame.cell(site)).collect()
        };
        assert_eq!(walk(road.back).len() + 1, road.back_steps as usize);
        assert_eq!(walk(road.front).len() + 1, road.front_steps as usize);
        let until_meet = |cells: Vec<Cell>| -> Vec<Cell> {
            let tail = cells.len() - road.tail_steps as usize;
            assert_eq!(cells[tail - 1], centres.frame.cell(road.meet));
            cells[..tail].to_vec()
        };
        Some(Found {
            back: until_meet(walk(road.back)),
            front: until_meet(walk(road.front)),
            shield: build_shield(&centres, road.back(&residues), pose.point().cell(), &TUNING),
        })
    }

    /// Spreads a wave from the centre cell nearest to a place, with the robot's surroundings as a
    /// blocker; returns the robot's centre cell.
    fn spread(&mut self, from: Cell, memory: &mut Memory) -> Site {
        let here = self.pose.point().cell();
        let mut round = self.round();
        let robot = round.nearest(here, &mut memory.lend()).unwrap();
        let goal = round.nearest(from, &mut memory.lend()).unwrap();
        let scratch = &mut memory.lend();
        round
            .propagate(goal, surroundings(robot), None, scratch)
            .unwrap();
        robot
    }

    /// Looks for the back to the previous shield and for the next one across it.
    fn back_to(&mut self, previous: Shield) -> Found {
        let mut memory = Memory::new();
        let here = self.pose.point().cell();
        let mut round = self.round();
        let robot = round.nearest(here, &mut memory.lend()).unwrap();
        spread_ahead_of(previous, &mut round, &mut memory.lend(), robot).unwrap();
        let centres = self.centres();
        let residues = Residues::new(centres.cells.tiling(), &mut memory.residues).unwrap();
        let back: Vec<Site> = back_to_shield(&centres, &residues, robot)
            .unwrap()
            .collect();
        Found {
            shield: build_shield(&centres, back.iter().copied(), here, &TUNING),
            back: back.iter().map(|site| centres.frame.cell(*site)).collect(),
            front: Vec::new(),
        }
    }

    /// The flaws of a shield at each cell of the back, from the robot on, up to the valid one.
    fn flaws(&mut self) -> Vec<Option<Flaw>> {
        let back = self.look().unwrap().back;
        let (centres, here) = (self.centres(), self.pose.point().cell());
        let judge = |span: &[Cell]| {
            Shield::build(&centres, span[2], [span[4], span[0]], here, &TUNING).err()
        };
        let mut flaws: Vec<_> = back.windows(5).map(judge).collect();
        let valid = flaws.iter().position(Option::is_none);
        flaws.truncate(valid.map_or(flaws.len(), |valid| valid + 1));
        flaws.dedup();
        flaws
    }

    /// The picture of what [`Self::look`] finds.
    fn drawn(&mut self) -> String {
        let found = self.look();
        self.picture_of(found.as_ref())
    }

    fn picture_of(&self, found: Option<&Found>) -> String {
        let centres = self.centres();
        let mark = |cell: Cell, seen: char| {
            let on = |cells: &[Cell]| cells.contains(&cell);
            if !matches!(seen, '.' | '?') {
                return seen;
            }
            match found {
                Some(found) if found.shield.is_some_and(|shield| has_cell(&shield, cell)) => '=',
                Some(found) if on(&found.back) => 'b',
                Some(found) if on(&found.front) => 'f',
                _ if centres.is_centre(cell) => '+',
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

/// The arms of a loop road up to where they meet, and the shield.
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

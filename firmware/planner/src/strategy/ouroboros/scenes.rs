//! Scenes: each rule of a loop as a picture.
//!
//! A character is a coarse cell, row 0 (the least y) on top: `#` obstacle, `.` free, `?` never measured, `T` the tractor
//! point, and the robot with its heading `>`, `<`, `v` (towards greater y) or `^`. In what comes back, `b` and `f` are the loop road's back and
//! front, `=` the shield, `+` other centre cells. The robot is a point, so it fits wherever there is no obstacle.

use core::f32::consts::{FRAC_PI_2, PI};
use std::string::String;
use std::vec::Vec;

use super::detour::Limits;
use super::ground::Ground;
use super::loop_road::{LoopRoad, build_shield, way_back};
use super::shield::{Flaw, Shield};
use super::{Ouroboros, Round};
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
        topology.reset(Space::AnchoredNotObstacle);
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
    fn look(&mut self) -> Option<Found> {
        let mut memory = Memory::new();
        let robot = self.spread(self.find('T').unwrap(), &mut memory);
        let (ground, pose) = (self.ground(), self.pose);
        let residues = Residues::new(ground.frame.shape, &mut memory.residues).unwrap();
        let road = LoopRoad::find(&ground, &residues, (robot, behind(&pose, 10)))?;
        let walk = |head: Site| -> Vec<Cell> {
            let sites = core::iter::once(head).chain(residues.descent(head));
            sites.map(|site| ground.frame.cell(site)).collect()
        };
        assert_eq!(walk(road.back).len() + 1, road.back_steps as usize);
        assert_eq!(walk(road.front).len() + 1, road.front_steps as usize);
        let until_meet = |cells: Vec<Cell>| -> Vec<Cell> {
            let tail = cells.len() - road.tail_steps as usize;
            assert_eq!(cells[tail - 1], ground.frame.cell(road.meet));
            cells[..tail].to_vec()
        };
        Some(Found {
            back: until_meet(walk(road.back)),
            front: until_meet(walk(road.front)),
            shield: build_shield(&ground, road.back(&residues), pose.point().cell()),
        })
    }

    /// A wave from the centre cell nearest to a place, with the robot's surroundings as a blocker; the robot's cell.
    fn spread(&mut self, from: Cell, memory: &mut Memory) -> Site {
        let here = self.pose.point().cell();
        let mut round = self.round();
        let robot = round.nearest(here, &mut memory.lend()).unwrap();
        let goal = round.nearest(from, &mut memory.lend()).unwrap();
        let lent = &mut memory.lend();
        round
            .propagate(goal, surroundings(robot), None, lent)
            .unwrap();
        robot
    }

    /// What keeps a shield from standing at each cell of the road's back, from the robot on, up to the valid one.
    fn flaws(&mut self) -> Vec<Option<Flaw>> {
        let back = self.look().unwrap().back;
        let (ground, here) = (self.ground(), self.pose.point().cell());
        let judge = |span: &[Cell]| Shield::build(&ground, span[2], [span[4], span[0]], here).err();
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
        let ground = self.ground();
        let mark = |cell: Cell, seen: char| {
            let on = |cells: &[Cell]| cells.contains(&cell);
            if !matches!(seen, '.' | '?') {
                return seen;
            }
            match found {
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

/// A block, and the way round it.
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

/// The same way, blocked below.
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
    #........###............#
    #........###............#
    #........###............#
    #........###............#
    #........###............#
    #########################";

/// The robot has just begun.
const STARTED: &str = "
    #########################
    #.......................#
    #.......................#
    #............>..........#
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

/// It has come this way.
const VISITED: &str = "
    #########################
    #.......................#
    #.......................#
    #..oooooooooooooo>......#
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

/// It has come this way and turned.
const TURNED: &str = "
    #########################
    #.......................#
    #.......................#
    #..oooooooooooooo<......#
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

/// A strip behind the robot was never seen.
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

/// A corridor, longer than a shield, leads off behind the robot.
const SIDE_CORRIDOR: &str = "
    #######.....###############
    #######.....###############
    #######.....###############
    #######.....###############
    #######.....###############
    #######.....###############
    #.........................#
    #.........................#
    #.T........>..............#
    #.........................#
    #.........................#
    #.....#############.......#
    #.....#############.......#
    #.....#############.......#
    #.........................#
    #.........................#
    #.........................#
    ###########################";

/// A wide way with a post in it.
const BRANCHES: &str = "
    #################################
    #...............................#
    #...............................#
    #...............................#
    #...............................#
    #...............................#
    #..T............................#
    #.......####..........>.........#
    #.......####....................#
    #...............................#
    #...............................#
    #...............................#
    #...............................#
    #...............................#
    #....####################.......#
    #....####################.......#
    #....####################.......#
    #...............................#
    #...............................#
    #...............................#
    #################################";

/// Three ways to the robot.
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

/// A way that may lead round through the unexplored.
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

/// A block, and a room from which the robot came to it.
const LASSO: &str = "
    ##################################
    ##########...................#####
    ##########...................#####
    ##########.......>...........#####
    ##########...................#####
    ##########.....########......#####
    #..............########......#####
    #..............########......#####
    #..T...........########......#####
    #..............########......#####
    #..............########......#####
    ##########.....########......#####
    ##########...................#####
    ##########...................#####
    ##########...................#####
    ##########...................#####
    ##################################";

/// Two loops; the robot has been round the right block.
const CAME: &str = "
    #########################################
    #.......................................#
    #.......................................#
    #.......................................#
    #.......................................#
    #.......................................#
    #.....########.....################.....#
    #.....########.....################.....#
    #.....########..T..################.....#
    #.....########.....################.....#
    #.....########.....################.....#
    #.....########.....################.....#
    #.....########.....################.....#
    #.....########.....################.....#
    #.....########.....################.....#
    #.....########.....################.....#
    #.......................................#
    #.......................................#
    #.........................<.............#
    #.......................................#
    #.......................................#
    #########################################";

/// It is about to come to the tractor point.
const NOW: &str = "
    #########################################
    #.......................................#
    #.......................................#
    #.......................................#
    #.......................................#
    #.......................................#
    #.....########.....################.....#
    #.....########.....################.....#
    #.....########..T..################.....#
    #.....########.....################.....#
    #.....########.....################.....#
    #.....########.....################.....#
    #.....########.....################.....#
    #.....########.....################.....#
    #.....########..^..################.....#
    #.....########.....################.....#
    #.......................................#
    #.......................................#
    #.......................................#
    #.......................................#
    #.......................................#
    #########################################";

/// The tractor point that is made for a robot that has come along the `o`s, from left to right.
#[track_caller]
fn assert_tractor(picture: &str, expected: &str) {
    let mut scene = Scene::parse(picture);
    let mut strategy = Ouroboros::new();
    strategy.reset(scene.tiles.box_tiles());
    let row = scene.picture.iter().position(|row| row.contains(&'o'));
    for (x, _) in row.into_iter().flat_map(|y| {
        let cells = scene.picture[y].iter().enumerate();
        cells.filter(|(_, c)| **c == 'o')
    }) {
        strategy.note_pose(&pose_in(at(x, row.unwrap()), 0.0));
    }
    strategy.note_pose(&scene.pose);
    let round = scene.round();
    let tractor = strategy.generate_tractor(&round, &mut Memory::new().lend());
    let rows = scene.picture.iter().enumerate().map(|(y, row)| {
        let mark = |(x, c): (usize, &char)| if tractor == Some(at(x, y)) { 'T' } else { *c };
        row.iter().enumerate().map(mark).collect()
    });
    assert_picture(&rows.collect::<Vec<String>>().join("\n"), expected);
}

/// The four cases of the paper's figure 2, as its text has them: only a tractor point in the visited space behind the robot, with a shield
/// between that reaches from obstacle to obstacle, will do.
#[test]
fn of_four_cases_only_one_is_valid() {
    // (a) Behind the robot nothing was visited.
    assert_tractor(STARTED, STARTED);
    // (b) What was visited is ahead of it.
    assert_tractor(TURNED, TURNED);
    // (c) Valid.
    assert_tractor(
        VISITED,
        "
        #########################
        #.......................#
        #.......................#
        #..oooooooooooooo>......#
        #...T...................#
        #.......................#
        #.....#############.....#
        #.....#############.....#
        #.....#############.....#
        #.......................#
        #.......................#
        #.......................#
        #.......................#
        #.......................#
        #########################",
    );
    assert_picture(
        &Scene::parse(RING).drawn(),
        "
        #########################
        #........=..............#
        #........=..............#
        #....Tbbb=bb+>+fffff....#
        #...f....=..........f...#
        #...f....=...........f..#
        #..f..#############..f..#
        #..f..#############..f..#
        #..f..#############..f..#
        #...f................f..#
        #....f..............f...#
        #.....ffffffffffffff....#
        #.......................#
        #.......................#
        #########################",
    );
    // (d) The shield's end is not at an obstacle: back and front are there, and no shield.
    assert_picture(
        &Scene::parse(UNEXPLORED_END).drawn(),
        "
        #########################
        #.......................#
        #.......................#
        #....T.......>..........#
        #++++bbbbb..............#
        #???f?????bb+++ffffff...#
        #???f?????????????+..f..#
        #++f++#############..f..#
        #..f..#############..f..#
        #..f..#############..f..#
        #...f................f..#
        #....f..............f...#
        #.....ffffffffffffff....#
        #.......................#
        #.......................#
        #########################",
    );
    assert_eq!(Scene::parse(UNEXPLORED_END).flaws(), [Some(Flaw::OpenEnd)]);
}

#[test]
fn without_a_second_way_to_the_tractor_point_there_is_no_loop() {
    assert_picture(
        &Scene::parse(NO_LOOP).drawn(),
        "
        #########################
        #.......................#
        #.......................#
        #....T+++++++>++++++....#
        #...+...............+...#
        #...+................+..#
        #..+..#############..+..#
        #..+..#############..+..#
        #..+..#############..+..#
        #...+....###.........+..#
        #....+...###........+...#
        #.....+..###..++++++....#
        #........###............#
        #........###............#
        #########################",
    );
    assert!(Scene::parse(NO_LOOP).look().is_none());
}

#[test]
fn a_loop_may_run_through_the_unexplored() {
    assert_picture(
        &Scene::parse(UNKNOWN_LOOP).drawn(),
        "
        ###############??????????
        #.........=..+?fffffff++?
        #.........=..+++++++++f+?
        #....Tbbbb=bb>+++++++++f?
        #...f.....=....+++++++++f
        #...f.....=...++++++++++?
        #..f..########??????????
        #..f..#??????????????????
        #++f++#??????????????????
        ???f??????????????????????
        ??f??????????????????????",
    );
}

#[test]
fn no_shield_hangs_in_the_open() {
    let mut scene = Scene::parse(SIDE_CORRIDOR);
    // In the mouth of the corridor none stands; the first that does is beyond it.
    assert_picture(
        &scene.drawn(),
        "
        #######+++++###############
        #######..+..###############
        #######..+..###############
        #######..+..###############
        #######..+..###############
        #######..+..###############
        #.....==.+................#
        #......=bbb+..............#
        #.T..bb=...>++ffffff......#
        #...f..=............ff....#
        #...f..==.............f...#
        #..f..#############...f...#
        #..f..#############...f...#
        #..f..#############...f...#
        #...ff..............ff....#
        #.....ffffffffffffff......#
        #.........................#
        ###########################",
    );
    let (mouth, road) = (at(10, 7), [at(8, 7), at(12, 7)]);
    let here = scene.pose.point().cell();
    let flaw = Shield::build(&scene.ground(), mouth, road, here).unwrap_err();
    assert_eq!(flaw, Flaw::OpenEnd);
    assert_eq!(scene.flaws(), [Some(Flaw::AtRobot), None]);
}

#[test]
fn no_shield_cuts_two_branches() {
    let mut scene = Scene::parse(BRANCHES);
    assert_picture(
        &scene.drawn(),
        "
        #################################
        #.............==................#
        #.............=.................#
        #.......bbbb.==.................#
        #.....bb....b=..................#
        #....b......==bb................#
        #..T.b......=...bb..............#
        #...f...####=.....bbb+>+f.......#
        #...f...####.....+.......f......#
        #....f.........++.........f.....#
        #....f++.....++...........f.....#
        #...f...+++++..............f....#
        #...f......................f....#
        #..f........................f...#
        #..f.####################...f...#
        #..f.####################...f...#
        #..f.####################...f...#
        #...f.....................ff....#
        #....fffffffffffffffffffff......#
        #...............................#
        #################################",
    );
    assert_eq!(
        scene.flaws(),
        [Some(Flaw::OffBranch), Some(Flaw::CutsMore), None]
    );
}

#[test]
fn of_several_ways_ahead_the_shortest_is_the_front() {
    assert_picture(
        &Scene::parse(FORK).drawn(),
        "
        ###########################
        #.........................#
        #...++++++..........++++..#
        #..+......++......++..#.+.#
        #.+.#####...+...++...##.+.#
        #.+.#####....+.+....###.+.#
        #..Tbb=b..>...+.....###.+.#
        #..f..=.b+++f+.+....###.+.#
        #.f.####....f...+...###.+.#
        #.f.####...f.....++..##.+.#
        #..f.....ff........++...+.#
        #...fffff............+++..#
        #.........................#
        ###########################",
    );
}

#[test]
fn a_loop_ends_where_its_ways_meet() {
    // From there to the tractor point both go the same way, where no shield may stand.
    assert_picture(
        &Scene::parse(LASSO).drawn(),
        "
        ##################################
        ##########...................#####
        ##########.....b+++ffff......#####
        ##########=...b..>.....ff....#####
        ##########==.b...........f...#####
        ##########.===.########...f..#####
        #...........b==########...f..#####
        #..........b..=########...f..#####
        #..T++++++b....########...f..#####
        #..........f...########...f..#####
        #...........f..########...f..#####
        ##########..f..########...f..#####
        ##########...f...........f...#####
        ##########....fffffffffff....#####
        ##########...................#####
        ##########...................#####
        ##################################",
    );
}

#[test]
fn a_loop_goes_on_by_the_previous_shield_though_another_is_shorter() {
    let previous = Scene::parse(CAME).look().unwrap().shield.unwrap();
    assert_picture(
        &Scene::parse(CAME).drawn(),
        "
        #########################################
        #.......................................#
        #.......................................#
        #....++++++++++...bbbbbbbbbbbbbbbbbb....#
        #...+..........++b..................b...#
        #...+...........b....................b..#
        #..+..########..b..################..b..#
        #..+..########..b..################..b..#
        #..+..########..T..################..b..#
        #..+..########..f..################..b..#
        #..+..########..f..################..b..#
        #..+..########..f..################..b..#
        #..+..########..f..################..b..#
        #..+..########..f..################..b..#
        #..+..########..f..################..b..#
        #..+..########..f..################..b..#
        #...+...........f.............=......b..#
        #....+.........++ff...........=.....b...#
        #.....+++++++++....ffffff+<+bb=bbbbb....#
        #.............................=.........#
        #.............................=.........#
        #########################################",
    );
    // Without the previous shield, the back would be the shorter way round the left block.
    assert_picture(
        &Scene::parse(NOW).drawn(),
        "
        #########################################
        #.......................................#
        #.......................................#
        #....bbbbbbbbbb...++++++++++++++++++....#
        #...b..........b++..................+...#
        #...b...........b....................+..#
        #..b..########..b..################..+..#
        #..b..########..b..################..+..#
        #..b..########..T..################..+..#
        #..b..########..f..################..+..#
        #..b..########..f..################..+..#
        #..b..########..f..################..+..#
        #..b..########..f..################..+..#
        #..b..########..+..################..+..#
        #..b..########..^..################..+..#
        #..b..########..+..################..+..#
        #...b........=..b....................+..#
        #....b.......==b+++.................+...#
        #.....bbbbbbbb=....+++++++++++++++++....#
        #.............==........................#
        #..............=........................#
        #########################################",
    );
    // With it, the back leads there, and there is the next shield.
    let mut scene = Scene::parse(NOW);
    let mut memory = Memory::new();
    let robot = scene.spread(previous.at(), &mut memory);
    let residues = Residues::new(scene.topology.frame().shape, &mut memory.residues).unwrap();
    let ground = scene.ground();
    let back: Vec<Site> = way_back(ground.way, &residues, robot).unwrap().collect();
    let here = scene.pose.point().cell();
    let found = Found {
        shield: build_shield(&ground, back.iter().copied(), here),
        back: back.iter().map(|site| ground.frame.cell(*site)).collect(),
        front: Vec::new(),
    };
    assert_eq!(found.back.last(), Some(&previous.at()));
    assert_picture(
        &scene.picture_of(Some(&found)),
        "
        #########################################
        #.......................................#
        #.......................................#
        #....++++++++++...++++++++++++++++++....#
        #...+..........+++..................+...#
        #...+...........+....................+..#
        #..+..########..+..################..+..#
        #..+..########..+..################..+..#
        #..+..########..T..################..+..#
        #..+..########..+..################..+..#
        #..+..########..+..################..+..#
        #..+..########..+..################..+..#
        #..+..########..+..################..+..#
        #..+..########..+..################..+..#
        #..+..########..^..################..+..#
        #..+..########..+..################..+..#
        #...+...........b..==................+..#
        #....+.........++bb=................+...#
        #.....+++++++++....=bbbbbbbbbbb+++++....#
        #..................=....................#
        #.................==....................#
        #########################################",
    );
}

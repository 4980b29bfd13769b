//! Whole explorations of small worlds: every loop is closed, and no loop holds the robot.
//!
//! The robot is simple: it sees every coarse cell within 1.6 m that no obstacle hides, and in each
//! round it moves some cells along the path, round the shield. Worlds are pictures as in
//! [`super::scenes`]; a digit is an obstacle with that name, which a loop goes round.

mod cases;
mod worlds;

use std::collections::{BTreeMap, VecDeque};
use std::string::String;
use std::vec::Vec;

use crate::config::LoopLimits;
use crate::geometry::{Cell, Pose};
use crate::map::{Class, Tiles};
use crate::path::{PlanningContext, RoundOutcome};
use crate::roadmap::configuration_space::Footprint;
use crate::roadmap::skeleton::{Skeleton, Space};
use crate::strategy::Frontier;
use crate::strategy::ouroboros::scenes::{
    Memory, POINT_M, SLOTS, TILES, TUNING, at, has_cell, pose_in,
};
use crate::strategy::ouroboros::{Closed, Ouroboros};

/// Cells that the robot sees: the same share of these loops as 12 m of one of 70 m.
const SIGHT: i32 = 8;
/// Cells that it moves in a round.
const STRIDE: usize = 3;
/// Rounds after which a loop holds the robot.
const MOST_ROUNDS: usize = 3000;
struct Exploration {
    world: Vec<Vec<char>>,
    tiles: Tiles<TILES, SLOTS>,
    skeleton: Skeleton<SLOTS>,
    strategy: Ouroboros<SLOTS>,
    frontier: Frontier,
    limits: LoopLimits,
    memory: Memory,
    robot: (i32, i32),
    pose: Pose,
    /// Angle that the robot has turned round each digit's middle: now, least and greatest, radians.
    turned: BTreeMap<char, [f64; 3]>,
    path: Vec<(i32, i32)>,
}

impl Exploration {
    fn new(world: &str, limits: LoopLimits) -> Self {
        let world: Vec<Vec<char>> = world
            .split_whitespace()
            .map(|r| r.chars().collect())
            .collect();
        let mut tiles = Tiles::new();
        tiles.reset();
        let mut skeleton = Skeleton::new();
        skeleton.reset(Space::NotObstacle);
        let strategy = Ouroboros::new();
        let mut robot = (0, 0);
        let mut turned = BTreeMap::new();
        for (y, row) in world.iter().enumerate() {
            for (x, &c) in row.iter().enumerate() {
                if c == '>' {
                    robot = (x as i32, y as i32);
                } else if c.is_ascii_digit() {
                    turned.insert(c, [0.0; 3]);
                }
            }
        }
        let pose = pose_in(at(robot.0 as usize, robot.1 as usize), 0.0);
        Self {
            world,
            tiles,
            skeleton,
            strategy,
            frontier: Frontier::new(),
            limits,
            memory: Memory::new(),
            robot,
            pose,
            turned,
            path: std::vec![robot],
        }
    }

    fn is_obstacle(&self, (x, y): (i32, i32)) -> bool {
        let row = usize::try_from(y).ok().and_then(|y| self.world.get(y));
        let cell = row.and_then(|row| row.get(usize::try_from(x).ok()?));
        cell.is_none_or(|&c| c == '#' || c.is_ascii_digit())
    }

    /// Writes everything within sight into the map.
    fn see(&mut self) {
        let (x, y) = self.robot;
        for to in (y - SIGHT..=y + SIGHT).flat_map(|j| (x - SIGHT..=x + SIGHT).map(move |i| (i, j)))
        {
            let (dx, dy) = (to.0 - x, to.1 - y);
            if dx * dx + dy * dy > SIGHT * SIGHT || to.0 < 0 || to.1 < 0 {
                continue;
            }
            let steps = dx.abs().max(dy.abs()).max(1);
            let on = |k: i32| {
                let along = |from: i32, d: i32| {
                    (f64::from(from) + f64::from(d * k) / f64::from(steps)).round() as i32
                };
                (along(x, dx), along(y, dy))
            };
            if (0..steps).any(|k| self.is_obstacle(on(k))) || to.1 as usize >= self.world.len() {
                continue;
            }
            let class = if self.is_obstacle(to) {
                Class::Obstacle
            } else {
                Class::Free
            };
            for part in at(to.0 as usize, to.1 as usize).quarters() {
                self.tiles.set(part, class).unwrap();
            }
        }
    }

    /// Plans a whole round on a new skeleton.
    fn plan(&mut self, time_ms: u32) -> RoundOutcome {
        let footprint = Footprint::new(POINT_M);
        self.strategy.note_pose(&self.pose, &TUNING);
        while !self
            .skeleton
            .advance(&self.tiles, &footprint, &mut [0; SLOTS * 8], u32::MAX)
        {}
        self.frontier.cut(&mut self.skeleton);
        let before = self.skeleton.skeleton().unwrap().words().to_vec();
        for calls in 1.. {
            assert!(calls <= 4, "a round that does not end");
            let blocked = self.frontier.blocked().clone();
            let round = PlanningContext {
                blocked: &blocked,
                pose: self.pose,
                time_ms,
                ..PlanningContext::on(&mut self.skeleton, &self.tiles, &footprint, &self.limits)
            };
            let outcome = self
                .strategy
                .advance(&mut self.frontier, round, self.memory.lend());
            assert_eq!(
                self.skeleton.skeleton().unwrap().words(),
                before,
                "it stays cut"
            );
            if let Some(outcome) = outcome {
                return outcome;
            }
        }
        unreachable!()
    }

    fn is_shield(&self, (x, y): (i32, i32)) -> bool {
        self.strategy
            .shield()
            .is_some_and(|shield| has_cell(shield, at(x as usize, y as usize)))
    }

    /// Moves some cells towards the part of the path that is a little ahead.
    fn go(&mut self) {
        let cells = self.frontier.path().cells();
        let here = at(self.robot.0 as usize, self.robot.1 as usize);
        let far = |cell: &Cell| (cell.x - here.x).abs().max((cell.y - here.y).abs());
        let Some(nearest) = (0..cells.len().min(20)).min_by_key(|&k| far(&cells[k])) else {
            return;
        };
        // The last cell of a path is unexplored, and may be an obstacle.
        let ahead = &cells[nearest..=(nearest + STRIDE).min(cells.len() - 1)];
        let ways = ahead
            .iter()
            .rev()
            .map(|goal| self.steps_to((goal.x / 2, goal.y / 2)));
        let way = ways.into_iter().find(|way| !way.is_empty());
        for step in way.into_iter().flatten().take(STRIDE) {
            self.step_to(step);
        }
    }

    fn step_to(&mut self, to: (i32, i32)) {
        assert!(!self.is_obstacle(to), "the path leads into an obstacle");
        let (dx, dy) = (to.0 - self.robot.0, to.1 - self.robot.1);
        let middles = self.middles();
        for (name, turned) in &mut self.turned {
            let (x, y) = middles[name];
            let bearing = |(i, j): (i32, i32)| (f64::from(j) - y).atan2(f64::from(i) - x);
            let turn = bearing(to) - bearing(self.robot);
            let turn = turn - (turn / core::f64::consts::TAU).round() * core::f64::consts::TAU;
            turned[0] += turn;
            turned[1] = turned[1].min(turned[0]);
            turned[2] = turned[2].max(turned[0]);
        }
        self.robot = to;
        let yaw_rad = (dy as f32).atan2(dx as f32);
        self.pose = pose_in(at(to.0 as usize, to.1 as usize), yaw_rad);
        self.strategy.note_pose(&self.pose, &TUNING);
        self.path.push(to);
        self.see();
    }

    fn middles(&self) -> BTreeMap<char, (f64, f64)> {
        let mut sums: BTreeMap<char, (f64, f64, f64)> = BTreeMap::new();
        for (y, row) in self.world.iter().enumerate() {
            for (x, c) in row.iter().enumerate().filter(|(_, c)| c.is_ascii_digit()) {
                let sum = sums.entry(*c).or_default();
                *sum = (sum.0 + x as f64, sum.1 + y as f64, sum.2 + 1.0);
            }
        }
        sums.into_iter()
            .map(|(c, (x, y, n))| (c, (x / n, y / n)))
            .collect()
    }

    /// The shortest path over free cells round the shield, without the first cell.
    fn steps_to(&self, goal: (i32, i32)) -> Vec<(i32, i32)> {
        let mut from = BTreeMap::from([(self.robot, self.robot)]);
        let mut queue = VecDeque::from([self.robot]);
        while let Some(here) = queue.pop_front() {
            if here == goal {
                let mut steps = std::vec![];
                let mut back = here;
                while back != self.robot {
                    steps.push(back);
                    back = from[&back];
                }
                steps.reverse();
                return steps;
            }
            for (dx, dy) in [(1, 0), (-1, 0), (0, 1), (0, -1)] {
                let near = (here.0 + dx, here.1 + dy);
                if !self.is_obstacle(near) && !self.is_shield(near) && !from.contains_key(&near) {
                    from.insert(near, here);
                    queue.push_back(near);
                }
            }
        }
        Vec::new()
    }

    /// Explores to the end.
    fn run(&mut self) {
        self.see();
        for round in 0..MOST_ROUNDS {
            match self.plan(round as u32 * 800) {
                RoundOutcome::Nothing => return,
                RoundOutcome::Stuck => panic!("stuck\n{}", self.drawn()),
                RoundOutcome::Path | RoundOutcome::Unsure => self.go(),
            }
        }
        panic!(
            "still exploring after {MOST_ROUNDS} rounds\n{}",
            self.drawn()
        );
    }

    /// The digits that the robot has been round.
    fn rounded(&self) -> String {
        let round = |[_, least, most]: [f64; 3]| most - least > 0.97 * core::f64::consts::TAU;
        self.turned
            .iter()
            .filter(|(_, turned)| round(**turned))
            .map(|(c, _)| *c)
            .collect()
    }

    fn unknown(&self) -> usize {
        let rows = self.world.iter().enumerate();
        let cells = rows.flat_map(|(y, row)| (0..row.len()).map(move |x| (x, y)));
        cells
            .filter(|&(x, y)| !self.is_obstacle((x as i32, y as i32)))
            .filter(|&(x, y)| self.tiles.class(at(x, y)) == Class::Unknown)
            .count()
    }

    /// The kinds of the world's closed regions.
    fn closed_kinds(&self) -> Vec<Closed> {
        let rows = self.world.iter().enumerate();
        let cells = rows.flat_map(|(y, row)| (0..row.len()).map(move |x| at(x, y)));
        cells
            .filter_map(|cell| self.strategy.closed_regions().closed(cell))
            .collect()
    }

    fn drawn(&self) -> String {
        let mut text = String::new();
        for (y, row) in self.world.iter().enumerate() {
            for (x, &c) in row.iter().enumerate() {
                let here = (x as i32, y as i32);
                let marked = self.strategy.closed_regions().is_closed(at(x, y));
                text.push(if here == self.robot {
                    '@'
                } else if self.strategy.tractor() == Some(at(x, y)) {
                    'T'
                } else if c != '.' && c != '>' {
                    c
                } else if self.is_shield(here) {
                    '='
                } else if self.path.contains(&here) {
                    '*'
                } else if self.tiles.class(at(x, y)) == Class::Unknown {
                    '?'
                } else if marked {
                    ','
                } else {
                    '.'
                });
            }
            text.push('\n');
        }
        text
    }
}

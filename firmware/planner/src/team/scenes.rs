//! Teams without a world: members with maps of their own, and an air that loses, doubles and
//! disorders what they say. After the last change all maps become equal.

use std::boxed::Box;
use std::vec::Vec;

use super::Team;
use super::exchange::STEP_PACKETS;
use super::packet::{Activity, Beacon, Body, Packet};
use crate::config::{LocaliseTuning, Member, TeamPlace};
use crate::geometry::{Cell, Point, Pose, Twist};
use crate::map::{Class, Map};

const STEP_MS: u32 = 200;
/// Side of the area in which the members see something, cells: 3 × 3 tiles.
const SIDE: u32 = 96;

type SmallMap = Map<20, 64>;

struct Random(u32);

impl Random {
    fn below(&mut self, bound: u32) -> u32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.0 >> 8) % bound
    }
}

const TUNING: &LocaliseTuning = &LocaliseTuning::DEFAULT;

struct Robot {
    team: Team,
    map: Box<SmallMap>,
}

impl Robot {
    fn new(id: u8) -> Self {
        let mut team = Team::new();
        let place = TeamPlace {
            member: Member { id, boot: 0 },
            ..TeamPlace::default()
        };
        team.reset(Some(place), false);
        let mut map = Box::<SmallMap>::default();
        map.reset();
        Self { team, map }
    }

    /// Measures a patch of cells.
    fn measure(&mut self, random: &mut Random) {
        let (x, y) = (random.below(SIDE - 6) as i32, random.below(SIDE - 6) as i32);
        for k in 0..36 {
            let class = match random.below(5) {
                0 => Class::Obstacle,
                1 => Class::Negative,
                _ => Class::Free,
            };
            let cell = Cell {
                x: x + k % 6,
                y: y + k / 6,
            };
            self.map.tiles.set(cell, class).expect("room");
        }
    }

    /// Makes a step and returns what is said after it.
    fn step(&mut self, now_ms: u32) -> Vec<Packet> {
        let motion = (&Pose::default(), Twist::default());
        self.team.begin_step(now_ms, motion, &mut self.map);
        core::iter::from_fn(|| self.team.say(&mut self.map, |beacon| beacon)).collect()
    }

    fn mark(&mut self) -> u32 {
        self.team.exchange.mark(&self.map)
    }
}

/// An air: which share of the packets is lost or doubled, percent, and how many wait in it.
struct Air {
    lost: u32,
    doubled: u32,
    delayed: usize,
    waiting: Vec<(usize, Packet)>,
}

impl Air {
    /// Takes what robot `from` says, and lets the robots hear some of what waits.
    fn carry(&mut self, from: usize, said: Vec<Packet>, team: &mut [Robot], random: &mut Random) {
        for packet in said {
            for to in (0..team.len()).filter(|&to| to != from) {
                let copies = 1 + u32::from(random.below(100) < self.doubled);
                for _ in 0..copies {
                    if random.below(100) >= self.lost {
                        self.waiting.push((to, packet.clone()));
                    }
                }
            }
        }
        while self.waiting.len() > self.delayed {
            let at = random.below(self.waiting.len() as u32) as usize;
            let (to, packet) = self.waiting.swap_remove(at);
            team[to]
                .team
                .hear(&packet, &mut team[to].map, (0.0, true, TUNING));
        }
    }
}

/// Returns the seconds after the last measurement until all maps are equal.
fn seconds_until_equal(members: u8, air: &mut Air, seed: u32) -> Option<u32> {
    let mut random = Random(seed);
    let mut team: Vec<Robot> = (0..members).map(Robot::new).collect();
    for step in 0..1_500 {
        for from in 0..team.len() {
            if step < 300 && random.below(3) == 0 {
                team[from].measure(&mut random);
            }
            let said = team[from].step(step * STEP_MS);
            let others = said
                .iter()
                .filter(|packet| !matches!(packet.body, Body::Beacon(_)));
            assert!(others.count() <= usize::from(STEP_PACKETS));
            air.carry(from, said, &mut team, &mut random);
        }
        let marks: Vec<u32> = team.iter_mut().map(Robot::mark).collect();
        if step >= 300 && marks.iter().all(|mark| *mark == marks[0]) {
            same_cells(&team);
            return Some((step - 300) / 5);
        }
    }
    None
}

fn same_cells(team: &[Robot]) {
    for (x, y) in (0..3).flat_map(|y| (0..3).map(move |x| (x, y))) {
        let cells = |robot: &Robot| robot.map.tiles().packed(x, y);
        assert!(team.iter().all(|robot| cells(robot) == cells(&team[0])));
    }
}

#[test]
fn all_maps_become_equal_whatever_the_air_does() {
    for seed in 0..12 {
        for members in [2, 3, 5] {
            let mut airs = [(0, 0, 0), (50, 0, 0), (20, 30, 40), (60, 30, 10)].map(
                |(lost, doubled, delayed)| Air {
                    lost,
                    doubled,
                    delayed,
                    waiting: Vec::new(),
                },
            );
            for (number, air) in airs.iter_mut().enumerate() {
                let seconds = seconds_until_equal(members, air, seed);
                let most = [8, 60, 60, 200][number];
                assert!(
                    seconds.is_some_and(|seconds| seconds <= most),
                    "{members} members, air {number}, seed {seed}: {seconds:?} s"
                );
            }
        }
    }
}

/// A quiet team with equal maps says beacons only.
#[test]
fn a_team_with_equal_maps_says_nothing_but_beacons() {
    let mut random = Random(1);
    let mut team: Vec<Robot> = (0..2).map(Robot::new).collect();
    team[0].measure(&mut random);
    let mut air = Air {
        lost: 0,
        doubled: 0,
        delayed: 0,
        waiting: Vec::new(),
    };
    let mut late = 0;
    for step in 0..100 {
        for from in 0..2 {
            let said = team[from].step(step * STEP_MS);
            late += usize::from(step >= 50) * said.len();
            air.carry(from, said, &mut team, &mut random);
        }
    }
    assert_eq!(late, 2 * 50);
}

#[test]
fn a_newcomer_has_the_whole_map_within_seconds() {
    let mut random = Random(2);
    let mut team: Vec<Robot> = (0..3).map(Robot::new).collect();
    let mut air = Air {
        lost: 0,
        doubled: 0,
        delayed: 0,
        waiting: Vec::new(),
    };
    for _ in 0..60 {
        team[0].measure(&mut random);
    }
    for step in 0..100 {
        for from in 0..3 {
            let said = team[from].step(step * STEP_MS);
            air.carry(from, said, &mut team, &mut random);
        }
    }
    same_cells(&team);
    // Robot 2 begins a new session: another boot, an empty map.
    team[2] = Robot::new(2);
    team[2].team.member = Some(Member { id: 2, boot: 1 });
    let mut seconds = None;
    for step in 100..150 {
        for from in 0..3 {
            let said = team[from].step(step * STEP_MS);
            air.carry(from, said, &mut team, &mut random);
        }
        let marks: Vec<u32> = team.iter_mut().map(Robot::mark).collect();
        if marks[0] == marks[2] {
            seconds = Some((step - 100) / 5);
            break;
        }
    }
    assert!(seconds.is_some_and(|seconds| seconds <= 4), "{seconds:?}");
}

#[test]
fn alone_nothing_but_beacons_is_said_and_nothing_is_lost() {
    let mut random = Random(3);
    let mut alone = Robot::new(0);
    alone.measure(&mut random);
    for step in 0..100 {
        assert_eq!(alone.step(step * STEP_MS).len(), 1);
    }
    let mut other = Robot::new(1);
    let said = other.step(0);
    alone
        .team
        .hear(&said[0], &mut alone.map, (0.0, true, TUNING));
    let said = alone.step(100 * STEP_MS);
    assert!(
        said.iter()
            .any(|packet| matches!(packet.body, Body::Tile(_)))
    );
}

/// An obstacle that one member saw go stays gone in all maps, although the others saw it.
#[test]
fn what_went_away_is_gone_for_all() {
    let mut random = Random(4);
    let mut team: Vec<Robot> = (0..2).map(Robot::new).collect();
    let cell = Cell { x: 5, y: 5 };
    for robot in &mut team {
        robot.map.tiles.set(cell, Class::Obstacle).expect("room");
    }
    let mut air = Air {
        lost: 0,
        doubled: 0,
        delayed: 0,
        waiting: Vec::new(),
    };
    for step in 0..100 {
        if step == 40 {
            team[1].map.tiles.set(cell, Class::Free).expect("room");
        }
        for from in 0..2 {
            let said = team[from].step(step * STEP_MS);
            air.carry(from, said, &mut team, &mut random);
        }
    }
    assert!(
        team.iter()
            .all(|robot| robot.map.class(cell) == Class::Free)
    );
    assert_eq!(team[0].mark(), team[1].mark());
}

/// Another member took the robot for an obstacle, before it heard of it.
#[test]
fn a_robot_that_was_taken_for_an_obstacle_clears_its_place_for_all() {
    let mut random = Random(5);
    let mut team: Vec<Robot> = (0..2).map(Robot::new).collect();
    let (under, wall) = (Cell { x: 2, y: 0 }, Cell { x: 9, y: 0 });
    for cell in [under, wall] {
        team[0].map.tiles.set(cell, Class::Free).expect("room");
        team[1].map.tiles.set(cell, Class::Obstacle).expect("room");
    }
    for step in 0..60 {
        for from in 0..2 {
            for packet in team[from].step(step * STEP_MS) {
                let to = &mut team[1 - from];
                let stand_m = if from == 1 { 0.45 } else { 0.0 };
                to.team.hear(&packet, &mut to.map, (stand_m, true, TUNING));
            }
        }
        team[usize::from(random.below(2) == 0)].mark();
    }
    for robot in &team {
        assert_eq!(robot.map.class(under), Class::Free);
        assert_eq!(robot.map.class(wall), Class::Obstacle);
    }
    assert_eq!(team[0].mark(), team[1].mark());
}

/// Returns true if a peer of the Pioneer's size, 2 m ahead and doing this, is in the way from the
/// origin to 4 m ahead, on a road that passes it at this distance.
fn bars(activity: Activity, beside_m: f32) -> bool {
    let mut team = Team::new();
    let beacon = Beacon {
        activity,
        position_cm: (200, 0),
        half_cm: (25, 25),
        ..Beacon::default()
    };
    team.peers.hear(Member { id: 2, boot: 0 }, 0, &beacon, 0);
    let at = |k: i32| Point {
        x_m: 0.2 * k as f32,
        y_m: beside_m,
    };
    team.bars(Point::default(), (0..20).map(at))
}

#[test]
fn a_finished_robot_is_in_the_way_where_two_hulls_have_no_room() {
    assert!(bars(Activity::Finished, 0.0) && bars(Activity::Finished, 0.6));
    assert!(!bars(Activity::Finished, 0.8), "there is room beside it");
    assert!(!bars(Activity::Exploring, 0.0), "it drives on");
}

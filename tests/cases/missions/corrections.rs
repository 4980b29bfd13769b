//! Corrections of the map while the robot explores: the map and the pose move, and the world stays.
//!
//! The host's copy of the map is drawn anew, cell by cell, at the places to which a correction
//! moves its cells, and the robot's pose goes with the part that it is in. So map and pose agree
//! again, and the planner is to drive on as if nothing had happened.

use core::time::Duration;
use std::collections::{BTreeMap, BTreeSet};

use fieldline_planner::geometry::{Cell, Pose};
use fieldline_protocol::message::{Command, Observation, Twist};
use fieldline_tests::runs::{FRONTIER, explored};
use fieldline_tests::worlds;
use host_sim::link::correction::{Classes, CorrectedTile, MapCorrection, Motion};
use host_sim::link::direct::Direct;
use host_sim::link::endpoint::{Endpoint, RetryPolicy};
use host_sim::link::line::Line;
use host_sim::link::loopback::{LocalDevice, loopback};
use host_sim::link::{Link, LinkError};
use host_sim::report::Report;
use host_sim::trial::mission::{Mission, OdometryProfile, explore_corrected};
use host_sim::trial::{Corrector, MapCopy};
use host_sim::world::World;

use crate::links::faulty;

/// Side of a cell, metres.
const CELL_M: f64 = 0.1;
/// Cells along a tile's side.
const SIDE: i32 = 32;
/// Steps within which the robot drives again: one second.
const SECOND: u32 = 5;
/// A link that loses and repeats frames.
const LOSSES: &str = "drop=0.05,duplicate=0.05";

/// What moves, and how.
#[derive(Clone, Copy, Debug)]
struct Moves {
    /// Time of the correction, milliseconds.
    at_ms: u32,
    motion: Motion,
    /// Only cells at least this many to the right of the robot's tile move; all if `None`.
    from: Option<i32>,
}

impl Moves {
    /// Returns where a point of the map goes, metres.
    fn forward(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let Motion { x_m, y_m, yaw_rad } = self.motion;
        let (sin, cos) = yaw_rad.sin_cos();
        [x * cos - y * sin + x_m, x * sin + y * cos + y_m]
    }

    /// Returns where a point of the map comes from, metres.
    fn back(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let Motion { x_m, y_m, yaw_rad } = self.motion;
        let (sin, cos) = yaw_rad.sin_cos();
        let (x, y) = (x - x_m, y - y_m);
        [x * cos + y * sin, y * cos - x * sin]
    }

    /// Returns true if a cell moves; `column` is that of the robot's tile.
    fn moves(&self, cell: Cell, column: i32) -> bool {
        self.from.is_none_or(|from| cell.x >= column * SIDE + from)
    }

    /// Returns the class of a cell in the moved map.
    fn class(&self, map: &Cells, cell: Cell, column: i32) -> u32 {
        let source = cell_of(self.back(centre(cell)));
        let moved = Some(source).filter(|at| self.moves(*at, column));
        let moved = moved.map_or(0, |at| map.class(at));
        if moved != 0 || self.moves(cell, column) {
            moved
        } else {
            map.class(cell)
        }
    }

    /// Draws the moved map.
    fn correction(&self, mirror: &dyn MapCopy, robot: &Pose) -> MapCorrection {
        let map = Cells(mirror.tiles());
        let column = robot.point().cell().x.div_euclid(SIDE);
        let mut keys: BTreeSet<(i16, i16)> = map.0.keys().copied().collect();
        for key in map.0.keys() {
            let [x, y] = self.forward(centre(middle(*key)));
            let Cell { x, y } = cell_of([x, y]);
            let (x, y) = (x.div_euclid(SIDE) as i16, y.div_euclid(SIDE) as i16);
            keys.extend((-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (x + dx, y + dy))));
        }
        let tile = |key: &(i16, i16)| {
            let mut classes = Classes::default();
            for (x, y) in (0..SIDE).flat_map(|x| (0..SIDE).map(move |y| (x, y))) {
                let cell = Cell {
                    x: i32::from(key.0) * SIDE + x,
                    y: i32::from(key.1) * SIDE + y,
                };
                let class = self.class(&map, cell, column);
                classes[0][y as usize] |= (class & 1) << x;
                classes[1][y as usize] |= (class >> 1) << x;
            }
            let from = middle(*key);
            let shift = if self.moves(from, column) {
                let to = cell_of(self.forward(centre(from)));
                ((to.x - from.x) as i8, (to.y - from.y) as i8)
            } else {
                (0, 0)
            };
            CorrectedTile {
                key: *key,
                shift,
                classes,
                trail: [0; 16],
            }
        };
        let is_news = |tile: &CorrectedTile| {
            let old = map.0.get(&tile.key).copied().unwrap_or_default();
            old != tile.classes || tile.shift != (0, 0)
        };
        MapCorrection {
            epoch: mirror.epoch() + 1,
            motion: self.motion,
            tiles: keys.iter().map(tile).filter(is_news).collect(),
        }
    }
}

/// The cells of a map.
struct Cells(BTreeMap<(i16, i16), Classes>);

impl Cells {
    fn class(&self, Cell { x, y }: Cell) -> u32 {
        let key = (x.div_euclid(SIDE) as i16, y.div_euclid(SIDE) as i16);
        let (x, y) = (x.rem_euclid(SIDE), y.rem_euclid(SIDE) as usize);
        self.0
            .get(&key)
            .map_or(0, |[low, high]| low[y] >> x & 1 | (high[y] >> x & 1) << 1)
    }
}

fn centre(cell: Cell) -> [f64; 2] {
    [cell.x, cell.y].map(|at| (f64::from(at) + 0.5) * CELL_M)
}

fn cell_of(point: [f64; 2]) -> Cell {
    let [x, y] = point.map(|at| (at / CELL_M).floor() as i32);
    Cell { x, y }
}

/// Returns the middle cell of a tile.
fn middle(key: (i16, i16)) -> Cell {
    Cell {
        x: i32::from(key.0) * SIDE + SIDE / 2,
        y: i32::from(key.1) * SIDE + SIDE / 2,
    }
}

/// Makes some corrections, and watches how the robot drives on.
struct Script {
    moves: Vec<Moves>,
    done: usize,
    /// Steps since the last correction, and those until the robot drove.
    since: u32,
    drove_after: Vec<u32>,
}

impl Corrector for Script {
    fn correct(
        &mut self,
        observation: &Observation,
        command: &Command,
        mirror: &dyn MapCopy,
    ) -> Option<MapCorrection> {
        assert_eq!(command.map_epoch, mirror.epoch(), "every command tells it");
        self.since += 1;
        if self.drove_after.len() < self.done && command.velocity != Twist::default() {
            self.drove_after.push(self.since);
        }
        let next = self.moves.get(self.done)?;
        if observation.time_ms < next.at_ms {
            return None;
        }
        (self.done, self.since) = (self.done + 1, 0);
        Some(next.correction(mirror, &mirror.pose()))
    }
}

const fn shift(x_m: f64) -> Motion {
    Motion {
        x_m,
        y_m: 0.0,
        yaw_rad: 0.0,
    }
}

/// The half of the map in which the robot is goes 1 m to the side, and back again.
fn tears() -> Vec<Moves> {
    let moves = |at_ms, x_m, from| Moves {
        at_ms,
        motion: shift(x_m),
        from: Some(from),
    };
    vec![moves(16_000, 1.0, 0), moves(20_000, -1.0, 10)]
}

/// All of the map turns by 5°.
fn turns() -> Vec<Moves> {
    vec![Moves {
        at_ms: 16_000,
        motion: Motion {
            yaw_rad: 5_f64.to_radians(),
            ..Motion::default()
        },
        from: None,
    }]
}

/// Explores with corrections; asserts that the robot drives on at once and ends as it should.
fn corrected(world: &World, mission: &Mission, link: &mut dyn Link, moves: Vec<Moves>) -> Report {
    let mut script = Script {
        moves,
        done: 0,
        since: 0,
        drove_after: Vec::new(),
    };
    let run = explore_corrected(mission, world, link, &mut (), &mut script);
    let (report, _) = run.expect("it begins");
    let what = format!("{} by {}: {:?}", world.name(), mission.link, report.outcome);
    assert!(report.explored(), "{what}");
    assert_eq!(report.safety.collisions, 0, "{what}");
    assert_eq!(report.debug.map_matches_mirror, Some(true), "{what}");
    assert!(
        report.coverage.fraction > 0.95,
        "{what}: {}",
        report.coverage.fraction
    );
    assert_eq!(script.drove_after.len(), script.moves.len(), "{what}");
    assert!(
        script.drove_after.iter().all(|steps| *steps <= SECOND),
        "{what}: {:?}",
        script.drove_after
    );
    report
}

fn mission(link: &str) -> Mission {
    Mission {
        strategy: FRONTIER.into(),
        link: link.into(),
        ..Mission::default()
    }
}

/// One digest by call, by bytes, and by a link that loses and repeats frames.
fn is_the_same_by_all_links(moves: fn() -> Vec<Moves>) {
    let world = worlds::builtin("narrow-doors");
    let by_call = corrected(&world, &mission("direct"), &mut Direct::new(), moves());
    let by_bytes = corrected(&world, &mission("loopback"), &mut loopback(), moves());
    let by_losses = corrected(&world, &mission(LOSSES), &mut faulty(LOSSES, 5), moves());
    assert!(by_losses.link_stats.retries > 0, "nothing was lost");
    for other in [by_bytes, by_losses] {
        assert_eq!(other.digest, by_call.digest, "{}", other.link);
    }
}

#[test]
fn the_robot_drives_on_when_half_of_the_map_moves() {
    is_the_same_by_all_links(tears);
}

#[test]
fn the_robot_drives_on_when_the_map_turns() {
    is_the_same_by_all_links(turns);
}

/// With drifting odometry the pose is found again in the turned map.
#[test]
fn a_robot_that_corrects_its_odometry_goes_on_in_the_turned_map() {
    let world = worlds::builtin("narrow-doors");
    let mission = Mission {
        odometry: OdometryProfile::Noisy,
        localise: true,
        ..mission("direct")
    };
    corrected(&world, &mission, &mut Direct::new(), turns());
}

/// Every strategy goes on with what it remembers.
#[test]
fn every_strategy_drives_on_when_the_map_turns() {
    for (strategy, name) in [
        ("ouroboros", "loop"),
        ("tdbvp", "narrow-doors"),
        ("esbpf", "hall"),
    ] {
        let mission = Mission {
            strategy: strategy.into(),
            ..mission("direct")
        };
        corrected(
            &worlds::builtin(name),
            &mission,
            &mut Direct::new(),
            turns(),
        );
    }
}

/// A device that loses its power before some frames.
struct Flickering {
    device: LocalDevice,
    sent: u32,
    resets: u32,
}

/// Number of losses of power, and of frames from one to the next.
const RESETS: u32 = 10;
const FRAMES: u32 = 23;

impl Line for Flickering {
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.sent += 1;
        if self.sent.is_multiple_of(FRAMES) && self.resets < RESETS {
            self.resets += 1;
            self.device.reboot();
        }
        self.device.send(bytes)
    }

    fn receive(&mut self, into: &mut Vec<u8>, wait: Duration) -> Result<(), LinkError> {
        self.device.receive(into, wait)
    }

    fn now(&self) -> Duration {
        self.device.now()
    }
}

/// A device that is reset ten times gets its map back each time, and the run ends as undisturbed.
#[test]
fn a_device_that_was_reset_goes_on_with_its_map() {
    for (name, drifts) in [("cluttered", false), ("hall", true), ("loop", true)] {
        let world = worlds::builtin(name);
        let mission = Mission {
            resumes: true,
            odometry: if drifts {
                OdometryProfile::Noisy
            } else {
                OdometryProfile::Truth
            },
            localise: drifts,
            ..mission("loopback")
        };
        let (clean, _) = explored(&mission, &world, &mut loopback());
        let line = Flickering {
            device: LocalDevice::new(),
            sent: 0,
            resets: 0,
        };
        let mut link = Endpoint::new(line, RetryPolicy::VIRTUAL, 1);
        let (report, _) = explored(&mission, &world, &mut link);
        assert_eq!(link.line().resets, RESETS, "{name}");
        assert!(report.explored(), "{name}: {:?}", report.outcome);
        assert_eq!(report.safety.collisions, 0, "{name}");
        assert_eq!(report.debug.map_matches_mirror, Some(true), "{name}");
        let [with, without] = [&report, &clean].map(|it| it.coverage.fraction);
        assert!(with > without - 0.01, "{name}: {with} and {without}");
    }
}

/// Without the option a reset ends the run.
#[test]
fn a_run_that_does_not_resume_ends_with_a_reset() {
    let world = worlds::builtin("hall");
    let line = Flickering {
        device: LocalDevice::new(),
        sent: 0,
        resets: 0,
    };
    let mut link = Endpoint::new(line, RetryPolicy::VIRTUAL, 1);
    let (report, _) = explored(&mission("loopback"), &world, &mut link);
    assert_eq!(report.outcome.reason, "device-reset");
}

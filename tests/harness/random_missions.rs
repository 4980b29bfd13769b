//! Missions drawn at random: world, strategy, fence, the time to go home, pauses, resets of the
//! device and kills of its host.
//!
//! ```text
//! seed ─► Draw ─► run ─ host killed ─► run from the last state ─ … ─► Outcome
//!              └─► the same without resets and kills, to compare
//! ```
//!
//! A kill loses what came after the last state that was kept. A host that goes on gets a device
//! that has just booted.
//!
//! Units: metres, simulated milliseconds.

use core::cell::RefCell;
use core::time::Duration;
use std::rc::Rc;

use host_sim::fence::{Fence, Polygon};
use host_sim::link::LinkError;
use host_sim::link::endpoint::{Endpoint, RetryPolicy};
use host_sim::link::line::Line;
use host_sim::link::loopback::LocalDevice;
use host_sim::report::{MadeBy, Report, Trip};
use host_sim::state::{Keeping, State, Store};
use host_sim::trial::itinerary::{Orders, Pause};
use host_sim::trial::mission::{Mission, OdometryProfile, explore, explore_kept};
use host_sim::trial::{Flow, Moment, Progress, Record, Watch};
use host_sim::world::World;

use crate::fences;
use crate::random::Random;

/// Built-in worlds, and kinds of generated ones.
const WORLDS: [&str; 8] = [
    "office",
    "cave",
    "hall",
    "cluttered",
    "loop",
    "rooms",
    "dungeon",
    "maze",
];
const STRATEGIES: [&str; 4] = ["ouroboros", "tdbvp", "esbpf", "frontier"];
/// Side of a map cell, metres.
const CELL_M: f64 = 0.1;
/// What home means: 0.2 m and 10°.
const HOME: (f64, f64) = (0.2, 10.0);
/// Simulated time after which a mission ends.
const TIME_LIMIT_MS: u32 = 1_200_000;

/// A mission, with what befalls it.
#[derive(Clone, Debug)]
pub struct Draw {
    /// What it was drawn from.
    pub seed: u64,
    /// Its world, by the name that `host-sim explore` takes.
    pub world: String,
    /// Kind of the world: the built-in one's name, or the kind of a generated one.
    pub kind: &'static str,
    mission: Mission,
    /// Frames of the host before which the device loses its power.
    resets: Vec<u32>,
    /// Times at which the host is killed.
    kills_ms: Vec<u32>,
}

/// How a mission ended.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The report.
    pub report: Report,
    /// The report without resets and kills, if there were any.
    pub undisturbed: Option<Report>,
    /// Number of resets and kills that came before the end.
    pub resumed: u32,
}

/// What became of the way home.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Home {
    /// The robot stands there.
    Reached,
    /// The device said that it cannot get there.
    Typed,
    /// Neither.
    Neither,
}

impl Draw {
    /// Draws a mission.
    ///
    /// # Panics
    /// If a world of the list cannot be opened.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        let mut random = Random::mixed(seed.wrapping_add(0x44_0000));
        let kind = WORLDS[random.index(WORLDS.len())];
        let world = match kind {
            "rooms" | "dungeon" | "maze" => format!("{kind}:{}", random.below(1_000)),
            name => name.into(),
        };
        let opened = open(&world);
        // Half of the missions have the usual strategy.
        let strategy = STRATEGIES[(random.index(6)).min(3)];
        let orders = Orders {
            home: true,
            home_at_ms: random.percent(75).then(|| millis(&mut random, 10, 200)),
            pauses: (0..random.below(3)).map(|_| pause(&mut random)).collect(),
            ..Orders::default()
        };
        let mission = Mission {
            strategy: strategy.into(),
            seed,
            odometry: OdometryProfile::Noisy,
            localise: true,
            resumes: true,
            time_limit_ms: TIME_LIMIT_MS,
            fence: fence(&mut random, &opened),
            orders,
            ..Mission::default()
        };
        let mut resets: Vec<u32> = (0..random.below(3))
            .map(|_| random.below(800) as u32)
            .collect();
        let mut kills_ms: Vec<u32> = (0..random.below(3))
            .map(|_| millis(&mut random, 5, 150))
            .collect();
        resets.sort_unstable();
        kills_ms.sort_unstable();
        kills_ms.dedup();
        Self {
            seed,
            world,
            kind,
            mission,
            resets,
            kills_ms,
        }
    }

    /// Makes the mission, with what befalls it, and once without.
    ///
    /// # Panics
    /// If a run cannot begin.
    #[must_use]
    pub fn go(&self) -> Outcome {
        let world = open(&self.world);
        let (report, _, resumed) = self.disturbed(&world);
        let undisturbed = (resumed > 0).then(|| self.undisturbed(&world).0);
        Outcome {
            report,
            undisturbed,
            resumed,
        }
    }

    /// Makes the mission without resets and kills.
    ///
    /// # Panics
    /// If the run cannot begin.
    #[must_use]
    pub fn undisturbed(&self, world: &World) -> (Report, Record) {
        let run = explore(&self.mission, world, &mut device(Vec::new()), &mut ());
        run.unwrap_or_else(|error| panic!("{}: {error}", self.world))
    }

    /// Makes the mission. Returns the last host's report and record, and the number of resets and
    /// kills.
    ///
    /// # Panics
    /// If a run cannot begin, or not go on.
    #[must_use]
    pub fn disturbed(&self, world: &World) -> (Report, Record, u32) {
        let kept: Rc<RefCell<Option<Vec<u8>>>> = Rc::default();
        let (mut killed, mut sent) = (0, 0);
        let kills = self.kills_ms.iter().copied().chain([u32::MAX]);
        for kill_ms in kills {
            let state = kept
                .borrow()
                .as_ref()
                .map(|bytes| State::of_bytes(bytes).unwrap_or_else(|fault| panic!("{fault:?}")));
            let store = Box::new(LastState(Rc::clone(&kept)));
            let mut keeping = Keeping::new(MadeBy::default(), store, state);
            let later = self.resets.iter().filter(|&&at| at >= sent);
            let mut link = device(later.map(|at| at - sent).collect());
            let mut kill = Kill(kill_ms);
            let run = explore_kept(&self.mission, world, &mut link, &mut kill, &mut keeping);
            let (report, record) = run.unwrap_or_else(|error| panic!("{}: {error}", self.world));
            killed += link.line().resets;
            sent += link.line().sent;
            if report.outcome.reason != "user" {
                return (report, record, killed);
            }
            killed += 1;
        }
        unreachable!("the last host is not killed")
    }
}

impl Outcome {
    /// Returns what became of the way home.
    #[must_use]
    pub fn home(&self) -> Home {
        home(&self.report)
    }

    /// Returns the greatest depth of the true hull in what was forbidden, metres; 0 without a
    /// fence.
    #[must_use]
    pub fn deepest_m(&self) -> f64 {
        self.report
            .fence
            .as_ref()
            .map_or(0.0, |fence| fence.deepest_m)
    }

    /// Returns true if the hull was as deep as a cell in what is forbidden, beyond the greatest
    /// error of its pose.
    #[must_use]
    pub fn left_its_bounds(&self) -> bool {
        let drift_m = self.report.localization.max_error_m.unwrap_or(0.0);
        self.deepest_m() >= CELL_M + drift_m
    }

    /// Returns true if a run that was reset or killed went home as the undisturbed one did; `None`
    /// of an undisturbed one.
    #[must_use]
    pub fn ends_alike(&self) -> Option<bool> {
        let other = self.undisturbed.as_ref()?;
        Some(home(other) == self.home())
    }

    /// Returns what is wrong with the mission; empty if nothing is.
    #[must_use]
    pub fn faults(&self) -> Vec<String> {
        let mut faults = Vec::new();
        if self.left_its_bounds() {
            faults.push(format!("{:.2} m deep in the forbidden", self.deepest_m()));
        }
        if self.report.safety.collisions > 0 {
            faults.push(format!("{} touches", self.report.safety.collisions));
        }
        if self.home() != Home::Reached {
            let trip = self.report.trips.iter().rfind(|trip| trip.to == "home");
            let refused = trip
                .and_then(|trip| trip.refused.as_deref())
                .unwrap_or("no");
            let other = self.undisturbed.as_ref().map(home);
            faults.push(format!(
                "not home: {}, refused: {refused}, undisturbed: {other:?}",
                self.report.outcome.reason
            ));
        }
        faults
    }
}

fn home(report: &Report) -> Home {
    let trip = |trip: &&Trip| trip.to == "home";
    let trip = report.trips.iter().rfind(trip);
    let is_there = |trip: &Trip| {
        trip.reached && trip.error_m <= HOME.0 && trip.error_deg.unwrap_or(180.0) <= HOME.1
    };
    match trip {
        Some(trip) if is_there(trip) => Home::Reached,
        _ if report.outcome.reason == "cannot-get-home" => Home::Typed,
        _ => Home::Neither,
    }
}

fn open(name: &str) -> World {
    World::open(name).unwrap_or_else(|error| panic!("{error}"))
}

fn millis(random: &mut Random, least_s: i64, most_s: i64) -> u32 {
    random.between(1_000 * least_s, 1_000 * most_s) as u32
}

fn pause(random: &mut Random) -> Pause {
    let from_ms = millis(random, 1, 120);
    Pause {
        from_ms,
        to_ms: from_ms + millis(random, 1, 20),
    }
}

/// Draws a fence around the world's first start: bounds in three of four cases, and up to three
/// triangles.
fn fence(random: &mut Random, world: &World) -> Fence {
    let polygon =
        |corners: Vec<[f64; 2]>| Polygon::of(&corners).unwrap_or_else(|error| panic!("{error}"));
    fences::around(world, |start| {
        let is_bound = random.percent(75);
        let bounds = is_bound.then(|| polygon(fences::bounds(random, start)));
        let no_go = fences::no_go(random, start).into_iter().map(polygon);
        Fence {
            no_go: no_go.collect(),
            bounds: bounds.into_iter().collect(),
        }
    })
}

/// Keeps the last state that a host kept before it was killed.
struct LastState(Rc<RefCell<Option<Vec<u8>>>>);

impl Store for LastState {
    fn put(&mut self, bytes: &[u8], moment: Moment) -> std::io::Result<()> {
        // A host that is killed keeps nothing at its end.
        if moment == Moment::Step {
            *self.0.borrow_mut() = Some(bytes.to_vec());
        }
        Ok(())
    }

    fn remove(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// Ends a run at a time.
struct Kill(u32);

impl Watch for Kill {
    fn step(&mut self, progress: &Progress) -> Flow {
        match progress.time_ms >= self.0 {
            true => Flow::Interrupt,
            false => Flow::Continue,
        }
    }
}

/// A device that loses its power before some frames.
struct Flickering {
    device: LocalDevice,
    at: Vec<u32>,
    sent: u32,
    resets: u32,
}

impl Line for Flickering {
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        if self.at.contains(&self.sent) && self.sent > 2 {
            self.resets += 1;
            self.device.reboot();
        }
        self.sent += 1;
        self.device.send(bytes)
    }

    fn receive(&mut self, into: &mut Vec<u8>, wait: Duration) -> Result<(), LinkError> {
        self.device.receive(into, wait)
    }

    fn now(&self) -> Duration {
        self.device.now()
    }
}

fn device(resets: Vec<u32>) -> Endpoint<Flickering> {
    let line = Flickering {
        device: LocalDevice::new(),
        at: resets,
        sent: 0,
        resets: 0,
    };
    Endpoint::new(line, RetryPolicy::VIRTUAL, 1)
}

#[cfg(test)]
mod tests {
    use super::Draw;

    #[test]
    fn a_seed_draws_the_same_mission_and_another_one_another() {
        let text = |seed| format!("{:?}", Draw::new(seed));
        assert_eq!(text(3), text(3));
        assert_ne!(text(3), text(4));
        let draws: Vec<Draw> = (0..40).map(Draw::new).collect();
        assert!(
            draws
                .iter()
                .any(|it| !it.resets.is_empty() && !it.kills_ms.is_empty())
        );
        assert!(draws.iter().any(|it| it.mission.fence.bounds.is_empty()));
    }
}

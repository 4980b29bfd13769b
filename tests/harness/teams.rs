//! Explorations by teams, and their tables.
//!
//! Units: simulated seconds, metres, per cent, kilobytes on the air. A *contact* is a touch of two
//! robots, a *hit* one with the world. *After another* is the share of the path that another robot
//! had driven before, *twice* the share of the known ground that more than one robot measured.

mod tables;

use core::ops::Range;

use host_sim::fence::Fence;
use host_sim::link::Link;
use host_sim::link::direct::Direct;
use host_sim::report::TeamReport;
use host_sim::slam::SlamPlace;
use host_sim::trial::mission::{Mission, OdometryProfile};
use host_sim::trial::team::{Appointment, StartError, TeamMission, TeamRecord, Timetable, explore};
use host_sim::world::World;

use crate::digests::Digest;
pub use tables::{
    CONTACTS, Column, END, EQUAL_MAPS, HITS, alignment, by_run, dropouts, speed_up, table,
};

/// A robot that moved less than this stands, metres.
const MOVED_M: f64 = 0.1;

/// One exploration by a team over direct links.
#[derive(Clone, Copy, Debug)]
pub struct TeamRun<'a> {
    /// World to explore.
    pub world: &'a World,
    /// Name of the strategy.
    pub strategy: &'a str,
    /// Number of robots.
    pub robots: usize,
    /// True if they start apart.
    pub apart: bool,
    /// The radio, as on the command line.
    pub radio: &'a str,
    /// Who leaves, as on the command line.
    pub leave: &'a [&'a str],
    /// Who joins again.
    pub join: &'a [&'a str],
    /// Errors of the odometry; the device corrects what drifts.
    pub odometry: OdometryProfile,
    /// Errors of the starts that the robots are told, as on the command line; empty for none.
    pub start_error: &'a str,
    /// Where loops are closed.
    pub slam: SlamPlace,
    /// Where the robots may be; everywhere if `None`.
    pub fence: Option<&'a Fence>,
    /// Seed of the noise.
    pub seed: u64,
}

impl<'a> TeamRun<'a> {
    /// Makes the usual run: `frontier`, side by side, a radio that loses nothing, seed 0.
    #[must_use]
    pub const fn of(world: &'a World, robots: usize) -> Self {
        Self {
            world,
            strategy: "frontier",
            robots,
            apart: false,
            radio: "loss=0",
            leave: &[],
            join: &[],
            odometry: OdometryProfile::Truth,
            start_error: "",
            slam: SlamPlace::Off,
            fence: None,
            seed: 0,
        }
    }

    /// Explores.
    ///
    /// # Panics
    /// If the team cannot begin.
    #[must_use]
    pub fn go(&self) -> TeamReport {
        self.go_recorded().0
    }

    /// Explores; returns the robots' records as well.
    ///
    /// # Panics
    /// If the team cannot begin.
    #[must_use]
    pub fn go_recorded(&self) -> (TeamReport, TeamRecord) {
        let link = |_| -> Box<dyn Link> { Box::new(Direct::new()) };
        self.go_by((0..self.robots).map(link).collect())
    }

    /// Explores over these links, one for each robot.
    ///
    /// # Panics
    /// If the team cannot begin.
    #[must_use]
    pub fn go_by(&self, mut links: Vec<Box<dyn Link>>) -> (TeamReport, TeamRecord) {
        let mission = Mission {
            strategy: self.strategy.into(),
            seed: self.seed,
            odometry: self.odometry,
            localise: self.odometry != OdometryProfile::Truth,
            slam: self.slam,
            fence: self.fence.cloned().unwrap_or_default(),
            ..Mission::default()
        };
        let start_error = match self.start_error {
            "" => StartError::default(),
            error => error.parse().expect("two numbers"),
        };
        let team = TeamMission {
            start_error,
            apart: self.apart,
            radio: self.radio.parse().expect("a radio"),
            timetable: Timetable {
                leave: appointments(self.leave),
                join: appointments(self.join),
            },
            ..TeamMission::of(mission, self.robots)
        };
        match explore(&team, self.world, &mut links, &mut ()) {
            Ok(run) => run,
            Err(error) => panic!("{}: {error}", self.world.name()),
        }
    }

    /// Returns the words that say what differs from a run of one robot.
    #[must_use]
    pub fn settings(&self) -> String {
        let starts = if self.apart { "apart" } else { "beside" };
        let mut words = vec![
            format!("team={}", self.robots),
            starts.into(),
            self.radio.into(),
        ];
        words.extend(self.leave.iter().map(|it| format!("leave={it}")));
        words.extend(self.join.iter().map(|it| format!("join={it}")));
        if self.odometry != OdometryProfile::Truth {
            words.push(self.odometry.name().into());
        }
        if !self.start_error.is_empty() {
            words.push(format!("start={}", self.start_error.replace(',', "/")));
        }
        if self.slam != SlamPlace::Off {
            words.push("slam=host".into());
        }
        if self.strategy != "frontier" {
            words.push(self.strategy.into());
        }
        words.join(",")
    }

    /// Returns the digest of its report.
    #[must_use]
    pub fn digest(&self, report: &TeamReport) -> Digest {
        Digest::of(&report.whole, &self.settings())
    }
}

/// Returns the longest time for which a robot stood while it explored, seconds.
#[must_use]
pub fn longest_stand_s(record: &TeamRecord) -> f64 {
    let robots = record.robots.iter().map(|robot| {
        let mut path = robot.steps.iter().map(|step| step.truth);
        let Some(mut from) = path.next() else {
            return 0;
        };
        let mut longest_ms = 0;
        for at in path {
            if (at.x_m - from.x_m).hypot(at.y_m - from.y_m) > MOVED_M {
                from = at;
            }
            longest_ms = longest_ms.max(at.time_ms - from.time_ms);
        }
        longest_ms
    });
    f64::from(robots.max().unwrap_or(0)) / 1000.0
}

fn appointments(words: &[&str]) -> Vec<Appointment> {
    let parse = |word: &&str| word.parse().expect("an appointment");
    words.iter().map(parse).collect()
}

/// Returns the runs of a speed-up table: each world with each start and radio, one to four robots.
#[must_use]
pub fn groups<'a>(
    worlds: &'a [World],
    strategy: &'a str,
    radios: &[&'a str],
    seeds: &Range<u64>,
) -> Vec<TeamRun<'a>> {
    let starts = [false, true].into_iter();
    let kinds = starts.flat_map(|apart| radios.iter().map(move |radio| (apart, *radio)));
    let kinds: Vec<(bool, &str)> = kinds.collect();
    let mut runs = Vec::new();
    for (world, (apart, radio)) in worlds
        .iter()
        .flat_map(|it| kinds.iter().map(move |k| (it, *k)))
    {
        for robots in 1..=4 {
            runs.extend(seeds.clone().map(|seed| TeamRun {
                strategy,
                apart,
                radio,
                seed,
                ..TeamRun::of(world, robots)
            }));
        }
    }
    runs
}

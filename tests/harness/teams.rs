//! Explorations by teams, and their tables.
//!
//! Units: simulated seconds, metres, per cent, kilobytes on the air. A *contact* is a touch of two
//! robots, a *hit* one with the world. *After another* is the share of the path that another robot
//! had driven before, *twice* the share of the known ground that more than one robot measured.

use core::ops::Range;

use host_sim::link::Link;
use host_sim::link::direct::Direct;
use host_sim::report::TeamReport;
use host_sim::slam::SlamPlace;
use host_sim::trial::mission::{Mission, OdometryProfile};
use host_sim::trial::team::{Appointment, StartError, TeamMission, TeamRecord, Timetable, explore};
use host_sim::world::World;

use crate::digests::Digest;
use crate::table::{Table, number};

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

/// Makes a table with one line for each run.
#[must_use]
pub fn table(runs: &[TeamRun<'_>], reports: &[TeamReport]) -> Table {
    let mut table = Table::new(
        3,
        &[
            "world",
            "team",
            "ended",
            "seed",
            "known %",
            "T90 s",
            "T99 s",
            "end s",
            "path m",
            "after another",
            "twice",
            "hits",
            "contacts",
            "gap m",
            "kB",
            "lost",
            "equal maps",
        ],
    );
    for (run, report) in runs.iter().zip(reports) {
        let whole = &report.whole;
        table.row(vec![
            whole.world.clone(),
            run.settings(),
            format!("{}({})", whole.outcome.status, whole.outcome.reason),
            whole.seed.to_string(),
            format!("{:.2}", whole.coverage.fraction * 100.0),
            number(whole.coverage.t90_s, 1),
            number(whole.coverage.t99_s, 1),
            format!("{:.1}", whole.sim_time_s),
            format!("{:.1}", whole.path_length_m),
            format!("{:.2}", report.team.driven_after_another),
            format!("{:.2}", report.team.measured_twice),
            (whole.safety.collisions + whole.safety.falls + whole.safety.tips).to_string(),
            whole.safety.robot_contacts.unwrap_or(0).to_string(),
            number(report.team.min_robot_gap_m, 3),
            format!("{:.1}", report.radio.traffic.sent_bytes as f64 / 1e3),
            report.radio.traffic.lost.to_string(),
            report
                .team
                .maps_equal
                .map_or("-".into(), |it| it.to_string()),
        ]);
    }
    table
}

const DROPOUT_COLUMNS: [&str; 15] = [
    "world",
    "team",
    "explored",
    "equal maps",
    "least known %",
    "T99 s",
    "end s",
    "at most",
    "stood s",
    "at most",
    "after another",
    "hits",
    "contacts",
    "kB",
    "lost",
];

/// Makes a table with one line for each kind of run, over its seeds; runs of a kind stand together.
///
/// *Stood* is the longest time for which a robot stood while it explored, in the mean and at most.
#[must_use]
pub fn dropouts(runs: &[TeamRun<'_>], ended: &[(TeamReport, TeamRecord)]) -> Table {
    let mut table = Table::new(2, &DROPOUT_COLUMNS);
    let all: Vec<_> = runs.iter().zip(ended).collect();
    let kind = |run: &TeamRun<'_>| (run.world.name().to_owned(), run.settings());
    for same in all.chunk_by(|(a, _), (b, _)| kind(a) == kind(b)) {
        let of = |of: fn(&TeamReport) -> f64| -> Vec<f64> {
            same.iter().map(|(_, (report, _))| of(report)).collect()
        };
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let most = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
        let count = |is: fn(&TeamReport) -> bool| same.iter().filter(|(_, it)| is(&it.0)).count();
        let known = of(|it| it.whole.coverage.fraction);
        let t99_s: Option<Vec<f64>> = same
            .iter()
            .map(|(_, (it, _))| it.whole.coverage.t99_s)
            .collect();
        let end_s = of(|it| it.whole.sim_time_s);
        let stood_s: Vec<f64> = same.iter().map(|(_, it)| longest_stand_s(&it.1)).collect();
        let sum = |values: &[f64]| format!("{:.0}", values.iter().sum::<f64>());
        let (world, settings) = kind(same[0].0);
        table.row(vec![
            world,
            settings,
            format!("{} of {}", count(|it| it.whole.explored()), same.len()),
            count(|it| it.team.maps_equal == Some(true)).to_string(),
            format!("{:.2}", known.iter().copied().fold(1.0, f64::min) * 100.0),
            number(t99_s.map(|times| mean(&times)), 1),
            format!("{:.1}", mean(&end_s)),
            format!("{:.1}", most(&end_s)),
            format!("{:.1}", mean(&stood_s)),
            format!("{:.1}", most(&stood_s)),
            format!("{:.2}", mean(&of(|it| it.team.driven_after_another))),
            sum(&of(|it| it.whole.safety.collisions.into())),
            sum(&of(|it| it.whole.safety.robot_contacts.unwrap_or(0).into())),
            format!(
                "{:.0}",
                mean(&of(|it| it.radio.traffic.sent_bytes as f64 / 1e3))
            ),
            sum(&of(|it| it.radio.traffic.lost as f64)),
        ]);
    }
    table
}

/// Makes a table with one line for each run of robots whose odometry drifts.
///
/// *Met* is when the map of each robot came to lie in the team's coordinates. *Apart* is the error
/// of the motion between two maps after that, in the median and at most, over all pairs and steps.
#[must_use]
pub fn alignment(runs: &[TeamRun<'_>], reports: &[TeamReport]) -> Table {
    let mut table = Table::new(
        3,
        &[
            "world",
            "team",
            "ended",
            "seed",
            "known %",
            "T99 s",
            "end s",
            "met s",
            "apart m",
            "at most",
            "apart deg",
            "at most",
            "hits",
            "contacts",
            "equal maps",
        ],
    );
    for (run, report) in runs.iter().zip(reports) {
        let whole = &report.whole;
        let apart = report.team.agreement;
        let met: Vec<String> = report.robots.iter().map(|it| number(it.met_s, 0)).collect();
        table.row(vec![
            whole.world.clone(),
            run.settings(),
            format!("{}({})", whole.outcome.status, whole.outcome.reason),
            whole.seed.to_string(),
            format!("{:.2}", whole.coverage.fraction * 100.0),
            number(whole.coverage.t99_s, 1),
            format!("{:.1}", whole.sim_time_s),
            met.join("/"),
            number(apart.map(|it| it.median_m), 2),
            number(apart.map(|it| it.max_m), 2),
            number(apart.map(|it| it.median_deg), 2),
            number(apart.map(|it| it.max_deg), 2),
            whole.safety.collisions.to_string(),
            whole.safety.robot_contacts.unwrap_or(0).to_string(),
            report
                .team
                .maps_equal
                .map_or("-".into(), |it| it.to_string()),
        ]);
    }
    table
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

const SPEED_UP_COLUMNS: [&str; 14] = [
    "world",
    "starts",
    "radio",
    "robots",
    "T90 s",
    "speed-up",
    "T99 s",
    "speed-up",
    "path m",
    "after another",
    "twice",
    "hits",
    "contacts",
    "unfinished",
];

/// Makes a table with one line for each world, start, radio and number of robots, over the seeds.
///
/// Runs of one line stand together, and the runs of one robot of a group come first. A *speed-up*
/// is the mean time of one robot over that of the team; it needs the share in every run.
#[must_use]
pub fn speed_up(runs: &[TeamRun<'_>], reports: &[TeamReport]) -> Table {
    let mut table = Table::new(3, &SPEED_UP_COLUMNS);
    let all: Vec<(&TeamRun<'_>, &TeamReport)> = runs.iter().zip(reports).collect();
    let group = |it: &TeamRun<'_>| (it.world.name().to_owned(), it.apart, it.radio.to_owned());
    for same in all.chunk_by(|(a, _), (b, _)| group(a) == group(b)) {
        let mut alone_s = [None; 2];
        for line in same.chunk_by(|(a, _), (b, _)| a.robots == b.robots) {
            let (run, count) = (line[0].0, line.len() as f64);
            let time = |of: fn(&TeamReport) -> Option<f64>| {
                let times: Option<Vec<f64>> = line.iter().map(|(_, it)| of(it)).collect();
                times.map(|times| times.iter().sum::<f64>() / count)
            };
            let times_s = [
                time(|it| it.whole.coverage.t90_s),
                time(|it| it.whole.coverage.t99_s),
            ];
            if run.robots == 1 {
                alone_s = times_s;
            }
            let faster = |k: usize| alone_s[k].zip(times_s[k]).map(|(alone, team)| alone / team);
            let mean =
                |of: fn(&TeamReport) -> f64| line.iter().map(|(_, it)| of(it)).sum::<f64>() / count;
            let sum = |of: fn(&TeamReport) -> u32| line.iter().map(|(_, it)| of(it)).sum::<u32>();
            table.row(vec![
                run.world.name().into(),
                if run.apart { "apart" } else { "beside" }.into(),
                run.radio.into(),
                run.robots.to_string(),
                number(times_s[0], 1),
                number(faster(0), 2),
                number(times_s[1], 1),
                number(faster(1), 2),
                format!("{:.1}", mean(|it| it.whole.path_length_m)),
                format!("{:.2}", mean(|it| it.team.driven_after_another)),
                format!("{:.2}", mean(|it| it.team.measured_twice)),
                sum(|it| it.whole.safety.collisions).to_string(),
                sum(|it| it.whole.safety.robot_contacts.unwrap_or(0)).to_string(),
                sum(|it| u32::from(!it.whole.explored())).to_string(),
            ]);
        }
    }
    table
}

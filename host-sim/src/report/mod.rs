//! What a run leaves behind: `report.json` and the files beside it.
//!
//! The structures here are the schema, field by field and in the order written; `host-sim/README.md` is its prose.
//! Invariant: every number in the file is finite, and `null` stands for "not measured" or "never reached".
//! Units are in the names: `_m` metres, `_m2` square metres, `_s` seconds, `_us` microseconds, `_deg` degrees.

pub mod closures;
pub mod commands;
pub mod folder;
pub mod grid_map;
pub mod ros_map;
pub mod terrain;
mod text;
pub mod tum;

use serde::{Deserialize, Serialize};

pub use crate::link::LinkStats;
pub use closures::{Closures, GivenUp};
pub use grid_map::{GridMap, MapCell};
pub use terrain::Terrain;

/// Version of the schema: it grows by one when a field changes its meaning or goes.
pub const SCHEMA_VERSION: u32 = 1;

/// One run, as `report.json` tells it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// [`SCHEMA_VERSION`].
    pub schema_version: u32,
    /// The world's name: a built-in's, or the file's stem.
    pub world: String,
    /// The strategy that planned.
    pub strategy: String,
    /// The rung of the run, as given to `--link`.
    pub link: String,
    /// Seed of every random number of the run.
    pub seed: u64,
    /// `truth` or `noisy`.
    pub odometry: String,
    /// Index into the world's start poses.
    pub start: usize,
    /// The faults put on the link, as given to `--fault`.
    pub fault: Option<String>,
    /// How the sensors erred.
    pub noise: Noise,
    /// What may surprise about the world file.
    pub notes: Vec<String>,
    /// How it ended.
    pub outcome: Outcome,
    /// Simulated seconds.
    pub sim_time_s: f64,
    /// Metres driven, by the true pose.
    pub path_length_m: f64,
    /// Metres up and down: the sum of the changes of the true height from step to step.
    pub climb_m: f64,
    /// Observations answered.
    pub steps: u64,
    /// What became known, and when.
    pub coverage: Coverage,
    /// Loops that were closed, and how many there are.
    #[serde(flatten)]
    pub loops: Loops,
    /// What the device said of loops; `null` where the strategy closes none.
    pub closures: Option<Closures>,
    /// What became of the rails on patrol; `null` without one.
    pub patrol: Option<Patrol>,
    /// What the true robot suffered.
    pub safety: Safety,
    /// The ground, and how it was driven over; `null` in a flat world.
    pub terrain: Option<Terrain>,
    /// Estimated pose against the true one.
    pub localization: Localization,
    /// What planning cost.
    pub planner: Planner,
    /// The quality of the windows' solutions.
    pub field: Field,
    /// The link's counters, both ends.
    pub link_stats: LinkStats,
    /// 128-bit FNV-1a of the command stream, 32 hexadecimal digits.
    pub digest: String,
    /// Cross-checks of the tool on itself.
    pub debug: Debug,
}

/// How a run ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// `finished`, `fault`, `time-limit`, `frozen` or `interrupted`.
    pub status: String,
    /// Which finish or fault; `explored` is the one that a run is for.
    pub reason: String,
    /// Frontiers that were left, and why each.
    pub residual_frontiers: Vec<ResidualFrontier>,
}

/// A frontier that was left.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ResidualFrontier {
    /// Centre of a cell of it, odometry frame.
    pub x_m: f64,
    /// Centre of a cell of it.
    pub y_m: f64,
    /// Cells in it.
    pub cells: u32,
    /// `unreachable`, `unobservable`, `out-of-bounds` or `no-progress`.
    pub reason: String,
}

/// Standard deviations of what the sensors say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Noise {
    /// Of a laser's range.
    pub laser_m: f64,
    /// Of roll and pitch.
    pub imu_deg: f64,
}

/// What became known of what a disc of the robot's radius could have seen from where it can reach.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Coverage {
    /// `known_m2 / reachable_m2`, at most 1.
    pub fraction: f64,
    /// Area known at the end, of the reachable.
    pub known_m2: f64,
    /// Area that could have been seen.
    pub reachable_m2: f64,
    /// When the fraction first was 0.90.
    pub t90_s: Option<f64>,
    /// When the fraction first was 0.99.
    pub t99_s: Option<f64>,
    /// Share of the path driven over ground that had been driven over before.
    pub overlap: Option<f64>,
}

/// Ways round islands of the world, judged on the true path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Loops {
    /// Islands that the robot went all the way round.
    pub loops_closed: u32,
    /// Islands with a way round of at least 10 m.
    pub loops: u32,
}

/// Ages of the rails on a patrol, judged on the true path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Patrol {
    /// Greatest time that any rail was not visited for, seconds.
    pub oldest_rail_s: f64,
    /// Mean of all rails and steps, seconds.
    pub mean_age_s: f64,
}

/// What the true footprint met in the true world.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Safety {
    /// Times the footprint came to touch an obstacle.
    pub collisions: u32,
    /// Times it lost the ground.
    pub falls: u32,
    /// Times it tipped.
    pub tips: u32,
    /// Least distance from the footprint to an obstacle.
    pub min_clearance_m: Option<f64>,
}

/// Distance between the estimated and the true position.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Localization {
    /// Mean over the steps.
    pub mean_error_m: Option<f64>,
    /// Greatest over the steps.
    pub max_error_m: Option<f64>,
}

/// What planning cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Planner {
    /// Microseconds of a step's round trip on the link, on this host.
    pub wall_us: Option<Percentiles>,
    /// Instructions of a step on the device; `null` where it does not count them.
    pub instructions: Option<Percentiles>,
    /// The same by stages, each over all steps: their greatest need not fall into one step.
    pub stages: Option<Stages>,
    /// Deepest stack of the device; `null` where it does not measure it.
    pub stack_bytes: Option<u32>,
}

/// Instructions of a step's stages.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Stages {
    /// Taking a request apart, and putting the reply before it together.
    pub session: Percentiles,
    /// Scans and odometry into the map.
    pub sense: Percentiles,
    /// An instalment of the skeleton.
    pub topology: Percentiles,
    /// The wave over a new skeleton, and the road.
    pub plan: Percentiles,
    /// The window's cells and boundary.
    pub window: Percentiles,
    /// The window's field.
    pub solve: Percentiles,
    /// Descent, drive, and the search for a manoeuvre.
    pub drive: Percentiles,
}

impl Stages {
    /// The stages by name, in the order of a step.
    #[must_use]
    pub const fn by_name(&self) -> [(&'static str, Percentiles); 7] {
        [
            ("session", self.session),
            ("sense", self.sense),
            ("topology", self.topology),
            ("plan", self.plan),
            ("window", self.window),
            ("solve", self.solve),
            ("drive", self.drive),
        ]
    }
}

/// Nearest-rank percentiles of the steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Percentiles {
    /// Half of the steps are at or below.
    pub p50: f64,
    /// 99 of 100 steps are at or below.
    pub p99: f64,
    /// The greatest.
    pub max: f64,
}

/// The quality of the windows' solutions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Field {
    /// Greatest angle between a step's heading and that of the converged window; `null` without `--check-field`.
    pub worst_heading_error_deg: Option<f64>,
    /// The same angle over all compared steps.
    pub heading_error_deg: Option<Percentiles>,
    /// Steps whose solver ran out of budget.
    pub budget_exhausted: u64,
}

/// Cross-checks of the tool on itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Debug {
    /// The map read over the link is cell for cell the one that the host kept from the same observations; `null` where
    /// either is missing.
    pub map_matches_mirror: Option<bool>,
    /// Windows that `--check-field` compared.
    pub checked_windows: u64,
}

impl Report {
    /// The file's text: indented JSON and a newline.
    #[must_use]
    pub fn to_json_pretty(&self) -> String {
        let mut text = serde_json::to_string_pretty(self).unwrap_or_default();
        text.push('\n');
        text
    }

    /// The report on one line, without a newline.
    #[must_use]
    pub fn to_json_line(&self) -> String {
        serde_json::to_string(self).unwrap_or_default()
    }

    /// Whether the run did what it was for.
    #[must_use]
    pub fn explored(&self) -> bool {
        self.outcome.status == "finished" && self.outcome.reason == "explored"
    }
}

impl Percentiles {
    /// Of `samples` in any order; `None` of none.
    ///
    /// Nearest rank: the p-th percentile of n samples is the ⌈p·n⌉-th smallest.
    #[must_use]
    pub fn of(samples: &[f64]) -> Option<Self> {
        let mut sorted = samples.to_vec();
        sorted.sort_by(f64::total_cmp);
        let rank = |per_cent: usize| (sorted.len() * per_cent).div_ceil(100).saturating_sub(1);
        Some(Self {
            p50: *sorted.get(rank(50))?,
            p99: *sorted.get(rank(99))?,
            max: *sorted.last()?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{Percentiles, Report};

    /// A report with a value of each kind in it.
    pub(crate) fn sample() -> Report {
        serde_json::from_str(include_str!("sample.json")).expect("the sample fits the schema")
    }

    #[test]
    fn percentiles_are_nearest_rank() {
        let hundred: Vec<f64> = (1..=100).rev().map(f64::from).collect();
        let p = Percentiles::of(&hundred).unwrap();
        assert_eq!((p.p50, p.p99, p.max), (50.0, 99.0, 100.0));
        let one = Percentiles::of(&[7.0]).unwrap();
        assert_eq!((one.p50, one.p99, one.max), (7.0, 7.0, 7.0));
        assert_eq!(Percentiles::of(&[]), None);
    }

    #[test]
    fn the_file_keeps_the_documented_names_and_order() {
        assert_eq!(sample().to_json_pretty(), include_str!("sample.json"));
    }

    #[test]
    fn a_line_is_one_line_and_says_the_same() {
        let line = sample().to_json_line();
        assert!(!line.contains('\n'));
        assert_eq!(serde_json::from_str::<Report>(&line).unwrap(), sample());
    }

    #[test]
    fn what_is_not_finite_is_null() {
        let mut report = sample();
        report.safety.min_clearance_m = Some(f64::INFINITY);
        report.coverage.fraction = f64::NAN;
        let value: serde_json::Value = serde_json::from_str(&report.to_json_line()).unwrap();
        assert!(value["safety"]["min_clearance_m"].is_null());
        assert!(value["coverage"]["fraction"].is_null());
    }

    #[test]
    fn only_finished_explored_counts_as_explored() {
        let mut report = sample();
        assert!(report.explored());
        report.outcome.reason = "boxed-in".into();
        assert!(!report.explored());
    }
}

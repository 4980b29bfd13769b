//! The files that a run leaves: `report.json` and those beside it.
//!
//! The structures here and in `outcome`, `settings`, `measures` and `cost` are the schema of
//! `report.json`, field by field and in this order; `host-sim/README.md` describes it in prose.
//! Invariant: every number in the file is finite, and `null` stands for "not measured" or "never
//! reached". Units are in the names: `_m` metres, `_m2` square metres, `_s` seconds, `_us`
//! microseconds, `_deg` degrees.

pub mod commands;
mod cost;
pub mod folder;
pub mod grid_map;
mod input_faults;
mod localization;
pub mod loop_closing;
pub mod made_by;
mod measures;
pub mod mission_log;
mod outcome;
pub mod ros_map;
mod settings;
pub mod team;
mod text;
pub mod true_ground;
pub mod tum;

use serde::{Deserialize, Serialize};

use crate::slam::SlamReport;
use crate::slam::particles::ParticleReport;

pub use crate::link::LinkStats;
pub use crate::network::Counters;
pub use cost::{Debug, Field, Percentiles, Planner, Stages};
pub use grid_map::{GridMap, MapCell};
pub use input_faults::InputFaults;
pub use localization::{Localization, QualityShares};
pub use loop_closing::{GivenUp, LoopClosing};
pub use made_by::MadeBy;
pub use measures::{Coverage, Loops, MapErrors, Patrol, Safety, WallError};
pub use outcome::{LiveRequest, Outcome, ResidualFrontier, Trip};
pub use settings::{Fence, Known, Noise, Relaxation, SpaceField};
pub use team::TeamReport;
pub use true_ground::TrueGround;

/// Version of the schema. It grows by one when a key changes its name or meaning, or goes.
pub const SCHEMA_VERSION: u32 = 3;

/// One run, as in `report.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// [`SCHEMA_VERSION`].
    pub schema_version: u32,
    /// Name of the world: a built-in one, a generated one with its seed, or the file's stem.
    pub world: String,
    /// Strategy that planned.
    pub strategy: String,
    /// Ground that the planner expected: `flat` or `uneven`.
    pub ground: String,
    /// Preferences of the field on uneven ground: `off`, `height`, `global` or `both`.
    pub preference: Option<String>,
    /// True if goals on other height levels cost more; `null` on flat ground and for baselines.
    pub levels: Option<bool>,
    /// Seconds without a new place after which strategy tdbvp follows a path, or `never`; `null`
    /// for other strategies.
    pub tdbvp_impatience: Option<String>,
    /// Order in which frontiers were taken: `gain` or `nearest`; `null` for baselines.
    #[serde(default)]
    pub order: Option<String>,
    /// Least gain of a trip, square metres for each metre; `null` without the order `gain`.
    #[serde(default)]
    pub worth: Option<f64>,
    /// Area, target and impatience of strategies sbpf and esbpf; `null` for other strategies.
    pub space_field: Option<SpaceField>,
    /// What the device knew before its first step; the key is missing if that was nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub known: Option<Known>,
    /// Where the robot had to stay; the key is missing if it might be everywhere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fence: Option<Fence>,
    /// Drives by order after the exploration; the key is missing without any.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub trips: Vec<Trip>,
    /// What viewers of the live page asked of the device; the key is missing without any. The
    /// command line does not make such a run again.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub live_requests: Vec<LiveRequest>,
    /// How strategy bvp-papers relaxes its potential; the key is missing for other strategies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub relaxation: Option<Relaxation>,
    /// Link to the planner, as given to `--link`.
    pub link: String,
    /// Version, command line and options; the key is missing for a run of a program or a campaign.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub made_by: Option<MadeBy>,
    /// Seed of every random number of the run.
    pub seed: u64,
    /// `truth` or `noisy`.
    pub odometry: String,
    /// Index into the world's start poses.
    pub start: usize,
    /// Faults put on the link, as given to `--fault`.
    pub injected_faults: Option<String>,
    /// Name of the robot, its file's or its preset's; the key is missing for the usual one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub robot_name: Option<String>,
    /// Faults of wheels and lasers, as given to `--disturb`; the key is missing without any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub disturbances: Option<String>,
    /// Wiring mistakes, as given to `--miswire`; the key is missing without any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub miswiring: Option<String>,
    /// Number of people who walk about, as given to `--people`; the key is missing without any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub people: Option<usize>,
    /// Noise of the sensors.
    pub noise: Noise,
    /// Remarks on the world file.
    pub world_notes: Vec<String>,
    /// End of the run.
    pub outcome: Outcome,
    /// The last changes of what the robot did, and why; the key is missing for baselines.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub mission: Vec<mission_log::Entry>,
    /// Simulated seconds.
    pub sim_time_s: f64,
    /// Length of the true path, metres.
    pub path_length_m: f64,
    /// Share of the path that the robot had driven before.
    pub path_overlap: Option<f64>,
    /// Sum of the changes of the true height, up and down, from step to step, metres.
    pub height_change_m: f64,
    /// Observations answered.
    pub steps: u64,
    /// Ground known, and when.
    pub coverage: Coverage,
    /// Loops of the world that the true path closed.
    pub loops: Loops,
    /// Loops that the device reported; `null` if the strategy closes none.
    pub loop_closing: Option<LoopClosing>,
    /// Ages of the rails on patrol; `null` without a patrol.
    pub patrol: Option<Patrol>,
    /// Contacts of the true robot.
    pub safety: Safety,
    /// The true ground, and the drive over it; `null` in a flat world.
    pub true_ground: Option<TrueGround>,
    /// The pose that the planner took for the true one.
    pub localization: Localization,
    /// The map's walls against the true ones; `null` without a map, and in an uneven world.
    pub map: Option<MapErrors>,
    /// Cost of planning.
    pub planner: Planner,
    /// Quality of the windows' solutions.
    pub field: Field,
    /// Counters of the link, both ends.
    pub link_stats: LinkStats,
    /// Observations that the device found wrong.
    #[serde(default)]
    pub input_faults: InputFaults,
    /// 128-bit FNV-1a of the command stream, 32 hexadecimal digits.
    pub digest: String,
    /// Cross-checks of the simulator.
    pub debug: Debug,
    /// Datagrams of a team of processes; the key is missing without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub network: Option<Counters>,
    /// What became of the loops that a pose graph closed; the key is missing without `--slam`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slam: Option<SlamReport>,
    /// What a particle filter beside the run told; the key is missing without `--particles`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub particles: Option<ParticleReport>,
}

impl Report {
    /// Returns the text of the file: indented JSON and a newline.
    #[must_use]
    pub fn to_json_pretty(&self) -> String {
        json_pretty(self)
    }

    /// Returns the report on one line, without a newline.
    #[must_use]
    pub fn to_json_line(&self) -> String {
        json_line(self)
    }

    /// Returns true if everything is explored, or the target coverage of an area is reached.
    #[must_use]
    pub fn explored(&self) -> bool {
        let reason = self.outcome.reason.as_str();
        self.outcome.status == "finished" && matches!(reason, "explored" | "covered")
    }
}

/// Returns indented JSON and a newline. Reports hold only what JSON can, so there is always a text.
fn json_pretty(report: &impl Serialize) -> String {
    let mut text = serde_json::to_string_pretty(report).unwrap_or_default();
    text.push('\n');
    text
}

/// Returns JSON on one line, without a newline.
pub(crate) fn json_line(report: &impl Serialize) -> String {
    serde_json::to_string(report).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::Report;

    /// Returns a report with a value of each kind.
    pub(crate) fn sample() -> Report {
        serde_json::from_str(include_str!("sample.json")).expect("the sample fits the schema")
    }

    #[test]
    fn the_file_keeps_the_documented_names_and_order() {
        assert_eq!(sample().to_json_pretty(), include_str!("sample.json"));
    }

    #[test]
    fn a_line_is_one_line_with_the_same_content() {
        let line = sample().to_json_line();
        assert!(!line.contains('\n'));
        assert_eq!(serde_json::from_str::<Report>(&line).unwrap(), sample());
    }

    #[test]
    fn numbers_that_are_not_finite_are_null() {
        let mut report = sample();
        report.safety.min_clearance_m = Some(f64::INFINITY);
        report.coverage.fraction = f64::NAN;
        let value: serde_json::Value = serde_json::from_str(&report.to_json_line()).unwrap();
        assert!(value["safety"]["min_clearance_m"].is_null());
        assert!(value["coverage"]["fraction"].is_null());
    }

    #[test]
    fn only_explored_and_covered_are_successes() {
        let mut report = sample();
        assert!(report.explored());
        report.outcome.reason = "covered".into();
        assert!(report.explored());
        report.outcome.reason = "boxed-in".into();
        assert!(!report.explored());
    }
}

//! The files that a run leaves: `report.json` and those beside it.
//!
//! The structures here are the schema of `report.json`, field by field and in this order;
//! `host-sim/README.md` describes it in prose. Invariant: every number in the file is finite, and
//! `null` stands for "not measured" or "never reached". Units are in the names: `_m` metres, `_m2`
//! square metres, `_s` seconds, `_us` microseconds, `_deg` degrees.

pub mod commands;
pub mod folder;
pub mod grid_map;
mod input_faults;
mod localization;
pub mod loop_closing;
pub mod made_by;
pub mod mission_log;
pub mod ros_map;
pub mod team;
mod text;
pub mod true_ground;
pub mod tum;

use serde::{Deserialize, Serialize};

use crate::slam::SlamReport;
use crate::slam::particles::ParticleReport;

pub use crate::link::LinkStats;
pub use crate::network::Counters;
pub use grid_map::{GridMap, MapCell};
pub use input_faults::InputFaults;
pub use localization::{Localization, QualityShares};
pub use loop_closing::{GivenUp, LoopClosing};
pub use made_by::MadeBy;
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

/// A drive by order after the exploration.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Trip {
    /// `home` or `goal`.
    pub to: String,
    /// The place, odometry frame.
    pub to_m: [f64; 2],
    /// True if the device said that the robot arrived.
    pub reached: bool,
    /// The device's reason if it refused the order.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub refused: Option<String>,
    /// Distance from the place at the end, by the pose that the device took for the true one.
    pub error_m: f64,
    /// Difference from the first heading at the end, by that pose; the key is missing for a goal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error_deg: Option<f64>,
    /// Distance of the true robot from the place at the end.
    pub true_error_m: f64,
    /// Where the robot stood at the end, by its own pose.
    pub stands_m: [f64; 2],
    /// Simulated seconds of the drive.
    pub time_s: f64,
}

/// A request of a viewer, and what became of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LiveRequest {
    /// Simulated time, seconds.
    pub time_s: f64,
    /// `pause`, `resume`, `stop`, `home`, `explore` or `go to X,Y`.
    pub request: String,
    /// The status that the device answered, or why it refused.
    pub answer: String,
    /// True if it was done.
    pub done: bool,
}

/// Bounds and no-go polygons, and whether the robot kept to them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fence {
    /// Corners of the polygons that the robot had to stay inside, world frame.
    pub bounds_m: Vec<Vec<[f64; 2]>>,
    /// Corners of the polygons that the robot had to stay out of.
    pub no_go_m: Vec<Vec<[f64; 2]>>,
    /// Greatest depth of the true hull in what was forbidden, metres.
    pub deepest_m: f64,
}

/// The relaxation of a stored potential.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Relaxation {
    /// Sweeps of the whole grid in each step.
    pub sweeps: u16,
    /// Type of the stored values: `f32` or `f64`.
    pub precision: String,
}

/// The parameters of a space-based potential field.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpaceField {
    /// Least x and y, width and height of the area, world frame.
    pub area_m: [f64; 4],
    /// Share of the area whose coverage ends the exploration.
    pub until: f64,
    /// Seconds without a newly covered cell after which the robot follows a path, or `never`.
    pub impatience: String,
}

/// End of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// `finished`, `fault`, `lost`, `time-limit`, `frozen` or `interrupted`.
    pub status: String,
    /// Kind of finish or fault. Only `explored` and `covered` are successes.
    pub reason: String,
    /// What the device lost when it rebooted: `map`, `pose`, `strategy`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub lost: Vec<String>,
    /// Frontiers left at the end.
    pub residual_frontiers: Vec<ResidualFrontier>,
}

/// A frontier left at the end.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ResidualFrontier {
    /// Centre of one of its cells, odometry frame.
    pub x_m: f64,
    /// Centre of one of its cells.
    pub y_m: f64,
    /// Number of its cells.
    pub cells: u32,
    /// `unreachable`, `unobservable`, `out-of-bounds`, `no-progress` or `not-worth-it`.
    pub reason: String,
}

/// Standard deviations of the sensors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Noise {
    /// Of a laser's range.
    pub laser_m: f64,
    /// Of roll and pitch.
    pub imu_deg: f64,
}

/// Ground known, as a share of the ground that a disc of the robot's radius can see from where it
/// can go.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Coverage {
    /// `known_m2 / explorable_m2`, at most 1.
    pub fraction: f64,
    /// Area known at the end, of the explorable.
    pub known_m2: f64,
    /// Area that can be seen; in an uneven world the area that the robot can cover.
    pub explorable_m2: f64,
    /// First time at which the fraction was 0.90.
    pub t90_s: Option<f64>,
    /// First time at which the fraction was 0.95.
    pub t95_s: Option<f64>,
    /// First time at which the fraction was 0.99.
    pub t99_s: Option<f64>,
}

/// Loops of the world that the robot drove, judged on its true path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Loops {
    /// Islands of the world with a way round them of at least 10 m.
    pub islands: u32,
    /// Islands that the robot drove round completely.
    pub circled: u32,
}

/// Ages of the rails on a patrol, judged on the true path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Patrol {
    /// Longest time for which a rail was not visited, seconds.
    pub max_rail_age_s: f64,
    /// Mean over all rails and steps, seconds.
    pub mean_rail_age_s: f64,
}

/// Contacts of the true footprint with the true world.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Safety {
    /// Number of times that the footprint began to touch an obstacle.
    pub collisions: u32,
    /// Number of times that a wheel lost the ground.
    pub falls: u32,
    /// Number of times that the robot tipped over.
    pub tips: u32,
    /// Least distance from the footprint to an obstacle.
    pub min_clearance_m: Option<f64>,
    /// Number of times that two robots of a team began to touch; the key is missing for a robot
    /// alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub robot_contacts: Option<u32>,
    /// Number of times that the robot began to touch a person; the key is missing without people.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub person_contacts: Option<u32>,
    /// Least distance from the footprint to a person, at most 1 m; the key is missing without
    /// people.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min_person_gap_m: Option<f64>,
}

/// The map's obstacle cells against the true surfaces, after the best rigid alignment of the map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MapErrors {
    /// Distance of an obstacle cell to a true surface; `null` for a map without obstacles.
    pub wall_error_m: Option<WallError>,
    /// Share of the obstacle cells farther than 0.3 m from every true surface.
    pub ghost_share: f64,
    /// Share of the true walls around the floor that have an obstacle cell within 0.3 m.
    #[serde(default)]
    pub walls_share: Option<f64>,
}

/// Percentiles of the distance of an obstacle cell to a true surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WallError {
    /// The median.
    pub p50: f64,
    /// 95 of 100 cells are at or below it.
    pub p95: f64,
}

/// Cost of planning.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Planner {
    /// Time from sending an observation to the command, on this host, microseconds.
    pub round_trip_us: Option<Percentiles>,
    /// Instructions of a step on the device; `null` if it does not count them.
    pub instructions: Option<Percentiles>,
    /// Instructions of each stage. The maxima of two stages may come from different steps.
    pub stage_instructions: Option<Stages>,
    /// Cycles of a step on the chip, by the model; `null` if nothing models them.
    #[serde(default)]
    pub cycles: Option<Percentiles>,
    /// The same in milliseconds at the clock of the chip.
    #[serde(default)]
    pub ms: Option<Percentiles>,
    /// Cycles of each stage, by the model.
    #[serde(default)]
    pub stage_cycles: Option<Stages>,
    /// Deepest stack of the device; `null` if it does not measure it.
    pub stack_bytes: Option<u32>,
}

/// Instructions or cycles of a step's stages. The maxima of two stages may come from different
/// steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Stages {
    /// Decodes the request; encodes the reply to the request before it.
    pub session: Percentiles,
    /// Enters scans and odometry into the map.
    pub sense: Percentiles,
    /// Thins one share of the skeleton.
    pub topology: Percentiles,
    /// Runs the wavefront over a new skeleton, and searches the path.
    pub plan: Percentiles,
    /// Sets the window's cells and boundary.
    pub window: Percentiles,
    /// Solves the window's field.
    pub solve: Percentiles,
    /// Descends the field, drives, and searches for a recovery.
    pub drive: Percentiles,
}

impl Stages {
    /// Returns the percentiles of each stage over the steps, of which `parts` returns the stages;
    /// `None` without steps.
    #[must_use]
    pub fn over<T>(steps: &[T], parts: fn(&T) -> [u32; 7]) -> Option<Self> {
        let stage = |i: usize| {
            let of: Vec<f64> = steps.iter().map(|step| f64::from(parts(step)[i])).collect();
            Percentiles::of(&of)
        };
        Some(Self {
            session: stage(0)?,
            sense: stage(1)?,
            topology: stage(2)?,
            plan: stage(3)?,
            window: stage(4)?,
            solve: stage(5)?,
            drive: stage(6)?,
        })
    }

    /// Returns the stages with their names, in the order of a step.
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

/// Nearest-rank percentiles over the steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Percentiles {
    /// Half of the steps are at or below it.
    pub p50: f64,
    /// 99 of 100 steps are at or below it.
    pub p99: f64,
    /// The greatest.
    pub max: f64,
}

/// Quality of the windows' solutions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Field {
    /// Angle between a step's heading and that of the converged window; `null` without
    /// `--check-field`.
    pub heading_error_deg: Option<Percentiles>,
    /// Windows that `--check-field` compared.
    pub checked_windows: u64,
    /// Steps in which the solver's budget ended before it converged.
    pub budget_exhausted_steps: u64,
}

/// Cross-checks of the simulator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Debug {
    /// True if the map read over the link equals the host's copy, cell for cell; `null` if either
    /// is missing.
    pub map_matches_mirror: Option<bool>,
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

impl Percentiles {
    /// Returns the percentiles of `samples`, which may be in any order; `None` if there are none.
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

    /// Returns a report with a value of each kind.
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

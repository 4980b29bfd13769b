//! The record of a run: every step, and the data read from the device at the end.

use std::collections::BTreeMap;

use fieldline_cycles::milliseconds;
use fieldline_protocol::message::{
    Command, Cost, Observation, Pose, Quality, ResidualFrontier, Tile,
};
use fixed::types::I16F16;

use super::corrector::Corrected;
use super::planned_path::PlannedPath;
use super::relief::Relief;
use super::snapshot::{Snapshot, Window};
use super::{Ending, Progress, wording};
use crate::link::cycles::StepCost;
use crate::link::digest::Digest;
use crate::link::{LinkError, LinkStats};
use crate::metrics::GroundTruth;
use crate::report::loop_closing::{LoopClosing, LoopStatus};
use crate::report::tum::Stamped;
use crate::report::{self, GridMap, Percentiles, Stages};

/// One step.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// The pose that the planner takes for the true one: its own location, or odometry's.
    pub estimate: Stamped,
    /// The true pose.
    pub truth: Stamped,
    /// The command.
    pub command: Command,
    /// Microseconds from observation to command.
    pub round_trip_us: f64,
    /// What the step took on the chip by the model of its cycles, where there is one.
    pub cycles: Option<StepCost>,
}

/// The record of a run.
#[derive(Clone, Debug)]
pub struct Record {
    /// End of the run.
    pub ending: Ending,
    /// Every answered observation.
    pub steps: Vec<Step>,
    /// Number of the first steps whose answers were kept from before the run went on.
    pub replayed: usize,
    /// Fraction known after the last step.
    pub coverage: f64,
    /// Length of the true path, metres.
    pub path_m: f64,
    /// Sum of the changes of the true height from step to step, metres.
    pub height_change_m: f64,
    /// Digest of the commands so far.
    pub digest: Digest,
    /// The device's map.
    pub map: GridMap,
    /// The device's map, as sent.
    pub tiles: BTreeMap<(i16, i16), Tile>,
    /// The last window's field.
    pub window: Option<Window>,
    /// The planner's path at the end.
    pub planned_path: PlannedPath,
    /// Heights and preferences in the window; `None` on flat ground.
    pub relief: Option<Relief>,
    /// Residual frontiers.
    pub frontiers: Vec<ResidualFrontier>,
    /// Drives by order after the exploration.
    pub trips: Vec<report::Trip>,
    /// Requests of whoever watched the run.
    pub live_requests: Vec<report::LiveRequest>,
    /// Map and window during the run, for pictures.
    pub snapshots: Vec<Snapshot>,
    /// Map and window before and after the largest corrections of the map, for pictures.
    pub corrections: Vec<Corrected>,
    /// The path as closed loops corrected it; empty if none are closed.
    pub corrected: Vec<Stamped>,
    /// The true ground, in an uneven world.
    pub ground: Option<GroundTruth>,
    /// Angles between headings and those of converged windows, with `check_field`.
    pub heading_errors_deg: Vec<f64>,
    /// Counters of the link, both ends.
    pub link_stats: LinkStats,
    /// Reason why map and window could not be read, if so.
    pub read_out_error: Option<LinkError>,
}

impl Default for Record {
    fn default() -> Self {
        Self {
            ending: Ending::Interrupted,
            steps: Vec::new(),
            replayed: 0,
            coverage: 0.0,
            path_m: 0.0,
            height_change_m: 0.0,
            digest: Digest::default(),
            map: GridMap::default(),
            tiles: BTreeMap::new(),
            window: None,
            planned_path: PlannedPath::default(),
            relief: None,
            frontiers: Vec::new(),
            trips: Vec::new(),
            live_requests: Vec::new(),
            snapshots: Vec::new(),
            corrections: Vec::new(),
            corrected: Vec::new(),
            ground: None,
            heading_errors_deg: Vec::new(),
            link_stats: LinkStats::default(),
            read_out_error: None,
        }
    }
}

impl Step {
    /// Makes a step from an observation and its command.
    #[must_use]
    pub fn new(
        observation: &Observation,
        truth: Stamped,
        command: Command,
        round_trip_us: f64,
    ) -> Self {
        let pose = match command.location {
            Some(at) => Pose {
                x: at.x,
                y: at.y,
                yaw: at.yaw,
                ..observation.pose
            },
            None => observation.pose,
        };
        Self {
            estimate: stamped(observation.time_ms, &pose),
            truth,
            command,
            round_trip_us,
            cycles: None,
        }
    }
}

impl Step {
    /// Takes the map's pose of a robot that stands. Its device says none then.
    pub(super) fn carry(&mut self, pose: Option<fieldline_planner::geometry::Pose>) {
        if let Some(pose) = pose {
            self.estimate.x_m = pose.x_m.into();
            self.estimate.y_m = pose.y_m.into();
            self.estimate.yaw_rad = pose.yaw_rad.into();
        }
    }
}

/// Converts a pose of the wire.
#[must_use]
pub fn stamped(time_ms: u32, pose: &Pose) -> Stamped {
    Stamped {
        time_ms,
        x_m: pose.x.to_num(),
        y_m: pose.y.to_num(),
        z_m: pose.z.to_num(),
        roll_rad: pose.roll.to_num(),
        pitch_rad: pose.pitch.to_num(),
        yaw_rad: pose.yaw.to_num(),
    }
}

/// Converts a pose back to the wire's. Exact for a pose that came from there.
#[must_use]
pub fn unstamped(pose: &Stamped) -> Pose {
    Pose {
        x: I16F16::saturating_from_num(pose.x_m),
        y: I16F16::saturating_from_num(pose.y_m),
        z: I16F16::saturating_from_num(pose.z_m),
        roll: I16F16::saturating_from_num(pose.roll_rad),
        pitch: I16F16::saturating_from_num(pose.pitch_rad),
        yaw: I16F16::saturating_from_num(pose.yaw_rad),
    }
}

impl Record {
    /// Adds a step and the coverage after it.
    pub fn push(&mut self, step: Step, coverage: f64) {
        if let Some(last) = self.steps.last() {
            let (dx, dy) = (
                step.truth.x_m - last.truth.x_m,
                step.truth.y_m - last.truth.y_m,
            );
            self.path_m += dx.hypot(dy);
            self.height_change_m += (step.truth.z_m - last.truth.z_m).abs();
        }
        self.digest.add(&step.command);
        self.coverage = coverage;
        self.steps.push(step);
    }

    /// Returns the progress after the last step.
    #[must_use]
    pub fn progress(&self) -> Progress {
        let last = self.steps.last();
        Progress {
            time_ms: last.map_or(0, |step| step.truth.time_ms),
            coverage: self.coverage,
            path_m: self.path_m,
            estimate: last.map_or_else(Stamped::default, |step| step.estimate),
            command: last.map_or_else(Command::default, |step| step.command),
        }
    }

    /// Returns the report's part on the end.
    #[must_use]
    pub fn outcome(&self) -> report::Outcome {
        let residual = |frontier: &ResidualFrontier| report::ResidualFrontier {
            x_m: centre_m(frontier.x),
            y_m: centre_m(frontier.y),
            cells: u32::from(frontier.cells),
            reason: wording::residual(frontier.reason).into(),
        };
        report::Outcome {
            status: self.ending.status().into(),
            reason: self.ending.reason().into(),
            lost: self.ending.lost().iter().map(|&it| it.into()).collect(),
            residual_frontiers: self.frontiers.iter().map(residual).collect(),
        }
    }

    /// Returns the report's part on loops that the device reported.
    #[must_use]
    pub fn loop_closing(&self) -> LoopClosing {
        LoopClosing::of(self.steps.iter().map(|step| {
            let (estimate, loops) = (step.estimate, step.command.loops);
            LoopStatus {
                time_s: f64::from(estimate.time_ms) / 1000.0,
                at_m: [estimate.x_m, estimate.y_m],
                closing: loops.closing,
                closed: loops.closed,
                given_up: loops.given_up,
            }
        }))
    }

    /// Returns the report's part on the pose that the planner took for the true one.
    #[must_use]
    pub fn localization(&self) -> report::Localization {
        let error = |s: &Step| (s.estimate.x_m - s.truth.x_m).hypot(s.estimate.y_m - s.truth.y_m);
        let errors: Vec<f64> = self.steps.iter().map(error).collect();
        let steps = errors.len() as f64;
        let located = self.steps.iter().filter_map(|step| step.command.location);
        let qualities: Vec<Quality> = located.map(|location| location.quality).collect();
        report::Localization {
            corrected: !qualities.is_empty(),
            mean_error_m: (steps > 0.0).then(|| errors.iter().sum::<f64>() / steps),
            max_error_m: errors.iter().copied().reduce(f64::max),
            end_error_m: errors.last().copied(),
            quality: (!qualities.is_empty()).then(|| report::QualityShares::of(&qualities)),
        }
    }

    /// Returns the report's part on observations that were not as they should be.
    #[must_use]
    pub fn input_faults(&self) -> report::InputFaults {
        report::InputFaults::of(self.steps.iter().map(|step| &step.command))
    }

    /// Returns the report's part on cost.
    #[must_use]
    pub fn planner(&self) -> report::Planner {
        let live = self.steps.iter().skip(self.replayed);
        let round_trips: Vec<f64> = live.map(|step| step.round_trip_us).collect();
        let costs = self.steps.iter().map(|step| step.command.cost);
        let counted: Vec<Cost> = costs.clone().filter(|cost| cost.instructions > 0).collect();
        let instructions: Vec<f64> = counted.iter().map(|it| it.instructions.into()).collect();
        let by_stage = |cost: &Cost| {
            let it = cost.stages;
            [
                it.session,
                it.sense,
                it.topology,
                it.plan,
                it.window,
                it.solve,
                it.drive,
            ]
        };
        let modelled: Vec<StepCost> = self.steps.iter().filter_map(|step| step.cycles).collect();
        let cycles: Vec<f64> = modelled.iter().map(|cost| cost.cycles() as f64).collect();
        let ms: Vec<f64> = cycles.iter().map(|&it| milliseconds(it)).collect();
        report::Planner {
            round_trip_us: Percentiles::of(&round_trips),
            instructions: Percentiles::of(&instructions),
            stage_instructions: Stages::over(&counted, by_stage),
            cycles: Percentiles::of(&cycles),
            ms: Percentiles::of(&ms),
            stage_cycles: Stages::over(&modelled, |cost| cost.stages.map(|stage| stage.cycles)),
            stack_bytes: costs
                .map(|cost| cost.stack_bytes)
                .max()
                .filter(|&bytes| bytes > 0),
        }
    }

    /// Returns the report's part on the windows.
    #[must_use]
    pub fn field(&self) -> report::Field {
        let exhausted = |step: &&Step| step.command.cost.budget_exhausted;
        report::Field {
            heading_error_deg: Percentiles::of(&self.heading_errors_deg),
            checked_windows: self.heading_errors_deg.len() as u64,
            budget_exhausted_steps: self.steps.iter().filter(exhausted).count() as u64,
        }
    }
}

fn centre_m(cell: i16) -> f64 {
    // Rounded, so that the file has 3.05 instead of 3.0500000000000003.
    ((f64::from(cell) + 0.5) * 100.0 * report::grid_map::CELL_M).round() / 100.0
}

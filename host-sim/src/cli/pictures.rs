//! The pictures of a run: one of its end, and a series during it.

use fieldline_protocol::message::ResidualReason;
use host_sim::picture::{Ground, Pixels, Scene, run_pixels, run_png};
use host_sim::report::tum::Stamped;
use host_sim::report::{Report, ResidualFrontier};
use host_sim::trial::snapshot::Snapshot;
use host_sim::trial::{Record, wording};
use host_sim::world::World;

/// The run that the pictures show.
pub(super) struct Album<'a> {
    report: &'a Report,
    record: &'a Record,
    ground: Option<Ground<'a>>,
    path: Vec<Stamped>,
    believed: Vec<Stamped>,
}

impl<'a> Album<'a> {
    /// Makes the album of a run in a world.
    pub(super) fn new(world: &'a World, report: &'a Report, record: &'a Record) -> Self {
        let start_z_m = report.true_ground.map_or(0.0, |ground| ground.start_z_m);
        let truth = record.ground.as_ref();
        let ground = truth.map(|truth| Ground::new(world, truth, start_z_m));
        Self {
            report,
            record,
            ground,
            path: record.steps.iter().map(|step| step.truth).collect(),
            believed: record.steps.iter().map(|step| step.estimate).collect(),
        }
    }

    /// Draws `run.png`.
    pub(super) fn end(&self) -> Vec<u8> {
        self.show_end(run_png)
    }

    /// Draws the frames of a film: the series.
    pub(super) fn film(&self) -> impl Iterator<Item = Pixels> {
        let moments = self.record.snapshots.iter();
        moments.filter_map(|it| self.show_moment(it, run_pixels))
    }

    /// Draws the last frame of a film; `None` only if the page does not fit into memory.
    pub(super) fn last(&self) -> Option<Pixels> {
        self.show_end(run_pixels)
    }

    fn show_end<T>(&self, draw: impl FnOnce(&Scene<'_>) -> T) -> T {
        let left = &self.report.outcome.residual_frontiers;
        let (not_worth_it, residual): (Vec<_>, Vec<_>) = left
            .iter()
            .partition(|left| left.reason == wording::residual(ResidualReason::NotWorthIt));
        let at = |left: Vec<&ResidualFrontier>| -> Vec<_> {
            left.iter().map(|left| (left.x_m, left.y_m)).collect()
        };
        draw(&Scene {
            title: &self.report.headline(),
            subtitle: &self.report.in_short(),
            map: &self.record.map,
            path: &self.path,
            believed: self.believed(self.believed.len()),
            corrected: &self.record.corrected,
            window: self.record.window.as_ref(),
            relief: self.record.relief.as_ref(),
            residual: &at(residual),
            not_worth_it: &at(not_worth_it),
            planned_path: Some(&self.record.planned_path),
            given_up: &self.given_up(u32::MAX),
            ground: self.ground,
            room_for: None,
        })
    }

    /// Returns the places where loops were given up until a time.
    fn given_up(&self, time_ms: u32) -> Vec<(f64, f64)> {
        let said = self
            .report
            .loop_closing
            .iter()
            .flat_map(|said| &said.given_up);
        said.filter(|at| at.time_s * 1000.0 <= f64::from(time_ms))
            .map(|at| (at.x_m, at.y_m))
            .collect()
    }

    /// Returns the path as it was believed up to a step, if loops are closed.
    fn believed(&self, steps: usize) -> &[Stamped] {
        match self.report.slam {
            Some(_) => &self.believed[..steps.min(self.believed.len())],
            None => &[],
        }
    }

    /// Draws the series, in order.
    pub(super) fn during(&self) -> impl Iterator<Item = Vec<u8>> {
        let snapshots = self.record.snapshots.iter();
        snapshots.map(|snapshot| self.moment(snapshot))
    }

    /// Draws the map before and after the largest corrections, in order.
    pub(super) fn corrections(&self) -> impl Iterator<Item = [Vec<u8>; 2]> {
        let corrections = self.record.corrections.iter();
        corrections.map(|it| [&it.before, &it.after].map(|moment| self.moment(moment)))
    }

    fn moment(&self, snapshot: &Snapshot) -> Vec<u8> {
        self.show_moment(snapshot, run_png)
    }

    fn show_moment<T>(&self, snapshot: &Snapshot, draw: impl FnOnce(&Scene<'_>) -> T) -> T {
        let progress = &snapshot.progress;
        let seconds = progress.time_ms / 1000;
        let subtitle = format!(
            "{:.1} % of {:.0} m² known after {}:{:02} min and {:.1} m",
            progress.coverage * 100.0,
            self.report.coverage.explorable_m2,
            seconds / 60,
            seconds % 60,
            progress.path_m
        );
        draw(&Scene {
            title: &self.report.headline(),
            subtitle: &subtitle,
            map: &snapshot.map,
            path: &self.path[..snapshot.steps.min(self.path.len())],
            believed: self.believed(snapshot.steps),
            corrected: &[],
            window: snapshot.window.as_ref(),
            relief: snapshot.relief.as_ref(),
            residual: &[],
            not_worth_it: &[],
            planned_path: Some(&snapshot.planned_path),
            given_up: &self.given_up(progress.time_ms),
            ground: self.ground,
            room_for: Some(&self.record.map),
        })
    }
}

//! The figures of a replay, and its files.
//!
//! `occupied_cells_5cm` counts cells of 5 cm that hold an end of a beam, all scans placed at their
//! estimated poses: the sharper the map, the fewer. Beams that met nothing have no end.
//!
//! Units: metres, degrees.

use core::fmt::Write as _;
use std::collections::BTreeSet;
use std::path::Path;

use serde::Serialize;

use super::carmen::{LeftOut, Lines, LogScan};
use super::relations::{Pose, Relation, RelationError, Spread, compose, spread};
use super::run::Replayed;
use super::sweep::By;
use super::wire::LogLaser;
use crate::picture::{Scene, run_png};
use crate::report::folder::{self, WriteError};
use crate::report::tum::{self, Stamped};
use crate::report::{GridMap, InputFaults, MadeBy, QualityShares, json_line};
use crate::slam::SlamReport;

/// Side of the cells that are counted, metres.
const CELL_M: f64 = 0.05;

/// The figures of a replay, as in `--json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReplayReport {
    /// The log's file.
    pub log: String,
    /// The link.
    pub link: String,
    /// Seed of the drift.
    pub seed: u64,
    /// Factor of the drift's variances; `None` for the log's own odometry.
    pub degrade: Option<f64>,
    /// Scans of the log.
    pub steps: usize,
    /// Errors against relations; `None` without them.
    pub relations: Option<RelationErrors>,
    /// Cells of 5 cm that hold an end of a beam.
    pub occupied_cells_5cm: usize,
    /// Shares of the steps.
    pub quality: QualityShares,
    /// Observations that the device found wrong.
    pub input_faults: InputFaults,
    /// Scans of the log whose time was before one that came before them.
    pub late_scans: usize,
    /// Lines of the log that were left out, by reason.
    pub skipped: LeftOut,
    /// Scans with some beams more or less than usual; `None` if there are none.
    pub resampled: Option<Lines>,
    /// How the scans were read.
    pub laser: ReadLaser,
    /// The first scan, from 1, of which the map had no room for everything; `None` if it had.
    pub map_full_at: Option<usize>,
    /// What became of the loops; without `--slam`, none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slam: Option<SlamReport>,
    /// Version, command line and options; the key is missing for a replay of a program.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub made_by: Option<MadeBy>,
    /// A particle filter over the same scans; without `--particles`, none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub particles: Option<ParticlePath>,
}

/// How the scans were read.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ReadLaser {
    /// Beams of a scan.
    pub beams: usize,
    /// Angle of the first beam in the laser's frame, degrees counter-clockwise.
    pub first_deg: f64,
    /// Angle from one beam to the next, degrees; below 0 for a laser that turns clockwise.
    pub step_deg: f64,
    /// How that is known.
    pub known_by: By,
}

impl ReadLaser {
    /// Returns how a log's laser was read.
    #[must_use]
    pub fn of(laser: &LogLaser, known_by: By) -> Self {
        let lidar = laser.lidar();
        let sign = if lidar.clockwise { -1.0 } else { 1.0 };
        let rounded = |rad: f64| (rad.to_degrees() * 1e4).round() / 1e4;
        Self {
            beams: lidar.beams,
            first_deg: rounded(lidar.first_rad),
            step_deg: rounded(sign * lidar.step_rad),
            known_by,
        }
    }

    /// Returns the sweep in words.
    fn line(&self) -> String {
        let Self {
            beams,
            first_deg,
            step_deg,
            known_by,
        } = *self;
        // The last beam of a whole turn is one step before the first.
        let whole = (beams as f64 * step_deg.abs()).round() == 360.0;
        let gaps = if whole {
            beams
        } else {
            beams.saturating_sub(1)
        };
        let field = (gaps as f64 * step_deg.abs()).round();
        let how = match known_by {
            By::Line => "told by its lines",
            By::Option => "told by the options",
            By::Scans => "found by its scans in turns",
            By::Count => "usual for this number of beams",
        };
        let side = if step_deg < 0.0 { ", clockwise" } else { "" };
        format!("{beams} beams from {first_deg}° in steps of {step_deg}°: {field}°{side}, {how}")
    }
}

/// The path of the best particle of a filter, judged as the device's poses are.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParticlePath {
    /// The filter, as it was asked for.
    pub filter: String,
    /// Errors against relations; `None` without them.
    pub relations: Option<RelationErrors>,
    /// Cells of 5 cm that hold an end of a beam.
    pub occupied_cells_5cm: usize,
}

/// Errors against relations, absolute values.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RelationErrors {
    /// Relations whose times the log has.
    pub used: usize,
    /// Metres.
    pub translation_m: Spread,
    /// Degrees.
    pub rotation_deg: Spread,
}

impl RelationErrors {
    /// Returns the errors; `None` if there are none.
    #[must_use]
    pub fn of(errors: &[RelationError]) -> Option<Self> {
        let all = |part: fn(&RelationError) -> f64| {
            let parts: Vec<f64> = errors.iter().map(part).collect();
            spread(&parts)
        };
        Some(Self {
            used: errors.len(),
            translation_m: all(|error| error.translation_m)?,
            rotation_deg: all(|error| error.rotation_deg)?,
        })
    }
}

/// Returns the number of cells that hold an end of a beam.
#[must_use]
pub fn occupied_cells(laser: &LogLaser, scans: &[LogScan], poses: &[Pose]) -> usize {
    let cell = |m: f64| (m / CELL_M).floor() as i32;
    let mut cells = BTreeSet::new();
    for (scan, pose) in scans.iter().zip(poses) {
        for [x, y] in laser.ends(scan) {
            let [x, y, _] = compose(*pose, [x, y, 0.0]);
            cells.insert((cell(x), cell(y)));
        }
    }
    cells.len()
}

impl ReplayReport {
    /// Returns the report as one line of JSON.
    #[must_use]
    pub fn to_json_line(&self) -> String {
        json_line(self)
    }

    /// Returns a few lines of text.
    #[must_use]
    pub fn to_text(&self) -> String {
        let shares = &self.quality;
        let mut out = format!(
            "{}: {}\n  quality    tracking {:.1} %, degenerate {:.1} %, lost {:.1} %\n",
            self.log,
            self.odometry(),
            100.0 * shares.tracking,
            100.0 * shares.degenerate,
            100.0 * shares.lost,
        );
        if let Some(errors) = &self.relations {
            let Spread { mean, sd, max } = errors.translation_m;
            let turn = errors.rotation_deg;
            // Writing into a string does not fail.
            let _ = writeln!(
                out,
                "  relations  {} used; {mean:.4} ± {sd:.4} m, at most {max:.3} m; \
                 {:.2} ± {:.2}°, at most {:.1}°",
                errors.used, turn.mean, turn.sd, turn.max
            );
        }
        let _ = write!(
            out,
            "  map        {} cells of 5 cm",
            self.occupied_cells_5cm
        );
        if let Some(scan) = self.map_full_at {
            let _ = write!(out, "; map full at scan {scan} of {}", self.steps);
        }
        let _ = write!(out, "\n  laser      {}", self.laser.line());
        if !self.skipped.is_empty() {
            let _ = write!(out, "\n  skipped    {}", self.skipped);
        }
        if let Some(Lines { lines, first_line }) = self.resampled {
            let beams = self.laser.beams;
            let _ = write!(
                out,
                "\n  resampled  {lines} scans with some beams more or less than {beams} (the first \
                 is line {first_line})"
            );
        }
        if let Some(slam) = &self.slam {
            let _ = write!(out, "\n  loops      {slam}");
        }
        if let Some(particles) = &self.particles {
            let ParticlePath { filter, .. } = particles;
            let cells = particles.occupied_cells_5cm;
            let _ = write!(out, "\n  particles  {filter}: {cells} cells of 5 cm");
            if let Some(errors) = &particles.relations {
                let Spread { mean, sd, max } = errors.translation_m;
                let _ = write!(out, "; {mean:.4} ± {sd:.4} m, at most {max:.3} m");
            }
        }
        if let Some(line) = self.input_faults.line() {
            out += "\n";
            out += &line;
        }
        out
    }

    /// Returns steps and odometry on one line.
    fn odometry(&self) -> String {
        let of = match self.degrade {
            Some(k) => format!("odometry degraded by {k}, seed {}", self.seed),
            None => "the log's own odometry".into(),
        };
        format!("{} scans, {of}", self.steps)
    }
}

/// The content of a replay's folder.
#[derive(Clone, Copy, Debug)]
pub struct Files<'a> {
    /// The figures.
    pub report: &'a ReplayReport,
    /// The log's scans.
    pub scans: &'a [LogScan],
    /// Poses and map.
    pub replayed: &'a Replayed,
    /// Relations and their errors, with the log's times; `None` without relations.
    pub relations: Option<&'a [(Relation, RelationError)]>,
}

impl Files<'_> {
    /// Writes every file into `folder`.
    ///
    /// # Errors
    /// As [`WriteError`], at the first file that cannot be written.
    pub fn write(&self, folder: &Path) -> Result<(), WriteError> {
        let map = GridMap::from_tiles(&self.replayed.tiles);
        let path: Vec<Stamped> = self.path();
        let times: Vec<f64> = self.scans.iter().map(|scan| scan.time).collect();
        let picture = run_png(&Scene {
            subtitle: &self.report.odometry(),
            ..Scene::plain(&self.report.log, &map, &path)
        });
        let relations = self.relations.map(csv);
        let figures = self.report.to_json_line() + "\n";
        folder::write_replay(
            folder,
            &map,
            &[
                ("report.json", figures.as_bytes()),
                ("trajectory.tum", tum::at_times(&times, &path).as_bytes()),
                ("run.png", &picture),
            ],
            relations.as_deref(),
        )
    }

    fn path(&self) -> Vec<Stamped> {
        let began = self.scans.first().map_or(0.0, |scan| scan.time);
        let poses = self.scans.iter().zip(&self.replayed.poses);
        poses
            .map(|(scan, &[x_m, y_m, yaw_rad])| Stamped {
                time_ms: ((scan.time - began) * 1000.0).round() as u32,
                x_m,
                y_m,
                yaw_rad,
                ..Stamped::default()
            })
            .collect()
    }
}

/// Returns the text of `relations.csv`.
fn csv(relations: &[(Relation, RelationError)]) -> String {
    let mut out =
        String::from("from_s,to_s,true_x_m,true_y_m,true_yaw_rad,translation_m,rotation_deg\n");
    for (relation, error) in relations {
        let [x, y, yaw] = relation.delta;
        // Writing into a string does not fail.
        let _ = writeln!(
            out,
            "{:.6},{:.6},{x:.6},{y:.6},{yaw:.6},{:.6},{:.6}",
            relation.from, relation.to, error.translation_m, error.rotation_deg
        );
    }
    out
}

#[cfg(test)]
mod tests {
    use fieldline_protocol::message::Quality;

    use super::*;

    #[test]
    fn keys_are_those_of_the_command() {
        let errors = [(0.1, 1.0), (0.3, 2.0)].map(|(translation_m, rotation_deg)| RelationError {
            translation_m,
            rotation_deg,
        });
        let report = ReplayReport {
            log: "a.log".into(),
            link: "direct".into(),
            seed: 3,
            degrade: Some(2.0),
            steps: 2,
            relations: RelationErrors::of(&errors),
            occupied_cells_5cm: 7,
            quality: QualityShares::of(&[Quality::Tracking, Quality::Lost]),
            input_faults: InputFaults {
                jumps: 1,
                ..InputFaults::default()
            },
            late_scans: 1,
            skipped: LeftOut::default(),
            resampled: Some(Lines {
                lines: 2,
                first_line: 7,
            }),
            laser: ReadLaser {
                beams: 360,
                first_deg: -180.0,
                step_deg: 1.0,
                known_by: By::Scans,
            },
            map_full_at: Some(2),
            slam: None,
            made_by: None,
            particles: None,
        };
        assert_eq!(
            report.to_json_line(),
            "{\"log\":\"a.log\",\"link\":\"direct\",\"seed\":3,\"degrade\":2.0,\"steps\":2,\
             \"relations\":{\"used\":2,\"translation_m\":{\"mean\":0.2,\"sd\":0.09999999999999999,\
             \"max\":0.3},\"rotation_deg\":{\"mean\":1.5,\"sd\":0.5,\"max\":2.0}},\
             \"occupied_cells_5cm\":7,\"quality\":{\"tracking\":0.5,\"degenerate\":0.0,\
             \"lost\":0.5},\"input_faults\":{\"refused\":0,\"jumps\":1,\"clock\":0},\
             \"late_scans\":1,\"skipped\":{},\"resampled\":{\"lines\":2,\"first_line\":7},\
             \"laser\":{\"beams\":360,\"first_deg\":-180.0,\"step_deg\":1.0,\
             \"known_by\":\"scans\"},\"map_full_at\":2}"
        );
        assert!(report.to_text().ends_with(
            "\
             \n  input     0 observations refused, 1 jumps of odometry, 0 times out of order"
        ));
        assert_eq!(RelationErrors::of(&[]), None);
    }
}

//! Closes loops during a run: the pose graph beside the link, and the corrections that it sends.
//!
//! ```text
//! step ─► pose graph ─ closed a loop ─► poses of all scans ─► map of the corrected poses
//!                                                                 │ tiles that moved
//!                                    device's map ◄── correction ─┘
//! ```
//!
//! A tile moves with the scan that was taken nearest to its middle. It is sent if it has moved by a
//! cell or more since its content was made. Others stay as the device has them: they were made
//! within a cell of where they belong. Half a cell would correct the map more often than it errs.
//!
//! Units: metres, radians; map cells of 10 cm; tiles of 3.2 m.

use std::collections::{BTreeMap, BTreeSet};

use fieldline_planner::geometry::CELL_M;
use fieldline_planner::map::tiles::TILE_SIDE;
use fieldline_protocol::message::{Command, Observation, Quality, Start};
use fieldline_slam as graph;

use super::{Canvas, PoseGraph, SlamReport};
use crate::link::correction::{Classes, CorrectedTile, MapCorrection, Motion};
use crate::replay::relations::{Pose, compose, inverse};
use crate::trial::Corrector;
use crate::trial::mirror::Mirror;

/// A move that is worth a correction, metres: a cell.
const LEAST_M: f64 = CELL_M as f64;
/// Side of a tile, metres.
const TILE_M: f64 = TILE_SIDE as f64 * CELL_M as f64;
/// Greatest shift of a tile that a correction can say, cells.
const MOST_CELLS: f64 = 127.0;

/// Column and row of a tile.
type Key = (i16, i16);

/// Closes the loops of a run.
#[derive(Debug)]
pub struct LoopCloser {
    graph: PoseGraph,
    start: Start,
    scans: Vec<Scan>,
}

/// A scan of the run.
#[derive(Debug)]
struct Scan {
    observation: Observation,
    /// Where it lies in the device's map.
    sent: Pose,
    /// The device entered it.
    entered: bool,
}

impl LoopCloser {
    /// Closes the loops of a session, for wheels with this noise. `None` if the session has no
    /// laser.
    #[must_use]
    pub fn new(start: &Start, motion: graph::Motion) -> Option<Self> {
        Some(Self {
            graph: PoseGraph::new(start.lasers.first()?, motion),
            start: start.clone(),
            scans: Vec::new(),
        })
    }

    /// Returns what became of the loops.
    #[must_use]
    pub fn report(&self) -> SlamReport {
        self.graph.report()
    }

    /// Returns the correction to these poses; `None` if no tile has moved far enough.
    fn correction(&mut self, poses: &[Pose], mirror: &Mirror) -> Option<MapCorrection> {
        let before: BTreeMap<Key, Classes> = mirror.tiles().collect();
        let entered = || {
            self.scans
                .iter()
                .zip(poses)
                .filter(|(scan, _)| scan.entered)
        };
        if entered().all(|(scan, pose)| !moves(scan, pose)) {
            return None;
        }
        let canvas = Canvas::of(
            &self.start,
            entered().map(|(scan, pose)| (&scan.observation, *pose)),
        )?;
        let mut tiles = Vec::new();
        let mut sent = BTreeSet::new();
        let drawn = canvas.keys().filter(|key| canvas.planes(*key).is_some());
        let keys: BTreeSet<Key> = before.keys().copied().chain(drawn).collect();
        for key in keys {
            let Some((scan, pose)) = self.nearest(key, poses) else {
                continue;
            };
            let [dx, dy] = shift_m(scan, pose, middle(key));
            let has_moved = dx.hypot(dy) >= LEAST_M || !before.contains_key(&key);
            let classes = canvas.planes(key).unwrap_or_default();
            if !has_moved || before.get(&key).copied().unwrap_or_default() == classes {
                continue;
            }
            let cells = |m: f64| (m / f64::from(CELL_M)).round();
            let cells = |m: f64| cells(m).clamp(-MOST_CELLS, MOST_CELLS) as i8;
            sent.insert(key);
            tiles.push(CorrectedTile {
                key,
                shift: (cells(dx), cells(dy)),
                classes,
            });
        }
        for (scan, pose) in self.scans.iter_mut().zip(poses) {
            if sent.contains(&tile_of(scan.sent)) || sent.contains(&tile_of(*pose)) {
                scan.sent = *pose;
            }
        }
        let at = mirror.pose();
        let at = [at.x_m, at.y_m, at.yaw_rad].map(f64::from);
        let [x_m, y_m, yaw_rad] = compose(*poses.last()?, inverse(at));
        Some(MapCorrection {
            epoch: mirror.epoch().checked_add(1)?,
            motion: Motion { x_m, y_m, yaw_rad },
            tiles,
        })
    }

    /// Returns the entered scan that was taken nearest to a tile's middle, and its pose now.
    fn nearest<'a>(&'a self, key: Key, poses: &'a [Pose]) -> Option<(&'a Scan, &'a Pose)> {
        let [x, y] = middle(key);
        let entered = self
            .scans
            .iter()
            .zip(poses)
            .filter(|(scan, _)| scan.entered);
        let far = |scan: &Scan| (scan.sent[0] - x).hypot(scan.sent[1] - y);
        entered.min_by(|(one, _), (other, _)| far(one).total_cmp(&far(other)))
    }
}

impl Corrector for LoopCloser {
    fn correct(
        &mut self,
        observation: &Observation,
        command: &Command,
        mirror: &Mirror,
    ) -> Option<MapCorrection> {
        let at = mirror.pose();
        let at = [at.x_m, at.y_m, at.yaw_rad].map(f64::from);
        let location = command.location;
        let is_lost = location.is_some_and(|it| it.quality == Quality::Lost);
        let (_, closed) = self.graph.observe_at(observation, (!is_lost).then_some(at));
        self.scans.push(Scan {
            observation: observation.clone(),
            sent: at,
            entered: !is_lost,
        });
        if !closed {
            return None;
        }
        let poses = self.graph.poses();
        let correction = self.correction(&poses, mirror)?;
        let Motion { x_m, y_m, yaw_rad } = correction.motion;
        self.graph.relocate([x_m, y_m, yaw_rad]);
        Some(correction)
    }
}

/// Returns true if a scan has moved far enough, itself or what it saw some metres off.
fn moves(scan: &Scan, pose: &Pose) -> bool {
    let [x, y, yaw] = scan.sent;
    let turn = crate::robot::wrap(pose[2] - yaw).abs();
    (pose[0] - x).hypot(pose[1] - y).max(turn * TILE_M) >= LEAST_M
}

/// Returns how a point of a scan's surroundings moves with it, metres.
fn shift_m(scan: &Scan, pose: &Pose, [x, y]: [f64; 2]) -> [f64; 2] {
    let local = compose(inverse(scan.sent), [x, y, 0.0]);
    let [to_x, to_y, _] = compose(*pose, local);
    [to_x - x, to_y - y]
}

fn middle((x, y): Key) -> [f64; 2] {
    [x, y].map(|at| (f64::from(at) + 0.5) * TILE_M)
}

fn tile_of([x, y, _]: Pose) -> Key {
    let tile = |m: f64| (m / TILE_M).floor() as i16;
    (tile(x), tile(y))
}

//! Closes loops during a run: the pose graph beside the link, and the corrections that it sends.
//!
//! ```text
//! step ─► pose graph ─ closed a loop ─► poses of all scans ─► map of the corrected poses
//!                                                                 │ tiles that changed
//!                                    device's map ◄── correction ─┘
//! ```
//!
//! A tile is sent if a scan that reached it has moved by a cell or more since it was drawn there: a
//! robot that comes back with a wrong pose has drawn into tiles of its first pass, too. Others stay
//! as the device has them: they were made within a cell of where they belong. Half a cell would
//! correct the map more often than it errs. What the device remembers of a tile moves with the scan
//! that was taken nearest to its middle.
//!
//! **On uneven ground** the graph takes the beams alone that end at what stands, as the localiser
//! does, and the map is drawn from all beams with the height that the device had then. A tile keeps
//! its heights in the device. Cells that the device resolved without a beam are unknown in a tile
//! that is drawn anew.
//!
//! **In a team** each robot has a graph of its own scans. A tile belongs to the robot that measured
//! it first, and only that robot's graph corrects it:
//!
//! | of a team's robot | what a correction does |
//! | --- | --- |
//! | tiles of its own | redrawn; what peers added goes by the tile's shift (`others.rs`) |
//! | tiles of a peer | nothing: they lie where the peer's graph puts them |
//! | scans taken in a tile of a peer | stay: the pose was found in the peer's map |
//! | its pose in a tile of a peer | stays |
//! | the others' copies of a tile | are replaced: a corrected tile is of a new era |
//! | its move into the team's coordinates | moves all that the device has; the graph stays |
//!
//! So two graphs pull at one tile only if both robots measured it before they heard of each other,
//! as at starts side by side; there the corrections are small.
//!
//! Units: metres, radians; map cells of 10 cm; tiles of 3.2 m.

use std::collections::{BTreeMap, BTreeSet};

use fieldline_device::convert::quantity;
use fieldline_planner::geometry::CELL_M;
use fieldline_planner::map::tiles::TILE_SIDE;
use fieldline_protocol::message::{Command, Laser, Observation, Quality, Start};
use fieldline_slam as graph;

use super::others::{Others, class_at};
use super::{Canvas, PoseGraph, SlamReport};
use crate::link::correction::{Classes, CorrectedTile, MapCorrection, Motion};
use crate::replay::relations::{Pose, compose, inverse};
use crate::trial::map_copy::Key;
use crate::trial::{Corrector, MapCopy};

/// A scan that has moved less is not drawn anew, metres: a cell.
const LEAST_M: f64 = CELL_M as f64;
/// Side of a tile, metres.
const TILE_M: f64 = TILE_SIDE as f64 * CELL_M as f64;
/// Greatest shift of a tile that a correction can say, cells.
const MOST_CELLS: f64 = 127.0;

/// Closes the loops of a run.
#[derive(Debug)]
pub struct LoopCloser {
    graph: PoseGraph,
    start: Start,
    scans: Vec<Scan>,
    /// Corrections sent, and the longest way by which one moved the robot, metres.
    sent: usize,
    largest_m: f64,
    /// From the graph's coordinates to the map's; `None` while they are the same.
    map_from_graph: Option<Pose>,
}

/// A scan of the run.
#[derive(Debug)]
struct Scan {
    observation: Observation,
    /// Where it lies in the device's map.
    sent: Pose,
    /// The device entered it.
    entered: bool,
    /// It was taken in a tile of a peer.
    of_peer: bool,
}

impl LoopCloser {
    /// Closes the loops of a session, for wheels with this noise. `None` if the session has no
    /// laser.
    #[must_use]
    pub fn new(start: &Start, motion: graph::Motion) -> Option<Self> {
        let graph = PoseGraph::new(Self::lasers(start), motion)?;
        Some(Self::with(start, graph))
    }

    /// Returns the lasers of a session that the graph takes. On uneven ground only the first one's
    /// beams are known to end at what stands.
    #[must_use]
    pub fn lasers(start: &Start) -> &[Laser] {
        let most = if start.uneven_ground.is_some() {
            1
        } else {
            start.lasers.len()
        };
        start.lasers.get(..most).unwrap_or_default()
    }

    /// Closes the loops of a session with this empty graph.
    #[must_use]
    pub fn with(start: &Start, graph: PoseGraph) -> Self {
        Self {
            graph,
            start: start.clone(),
            scans: Vec::new(),
            sent: 0,
            largest_m: 0.0,
            map_from_graph: None,
        }
    }

    /// Says whether loops are closed from now on.
    pub fn set_closing(&mut self, closes: bool) {
        self.graph.set_closing(closes);
    }

    /// Returns what became of the loops.
    #[must_use]
    pub fn report(&self) -> SlamReport {
        SlamReport {
            corrections: self.sent,
            largest_m: self.largest_m,
            ..self.graph.report()
        }
    }

    /// Returns the correction to these poses; `None` if the map needs none.
    fn correction(&mut self, poses: &[Pose], copy: &dyn MapCopy) -> Option<MapCorrection> {
        let mut moved = self.drawn_anew(poses);
        moved.retain(|key| !copy.is_of_peer(*key));
        if moved.is_empty() {
            return None;
        }
        let before = copy.tiles();
        let mut drawn = self.drawn(&moved, poses)?;
        if copy.is_shared() {
            self.keep_others(&mut drawn, &before)?;
        }
        drawn.retain(|tile| before.get(&tile.key).copied().unwrap_or_default() != tile.classes);
        for (scan, pose) in self.scans.iter_mut().zip(poses) {
            if has_moved(scan, pose) {
                scan.sent = *pose;
            }
        }
        let [x_m, y_m, yaw_rad] = compose(*poses.last()?, inverse(pose_of(copy)));
        Some(MapCorrection {
            epoch: copy.epoch().checked_add(1)?,
            motion: Motion { x_m, y_m, yaw_rad },
            tiles: drawn,
        })
    }

    /// Returns these tiles of the map that the scans at some poses make.
    fn drawn(&self, keys: &BTreeSet<Key>, poses: &[Pose]) -> Option<Vec<CorrectedTile>> {
        let canvas = self.canvas(poses.iter().copied())?;
        let tile = |key: &Key| {
            Some(CorrectedTile {
                key: *key,
                shift: self.shift_of(*key, poses)?,
                classes: canvas.planes(*key).unwrap_or_default(),
                trail: [0; 16],
            })
        };
        keys.iter().map(tile).collect()
    }

    /// Returns the map that the scans make which the device entered.
    fn canvas(&self, poses: impl Iterator<Item = Pose>) -> Option<Canvas> {
        let scans = self.scans.iter().zip(poses);
        let entered = scans.filter(|(scan, _)| scan.entered);
        Canvas::of(
            &self.start,
            entered.map(|(scan, pose)| (&scan.observation, pose)),
        )
    }

    /// Keeps what others measured in the tiles.
    fn keep_others(
        &self,
        drawn: &mut [CorrectedTile],
        before: &BTreeMap<Key, Classes>,
    ) -> Option<()> {
        let own = self.canvas(self.scans.iter().map(|scan| scan.sent))?;
        let own: BTreeMap<Key, Classes> = own.all_planes().collect();
        let mut others = Others::default();
        for tile in &*drawn {
            if let Some(known) = before.get(&tile.key) {
                let own_at = |cell| class_at(cell, |key| own.get(&key).copied());
                others.take((tile.key, known), tile.shift, own_at);
            }
        }
        for tile in drawn {
            others.fill(tile.key, &mut tile.classes);
        }
        Some(())
    }

    /// Returns the pose of every scan: the graph's, or the device's in a tile of a peer.
    #[must_use]
    pub fn poses(&self) -> Vec<Pose> {
        let corrected = self.graph.poses().into_iter().zip(&self.scans);
        let pose = |(pose, scan): (Pose, &Scan)| match self.map_from_graph {
            _ if scan.of_peer => scan.sent,
            Some(frame) => compose(frame, pose),
            None => pose,
        };
        corrected.map(pose).collect()
    }

    /// Returns a motion of the map in the graph's coordinates.
    fn in_graph(&self, motion: Pose) -> Pose {
        self.map_from_graph.map_or(motion, |frame| {
            compose(inverse(frame), compose(motion, frame))
        })
    }

    /// Follows the whole map, which moved.
    fn follow(&mut self, motion: Motion) {
        let motion = [motion.x_m, motion.y_m, motion.yaw_rad];
        let frame = self.map_from_graph.unwrap_or_default();
        self.map_from_graph = Some(compose(motion, frame));
        for scan in &mut self.scans {
            scan.sent = compose(motion, scan.sent);
        }
    }

    /// Returns the tiles that scans which have moved reached, and those that they reach now.
    fn drawn_anew(&self, poses: &[Pose]) -> BTreeSet<Key> {
        let mut tiles = BTreeSet::new();
        for (scan, pose) in self.scans.iter().zip(poses) {
            if scan.entered && has_moved(scan, pose) {
                for place in [scan.sent, *pose] {
                    tiles.extend(reached(&self.start, &scan.observation, place));
                }
            }
        }
        tiles
    }

    /// Returns the shift of what the device remembers of a tile, cells.
    fn shift_of(&self, key: Key, poses: &[Pose]) -> Option<(i8, i8)> {
        let (scan, pose) = self.nearest(key, poses)?;
        let cells = shift_m(scan, pose, middle(key)).map(|m| (m / f64::from(CELL_M)).round());
        let [dx, dy] = cells.map(|cells| cells.clamp(-MOST_CELLS, MOST_CELLS) as i8);
        Some((dx, dy))
    }

    /// Returns the entered scan that was taken nearest to a tile's middle, not in a tile of a peer,
    /// and its pose now.
    fn nearest<'a>(&'a self, key: Key, poses: &'a [Pose]) -> Option<(&'a Scan, &'a Pose)> {
        let [x, y] = middle(key);
        let entered = self
            .scans
            .iter()
            .zip(poses)
            .filter(|(scan, _)| scan.entered && !scan.of_peer);
        let far = |scan: &Scan| (scan.sent[0] - x).hypot(scan.sent[1] - y);
        entered.min_by(|(one, _), (other, _)| far(one).total_cmp(&far(other)))
    }
}

impl Corrector for LoopCloser {
    fn correct(
        &mut self,
        observation: &Observation,
        command: &Command,
        copy: &dyn MapCopy,
    ) -> Option<MapCorrection> {
        if let Some(motion) = copy.moved() {
            self.follow(motion);
        }
        let at = pose_of(copy);
        let location = command.location;
        let is_lost = location.is_some_and(|it| it.quality == Quality::Lost);
        let entered = !is_lost && copy.moved().is_none();
        let in_graph = match self.map_from_graph {
            Some(frame) => compose(inverse(frame), at),
            None => at,
        };
        let standing = copy.standing(observation);
        let mut observation = copy.measured(observation);
        if self.start.uneven_ground.is_some() {
            // The height was corrected with the pose; a closed loop leaves it.
            observation.pose.z = quantity(copy.pose().z_m);
        }
        let located = entered.then_some(in_graph);
        let (_, closed) = self.graph.observe_at(&standing, located);
        self.scans.push(Scan {
            observation,
            sent: at,
            entered,
            of_peer: copy.is_of_peer(tile_of(at)),
        });
        if !closed {
            return None;
        }
        let poses = self.poses();
        let correction = self.correction(&poses, copy)?;
        self.sent += 1;
        let moved_m = correction.motion.length_at_m(&copy.pose());
        self.largest_m = self.largest_m.max(moved_m);
        let Motion { x_m, y_m, yaw_rad } = correction.motion;
        self.graph.relocate(self.in_graph([x_m, y_m, yaw_rad]));
        Some(correction)
    }
}

/// Returns the robot's pose in the map.
fn pose_of(copy: &dyn MapCopy) -> Pose {
    let at = copy.pose();
    [at.x_m, at.y_m, at.yaw_rad].map(f64::from)
}

/// Returns true if a scan has moved far enough, itself or what it saw some metres off.
fn has_moved(scan: &Scan, pose: &Pose) -> bool {
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

/// Returns the tiles that a scan's beams cross from a pose. Beams and places along them are looked
/// at each half tile.
fn reached(start: &Start, observation: &Observation, pose: Pose) -> BTreeSet<Key> {
    let mut tiles = BTreeSet::new();
    let look_m = 0.5 * TILE_M;
    for (laser, scan) in start.lasers.iter().zip(&observation.scans) {
        let step_rad: f64 = laser.bearing_step.to_num();
        let first_rad: f64 = laser.first_bearing.to_num();
        let most_m = f64::from(laser.range_limit_mm) * 1e-3;
        // A step of zero makes it infinite, and the cast the greatest number.
        let stride = (look_m / (step_rad.abs() * most_m)).max(1.0) as usize;
        for (number, &range_mm) in (0..).zip(&scan.ranges_mm).step_by(stride) {
            let (sin, cos) = (first_rad + step_rad * f64::from(number)).sin_cos();
            // A code for no return is farther than any range.
            let range_m = (f64::from(range_mm) * 1e-3).min(most_m);
            let steps = (range_m / look_m).ceil().max(1.0) as u32;
            tiles.extend((0..=steps).map(|k| {
                let part_m = range_m * f64::from(k) / f64::from(steps);
                tile_of(compose(pose, [part_m * cos, part_m * sin, 0.0]))
            }));
        }
    }
    tiles
}

fn tile_of([x, y, _]: Pose) -> Key {
    let tile = |m: f64| (m / TILE_M).floor() as i16;
    (tile(x), tile(y))
}

#[cfg(test)]
mod tests {
    use core::f64::consts::{FRAC_PI_2, FRAC_PI_4};

    use fieldline_protocol::message::{NO_RETURN_MM, Scan as Sweep};
    use fixed::types::I16F16;

    use super::*;

    /// A laser of five beams over half a turn, and what it saw.
    fn seen(ranges_mm: [u16; 5]) -> (Start, Observation) {
        let laser = Laser {
            beams: 5,
            first_bearing: I16F16::from_num(-FRAC_PI_2),
            bearing_step: I16F16::from_num(FRAC_PI_4),
            range_limit_mm: 8_000,
            ..Laser::default()
        };
        let start = Start {
            lasers: [laser].into_iter().collect(),
            ..Start::default()
        };
        let scan = Sweep {
            ranges_mm: ranges_mm.into_iter().collect(),
        };
        let observation = Observation {
            scans: [scan].into_iter().collect(),
            ..Observation::default()
        };
        (start, observation)
    }

    #[test]
    fn a_scan_reaches_the_tiles_that_its_beams_cross() {
        let (start, observation) = seen([1_000, 0, NO_RETURN_MM, 0, 4_000]);
        let tiles: Vec<Key> = reached(&start, &observation, [1.7, 1.6, 0.0])
            .into_iter()
            .collect();
        // 8 m ahead, 1 m to the right and 4 m to the left.
        assert_eq!(tiles, [(0, 0), (0, 1), (1, 0), (2, 0), (3, 0)]);
    }

    #[test]
    fn a_scan_that_turns_moves_what_it_saw_some_metres_off() {
        let (_, observation) = seen([0; 5]);
        let scan = Scan {
            observation,
            sent: [5.0, 5.0, 3.1],
            entered: true,
            of_peer: false,
        };
        assert!(!has_moved(&scan, &[5.05, 5.0, 3.1]));
        assert!(has_moved(&scan, &[5.11, 5.0, 3.1]));
        assert!(has_moved(&scan, &[5.0, 5.0, -3.1]), "five degrees");
        let moved = shift_m(&scan, &[5.0, 5.0, 3.1 + 0.1], [8.0, 5.0]);
        assert!(moved[1] > 0.29 && moved[0].abs() < 0.02, "{moved:?}");
    }
}

//! Where the robot is in its own map: odometry predicts, the level scan corrects.
//!
//! ```text
//! input ─► predict (odometry) ─► align (scan with the map's tiles) ─► fuse ─► map pose
//!                                 └─► if wheels slipped: align from where they did not lead
//! ```
//!
//! | file | holds |
//! | --- | --- |
//! | `odometry` | how far odometry may be wrong after a step |
//! | `scan_points` | the beams' ends, and the surfaces that they lie on |
//! | `occupancy` | the map as a field with a gradient |
//! | `alignment` | Gauss–Newton, and directions that the scan does not observe |
//! | `slip` | predictions for wheels that slip |
//! | `search` | the wider search of a robot that is lost |
//! | `lost` | which place a lost robot takes |
//! | `overlap` | how a tile of another map lies in this one |
//! | `symmetric` | 3 × 3 matrices, and eigenvalues of 2 × 2 |
//!
//! The state is the motion [`MapFromOdom`] and its covariance. Without localisation the motion is
//! the identity, and every pose passes through unchanged, bit for bit.
//!
//! On uneven ground only beams that end on obstacles of the map or on landmarks
//! (`map/landmarks.rs`) are matched, and the height follows the ground that the map has under the
//! robot. A beam may end on ground there, so a scan never contradicts the map.
//!
//! Invariant: a correction changes the motion only. The odometry frame, and with it the obstacle
//! points beside the robot, never moves.
//! Units: metres, radians; cells inside the alignment.

mod alignment;
mod location;
mod lost;
mod motion;
mod occupancy;
mod odometry;
mod overlap;
mod scan_points;
mod search;
mod slip;
mod symmetric;
#[cfg(test)]
mod tests;

use crate::config::{Config, LocaliseTuning};
use crate::geometry::{CELL_M, MapFromOdom, MapPose, OdomPose, Pose, RobotFrame};
use crate::input::Input;
use crate::map::neighbourhood::Neighbourhood;
use crate::map::{Map, Tiles};
use crate::math;
use crate::robot::LaserMount;
use alignment::{Aligned, Unobserved, align};
pub use location::{Location, Quality};
use motion::Motion;
pub(crate) use odometry::carry;
pub(crate) use overlap::{MOST_CELLS, Overlap, add_tile, is_of_tile, overlap, sd_m};
use scan_points::ScanPoints;
use search::Search;
use slip::{likelier, predictions};
pub(crate) use symmetric::Symmetric;

/// The localiser's memory.
#[derive(Debug)]
pub struct Localiser {
    /// The last odometry pose.
    odom: OdomPose,
    /// True from the first step on. An `Option` of the pose would take a word more.
    has_odom: bool,
    map_from_odom: MapFromOdom,
    /// Covariance of the pose in the map, metres and radians.
    covariance: Symmetric,
    quality: Quality,
    /// Height of the map above the odometry's, metres; 0 on flat ground.
    rise_m: f32,
    /// Consecutive steps whose scan contradicted the map.
    contradicted: u8,
    /// Steps for which only a scan that refutes the place is doubted.
    trusted_steps: u8,
    /// Steps for which no scan is doubted.
    unjudged_steps: u8,
    /// What the next step goes on from.
    footing: Footing,
}

/// What a step goes on from.
#[derive(Debug)]
enum Footing {
    /// The last step.
    Moved(Motion),
    /// The search of a robot that is lost.
    Lost(Search),
}

impl Default for Localiser {
    fn default() -> Self {
        Self::new()
    }
}

impl Localiser {
    /// Returns a localiser at the beginning of a session.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            odom: OdomPose(Pose::ORIGIN),
            has_odom: false,
            map_from_odom: MapFromOdom::IDENTITY,
            covariance: Symmetric::ZERO,
            quality: Quality::Tracking,
            rise_m: 0.0,
            contradicted: 0,
            trusted_steps: 0,
            unjudged_steps: 0,
            footing: Footing::Moved(Motion::NONE),
        }
    }

    /// Returns the last odometry pose.
    #[must_use]
    pub fn odom(&self) -> OdomPose {
        self.odom
    }

    /// Returns the robot's pose in the map.
    #[must_use]
    pub fn pose(&self) -> MapPose {
        self.to_map(&self.odom)
    }

    /// Returns a pose of the odometry in the map, with the last correction.
    #[must_use]
    pub fn to_map(&self, odom: &OdomPose) -> MapPose {
        if self.map_from_odom == MapFromOdom::IDENTITY && self.rise_m == 0.0 {
            return MapPose(odom.0);
        }
        let MapPose(pose) = self.map_from_odom.apply(odom);
        MapPose(Pose {
            z_m: pose.z_m + self.rise_m,
            ..pose
        })
    }

    /// Returns true if the last scan may be entered into the map.
    #[must_use]
    pub const fn may_enter(&self) -> bool {
        self.contradicted == 0
    }

    /// Returns true if the robot does not know where it is.
    #[must_use]
    pub fn is_lost(&self) -> bool {
        self.quality == Quality::Lost
    }

    /// Returns true if the robot is lost and the search found no place.
    #[must_use]
    pub fn has_given_up(&self) -> bool {
        matches!(&self.footing, Footing::Lost(search) if search.is_over())
    }

    /// Returns the location after the last step.
    #[must_use]
    pub fn location(&self) -> Location {
        let p = &self.covariance;
        Location {
            pose: self.pose(),
            covariance: [p.xx, p.xy, p.yy, p.xt, p.yt, p.tt],
            quality: self.quality,
        }
    }

    /// Moves the pose with the map. `covariance` is that of the motion, about the robot.
    pub(crate) fn move_map(&mut self, motion: &MapFromOdom, covariance: &Symmetric) {
        self.map_from_odom = motion.after(&self.map_from_odom);
        self.covariance = self.covariance + *covariance;
    }

    /// Moves the pose by a correction of the map. A lost robot begins its search anew there.
    pub fn correct_pose(&mut self, motion: &MapFromOdom) {
        self.map_from_odom = motion.after(&self.map_from_odom);
        self.contradicted = 0;
        if self.is_lost() {
            self.footing = Footing::Lost(Search::new());
        }
    }

    /// Doubts no scan for a while. The map was made to forget obstacles that may still stand, so a
    /// scan that shows them says nothing against the pose. A lost robot never plans, so it never
    /// makes its map forget.
    pub const fn expect_contradiction(&mut self, tuning: &LocaliseTuning) {
        self.unjudged_steps = tuning.trusted_steps;
    }

    /// Takes odometry and scans of a step. Returns the pose in the map.
    pub fn locate<const TILES: usize, const SLOTS: usize>(
        &mut self,
        config: &Config,
        map: &Map<TILES, SLOTS>,
        input: &Input<'_>,
    ) -> MapPose {
        let tiles = map.tiles();
        let odom = OdomPose(input.pose);
        let last = core::mem::replace(&mut self.odom, odom);
        let last = if self.has_odom { last } else { odom };
        self.has_odom = true;
        if !config.localise {
            return self.to_map(&odom);
        }
        let tuning = &config.tuning.localise;
        let was_lost = self.is_lost();
        let before = self.to_map(&last);
        let predicted = self.to_map(&odom);
        self.covariance = odometry::spread(
            &self.covariance,
            (&last, &odom),
            predicted.0.yaw_rad,
            tuning,
        );
        let lasers = config.lasers.iter().zip(input.scans);
        let level = lasers.filter(|(laser, _)| laser.is_level());
        let mut pose = match level.into_iter().next() {
            Some(level) => self.correct(config, tiles, level, (&before, &predicted)),
            None => {
                self.quality = Quality::Degenerate(None);
                predicted
            }
        };
        self.map_from_odom = MapFromOdom::between(&odom, &pose);
        if let (Footing::Moved(motion), false) = (&mut self.footing, was_lost) {
            *motion = Motion::between(&before.0, &pose.0);
        }
        if config.ground.is_some() {
            self.settle(map, &mut pose.0, config.tuning.map.stand_radius_m);
        }
        pose
    }

    /// Puts the robot on the ground that the map has under it. A correction on a slope is also one
    /// of the height: without it the ground that is measured next would lie beside what is known.
    fn settle<const TILES: usize, const SLOTS: usize>(
        &mut self,
        map: &Map<TILES, SLOTS>,
        pose: &mut Pose,
        reach_m: f32,
    ) {
        if let Some(off_m) = map.heights().mean_over_plane_m(pose, reach_m) {
            self.rise_m += off_m;
            pose.z_m += off_m;
        }
    }

    /// Corrects the predicted pose by a scan. The scan's points leave the stack with it.
    #[inline(never)]
    fn correct<const TILES: usize, const SLOTS: usize>(
        &mut self,
        config: &Config,
        tiles: &Tiles<TILES, SLOTS>,
        (laser, ranges_mm): (&LaserMount, &[u16]),
        (before, predicted): (&MapPose, &MapPose),
    ) -> MapPose {
        let is_uneven = config.ground.is_some();
        let tuning = &if is_uneven {
            config.tuning.localise.on_uneven_ground()
        } else {
            config.tuning.localise
        };
        let mut points = ScanPoints::new();
        scan_points::scan_points(config, &predicted.0, (laser, ranges_mm), &mut points);
        let frame = RobotFrame::of(&predicted.0);
        // Walls of a fold came too, but they are surfaces, which people have not.
        let mut near = Neighbourhood::of(tiles);
        points.retain(|point| {
            is_uneven
                || point.normal.is_some()
                || !near.has_lone_arrival(frame.to_map(point.end).cell())
        });
        let Some(information) = to_cells(&self.covariance).inverse() else {
            return *predicted;
        };
        let prior = in_cells(&predicted.0);
        let mut found = align(tiles, &points, (prior, &information), prior, tuning);
        let mut predicted = *predicted;
        // On uneven ground a slip is not followed: ground is often taken for walls there.
        if let Footing::Moved(motion) = &self.footing
            && !is_uneven
            && let Some(slipped) = predictions(config, (&before.0, &predicted.0), motion)
        {
            let others = slipped.map(|pose| in_cells(&pose));
            let place = likelier(tiles, &points, found.pose, others, tuning);
            if let Some((pose, prior)) = place.and_then(|at| slipped.get(at).zip(others.get(at))) {
                predicted = MapPose(*pose);
                found = align(tiles, &points, (*prior, &information), *prior, tuning);
            }
        }
        let predicted = &predicted;
        self.trusted_steps = self.trusted_steps.saturating_sub(1);
        self.unjudged_steps = self.unjudged_steps.saturating_sub(1);
        if !self.is_doubtful(&found, is_uneven, tuning) {
            return self.accept(&found, predicted);
        }
        if self.is_lost() {
            return self.search(tiles, &points, (&found, predicted), tuning);
        }
        self.contradicted = self.contradicted.saturating_add(1);
        if self.contradicted >= tuning.lost_steps {
            self.quality = Quality::Lost;
            self.footing = Footing::Lost(Search::new());
        }
        *predicted
    }

    /// Returns true if an alignment contradicts the map. On uneven ground none does, because a beam
    /// may end on ground that is free, nor after the map forgot what stands.
    fn is_doubtful(&self, found: &Aligned, is_uneven: bool, tuning: &LocaliseTuning) -> bool {
        let agreement = &found.agreement;
        if is_uneven || self.unjudged_steps > 0 {
            false
        } else if self.trusted_steps > 0 {
            agreement.is_refuted(tuning)
        } else {
            agreement.is_contradicted(self.contradicted > 0, tuning)
        }
    }

    /// Takes an alignment for the pose.
    fn accept(&mut self, found: &Aligned, predicted: &MapPose) -> MapPose {
        self.contradicted = 0;
        if self.is_lost() {
            self.footing = Footing::Moved(Motion::NONE);
        }
        self.quality = match found.unobserved {
            Unobserved::Nothing => Quality::Tracking,
            Unobserved::Direction([x, y]) => Quality::Degenerate(Some(math::atan2(y, x))),
            Unobserved::Everything => Quality::Degenerate(None),
        };
        if let Some(covariance) = found.information.inverse() {
            self.covariance = to_metres(&covariance);
        }
        let [x, y, yaw_rad] = found.pose;
        MapPose(Pose {
            x_m: x * CELL_M,
            y_m: y * CELL_M,
            yaw_rad,
            ..predicted.0
        })
    }
}

/// Returns a pose in cells.
fn in_cells(pose: &Pose) -> [f32; 3] {
    [pose.x_m / CELL_M, pose.y_m / CELL_M, pose.yaw_rad]
}

/// Returns a covariance in cells.
fn to_cells(metres: &Symmetric) -> Symmetric {
    rescaled(metres, 1.0 / CELL_M)
}

/// Returns a covariance in metres.
fn to_metres(cells: &Symmetric) -> Symmetric {
    rescaled(cells, CELL_M)
}

fn rescaled(p: &Symmetric, by: f32) -> Symmetric {
    Symmetric {
        xx: p.xx * by * by,
        xy: p.xy * by * by,
        yy: p.yy * by * by,
        xt: p.xt * by,
        yt: p.yt * by,
        tt: p.tt,
    }
}

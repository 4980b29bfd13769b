//! The host's copy of what a lone robot knows of the space around it, from the same observations.
//!
//! The copy does not know when the robot gives up a trap, or turns back on its track. It needs not:
//! points go as beams pass them, and a way that the robot goes back is forgotten by the track
//! itself. What the hull felt is not copied, because the copy is not told what the robot was told
//! to drive.
//!
//! Units: metres, radians.

use heapless::Vec;

use super::{RECALLED_POINTS, Recall, RecalledPoint};
use crate::config::Config;
use crate::drive::track::Track;
use crate::geometry::{MapFromOdom, OdomPose, Point};
use crate::input::Input;
use crate::map::obstacle_points::{FELT, MAX_POINTS, ObstaclePoints};
use crate::math;
use crate::planner::sense::level_scans;
use crate::planner::state::State;

/// Obstacle points and track of a lone robot.
#[derive(Debug)]
pub struct Surroundings {
    points: ObstaclePoints,
    track: Track,
    has_begun: bool,
}

impl Surroundings {
    /// Returns those of a robot that has seen nothing.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            points: ObstaclePoints::new(),
            track: Track::new(),
            has_begun: false,
        }
    }

    /// Enters an input, whose pose is that of the map. Nothing has surrounded a robot that
    /// `has_started` before the first input of which this is true.
    pub fn observe(
        &mut self,
        config: &Config,
        (input, odom): (&Input<'_>, &OdomPose),
        has_started: bool,
    ) {
        let is_flat = config.ground.is_none();
        if is_flat && has_started && !self.has_begun {
            self.points.surround(&odom.0, &config.robot);
        }
        self.has_begun |= has_started;
        for scan in level_scans(config, input).filter(|_| is_flat) {
            self.points.update(config, &odom.0, scan, |_| false);
        }
        self.track.record(&input.pose);
    }

    /// Moves the track with the robot by a correction of the map.
    pub fn correct(&mut self, motion: &MapFromOdom) {
        self.track.correct(motion);
    }

    /// Returns what a device that was reset is told, after the correction of this number.
    #[must_use]
    pub fn recall(&self, epoch: u16, odom: &OdomPose) -> Recall {
        recall(epoch, odom, &self.points, &self.track)
    }

    /// Goes on with what a device that was reset was told.
    pub fn take_over(&mut self, recall: &Recall) {
        self.points.take_over(recall.from, recall.counted());
        self.track = recall.track();
        self.has_begun = true;
    }
}

impl Default for Surroundings {
    fn default() -> Self {
        Self::new()
    }
}

/// Returns what a device would have to be told to know what this one knows.
#[must_use]
pub fn known_by<const TILES: usize, const SLOTS: usize>(state: &State<TILES, SLOTS>) -> Recall {
    let (epoch, odom) = (state.map_epoch(), state.localiser.odom());
    let none = ObstaclePoints::new();
    recall(
        epoch,
        &odom,
        state.ground.points().unwrap_or(&none),
        state.drive.track(),
    )
}

fn recall(epoch: u16, odom: &OdomPose, points: &ObstaclePoints, track: &Track) -> Recall {
    let from = odom.0.point();
    let measured = points.counted().filter(|&(_, returns)| returns != FELT);
    let mut near: Vec<(Point, u8), MAX_POINTS> = measured.collect();
    near.sort_unstable_by(|(a, _), (b, _)| a.distance2(from).total_cmp(&b.distance2(from)));
    let told = |&(point, returns): &(Point, u8)| RecalledPoint {
        x_mm: millimetres(point.x_m - from.x_m),
        y_mm: millimetres(point.y_m - from.y_m),
        returns,
    };
    Recall {
        epoch,
        from,
        points: near.iter().take(RECALLED_POINTS).map(told).collect(),
        track_end: track.end(),
        track: track.differences().collect(),
    }
}

/// Returns a length in whole millimetres. Points are within 3 m.
fn millimetres(length_m: f32) -> i16 {
    math::floor(1e3 * length_m + 0.5) as i16
}

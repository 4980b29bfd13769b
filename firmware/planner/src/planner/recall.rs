//! What a robot remembers of the space around it, for a device that was reset.
//!
//! ```text
//! host    reset ─► start ─► correct, tiles … ─► recall ─► observation
//! device                    map, pose, trail    points, track
//! ```
//!
//! A map cell is 10 cm, and a door leaves the hull 8 cm on each side. What tells the robot that it
//! fits are the obstacle points beside it. What leads it out of where it does not fit any more is
//! the track along which it came. A device that was reset has lost both, and cells alone do not
//! bring them back. The host took every observation, so it has the same points and the same track,
//! by the same code: [`Surroundings`].
//!
//! | of the surroundings | told | not told |
//! | --- | --- | --- |
//! | obstacle points | the nearest, in whole millimetres, with their returns | those farther off |
//! | felt points | | what the hull felt is felt again |
//! | unseen points of a start | as they are | |
//! | track | its end, and the differences before it | |
//!
//! Invariants: a recall comes once, between the correction that brought the map and the first step.
//! A robot that has taken a step knows its surroundings better than any host, so it refuses one.
//! Units: metres, radians; millimetres where a name says so. Points lie in the odometry's frame,
//! the track in the map's.

use heapless::Vec;

use crate::config::Config;
use crate::drive::track::{MOST as MOST_TRACK, Track};
use crate::geometry::Point;
use crate::math;
use crate::planner::state::State;
use crate::planner::{CorrectionError, CorrectionProgress};

#[cfg(feature = "internals")]
pub use surroundings::{Surroundings, known_by};

/// Greatest number of points in a recall.
pub const RECALLED_POINTS: usize = 128;
/// Greatest number of differences in a recalled track.
pub const RECALLED_TRACK: usize = MOST_TRACK;

/// The number of returns that stands for a point beside the hull of a robot that starts, which
/// nothing has seen.
const UNSEEN: u8 = crate::map::obstacle_points::UNSEEN;
/// Greatest coordinate, metres: as for odometry.
const MOST_M: f32 = 10_000.0;

/// An obstacle point near the robot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RecalledPoint {
    /// Millimetres east of [`Recall::from`].
    pub x_mm: i16,
    /// Millimetres north of it.
    pub y_mm: i16,
    /// Number of returns of the point, at least 1; 255 for a point beside the hull of a robot that
    /// starts, which nothing has seen.
    pub returns: u8,
}

/// What a device that was reset knew of the space around its robot.
///
/// ```
/// use fieldline_planner::{
///     Config, Correction, LaserMount, Point, RECALLED_POINTS, RECALLED_TRACK, Recall,
///     RecalledPoint, RobotShape, State, Workspace,
/// };
///
/// let config = Config::builder(RobotShape::PIONEER_3AT)
///     .laser(LaserMount::level(0.10, 0.40))
///     .build()
///     .unwrap();
/// let mut state = Box::new(State::<16, 20>::new());
/// let mut workspace = Box::new(Workspace::new());
/// state.reset(&config);
/// let recall = Recall {
///     epoch: 1,
///     from: Point { x_m: 5.0, y_m: 0.0 },
///     // Something stands 0.4 m to the left.
///     points: [RecalledPoint { x_mm: 0, y_mm: 400, returns: 8 }].into_iter().collect(),
///     // It came from the west, in pieces of 0.4 m.
///     track_end: Some([5.0, 0.0, 0.0]),
///     track: [[100, 0, 0]; 3].into_iter().collect(),
/// };
/// assert!(state.recall(&config, &recall).is_err(), "it has no map yet");
/// state.begin_correction(&Correction { epoch: 1, x_m: 5.0, ..Correction::default() })?;
/// state.finish_correction(&config, &mut workspace);
/// assert!(state.recall(&config, &recall)?.closed);
/// assert_eq!((RECALLED_POINTS, RECALLED_TRACK), (128, 56));
/// # Ok::<(), fieldline_planner::CorrectionError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recall {
    /// Number of the correction that brought the map: the last one that was finished.
    pub epoch: u16,
    /// From where the points are told, by odometry.
    pub from: Point,
    /// The nearest obstacle points.
    pub points: Vec<RecalledPoint, RECALLED_POINTS>,
    /// Where the track ends, in the map: x, y, yaw. `None` without a track.
    pub track_end: Option<[f32; 3]>,
    /// The differences of the track's poses, the oldest first, each in the frame of the older pose:
    /// ahead in 4 mm, to the left in 1 mm, turned in 0.01 rad.
    pub track: Vec<[i8; 3], RECALLED_TRACK>,
}

impl Recall {
    /// Returns true if every number may be one that a robot remembers.
    fn is_usable(&self, config: &Config) -> bool {
        let most = config.tuning.map.max_returns;
        let counts = |point: &RecalledPoint| {
            matches!(point.returns, UNSEEN) || (1..=most).contains(&point.returns)
        };
        let is_near = |at: f32| at.abs() <= MOST_M;
        let ends = self.track_end.iter().flatten();
        self.points.iter().all(counts)
            && is_near(self.from.x_m)
            && is_near(self.from.y_m)
            && ends.copied().all(is_near)
    }

    /// Returns the points in the odometry's frame, with their counts.
    fn counted(&self) -> impl Iterator<Item = (Point, u8)> + '_ {
        self.points.iter().map(|point| {
            let at = Point {
                x_m: self.from.x_m + 1e-3 * f32::from(point.x_mm),
                y_m: self.from.y_m + 1e-3 * f32::from(point.y_mm),
            };
            (at, point.returns)
        })
    }

    /// Returns the track.
    fn track(&self) -> Track {
        let end = self.track_end.map(|[x, y, yaw]| [x, y, math::wrap(yaw)]);
        Track::of(end, self.track.iter().copied())
    }
}

impl<const TILES: usize, const SLOTS: usize> State<TILES, SLOTS> {
    /// Takes over what a device that was reset knew of the space around its robot: after the
    /// correction that gave it its map back, and before its first step. The same recall again
    /// changes nothing. Returns how far the correction is.
    ///
    /// # Errors
    /// [`CorrectionError::NotOpen`] if the correction is not the last one that was finished, or the
    /// robot has made a step. [`CorrectionError::Unusable`] if a number is none that a robot
    /// remembers. Nothing has changed then.
    #[inline(never)]
    pub fn recall(
        &mut self,
        config: &Config,
        recall: &Recall,
    ) -> Result<CorrectionProgress, CorrectionError> {
        let progress = self.correction_progress(recall.epoch)?;
        if self.started || !progress.closed {
            return Err(CorrectionError::NotOpen);
        }
        if !recall.is_usable(config) {
            return Err(CorrectionError::Unusable);
        }
        self.ground.take_over(recall.from, recall.counted());
        self.drive.came_along(recall.track());
        self.is_recalled = true;
        Ok(progress)
    }
}

#[cfg(feature = "internals")]
mod surroundings;

#[cfg(test)]
mod tests;

//! A log through a session over any link.
//!
//! ```text
//! hello → Start(survey) → one observation a scan → tiles
//! ```
//!
//! Nothing is driven. After the device gave up its pose, the poses are those of odometry with its
//! last correction, and these steps count as lost.
//!
//! Units: metres, radians, milliseconds.

use std::collections::BTreeMap;

use fieldline_protocol::message::{Control, Location, Quality, Status, Tile};

use super::carmen::LogScan;
use super::drift;
use super::relations::{Pose, compose, inverse};
use super::wire::{LogLaser, start};
use crate::link::{Link, LinkError};
use crate::report::InputFaults;
use crate::trial::snapshot;

/// The record of a replay.
#[derive(Clone, Debug, PartialEq)]
pub struct Replayed {
    /// Pose in the map at each scan.
    pub poses: Vec<Pose>,
    /// Quality of each step.
    pub qualities: Vec<Quality>,
    /// Status after the last step that the device made.
    pub status: Status,
    /// Observations that the device found wrong.
    pub input_faults: InputFaults,
    /// The device's map, as sent.
    pub tiles: BTreeMap<(i16, i16), Tile>,
}

/// Returns the odometry of a replay: the log's own, or degraded by `degrade`; it begins at zero.
#[must_use]
pub fn odometry(scans: &[LogScan], degrade: Option<f64>, seed: u64) -> Vec<Pose> {
    let Some(first) = scans.first().map(|scan| inverse(scan.odometry)) else {
        return Vec::new();
    };
    let own = scans.iter().map(|scan| compose(first, scan.odometry));
    let own: Vec<Pose> = own.collect();
    match degrade {
        None => own,
        Some(k) => drift::drifting(&own, drift::noise(k), seed),
    }
}

/// Replays scans with this odometry. `step` is called before each step with its number, and ends
/// the replay if it returns false.
///
/// # Errors
/// As [`LinkError`].
pub fn run(
    scans: &[LogScan],
    odometry: &[Pose],
    link: &mut dyn Link,
    step: &mut dyn FnMut(usize) -> bool,
) -> Result<Replayed, LinkError> {
    let laser = LogLaser::of(scans);
    link.hello()?;
    let mut status = link.control(&Control::Start(start(&laser)))?;
    let began = scans.first().map_or(0.0, |scan| scan.time);
    let (mut poses, mut qualities) = (Vec::new(), Vec::new());
    let mut map_from_odom = [0.0; 3];
    let mut input_faults = InputFaults::default();
    for (number, (scan, odom)) in scans.iter().zip(odometry).enumerate() {
        if !step(number) {
            break;
        }
        let mut located = None;
        if status == Status::Exploring {
            let time_ms = ((scan.time - began) * 1000.0).round() as u32;
            let command = link.observe(&laser.observation(scan, time_ms, *odom))?;
            status = command.status;
            located = command.location;
            input_faults = input_faults.after(command.input_faults);
        }
        if let Some(location) = &located {
            map_from_odom = compose(pose(location), inverse(*odom));
        }
        poses.push(compose(map_from_odom, *odom));
        qualities.push(located.map_or(Quality::Lost, |location| location.quality));
    }
    let places: Vec<[f64; 2]> = poses.iter().map(|pose| [pose[0], pose[1]]).collect();
    Ok(Replayed {
        tiles: snapshot::tiles(link, &places)?,
        poses,
        qualities,
        status,
        input_faults,
    })
}

fn pose(location: &Location) -> Pose {
    [
        location.x.to_num(),
        location.y.to_num(),
        location.yaw.to_num(),
    ]
}

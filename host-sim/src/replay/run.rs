//! A log through a session over any link.
//!
//! ```text
//! hello → Start(survey) → one observation a scan → tiles
//! ```
//!
//! Nothing is driven. A log may have equal times, or scans far apart. The session's clock then goes
//! on as if its robot had driven each step, so the device takes no step for a jump of odometry.
//!
//! The map that the device makes is full when the pool has no page for what a beam met. The device
//! goes on, and knows nothing of what it could not enter. The host's copy of the map tells when.
//!
//! After the device gave up its pose, the poses are those of odometry with its
//! last correction, and these steps count as lost.
//!
//! Units: metres, radians, milliseconds.

use std::collections::BTreeMap;
use std::time::Instant;

use fieldline_device::{TILES, convert};
use fieldline_planner::config::Tuning;
use fieldline_protocol::message::{Control, Location, Observation, Quality, Status, Tile};
use fieldline_slam::Motion;

use super::carmen::LogScan;
use super::drift;
use super::relations::{Pose, compose, inverse};
use super::wire::{LogLaser, start};
use crate::link::{Link, LinkError};
use crate::report::InputFaults;
use crate::robot::wrap;
use crate::slam::{Canvas, PoseGraph, SlamReport};
use crate::trial::at_once::AtOnce;
use crate::trial::mirror::Mirror;
use crate::trial::showing::Showing;
use crate::trial::snapshot;
use crate::trial::{Flow, Watch};

/// The record of a replay.
#[derive(Clone, Debug, PartialEq)]
pub struct Replayed {
    /// Pose in the map at each scan; with a pose graph as it corrected them in the end.
    pub poses: Vec<Pose>,
    /// What became of the loops; `None` without a pose graph.
    pub slam: Option<SlamReport>,
    /// Quality of each step.
    pub qualities: Vec<Quality>,
    /// Status after the last step that the device made.
    pub status: Status,
    /// Observations that the device found wrong.
    pub input_faults: InputFaults,
    /// Tiles in the pool of the device's map.
    pub tile_pool: u16,
    /// The device's map, as sent; with a pose graph the map of its corrected poses.
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

/// Returns the observations of a replay, as a device would get them.
#[must_use]
pub fn observations(laser: &LogLaser, scans: &[LogScan], odometry: &[Pose]) -> Vec<Observation> {
    let times = times_ms(laser, scans, odometry);
    let steps = scans.iter().zip(odometry).zip(times);
    steps
        .map(|((scan, odom), time_ms)| laser.observation(scan, time_ms, *odom))
        .collect()
}

/// Returns the session's time at each scan, milliseconds: the log's, but no step takes less than
/// the session's robot needs for it.
fn times_ms(laser: &LogLaser, scans: &[LogScan], odometry: &[Pose]) -> Vec<u32> {
    let limits = start(laser);
    let (speed, turn_rate): (f64, f64) = (limits.max_linear.to_num(), limits.max_angular.to_num());
    let began = scans.first().map_or(0.0, |scan| scan.time);
    let mut last: Option<(f64, Pose)> = None;
    let time = |(scan, odom): (&LogScan, &Pose)| {
        let mut time = scan.time - began;
        if let Some((before, from)) = last {
            let [x, y, turn] = compose(inverse(from), *odom);
            let needed = (x.hypot(y) / speed).max(wrap(turn).abs() / turn_rate);
            time = time.max(before + needed.max(0.001));
        }
        last = Some((time, *odom));
        (time * 1000.0).round() as u32
    };
    scans.iter().zip(odometry).map(time).collect()
}

/// Returns the number of the first scan, from 1, of which the map of a device of the default image
/// could not take everything; `None` if it takes all.
#[must_use]
pub fn map_full_at(
    laser: &LogLaser,
    scans: &[LogScan],
    odometry: &[Pose],
    tuning: &'static Tuning,
) -> Option<usize> {
    let mut mirror = Mirror::tuned(&start(laser), tuning);
    let times = times_ms(laser, scans, odometry);
    let steps = scans.iter().zip(odometry).zip(times);
    let full = steps.map(|((scan, odom), time_ms)| {
        mirror.observe(&laser.observation(scan, time_ms, *odom), Status::Exploring);
        mirror.is_full()
    });
    full.into_iter()
        .position(|full| full)
        .map(|place| place + 1)
}

/// Returns true if this many tiles are those of the default image.
#[must_use]
pub fn is_default_pool(tile_pool: u16) -> bool {
    usize::from(tile_pool) == TILES
}

/// Replays scans of a laser with this odometry, with a pose graph beside the device if `slam` has
/// the noise of the wheels. The watcher may end it.
///
/// # Errors
/// As [`LinkError`].
pub fn run(
    laser: &LogLaser,
    scans: &[LogScan],
    odometry: &[Pose],
    link: &mut dyn Link,
    slam: Option<Motion>,
    watch: &mut dyn Watch,
) -> Result<Replayed, LinkError> {
    let mut graph = slam.and_then(|motion| PoseGraph::new(&[*laser.announced()], motion));
    let tile_pool = link.hello()?.tile_pool;
    let start = start(laser);
    let (config, mut at_once) = (convert::config(&start, &Tuning::DEFAULT), AtOnce::default());
    let mut status = link.control(&Control::Start(start.clone()))?;
    let times = times_ms(laser, scans, odometry);
    let (mut poses, mut qualities) = (Vec::new(), Vec::new());
    let mut map_from_odom = [0.0; 3];
    let mut input_faults = InputFaults::default();
    let mut seen = Vec::new();
    let copies = link.end().inside().is_none();
    let mut showing = Showing::new(&start, scans.len(), copies);
    for ((scan, odom), time_ms) in scans.iter().zip(odometry).zip(times) {
        let (mut located, mut flow) = (None, Flow::Continue);
        let observation = laser.observation(scan, time_ms, *odom);
        if status == Status::Exploring {
            let asked = Instant::now();
            let command = link.observe(&observation)?;
            let step = (&observation, &command);
            flow = showing.step(step, asked.elapsed(), link, watch);
            status = command.status;
            located = command.location;
            input_faults = input_faults.after(command.input_faults);
        }
        if let Some(location) = &located {
            map_from_odom = compose(pose(location), inverse(*odom));
        }
        poses.push(compose(map_from_odom, *odom));
        if let (Some(graph), Ok(config)) = (&mut graph, &config) {
            let observation = at_once.take(config, &observation).into_owned();
            graph.observe(&observation, located.as_ref());
            seen.push(observation);
        }
        qualities.push(located.map_or(Quality::Lost, |location| location.quality));
        if flow == Flow::Interrupt {
            break;
        }
    }
    let places: Vec<[f64; 2]> = poses.iter().map(|pose| [pose[0], pose[1]]).collect();
    let mut replayed = Replayed {
        tiles: snapshot::tiles(link, &places)?,
        poses,
        slam: None,
        qualities,
        status,
        input_faults,
        tile_pool,
    };
    if let Some(mut graph) = graph {
        graph.finish();
        replayed.poses = graph.poses();
        let scans = seen.iter().zip(replayed.poses.iter().copied());
        let canvas = Canvas::of(&start, scans);
        replayed.tiles = canvas.map_or_else(BTreeMap::new, |canvas| canvas.tiles());
        replayed.slam = Some(graph.report());
    }
    Ok(replayed)
}

fn pose(location: &Location) -> Pose {
    [
        location.x.to_num(),
        location.y.to_num(),
        location.yaw.to_num(),
    ]
}

#[cfg(test)]
mod tests {
    use fieldline_device::SLOTS;

    use super::super::carmen::Beams;
    use super::*;
    use crate::link::direct::Direct;

    /// Returns a log of scans at the same time, a metre and a half apart along a corridor that is
    /// as long as the path, and without end for a laser; its walls are so far to the sides.
    fn log(scans: u32, aside_m: f64) -> Vec<LogScan> {
        let scan = |k: u32| {
            let beams = Beams::half_turn(181);
            let place = [1.5 * f64::from(k), 0.0, 0.0];
            let range = |beam: u32| {
                let angle = beams.first_rad + f64::from(beam) * beams.step_rad;
                (aside_m / angle.sin().abs().max(1e-3)).min(80.0)
            };
            LogScan {
                line: k as usize + 1,
                time: 1.13e9,
                ranges: (0..181).map(range).collect(),
                beams,
                laser: place,
                odometry: place,
                speed: [0.0; 2],
            }
        };
        (0..scans).map(scan).collect()
    }

    #[test]
    fn scans_far_apart_with_equal_times_are_no_jumps_of_odometry() {
        let scans = log(20, 1.2);
        let own = odometry(&scans, None, 0);
        let laser = LogLaser::of(&scans);
        let replayed = run(&laser, &scans, &own, &mut Direct::new(), None, &mut ());
        let replayed = replayed.unwrap();
        assert_eq!(replayed.input_faults, InputFaults::default());
        let [x, y, _] = replayed.poses[19];
        assert!((x - 28.5).abs() < 1.0 && y.abs() < 0.1, "{x} {y}");
        assert!(is_default_pool(replayed.tile_pool));
        assert_eq!(map_full_at(&laser, &scans, &own, &Tuning::DEFAULT), None);
    }

    #[test]
    fn a_map_that_has_no_room_says_at_which_scan() {
        // Four tiles across, one for each 3.2 m.
        let scans = log(250, 4.5);
        let own = odometry(&scans, None, 0);
        let laser = LogLaser::of(&scans);
        let full = map_full_at(&laser, &scans, &own, &Tuning::DEFAULT).unwrap();
        // Six columns of tiles more or less.
        let tiles = 4.0 * (1.5 * full as f64 + 12.0) / 3.2;
        assert!(
            (tiles - SLOTS as f64).abs() < 24.0,
            "scan {full}: {tiles} tiles"
        );
    }
}

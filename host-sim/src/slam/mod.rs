//! The pose graph on the host that relays the scans: loops are closed, and the past is corrected.
//!
//! ```text
//! observation, located pose ─► fieldline-slam ─► pose of every scan, corrected at each closure
//! ```
//!
//! A scan hangs on a keyframe, and moves with it. The graph takes the first laser, and a second one
//! that does not look down.
//!
//! Units: metres, radians, millimetres where a name says so.

mod canvas;
mod closer;
mod others;
pub mod particles;
mod votes;

use core::fmt;

use fieldline_protocol::message::{
    INVALID_MM, Laser, Location, NO_RETURN_MM, Observation, Quality, Scan,
};
use fieldline_slam as graph;
use serde::{Deserialize, Serialize};

pub use canvas::Canvas;
pub use closer::LoopCloser;
pub use fieldline_slam::Rules;

use crate::replay::relations::Pose;

/// Most keyframes. A robot that turns much makes four a metre, so they last for 4 km at least.
pub const KEYFRAMES: usize = 16_384;
/// Most closures. There is at most one each metre of way.
pub const CLOSURES: usize = 8_192;
/// Most ranges of all lasers.
const BEAMS: usize = graph::LASERS * fieldline_protocol::message::MAX_BEAMS;
/// Cells of 10 cm along the side of a grid: 51 m.
const SIDE: usize = 512;
/// Bytes of stack for what is made on the stack and then moved.
const STACK: usize = 64 << 20;

type Graph = graph::Slam<KEYFRAMES, CLOSURES, BEAMS>;
type Workspace = graph::Workspace<KEYFRAMES, SIDE>;

/// A pose graph of all scans of a run.
#[derive(Debug)]
pub struct PoseGraph {
    graph: Box<Graph>,
    workspace: Box<Workspace>,
    /// What each scan hangs on: a keyframe, and the pose in its frame.
    scans: Vec<(usize, graph::Pose)>,
    corrections: usize,
    largest_m: f32,
    is_full: bool,
}

/// Where loops are closed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SlamPlace {
    /// Nowhere.
    #[default]
    Off,
    /// On the host that relays the scans.
    Host,
}

/// What became of the loops, as in a report.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SlamReport {
    /// Where the graph ran: `host`.
    #[serde(rename = "where")]
    pub place: String,
    /// Keyframes.
    pub keyframes: usize,
    /// Closures in the graph.
    pub closed: usize,
    /// Tries to close a loop that brought no closure.
    pub refused: usize,
    /// Corrections of the device's map; in a replay, of the past poses.
    pub corrections: usize,
    /// Longest way by which a correction moved the robot, metres.
    pub largest_m: f64,
    /// The graph had no room for a further keyframe.
    pub is_full: bool,
}

impl fmt::Display for SlamReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} closures, {} refused, {} keyframes on the {}; {} corrections, at most {:.2} m",
            self.closed, self.refused, self.keyframes, self.place, self.corrections, self.largest_m,
        )?;
        if self.is_full {
            write!(
                f,
                "; the graph was full, and the rest of the way was not corrected"
            )?;
        }
        Ok(())
    }
}

impl PoseGraph {
    /// Returns an empty graph for the lasers of a robot and the noise of its wheels. `None` without
    /// a laser.
    #[must_use]
    pub fn new(lasers: &[Laser], motion: graph::Motion) -> Option<Self> {
        Some(Self::with(Self::config(lasers, motion)?))
    }

    /// Returns the usual configuration for the lasers of a robot and the noise of its wheels.
    /// `None` without a laser.
    #[must_use]
    pub fn config(lasers: &[Laser], motion: graph::Motion) -> Option<graph::Config> {
        let (first, others) = lasers.split_first()?;
        let config = graph::Config::new(graph_laser(first), motion);
        Some(match others {
            [second, ..] if second.pitch == 0 => config.with_second(graph_laser(second)),
            _ => config,
        })
    }

    /// Returns an empty graph.
    #[must_use]
    pub fn with(config: graph::Config) -> Self {
        Self {
            graph: made_on_a_large_stack(move || Graph::new(config)),
            workspace: made_on_a_large_stack(Workspace::default),
            scans: Vec::new(),
            corrections: 0,
            largest_m: 0.0,
            is_full: false,
        }
    }

    /// Takes the scans of an observation, with the pose that the device located. Returns the
    /// pose in the graph's map, and whether the past was corrected.
    pub fn observe(
        &mut self,
        observation: &Observation,
        location: Option<&Location>,
    ) -> (Pose, bool) {
        let located = location.filter(|it| it.quality != Quality::Lost);
        let located = located.map(|it| [it.x.to_num(), it.y.to_num(), it.yaw.to_num()]);
        self.observe_at(observation, located)
    }

    /// As [`PoseGraph::observe`], with the pose that the device located.
    pub fn observe_at(&mut self, observation: &Observation, located: Option<Pose>) -> (Pose, bool) {
        let odom = graph::Pose {
            x_m: observation.pose.x.to_num(),
            y_m: observation.pose.y.to_num(),
            yaw_rad: observation.pose.yaw.to_num(),
        };
        let located = located.map(graph_pose);
        let lasers = self.graph.config().lasers.iter();
        let ranges: Vec<u16> = lasers
            .zip(&observation.scans)
            .flat_map(|(laser, scan)| ranges_of(laser, scan))
            .collect();
        let seen = self
            .graph
            .observe(&odom, located.as_ref(), &ranges, &mut self.workspace);
        self.scans.push((seen.key, seen.from_key));
        self.is_full |= seen.is_full;
        if seen.moved_m > 0.0 {
            self.corrections += 1;
            self.largest_m = self.largest_m.max(seen.moved_m);
        }
        (pose(&seen.pose), seen.closed)
    }

    /// Tells that the device's map was corrected, and its located poses with it.
    pub fn relocate(&mut self, motion: Pose) {
        self.graph.relocate(&graph_pose(motion));
    }

    /// Says whether loops are closed from now on.
    pub fn set_closing(&mut self, closes: bool) {
        self.graph.set_closing(closes);
    }

    /// Solves the graph until it rests.
    pub fn finish(&mut self) {
        self.graph.finish(&mut self.workspace);
    }

    /// Returns the poses of all scans, as corrected so far.
    #[must_use]
    pub fn poses(&self) -> Vec<Pose> {
        let hung = self.scans.iter().map(|(key, from_key)| {
            let key = self.graph.pose(*key).unwrap_or_default();
            pose(&key.compose(from_key))
        });
        hung.collect()
    }

    /// Returns the counts so far.
    #[must_use]
    pub fn report(&self) -> SlamReport {
        let counts = self.graph.counts();
        SlamReport {
            place: "host".into(),
            keyframes: counts.keyframes,
            closed: counts.closed,
            refused: counts.refused,
            corrections: self.corrections,
            largest_m: f64::from(self.largest_m),
            is_full: self.is_full,
        }
    }
}

/// Makes a large thing in a thread with a large stack, and moves it to the heap.
///
/// # Panics
/// If the system has no memory for a thread.
fn made_on_a_large_stack<T: Send + 'static>(make: impl FnOnce() -> T + Send + 'static) -> Box<T> {
    let thread = std::thread::Builder::new().stack_size(STACK);
    let made = thread.spawn(|| Box::new(make()));
    made.expect("memory for a thread")
        .join()
        .expect("making it does not panic")
}

fn graph_laser(laser: &Laser) -> graph::Laser {
    graph::Laser {
        x_m: laser.x.to_num(),
        y_m: laser.y.to_num(),
        first_rad: laser.first_bearing.to_num(),
        step_rad: laser.bearing_step.to_num(),
        beams: laser.beams.into(),
        most_m: f32::from(laser.range_limit_mm) * 1e-3,
    }
}

/// Returns as many ranges as a laser has beams; those that a scan lacks are no readings.
fn ranges_of(laser: &graph::Laser, scan: &Scan) -> impl Iterator<Item = u16> {
    let ranges = scan.ranges_mm.iter().map(|&range_mm| match range_mm {
        INVALID_MM => 0,
        NO_RETURN_MM => u16::MAX,
        measured => measured,
    });
    ranges.chain(core::iter::repeat(0)).take(laser.beams)
}

fn graph_pose([x, y, yaw]: Pose) -> graph::Pose {
    graph::Pose {
        x_m: x as f32,
        y_m: y as f32,
        yaw_rad: yaw as f32,
    }
}

fn pose(pose: &graph::Pose) -> Pose {
    [pose.x_m, pose.y_m, pose.yaw_rad].map(f64::from)
}

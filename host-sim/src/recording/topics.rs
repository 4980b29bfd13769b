//! What a step tells on the topics of ROS 2.
//!
//! Frames: `map` and `odom` agree at the start; `base_link` is the robot's centre on the ground,
//! `laser` and `laser_2` its lasers. The true pose is told in `map` too.

use std::collections::BTreeMap;

use fieldline_protocol::message::{INVALID_MM, Laser, NO_RETURN_MM, Pose as Wire};

use super::Recording;
use super::ros::{
    Float32, Header, LaserScan, Log, MapMetaData, OccupancyGrid, Odometry, Path, Pose, PoseStamped,
    TFMessage, Text, TransformStamped, Twist, Vector3,
};
use crate::link::inside::Key;
use crate::report::grid_map::{CELL_M, TILE_SIDE};
use crate::report::mission_log::MissionLog;
use crate::report::tum::Stamped;
use crate::trial::planned_path::{self, PlannedPath};
use crate::trial::sight::Sight;
use crate::trial::snapshot::{Window, WindowCell};
use crate::trial::{Step, wording};

/// Times between two maps, and between two fields and paths, milliseconds.
const MAP_MS: u32 = 5_000;
const PLAN_MS: u32 = 1_000;
/// Names of the lasers: topic and frame.
const LASERS: [[&str; 2]; 2] = [["/scan", "laser"], ["/scan_2", "laser_2"]];

/// What was told.
#[derive(Debug)]
pub(super) struct Topics {
    is_begun: bool,
    /// The map's changes that were told, and when to tell more.
    edits: Option<u32>,
    map_due_ms: u32,
    plan_due_ms: u32,
    path: PlannedPath,
    status: String,
    log: MissionLog,
}

impl Default for Topics {
    fn default() -> Self {
        Self {
            is_begun: false,
            edits: None,
            map_due_ms: 0,
            plan_due_ms: 0,
            path: PlannedPath::default(),
            status: String::new(),
            log: MissionLog::new(),
        }
    }
}

impl Topics {
    /// Tells a step.
    pub(super) fn tell(&mut self, sight: &Sight<'_>, to: &mut Recording) {
        let Some(step) = sight.step() else {
            return;
        };
        let time_ms = step.truth.time_ms;
        to.set_time(time_ms);
        let lasers = &sight.setup.start.lasers;
        if !self.is_begun {
            self.is_begun = true;
            to.tell("/tf_static", &mounts(lasers));
        }
        tell_poses(step, sight, to);
        tell_scans(time_ms, lasers, sight, to);
        self.tell_words(step, to);
        if !sight.again {
            let data = sight.record().coverage as f32;
            to.tell("/coverage", &Float32 { data });
        }
        self.tell_map(time_ms, sight, to);
        self.tell_plan(time_ms, sight, to);
    }

    /// Tells the path, if it changed, and the field.
    fn tell_plan(&mut self, time_ms: u32, sight: &Sight<'_>, to: &mut Recording) {
        let inside = sight.inside().filter(|_| time_ms >= self.plan_due_ms);
        let Some(inside) = inside else {
            return;
        };
        self.plan_due_ms = time_ms + PLAN_MS;
        let path = inside.path();
        if path != self.path {
            to.tell("/plan", &plan(time_ms, &path));
            self.path = path;
        }
        if let Some(window) = inside.field() {
            to.tell("/field", &field(time_ms, &window));
        }
    }

    /// Tells the status, and what the robot does and why.
    fn tell_words(&mut self, step: &Step, to: &mut Recording) {
        let status = wording::status(step.command.status);
        if status != self.status {
            let data = status.clone();
            to.tell("/status", &Text { data });
            self.status = status;
        }
        if let Some(entry) = self.log.note(&step.estimate, &step.command) {
            to.tell("/rosout", &Log::info(step.truth.time_ms, entry.to_string()));
        }
    }

    fn tell_map(&mut self, time_ms: u32, sight: &Sight<'_>, to: &mut Recording) {
        let is_due = time_ms >= self.map_due_ms || sight.ending.is_some();
        let edits = sight.map_edits();
        if !is_due || edits.is_none() || edits == self.edits {
            return;
        }
        self.edits = edits;
        self.map_due_ms = time_ms + MAP_MS;
        if let Some(map) = map(time_ms, &sight.map_tiles()) {
            to.tell("/map", &map);
        }
    }
}

fn tell_poses(step: &Step, sight: &Sight<'_>, to: &mut Recording) {
    let (time_ms, observation) = (step.truth.time_ms, sight.observation);
    let odom = in_odometry(&observation.pose);
    let twist = Twist::of(
        observation.velocity.linear.to_num(),
        observation.velocity.angular.to_num(),
    );
    to.tell(
        "/odom",
        &Odometry {
            header: Header::new(time_ms, "odom"),
            child_frame_id: "base_link".into(),
            pose: (odom, Default::default()),
            twist: (twist, Default::default()),
        },
    );
    let told = [
        ("map", "odom", map_from_odom(step, &observation.pose)),
        ("odom", "base_link", odom),
    ];
    let transforms = told.map(|(frame, child, transform)| TransformStamped {
        header: Header::new(time_ms, frame),
        child_frame_id: child.into(),
        transform,
    });
    to.tell(
        "/tf",
        &TFMessage {
            transforms: transforms.into(),
        },
    );
    let truth = (!sight.again).then_some(("/true_pose", &step.truth));
    for (topic, pose) in [("/pose", &step.estimate)].into_iter().chain(truth) {
        to.tell(
            topic,
            &PoseStamped {
                header: Header::new(time_ms, "map"),
                pose: pose.into(),
            },
        );
    }
    let velocity = step.command.velocity;
    let velocity = Twist::of(velocity.linear.to_num(), velocity.angular.to_num());
    to.tell("/cmd_vel", &velocity);
}

fn in_odometry(pose: &Wire) -> Pose {
    let position = Vector3 {
        x: pose.x.to_num(),
        y: pose.y.to_num(),
        z: pose.z.to_num(),
    };
    let turns = [pose.roll, pose.pitch, pose.yaw].map(|it| it.to_num());
    Pose::at(position, turns)
}

/// Returns the motion that takes the odometry's frame to the map's: a turn in the plane, and a
/// shift.
fn map_from_odom(Step { estimate, .. }: &Step, odom: &Wire) -> Pose {
    let Stamped {
        x_m, y_m, yaw_rad, ..
    } = *estimate;
    let [x, y, yaw]: [f64; 3] = [odom.x, odom.y, odom.yaw].map(|it| it.to_num());
    let turn = yaw_rad - yaw;
    let (sin, cos) = turn.sin_cos();
    Pose::flat(x_m - (cos * x - sin * y), y_m - (sin * x + cos * y), turn)
}

fn mounts(lasers: &[Laser]) -> TFMessage {
    let named = lasers.iter().zip(LASERS);
    let transforms = named.map(|(laser, [_, frame])| {
        let [x, y, z] = [laser.x, laser.y, laser.z].map(|it| it.to_num());
        TransformStamped {
            header: Header::new(0, "base_link"),
            child_frame_id: frame.into(),
            transform: Pose::at(Vector3 { x, y, z }, [0.0, laser.pitch.to_num(), 0.0]),
        }
    });
    TFMessage {
        transforms: transforms.collect(),
    }
}

/// Tells the scans: infinity for a beam without a return, no number for one that tells nothing.
fn tell_scans(time_ms: u32, lasers: &[Laser], sight: &Sight<'_>, to: &mut Recording) {
    let scans = lasers.iter().zip(&sight.observation.scans).zip(LASERS);
    for ((laser, scan), [topic, frame]) in scans {
        let ranges = scan.ranges_mm.iter().map(|&range_mm| match range_mm {
            NO_RETURN_MM => f32::INFINITY,
            INVALID_MM => f32::NAN,
            range_mm => f32::from(range_mm) / 1000.0,
        });
        let (first, step) = (laser.first_bearing, laser.bearing_step);
        let (first, step): (f32, f32) = (first.to_num(), step.to_num());
        let steps = scan.ranges_mm.len().saturating_sub(1) as f32;
        to.tell(
            topic,
            &LaserScan {
                header: Header::new(time_ms, frame),
                angle_min: first,
                angle_max: first + steps * step,
                angle_increment: step,
                scan_time: f32::from(sight.setup.start.period_ms) / 1000.0,
                range_max: f32::from(laser.range_limit_mm) / 1000.0,
                ranges: ranges.collect(),
                ..LaserScan::default()
            },
        );
    }
}

fn plan(time_ms: u32, path: &PlannedPath) -> Path {
    let header = Header::new(time_ms, "map");
    let pose = |place| {
        let [x, y] = planned_path::middle_m(place);
        PoseStamped {
            header: header.clone(),
            pose: Pose::flat(x, y, 0.0),
        }
    };
    Path {
        poses: path.cells.iter().copied().map(pose).collect(),
        header: header.clone(),
    }
}

/// Returns a grid of ROS: −1 is unknown.
fn grid(
    time_ms: u32,
    (origin, cell_m): ([f64; 2], f64),
    [width, height]: [usize; 2],
    data: Vec<i8>,
) -> OccupancyGrid {
    let [x, y] = origin;
    OccupancyGrid {
        header: Header::new(time_ms, "map"),
        info: MapMetaData {
            resolution: cell_m as f32,
            width: width as u32,
            height: height as u32,
            origin: Pose::flat(x, y, 0.0),
            ..MapMetaData::default()
        },
        data,
    }
}

/// Returns the map: 0 free, 100 obstacle or hole; `None` without a tile.
fn map(time_ms: u32, tiles: &BTreeMap<Key, [u8; 256]>) -> Option<OccupancyGrid> {
    let side = TILE_SIDE as usize;
    let span = |of: fn(&Key) -> i16| {
        let least = tiles.keys().map(of).min()?;
        let most = tiles.keys().map(of).max()?;
        Some((
            i32::from(least),
            (i32::from(most) - i32::from(least) + 1) as usize,
        ))
    };
    let (x0, columns) = span(|key| key.0)?;
    let (y0, rows) = span(|key| key.1)?;
    let width = columns * side;
    let mut data = vec![-1; width * rows * side];
    for (&(x, y), cells) in tiles {
        let corner =
            (i32::from(x) - x0) as usize * side + (i32::from(y) - y0) as usize * side * width;
        for (at, pair) in (0..side * side).map(|at| (at, cells[at / 4] >> (2 * (at % 4)) & 3)) {
            data[corner + at / side * width + at % side] = match pair {
                0 => -1,
                1 => 0,
                _ => 100,
            };
        }
    }
    let origin = [x0, y0].map(|at| f64::from(at * TILE_SIDE) * CELL_M);
    Some(grid(time_ms, (origin, CELL_M), [width, rows * side], data))
}

/// Returns the window's field: 100 at a goal, 0 where no goal leads, −1 on obstacles.
fn field(time_ms: u32, window: &Window) -> OccupancyGrid {
    let side = window.cells.len().isqrt();
    let cells = window.q.iter().zip(&window.cells);
    let data = cells.map(|(q, cell)| match cell {
        WindowCell::Obstacle => -1,
        WindowCell::Goal => 100,
        WindowCell::Free => (100.0 * q) as i8,
    });
    let origin = [window.origin_x, window.origin_y].map(|at| f64::from(at) * window.cell_m);
    grid(time_ms, (origin, window.cell_m), [side; 2], data.collect())
}

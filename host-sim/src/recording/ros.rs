//! ROS 2's messages, and their bytes: CDR, little endian, behind a head of four bytes.
//!
//! Fields stand in the order of `definitions.rs`. Frames and units are those of REP 103 and 105:
//! metres, radians, x ahead, y to the left; `map`, `odom`, `base_link`.

use byteorder::LittleEndian;
use serde::Serialize;

use crate::report::tum::Stamped;

/// The head of little-endian CDR.
const HEAD: [u8; 4] = [0, 1, 0, 0];

/// A message that has a name in ROS 2.
pub(super) trait Message: Serialize {
    /// Its name, as in `nav_msgs/msg/Path`.
    const NAME: &'static str;
}

/// Returns the bytes of a message; `None` if it cannot be told, as a text with a zero.
pub(super) fn bytes<M: Message>(message: &M) -> Option<Vec<u8>> {
    let body = cdr_encoding::to_vec::<M, LittleEndian>(message).ok()?;
    Some([&HEAD[..], &body].concat())
}

#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(super) struct Time {
    sec: i32,
    nanosec: u32,
}

impl Time {
    pub(super) const fn of_ms(time_ms: u32) -> Self {
        Self {
            // At most 4,294,967 seconds.
            sec: (time_ms / 1000) as i32,
            nanosec: time_ms % 1000 * 1_000_000,
        }
    }
}

#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct Header {
    stamp: Time,
    frame_id: String,
}

impl Header {
    pub(super) fn new(time_ms: u32, frame_id: &str) -> Self {
        Self {
            stamp: Time::of_ms(time_ms),
            frame_id: frame_id.into(),
        }
    }
}

/// A point, and a vector.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(super) struct Vector3 {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) z: f64,
}

#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct Quaternion {
    x: f64,
    y: f64,
    z: f64,
    w: f64,
}

impl Default for Quaternion {
    fn default() -> Self {
        Self::of(0.0, 0.0, 0.0)
    }
}

impl Quaternion {
    /// Turns by roll, then pitch, then yaw, about fixed axes, radians.
    fn of(roll: f64, pitch: f64, yaw: f64) -> Self {
        let [(sr, cr), (sp, cp), (sy, cy)] = [roll, pitch, yaw].map(|it| (0.5 * it).sin_cos());
        Self {
            x: sr * cp * cy - cr * sp * sy,
            y: cr * sp * cy + sr * cp * sy,
            z: cr * cp * sy - sr * sp * cy,
            w: cr * cp * cy + sr * sp * sy,
        }
    }
}

/// A pose, and a transform, whose fields are the same.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(super) struct Pose {
    pub(super) position: Vector3,
    pub(super) orientation: Quaternion,
}

impl Pose {
    pub(super) fn at(position: Vector3, [roll, pitch, yaw]: [f64; 3]) -> Self {
        Self {
            position,
            orientation: Quaternion::of(roll, pitch, yaw),
        }
    }

    /// A pose in the plane.
    pub(super) fn flat(x: f64, y: f64, yaw: f64) -> Self {
        Self::at(Vector3 { x, y, z: 0.0 }, [0.0, 0.0, yaw])
    }
}

impl From<&Stamped> for Pose {
    fn from(pose: &Stamped) -> Self {
        let position = Vector3 {
            x: pose.x_m,
            y: pose.y_m,
            z: pose.z_m,
        };
        Self::at(position, [pose.roll_rad, pose.pitch_rad, pose.yaw_rad])
    }
}

#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct PoseStamped {
    pub(super) header: Header,
    pub(super) pose: Pose,
}

impl Message for PoseStamped {
    const NAME: &'static str = "geometry_msgs/msg/PoseStamped";
}

#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(super) struct Twist {
    linear: Vector3,
    angular: Vector3,
}

impl Twist {
    /// Ahead, metres a second, and counter-clockwise, radians a second.
    pub(super) fn of(ahead: f64, left: f64) -> Self {
        let zero = Vector3::default();
        Self {
            linear: Vector3 { x: ahead, ..zero },
            angular: Vector3 { z: left, ..zero },
        }
    }
}

impl Message for Twist {
    const NAME: &'static str = "geometry_msgs/msg/Twist";
}

/// A covariance of x, y, z and the turns about them, row by row; zero is unknown.
type Covariance = [[f64; 6]; 6];

#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct Odometry {
    pub(super) header: Header,
    pub(super) child_frame_id: String,
    pub(super) pose: (Pose, Covariance),
    pub(super) twist: (Twist, Covariance),
}

impl Message for Odometry {
    const NAME: &'static str = "nav_msgs/msg/Odometry";
}

#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct TransformStamped {
    pub(super) header: Header,
    pub(super) child_frame_id: String,
    pub(super) transform: Pose,
}

#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct TFMessage {
    pub(super) transforms: Vec<TransformStamped>,
}

impl Message for TFMessage {
    const NAME: &'static str = "tf2_msgs/msg/TFMessage";
}

#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct LaserScan {
    pub(super) header: Header,
    pub(super) angle_min: f32,
    pub(super) angle_max: f32,
    pub(super) angle_increment: f32,
    pub(super) time_increment: f32,
    pub(super) scan_time: f32,
    pub(super) range_min: f32,
    pub(super) range_max: f32,
    pub(super) ranges: Vec<f32>,
    pub(super) intensities: Vec<f32>,
}

impl Message for LaserScan {
    const NAME: &'static str = "sensor_msgs/msg/LaserScan";
}

#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct MapMetaData {
    pub(super) map_load_time: Time,
    pub(super) resolution: f32,
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) origin: Pose,
}

#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct OccupancyGrid {
    pub(super) header: Header,
    pub(super) info: MapMetaData,
    pub(super) data: Vec<i8>,
}

impl Message for OccupancyGrid {
    const NAME: &'static str = "nav_msgs/msg/OccupancyGrid";
}

#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct Path {
    pub(super) header: Header,
    pub(super) poses: Vec<PoseStamped>,
}

impl Message for Path {
    const NAME: &'static str = "nav_msgs/msg/Path";
}

#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct Text {
    pub(super) data: String,
}

impl Message for Text {
    const NAME: &'static str = "std_msgs/msg/String";
}

#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct Float32 {
    pub(super) data: f32,
}

impl Message for Float32 {
    const NAME: &'static str = "std_msgs/msg/Float32";
}

#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct Log {
    stamp: Time,
    level: u8,
    name: String,
    msg: String,
    file: String,
    function: String,
    line: u32,
}

impl Log {
    /// Something to know, from the planner.
    pub(super) fn info(time_ms: u32, msg: String) -> Self {
        Self {
            stamp: Time::of_ms(time_ms),
            level: 20,
            name: "fieldline".into(),
            msg,
            ..Self::default()
        }
    }
}

impl Message for Log {
    const NAME: &'static str = "rcl_interfaces/msg/Log";
}

#[cfg(test)]
mod tests {
    use core::f64::consts::FRAC_1_SQRT_2;

    use super::{Header, Path, Pose, PoseStamped, Quaternion, Text, Time, Vector3, bytes};

    #[test]
    fn bytes_are_those_of_the_standard() {
        let text = Text { data: "ab".into() };
        let wanted = [0, 1, 0, 0, 3, 0, 0, 0, b'a', b'b', 0];
        assert_eq!(bytes(&text), Some(wanted.to_vec()));

        let path = Path {
            header: Header::new(1_250, "map"),
            poses: vec![PoseStamped {
                header: Header::default(),
                pose: Pose::flat(1.0, -2.0, 0.0),
            }],
        };
        let path = bytes(&path).expect("bytes");
        // Seconds, nanoseconds, the frame with its length, the number of poses.
        assert_eq!(path[4..12], [1, 0, 0, 0, 0x80, 0xb2, 0xe6, 0x0e]);
        assert_eq!(path[12..20], [4, 0, 0, 0, b'm', b'a', b'p', 0]);
        assert_eq!(path[20..24], [1, 0, 0, 0]);
        // Time, an empty frame of one zero, and x at the next multiple of eight behind the head.
        assert_eq!(path[32..37], [1, 0, 0, 0, 0]);
        assert_eq!(path[44..52], 1.0_f64.to_le_bytes());
        assert_eq!(path[52..60], (-2.0_f64).to_le_bytes());
        assert_eq!(path.len(), 44 + 7 * 8);
    }

    #[test]
    fn a_quarter_turn_left_is_about_z() {
        let Quaternion { x, y, z, w } = Quaternion::of(0.0, 0.0, core::f64::consts::FRAC_PI_2);
        assert!(x.abs() + y.abs() < 1e-12);
        assert!((z - FRAC_1_SQRT_2).abs() + (w - FRAC_1_SQRT_2).abs() < 1e-12);
        let Quaternion { x, z, .. } = Quaternion::of(0.2, 0.0, 0.0);
        assert!((x - 0.1_f64.sin()).abs() + z.abs() < 1e-12);
        let at = Pose::at(Vector3::default(), [0.0, 0.1, 0.0]);
        assert!(at.orientation.y > 0.0);
    }

    #[test]
    fn time_is_seconds_and_nanoseconds() {
        let Time { sec, nanosec } = Time::of_ms(u32::MAX);
        assert_eq!((sec, nanosec), (4_294_967, 295_000_000));
    }
}

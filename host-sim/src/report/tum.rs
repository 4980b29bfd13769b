//! Trajectories in the TUM format: `timestamp tx ty tz qx qy qz qw`, one pose a line, seconds and
//! metres.
//!
//! The orientation is the unit quaternion of yaw about z, then pitch about the new y, then roll
//! about the new x: `q = q_z(yaw) q_y(pitch) q_x(roll)`.

/// A pose with its time, in the frame of the map.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stamped {
    /// Simulated milliseconds.
    pub time_ms: u32,
    /// Metres.
    pub x_m: f64,
    /// Metres.
    pub y_m: f64,
    /// Metres.
    pub z_m: f64,
    /// Radians about the forward axis.
    pub roll_rad: f64,
    /// Radians about the left axis, positive nose down.
    pub pitch_rad: f64,
    /// Radians about the up axis.
    pub yaw_rad: f64,
}

/// Returns the text of the file, one line for each pose.
#[must_use]
pub fn text(poses: &[Stamped]) -> String {
    let stamp = |pose: &Stamped| format!("{}.{:03}", pose.time_ms / 1000, pose.time_ms % 1000);
    poses.iter().map(|pose| line(&stamp(pose), pose)).collect()
}

/// Returns the text of the file with times in seconds of another clock, one for each pose.
#[must_use]
pub fn at_times(times_s: &[f64], poses: &[Stamped]) -> String {
    let rows = times_s.iter().zip(poses);
    rows.map(|(time_s, pose)| line(&format!("{time_s:.6}"), pose))
        .collect()
}

fn line(stamp: &str, pose: &Stamped) -> String {
    let [qx, qy, qz, qw] = quaternion(pose);
    format!(
        "{stamp} {:.6} {:.6} {:.6} {qx:.7} {qy:.7} {qz:.7} {qw:.7}\n",
        pose.x_m, pose.y_m, pose.z_m
    )
}

fn quaternion(pose: &Stamped) -> [f64; 4] {
    let (sr, cr) = (pose.roll_rad / 2.0).sin_cos();
    let (sp, cp) = (pose.pitch_rad / 2.0).sin_cos();
    let (sy, cy) = (pose.yaw_rad / 2.0).sin_cos();
    [
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    ]
}

#[cfg(test)]
mod tests {
    use super::{Stamped, quaternion, text};
    use core::f64::consts::FRAC_PI_2;

    #[test]
    fn lines_are_exact() {
        let poses = [
            Stamped::default(),
            Stamped {
                time_ms: 61_050,
                x_m: 1.5,
                y_m: -2.25,
                z_m: 0.125,
                yaw_rad: FRAC_PI_2,
                ..Stamped::default()
            },
        ];
        assert_eq!(
            text(&poses),
            "0.000 0.000000 0.000000 0.000000 0.0000000 0.0000000 0.0000000 1.0000000\n\
             61.050 1.500000 -2.250000 0.125000 0.0000000 0.0000000 0.7071068 0.7071068\n"
        );
    }

    /// The quaternion turns the forward axis to the direction given by yaw and pitch.
    #[test]
    fn the_quaternion_turns_the_forward_axis() {
        let pose = Stamped {
            roll_rad: 0.3,
            pitch_rad: 0.4,
            yaw_rad: 1.1,
            ..Stamped::default()
        };
        let [x, y, z, w] = quaternion(&pose);
        let forward = [
            1.0 - 2.0 * (y * y + z * z),
            2.0 * (x * y + w * z),
            2.0 * (x * z - w * y),
        ];
        let expected = [
            0.4_f64.cos() * 1.1_f64.cos(),
            0.4_f64.cos() * 1.1_f64.sin(),
            -0.4_f64.sin(),
        ];
        for (f, e) in forward.iter().zip(expected) {
            assert!((f - e).abs() < 1e-12, "{forward:?} {expected:?}");
        }
    }
}

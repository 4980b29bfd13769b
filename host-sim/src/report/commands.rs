//! `commands.csv`: estimated pose and command, one line a step.
//!
//! Columns: `time_s, x_m, y_m, yaw_rad` (the estimate), `v_mps, w_radps` (the command),
//! `heading_rad` (the field's direction), `cycles` (of the solver), `status`.

use core::fmt::Write as _;

use fieldline_protocol::message::Command;

use super::tum::Stamped;

/// Names of the columns.
pub const HEADER: &str = "time_s,x_m,y_m,yaw_rad,v_mps,w_radps,heading_rad,cycles,status";

/// Returns the text of the file.
#[must_use]
pub fn text<'a>(rows: impl Iterator<Item = (&'a Stamped, &'a Command)>) -> String {
    let mut out = format!("{HEADER}\n");
    for (pose, command) in rows {
        // Writing into a string does not fail.
        let _ = writeln!(
            out,
            "{}.{:03},{:.4},{:.4},{:.5},{:.6},{:.6},{:.5},{},{}",
            pose.time_ms / 1000,
            pose.time_ms % 1000,
            pose.x_m,
            pose.y_m,
            pose.yaw_rad,
            command.velocity.linear.to_num::<f64>(),
            command.velocity.angular.to_num::<f64>(),
            command.heading.to_num::<f64>(),
            command.cost.cycles,
            crate::trial::wording::status(command.status),
        );
    }
    out
}

#[cfg(test)]
mod tests {
    use super::text;
    use crate::report::tum::Stamped;
    use fieldline_protocol::message::{Command, Finish, Status, Twist};
    use fixed::types::{I4F12, I16F16};

    #[test]
    fn lines_are_exact() {
        let pose = Stamped {
            time_ms: 1_200,
            x_m: 1.25,
            y_m: -0.5,
            yaw_rad: 0.75,
            ..Stamped::default()
        };
        let mut command = Command {
            velocity: Twist {
                linear: I4F12::from_num(0.5),
                angular: I4F12::from_num(-0.25),
            },
            status: Status::Exploring,
            heading: I16F16::from_num(1.5),
            ..Command::default()
        };
        command.cost.cycles = 3;
        let last = Command {
            status: Status::Finished(Finish::Explored),
            ..Command::default()
        };
        let rows = [(pose, command), (pose, last)];
        assert_eq!(
            text(rows.iter().map(|(pose, command)| (pose, command))),
            "time_s,x_m,y_m,yaw_rad,v_mps,w_radps,heading_rad,cycles,status\n\
             1.200,1.2500,-0.5000,0.75000,0.500000,-0.250000,1.50000,3,exploring\n\
             1.200,1.2500,-0.5000,0.75000,0.000000,0.000000,0.00000,0,finished(explored)\n"
        );
    }
}

//! A robot that is held by something that its laser does not see: a bar across a corridor, below
//! the laser's plane.

use fieldline_planner::{
    Config, F405, Input, LaserMount, Output, Planner, Pose, RobotShape, Status, Twist,
};

const PERIOD_S: f32 = 0.2;
/// Half the corridor's width, and its ends, metres.
const HALF_WIDTH_M: f32 = 1.5;
const ENDS_M: [f32; 2] = [-3.0, 30.0];
/// Where the bar begins, metres.
const BAR_M: f32 = 1.5;

/// The robot and what its wheels do. The heading is exact; the bar stops all motion into it.
struct Robot {
    pose: Pose,
    velocity: Twist,
    /// Periods in a row in which it pushed against the bar, and the most of them.
    pushes: u32,
    most_pushes: u32,
}

impl Robot {
    fn scan(&self) -> [u16; 181] {
        core::array::from_fn(|beam| {
            let angle = self.pose.yaw_rad + (beam as f32 - 90.0).to_radians();
            let (sin, cos) = angle.sin_cos();
            let to = |walls: [f32; 2], at: f32, along: f32| {
                let wall = walls[usize::from(along > 0.0)];
                if along.abs() < 1e-6 {
                    f32::MAX
                } else {
                    (wall - at) / along
                }
            };
            let x_m = to(ENDS_M, self.pose.x_m, cos);
            let y_m = to([-HALF_WIDTH_M, HALF_WIDTH_M], self.pose.y_m, sin);
            let range_mm = 1000.0 * x_m.min(y_m);
            if range_mm > 12_000.0 {
                16_383
            } else {
                range_mm as u16
            }
        })
    }

    /// Follows a command for one period, within the accelerations of a Pioneer 3-AT.
    fn drive(&mut self, told: Twist) {
        let towards = |from: f32, to: f32, most: f32| from + (to - from).clamp(-most, most);
        let v = towards(self.velocity.linear_mps, told.linear_mps, 0.3 * PERIOD_S);
        let w = towards(
            self.velocity.angular_radps,
            told.angular_radps,
            1.75 * PERIOD_S,
        );
        let yaw_rad = self.pose.yaw_rad + w * PERIOD_S;
        let x_m = self.pose.x_m + v * PERIOD_S * yaw_rad.cos();
        let y_m = self.pose.y_m + v * PERIOD_S * yaw_rad.sin();
        // The foremost corner of the hull.
        let (length_m, width_m) = (0.26, 0.25);
        let reach_m = length_m * yaw_rad.cos().abs() + width_m * yaw_rad.sin().abs();
        if x_m + reach_m > BAR_M {
            self.velocity = Twist::default();
            self.pushes += 1;
            self.most_pushes = self.most_pushes.max(self.pushes);
            return;
        }
        self.pushes = 0;
        self.velocity = Twist {
            linear_mps: v,
            angular_radps: w,
        };
        self.pose = Pose {
            x_m,
            y_m,
            yaw_rad,
            ..self.pose
        };
    }
}

#[test]
fn a_held_robot_stops_pushing_and_the_run_ends() {
    let config = Config::builder(RobotShape::PIONEER_3AT)
        .laser(LaserMount::level(0.10, 0.40))
        .period_s(PERIOD_S)
        .build()
        .expect("valid");
    let mut planner = Box::new(Planner::<F405>::new(&config));
    let mut robot = Robot {
        pose: Pose::default(),
        velocity: Twist::default(),
        pushes: 0,
        most_pushes: 0,
    };
    let mut output = Output::default();
    for step in 0..5 * 1800 {
        let ranges_mm = robot.scan();
        output = planner.step(&Input {
            time_ms: step * 200,
            pose: robot.pose,
            velocity: robot.velocity,
            scans: [&ranges_mm, &[]],
        });
        if output.status != Status::Exploring {
            break;
        }
        robot.drive(output.velocity);
    }
    assert!(robot.most_pushes > 0, "the bar is met");
    assert!(
        robot.most_pushes <= 4,
        "{} pushes in a row",
        robot.most_pushes
    );
    assert_ne!(output.status, Status::Exploring, "half an hour is enough");
    assert!(
        !planner.frontiers().is_empty(),
        "what lies behind the bar is listed"
    );
}

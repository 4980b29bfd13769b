//! A closed loop for link tests: a robot with two lasers in a rectangular room, driven by the
//! commands of a link.

#![allow(dead_code, reason = "each test file uses its part")]

use fieldline_protocol::message::{
    Budget, Command, Control, Fence, Hull, Laser, LoopLimits, NO_RETURN_MM, Observation, Order,
    Pose, Scan, Start, Status, Strategy, Twist,
};
use fixed::types::{I4F12, I16F16};
use host_sim::link::digest::Digest;
use host_sim::link::{Link, LinkError};

/// Half the sides of the room, metres.
const HALF: (f64, f64) = (4.0, 3.0);
/// Time of a step, seconds.
const STEP_S: f64 = 0.1;
const PITCH: f64 = 0.349;
const LASER_Z: f64 = 0.4;

/// The 3-AT with a level and a tilted laser.
pub(crate) fn start() -> Start {
    let level = Laser {
        x: I4F12::ZERO,
        y: I4F12::ZERO,
        z: I4F12::from_num(LASER_Z),
        pitch: I4F12::ZERO,
        first_bearing: I16F16::from_num(-core::f64::consts::FRAC_PI_2),
        bearing_step: I16F16::from_num(core::f64::consts::PI / 180.0),
        beams: 181,
        range_limit_mm: 12_000,
        ..Laser::default()
    };
    let tilted = Laser {
        pitch: I4F12::from_num(PITCH),
        ..level
    };
    Start {
        strategy: Strategy::Frontier,
        lasers: [level, tilted].into_iter().collect(),
        hull: Hull::default(),
        robot_radius_mm: 300,
        max_linear: I4F12::from_num(0.7),
        max_angular: I4F12::from_num(2.44),
        linear_accel: I4F12::from_num(0.3),
        angular_accel: I4F12::from_num(1.745),
        period_ms: 200,
        uneven_ground: None,
        loops: LoopLimits::default(),
        order: Order::default(),
        team: None,
        localise: false,
        survey: false,
        fence: Fence::default(),
        budget: Budget::default(),
    }
}

/// The robot's state and its last command.
pub(crate) struct Robot {
    x: f64,
    y: f64,
    yaw: f64,
    velocity: Twist,
    time_ms: u32,
    /// Digest of the commands so far.
    pub(crate) digest: Digest,
    /// Number of commands so far.
    pub(crate) steps: u32,
    /// The last command.
    pub(crate) last: Command,
}

impl Robot {
    pub(crate) fn new() -> Self {
        Self {
            x: -1.0,
            y: 0.5,
            yaw: 0.3,
            velocity: Twist::default(),
            time_ms: 0,
            digest: Digest::new(),
            steps: 0,
            last: Command::default(),
        }
    }

    fn range_m(&self, bearing: f64) -> f64 {
        let (sin, cos) = (self.yaw + bearing).sin_cos();
        let to = |at: f64, half: f64, d: f64| {
            if d.abs() < 1e-9 {
                f64::INFINITY
            } else {
                (half.copysign(d) - at) / d
            }
        };
        to(self.x, HALF.0, cos).min(to(self.y, HALF.1, sin))
    }

    fn scan(&self, pitch: f64) -> Scan {
        let ground = if pitch > 0.0 {
            LASER_Z / pitch.sin()
        } else {
            f64::INFINITY
        };
        let range = |beam: i32| {
            let bearing = f64::from(beam - 90).to_radians();
            let range = (self.range_m(bearing) / pitch.cos()).min(ground);
            if range > 12.0 {
                NO_RETURN_MM
            } else {
                (range * 1000.0).round() as u16
            }
        };
        Scan {
            ranges_mm: (0..181).map(range).collect(),
        }
    }

    /// The current observation.
    pub(crate) fn sense(&self) -> Observation {
        let pose = Pose {
            x: I16F16::from_num(self.x),
            y: I16F16::from_num(self.y),
            yaw: I16F16::from_num(self.yaw),
            ..Pose::default()
        };
        Observation {
            time_ms: self.time_ms,
            pose,
            velocity: self.velocity,
            scans: [self.scan(0.0), self.scan(PITCH)].into_iter().collect(),
        }
    }

    /// Lets one step pass without a command.
    pub(crate) fn wait(&mut self) {
        self.time_ms += 100;
    }

    fn drive(&mut self, command: &Command) {
        self.digest.add(command);
        self.steps += 1;
        self.last = *command;
        self.velocity = command.velocity;
        let linear: f64 = command.velocity.linear.to_num();
        let angular: f64 = command.velocity.angular.to_num();
        self.x = (self.x + linear * self.yaw.cos() * STEP_S).clamp(-HALF.0 + 0.3, HALF.0 - 0.3);
        self.y = (self.y + linear * self.yaw.sin() * STEP_S).clamp(-HALF.1 + 0.3, HALF.1 - 0.3);
        let turn = core::f64::consts::TAU;
        self.yaw = (self.yaw + angular * STEP_S + turn / 2.0).rem_euclid(turn) - turn / 2.0;
        self.time_ms += 100;
    }

    /// Starts a session and drives up to `steps` steps.
    pub(crate) fn run(&mut self, link: &mut dyn Link, steps: u32) -> Result<(), LinkError> {
        link.hello()?;
        let status = link.control(&Control::Start(start()))?;
        assert_eq!(status, Status::Exploring);
        (0..steps).try_for_each(|_| self.step(link))
    }

    /// Drives a step of a session that has started.
    pub(crate) fn step(&mut self, link: &mut dyn Link) -> Result<(), LinkError> {
        let command = link.observe(&self.sense())?;
        self.drive(&command);
        Ok(())
    }
}

/// The digest of `steps` steps over a link that must not fail.
pub(crate) fn digest_of(link: &mut dyn Link, steps: u32) -> String {
    let mut robot = Robot::new();
    robot.run(link, steps).expect("the link holds");
    assert_eq!(robot.steps, steps);
    robot.digest.to_string()
}

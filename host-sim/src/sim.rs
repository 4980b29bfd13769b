//! The simulator: a robot in its world, step by step. Observations go out, commands come in.
//!
//! Time is simulated and counted in whole milliseconds. One [`Simulator::drive`] is one control
//! period, cut into substeps. In each substep the drive follows its target, and the slope slows and
//! shifts the motion. Then the footprint is tested at the next pose. A wall, or ground too high to
//! climb, stops the robot there. A lost ground contact or a slope too steep ends the drive for
//! good. The same world, configuration (with its seed) and commands give the same run, bit for bit.

pub(crate) mod announcement;
mod config;
mod fleet;
mod motion;
mod readings;
mod trail;

use fieldline_protocol::message::{INVALID_MM, Observation, Scan, Twist};

use crate::metrics::{Overlap, Ride, Safety};
use crate::people::People;
use crate::robot::{
    Contacts, Drive, LaserScanner, Noise, Odometry, OtherRobot, Pose, Source, Span, Velocity,
    nearest_m, stand, wrap,
};
use crate::world::{Ray, World, WorldError};
pub use config::SimConfig;
pub use fleet::{Fleet, FleetError};
use trail::Trail;

/// Noise of ranges and of faults, of the first lidar and of the second.
const SOURCES: [[Source; 2]; 2] = [
    [Source::LevelRange, Source::LevelFault],
    [Source::TiltedRange, Source::TiltedFault],
];

/// Why the robot is lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Loss {
    /// A wheel lost the ground.
    Fell,
    /// The robot tipped over.
    Tipped,
}

/// A run in progress.
#[derive(Clone, Debug)]
pub struct Simulator<'w> {
    world: &'w World,
    config: SimConfig,
    time_ms: u32,
    commanded_ms: u32,
    start_z_m: f64,
    /// The true pose at the start.
    first: Pose,
    pose: Pose,
    /// Where the robot was before, and when, for lidars that turn meanwhile.
    trail: Trail,
    drive: Drive,
    odometry: Odometry,
    /// Odometry's pose where it began anew.
    restart: Option<Pose>,
    lasers: Vec<LaserScanner>,
    /// Draws the beams that are missing.
    missing: Noise,
    path_length_m: f64,
    in_contact: bool,
    /// The wheels on uneven ground.
    contacts: Option<Contacts>,
    /// Pose at which ground stopped the robot, until it has left that place.
    stopped_at: Option<Pose>,
    loss: Option<Loss>,
    safety: Safety,
    ride: Ride,
    overlap: Overlap,
    /// Distance and turn of the wheels in this period, metres and radians.
    wheels: [f64; 2],
    /// The other robots of the world, where they are now; empty for a robot that is alone.
    others: Vec<OtherRobot>,
    people: People,
    /// The robot touches a person.
    touches_person: bool,
    /// Index of the other robot that stopped this one in the last substep.
    bumped: Option<usize>,
}

impl<'w> Simulator<'w> {
    /// Puts the robot at its start.
    ///
    /// # Errors
    /// [`WorldError::Start`] if the world has no such start or the robot does not fit there;
    /// [`WorldError::People`] if the people have no room.
    pub fn new(world: &'w World, config: SimConfig) -> Result<Self, WorldError> {
        let pose = start_pose(world, &config)?;
        let lidars = config.lidars.iter().zip(SOURCES);
        let mut lasers: Vec<LaserScanner> = lidars
            .map(|(lidar, sources)| {
                LaserScanner::of(lidar, &config.footprint, config.seed, sources)
            })
            .collect();
        if let Some(level) = lasers.first_mut() {
            let wrong = &config.miswiring;
            level.misplace(wrong.laser_turned_rad, wrong.mirrored);
        }
        let mut simulator = Self {
            world,
            time_ms: 0,
            commanded_ms: 0,
            start_z_m: pose.z_m,
            first: pose,
            pose,
            trail: Trail::of(&lasers),
            drive: Drive::new(config.limits),
            odometry: Odometry::new(config.odometry, pose, config.seed),
            restart: None,
            lasers,
            missing: Noise::new(config.seed, Source::Missing),
            path_length_m: 0.0,
            in_contact: false,
            contacts: world.elevation().and(Contacts::at(world, &pose)),
            stopped_at: None,
            loss: None,
            safety: Safety::default(),
            ride: Ride::default(),
            overlap: Overlap::default(),
            wheels: [0.0; 2],
            others: Vec::new(),
            people: People::none(config.seed),
            touches_person: false,
            bumped: None,
            config,
        };
        let config = &simulator.config;
        let (footprint, crowd) = (&config.footprint, (config.people, config.seed));
        simulator.people = People::new(world, simulator.start(), (footprint, &pose), crowd)?;
        simulator.overlap.add(pose.x_m, pose.y_m);
        simulator.track_clearance();
        Ok(simulator)
    }

    /// Measures an observation. Every call draws new noise.
    pub fn observe(&mut self) -> Observation {
        let miswiring = self.config.miswiring;
        let mut observation = Observation {
            time_ms: self.time_ms,
            pose: self.told_pose().to_wire(),
            velocity: miswiring.measured(self.odometry.velocity()).to_wire(),
            ..Observation::default()
        };
        for laser in 0..self.lasers.len() {
            let (world, others, people) = (self.world, &self.others, &self.people);
            let moving = |ray: &Ray, limit_m| {
                let robot_m = nearest_m(others, ray, limit_m);
                people
                    .cast(world, ray, robot_m.unwrap_or(limit_m))
                    .or(robot_m)
            };
            let (trail, now) = (&self.trail, (self.time_ms, &self.pose));
            let pose = |age_s| trail.pose(now, age_s);
            let mut scan = self.lasers[laser].scan_among(world, moving, pose);
            self.disturb(&mut scan);
            // The vector holds two scans, and there are at most two lasers.
            let _ = observation.scans.push(scan);
        }
        miswiring.spoil(&mut observation);
        observation
    }

    /// Returns the pose that odometry tells: once it began anew, the motion since then.
    fn told_pose(&mut self) -> Pose {
        let pose = self.above_start(self.odometry.pose());
        let first = self.above_start(&self.first);
        let pose = self.config.miswiring.told(pose, &first);
        if !self.config.disturbances.has_restarted(self.time_ms) {
            return pose;
        }
        let from = *self.restart.get_or_insert(pose);
        let [x_m, y_m] = from.planar_frame().to_local([pose.x_m, pose.y_m]);
        Pose {
            x_m,
            y_m,
            z_m: pose.z_m - from.z_m,
            yaw_rad: wrap(pose.yaw_rad - from.yaw_rad),
            ..pose
        }
    }

    /// Takes the information out of beams that are missing.
    fn disturb(&mut self, scan: &mut Scan) {
        let disturbances = &self.config.disturbances;
        let is_dark = disturbances.is_dark(self.time_ms);
        if !is_dark && disturbances.missing == 0.0 {
            return;
        }
        for range_mm in &mut scan.ranges_mm {
            if self.missing.uniform() < disturbances.missing || is_dark {
                *range_mm = INVALID_MM;
            }
        }
    }

    /// Drives for one period. `None` means that no command came: the last command counts until it
    /// is stale.
    pub fn drive(&mut self, command: Option<Twist>) {
        self.begin_period(command);
        let end_ms = self.time_ms + self.config.period_ms;
        while self.time_ms < end_ms {
            self.advance(self.config.substep_ms.clamp(1, end_ms - self.time_ms));
        }
        self.end_period();
    }

    /// Takes the command of a period.
    fn begin_period(&mut self, command: Option<Twist>) {
        if let Some(twist) = command {
            self.drive
                .command(self.config.miswiring.heard(twist.into()));
            self.commanded_ms = self.time_ms;
        }
        self.wheels = [0.0; 2];
    }

    /// Drives for one substep.
    fn advance(&mut self, step_ms: u32) {
        if self.time_ms - self.commanded_ms >= self.config.stale_ms {
            self.drive.command(Velocity::default());
        }
        let seconds = f64::from(step_ms) / 1000.0;
        self.trail.note(self.time_ms, &self.pose);
        let robot = (&self.config.footprint, &self.pose);
        self.people.walk(self.world, robot, seconds);
        let forwards = self.drive.velocity().linear_mps >= 0.0;
        let share = self.config.traction.speed_share(&self.pose, forwards);
        let velocity = self.drive.advance(seconds, share);
        let disturbances = self.config.disturbances;
        let turns = disturbances.spins(self.time_ms) || self.substep(velocity, seconds);
        if turns && !disturbances.pushes(self.time_ms) {
            self.wheels[0] += velocity.linear_mps * seconds;
            self.wheels[1] += velocity.angular_radps * seconds;
        }
        self.ride.add(&self.pose, &self.config.working, seconds);
        self.time_ms += step_ms;
    }

    /// Measures the motion of a period.
    fn end_period(&mut self) {
        self.overlap.add(self.pose.x_m, self.pose.y_m);
        let disturbances = &self.config.disturbances;
        let period = Span {
            from_ms: self.time_ms.saturating_sub(self.config.period_ms),
            to_ms: self.time_ms,
        };
        let [slip_m, slip_rad] = disturbances.slip(period);
        let velocity = if disturbances.pushes(period.from_ms) {
            Velocity::default()
        } else {
            self.drive.velocity()
        };
        let [forward_m, turn_rad] = self.wheels;
        self.odometry.advance(
            &self.pose,
            forward_m + slip_m,
            turn_rad + slip_rad,
            velocity,
        );
    }
}

/// The stance at the configured start, if the robot can stand there.
fn start_pose(world: &World, config: &SimConfig) -> Result<Pose, WorldError> {
    let Some(start) = config.place.as_ref().or(world.starts().get(config.start)) else {
        let count = world.starts().len();
        return Err(WorldError::Start {
            file: world.name().to_owned(),
            index: config.start,
            reason: format!(
                "the world has only {count} starts; give --start a number below {count}"
            ),
        });
    };
    world.check_start(world.name(), config.start, *start)?;
    let planar = start.pose();
    if config.footprint.overlaps(world, &planar) {
        let reason = "the robot's hull overlaps a wall at this start";
        return Err(world.bad_start(world.name(), config.start, reason));
    }
    let pose = stand(world, &planar).unwrap_or(planar);
    if !config.failing.holds_attitude(pose.pitch_rad, pose.roll_rad) {
        let reason = format!(
            "the robot would tip over, at a pitch of {:.1} and a roll of {:.1} degrees",
            pose.pitch_rad.to_degrees(),
            pose.roll_rad.to_degrees()
        );
        return Err(world.bad_start(world.name(), config.start, &reason));
    }
    Ok(pose)
}

#[cfg(test)]
mod tests;

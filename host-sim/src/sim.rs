//! The robot in its world, driven step by step: observation out, command in.
//!
//! Time is simulated and counted in whole milliseconds. One [`Simulator::drive`] is one control period, cut into
//! substeps; in each the drive follows its target, the slope slows and shifts what becomes of it, the footprint is tried
//! at the pose it would reach, and something solid there stops it: a wall, or ground too high to climb. Ground that is gone,
//! or too steep, ends the drive for good. Nothing but the seed decides: same world, configuration and commands, same run, bit for bit.

use fieldline_protocol::message::{Observation, Start, Strategy, Twist};
use fixed::types::I4F12;

use crate::metrics::{Localization, Overlap, Ride, Safety};
use crate::robot::{
    Contacts, Drive, DriveLimits, Footprint, LaserNoise, LaserScanner, Limits, Mishap, Odometry,
    OdometryModel, Pose, RADIUS_M, Source, Traction, Velocity, laser, stand,
};
use crate::world::{World, WorldError};

/// A contact is over once the robot is this far from everything, metres.
const CONTACT_OVER_M: f64 = 0.01;
/// A contact with the ground is over once the robot is this far from where it began, metres.
const EDGE_OVER_M: f64 = 0.05;

/// The parameters of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimConfig {
    /// Decides all noise. Default: 0.
    pub seed: u64,
    /// Which of the world's starts. Default: 0.
    pub start: usize,
    /// What the robot believes of its motion. Default: the truth.
    pub odometry: OdometryModel,
    /// How the lasers err. Default: [`LaserNoise::default`].
    pub laser_noise: LaserNoise,
    /// What the drive can do. Default: [`DriveLimits::default`].
    pub limits: DriveLimits,
    /// The ground that the robot is at home on; what is beyond is counted. Default: [`Limits::WORKING`].
    pub working: Limits,
    /// The ground that it does not survive. Default: [`Limits::FAILING`].
    pub failing: Limits,
    /// How slopes slow and shift it. Default: [`Traction::default`].
    pub traction: Traction,
    /// Time between observations, milliseconds. Default: 200.
    pub period_ms: u32,
    /// Longest substep, milliseconds. Default: 10.
    pub substep_ms: u32,
    /// A command older than this no longer counts, milliseconds. Default: 500.
    pub stale_ms: u32,
}

impl Default for SimConfig {
    fn default() -> Self {
        Self {
            seed: 0,
            start: 0,
            odometry: OdometryModel::Truth,
            laser_noise: LaserNoise::default(),
            limits: DriveLimits::default(),
            working: Limits::WORKING,
            failing: Limits::FAILING,
            traction: Traction::default(),
            period_ms: 200,
            substep_ms: 10,
            stale_ms: 500,
        }
    }
}

/// Why a robot cannot go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Loss {
    /// A wheel lost the ground.
    Fell,
    /// It stood too steep.
    Tipped,
}

/// A run in progress.
#[derive(Clone, Debug)]
pub struct Simulator<'w> {
    world: &'w World,
    config: SimConfig,
    footprint: Footprint,
    time_ms: u32,
    commanded_ms: u32,
    start_z_m: f64,
    pose: Pose,
    drive: Drive,
    odometry: Odometry,
    lasers: [LaserScanner; 2],
    path_length_m: f64,
    in_contact: bool,
    /// The wheels on uneven ground.
    contacts: Option<Contacts>,
    /// Where ground last stopped the robot, if it has not left that place.
    stopped_at: Option<Pose>,
    loss: Option<Loss>,
    safety: Safety,
    ride: Ride,
    localization: Localization,
    overlap: Overlap,
}

/// The greatest wire quantity that promises no more than this.
fn at_most(quantity: f64) -> I4F12 {
    let least_step = f64::from(1_u32 << I4F12::FRAC_NBITS);
    I4F12::saturating_from_num((quantity * least_step).floor() / least_step)
}

impl<'w> Simulator<'w> {
    /// Puts the robot at its start.
    ///
    /// # Errors
    /// [`WorldError::Start`] where the world has no such start or the robot does not fit there.
    pub fn new(world: &'w World, config: SimConfig) -> Result<Self, WorldError> {
        let Some(start) = world.starts().get(config.start) else {
            return Err(WorldError::Start {
                file: world.name().to_owned(),
                index: config.start,
                reason: format!("there are only {} starts", world.starts().len()),
            });
        };
        world.check_start(world.name(), config.start, *start)?;
        let planar = start.pose();
        let pose = stand(world, &planar).unwrap_or(planar);
        if !config.failing.holds_attitude(pose.pitch_rad, pose.roll_rad) {
            let reason = format!(
                "the robot would tip over, at a pitch of {:.1} and a roll of {:.1} degrees",
                pose.pitch_rad.to_degrees(),
                pose.roll_rad.to_degrees()
            );
            return Err(world.bad_start(world.name(), config.start, &reason));
        }
        let scanner =
            |laser, sources| LaserScanner::new(&laser, config.laser_noise, config.seed, sources);
        let mut simulator = Self {
            world,
            config,
            footprint: Footprint::PIONEER_3AT,
            time_ms: 0,
            commanded_ms: 0,
            start_z_m: pose.z_m,
            pose,
            drive: Drive::new(config.limits),
            odometry: Odometry::new(config.odometry, pose, config.seed),
            lasers: [
                scanner(laser::level(), [Source::LevelRange, Source::LevelFault]),
                scanner(laser::tilted(), [Source::TiltedRange, Source::TiltedFault]),
            ],
            path_length_m: 0.0,
            in_contact: false,
            contacts: world.elevation().and(Contacts::at(world, &pose)),
            stopped_at: None,
            loss: None,
            safety: Safety::default(),
            ride: Ride::default(),
            localization: Localization::default(),
            overlap: Overlap::default(),
        };
        simulator.overlap.add(pose.x_m, pose.y_m);
        simulator.track_clearance();
        Ok(simulator)
    }

    /// What the robot senses now. Draws noise: every call is another measurement.
    pub fn observe(&mut self) -> Observation {
        self.localization
            .add(self.pose.distance_m(self.odometry.pose()));
        let mut observation = Observation {
            time_ms: self.time_ms,
            pose: self.above_start(self.odometry.pose()).to_wire(),
            velocity: self.odometry.velocity().to_wire(),
            ..Observation::default()
        };
        for laser in &mut self.lasers {
            // The vector holds two scans, and there are two lasers.
            let _ = observation.scans.push(laser.scan(self.world, &self.pose));
        }
        observation
    }

    /// Drives for one period. `None` means that no command came: the last one counts until it is stale.
    pub fn drive(&mut self, command: Option<Twist>) {
        if let Some(twist) = command {
            self.drive.command(twist.into());
            self.commanded_ms = self.time_ms;
        }
        let end_ms = self.time_ms + self.config.period_ms;
        let (mut forward_m, mut turn_rad) = (0.0, 0.0);
        while self.time_ms < end_ms {
            let step_ms = self.config.substep_ms.clamp(1, end_ms - self.time_ms);
            if self.time_ms - self.commanded_ms >= self.config.stale_ms {
                self.drive.command(Velocity::default());
            }
            let seconds = f64::from(step_ms) / 1000.0;
            let forwards = self.drive.velocity().linear_mps >= 0.0;
            let share = self.config.traction.speed_share(&self.pose, forwards);
            let velocity = self.drive.advance(seconds, share);
            if self.substep(velocity, seconds) {
                forward_m += velocity.linear_mps * seconds;
                turn_rad += velocity.angular_radps * seconds;
            }
            self.ride.add(&self.pose, &self.config.working, seconds);
            self.time_ms += step_ms;
        }
        self.overlap.add(self.pose.x_m, self.pose.y_m);
        let velocity = self.drive.velocity();
        self.odometry
            .advance(&self.pose, forward_m, turn_rad, velocity);
    }

    /// Moves if nothing is in the way, and says whether it did. A robot that fell or tipped lies where it was.
    fn substep(&mut self, velocity: Velocity, seconds: f64) -> bool {
        if self.loss.is_some() {
            self.drive.halt();
            return false;
        }
        let shift = self.config.traction.shift(&self.pose, velocity, seconds);
        let next = match self.attempt(&shift.applied(&self.pose)) {
            Ok(next) => next,
            Err(mishap) => {
                self.suffer(mishap);
                return false;
            }
        };
        self.path_length_m += shift.driven_m.abs();
        self.pose = next;
        if self
            .stopped_at
            .is_some_and(|at| at.distance_m(&next) >= EDGE_OVER_M)
        {
            self.stopped_at = None;
        }
        self.track_clearance();
        true
    }

    /// The stance at a planar pose near by.
    fn attempt(&mut self, next: &Pose) -> Result<Pose, Mishap> {
        let walled = |pose: &Pose| self.footprint.overlaps(self.world, pose);
        if walled(next) {
            return self.walled();
        }
        let Some(mut contacts) = self.contacts else {
            return Ok(*next);
        };
        let stance = contacts.go(self.world, &self.pose, next, &self.config.failing);
        match stance {
            Ok(stance) if walled(&stance) => self.walled(),
            Ok(stance) => {
                self.contacts = Some(contacts);
                Ok(stance)
            }
            Err(Mishap::Blocked) => {
                let again = self.stopped_at.is_some();
                self.safety.collisions += u32::from(!again);
                self.stopped_at.get_or_insert(self.pose);
                Err(Mishap::Blocked)
            }
            Err(mishap) => Err(mishap),
        }
    }

    /// A wall is in the way.
    fn walled(&mut self) -> Result<Pose, Mishap> {
        self.safety.collisions += u32::from(!self.in_contact);
        self.in_contact = true;
        Err(Mishap::Blocked)
    }

    /// Stops, and keeps account of what cannot be undone.
    fn suffer(&mut self, mishap: Mishap) {
        self.drive.halt();
        match mishap {
            Mishap::Blocked => self.safety.min_clearance_m = 0.0,
            Mishap::Fallen => {
                self.safety.falls += 1;
                self.loss = Some(Loss::Fell);
            }
            Mishap::Tipped => {
                self.safety.tips += 1;
                self.loss = Some(Loss::Tipped);
            }
        }
    }

    /// Measures the clearance where it may be a new least, or end a contact.
    fn track_clearance(&mut self) {
        let needed_m = if self.in_contact {
            CONTACT_OVER_M
        } else {
            self.safety.min_clearance_m
        };
        if self.footprint.clearance_bound_m(self.world, &self.pose) >= needed_m {
            self.in_contact = false;
            return;
        }
        let clearance_m = self.footprint.clearance_m(self.world, &self.pose);
        self.in_contact &= clearance_m < CONTACT_OVER_M;
        self.safety.min_clearance_m = self.safety.min_clearance_m.min(clearance_m);
    }

    /// The session's parameters for the planner, in a map box of `box_tiles`.
    #[must_use]
    pub fn start_message(&self, strategy: Strategy, box_tiles: (u8, u8)) -> Start {
        let limits = &self.config.limits;
        Start {
            strategy,
            box_tiles,
            lasers: [laser::level(), laser::tilted()].into_iter().collect(),
            robot_radius_mm: (RADIUS_M * 1000.0) as u16,
            max_linear: I4F12::saturating_from_num(limits.linear_mps),
            max_angular: I4F12::saturating_from_num(limits.angular_radps),
            linear_accel: at_most(limits.acceleration_mps2.min(limits.braking_mps2)),
            angular_accel: at_most(limits.angular_radps2),
            period_ms: u16::try_from(self.config.period_ms).unwrap_or(u16::MAX),
            uneven_ground: None,
        }
    }

    /// The world.
    #[must_use]
    pub fn world(&self) -> &'w World {
        self.world
    }

    /// The parameters of this run.
    #[must_use]
    pub fn config(&self) -> &SimConfig {
        &self.config
    }

    /// Simulated milliseconds since the start.
    #[must_use]
    pub fn time_ms(&self) -> u32 {
        self.time_ms
    }

    /// Simulated seconds since the start.
    #[must_use]
    pub fn time_s(&self) -> f64 {
        f64::from(self.time_ms) / 1000.0
    }

    /// Where the robot really is.
    #[must_use]
    pub fn pose(&self) -> &Pose {
        &self.pose
    }

    /// How it really moves.
    #[must_use]
    pub fn velocity(&self) -> Velocity {
        self.drive.velocity()
    }

    /// Where it believes to be.
    #[must_use]
    pub fn odometry_pose(&self) -> &Pose {
        self.odometry.pose()
    }

    /// A pose with its height counted from the start, as odometry does.
    #[must_use]
    pub fn above_start(&self, pose: &Pose) -> Pose {
        Pose {
            z_m: pose.z_m - self.start_z_m,
            ..*pose
        }
    }

    /// Height of the start in the world, metres.
    #[must_use]
    pub fn start_z_m(&self) -> f64 {
        self.start_z_m
    }

    /// Why the robot cannot go on, if so.
    #[must_use]
    pub fn loss(&self) -> Option<Loss> {
        self.loss
    }

    /// How the ground was driven over so far.
    #[must_use]
    pub fn ride(&self) -> Ride {
        self.ride
    }

    /// Metres driven, forwards and backwards, up and down.
    #[must_use]
    pub fn path_length_m(&self) -> f64 {
        self.path_length_m
    }

    /// Is the robot up against something?
    #[must_use]
    pub fn in_contact(&self) -> bool {
        self.in_contact || self.stopped_at.is_some()
    }

    /// Collisions, falls, tips and clearance so far.
    #[must_use]
    pub fn safety(&self) -> Safety {
        self.safety
    }

    /// Share of the path that was driven again.
    #[must_use]
    pub fn overlap(&self) -> f64 {
        self.overlap.fraction()
    }

    /// The odometry's error so far.
    #[must_use]
    pub fn localization(&self) -> Localization {
        self.localization
    }
}

#[cfg(test)]
mod tests;

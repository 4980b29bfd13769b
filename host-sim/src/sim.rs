//! The robot in its world, driven step by step: observation out, command in.
//!
//! Time is simulated and counted in whole milliseconds. One [`Simulator::drive`] is one control period, cut into
//! substeps; in each the drive follows its target, the footprint is tried at the pose it would reach, and something solid there
//! stops it. Nothing but the seed decides: same world, configuration and commands, same run, bit for bit.

use fieldline_protocol::message::{Observation, Start, Strategy, Twist};
use fixed::types::I4F12;

use crate::metrics::{Localization, Overlap, Safety};
use crate::robot::{
    Drive, DriveLimits, Footprint, LaserNoise, LaserScanner, Odometry, OdometryModel, Pose,
    RADIUS_M, Source, Velocity, laser,
};
use crate::world::{World, WorldError};

/// A contact is over once the robot is this far from everything, metres.
const CONTACT_OVER_M: f64 = 0.01;

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
            period_ms: 200,
            substep_ms: 10,
            stale_ms: 500,
        }
    }
}

/// A run in progress.
#[derive(Clone, Debug)]
pub struct Simulator<'w> {
    world: &'w World,
    config: SimConfig,
    footprint: Footprint,
    time_ms: u32,
    commanded_ms: u32,
    pose: Pose,
    drive: Drive,
    odometry: Odometry,
    lasers: [LaserScanner; 2],
    path_length_m: f64,
    in_contact: bool,
    safety: Safety,
    localization: Localization,
    overlap: Overlap,
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
        let pose = Pose {
            x_m: start.x_m,
            y_m: start.y_m,
            z_m: world.ground_m(start.x_m, start.y_m).unwrap_or(0.0),
            yaw_rad: crate::robot::wrap(start.yaw_rad),
            ..Pose::default()
        };
        let scanner =
            |laser, sources| LaserScanner::new(&laser, config.laser_noise, config.seed, sources);
        let mut simulator = Self {
            world,
            config,
            footprint: Footprint::PIONEER_3AT,
            time_ms: 0,
            commanded_ms: 0,
            pose,
            drive: Drive::new(config.limits),
            odometry: Odometry::new(config.odometry, pose, config.seed),
            lasers: [
                scanner(laser::level(), [Source::LevelRange, Source::LevelFault]),
                scanner(laser::tilted(), [Source::TiltedRange, Source::TiltedFault]),
            ],
            path_length_m: 0.0,
            in_contact: false,
            safety: Safety::default(),
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
            pose: self.odometry.pose().to_wire(),
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
            let velocity = self.drive.advance(seconds);
            if self.substep(velocity, seconds) {
                forward_m += velocity.linear_mps * seconds;
                turn_rad += velocity.angular_radps * seconds;
            }
            self.time_ms += step_ms;
        }
        self.overlap.add(self.pose.x_m, self.pose.y_m);
        let velocity = self.drive.velocity();
        self.odometry
            .advance(&self.pose, forward_m, turn_rad, velocity);
    }

    /// Moves if nothing solid is in the way, and says whether it did.
    fn substep(&mut self, velocity: Velocity, seconds: f64) -> bool {
        let next = self.pose.driven(velocity, seconds);
        if self
            .footprint
            .overlaps(self.world, next.x_m, next.y_m, next.yaw_rad)
        {
            self.drive.halt();
            if !self.in_contact {
                self.safety.collisions += 1;
            }
            self.in_contact = true;
            self.safety.min_clearance_m = 0.0;
            return false;
        }
        self.path_length_m += velocity.linear_mps.abs() * seconds;
        self.pose = next;
        self.track_clearance();
        true
    }

    /// Measures the clearance where it may be a new least, or end a contact.
    fn track_clearance(&mut self) {
        let Pose {
            x_m, y_m, yaw_rad, ..
        } = self.pose;
        let needed_m = if self.in_contact {
            CONTACT_OVER_M
        } else {
            self.safety.min_clearance_m
        };
        if self.footprint.clearance_bound_m(self.world, x_m, y_m) >= needed_m {
            self.in_contact = false;
            return;
        }
        let clearance_m = self.footprint.clearance_m(self.world, x_m, y_m, yaw_rad);
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

    /// Metres driven, forwards and backwards.
    #[must_use]
    pub fn path_length_m(&self) -> f64 {
        self.path_length_m
    }

    /// Is the robot up against something?
    #[must_use]
    pub fn in_contact(&self) -> bool {
        self.in_contact
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
mod tests {
    use super::*;

    fn twist(linear: f64, angular: f64) -> Option<Twist> {
        let velocity = Velocity {
            linear_mps: linear,
            angular_radps: angular,
        };
        Some(velocity.to_wire())
    }

    fn office() -> World {
        World::builtin("office").expect("built in")
    }

    #[test]
    fn same_seed_same_run() {
        let world = office();
        let run = |seed| {
            let config = SimConfig {
                seed,
                odometry: OdometryModel::Noisy(crate::robot::OdometryNoise::default()),
                ..SimConfig::default()
            };
            let mut sim = Simulator::new(&world, config).expect("fits");
            let mut seen = Vec::new();
            for step in 0..40 {
                seen.push(sim.observe());
                sim.drive(twist(0.4, if step % 9 < 4 { 0.7 } else { -0.6 }));
            }
            (seen, sim.odometry_pose().x_m.to_bits())
        };
        assert_eq!(run(5), run(5));
        assert_ne!(run(5).0, run(6).0);
    }

    #[test]
    fn a_wall_stops_the_robot_and_counts_once() {
        let world = office();
        let mut sim = Simulator::new(&world, SimConfig::default()).expect("fits");
        for _ in 0..300 {
            sim.drive(twist(0.7, 0.0));
        }
        assert_eq!(sim.safety().collisions, 1);
        assert_eq!(sim.safety().min_clearance_m, 0.0);
        // The corridor ends at x = 24.2, the robot's nose is 0.254 ahead.
        let nose_m = sim.pose().x_m + 0.254;
        assert!((24.19..24.2).contains(&nose_m), "{nose_m}");
        assert!((sim.path_length_m() - (sim.pose().x_m - 12.0)).abs() < 1e-9);
        // Back off and hit it again: another contact.
        for speed in [-0.3, 0.5] {
            for _ in 0..20 {
                sim.drive(twist(speed, 0.0));
            }
        }
        assert_eq!(sim.safety().collisions, 2);
    }

    #[test]
    fn silence_stops_the_robot_after_the_stale_limit() {
        let world = office();
        let mut sim = Simulator::new(&world, SimConfig::default()).expect("fits");
        for _ in 0..10 {
            sim.drive(twist(0.25, 0.0));
        }
        sim.drive(None);
        // 400 ms after the last command it still counts.
        assert!((sim.velocity().linear_mps - 0.25).abs() < 1e-9);
        sim.drive(None);
        assert!((sim.velocity().linear_mps - 0.19).abs() < 1e-9);
        sim.drive(None);
        sim.drive(None);
        sim.drive(None);
        assert_eq!(sim.velocity(), Velocity::default());
    }

    #[test]
    fn truth_starts_in_the_world_frame() {
        let world = office();
        let mut sim = Simulator::new(&world, SimConfig::default()).expect("fits");
        let seen = sim.observe();
        assert_eq!(seen.pose.x.to_num::<f64>(), 12.0);
        assert_eq!(seen.pose.y.to_num::<f64>(), 7.0);
        assert_eq!(seen.scans.len(), 2);
        assert_eq!(seen.scans[0].ranges_mm.len(), 181);
        // Straight ahead, the tilted laser meets the ground at 0.45 m / sin 20°.
        let ground = f64::from(seen.scans[1].ranges_mm[90]) / 1000.0;
        assert!(
            (ground - 0.45 / 20.0_f64.to_radians().sin()).abs() < 0.05,
            "{ground}"
        );
    }
}

//! What can be read of a run in progress: its world, its clock, the true motion, the record.

use super::{Loss, SimConfig, Simulator};
use crate::metrics::{Ride, Safety};
use crate::people::People;
use crate::robot::{Pose, Velocity};
use crate::world::{Start, World};

impl<'w> Simulator<'w> {
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

    /// The start in the world.
    #[must_use]
    pub fn start(&self) -> Start {
        let starts = self.world.starts();
        let of_world = || starts.get(self.config.start).copied().unwrap_or_default();
        self.config.place.unwrap_or_else(of_world)
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

    /// The true pose.
    #[must_use]
    pub fn pose(&self) -> &Pose {
        &self.pose
    }

    /// The people who walk about.
    #[must_use]
    pub fn people(&self) -> &People {
        &self.people
    }

    /// The true velocity.
    #[must_use]
    pub fn velocity(&self) -> Velocity {
        self.drive.velocity()
    }

    /// A pose with its height counted from the start, as in the odometry.
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

    /// Why the robot is lost, if it is.
    #[must_use]
    pub fn loss(&self) -> Option<Loss> {
        self.loss
    }

    /// Attitudes of the robot so far, and its time beyond the working limits.
    #[must_use]
    pub fn ride(&self) -> Ride {
        self.ride
    }

    /// Path length along the ground, forwards and backwards, metres.
    #[must_use]
    pub fn path_length_m(&self) -> f64 {
        self.path_length_m
    }

    /// Returns true if the robot is in contact with a wall or an edge.
    #[must_use]
    pub fn in_contact(&self) -> bool {
        self.in_contact || self.stopped_at.is_some()
    }

    /// Collisions, falls, tips and clearance so far.
    #[must_use]
    pub fn safety(&self) -> Safety {
        self.safety
    }

    /// Share of the path that was driven again, 0 to 1.
    #[must_use]
    pub fn overlap(&self) -> f64 {
        self.overlap.fraction()
    }
}

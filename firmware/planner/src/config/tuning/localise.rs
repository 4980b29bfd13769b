//! Tuned constants of localisation: how far odometry may be wrong, and what a beam says.
//!
//! Measured: docs/MEASURED.md, "Price of a slip", "Information of a beam".
//!
//! Units: metres, radians, map cells of 0.1 m.

tuning! {
    /// Tuned constants of localisation.
    "localise" LocaliseTuning {
        /// Variance of a distance per metre driven.
        along_by_distance: f32 = 2e-3, 0.0..=1.0, "m²/m";
        /// Variance of a distance per radian turned.
        along_by_turn: f32 = 5e-4, 0.0..=1.0, "m²/rad";
        /// Variance sideways as a share of that of the distance.
        across_share: f32 = 0.25, 0.0..=1.0, "1";
        /// Variance of a turn per radian turned.
        turn_by_turn: f32 = 2e-3, 0.0..=1.0, "rad²/rad";
        /// Variance of a turn per metre driven.
        turn_by_distance: f32 = 1e-3, 0.0..=1.0, "rad²/m";
        /// Least standard deviation of the distance of a step.
        floor_m: f32 = 0.005, 0.0001..=0.1, "m";
        /// Least standard deviation of the turn of a step.
        floor_rad: f32 = 0.002, 0.0001..=0.1, "rad";

        /// Every beam of this number is matched.
        beam_stride: u16 = 1, 1..=10, "beams";
        /// Greatest number of Gauss–Newton steps.
        iterations: u16 = 6, 1..=30, "1";
        /// Greatest distance of a beam's end from the line of its neighbours on a surface. With 0
        /// there are no surfaces, and each beam measures in both directions.
        flat_m: f32 = 0.05, 0.0..=1.0, "m";
        /// Information of a beam about the distance to its wall. A cell is 0.3 cells wide as a
        /// standard deviation, and beams of one wall share their error.
        beam_information: f32 = 6.0, 0.01..=100.0, "1/cell²";
        /// Distance from its wall at which a beam counts half.
        robust_cells: f32 = 0.7, 0.05..=10.0, "cells";
        /// Squared distance from odometry, in standard deviations, at which odometry counts half:
        /// wheels slip. A poor odometry alone is often 3 deviations off.
        slip_gap: f32 = 50.0, 1.0..=1e9, "1";
        /// Gain of the fit from which on the wheels slipped in a step: twice the logarithm of the
        /// number of steps in which they do so once.
        slip_price: f32 = 10.0, 0.0..=1e9, "1";
        /// A direction with less information than this is not observed.
        least_information: f32 = 4.0, 0.0..=100.0, "1/cell²";
        /// Share of contradicting beams above which a scan contradicts the map. People near the
        /// robot hide up to a third of what the map knows.
        contradicted_share: f32 = 0.5, 0.01..=1.0, "1";
        /// The same share of the beams that end on a surface. It is at most 0.16 among simulated
        /// people. With 0.1 recorded logs of real rooms raise doubts, and lose their place.
        contradicted_surfaces: f32 = 0.3, 0.01..=1.0, "1";
        /// Share of the surfaces by which more must agree at another place near by, before a robot
        /// that doubts its own takes it.
        better_share: f32 = 0.2, 0.0..=1.0, "1";
        /// Steps for which a robot that found no better place does not doubt its own again, unless
        /// the scan refutes it.
        trusted_steps: u8 = 50, 0..=250, "steps";
        /// Share of the surfaces that lie within a cell of an obstacle, from which on a robot that
        /// searches far off is found.
        agreed_share: f32 = 0.8, 0.5..=1.0, "1";
        /// Fewest beams or surfaces on known ground with which a scan can contradict the map, or
        /// find a lost robot.
        least_counted: f32 = 20.0, 1.0..=181.0, "beams";
        /// Share of a beam's information that counts on uneven ground, where many beams end on
        /// ground and not on walls.
        uneven_share: f32 = 0.05, 0.001..=1.0, "1";
        /// Least slope of a level beam that may leave a landmark on uneven ground. One that runs
        /// down more steeply meets ground.
        landmark_slope: f32 = -0.03, -1.0..=1.0, "1";
        /// Consecutive contradicting scans after which the robot is lost.
        lost_steps: u8 = 3, 1..=50, "steps";
    }
}

impl LocaliseTuning {
    /// Returns the constants as they count on uneven ground: beams count less, and never more than
    /// odometry where they agree on a pose far from it. Wheels slip there too, but ground that is
    /// taken for a wall misleads more often.
    pub(crate) fn on_uneven_ground(&self) -> Self {
        Self {
            slip_gap: f32::INFINITY,
            ..self.weighted(self.uneven_share)
        }
    }

    /// Returns the constants if a beam counts only this share of its information.
    pub(crate) fn weighted(&self, share: f32) -> Self {
        Self {
            beam_information: share * self.beam_information,
            least_information: share * self.least_information,
            ..*self
        }
    }
}

//! Tuned constants of strategy Ouroboros.

tuning! {
    /// Tuned constants of strategy Ouroboros \[Jorge15\].
    "ouroboros" OuroborosTuning {
        /// Distance from the tractor point at which the robot has reached it.
        reached_m: f32 = 1.0, 0.2..=5.0, "m";
        /// Least distance of the shield behind the robot.
        least_behind_m: f32 = 2.5, 0.5..=10.0, "m";
    }
}

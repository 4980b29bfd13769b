//! Tuned constants of the window's field.
//!
//! The constants of the solver stay in `field`: beyond narrow bounds it does not converge.

tuning! {
    /// Tuned constants of the window's field.
    "field" FieldTuning {
        /// Greatest roll and pitch of a robot on level ground. Where it stands level its height is
        /// the reference for the heights of goals.
        level_rad: f32 = 0.1, 0.01..=0.5, "rad";
    }
}

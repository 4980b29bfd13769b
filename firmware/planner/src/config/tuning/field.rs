//! Tuned constants of the window's field and of its solver.
//!
//! The constants of the multigrid itself stay in `field`: beyond narrow bounds it does not
//! converge.

tuning! {
    /// Tuned constants of the window's field and of its solver.
    "field" FieldTuning {
        /// Mean preference of the reachable cells above which Gauss–Seidel solves instead of the
        /// multigrid. Under a strong attraction q is so near to the goal's value over whole rooms
        /// that the factors show only rounding, and a wrong field seems right.
        strong_attraction: f32 = 0.15, 0.0..=2.0, "1";
        /// Gauss–Seidel sweeps for each multigrid cycle of the budget: about as many as take the
        /// same time.
        sweeps_per_cycle: u16 = 5, 1..=20, "sweeps";
        /// Consecutive cycles of one call without a smaller error after which the multigrid gives
        /// up.
        most_idle_cycles: u16 = 12, 1..=1000, "cycles";
        /// Greatest relative change of a cell in the last sweep of Gauss–Seidel. Its slowest modes
        /// lose less than a hundredth of their error per sweep, so the remaining error is a few
        /// thousandths at most.
        sweep_tolerance: f32 = 1e-5, 1e-7..=1e-2, "1";
        /// Greatest roll and pitch of a robot on level ground. Where it stands level its height is
        /// the reference for the heights of goals.
        level_rad: f32 = 0.1, 0.01..=0.5, "rad";
    }
}

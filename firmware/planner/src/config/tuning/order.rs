//! Tuned constants of the order in which frontiers are taken.
//!
//! The power of a gain and the area of an opening. `frontier`, true odometry, 51 runs in 17
//! buildings of others and 64 in built-in and generated worlds, as ratios to `greedy-frontier`,
//! the 64 in the last five columns. Openings were those for
//! [`passage_radius_m`](crate::Config::passage_radius_m):
//!
//! | power | m² | T90 | T95 | T99 | end | known % | T90 | T95 | T99 | end | known % |
//! | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |
//! | 0.625 | 0 | 0.87 | 0.90 | 0.95 | 1.04 | 99.54 | 0.90 | 0.92 | 0.96 | 1.04 | 99.65 |
//! | 0.7 | 0 | 0.85 | 0.85 | 0.97 | 1.05 | 99.56 | 0.90 | 0.90 | 0.96 | 1.01 | 99.54 |
//! | 0.8 | 0 | 0.82 | 0.82 | 0.94 | 1.08 | 99.58 | 0.91 | 0.89 | 0.97 | 1.03 | 99.54 |
//! | 0.9 | 0 | 0.82 | 0.82 | 0.95 | 1.11 | 99.58 | 0.92 | 0.91 | 1.00 | 1.05 | 99.49 |
//! | 0.8 | 3 * | 0.81 | 0.82 | 0.95 | 1.07 | 99.56 | 0.90 | 0.91 | 0.97 | 1.02 | 99.52 |
//! | 0.8 | 4.5 * | 0.83 | 0.83 | 0.93 | 1.04 | 99.52 | 0.90 | 0.90 | 0.95 | 0.98 | 99.51 |
//! | 0.8 | 6 | 0.84 | 0.83 | 0.94 | 1.04 | 99.53 | 0.93 | 0.94 | 0.98 | 1.02 | 99.48 |
//! | 0.8 | 4.5 † | 0.83 | 0.83 | 0.92 | 1.03 | 99.49 | 0.90 | 0.90 | 0.95 | 0.98 | 99.56 |
//!
//! The robot waited 2.4 s at the end, \* 0.6 s, † not at all. In the last row, which is what is
//! built, openings are those for the robot's disc.

tuning! {
    /// Tuned constants of the order in which frontiers are taken.
    "order" OrderTuning {
        /// Distance from a goal within which unexplored area counts as its gain.
        gain_m: f32 = 3.0, 0.5..=3.1, "m";
        /// Power of a gain in a goal's utility: below 1, small gains near the robot are taken on
        /// the way rather than left for a trip of their own; 0 makes all gains equal.
        power: f32 = 0.8, 0.0..=2.0, "1";
        /// Least area that an opening counts for in a goal's utility: small openings are taken
        /// while the robot is near.
        opening_m2: f32 = 4.5, 0.0..=36.0, "m²";
        /// Way that counts as much as turning about: stopping from 0.7 m/s and going on costs 2.3
        /// s, which is 1.6 m, and half a turn another 2.2 m.
        turn_m: f32 = 3.8, 0.0..=20.0, "m";
        /// Factor of the gain of a goal that another robot of the team has claimed, and weight of
        /// a cell of `sbpf` and `esbpf` that another robot is nearer to; 1 for no claims.
        claimed: f32 = 0.2, 0.0..=1.0, "1";
        /// Factor of the present goal's gain: another one is taken only if it is better by as much.
        keep: f32 = 1.3, 1.0..=10.0, "1";
    }
}

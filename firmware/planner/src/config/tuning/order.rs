//! Tuned constants of the order in which frontiers are taken.
//!
//! The power of a gain and the area of an opening are the ones with which robots know 90 and 99 %
//! early without a later end (measured: docs/MEASURED.md, "Power of a gain, and area of an
//! opening").

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

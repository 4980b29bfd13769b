//! Tuned constants of strategy TDBVP.
//!
//! Measured: docs/MEASURED.md, "Side preference at a fork", "Free cells around a robot that follows
//! rails".

tuning! {
    /// Tuned constants of strategy TDBVP \[Maffei14\].
    "tdbvp" TdbvpTuning {
        /// A robot lingers if it stays within this distance for longer than `linger_ms`.
        linger_m: f32 = 1.0, 0.2..=5.0, "m";
        /// A robot lingers if it stays within `linger_m` for longer than this time: some seven
        /// times what it takes to drive that distance.
        linger_ms: u32 = 15_000, 1_000..=1_000_000, "ms";
        /// Distance from a robot that lingers within which centre cells count as visited: the one
        /// that attracts it cannot be reached.
        linger_visit_m: f32 = 2.0, 0.5..=5.0, "m";
        /// Distance from an exploring robot within which centre cells are free, so that the nearest
        /// rail attracts from there. At 0.5 m the half disc has no room for a preferred side.
        free_m: f32 = 1.2, 0.2..=3.0, "m";
        /// Time that a tour of all rails takes for the 20 cm of a centre cell, at 0.5 m/s. On
        /// patrol a rail is overdue if the robot did not visit it for as long as a tour takes.
        tour_cell_ms: u32 = 400, 200..=4_000, "ms";
        /// Distance from the robot within which centre cells are visited: half a corridor of 2 m
        /// less a quarter of a centre cell, so that the robot visits none beyond a wall.
        visit_m: f32 = 0.95, 0.2..=3.0, "m";
        /// Distance from the robot at which a pending visit ends: most of the way to the window's
        /// edge.
        away_m: f32 = 2.4, 0.8..=10.0, "m";
        /// Length of a tick of the stamps at first, in which the robot does not cross a place. A
        /// tick is a whole number of steps, at least one.
        first_tick_ms: u32 = 800, 100..=12_800, "ms";
        /// Distance from a dropped goal, along either axis, within which the unexplored is no goal:
        /// the 0.5 m in which no other goal is taken, and the frontier's own coarse cell.
        dropped_cells: i32 = 7, 1..=30, "cells";
        /// Greatest range that counts for an opening: what is farther is open anyway.
        farthest_m: f32 = 4.0, 1.0..=12.0, "m";
        /// Increase of the mean range to a side that is an opening: half the width of a corridor.
        opening_m: f32 = 1.0, 0.2..=4.0, "m";
        /// Share of `opening_m` below which the opening is over: without hysteresis noise would
        /// repeat the vote.
        closed_share: f32 = 0.5, 0.0..=1.0, "1";
        /// Least bearing of the beams to a side, from straight ahead; the greatest is π/2.
        beside_rad: f32 = 1.2, 0.0..=2.5, "rad";
        /// Radius of the half disc with the preferred side: that of the local goal. The direction
        /// ahead is that of the last such distance driven, so that the disc does not turn with a
        /// robot that turns into it.
        disc_m: f32 = 2.0, 0.5..=5.0, "m";
        /// Preference ε of the preferred side, and minus that of the other.
        side_preference: f32 = 0.2, 0.0..=2.0, "1";
    }
}

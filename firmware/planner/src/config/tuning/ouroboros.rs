//! Tuned constants of strategy Ouroboros.

tuning! {
    /// Tuned constants of strategy Ouroboros \[Jorge15\].
    "ouroboros" OuroborosTuning {
        /// Distance from the tractor point at which the robot has reached it: `Threshold` of the
        /// paper's Algorithm 1, line 7. The paper gives no value; this is half a corridor. At this
        /// distance along the path, a revisit is done too.
        reached_m: f32 = 1.0, 0.2..=5.0, "m";
        /// Least distance of the tractor point behind the robot: a shield must find room between.
        /// Four times this distance is the shortest stretch that is worth a revisit.
        least_behind_m: f32 = 2.5, 0.5..=10.0, "m";
        /// Distance behind the robot beyond which a tractor point without a loop is made again.
        far_m: f32 = 10.0, 2.0..=50.0, "m";
        /// Rounds in a row without loop road or shield after which a loop is lost: a spur under the
        /// robot is gone by then. After as many lost loops in a row the next one is given up.
        lost_rounds: u8 = 3, 1..=30, "rounds";
        /// Distance from a loop's path, along either axis, within which regions are closed with it:
        /// half the width of a corridor.
        near_cells: i32 = 10, 1..=32, "cells";
        /// Greatest length of a shield to one side of the path, and of the loop road's back along
        /// which a place for it is tried: 6.4 m.
        most_reach_cells: u8 = 32, 4..=100, "coarse cells";
        /// Cells between the robot and the shield along at least one axis: with fewer, the wall is
        /// at the robot's own place in the window.
        clear_cells: i32 = 2, 0..=8, "coarse cells";
        /// Branches that one call of the search for a revisit looks at. Those with too short a
        /// stretch cost no wave. With 0 there are no revisits, as in the paper.
        most_branches: usize = 12, 0..=100, "branches";
    }
}

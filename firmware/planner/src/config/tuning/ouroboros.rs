//! Tuned constants of strategy Ouroboros.

tuning! {
    /// Tuned constants of strategy Ouroboros \[Jorge15\].
    "ouroboros" OuroborosTuning {
        /// Distance from the tractor point at which the robot has reached it: `Threshold` of the
        /// paper's Algorithm 1, line 7. The paper gives no value; this is half a corridor.
        reached_m: f32 = 1.0, 0.2..=5.0, "m";
        /// Least distance of the tractor point behind the robot: a shield must find room between.
        /// Four times this distance is the shortest stretch that is worth a revisit.
        least_behind_m: f32 = 2.5, 0.5..=10.0, "m";
        /// Greatest distance of a tractor point aside of the robot's path: beyond it the robot did
        /// not visit the place.
        most_aside_m: f32 = 1.5, 0.2..=5.0, "m";
        /// Distance behind the robot beyond which a tractor point without a loop is made again.
        far_m: f32 = 10.0, 2.0..=50.0, "m";
        /// Rounds in a row without loop road or shield after which a loop is lost: a spur under the
        /// robot is gone by then.
        lost_rounds: u8 = 3, 1..=30, "rounds";
        /// Loops lost, since one was last closed or given up, after which the next one is given up.
        most_lost_loops: u8 = 3, 0..=30, "loops";
        /// Distance from a loop's path, along either axis, within which regions are closed with it:
        /// half the width of a corridor.
        near_cells: i32 = 10, 1..=32, "cells";
        /// Cells of the loop road's back that are tried for a shield: the nearest 8 m. It bounds
        /// the cost of the search.
        most_tried_cells: usize = 40, 4..=200, "coarse cells";
        /// Greatest length of a shield to one side of the path: 6.4 m.
        most_reach_cells: u8 = 32, 4..=100, "coarse cells";
        /// Greatest number of centre cells on a shield: those of one branch that crosses it at an
        /// angle.
        most_cut_cells: usize = 4, 1..=9, "coarse cells";
        /// Cells between the robot and the shield along at least one axis: with fewer, the wall is
        /// at the robot's own place in the window.
        clear_cells: i32 = 2, 0..=8, "coarse cells";
        /// Steps to the middle of the stretch at which a revisit is done: 0.8 m, within what the
        /// goal's closed regions cover.
        done_steps: u32 = 4, 1..=40, "steps";
        /// Branches that one call of the search for a revisit looks at. Those with too short a
        /// stretch cost no wave.
        most_branches: usize = 12, 1..=100, "branches";
    }
}

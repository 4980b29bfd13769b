//! Tuned constants of uneven ground: the filter of the attitude, the survey, drops, the classes of
//! cells, and the view through doorways.
//!
//! Units: metres, millimetres, map cells of 0.1 m; slopes are tangents.

use crate::geometry::CELL_M;

tuning! {
    /// Tuned constants of uneven ground.
    "ground" GroundTuning {
        /// Share of a deviation that the filter of the attitude corrects in one step.
        attitude_gain: f32 = 0.5, 0.1..=1.0, "1";
        /// Standard deviation of the filtered slope over that of one slope: √(g / (2 − g)) for a
        /// gain of g.
        smoothed_ratio: f32 = 0.577, 0.2..=1.2, "1";
        /// Steps that the mean of the second differences of the attitude remembers: 20 s at 5 Hz.
        noise_steps: u8 = 100, 20..=250, "steps";
        /// Standard deviation of a slope below which the attitude counts as exact: 0.15°.
        exact_sigma: f32 = 0.0026, 0.0005..=0.02, "1";
        /// Standard deviation of a height at the reach of the measured heights.
        max_height_sigma_m: f32 = 0.03, 0.01..=0.1, "m";
        /// Standard deviations of one slope beyond which a deviation is motion. They are 4.3
        /// standard deviations of the deviation itself. At 3 one step in fifty would count as
        /// motion and pass unfiltered: exactly the steps with the largest errors.
        motion_sigmas: f32 = 5.0, 2.0..=10.0, "1";

        /// A height farther than this from the mean may be a false return.
        outlier_m: f32 = 0.15, 0.05..=0.5, "m";
        /// Score that a hit of something that stands adds to a cell. A measurement of ground takes
        /// one point away.
        hit_score: u8 = 2, 1..=4, "points";
        /// Least score of an obstacle: one hit may be a false return.
        obstacle_score: u8 = 3, 1..=7, "points";
        /// Depth behind a beam's end at which an obstacle is marked: three standard deviations of a
        /// range, so that the cell belongs to the obstacle and not to the ground before it.
        hit_depth_m: f32 = 0.03, 0.0..=0.1, "m";

        /// Radius around the start that the tilted beams never see. They meet level ground 1.39 m
        /// from the robot's centre.
        blind_radius_m: f32 = 1.35, 0.5..=2.8, "m";
        /// Error of a height, also of one of low confidence: from the attitude, the range and the
        /// extent of the cell.
        height_tolerance_m: f32 = 0.10, 0.02..=0.3, "m";
        /// Rise above the steepest slope from which P is the foot of an obstacle and no ground.
        wall_foot_m: f32 = 0.03, 0.01..=0.1, "m";
        /// Greatest gap between K and the ground that a level beam measures. Beyond it, the beam
        /// may have hit a wall.
        max_ground_gap_m: f32 = 0.45, 0.1..=1.0, "m";
        /// Least depth of a drop.
        min_drop_m: f32 = 0.08, 0.02..=0.3, "m";
        /// Least gap between K and P for a drop between them.
        min_drop_gap_m: f32 = 1.5 * CELL_M, 0.05..=0.5, "m";
        /// Greatest height above K at which a beam just passes over it.
        grazing_m: f32 = 0.15, 0.05..=0.5, "m";
        /// Greatest height above K at which a beam just passes over a possible drop. K was measured
        /// long before, and from elsewhere.
        possible_grazing_m: f32 = 0.3, 0.1..=1.0, "m";
        /// Length before K over which the slope at K is measured.
        slope_base_m: f32 = 0.3, 0.1..=1.0, "m";
        /// Greatest change of the slope between K and P on a brow.
        max_bend: f32 = 0.15, 0.05..=0.5, "1";
        /// Share of the climb from which a beam comes down steeply enough to tell a rim from a
        /// slope.
        steep_share: f32 = 0.85, 0.2..=2.0, "1";
        /// Share of the climb from which the line from K to P is steep enough for a possible drop.
        possible_steep_share: f32 = 0.3, 0.1..=1.0, "1";
        /// Least gap between K and P for a brow between them. Behind the brow of a climbable slope,
        /// nearer ground is not as low as a drop.
        min_brow_gap_m: f32 = 0.45, 0.1..=1.0, "m";
        /// Greatest length marked as a drop behind K. Farther ground may be seen from elsewhere.
        drop_depth_m: f32 = 0.6, 0.2..=2.0, "m";
        /// Least distance from the laser at which K is looked for.
        min_ground_m: f32 = 0.2, 0.05..=0.5, "m";
        /// Distance from the laser at which the ground under the robot stands for K.
        robot_ground_m: f32 = 0.1, 0.0..=0.5, "m";
        /// Reach of heights of low confidence over the reach of measured heights.
        low_confidence_reach: f32 = 2.0, 1.0..=4.0, "1";
        /// Cells from one sample of the kernel to the next, along both axes.
        kernel_stride_cells: usize = 2, 1..=5, "cells";
        /// One in so many of the kernel's samples must be measured for the mean to count.
        kernel_divisor: u16 = 8, 1..=100, "1";

        /// Distance from the robot along an axis within which unmeasured ground stays unmeasured.
        /// The steep beams meet level ground farther off (1.39 m), and would have met a slope.
        near_cells: i32 = 9, 3..=20, "cells";
        /// Share of the climb that a slope may have if a noisy attitude measured it: across a gap,
        /// and on the way to a height of low confidence.
        noisy_climb_share: f32 = 0.75, 0.2..=2.0, "1";

        /// Error of the difference of two mean heights: two standard deviations, for means of four
        /// heights with a standard deviation of 0.01 m each.
        mean_noise_m: f32 = 0.015, 0.0..=0.05, "m";
        /// Share of the climb that an edge may add to the step.
        edge_climb_share: f32 = 0.25, 0.0..=1.0, "1";
        /// Share of the greatest rise over four cells that each half must have, for a slope or an
        /// edge.
        half_share: f32 = 0.3, 0.1..=0.7, "1";
        /// Share of the greatest rise over four cells that the ends of a bridge may differ by.
        bridge_share: f32 = 0.7, 0.2..=2.0, "1";
        /// Distance to either side within which the ground beside a gap is looked for.
        max_gap_cells: i32 = 10, 2..=30, "cells";
        /// Directions, of four, in which ground must span a gap. At the corner of a hole only one
        /// does.
        min_directions: i32 = 3, 1..=6, "1";
        /// Difference between the grade across a gap and the grades beside it. A gap higher than an
        /// edge must blend in: a kerb in a gap is steep between two level grounds.
        max_blend: f32 = 0.1, 0.02..=0.5, "1";
        /// Measured cells, of the eight around, that free an obstacle of the map.
        min_measured_around: u32 = 6, 1..=12, "cells";

        /// Greatest width of a doorway.
        max_doorway_m: f32 = 2.0, 1.0..=5.0, "m";
        /// Difference of range between a jamb and the next beam; the jamb is nearer.
        jamb_step_mm: u16 = 100, 20..=500, "mm";
        /// Range below which a beam's end can be a jamb: inside the elevation window.
        max_jamb_mm: u16 = 3_000, 1_000..=6_000, "mm";
        /// Least depth behind the threshold of every beam's end.
        min_recess_m: f32 = 0.08, 0.0..=0.3, "m";
        /// Greatest slope of the robot along x and y that shows a doorway: 2.9°.
        max_doorway_tilt: f32 = 0.05, 0.01..=0.2, "1";
        /// Distance between the ends of neighbouring beams on one wall.
        max_wall_gap_m: f32 = 0.7, 0.2..=2.0, "m";
    }
}

//! Tuned constants of the map: beams into cells, evidence, obstacle points, and the elevation
//! window's classes into the tiles.
//!
//! Units: metres, millimetres, map cells of 0.1 m.

tuning! {
    /// Tuned constants of the map.
    "map" MapTuning {
        /// Radius around the robot's centre in which it stands: the ground carries the wheels
        /// there, and no cell is unknown.
        stand_radius_m: f32 = 0.25, 0.1..=0.5, "m";
        /// Least height of an obstacle above the robot's ground for the tilted laser on flat
        /// ground. It exceeds the ground clearance of a Pioneer 3-AT, and three sigma of an
        /// attitude error of 1° at the tilted beam's reach.
        tilted_obstacle_m: f32 = 0.15, 0.05..=0.5, "m";
        /// Length before a beam's end on which it does not erode obstacles: at a grazing angle it
        /// crosses the wall's own cells first.
        guard_m: f32 = 0.35, 0.1..=1.0, "m";
        /// Range from which on every second beam frees cells: nearer, every fourth one does. At 1°
        /// per beam, every fourth beam is one cell (0.1 m) from the next at 1.4 m. From twice this
        /// range on every beam frees cells.
        second_beam_from_mm: u16 = 1_400, 0..=5_000, "mm";

        /// A hit raises the count of a cell by this; a pass lowers it by 1.
        hit_count: u8 = 3, 1..=15, "1";
        /// Least count of an obstacle. No count exceeds 15.
        obstacle_count: u8 = 10, 2..=15, "1";
        /// Greatest count of a free cell.
        free_count: u8 = 7, 1..=15, "1";
        /// Count that an unknown cell starts with.
        unknown_start: u8 = 8, 1..=15, "1";
        /// Count that a free cell starts with.
        free_start: u8 = 5, 1..=15, "1";
        /// Count that an obstacle or a negative obstacle starts with. No count exceeds 15.
        obstacle_start: u8 = 12, 1..=15, "1";

        /// Reach for obstacle points ahead, from the robot's centre: half the robot and its braking
        /// distance.
        reach_m: f32 = 1.2, 0.4..=3.0, "m";
        /// Reach for obstacle points and cells behind: half the robot's diagonal and its longest
        /// leg backwards. Cells count up to 1.5 m.
        reach_behind_m: f32 = 0.8, 0.4..=1.6, "m";
        /// A return nearer than this to an obstacle point is a return of it: a little over two
        /// sigma of a range. The mean rounds a sharp corner by a third of this. A point farther
        /// than this inside the robot's rectangle is false.
        same_point_m: f32 = 0.025, 0.005..=0.1, "m";
        /// Greatest number of returns in an obstacle point's mean; later returns weigh as much as
        /// the last of these.
        max_returns: u8 = 8, 1..=100, "returns";
        /// A beam that ends this far behind an obstacle point passed through its place: five sigma
        /// of a range.
        through_m: f32 = 0.05, 0.01..=0.2, "m";

        /// Rows of the elevation window this near to the robot are classified in every step, others
        /// in every second step. It is more than the robot's stopping distance.
        near_rows: i32 = 12, 4..=32, "cells";
        /// Number of doorway cells after which a step starts no further beam; the rest waits for
        /// the next step. A whole room at once takes too long for a step.
        max_doorway_cells: u32 = 5_000, 500..=20_000, "cells";
        /// Cells around a goal that are resolved with it.
        resolve_cells: i32 = 3, 0..=10, "cells";
        /// Cells around the place before a blocked robot in which gaps are freed: the ground hidden
        /// behind a brow is at least as wide.
        free_gap_cells: i32 = 5, 0..=15, "cells";
    }
}

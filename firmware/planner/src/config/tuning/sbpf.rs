//! Tuned constants of the space-based potential field.
//!
//! Measured: docs/MEASURED.md, "Repulsion of cells that a peer visited".

tuning! {
    /// Tuned constants of strategies SBPF and ESBPF \[Kenealy15\], which gives the twist only.
    "sbpf" SbpfTuning {
        /// Least side of a cell of the area: about that of the robot, so that a door is one cell
        /// wide and is a gate. Gates of other widths are not seen.
        cell: i32 = 5, 2..=20, "cells";
        /// Weight K of the repulsion beside an attraction of 1.
        repulsion: f32 = 0.2, 0.0..=1000.0, "m³";
        /// Range of the repulsion, ρ₀: that of a SICK LMS 200.
        range_m: f32 = 8.0, 0.5..=50.0, "m";
        /// Angle of the conveyor belt, α: 30° \[Kenealy15, 3.3\].
        twist_rad: f32 = core::f32::consts::FRAC_PI_6, -3.2..=3.2, "rad";
        /// Repulsion of a cell that a peer visited, beside an obstacle's of 1.
        peer: f32 = 3.0, 0.0..=10.0, "1";
        /// Repulsion of a covered cell beside an obstacle's of 1: 1 in \[Kenealy15, eq. 3\], which
        /// sums over every cell with a level. 0 leaves them out.
        covered: f32 = 0.0, 0.0..=10.0, "1";
        /// Time without a newly covered cell after which a robot that follows forces only is
        /// trapped.
        trapped_ms: u32 = 60_000, 1_000..=1_000_000, "ms";
        /// A frontier that moved less is still the one that the robot set out for.
        errand_cells: i32 = 10, 1..=100, "cells";
    }
}

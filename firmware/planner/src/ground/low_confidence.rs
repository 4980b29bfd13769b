//! Heights of low confidence: ground met beyond the reach of the [attitude
//! filter](super::attitude_filter), and when it counts as free.
//!
//! ```text
//! usable:  |z − h| ≤ height_tolerance_m + noisy_climb_share climb d
//! ```
//!
//! Here z is the height of the cell and h the first measured height on the line to the robot, d
//! away over ground. The cell lies at most `near_cells` from the robot. On the line before h there
//! is no obstacle and no drop.
//!
//! Behind a brow, tilted beams meet the ground only far off, until the robot itself tilts. If the
//! attitude is noisy, nothing is measured there, and unmeasured ground stops the robot before its
//! nose goes down. Therefore such ground becomes free when the robot is too near to measure it, if
//! a gentle slope leads to it from the measured ground before it. It never becomes a measured
//! height, because its errors would make edges beside measured heights.
//!
//! Departs from \[Maffei20, III-B\]: the paper measures attitude without error.
//!
//! Units: metres, map cells; slopes are tangents.

use crate::geometry::Cell;
use crate::ground::classify::RiseLimits;
use crate::ground::elevation::{Heights, WINDOW_SIDE};

/// Returns true if a cell with a height of low confidence counts as free. The robot is in the
/// middle of the window.
pub(super) fn is_usable(heights: &Heights<'_>, limits: &RiseLimits<'_>, cell: Cell) -> bool {
    let Some(low_confidence_m) = heights.low_confidence_m(cell) else {
        return false;
    };
    let (climb, tuning) = (limits.climb, limits.tuning);
    let robot = heights.origin().offset(WINDOW_SIDE / 2, WINDOW_SIDE / 2);
    let (dx, dy) = (robot.x - cell.x, robot.y - cell.y);
    let steps = dx.abs().max(dy.abs());
    if steps > tuning.near_cells {
        return false;
    }
    let distance_m = cell.distance_m(robot);
    for k in 1..=steps {
        let on = cell.offset(rounded(k * dx, steps), rounded(k * dy, steps));
        if heights.is_obstacle(on, tuning) || heights.is_drop(on) {
            return false;
        }
        if let Some(height_m) = heights.height_m(on) {
            let d_m = distance_m * k as f32 / steps as f32;
            return (low_confidence_m - height_m).abs()
                <= tuning.height_tolerance_m + tuning.noisy_climb_share * climb * d_m;
        }
    }
    false
}

/// Returns a / b, rounded to nearest, for b > 0.
const fn rounded(a: i32, b: i32) -> i32 {
    (2 * a + b).div_euclid(2 * b)
}

#[cfg(test)]
mod tests {
    use super::is_usable;
    use crate::config::{GroundTuning, UnevenGround};
    use crate::geometry::Cell;
    use crate::ground::classify::RiseLimits;
    use crate::ground::elevation::Elevation;
    use crate::ground::elevation::tests::OwnedWindow;

    /// Three cells ahead of the measured ground around the robot.
    const CELL: Cell = Cell { x: 6, y: 2 };

    /// Level ground measured up to column 3, and a height of low confidence three cells on.
    fn is_usable_at(low_confidence_m: f32, before: impl Fn(&mut Elevation<'_>)) -> bool {
        let mut owned = OwnedWindow::new(Cell::default());
        let mut window = owned.write();
        for x in -3..=3 {
            for y in -3..=3 {
                window.measure(Cell { x, y }, 0.0);
            }
        }
        window.measure_low_confidence(CELL, low_confidence_m);
        before(&mut window);
        let ground = UnevenGround {
            climb: 0.36,
            ..UnevenGround::TABLE_I
        };
        let limits = RiseLimits::new(&ground, &GroundTuning::DEFAULT);
        is_usable(&window.read(), &limits, CELL)
    }

    #[test]
    fn a_gentle_slope_makes_low_confidence_usable() {
        // 0.10 + 0.75 · 0.36 · 0.316
        for (low_confidence_m, expected) in [
            (0.0, true),
            (-0.17, true),
            (0.17, true),
            (-0.20, false),
            (0.20, false),
        ] {
            assert_eq!(
                is_usable_at(low_confidence_m, |_| ()),
                expected,
                "{low_confidence_m}"
            );
        }
    }

    #[test]
    fn a_drop_or_an_obstacle_between_refuses_low_confidence() {
        let between = Cell { x: 4, y: 1 };
        assert!(!is_usable_at(0.0, |window| window.mark_drop(between)));
        assert!(!is_usable_at(0.0, |window| {
            window.mark_obstacle(between);
            window.mark_obstacle(between);
        }));
    }

    #[test]
    fn measured_ground_and_distant_ground_are_not_of_low_confidence() {
        assert!(!is_usable_at(0.0, |window| window.measure(CELL, 0.0)));
        assert!(!is_usable_at(0.0, |window| {
            window.follow(Cell { x: -4, y: 0 });
        }));
    }
}

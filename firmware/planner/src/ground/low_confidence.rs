//! Glimpses: ground met from farther off than the attitude lets heights be measured.
//!
//! ```text
//! enough:  |z − h| ≤ TOLERANCE_M + CLIMB_SHARE climb d        h measured nearest on the way to the robot, d away over ground, d ≤ MAX_CELLS
//! ```
//!
//! Over the brow of a slope tilted beams meet the ground far off only, until the robot itself tilts; of an attitude that is not sure nothing
//! would be measured there, and ground never measured stops the robot before its nose goes down. So what was glimpsed there is free to
//! drive on once the robot stands so near that it will not be measured from where it stands, unless it lies higher or lower than a
//! gentle slope from the measured ground before it can lead. It becomes no height: beside heights that are measured its errors would
//! make edges. Not in [Maffei20], which measures attitude without error. Units: metres, map cells.

use crate::geometry::{CELL_M, Cell};
use crate::ground::elevation::{Heights, WINDOW_SIDE};

/// From farther off than this to either side of the robot glimpses are not enough, cells: tilted beams meet level ground beyond, and
/// measure it.
const MAX_CELLS: i32 = 9;
/// What a mean of glimpses errs by, metres.
const TOLERANCE_M: f32 = 0.10;
/// The part of the climb by which ground may rise or fall on the way to a glimpse.
const CLIMB_SHARE: f32 = 0.75;

/// Whether a cell that was only glimpsed is as good as measured to the robot in the window's middle, which climbs so much.
#[must_use]
pub fn is_usable(heights: &Heights<'_>, climb: f32, cell: Cell) -> bool {
    let Some(low_confidence_m) = heights.low_confidence_m(cell) else {
        return false;
    };
    let origin = heights.origin();
    let (dx, dy) = (
        origin.x + WINDOW_SIDE / 2 - cell.x,
        origin.y + WINDOW_SIDE / 2 - cell.y,
    );
    let way = dx.abs().max(dy.abs());
    if way > MAX_CELLS {
        return false;
    }
    let far_m = crate::math::sqrt((dx * dx + dy * dy) as f32) * CELL_M;
    for k in 1..=way {
        let on = Cell {
            x: cell.x + nearest(k * dx, way),
            y: cell.y + nearest(k * dy, way),
        };
        if heights.is_obstacle(on) || heights.is_drop(on) {
            return false;
        }
        if let Some(height_m) = heights.height_m(on) {
            let d_m = far_m * k as f32 / way as f32;
            return (low_confidence_m - height_m).abs() <= TOLERANCE_M + CLIMB_SHARE * climb * d_m;
        }
    }
    false
}

/// a / b to the nearest whole, for b > 0.
const fn nearest(a: i32, b: i32) -> i32 {
    (2 * a + b).div_euclid(2 * b)
}

#[cfg(test)]
mod tests {
    use std::boxed::Box;
    use std::vec;

    use super::is_usable;
    use crate::geometry::Cell;
    use crate::ground::elevation::{Elevation, WINDOW_CELLS};

    const CLIMB: f32 = 0.36;
    /// Three cells ahead of what is measured around the robot, at 0.
    const CELL: Cell = Cell { x: 6, y: 2 };

    /// Level ground measured as far as column 3, and a glimpse three cells on.
    fn is_usable_at(low_confidence_m: f32, before: impl Fn(&mut Elevation<'_>)) -> bool {
        let mut heights: Box<[u8]> = vec![0; 2 * WINDOW_CELLS].into();
        let mut marks: Box<[u8]> = vec![0; WINDOW_CELLS].into();
        let mut origin = Cell::default();
        let mut window = Elevation::new(&mut heights, &mut marks, &mut origin);
        window.follow(Cell::default());
        for x in -3..=3 {
            for y in -3..=3 {
                window.measure(Cell { x, y }, 0.0);
            }
        }
        window.measure_low_confidence(CELL, low_confidence_m);
        before(&mut window);
        is_usable(&window.read(), CLIMB, CELL)
    }

    #[test]
    fn what_a_gentle_slope_leads_to_is_enough() {
        // 0.10 + 0.75 · 0.36 · 0.316
        for (low_confidence_m, enough) in [
            (0.0, true),
            (-0.17, true),
            (0.17, true),
            (-0.20, false),
            (0.20, false),
        ] {
            assert_eq!(
                is_usable_at(low_confidence_m, |_| ()),
                enough,
                "{low_confidence_m}"
            );
        }
    }

    #[test]
    fn what_is_gone_or_stands_on_the_way_is_not_led_over() {
        let between = Cell { x: 4, y: 1 };
        assert!(!is_usable_at(0.0, |window| window.mark_drop(between)));
        assert!(!is_usable_at(0.0, |window| {
            window.mark_obstacle(between);
            window.mark_obstacle(between);
        }));
    }

    #[test]
    fn measured_ground_and_ground_far_off_are_no_matter_of_glimpses() {
        assert!(!is_usable_at(0.0, |window| window.measure(CELL, 0.0)));
        assert!(!is_usable_at(0.0, |window| {
            window.follow(Cell { x: -4, y: 0 });
        }));
    }
}

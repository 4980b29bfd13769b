//! The side slope: the robot's roll on a slope for a heading, and the headings within its limit.
//!
//! ```text
//! g = (∂h/∂x, ∂h/∂y)                      slope of the ground under the robot
//! side_slope(g, ψ) = g_y cos ψ − g_x sin ψ
//!                                         tangent of the roll; positive: the left side is higher
//! |side_slope| ≤ r  ⇔  ψ within asin(r / |g|) of the fall line, up or down
//! ```
//!
//! The robot may climb slopes head-on that it may not cross. On a slope steeper than its limit `r`
//! two intervals of headings remain, around uphill and around downhill, and the robot cannot turn
//! from one to the other. So it follows a path in one slope direction, forwards or backwards, until
//! the path leads clearly into the other; a path straight across becomes a zigzag. \[Maffei20\]
//! names this problem as open.
//!
//! Units: tangents, metres, radians.

use crate::geometry::{CELL_M, Cell};
use crate::ground::elevation::Heights;
use crate::math;

/// Cells to either side between which a slope is measured: about the distance of the wheels.
const REACH: i32 = 2;
/// Rows (and columns) in which a slope is measured, by their offset.
const ROWS: [i32; 3] = [0, -2, 2];
/// Part of the limit that headings use: heights have errors, and the robot drifts.
const KEPT_PART: f32 = 0.8;
/// Bias for the previous slope direction, as the cosine of a path's angle to the fall line.
const PREVIOUS_BIAS: f32 = 0.25;
/// Bias for the goal's slope direction, as the same cosine: a path along a slope goes by its foot
/// or its brow.
const GOAL_BIAS: f32 = 0.15;

/// One end of the fall line.
///
/// No value is zero: so a planner without a direction is all zeros and takes no flash.
#[repr(u8)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SlopeDirection {
    /// Uphill.
    Up = 1,
    /// Downhill.
    Down = 2,
}

/// The slope directions that decide where a path leads across a slope.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Hysteresis {
    /// The direction of the last step; favoured.
    pub(crate) previous: Option<SlopeDirection>,
    /// The direction of the goal; favoured.
    pub(crate) goal: Option<SlopeDirection>,
    /// The blocked side, where the drive found no recovery; excluded.
    pub(crate) blocked: Option<SlopeDirection>,
}

impl Hysteresis {
    /// Returns the least cosine of a path's angle to uphill for which the robot goes uphill.
    fn least_up(self) -> f32 {
        match self.blocked {
            Some(SlopeDirection::Up) => return f32::INFINITY,
            Some(SlopeDirection::Down) => return f32::NEG_INFINITY,
            None => {}
        }
        let bias = |direction: Option<SlopeDirection>, by: f32| match direction {
            Some(SlopeDirection::Up) => -by,
            Some(SlopeDirection::Down) => by,
            None => 0.0,
        };
        bias(self.previous, PREVIOUS_BIAS) + bias(self.goal, GOAL_BIAS)
    }
}

/// A slope: the tangents along x and y.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Slope {
    /// Metres up per metre along x.
    pub(crate) x: f32,
    /// Metres up per metre along y.
    pub(crate) y: f32,
}

impl Slope {
    /// Returns the mean slope around a cell, from pairs of heights on opposite sides; `None`
    /// without a measured pair along each axis.
    #[must_use]
    pub(crate) fn around(heights: &Heights<'_>, cell: Cell) -> Option<Self> {
        Self::of(heights, cell, &ROWS)
    }

    /// Returns the slope from one pair of heights along each axis: faster than [`Slope::around`]
    /// and less exact.
    #[must_use]
    pub(crate) fn at(heights: &Heights<'_>, cell: Cell) -> Option<Self> {
        Self::of(heights, cell, &[0])
    }

    fn of(heights: &Heights<'_>, cell: Cell, beside: &[i32]) -> Option<Self> {
        let height = |x: i32, y: i32| {
            heights.height_m(Cell {
                x: cell.x + x,
                y: cell.y + y,
            })
        };
        let x = mean(
            beside
                .iter()
                .map(|&y| (height(REACH, y), height(-REACH, y))),
        )?;
        let y = mean(
            beside
                .iter()
                .map(|&x| (height(x, REACH), height(x, -REACH))),
        )?;
        Some(Self { x, y })
    }

    /// Returns the tangent of the slope along its fall line.
    #[must_use]
    pub(crate) fn steepness(self) -> f32 {
        math::sqrt(self.x * self.x + self.y * self.y)
    }

    /// Returns the slope in a frame that is turned by `yaw_rad`.
    #[must_use]
    pub(crate) fn turned(self, yaw_rad: f32) -> Self {
        let (sin, cos) = math::sin_cos(yaw_rad);
        Self {
            x: self.x * cos + self.y * sin,
            y: self.y * cos - self.x * sin,
        }
    }

    /// Returns the tangent of the robot's roll for the sine and cosine of its heading.
    #[must_use]
    pub(crate) fn side_slope(self, (sin, cos): (f32, f32)) -> f32 {
        self.y * cos - self.x * sin
    }

    /// Returns true if the side slope exceeds `limit` in the direction (x, y).
    #[must_use]
    pub(crate) fn is_crossed(self, (x, y): (f32, f32), limit: f32) -> bool {
        // The squares of a field's gradient far from its goal underflow.
        let length = x.abs().max(y.abs());
        if length == 0.0 {
            return false;
        }
        let (x, y) = (x / length, y / length);
        let across = self.side_slope((y, x));
        across * across > limit * limit * (x * x + y * y)
    }

    /// Returns the nearest heading whose side slope is within [`KEPT_PART`] of `limit`, and its
    /// slope direction. If the robot may cross the slope, returns `heading_rad` and no direction.
    #[must_use]
    pub(crate) fn heading(
        self,
        heading_rad: f32,
        limit: f32,
        hysteresis: Hysteresis,
    ) -> (f32, Option<SlopeDirection>) {
        let (steepness, most) = (self.steepness(), KEPT_PART * limit);
        if steepness <= most {
            return (heading_rad, None);
        }
        let up_rad = math::atan2(self.y, self.x);
        let (_, along) = math::sin_cos(heading_rad - up_rad);
        let (direction, middle_rad) = if along >= hysteresis.least_up() {
            (SlopeDirection::Up, up_rad)
        } else {
            (SlopeDirection::Down, up_rad + math::PI)
        };
        let half_rad = math::atan2(most, math::sqrt(steepness * steepness - most * most));
        let off_rad = math::wrap(heading_rad - middle_rad).clamp(-half_rad, half_rad);
        (math::wrap(middle_rad + off_rad), Some(direction))
    }
}

/// Returns the mean slope over the pairs of which both heights are known.
fn mean(pairs: impl Iterator<Item = (Option<f32>, Option<f32>)>) -> Option<f32> {
    let (mut sum_m, mut count) = (0.0, 0.0);
    for (there, here) in pairs {
        if let (Some(there), Some(here)) = (there, here) {
            sum_m += there - here;
            count += 1.0;
        }
    }
    (count > 0.0).then(|| sum_m / (count * 2.0 * REACH as f32 * CELL_M))
}

#[cfg(test)]
mod tests {
    use super::{Hysteresis, KEPT_PART, Slope, SlopeDirection};
    use crate::geometry::Cell;
    use crate::ground::elevation::tests::OwnedWindow;
    use crate::math::{self, PI};

    const MOST: f32 = 0.268;

    /// Returns the tangent of the roll of a rectangle on a plane, from the heights of its wheels.
    fn roll_of_wheels(slope: Slope, heading: f64) -> f64 {
        let height = |x: f64, y: f64| f64::from(slope.x) * x + f64::from(slope.y) * y;
        let side = |left: f64| {
            let wheel = |ahead: f64| {
                let (sin, cos) = heading.sin_cos();
                height(ahead * cos - left * sin, ahead * sin + left * cos)
            };
            0.5 * (wheel(0.13) + wheel(-0.13))
        };
        (side(0.2) - side(-0.2)) / 0.4
    }

    #[test]
    fn a_side_slope_is_the_roll_of_four_wheels_on_the_plane() {
        for k in 0..64 {
            let slope = Slope {
                x: 0.4 * (k % 8) as f32 / 7.0 - 0.2,
                y: 0.4 * (k / 8) as f32 / 7.0 - 0.2,
            };
            for heading in [-2.5_f32, -0.3, 0.0, 1.1, 3.0] {
                let exact = roll_of_wheels(slope, f64::from(heading));
                let across = f64::from(slope.side_slope(math::sin_cos(heading)));
                assert!((across - exact).abs() < 1e-5, "{slope:?} {heading}");
                // In the robot's frame.
                let own = f64::from(slope.turned(heading).y);
                assert!((own - exact).abs() < 1e-5, "{slope:?} {heading}");
            }
        }
    }

    /// Returns the turn to the nearest heading within the limit, by trial of all of them.
    fn nearest_by_trial(slope: Slope, heading: f32) -> f32 {
        let allowed =
            |turn: f32| slope.side_slope(math::sin_cos(heading + turn)).abs() <= KEPT_PART * MOST;
        (0..3142)
            .map(|k| 0.001 * k as f32)
            .find(|&turn| allowed(turn) || allowed(-turn))
            .expect("the fall line is always allowed")
    }

    #[test]
    fn the_heading_is_the_nearest_one_within_the_limit() {
        for steep in [0.0_f32, 0.1, 0.24, 0.25, 0.3, 0.364, 0.8] {
            for k in 0..60 {
                let (sin, cos) = math::sin_cos(0.7 * k as f32);
                let (x, y) = (steep * cos, steep * sin);
                let slope = Slope { x, y };
                let heading = math::wrap(0.31 * k as f32);
                let (kept, direction) = slope.heading(heading, MOST, Hysteresis::default());
                let across = slope.side_slope(math::sin_cos(kept)).abs();
                assert!(across <= KEPT_PART * MOST + 1e-5, "{steep} {k}: {across}");
                let turn = math::wrap(kept - heading).abs();
                let least = nearest_by_trial(slope, heading);
                assert!((turn - least).abs() < 2e-3, "{steep} {k}: {turn} {least}");
                assert_eq!(direction.is_some(), steep > KEPT_PART * MOST);
            }
        }
    }

    #[test]
    fn a_path_across_keeps_its_direction_until_it_leads_well_into_the_other() {
        // It rises to the north.
        let slope = Slope { x: 0.0, y: 0.35 };
        let degrees = |degrees: f32| degrees * PI / 180.0;
        let (up, down) = (Some(SlopeDirection::Up), Some(SlopeDirection::Down));
        let direction = |heading, before, goal| {
            let hysteresis = Hysteresis {
                previous: before,
                goal,
                blocked: None,
            };
            slope.heading(degrees(heading), MOST, hysteresis).1
        };
        assert_eq!(
            [5.0, -5.0].map(|way| direction(way, None, None)),
            [up, down]
        );
        assert_eq!(
            [-12.0, -17.0].map(|way| direction(way, up, None)),
            [up, down]
        );
        assert_eq!(
            [12.0, 17.0].map(|way| direction(way, down, None)),
            [down, up]
        );
        // The goal's direction is taken sooner, and left later.
        assert_eq!([-3.0, -8.0].map(|way| direction(way, up, down)), [up, down]);
        assert_eq!(
            [21.0, 26.0].map(|way| direction(way, down, down)),
            [down, up]
        );
        // To the east, a little down, but uphill previous: north-east.
        let hysteresis = Hysteresis {
            previous: up,
            ..Hysteresis::default()
        };
        let (heading, _) = slope.heading(degrees(-12.0), MOST, hysteresis);
        assert!(
            (degrees(45.0)..degrees(60.0)).contains(&heading),
            "{heading}"
        );
    }

    #[test]
    fn a_blocked_direction_is_left_for_the_other() {
        let slope = Slope { x: 0.0, y: 0.33 };
        for (blocked, other) in [
            (SlopeDirection::Up, SlopeDirection::Down),
            (SlopeDirection::Down, SlopeDirection::Up),
        ] {
            for k in 0..64 {
                let hysteresis = Hysteresis {
                    previous: Some(blocked),
                    goal: Some(blocked),
                    blocked: Some(blocked),
                };
                let wanted_rad = 0.1 * k as f32 - PI;
                let (heading, direction) = slope.heading(wanted_rad, MOST, hysteresis);
                assert_eq!(direction, Some(other), "{wanted_rad}");
                assert!(slope.side_slope(math::sin_cos(heading)).abs() <= MOST);
            }
        }
    }

    #[test]
    fn a_slope_is_crossed_as_its_side_slope_tells() {
        let slope = Slope { x: 0.3, y: -0.1 };
        for k in 0..100 {
            let (sin, cos) = math::sin_cos(0.1 * k as f32);
            let across = slope.side_slope((sin, cos)).abs();
            assert_eq!(
                slope.is_crossed((7.0 * cos, 7.0 * sin), MOST),
                across > MOST
            );
        }
        assert!(!slope.is_crossed((0.0, 0.0), MOST), "no direction");
    }

    #[test]
    fn slopes_are_measured_where_both_sides_are_known() {
        let mut owned = OwnedWindow::new(Cell::default());
        let mut window = owned.write();
        for x in -10..5 {
            for y in -10..10 {
                let at = Cell { x, y }.centre();
                window.measure(Cell { x, y }, 0.2 * at.x_m - 0.1 * at.y_m);
            }
        }
        let heights = window.read();
        for of in [Slope::around, Slope::at] {
            let slope = of(&heights, Cell { x: -3, y: 4 }).expect("measured");
            // Heights are stored in steps of 2 mm.
            assert!((slope.x - 0.2).abs() < 0.01 && (slope.y + 0.1).abs() < 0.01);
            assert_eq!(of(&heights, Cell { x: 4, y: 0 }), None, "at its border");
        }
    }
}

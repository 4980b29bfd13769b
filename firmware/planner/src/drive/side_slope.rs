//! Sidling: how far a robot leans aside that stands on a slope with some heading, and which headings keep that within its limit.
//!
//! ```text
//! g = (∂h/∂x, ∂h/∂y)                              slope of the ground under the robot
//! lean(g, ψ) = g_y cos ψ − g_x sin ψ              tangent of the roll; positive: the left side is the higher one
//! |lean| ≤ r  ⇔  ψ within asin(r / |g|) of the fall line, up or down
//! ```
//!
//! What a robot may climb head-on it may not cross: of a slope steeper than its limit `r` two wedges of headings are left, and between them it
//! cannot turn there. So a way is taken in one wedge, forwards or backwards, until it leads clearly into the other one; a way straight across becomes
//! a zigzag. Not in [Maffei20], which names it as open. Units: tangents, metres, radians.

use crate::config::UnevenGround;
use crate::geometry::{CELL_M, Cell};
use crate::ground::elevation::Heights;
use crate::math;

/// Cells to either side between which a slope is measured: about as far apart as the wheels.
const REACH: i32 = 2;
/// Rows (and columns) beside the middle one in which it is measured as well.
const BESIDE: [i32; 3] = [0, -2, 2];
/// Headings are kept to so much of the limit: heights have errors, and the robot drifts.
const KEPT: f32 = 0.8;
/// The other wedge is taken by a way that leads into it by so much more: the cosine of its angle with the fall line.
const STEADY: f32 = 0.25;
/// The wedge that the goal lies in is taken by a way that leads out of it by no more: a way along a slope goes by its foot or its brow.
const HOMING: f32 = 0.15;

/// Which end of the fall line is gone for. No value is zero: so a planner without any is all zeros, and takes no place in the image's flash.
#[repr(u8)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlopeDirection {
    /// Uphill.
    Up = 1,
    /// Downhill.
    Down = 2,
}

/// What is in favour of a wedge where a way leads across.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Hysteresis {
    /// That the robot went for it in the last step.
    pub before: Option<SlopeDirection>,
    /// That its goal lies there.
    pub goal: Option<SlopeDirection>,
    /// Against it, for now: that the drive found no way there.
    pub shut: Option<SlopeDirection>,
}

impl Hysteresis {
    /// Cosine of the way's angle with uphill from which on it is taken uphill.
    fn least_up(self) -> f32 {
        match self.shut {
            Some(SlopeDirection::Up) => return f32::INFINITY,
            Some(SlopeDirection::Down) => return f32::NEG_INFINITY,
            None => {}
        }
        let against = |wedge: Option<SlopeDirection>, by: f32| match wedge {
            Some(SlopeDirection::Up) => -by,
            Some(SlopeDirection::Down) => by,
            None => 0.0,
        };
        against(self.before, STEADY) + against(self.goal, HOMING)
    }
}

/// A slope: the tangents along x and y.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Slope {
    /// Metres up for a metre along x.
    pub x: f32,
    /// Metres up for a metre along y.
    pub y: f32,
}

impl Slope {
    /// Of the ground around a cell, as far as it was measured on opposite sides; `None` where it was not.
    #[must_use]
    pub fn around(heights: &Heights<'_>, cell: Cell) -> Option<Self> {
        Self::of(heights, cell, &BESIDE)
    }

    /// The same from the four heights straight beside the cell: four times as quick, and rougher.
    #[must_use]
    pub fn at(heights: &Heights<'_>, cell: Cell) -> Option<Self> {
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

    /// Tangent of the angle that it rises by.
    #[must_use]
    pub fn steepness(self) -> f32 {
        math::sqrt(self.x * self.x + self.y * self.y)
    }

    /// As it looks from a frame that is turned by `yaw_rad`.
    #[must_use]
    pub fn turned(self, yaw_rad: f32) -> Self {
        let (sin, cos) = math::sin_cos(yaw_rad);
        Self {
            x: self.x * cos + self.y * sin,
            y: self.y * cos - self.x * sin,
        }
    }

    /// Tangent of a robot's roll that stands on it with a heading, by the heading's sine and cosine.
    #[must_use]
    pub fn lean(self, (sin, cos): (f32, f32)) -> f32 {
        self.y * cos - self.x * sin
    }

    /// Whether a way along (x, y) leans more than `most`.
    #[must_use]
    pub fn is_crossed(self, (x, y): (f32, f32), most: f32) -> bool {
        // Of a way as short as a field's far from its goal no square is left.
        let length = x.abs().max(y.abs());
        if length == 0.0 {
            return false;
        }
        let (x, y) = (x / length, y / length);
        let lean = self.y * x - self.x * y;
        lean * lean > most * most * (x * x + y * y)
    }

    /// The heading nearest to this one that leans no more than the part of `most` that is kept to, and in which wedge it is; as it is where
    /// the slope may be crossed.
    #[must_use]
    pub fn heading(
        self,
        heading_rad: f32,
        most: f32,
        bias: Hysteresis,
    ) -> (f32, Option<SlopeDirection>) {
        let (steepness, most) = (self.steepness(), KEPT * most);
        if steepness <= most {
            return (heading_rad, None);
        }
        let up_rad = math::atan2(self.y, self.x);
        let (_, along) = math::sin_cos(heading_rad - up_rad);
        let (wedge, middle_rad) = if along >= bias.least_up() {
            (SlopeDirection::Up, up_rad)
        } else {
            (SlopeDirection::Down, up_rad + math::PI)
        };
        let half_rad = math::atan2(most, math::sqrt(steepness * steepness - most * most));
        let off_rad = math::wrap(heading_rad - middle_rad).clamp(-half_rad, half_rad);
        (math::wrap(middle_rad + off_rad), Some(wedge))
    }
}

impl UnevenGround {
    /// The greatest lean, if any slope that may be climbed is too steep to be crossed.
    #[must_use]
    pub fn most_lean(&self) -> Option<f32> {
        (self.roll < self.climb).then_some(self.roll)
    }
}

/// Mean rise between the two ends of the pairs of which both are known.
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
    use super::{Hysteresis, KEPT, Slope, SlopeDirection};
    use crate::config::UnevenGround;
    use crate::geometry::Cell;
    use crate::ground::elevation::{Elevation, WINDOW_CELLS};
    use crate::math::{self, PI};

    const MOST: f32 = 0.268;

    /// Roll of a rectangle whose wheels stand on a plane, from their heights.
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
    fn a_lean_is_the_roll_of_four_wheels_on_the_plane() {
        for k in 0..64 {
            let slope = Slope {
                x: 0.4 * (k % 8) as f32 / 7.0 - 0.2,
                y: 0.4 * (k / 8) as f32 / 7.0 - 0.2,
            };
            for heading in [-2.5_f32, -0.3, 0.0, 1.1, 3.0] {
                let exact = roll_of_wheels(slope, f64::from(heading));
                let lean = f64::from(slope.lean(math::sin_cos(heading)));
                assert!((lean - exact).abs() < 1e-5, "{slope:?} {heading}");
                // As seen by the robot itself.
                let own = f64::from(slope.turned(heading).y);
                assert!((own - exact).abs() < 1e-5, "{slope:?} {heading}");
            }
        }
    }

    /// The nearest heading that is within the limit, by trying them all.
    fn nearest_by_trial(slope: Slope, heading: f32) -> f32 {
        let allowed = |turn: f32| slope.lean(math::sin_cos(heading + turn)).abs() <= KEPT * MOST;
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
                let (kept, wedge) = slope.heading(heading, MOST, Hysteresis::default());
                let lean = slope.lean(math::sin_cos(kept)).abs();
                assert!(lean <= KEPT * MOST + 1e-5, "{steep} {k}: {lean}");
                let turn = math::wrap(kept - heading).abs();
                let least = nearest_by_trial(slope, heading);
                assert!((turn - least).abs() < 2e-3, "{steep} {k}: {turn} {least}");
                assert_eq!(wedge.is_some(), steep > KEPT * MOST);
            }
        }
    }

    #[test]
    fn a_way_across_goes_on_in_its_wedge_until_it_leads_well_into_the_other() {
        // It rises to the north.
        let slope = Slope { x: 0.0, y: 0.35 };
        let degrees = |degrees: f32| degrees * PI / 180.0;
        let (up, down) = (Some(SlopeDirection::Up), Some(SlopeDirection::Down));
        let wedge = |heading, before, goal| {
            let bias = Hysteresis {
                before,
                goal,
                shut: None,
            };
            slope.heading(degrees(heading), MOST, bias).1
        };
        assert_eq!([5.0, -5.0].map(|way| wedge(way, None, None)), [up, down]);
        assert_eq!([-12.0, -17.0].map(|way| wedge(way, up, None)), [up, down]);
        assert_eq!([12.0, 17.0].map(|way| wedge(way, down, None)), [down, up]);
        // The goal's wedge is taken sooner, and left later.
        assert_eq!([-3.0, -8.0].map(|way| wedge(way, up, down)), [up, down]);
        assert_eq!([21.0, 26.0].map(|way| wedge(way, down, down)), [down, up]);
        // To the east, a little down, but uphill before: north-east.
        let bias = Hysteresis {
            before: up,
            ..Hysteresis::default()
        };
        let (heading, _) = slope.heading(degrees(-12.0), MOST, bias);
        assert!(
            (degrees(45.0)..degrees(60.0)).contains(&heading),
            "{heading}"
        );
    }

    #[test]
    fn a_wedge_without_a_way_is_left_to_the_other() {
        let slope = Slope { x: 0.0, y: 0.33 };
        for (shut, other) in [
            (SlopeDirection::Up, SlopeDirection::Down),
            (SlopeDirection::Down, SlopeDirection::Up),
        ] {
            for k in 0..64 {
                let bias = Hysteresis {
                    before: Some(shut),
                    goal: Some(shut),
                    shut: Some(shut),
                };
                let wanted_rad = 0.1 * k as f32 - PI;
                let (heading, wedge) = slope.heading(wanted_rad, MOST, bias);
                assert_eq!(wedge, Some(other), "{wanted_rad}");
                assert!(slope.lean(math::sin_cos(heading)).abs() <= MOST);
            }
        }
    }

    #[test]
    fn a_way_is_crossed_as_its_heading_leans() {
        let slope = Slope { x: 0.3, y: -0.1 };
        for k in 0..100 {
            let (sin, cos) = math::sin_cos(0.1 * k as f32);
            let lean = slope.lean((sin, cos)).abs();
            assert_eq!(slope.is_crossed((7.0 * cos, 7.0 * sin), MOST), lean > MOST);
        }
        assert!(!slope.is_crossed((0.0, 0.0), MOST), "no way");
    }

    #[test]
    fn slopes_are_measured_where_both_sides_are_known() {
        let (mut heights, mut marks) = ([0; 2 * WINDOW_CELLS], [0; WINDOW_CELLS]);
        let mut origin = Cell::default();
        let mut window = Elevation::new(&mut heights, &mut marks, &mut origin);
        window.follow(Cell::default());
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

    #[test]
    fn a_limit_as_steep_as_the_climb_is_none() {
        let terrain = UnevenGround::TABLE_I;
        assert_eq!(terrain.most_lean(), None);
        let roll = MOST;
        assert_eq!(UnevenGround { roll, ..terrain }.most_lean(), Some(MOST));
    }
}

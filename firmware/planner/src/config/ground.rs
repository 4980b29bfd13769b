//! Parameters of uneven ground: the robot's limits on it, and the preferences that bend the field.
//!
//! Units: metres; slopes are tangents; preferences are pure numbers.

use crate::math::{PI, sin_cos};

/// `K_n`, the width of the kernel, cells \[Maffei20, Table I\].
pub const KERNEL_CELLS: usize = 20;

/// The preferences in use \[Maffei20, III-C\].
///
/// ```
/// use fieldline_planner::{PreferenceMode, UnevenGround};
///
/// let ground = UnevenGround { mode: PreferenceMode::Height, ..UnevenGround::TABLE_I };
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PreferenceMode {
    /// No preference.
    Off,
    /// `ε_height`: prefer ground at the robot's own height.
    Height,
    /// `ε_global`: one preference for the whole window. It grows as the field becomes flat.
    Global,
    /// The sum of both.
    #[default]
    Both,
}

impl PreferenceMode {
    /// Returns true if `ε_height` is in use.
    #[must_use]
    pub const fn has_heights(self) -> bool {
        matches!(self, Self::Height | Self::Both)
    }
}

/// Parameters of uneven ground \[Maffei20, Table I\], and the robot's limits on it.
///
/// [`Config::builder`](crate::Config::builder) checks the ranges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnevenGround {
    /// The preferences in use. Default: both.
    pub mode: PreferenceMode,
    /// True if goals on other height levels cost more: a goal waits longer, the more its height
    /// differs from that of the level ground that the robot stood on last. The cost uses
    /// `height_scale` and `least_preference`. It is independent of `mode`, and not in \[Maffei20\].
    /// Default: true.
    pub levels: bool,
    /// `h_obs`: height above the mean ground around from which a return is an obstacle, metres;
    /// positive. Default: 0.30.
    pub obstacle_m: f32,
    /// `d_obs`: distance within which a steep return over unmeasured ground is an obstacle, metres;
    /// positive. Default: 1.5.
    pub near_m: f32,
    /// `h_hole`: depth below the neighbouring ground from which the end of a beam is the inside of
    /// a hole and not ground, metres; negative. Default: −0.60.
    pub hole_m: f32,
    /// `ε_hmin`, the least preference: −2 to 0. Default: −0.5.
    pub least_preference: f32,
    /// `ε_gmax`, the greatest preference, a pure number: 0 to 2. Default: 0.5.
    pub most_preference: f32,
    /// `λ_h`, preference lost per metre of height; at least 0. Default: 2.0.
    pub height_scale: f32,
    /// `λ_g`, preference gained each time that the field's steepness falls by a factor e; at least
    /// 0. Default: 0.005.
    pub global_scale: f32,
    /// Steepest slope that the robot may drive up or down, a tangent: above 0, at most 1 (45°).
    /// Default: 0.364 (20°, the 3-AT's limit).
    pub climb: f32,
    /// Steepest slope that the robot may drive across, a tangent: above 0, at most 1 (45°). A value
    /// of at least `climb` sets no limit. Default: 0.364, as `climb`; the 3-AT's limit is 0.268
    /// (15°).
    pub roll: f32,
    /// Highest edge that the robot may drive over, metres; positive. Default: 0.07.
    pub step_m: f32,
}

impl UnevenGround {
    /// The parameters of \[Maffei20, Table I\], and the limits of a Pioneer 3-AT.
    pub const TABLE_I: Self = Self {
        mode: PreferenceMode::Both,
        levels: true,
        obstacle_m: 0.30,
        near_m: 1.5,
        hole_m: -0.60,
        least_preference: -0.5,
        most_preference: 0.5,
        height_scale: 2.0,
        global_scale: 0.005,
        climb: 0.364,
        roll: 0.364,
        step_m: 0.07,
    };

    /// Returns the limit of the side slope, if some slope that may be climbed is too steep to
    /// cross.
    #[must_use]
    pub(crate) fn side_slope_limit(&self) -> Option<f32> {
        (self.roll < self.climb).then_some(self.roll)
    }
}

impl UnevenGround {
    /// Returns the tangent of a slope of `angle_rad` radians, for [`Self::climb`] and
    /// [`Self::roll`]. It is not a number below 0 and from a right angle on, and then
    /// [`ConfigBuilder::build`](crate::ConfigBuilder::build) refuses it.
    ///
    /// ```
    /// use fieldline_planner::UnevenGround;
    ///
    /// let ground = UnevenGround { climb: UnevenGround::slope(0.349), ..UnevenGround::TABLE_I };
    /// assert!((ground.climb - 0.364).abs() < 1e-3);
    /// ```
    #[must_use]
    pub fn slope(angle_rad: f32) -> f32 {
        if !(0.0..0.5 * PI).contains(&angle_rad) {
            return f32::NAN;
        }
        let (sin, cos) = sin_cos(angle_rad);
        sin / cos
    }
}

impl Default for UnevenGround {
    fn default() -> Self {
        Self::TABLE_I
    }
}

#[cfg(test)]
mod tests {
    use super::UnevenGround;

    #[test]
    fn a_roll_limit_as_large_as_the_climb_is_none() {
        let ground = UnevenGround::TABLE_I;
        assert_eq!(ground.side_slope_limit(), None);
        let roll = 0.268;
        let limited = UnevenGround { roll, ..ground };
        assert_eq!(limited.side_slope_limit(), Some(roll));
    }
}

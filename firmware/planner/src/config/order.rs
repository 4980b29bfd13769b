//! The order in which frontiers are taken.
//!
//! Units: square metres for each metre.

use crate::config::OrderTuning;

/// The order in which frontiers are taken.
///
/// ```
/// use fieldline_planner::{Config, LaserMount, Order, RobotShape};
///
/// // Explore everything that can be seen, whatever the way.
/// let config = Config::builder(RobotShape::PIONEER_3AT)
///     .laser(LaserMount::level(0.10, 0.40))
///     .order(Order::Gain { worth: 0.0 })
///     .build()?;
/// # Ok::<(), fieldline_planner::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Order {
    /// First the frontier of the greatest gain for its cost: the unexplored area around it, for the
    /// way there and the turn before it.
    Gain {
        /// Least gain of a trip, square metres for each metre of way, 0 to 7. What is not worth the
        /// trip is left; 0 leaves nothing.
        worth: f32,
    },
    /// First the nearest frontier, as in the papers: all gains are equal.
    Nearest {
        /// As for [`Gain`](Self::Gain).
        worth: f32,
    },
}

impl Order {
    /// By gain, with the default worth.
    pub const GAIN: Self = Self::Gain { worth: 0.25 };
    /// The nearest first, with the default worth.
    pub const NEAREST: Self = Self::Nearest { worth: 0.25 };
    /// The nearest first, and every trip is worth it.
    pub const ALL: Self = Self::Nearest { worth: 0.0 };

    /// Returns the least gain of a trip, square metres for each metre of way.
    pub(crate) const fn worth(self) -> f32 {
        match self {
            Self::Gain { worth } | Self::Nearest { worth } => worth,
        }
    }

    /// Returns the power of a gain in a goal's utility.
    pub(crate) const fn power(self, tuning: &OrderTuning) -> f32 {
        match self {
            Self::Gain { .. } => tuning.power,
            Self::Nearest { .. } => 0.0,
        }
    }
}

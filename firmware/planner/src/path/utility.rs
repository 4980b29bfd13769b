//! The utility of a goal: what a trip to it gains for what it costs.
//!
//! ```text
//! U = G^p / (t + 1 m)          worth it: G ≥ worth · max(t, 1 m)
//! ```
//!
//! G is the unexplored area that may be seen from the goal, t the length of the trip to it. The
//! [order](Order) of a session gives the worth and the power p: by gain 0.8, nearest first 0, so
//! that all goals gain the same.
//!
//! Units: metres, square metres.

use crate::config::{Config, Order, OrderTuning};
use crate::math;

/// Length that is added to every trip, metres, so that a goal at the robot is worth no more than
/// its gain.
const NEAR_M: f32 = 1.0;

/// The order of goals of a session.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GoalOrder<'a> {
    /// The tuned constants.
    pub(crate) tuning: &'a OrderTuning,
    /// Power of a gain.
    power: f32,
    /// Least gain of a trip, square metres for each metre of way.
    pub(crate) worth: f32,
}

impl GoalOrder<'static> {
    /// Returns the order of a session.
    pub(crate) const fn of(config: &Config) -> Self {
        Self::new(config.order(), &config.tuning.order)
    }
}

impl<'a> GoalOrder<'a> {
    /// Makes an order with these constants.
    pub(crate) const fn new(order: Order, tuning: &'a OrderTuning) -> Self {
        Self {
            tuning,
            power: order.power(tuning),
            worth: order.worth(),
        }
    }

    /// Returns the value of a gain.
    pub(crate) fn value(&self, gain_m2: f32) -> f32 {
        math::powf(gain_m2, self.power)
    }

    /// Returns the greatest value that a goal can have: of the whole square within reach.
    pub(crate) fn most_value(&self) -> f32 {
        let side_m = 2.0 * self.tuning.gain_m;
        self.value(self.tuning.keep * side_m * side_m)
    }

    /// Returns true if a gain is worth a trip.
    pub(crate) fn is_worth(&self, gain_m2: f32, trip_m: f32) -> bool {
        gain_m2 >= self.worth * trip_m.max(NEAR_M)
    }
}

/// Returns the utility of a trip for a value.
pub(crate) fn utility(value: f32, trip_m: f32) -> f32 {
    value / (trip_m + NEAR_M)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Tuning;

    const ORDER: &OrderTuning = &Tuning::DEFAULT.order;

    #[test]
    fn nearest_first_all_gains_are_equal_and_every_trip_is_worth_it() {
        let nearest = GoalOrder::new(Order::ALL, ORDER);
        for gain_m2 in [0.0, 0.01, 4.0, 36.0] {
            assert!((nearest.value(gain_m2) - 1.0).abs() < 1e-6, "{gain_m2}");
            assert!(nearest.is_worth(gain_m2, 500.0));
        }
        assert!((nearest.most_value() - 1.0).abs() < 1e-6);
    }

    #[test]
    fn by_gain_a_greater_gain_is_worth_a_longer_trip() {
        let order = GoalOrder::new(Order::Gain { worth: 0.5 }, ORDER);
        assert!(order.is_worth(2.0, 4.0) && !order.is_worth(2.0, 4.1));
        assert!(!order.is_worth(0.4, 0.0), "a trip is at least a metre long");
        let of = |gain_m2, trip_m| utility(order.value(gain_m2), trip_m);
        assert!(of(8.0, 10.0) > of(4.0, 10.0) && of(4.0, 5.0) > of(4.0, 6.0));
    }
}

//! The budget of a session: what the robot may drive before it must be home.
//!
//! Units: metres, seconds.

/// What the robot may drive and how long it may take. It drives home by itself as soon as the way
/// home takes what is left:
///
/// ```text
/// 1.5 · way + 2 m      > range left          way along the skeleton, or back along the track
/// way / (v_max / 3) + 20 s > time left
/// ```
///
/// A step of the way counts 20 cm, a diagonal one too, so a way is up to 1.41 times as long; the
/// rest is for ways round. A robot reaches half of its speed in the mean.
///
/// ```
/// use fieldline_planner::{Budget, Config, LaserMount, RobotShape};
///
/// let config = Config::builder(RobotShape::PIONEER_3AT)
///     .laser(LaserMount::level(0.10, 0.40))
///     .budget(Budget { range_m: Some(200), time_s: None })
///     .build()?;
/// # Ok::<(), fieldline_planner::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Budget {
    /// Metres; `None` for any.
    pub range_m: Option<u16>,
    /// Seconds; `None` for any.
    pub time_s: Option<u16>,
}

/// Ratio of the range that is kept to the way home, and what is kept for the start of it, metres.
const RANGE_MARGIN: (f32, f32) = (1.5, 2.0);
/// Part of the greatest speed with which the way home is counted, and what is kept for turns and
/// the first plan, seconds.
const TIME_MARGIN: (f32, f32) = (1.0 / 3.0, 20.0);

impl Budget {
    /// Returns true if there is none.
    pub(crate) const fn is_empty(&self) -> bool {
        self.range_m.is_none() && self.time_s.is_none()
    }

    /// Returns true if a robot that has driven so far for so long must go home, `way_m` away.
    pub(crate) fn is_spent(
        &self,
        (driven_m, time_ms): (f32, u32),
        way_m: f32,
        most_mps: f32,
    ) -> bool {
        let (ratio, first_m) = RANGE_MARGIN;
        let (part, first_s) = TIME_MARGIN;
        let needs_m = ratio * way_m + first_m;
        let needs_s = way_m / (part * most_mps) + first_s;
        let over = |most: Option<u16>, used: f32| most.is_some_and(|most| used > f32::from(most));
        over(self.range_m, driven_m + needs_m) || over(self.time_s, 1e-3 * time_ms as f32 + needs_s)
    }
}

#[cfg(test)]
mod tests {
    use super::Budget;

    #[test]
    fn the_way_home_is_kept() {
        let range = Budget {
            range_m: Some(100),
            time_s: None,
        };
        assert!(!range.is_spent((80.0, 0), 11.9, 0.7) && range.is_spent((80.0, 0), 12.1, 0.7));
        let time = Budget {
            range_m: None,
            time_s: Some(100),
        };
        assert!(!time.is_spent((0.0, 50_000), 6.9, 0.7) && time.is_spent((0.0, 50_000), 7.1, 0.7));
        assert!(!Budget::default().is_spent((1e9, u32::MAX), 1e9, 0.7));
    }
}

//! Limits of the loops that are worth closing.
//!
//! Units: metres.

/// Limits of a loop, for [`Strategy::Ouroboros`](crate::Strategy::Ouroboros).
///
/// ```
/// use fieldline_planner::LoopLimits;
///
/// // Only loops of 40 to 200 m, however much frontier is left.
/// let limits =
///     LoopLimits { least_m: 40.0, most_m: 200.0, most_per_frontier: 0.0, ..LoopLimits::DEFAULT };
/// # assert_eq!(limits.detour, 2.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopLimits {
    /// Least length that is worth closing, metres: a shorter loop corrects nothing. Default: 20, a
    /// circle of 6.4 m diameter: a laser of twice that range has all of it in view. With less, a
    /// robot among trees drives around most of them (measured: docs/MEASURED.md, "Least length of a
    /// loop").
    pub least_m: f32,
    /// Greatest length that is worth closing when no frontier is left, metres. Default: 120.
    pub most_m: f32,
    /// Additional length that is worth closing per metre of frontier that is left. Default: 10.
    pub most_per_frontier: f32,
    /// Greatest driven distance on a loop, a factor of its longest expected length. Default:
    /// 2.
    pub detour: f32,
    /// Additional driven distance, metres. Default: 20.
    pub slack_m: f32,
}

impl Default for LoopLimits {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl LoopLimits {
    /// The defaults of all limits.
    pub const DEFAULT: Self = Self {
        least_m: 20.0,
        most_m: 120.0,
        most_per_frontier: 10.0,
        detour: 2.0,
        slack_m: 20.0,
    };

    /// Returns true if a loop of this expected length is too long for the length of frontier that
    /// is left.
    #[must_use]
    pub(crate) fn is_too_long(&self, loop_m: f32, frontier_m: f32) -> bool {
        loop_m > self.most_m + self.most_per_frontier * frontier_m
    }

    /// Returns true if a loop of this expected length is worth closing.
    #[must_use]
    pub(crate) fn is_worth(&self, loop_m: f32, frontier_m: f32) -> bool {
        loop_m >= self.least_m && !self.is_too_long(loop_m, frontier_m)
    }
}

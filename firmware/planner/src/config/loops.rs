//! Which loops are worth closing.
//!
//! Units: metres.

/// Bounds of a loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopLimits {
    /// A shorter loop is not worth closing: it corrects nothing. Default: 20, a round of 6.4 m
    /// across, which lasers that see twice as far have in view all the way. At 10 a robot among
    /// trees goes round most of them, and takes twice the time.
    pub least_m: f32,
    /// A longer loop is not worth closing when nothing else is left to explore. Default: 120.
    pub most_m: f32,
    /// Metres of loop that are worth closing more for each metre of frontier that is left. Default:
    /// 10.
    pub most_per_frontier: f32,
    /// Times the longest expected length that the robot may go. Default: 2.
    pub detour: f32,
    /// Metres that it may go beside that. Default: 20.
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

    /// Whether a loop of this expected length is too long, with so much frontier left.
    #[must_use]
    pub fn is_too_long(&self, loop_m: f32, frontier_m: f32) -> bool {
        loop_m > self.most_m + self.most_per_frontier * frontier_m
    }

    /// Whether it is worth beginning.
    #[must_use]
    pub fn is_worth(&self, loop_m: f32, frontier_m: f32) -> bool {
        loop_m >= self.least_m && !self.is_too_long(loop_m, frontier_m)
    }
}

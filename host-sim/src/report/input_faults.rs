//! The report's part on observations that were not as they should be.
//!
//! The device counts from the start of its session, and each reply has the counts so far. A reply
//! without a step has none. Invariant: the counts of a run are the greatest of its replies.

use core::ops::Add;

use fieldline_protocol::message::{Command, InputFaults as Counts};
use serde::{Deserialize, Serialize};

/// Observations that the device found wrong.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct InputFaults {
    /// Observations with a number that no robot reports: the device made no step.
    pub refused: u32,
    /// Poses that no robot reaches in the time: the odometry was taken to have begun anew.
    pub jumps: u32,
    /// Times that were no later than the one before, or later by more than a minute.
    pub clock: u32,
}

impl InputFaults {
    /// Returns the counts of a run with these replies.
    #[must_use]
    pub fn of<'a>(replies: impl IntoIterator<Item = &'a Command>) -> Self {
        let counts = replies.into_iter().map(|reply| reply.input_faults);
        counts.fold(Self::default(), Self::after)
    }

    /// Returns these counts after another reply.
    #[must_use]
    pub fn after(self, counts: Counts) -> Self {
        Self {
            refused: self.refused.max(counts.refused),
            jumps: self.jumps.max(counts.jumps),
            clock: self.clock.max(counts.clock),
        }
    }

    /// Returns a line of a summary; `None` if nothing was wrong.
    #[must_use]
    pub fn line(&self) -> Option<String> {
        let Self {
            refused,
            jumps,
            clock,
        } = self;
        (*self != Self::default()).then(|| {
            format!(
                "  input     {refused} observations refused, {jumps} jumps of odometry, \
                 {clock} times out of order"
            )
        })
    }
}

impl Add for InputFaults {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            refused: self.refused + other.refused,
            jumps: self.jumps + other.jumps,
            clock: self.clock + other.clock,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Counts, InputFaults};

    #[test]
    fn a_reply_without_counts_forgets_none() {
        let counts = |refused, jumps, clock| Counts {
            refused,
            jumps,
            clock,
        };
        let replies = [counts(0, 1, 2), counts(0, 1, 3), counts(0, 0, 0)];
        let faults = replies
            .into_iter()
            .fold(InputFaults::default(), InputFaults::after);
        let expected = "  input     0 observations refused, 1 jumps of odometry, \
                        3 times out of order";
        assert_eq!(faults.line().as_deref(), Some(expected));
        assert_eq!(InputFaults::default().line(), None);
    }
}

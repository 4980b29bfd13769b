//! What the robot does in a step, and what happened in it: together the log of a run.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// What the robot does in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Doing {
    /// It stands: the session does not drive, no scan tells anything, the robot is lost, or the map
    /// is being corrected.
    #[default]
    Stands,
    /// It stands because there is no path yet, or another robot must pass.
    Waits,
    /// It follows the window's field to a frontier, or round a loop.
    Explores,
    /// It follows the forces of a space-based field.
    FollowsForces,
    /// It follows a path to a place from which it sees through a gap.
    GoesToLook,
    /// It drives to a place by order.
    GoesByOrder,
    /// It searches for motions out of a narrow place, and stands meanwhile.
    Searches,
    /// It drives the motions that the search found.
    Recovers,
    /// It goes back along its own track.
    GoesBack,
    /// It searches the map for gaps to look through.
    LooksForGaps,
    /// It turns on the spot to see more.
    LooksAbout,
    /// It leaves the road of another robot.
    MakesWay,
}

/// Something that happened in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// The goal was reached and stays unexplored: it is given up.
    GoalSaysNothing,
    /// The robot came no nearer to the goal: it is given up.
    GoalNoNearer,
    /// The way along the path is closed near the robot: the passage is blocked.
    PathClosed,
    /// The robot stood too long: the passage ahead is blocked.
    Stalled,
    /// No motion leads on: the passage ahead is blocked.
    Wedged,
    /// No path leads to the place from which it wanted to look.
    NoPathToLook,
    /// No other path is left: it goes back through a passage that was blocked.
    BackThroughBlocked,
    /// Nothing else is left: all that failed is tried again.
    TriesAgain,
    /// It got stuck at every try: from here on it only looks.
    OnlyLooks,
    /// A place was found from which it sees through a gap.
    FoundGap,
    /// What came in the way meanwhile counts as gone: a second look.
    SecondLook,
    /// Something holds the robot that no laser sees.
    Touched,
}

impl Event {
    /// All events, in the order of their bits.
    pub const ALL: [Self; 12] = [
        Self::GoalSaysNothing,
        Self::GoalNoNearer,
        Self::PathClosed,
        Self::Stalled,
        Self::Wedged,
        Self::NoPathToLook,
        Self::BackThroughBlocked,
        Self::TriesAgain,
        Self::OnlyLooks,
        Self::FoundGap,
        Self::SecondLook,
        Self::Touched,
    ];
}

/// The events of a step, one bit each, the first of [`Event::ALL`] the lowest. Other bits mean
/// nothing.
///
/// ```
/// use fieldline_protocol::message::{Event, Events};
///
/// assert!(Events(0b1000).iter().eq([Event::Stalled]));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Events(pub u16);

impl Events {
    /// Returns the events, in the order of [`Event::ALL`].
    pub fn iter(self) -> impl Iterator<Item = Event> {
        let all = Event::ALL.into_iter();
        all.filter(move |&event| self.0 >> event as u16 & 1 == 1)
    }
}

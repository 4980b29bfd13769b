//! What the robot does in a step, and what happened in it: together the log of a run.
//!
//! | what it does | begins when | ends when |
//! | --- | --- | --- |
//! | [`Doing::Explores`] | a path leads to a frontier, or a loop is closed | the path ends |
//! | [`Doing::FollowsForces`] | the forces of `sbpf` lead somewhere | they do not |
//! | [`Doing::GoesToLook`] | only a look through a gap is left | the robot has looked |
//! | [`Doing::GoesByOrder`] | the host orders it | it arrives, or cannot |
//! | [`Doing::Searches`] | no motion along the field is admissible | a way out is found, or none |
//! | [`Doing::Recovers`] | a search found motions | they are driven, or not admissible |
//! | [`Doing::GoesBack`] | a passage was blocked where it cannot turn | it can turn |
//! | [`Doing::LooksForGaps`] | no frontier is left | the whole map was searched |
//! | [`Doing::LooksAbout`] | it has no path, or stands for long | there is a path |
//! | [`Doing::MakesWay`] | another robot comes and goes first | its road is free |
//! | [`Doing::Waits`] | it has no path yet, or another robot must pass | there is a path |
//! | [`Doing::Stands`] | the status does not drive, or nothing is seen or located | it drives |
//!
//! The [`Events`] of a step say why it changed: the robot goes back because it
//! [stalled](Event::Stalled).

/// What the robot does in a step.
///
/// ```
/// use fieldline_planner::{Doing, Output};
///
/// let output = Output::default();
/// assert_eq!(output.doing, Doing::Stands, "no step was made yet");
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
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

/// The events of a step.
///
/// ```
/// use fieldline_planner::{Event, Events};
///
/// let mut events = Events::default();
/// events.add(Event::TriesAgain);
/// events.add(Event::Stalled);
/// assert!(events.iter().eq([Event::Stalled, Event::TriesAgain]));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Events(u16);

impl Events {
    /// No event.
    pub(crate) const NONE: Self = Self(0);

    /// Adds an event.
    pub const fn add(&mut self, event: Event) {
        self.0 |= 1 << event as u16;
    }

    /// Takes all events, and leaves none.
    pub(crate) const fn take(&mut self) -> Self {
        core::mem::replace(self, Self::NONE)
    }

    /// Returns these events and others.
    pub(crate) const fn and(self, others: Self) -> Self {
        Self(self.0 | others.0)
    }

    /// Returns the events, one bit each, the first of [`Event::ALL`] the lowest.
    #[must_use]
    pub const fn bits(self) -> u16 {
        self.0
    }

    /// Returns the events, in the order of [`Event::ALL`].
    pub fn iter(self) -> impl Iterator<Item = Event> {
        let all = Event::ALL.into_iter();
        all.filter(move |&event| self.0 >> event as u16 & 1 == 1)
    }
}

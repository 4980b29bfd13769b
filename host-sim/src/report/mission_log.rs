//! `mission.log`: what the robot did, and what made it change; a line for each change and event.
//!
//! ```text
//!     0.0 s  (12.00, 7.00)  looks about
//!     0.8 s  (12.00, 7.00)  explores
//!   120.4 s  (3.10, 4.25)   goes back: it stood too long, so the passage ahead is blocked
//! ```
//!
//! A change that lasts for one step only is left out, unless something happened in it.
//!
//! Units: seconds, metres.

use core::fmt::Write as _;

use fieldline_protocol::message::{Command, Doing, Event, Status};
use serde::{Deserialize, Serialize};

use super::tum::Stamped;
use crate::trial::wording;

/// Entries that `report.json` holds: the last ones.
const LAST: usize = 20;

/// A change of what the robot does, or something that happened.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// Simulated time, seconds.
    pub time_s: f64,
    /// Where the robot takes itself to be, odometry frame or map.
    pub at_m: [f64; 2],
    /// What it does: `explores`, `goes back` ..., or its status if that does not drive.
    pub doing: String,
    /// What happened in the step.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub events: Vec<String>,
}

impl core::fmt::Display for Entry {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let [x_m, y_m] = self.at_m;
        let place = format!("({x_m:.2}, {y_m:.2})");
        write!(f, "{:8.1} s  {place:<18}  {}", self.time_s, self.doing)?;
        if !self.events.is_empty() {
            write!(f, ": {}", self.events.join("; "))?;
        }
        Ok(())
    }
}

/// What a step says of the robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct State {
    status: Status,
    doing: Doing,
}

impl State {
    fn of(command: &Command) -> Self {
        Self {
            status: command.status,
            doing: command.doing,
        }
    }

    fn text(self) -> String {
        match (self.status, self.doing) {
            (status, doing) if status.drives() => wording::doing(doing).into(),
            (status, _) => wording::status(status),
        }
    }
}

/// Makes the entries of a run, step by step.
#[derive(Clone, Debug, Default)]
pub struct MissionLog {
    /// What the last entry says.
    said: Option<State>,
    /// A new state, with the time and place of its first step.
    next: Option<(State, f64, [f64; 2])>,
}

impl MissionLog {
    /// Makes an empty log.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes a step, and returns the entry that it completes: at once if something happened or the
    /// run ended, else in the second step of a change.
    pub fn note(&mut self, pose: &Stamped, command: &Command) -> Option<Entry> {
        let state = State::of(command);
        let here = (f64::from(pose.time_ms) / 1000.0, [pose.x_m, pose.y_m]);
        let events: Vec<String> = command.events.iter().map(|it| event(it).into()).collect();
        if events.is_empty() && self.said == Some(state) {
            self.next = None;
            return None;
        }
        let lasts = self.next.filter(|(next, ..)| *next == state);
        let is_due = !events.is_empty() || !state.status.goes_on() || lasts.is_some();
        if !is_due {
            self.next = Some((state, here.0, here.1));
            return None;
        }
        let (_, time_s, at_m) = lasts.unwrap_or((state, here.0, here.1));
        (self.said, self.next) = (Some(state), None);
        Some(Entry {
            time_s,
            at_m,
            doing: state.text(),
            events,
        })
    }
}

/// Returns the entries of a run.
pub fn entries<'a>(steps: impl Iterator<Item = (&'a Stamped, &'a Command)>) -> Vec<Entry> {
    let mut log = MissionLog::new();
    steps
        .filter_map(|(pose, command)| log.note(pose, command))
        .collect()
}

/// Returns the last entries, for `report.json`.
#[must_use]
pub fn last(mut entries: Vec<Entry>) -> Vec<Entry> {
    entries.split_off(entries.len().saturating_sub(LAST))
}

/// Returns the text of the file.
#[must_use]
pub fn text(entries: &[Entry]) -> String {
    let mut out = String::new();
    for entry in entries {
        // Writing into a string does not fail.
        let _ = writeln!(out, "{entry}");
    }
    out
}

/// Returns what happened, in words.
const fn event(event: Event) -> &'static str {
    match event {
        Event::GoalSaysNothing => "the goal was reached and stays unexplored, so it is given up",
        Event::GoalNoNearer => "it came no nearer to the goal, which is given up",
        Event::PathClosed => "the path is closed near the robot, so the passage is blocked",
        Event::Stalled => "it stood too long, so the passage ahead is blocked",
        Event::Wedged => "no motion leads on, so the passage ahead is blocked",
        Event::NoPathToLook => "no path leads to the place from which it wanted to look",
        Event::BackThroughBlocked => "no other path is left, so it goes through a blocked passage",
        Event::TriesAgain => "nothing else is left, so all that failed is tried again",
        Event::OnlyLooks => "it got stuck at every try, so it only looks from here on",
        Event::FoundGap => "nothing is left to drive to, so it goes to look through a gap",
        Event::SecondLook => "what came in the way counts as gone, for a second look",
        Event::Touched => "something holds it that no laser sees",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fieldline_protocol::message::{Events, Finish};

    fn step(number: u32, status: Status, doing: Doing, events: u16) -> (Stamped, Command) {
        let pose = Stamped {
            time_ms: 200 * number,
            x_m: f64::from(number),
            ..Stamped::default()
        };
        let command = Command {
            status,
            doing,
            events: Events(events),
            ..Command::default()
        };
        (pose, command)
    }

    /// Runs a log over steps while exploring, each with what is done and the events' bits.
    fn log(steps: &[(Doing, u16)]) -> String {
        let steps: Vec<_> = (0..)
            .zip(steps)
            .map(|(number, &(doing, events))| step(number, Status::Exploring, doing, events))
            .collect();
        text(&entries(
            steps.iter().map(|(pose, command)| (pose, command)),
        ))
    }

    #[test]
    fn a_change_that_lasts_is_told_with_its_first_step() {
        let told = log(&[
            (Doing::Waits, 0),
            (Doing::Waits, 0),
            (Doing::Explores, 0),
            (Doing::Searches, 0),
            (Doing::Explores, 0),
            (Doing::Explores, 0),
            (Doing::Explores, 0),
        ]);
        assert_eq!(
            told,
            "     0.0 s  (0.00, 0.00)        waits\n\
             \x20    0.8 s  (4.00, 0.00)        explores\n"
        );
    }

    #[test]
    fn an_event_is_told_at_once_with_its_reason() {
        let told = log(&[(Doing::Explores, 0), (Doing::GoesBack, 1 << 3 | 1 << 7)]);
        assert_eq!(
            told,
            "     0.2 s  (1.00, 0.00)        goes back: it stood too long, so the passage ahead \
             is blocked; nothing else is left, so all that failed is tried again\n"
        );
    }

    #[test]
    fn the_end_of_a_run_is_told_in_its_last_step() {
        let mut log = MissionLog::new();
        let (pose, command) = step(7, Status::Finished(Finish::Explored), Doing::Stands, 0);
        let entry = log.note(&pose, &command).expect("the end");
        assert_eq!(entry.doing, "finished(explored)");
    }

    #[test]
    fn the_report_holds_the_last_twenty() {
        let steps: Vec<_> = (0..30)
            .map(|number| step(number, Status::Exploring, Doing::Explores, 1))
            .collect();
        let all = entries(steps.iter().map(|(pose, command)| (pose, command)));
        assert_eq!(all.len(), 30);
        let last = last(all);
        assert_eq!((last.len(), last[0].at_m), (20, [10.0, 0.0]));
    }
}

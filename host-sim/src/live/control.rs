//! What viewers ask for: the pace of the simulation, and requests to the device.
//!
//! | message of the page | what it does | changes the run |
//! | --- | --- | --- |
//! | `speed` with `factor` | simulated seconds a second at most; 0 as fast as it goes | no |
//! | `hold` with `on`, `step` | the simulated clock stands; goes on for one step | no |
//! | `pause`, `resume`, `stop`, `home`, `explore`, `go-to` | a request on the wire | yes |
//!
//! The clock is held only while someone is connected. The queue of requests is bounded.

use core::time::Duration;
use std::collections::VecDeque;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use fieldline_protocol::message::Control;
use fixed::types::I16F16;
use serde::{Deserialize, Serialize};

/// Most requests that wait for the next step.
const MOST_WAITING: usize = 32;
/// Greatest factor of the pace.
const MOST_FACTOR: f64 = 1_000.0;
/// Greatest coordinate of a goal, metres: as of a fence's corner.
const MOST_M: f64 = 3_200.0;

/// A message of a page.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(try_from = "Fields")]
pub enum Ask {
    /// Run at most this many simulated seconds a second; 0 as fast as it goes.
    Speed {
        /// Simulated seconds a second.
        factor: f64,
    },
    /// Hold or release the simulated clock.
    Hold {
        /// True to hold it.
        on: bool,
    },
    /// Hold the clock after the next step.
    Step,
    /// The device's *pause*.
    Pause,
    /// The device's *resume*, or go on with what a request cut short.
    Resume,
    /// The device's *stop*: the run ends.
    Stop,
    /// The device's *home*.
    Home,
    /// The device's *explore*, as *resume*.
    Explore,
    /// The device's *go to*.
    GoTo {
        /// Metres, map.
        x: f64,
        /// Metres, map.
        y: f64,
    },
}

/// The fields of a message, of which each kind has its own. An enum with a tag would read them
/// through a buffer, which numbers do not pass where `serde_json` keeps all of their digits.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Fields {
    r#do: String,
    factor: Option<f64>,
    on: Option<bool>,
    x: Option<f64>,
    y: Option<f64>,
}

impl TryFrom<Fields> for Ask {
    type Error = String;

    fn try_from(fields: Fields) -> Result<Self, Self::Error> {
        let Fields {
            r#do,
            factor,
            on,
            x,
            y,
        } = fields;
        Ok(match (r#do.as_str(), factor, on, x, y) {
            ("speed", Some(factor), None, None, None) => Self::Speed { factor },
            ("hold", None, Some(on), None, None) => Self::Hold { on },
            ("go-to", None, None, Some(x), Some(y)) => Self::GoTo { x, y },
            ("step", None, None, None, None) => Self::Step,
            ("pause", None, None, None, None) => Self::Pause,
            ("resume", None, None, None, None) => Self::Resume,
            ("stop", None, None, None, None) => Self::Stop,
            ("home", None, None, None, None) => Self::Home,
            ("explore", None, None, None, None) => Self::Explore,
            (name, ..) => return Err(format!("no request is `{name}` with these fields")),
        })
    }
}

impl Ask {
    /// Returns the request on the wire; `None` for what is the simulator's own.
    fn control(self) -> Option<Control> {
        Some(match self {
            Self::Speed { .. } | Self::Hold { .. } | Self::Step => return None,
            Self::Pause => Control::Pause,
            Self::Resume => Control::Resume,
            Self::Stop => Control::Stop,
            Self::Home => Control::Home,
            Self::Explore => Control::Explore,
            Self::GoTo { x, y } => {
                let [x, y] = [x, y].map(I16F16::saturating_from_num);
                Control::GoTo { x, y }
            }
        })
    }
}

/// A request of a viewer.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Request {
    /// Number of the viewer, from 1.
    pub(super) viewer: u64,
    pub(super) control: Control,
}

/// The pace, as every page shows it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Pace {
    /// Simulated seconds a second; 0 as fast as it goes.
    pub(super) factor: f64,
    /// The simulated clock stands.
    pub(super) held: bool,
}

#[derive(Debug)]
struct State {
    pace: Pace,
    /// Steps to make while the clock is held.
    steps: u32,
    waiting: VecDeque<Request>,
    /// A run takes requests.
    runs: bool,
}

/// Where requests wait for the run.
#[derive(Debug)]
pub(super) struct Desk {
    state: Mutex<State>,
    changed: Condvar,
}

impl Desk {
    pub(super) fn new(factor: f64) -> Self {
        let pace = Pace {
            factor,
            held: false,
        };
        Self {
            state: Mutex::new(State {
                pace,
                steps: 0,
                waiting: VecDeque::new(),
                runs: false,
            }),
            changed: Condvar::new(),
        }
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        // A thread that panicked left whole values behind.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Begins or ends the time in which requests are taken.
    pub(super) fn set_runs(&self, runs: bool) {
        let mut state = self.lock();
        state.runs = runs;
        state.waiting.clear();
    }

    /// Takes what a viewer asks for.
    ///
    /// # Errors
    /// Why it is refused, for the viewer.
    pub(super) fn take(&self, viewer: u64, ask: Ask) -> Result<(), String> {
        let mut state = self.lock();
        match ask {
            Ask::Speed { factor } if (0.0..=MOST_FACTOR).contains(&factor) => {
                state.pace.factor = factor;
            }
            Ask::Speed { .. } => {
                return Err(format!("a speed is 0 to {MOST_FACTOR}"));
            }
            Ask::Hold { on } => (state.pace.held, state.steps) = (on, 0),
            Ask::Step => (state.pace.held, state.steps) = (true, state.steps.min(100) + 1),
            Ask::GoTo { x, y } if !(x.abs() <= MOST_M && y.abs() <= MOST_M) => {
                return Err(format!("a goal lies within {MOST_M} m"));
            }
            _ if !state.runs => return Err("no run takes requests now".into()),
            _ if state.waiting.len() >= MOST_WAITING => {
                return Err("too many requests wait; try again".into());
            }
            other => state
                .waiting
                .extend(other.control().map(|control| Request { viewer, control })),
        }
        self.changed.notify_all();
        Ok(())
    }

    /// Returns the next request.
    pub(super) fn next(&self) -> Option<Request> {
        self.lock().waiting.pop_front()
    }

    /// Returns the pace.
    pub(super) fn pace(&self) -> Pace {
        self.lock().pace
    }

    /// Returns true if the clock is held, and takes one of the single steps if there are any.
    pub(super) fn holds(&self) -> bool {
        let mut state = self.lock();
        if !state.pace.held {
            return false;
        }
        let steps = state.steps.checked_sub(1);
        state.steps = steps.unwrap_or(0);
        steps.is_none()
    }

    /// Waits until someone asks for something, at most this long.
    pub(super) fn wait(&self, most: Duration) {
        let state = self.lock();
        if state.waiting.is_empty() {
            drop(self.changed.wait_timeout(state, most));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Option<Ask> {
        serde_json::from_str(text).ok()
    }

    #[test]
    fn messages_are_read_strictly() {
        assert_eq!(read(r#"{"do":"pause"}"#), Some(Ask::Pause));
        assert_eq!(
            read(r#"{"do":"go-to","x":1.5,"y":-2}"#),
            Some(Ask::GoTo { x: 1.5, y: -2.0 })
        );
        for bad in [
            "",
            "pause",
            r#"{"do":"reset"}"#,
            r#"{"do":"go-to","x":1}"#,
            r#"{"do":"speed","factor":"fast"}"#,
            r#"{"do":"go-to","x":1,"y":2,"z":3}"#,
        ] {
            assert_eq!(read(bad), None, "{bad}");
        }
    }

    #[test]
    fn only_a_run_takes_requests_and_only_so_many() {
        let desk = Desk::new(0.0);
        assert!(desk.take(1, Ask::Pause).is_err());
        desk.set_runs(true);
        for _ in 0..MOST_WAITING {
            assert_eq!(desk.take(1, Ask::Pause), Ok(()));
        }
        assert!(desk.take(1, Ask::Pause).is_err());
        assert_eq!(desk.next().map(|it| it.control), Some(Control::Pause));
        assert_eq!(desk.take(2, Ask::Home), Ok(()));
        for x in [f64::NAN, f64::INFINITY, 1e9] {
            assert!(desk.take(2, Ask::GoTo { x, y: 0.0 }).is_err());
        }
    }

    #[test]
    fn a_held_clock_makes_single_steps() {
        let desk = Desk::new(0.0);
        assert!(!desk.holds());
        assert_eq!(desk.take(1, Ask::Hold { on: true }), Ok(()));
        assert!(desk.holds());
        assert_eq!(desk.take(1, Ask::Step), Ok(()));
        assert!(!desk.holds() && desk.holds());
        assert_eq!(desk.take(1, Ask::Hold { on: false }), Ok(()));
        assert!(!desk.holds());
        assert!(desk.take(1, Ask::Speed { factor: -1.0 }).is_err());
        assert!(desk.take(1, Ask::Speed { factor: f64::NAN }).is_err());
        assert_eq!(desk.take(1, Ask::Speed { factor: 4.0 }), Ok(()));
        assert_eq!(desk.pace().factor, 4.0);
    }
}

//! The direct link: a function call of the pilot, without bytes.

use fieldline_device::session::{self, Boot};
use fieldline_device::{Memory, Pilot, SLOTS, State, TILES};
use fieldline_planner::{Tuning, Workspace};
use fieldline_protocol::message::{Reply, Request};

use super::inside::{Inside, Look};
use super::{End, Link, LinkError, LinkStats};

/// A pilot and its memory.
#[derive(Debug)]
pub struct Direct {
    pilot: Pilot,
    state: Box<State>,
    workspace: Box<Workspace>,
    tuning: &'static Tuning,
    calls: u64,
}

impl Default for Direct {
    fn default() -> Self {
        Self::new()
    }
}

impl Direct {
    /// A pilot that has just booted.
    #[must_use]
    pub fn new() -> Self {
        Self::tuned(&Tuning::DEFAULT)
    }

    /// A pilot that has just booted, with these tuned constants.
    #[must_use]
    pub fn tuned(tuning: &'static Tuning) -> Self {
        Self {
            pilot: Pilot::new(),
            state: Box::new(State::new()),
            workspace: Box::new(Workspace::new()),
            tuning,
            calls: 0,
        }
    }

    /// Returns the planner's memory.
    #[must_use]
    pub const fn state(&self) -> &State {
        &self.state
    }

    /// Returns the planner's memory.
    pub(crate) const fn state_mut(&mut self) -> &mut State {
        &mut self.state
    }

    /// Runs `act` on the pilot and its memory.
    fn with<T>(&mut self, act: impl FnOnce(&mut Pilot, &mut Memory<'_, TILES, SLOTS>) -> T) -> T {
        self.calls += 1;
        let mut memory = Memory {
            state: &mut self.state,
            workspace: &mut self.workspace,
            tuning: self.tuning,
        };
        act(&mut self.pilot, &mut memory)
    }
}

impl Link for Direct {
    fn ask(&mut self, request: &Request) -> Result<Reply, LinkError> {
        if matches!(request, Request::Hello { .. }) {
            let identity = session::identity(Boot::default(), TILES, SLOTS);
            return Ok(Reply::Hello(identity));
        }
        let reply = self.with(|pilot, memory| match request {
            Request::Observation(observation) => {
                let command = pilot.observe(memory, observation, &mut ());
                command.map(Reply::Command)
            }
            _ => pilot.answer(memory, request),
        });
        reply.map_err(|refusal| LinkError::Refused(refusal.to_string()))
    }

    fn end(&self) -> &dyn End {
        self
    }
}

impl End for Direct {
    /// Every call counts as one frame sent and one received.
    fn stats(&self) -> LinkStats {
        LinkStats {
            sent: self.calls,
            received: self.calls,
            ..LinkStats::default()
        }
    }

    fn inside(&self) -> Option<Box<dyn Inside + '_>> {
        Some(Box::new(Look {
            state: &*self.state,
            workspace: &self.workspace,
        }))
    }
}

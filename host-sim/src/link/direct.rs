//! The direct link: a function call of the pilot, without bytes.

use fieldline_device::session::{self, Boot};
use fieldline_device::{Memory, Pilot, SLOTS, State, TILES};
use fieldline_planner::{Tuning, Workspace};
use fieldline_protocol::message::{
    Command, Control, Correct, CorrectedTiles, CorrectionProgress, FieldRow, Identity, Observation,
    Packet, Path, Recall, Refusal, ResidualFrontier, Status, Tile,
};

use super::inside::{Inside, Look};
use super::{Link, LinkError, LinkStats};

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

fn refused(refusal: Refusal) -> LinkError {
    LinkError::Refused(refusal.to_string())
}

impl Link for Direct {
    fn hello(&mut self) -> Result<Identity, LinkError> {
        Ok(session::identity(Boot::default(), TILES, SLOTS))
    }

    fn control(&mut self, control: &Control) -> Result<Status, LinkError> {
        self.with(|pilot, memory| pilot.control(memory, control))
            .map_err(refused)
    }

    fn observe(&mut self, observation: &Observation) -> Result<Command, LinkError> {
        self.with(|pilot, memory| pilot.observe(memory, observation, &mut ()))
            .map_err(refused)
    }

    fn tile(&mut self, x: i16, y: i16) -> Result<Option<Tile>, LinkError> {
        Ok(self.with(|_, memory| Pilot::tile(memory, x, y)))
    }

    fn field_row(&mut self, row: u8) -> Result<Option<FieldRow>, LinkError> {
        Ok(self.with(|_, memory| Pilot::field_row(memory, row)))
    }

    fn frontiers(&mut self) -> Result<Vec<ResidualFrontier>, LinkError> {
        Ok(self.with(|_, memory| Pilot::frontiers(memory).iter().copied().collect()))
    }

    fn path(&mut self, from: u8) -> Result<Path, LinkError> {
        Ok(self.with(|_, memory| Pilot::path(memory, from)))
    }

    fn hear(&mut self, packet: &Packet) -> Result<(), LinkError> {
        self.with(|pilot, memory| pilot.hear(memory, packet))
            .map_err(refused)
    }

    fn say(&mut self) -> Result<Option<Packet>, LinkError> {
        self.with(Pilot::say).map_err(refused)
    }

    fn open_correction(&mut self, correct: &Correct) -> Result<CorrectionProgress, LinkError> {
        self.with(|pilot, memory| pilot.correct(memory, correct))
            .map_err(refused)
    }

    fn send_tiles(&mut self, part: &CorrectedTiles) -> Result<CorrectionProgress, LinkError> {
        self.with(|pilot, memory| pilot.tiles(memory, part))
            .map_err(refused)
    }

    fn recall(&mut self, recall: &Recall) -> Result<(), LinkError> {
        self.with(|pilot, memory| pilot.recall(memory, recall))
            .map(drop)
            .map_err(refused)
    }

    fn inside(&self) -> Option<Box<dyn Inside + '_>> {
        Some(Box::new(Look {
            state: &*self.state,
            workspace: &self.workspace,
        }))
    }

    /// Every call counts as one frame sent and one received.
    fn stats(&self) -> LinkStats {
        LinkStats {
            sent: self.calls,
            received: self.calls,
            ..LinkStats::default()
        }
    }

    /// The pilot keeps no log.
    fn take_log(&mut self) -> Vec<u8> {
        Vec::new()
    }
}

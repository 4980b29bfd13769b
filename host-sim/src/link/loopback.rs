//! The loopback link: frames to a device in this process, in virtual time.
//!
//! Time passes only while the host waits without an answer, so a lost frame costs a retry and no
//! wall-clock time.

use core::time::Duration;

use fieldline_device::meter::NoMeter;
use fieldline_device::session::Boot;
use fieldline_device::{Memory, SLOTS, Session, TILES};
use fieldline_planner::{State, Tuning, Workspace};

use super::LinkError;
use super::endpoint::{Endpoint, RetryPolicy};
use super::inside::{Inside, Look};
use super::line::Line;

/// A whole device at the far end of a line. Its map has the default image's size if nothing else is
/// said.
#[derive(Debug)]
pub struct LocalDevice<const POOL: usize = TILES, const MOST: usize = SLOTS> {
    session: Session,
    state: Box<State<POOL, MOST>>,
    workspace: Box<Workspace>,
    boots: u32,
    now: Duration,
    outgoing: Vec<u8>,
}

impl Default for LocalDevice {
    fn default() -> Self {
        Self::new()
    }
}

impl LocalDevice {
    /// A device that has just booted for the first time.
    #[must_use]
    pub fn new() -> Self {
        Self::sized()
    }
}

impl<const POOL: usize, const MOST: usize> LocalDevice<POOL, MOST> {
    /// A device that has just booted for the first time, whose map has `POOL` tiles in its pool
    /// and at most `MOST` tiles.
    #[must_use]
    pub fn sized() -> Self {
        Self {
            session: boot::<POOL, MOST>(1),
            state: Box::new(State::new()),
            workspace: Box::new(Workspace::new()),
            boots: 1,
            now: Duration::ZERO,
            outgoing: Vec::new(),
        }
    }

    /// The device's session.
    #[must_use]
    pub const fn session(&self) -> &Session {
        &self.session
    }

    /// The planner's memory.
    #[must_use]
    pub const fn state(&self) -> &State<POOL, MOST> {
        &self.state
    }

    /// Presses or releases the emergency stop.
    pub fn set_emergency_stop(&mut self, pressed: bool) {
        self.session.set_emergency_stop(pressed);
    }

    /// Appends log bytes, as a board's logger does.
    pub fn log(&mut self, bytes: &[u8]) -> usize {
        self.session.log(bytes)
    }

    /// Boots anew, as after a loss of power: the session is lost.
    pub fn reboot(&mut self) {
        self.outgoing.clear();
        self.boots += 1;
        self.session = boot::<POOL, MOST>(self.boots);
    }

    fn collect(&mut self) {
        while !self.session.pending().is_empty() {
            let count = self.session.pending().len();
            self.outgoing.extend_from_slice(self.session.pending());
            self.session.sent(count);
        }
    }
}

fn boot<const POOL: usize, const MOST: usize>(boots: u32) -> Session {
    let boot = Boot { boots, crash: None };
    let mut session = Session::new();
    session.boot(boot, POOL, MOST);
    session
}

impl<const POOL: usize, const MOST: usize> Line for LocalDevice<POOL, MOST> {
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        let mut memory = Memory {
            state: &mut self.state,
            workspace: &mut self.workspace,
            tuning: &Tuning::DEFAULT,
        };
        for byte in bytes {
            self.session.receive(*byte, &mut memory, &mut NoMeter);
        }
        if self.session.wants_reset() {
            self.collect();
            self.boots += 1;
            self.session = boot::<POOL, MOST>(self.boots);
        }
        Ok(())
    }

    fn receive(&mut self, into: &mut Vec<u8>, wait: Duration) -> Result<(), LinkError> {
        self.collect();
        if self.outgoing.is_empty() {
            self.now += wait;
            self.session.tick(self.now.as_millis() as u32);
        }
        into.append(&mut self.outgoing);
        Ok(())
    }

    fn now(&self) -> Duration {
        self.now
    }

    fn inside(&self) -> Option<Box<dyn Inside + '_>> {
        Some(Box::new(Look {
            state: &*self.state,
            workspace: &self.workspace,
        }))
    }
}

/// The loopback link.
pub type Loopback = Endpoint<LocalDevice>;

/// Opens the host's end on a new device in this process.
#[must_use]
pub fn loopback() -> Loopback {
    Endpoint::new(LocalDevice::new(), RetryPolicy::VIRTUAL, 1)
}

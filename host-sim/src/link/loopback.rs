//! The loopback link: frames to a device in this process, in virtual time.
//!
//! Time passes only while the host waits without an answer, so a lost frame costs a retry and no
//! wall-clock time.

use core::time::Duration;

use fieldline_device::meter::NoMeter;
use fieldline_device::session::Boot;
use fieldline_device::{Memory, SLOTS, Session, State, TILES};
use fieldline_planner::{Tuning, Workspace};

use super::LinkError;
use super::endpoint::{Endpoint, RetryPolicy};
use super::line::Line;

/// A whole device at the far end of a line.
#[derive(Debug)]
pub struct LocalDevice {
    session: Session,
    state: Box<State>,
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
        Self {
            session: boot(1),
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

    /// Presses or releases the emergency stop.
    pub fn set_emergency_stop(&mut self, pressed: bool) {
        self.session.set_emergency_stop(pressed);
    }

    /// Appends log bytes, as a board's logger does.
    pub fn log(&mut self, bytes: &[u8]) -> usize {
        self.session.log(bytes)
    }

    fn collect(&mut self) {
        while !self.session.pending().is_empty() {
            let count = self.session.pending().len();
            self.outgoing.extend_from_slice(self.session.pending());
            self.session.sent(count);
        }
    }
}

fn boot(boots: u32) -> Session {
    let boot = Boot { boots, crash: None };
    let mut session = Session::new();
    session.boot(boot, TILES, SLOTS);
    session
}

impl Line for LocalDevice {
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
            self.session = boot(self.boots);
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
}

/// The loopback link.
pub type Loopback = Endpoint<LocalDevice>;

/// Opens the host's end on a new device in this process.
#[must_use]
pub fn loopback() -> Loopback {
    Endpoint::new(LocalDevice::new(), RetryPolicy::VIRTUAL, 1)
}

//! The session on a board: serial line, emergency stop and LED through the embedded traits.
//!
//! The emergency stop is a normally closed contact to ground with a pull-up. A high level means
//! that it is pressed or that the wire is broken. A pin that cannot be read counts as pressed.

use embedded_hal::digital::{InputPin, OutputPin};
use embedded_io::{Error, ErrorKind, Read, ReadReady, Write};
use fieldline_protocol::frame::MAX_LOG_BYTES;

use crate::memory::Memory;
use crate::meter::Meter;
use crate::session::Session;

/// The functions that the port needs from a board, beside its pins and its serial line.
pub trait Board: Meter {
    /// Returns the time from any origin, milliseconds, wrapping.
    fn now_ms(&mut self) -> u32;
    /// Moves waiting log bytes to `out` and returns how many.
    fn take_log(&mut self, out: &mut [u8]) -> usize;
}

/// The serial line failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PortError {
    /// Reading from it failed.
    Read(ErrorKind),
    /// Writing to it failed.
    Write(ErrorKind),
}

impl core::fmt::Display for PortError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let (action, kind) = match self {
            Self::Read(kind) => ("reading from", kind),
            Self::Write(kind) => ("writing to", kind),
        };
        write!(
            f,
            "{action} the serial line failed ({kind:?}); check the wiring"
        )
    }
}

impl core::error::Error for PortError {}

/// Result of a turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    /// Nothing moved. The board may sleep until a byte arrives.
    Idle,
    /// Bytes moved.
    Busy,
    /// Everything is sent, and the host asked for a reboot.
    Reset,
}

/// The pins and the serial line of a board.
#[derive(Debug)]
pub struct Port<S, P, L> {
    /// The serial line. Reading must not block while [`ReadReady`] reports bytes.
    pub serial: S,
    /// The emergency stop; high is pressed.
    pub emergency_stop: P,
    /// The status LED; high is lit.
    pub led: L,
}

impl<S: Read + ReadReady + Write, P: InputPin, L: OutputPin> Port<S, P, L> {
    /// Reads the emergency stop, sets the LED, reads bytes and answers requests, then writes
    /// replies and log.
    ///
    /// # Errors
    /// [`PortError`]. The session is intact, and the caller may try the next turn.
    pub fn turn<B: Board, const TILES: usize, const SLOTS: usize>(
        &mut self,
        session: &mut Session,
        memory: &mut Memory<'_, TILES, SLOTS>,
        board: &mut B,
    ) -> Result<Turn, PortError> {
        let now_ms = board.now_ms();
        session.set_emergency_stop(self.emergency_stop.is_high().unwrap_or(true));
        session.tick(now_ms);
        // A failed LED must not stop the planner.
        let _ = self.led.set_state(session.signal().lit(now_ms).into());

        let read = self.read(session, memory, board)?;
        take_log(session, board);
        let wrote = self.write(session)?;
        Ok(match (read || wrote, session.wants_reset()) {
            (_, true) => Turn::Reset,
            (true, false) => Turn::Busy,
            (false, false) => Turn::Idle,
        })
    }

    fn read<B: Board, const TILES: usize, const SLOTS: usize>(
        &mut self,
        session: &mut Session,
        memory: &mut Memory<'_, TILES, SLOTS>,
        board: &mut B,
    ) -> Result<bool, PortError> {
        let failed = |error: S::Error| PortError::Read(error.kind());
        if !self.serial.read_ready().map_err(failed)? {
            return Ok(false);
        }
        let mut bytes = [0; 64];
        let count = self.serial.read(&mut bytes).map_err(failed)?;
        for byte in bytes.iter().take(count) {
            session.receive(*byte, memory, board);
        }
        Ok(count > 0)
    }

    fn write(&mut self, session: &mut Session) -> Result<bool, PortError> {
        let failed = |error: S::Error| PortError::Write(error.kind());
        let mut wrote = false;
        while !session.pending().is_empty() {
            let count = self.serial.write(session.pending()).map_err(failed)?;
            session.sent(count);
            wrote = true;
        }
        self.serial.flush().map_err(failed)?;
        Ok(wrote)
    }
}

/// Moves log bytes from the board to the session. Not inlined: its buffer must not be on the stack
/// during a step.
#[inline(never)]
fn take_log<B: Board>(session: &mut Session, board: &mut B) {
    let mut log = [0; MAX_LOG_BYTES];
    let room = session.log_room();
    if let Some(log) = log.get_mut(..room) {
        let count = board.take_log(log);
        if let Some(log) = log.get(..count) {
            session.log(log);
        }
    }
}

#[cfg(test)]
mod tests;

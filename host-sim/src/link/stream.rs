//! A line over any stream of bytes: sockets, serial ports, ptys.
//!
//! The stream's own read timeout must be short ([`POLL`]): the line waits by repeated reads until
//! the deadline.

use core::time::Duration;
use std::io::{ErrorKind, Read, Write};
use std::time::Instant;

use super::LinkError;
use super::line::Line;

/// Read timeout to set on a stream before it becomes a line.
pub const POLL: Duration = Duration::from_millis(20);

/// A line over a stream, in wall-clock time.
#[derive(Debug)]
pub struct Stream<S> {
    stream: S,
    name: String,
    began: Instant,
}

impl<S: Read + Write> Stream<S> {
    /// A line over `stream`; errors name it `name`.
    pub fn new(stream: S, name: impl Into<String>) -> Self {
        Self {
            stream,
            name: name.into(),
            began: Instant::now(),
        }
    }

    fn failed(&self, what: &str, error: &std::io::Error) -> LinkError {
        LinkError::Io(format!(
            "{what} {} failed: {error}; check the connection",
            self.name
        ))
    }
}

/// Returns true if the stream only has no bytes at the moment.
fn is_idle(kind: ErrorKind) -> bool {
    matches!(
        kind,
        ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted
    )
}

impl<S: Read + Write> Line for Stream<S> {
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.stream
            .write_all(bytes)
            .and_then(|()| self.stream.flush())
            .map_err(|error| self.failed("writing to", &error))
    }

    fn receive(&mut self, into: &mut Vec<u8>, wait: Duration) -> Result<(), LinkError> {
        let deadline = Instant::now() + wait;
        let mut bytes = [0; 1024];
        loop {
            match self.stream.read(&mut bytes) {
                Ok(0) => {
                    return Err(LinkError::Io(format!(
                        "{} closed the connection; check that it still runs",
                        self.name
                    )));
                }
                Ok(count) => {
                    into.extend_from_slice(&bytes[..count]);
                    return Ok(());
                }
                Err(error) if is_idle(error.kind()) => {}
                Err(error) => return Err(self.failed("reading from", &error)),
            }
            if Instant::now() >= deadline {
                return Ok(());
            }
        }
    }

    fn now(&self) -> Duration {
        self.began.elapsed()
    }
}

/// A number that distinguishes this host from the last one on the same device.
#[must_use]
pub fn fresh_nonce() -> u32 {
    let since = std::time::SystemTime::now()
        .duration_since(std::time::UNIX_EPOCH)
        .unwrap_or_default();
    (since.as_nanos() as u32) ^ std::process::id().rotate_left(16)
}

//! A line carries bytes both ways and knows its own time.

use core::time::Duration;

use super::LinkError;

/// Bytes both ways. Time is the line's own: the wall's on a real one, counted on an imagined one, where nothing ever waits.
pub trait Line {
    /// Puts bytes on the line.
    ///
    /// # Errors
    /// [`LinkError::Io`].
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError>;
    /// Adds what came to `into`, waiting at most `wait` for the first byte.
    ///
    /// # Errors
    /// [`LinkError::Io`].
    fn receive(&mut self, into: &mut Vec<u8>, wait: Duration) -> Result<(), LinkError>;
    /// Time since some beginning.
    fn now(&self) -> Duration;
}

impl<L: Line + ?Sized> Line for &mut L {
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        (**self).send(bytes)
    }

    fn receive(&mut self, into: &mut Vec<u8>, wait: Duration) -> Result<(), LinkError> {
        (**self).receive(into, wait)
    }

    fn now(&self) -> Duration {
        (**self).now()
    }
}

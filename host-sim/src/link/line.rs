//! A line: bytes in both directions, and a clock.

use core::time::Duration;

use super::LinkError;
use super::cycles::StepCost;
use super::inside::Inside;

/// Bytes in both directions. A real line has wall-clock time; a simulated one counts its time and
/// never waits.
pub trait Line {
    /// Sends bytes.
    ///
    /// # Errors
    /// [`LinkError::Io`].
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError>;
    /// Appends the received bytes to `into`; waits at most `wait` for the first one.
    ///
    /// # Errors
    /// [`LinkError::Io`].
    fn receive(&mut self, into: &mut Vec<u8>, wait: Duration) -> Result<(), LinkError>;
    /// Time since a fixed moment.
    fn now(&self) -> Duration;
    /// Looks into the device at the far end, if it lives in this process. A line that wraps another
    /// one passes this on.
    fn inside(&self) -> Option<Box<dyn Inside + '_>> {
        None
    }
    /// Returns what the last step took by the model of the chip's cycles, once, if the far end has
    /// one. A line that wraps another one passes this on.
    fn cycles(&self) -> Option<StepCost> {
        None
    }
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

    fn inside(&self) -> Option<Box<dyn Inside + '_>> {
        (**self).inside()
    }

    fn cycles(&self) -> Option<StepCost> {
        (**self).cycles()
    }
}

//! The packets for the team that a planner says after an observation, as bytes.
//!
//! Invariant: a planner is asked at most [`MOST_SAID`] times in a step, so a device that never ends
//! does not stop the robot.

use fieldline_protocol::packet::{MAX_PACKET, encode_packet};

use super::{Link, LinkError};

/// Most packets that a planner says in a step. A device that says more is not asked on.
const MOST_SAID: usize = 8;

/// What a planner says in one step.
#[derive(Debug)]
pub(crate) struct Said {
    left: usize,
    bytes: [u8; MAX_PACKET],
}

impl Said {
    /// Begins a step.
    pub(crate) const fn new() -> Self {
        Self {
            left: MOST_SAID,
            bytes: [0; MAX_PACKET],
        }
    }

    /// Asks for the next packet; `None` after the last one. A packet that has no bytes is left out.
    ///
    /// # Errors
    /// As [`Link::say`].
    pub(crate) fn next(&mut self, link: &mut dyn Link) -> Result<Option<&[u8]>, LinkError> {
        while self.left > 0 {
            self.left -= 1;
            let Some(packet) = link.say()? else {
                self.left = 0;
                break;
            };
            if let Ok(length) = encode_packet(&packet, &mut self.bytes) {
                return Ok(Some(&self.bytes[..length]));
            }
        }
        Ok(None)
    }
}

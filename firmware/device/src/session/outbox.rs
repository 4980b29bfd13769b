//! Frames that wait to be sent.
//!
//! Invariant: the outbox holds whole frames, except for the part of the first one that is already
//! sent.

use fieldline_protocol::frame::{MAX_LOG_BYTES, MAX_REPLY_FRAME, overhead};
use heapless::Deque;

/// Capacity, bytes: two replies and some log.
const CAPACITY: usize = 2 * MAX_REPLY_FRAME + 128;

/// A queue of frames.
#[derive(Debug)]
pub(super) struct Outbox(Deque<u8, CAPACITY>);

impl Outbox {
    /// Returns an empty outbox.
    pub(super) const fn new() -> Self {
        Self(Deque::new())
    }

    /// Queues a whole frame. Returns false, and queues nothing, if the frame does not fit.
    #[must_use]
    pub(super) fn put(&mut self, frame: &[u8]) -> bool {
        if CAPACITY - self.0.len() < frame.len() {
            return false;
        }
        for byte in frame {
            // There is room: checked above.
            let _ = self.0.push_back(*byte);
        }
        true
    }

    /// Returns the next bytes to send. More bytes may follow after [`Outbox::sent`].
    pub(super) fn pending(&self) -> &[u8] {
        self.0.as_slices().0
    }

    /// Removes the first `count` bytes.
    pub(super) fn sent(&mut self, count: usize) {
        for _ in 0..count {
            self.0.pop_front();
        }
    }

    /// Returns the number of log bytes that fit into a frame now, such that a reply fits behind it.
    pub(super) fn log_room(&self) -> usize {
        let free = CAPACITY - self.0.len();
        free.saturating_sub(MAX_REPLY_FRAME + overhead(MAX_LOG_BYTES))
            .min(MAX_LOG_BYTES)
    }
}

//! Processes of a team go on together: none runs ahead of a peer that is slower.
//!
//! A process begins a step when each peer has said something since its last step, or was silent
//! for [`GONE_AFTER`]. Every planner says a beacon in each step, so the simulated clocks of two
//! processes differ by a step or two, however long the machine lets one of them wait. Without this
//! a process that stands still for 0.1 s at six times real time is silent for 0.6 simulated
//! seconds, and its robot then appears where another one drives.
//!
//! A lost datagram stops nobody for long: the peer that heard goes on and says more. If all were
//! lost, the silence ends the waiting.
//!
//! Units: real time, which the caller passes.

use core::time::Duration;
use std::time::Instant;

use super::envelope::ROBOTS;

/// Real time of silence after which nobody waits for a peer: it ended, or cannot be reached. As
/// long as a peer's claims hold at a pace of 1.
const GONE_AFTER: Duration = Duration::from_secs(2);

/// A peer that was heard.
#[derive(Clone, Copy, Debug)]
struct Heard {
    at: Instant,
    since_step: bool,
}

/// Which peers have said something since the last step.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Lockstep([Option<Heard>; ROBOTS]);

impl Lockstep {
    /// Notes a packet of a peer.
    pub(super) fn hear(&mut self, peer: u8, at: Instant) {
        if let Some(heard) = self.0.get_mut(usize::from(peer)) {
            let since_step = true;
            *heard = Some(Heard { at, since_step });
        }
    }

    /// Returns true if a peer may still say something that the next step needs.
    pub(super) fn waits(&self, now: Instant) -> bool {
        let mut heard = self.0.iter().flatten();
        heard.any(|it| !it.since_step && now.duration_since(it.at) < GONE_AFTER)
    }

    /// Notes a step of the own robot.
    pub(super) fn step(&mut self) {
        for heard in self.0.iter_mut().flatten() {
            heard.since_step = false;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_waits_for_each_peer_that_was_heard_of_late() {
        let start = Instant::now();
        let after = |ms| start + Duration::from_millis(ms);
        let mut lockstep = Lockstep::default();
        // Nobody is known.
        assert!(!lockstep.waits(start));
        lockstep.hear(1, start);
        lockstep.hear(2, after(500));
        assert!(!lockstep.waits(after(500)));
        lockstep.step();
        lockstep.hear(1, after(600));
        assert!(lockstep.waits(after(600)) && lockstep.waits(after(2_499)));
        // Robot 2 is gone, and comes back.
        assert!(!lockstep.waits(after(2_500)));
        lockstep.step();
        lockstep.hear(2, after(2_550));
        assert!(lockstep.waits(after(2_599)) && !lockstep.waits(after(2_600)));
        // A number that no robot has.
        lockstep.hear(200, after(2_600));
    }
}

//! Patterns of the status LED: sixteen slots of an eighth of a second, repeated.

use fieldline_protocol::message::Status;

/// Length of a slot, milliseconds.
const SLOT_MS: u32 = 125;

/// A state of the device that the LED shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Signal {
    /// No host has greeted: one flash.
    #[default]
    Waiting,
    /// A host has greeted, and there is no session: two flashes.
    Ready,
    /// The session explores: half a second on, half a second off.
    Exploring,
    /// The host paused the session: one second on, one second off.
    Paused,
    /// The exploration ended: three flashes.
    Finished,
    /// The emergency stop is latched: on.
    EmergencyStop,
    /// The host is silent or incompatible, or the planner cannot continue: four blinks per second.
    Trouble,
    /// The device rebooted after a crash, and no host has greeted: on, with two gaps.
    Crashed,
}

impl Signal {
    /// Returns the signal of a session's status.
    #[must_use]
    pub const fn of(status: Status) -> Self {
        match status {
            Status::Idle => Self::Ready,
            Status::Exploring | Status::NoScan | Status::Going(_) => Self::Exploring,
            Status::Paused => Self::Paused,
            Status::EmergencyStop => Self::EmergencyStop,
            Status::Finished(_) | Status::Arrived(_) => Self::Finished,
            Status::Fault(_) | Status::Unreachable(_) => Self::Trouble,
        }
    }

    /// Returns one bit per slot, the first slot in the highest bit.
    const fn pattern(self) -> u16 {
        match self {
            Self::Waiting => 0b1000_0000_0000_0000,
            Self::Ready => 0b1010_0000_0000_0000,
            Self::Exploring => 0b1111_0000_1111_0000,
            Self::Paused => 0b1111_1111_0000_0000,
            Self::Finished => 0b1010_1000_0000_0000,
            Self::EmergencyStop => 0b1111_1111_1111_1111,
            Self::Trouble => 0b1010_1010_1010_1010,
            Self::Crashed => 0b1111_1111_1111_0101,
        }
    }

    /// Returns true if the LED is on at `now_ms`.
    #[must_use]
    pub const fn lit(self, now_ms: u32) -> bool {
        self.pattern() << ((now_ms / SLOT_MS) % 16) & 0x8000 != 0
    }
}

#[cfg(test)]
mod tests {
    use std::string::String;

    use super::{SLOT_MS, Signal};

    fn seen(signal: Signal) -> String {
        (0..16)
            .map(|slot| if signal.lit(slot * SLOT_MS) { '#' } else { '.' })
            .collect()
    }

    #[test]
    fn patterns_look_as_documented() {
        for (signal, picture) in [
            (Signal::Waiting, "#..............."),
            (Signal::Ready, "#.#............."),
            (Signal::Exploring, "####....####...."),
            (Signal::Paused, "########........"),
            (Signal::Finished, "#.#.#..........."),
            (Signal::EmergencyStop, "################"),
            (Signal::Trouble, "#.#.#.#.#.#.#.#."),
            (Signal::Crashed, "############.#.#"),
        ] {
            assert_eq!(seen(signal), picture, "{signal:?}");
            assert_eq!(signal.lit(2000), signal.lit(0), "repeats every two seconds");
            assert_eq!(signal.lit(SLOT_MS - 1), signal.lit(0));
        }
    }
}

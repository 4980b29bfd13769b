//! The fingerprint of a command stream: 64-bit FNV-1a over each command's bits.
//!
//! Hashed of every command, in order: linear and angular velocity (raw I4F12, two bytes each, little-endian), heading (raw
//! I16F16, four bytes), status (two bytes: variant, reason). Two runs with one digest drove the same, bit for bit; costs
//! and counters are left out, since they differ between rungs.

use fieldline_protocol::message::{Command, Fault, Finish, Status};

const OFFSET_BASIS: u64 = 0xcbf2_9ce4_8422_2325;
const PRIME: u64 = 0x0000_0100_0000_01b3;

/// A running digest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Digest(u64);

impl Default for Digest {
    fn default() -> Self {
        Self(OFFSET_BASIS)
    }
}

impl Digest {
    /// Take one more command.
    pub fn push(&mut self, command: &Command) {
        self.bytes(&command.velocity.linear.to_bits().to_le_bytes());
        self.bytes(&command.velocity.angular.to_bits().to_le_bytes());
        self.bytes(&command.heading.to_bits().to_le_bytes());
        self.bytes(&status_code(command.status));
    }

    fn bytes(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(PRIME);
        }
    }
}

impl core::fmt::Display for Digest {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "{:016x}", self.0)
    }
}

/// Written out, so that the digest does not change with the order of an enum.
fn status_code(status: Status) -> [u8; 2] {
    match status {
        Status::Idle => [0, 0],
        Status::Exploring => [1, 0],
        Status::Paused => [2, 0],
        Status::EmergencyStop => [3, 0],
        Status::Finished(Finish::Explored) => [4, 0],
        Status::Finished(Finish::BoxedIn) => [4, 1],
        Status::Finished(Finish::Stopped) => [4, 2],
        Status::Fault(Fault::StartBlocked) => [5, 0],
        Status::Fault(Fault::MapFull) => [5, 1],
        Status::Fault(Fault::OutOfBox) => [5, 2],
        Status::Fault(Fault::BadObservation) => [5, 3],
        Status::Fault(Fault::Stuck) => [5, 4],
    }
}

#[cfg(test)]
mod tests {
    use super::Digest;
    use fieldline_protocol::message::{Command, Cost, Status, Twist};
    use fixed::types::{I4F12, I16F16};

    fn of(commands: &[Command]) -> String {
        let mut digest = Digest::default();
        commands.iter().for_each(|command| digest.push(command));
        digest.to_string()
    }

    /// FNV-1a's published vectors: the empty string, "a" and "foobar".
    #[test]
    fn the_hash_is_fnv_1a() {
        let hash = |text: &str| {
            let mut digest = Digest::default();
            digest.bytes(text.as_bytes());
            digest.to_string()
        };
        assert_eq!(hash(""), "cbf29ce484222325");
        assert_eq!(hash("a"), "af63dc4c8601ec8c");
        assert_eq!(hash("foobar"), "85944171f73967e8");
    }

    #[test]
    fn one_bit_of_motion_or_status_changes_it_and_cost_does_not() {
        let base = Command {
            status: Status::Exploring,
            ..Command::default()
        };
        let faster = Command {
            velocity: Twist {
                linear: I4F12::from_bits(1),
                ..Twist::default()
            },
            ..base
        };
        let turned = Command {
            heading: I16F16::from_bits(1),
            ..base
        };
        let idle = Command {
            status: Status::Idle,
            ..base
        };
        let dear = Command {
            cost: Cost {
                instructions: 9,
                ..Cost::default()
            },
            ..base
        };
        let reference = of(&[base, base]);
        for other in [faster, turned, idle] {
            assert_ne!(of(&[base, other]), reference);
            assert_ne!(of(&[base, other]), of(&[other, base]));
        }
        assert_eq!(of(&[base, dear]), reference);
    }
}

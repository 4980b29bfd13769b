//! Digest of a stream of commands: equal digests mean equal drives, bit for bit.
//!
//! FNV-1a of 128 bits over each command's raw velocity (two little-endian 16-bit numbers) and the
//! wire's bytes of its status. Counters, costs and headings are left out: they do not move the
//! robot.

use core::fmt;

use fieldline_protocol::message::Command;

/// The running digest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Digest(u128);

impl Default for Digest {
    fn default() -> Self {
        Self::new()
    }
}

impl Digest {
    /// The digest of no commands.
    #[must_use]
    pub const fn new() -> Self {
        Self(0x6c62_272e_07bb_0142_62b8_2175_6295_c58d)
    }

    /// Adds a command.
    pub fn add(&mut self, command: &Command) {
        let velocity = command.velocity;
        self.bytes(&velocity.linear.to_bits().to_le_bytes());
        self.bytes(&velocity.angular.to_bits().to_le_bytes());
        // A status has at most two bytes.
        let mut room = [0; 4];
        if let Ok(status) = postcard::to_slice(&command.status, &mut room) {
            self.bytes(status);
        }
    }

    fn bytes(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u128::from(*byte)).wrapping_mul((1 << 88) + 0x13b);
        }
    }
}

impl fmt::Display for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:032x}", self.0)
    }
}

#[cfg(test)]
mod tests {
    use fieldline_protocol::message::{Command, Fault, Status, Twist};
    use fixed::types::I4F12;

    use super::Digest;

    fn digest(commands: &[Command]) -> String {
        let mut digest = Digest::new();
        commands.iter().for_each(|command| digest.add(command));
        digest.to_string()
    }

    /// Reference values from the authors of FNV.
    #[test]
    fn the_hash_is_fnv_1a_of_128_bits() {
        for (text, hash) in [
            ("", "6c62272e07bb014262b821756295c58d"),
            ("a", "d228cb696f1a8caf78912b704e4a8964"),
            ("foobar", "343e1662793c64bf6f0d3597ba446f18"),
        ] {
            let mut digest = Digest::new();
            digest.bytes(text.as_bytes());
            assert_eq!(digest.to_string(), hash);
        }
    }

    #[test]
    fn only_velocity_and_status_count_and_every_bit_of_them() {
        let command = Command {
            status: Status::Exploring,
            ..Command::default()
        };
        let base = digest(&[command, command]);
        let mut slower = command;
        slower.velocity = Twist {
            angular: I4F12::DELTA,
            ..Twist::default()
        };
        assert_ne!(digest(&[command, slower]), base);
        assert_ne!(digest(&[slower, command]), digest(&[command, slower]));
        let mut stuck = command;
        stuck.status = Status::Fault(Fault::Stuck);
        assert_ne!(digest(&[command, stuck]), base);
        assert_ne!(digest(&[command]), base);
        let mut costly = command;
        costly.cost.instructions = 7;
        costly.counters.received = 9;
        assert_eq!(digest(&[command, costly]), base);
    }
}

//! What carries datagrams between processes.

use core::fmt::Debug;
use core::net::SocketAddr;

/// A datagram that arrived.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Arrived {
    /// Its bytes.
    pub bytes: Vec<u8>,
    /// Where it came from, if the carrier knows addresses.
    pub from: Option<SocketAddr>,
    /// True if it came from a peer.
    pub is_known: bool,
}

/// Carries datagrams. Nothing is certain to arrive, or once, or in order.
pub trait Carrier: Debug {
    /// Sends a datagram to all peers; returns to how many.
    fn send(&mut self, bytes: &[u8]) -> u64;
    /// Returns a datagram that has arrived; `None` if there is none. Does not wait.
    fn receive(&mut self) -> Option<Arrived>;
    /// Returns the own port if a hello is due, for a carrier whose members find each other.
    fn hello(&mut self) -> Option<u16> {
        None
    }
    /// Sends a hello to whoever listens.
    fn say_hello(&mut self, _bytes: &[u8]) {}
    /// Notes that a member hears packets at a port.
    fn found(&mut self, _id: u8, _from: SocketAddr, _port: u16) {}
}

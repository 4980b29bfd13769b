//! Datagrams between the processes of a team: unicast to known peers, multicast only to find them.
//!
//! Once a second a process says in the group at which port it hears packets. Whoever hears that
//! sends its packets there. Without a group, only the configured peers are known.

use core::net::{Ipv4Addr, SocketAddr};
use core::time::Duration;
use std::collections::BTreeMap;
use std::io::{self, ErrorKind};
use std::net::UdpSocket;
use std::time::Instant;

use socket2::{Domain, Protocol, Socket, Type};

use super::carrier::{Arrived, Carrier};
use super::spec::TeamSpec;

/// Time between two hellos.
const HELLO_EVERY: Duration = Duration::from_secs(1);
/// Room for the longest datagram of a team, and more: a longer one is cut and then refused.
const ROOM: usize = 1_024;

/// Datagrams over UDP.
#[derive(Debug)]
pub struct Udp {
    socket: UdpSocket,
    group: Option<(UdpSocket, SocketAddr)>,
    peers: Vec<SocketAddr>,
    /// Members that said hello, by number.
    found: BTreeMap<u8, SocketAddr>,
    said_hello: Option<Instant>,
}

impl Udp {
    /// Opens the sockets.
    ///
    /// # Errors
    /// The system's error, with the address.
    pub fn open(spec: &TeamSpec) -> Result<Self, String> {
        let failed = |what: SocketAddr| move |error: io::Error| format!("{what}: {error}");
        let socket = UdpSocket::bind(spec.bind).map_err(failed(spec.bind))?;
        socket.set_nonblocking(true).map_err(failed(spec.bind))?;
        let group = spec.find.map(SocketAddr::V4);
        let group = match (spec.find, group) {
            (Some(found), Some(group)) => {
                let joined = join(*found.ip(), found.port(), spec.interface);
                socket2::SockRef::from(&socket)
                    .set_multicast_if_v4(&spec.interface)
                    .map_err(failed(group))?;
                Some((joined.map_err(failed(group))?, group))
            }
            _ => None,
        };
        Ok(Self {
            socket,
            group,
            peers: spec.peers.clone(),
            found: BTreeMap::new(),
            said_hello: None,
        })
    }
}

/// Opens a socket in a multicast group. Several processes of a machine may do so.
fn join(group: Ipv4Addr, port: u16, interface: Ipv4Addr) -> io::Result<UdpSocket> {
    let socket = Socket::new(Domain::IPV4, Type::DGRAM, Some(Protocol::UDP))?;
    socket.set_reuse_address(true)?;
    #[cfg(unix)]
    socket.set_reuse_port(true)?;
    socket.bind(&SocketAddr::from((Ipv4Addr::UNSPECIFIED, port)).into())?;
    socket.join_multicast_v4(&group, &interface)?;
    socket.set_nonblocking(true)?;
    Ok(socket.into())
}

/// Takes one datagram that has arrived.
fn take(socket: &UdpSocket) -> Option<(Vec<u8>, SocketAddr)> {
    let mut bytes = [0; ROOM];
    loop {
        match socket.recv_from(&mut bytes) {
            Ok((length, from)) => return Some((bytes[..length].to_vec(), from)),
            // A peer that does not run answers with an error; the next datagram may be good.
            Err(error) if error.kind() == ErrorKind::ConnectionRefused => {}
            Err(error) if error.kind() == ErrorKind::ConnectionReset => {}
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(_) => return None,
        }
    }
}

impl Carrier for Udp {
    fn send(&mut self, bytes: &[u8]) -> u64 {
        let mut all: Vec<SocketAddr> = self.peers.clone();
        all.extend(self.found.values());
        all.sort_unstable();
        all.dedup();
        let sent = all
            .iter()
            .filter(|peer| self.socket.send_to(bytes, peer).is_ok());
        sent.count() as u64
    }

    fn receive(&mut self) -> Option<Arrived> {
        let direct = take(&self.socket);
        let (bytes, from) = direct.or_else(|| take(&self.group.as_ref()?.0))?;
        Some(Arrived {
            is_known: self.peers.contains(&from) || self.found.values().any(|it| *it == from),
            bytes,
            from: Some(from),
        })
    }

    fn hello(&mut self) -> Option<u16> {
        self.group.as_ref()?;
        let due = self.said_hello.is_none_or(|at| at.elapsed() >= HELLO_EVERY);
        if !due {
            return None;
        }
        self.said_hello = Some(Instant::now());
        self.socket.local_addr().ok().map(|address| address.port())
    }

    fn say_hello(&mut self, bytes: &[u8]) {
        if let Some((_, group)) = &self.group {
            // The next hello comes in a second.
            let _ = self.socket.send_to(bytes, group);
        }
    }

    fn found(&mut self, id: u8, from: SocketAddr, port: u16) {
        self.found.insert(id, SocketAddr::new(from.ip(), port));
    }
}

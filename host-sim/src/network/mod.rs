//! A robot of a team whose members are processes, on one machine or on several.
//!
//! [`Networked`] is a link around the link to the robot's own planner. Before each observation it
//! passes on what arrived from the others; after it, it sends what the planner says. So every run
//! over every link can be part of a team, also one with a board on a serial port. Each process
//! simulates its own robot in its own copy of the world: robots of other processes are neither seen
//! nor touched there, only heard.
//!
//! | file | holds |
//! | --- | --- |
//! | [`envelope`] | the bytes of a datagram: sender, number, tag; what is new |
//! | [`spec`] | a process's place in a team, by name |
//! | [`carrier`] | what carries datagrams |
//! | [`udp`] | unicast to peers, multicast to find them |
//! | `zenoh` | a zenoh router or peers; feature `zenoh` |
//! | `lockstep` | no process runs ahead of the others |
//!
//! Whatever arrives, nothing panics: a datagram that is no good is dropped and counted.

pub mod carrier;
pub mod envelope;
mod lockstep;
pub mod spec;
pub mod udp;
#[cfg(feature = "zenoh")]
pub mod zenoh;

use core::time::Duration;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Instant, SystemTime, UNIX_EPOCH};

use fieldline_protocol::message::{
    Command, Control, Correct, CorrectedTiles, CorrectionProgress, FieldRow, Identity, Member,
    Observation, Packet, Path, Recall, ResidualFrontier, Status, Team, Tile,
};
use fieldline_protocol::packet::decode_packet;
use serde::{Deserialize, Serialize};

use crate::link::inside::Inside;
use crate::link::said::Said;
use crate::link::{Link, LinkError, LinkStats};
use carrier::{Arrived, Carrier};
use envelope::{Heard, Key, Kind, Letter, Refused};
use lockstep::Lockstep;

/// Most datagrams that are taken before an observation: a flood must not stop the robot.
const MOST_TAKEN: usize = 256;
/// Time from one look for datagrams to the next while peers are slower.
const LOOK_EVERY: Duration = Duration::from_millis(1);

/// What happened to datagrams; as in a report.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counters {
    /// Packets that the planner said.
    pub said: u64,
    /// Datagrams with packets, one for each peer.
    pub sent: u64,
    /// Datagrams that arrived.
    pub received: u64,
    /// Packets passed on to the planner.
    pub heard: u64,
    /// Dropped: no datagram of a team, or none with a packet of this schema.
    pub malformed: u64,
    /// Dropped: the tag is wrong, because of another key or of damage.
    pub unauthentic: u64,
    /// Dropped: heard before, or of an earlier session of its sender.
    pub replayed: u64,
    /// Dropped: from an address that is no peer's, in a team without a key.
    pub foreign: u64,
    /// Dropped: from this robot, or from another one with its number.
    pub own: u64,
}

/// Counters that can be read while the link is in use.
#[derive(Clone, Debug, Default)]
pub struct Account(Arc<Mutex<Counters>>);

impl Account {
    /// Returns the present counters.
    #[must_use]
    pub fn read(&self) -> Counters {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn add(&self, change: impl FnOnce(&mut Counters)) {
        change(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner));
    }
}

/// A link to a planner that is in a team of processes.
#[expect(missing_debug_implementations, reason = "a boxed trait object")]
pub struct Networked {
    link: Box<dyn Link>,
    carrier: Box<dyn Carrier>,
    key: Key,
    member: Member,
    session: u64,
    counter: u64,
    heard: Heard,
    lockstep: Lockstep,
    account: Account,
}

impl Networked {
    /// Makes a planner a member of a team. The session is the present time, so a restarted process
    /// has a later one.
    #[must_use]
    pub fn new(link: Box<dyn Link>, carrier: Box<dyn Carrier>, key: Key, id: u8) -> Self {
        let since = SystemTime::now().duration_since(UNIX_EPOCH);
        let session = since.map_or(1, |since| since.as_micros() as u64);
        Self {
            link,
            carrier,
            key,
            // About milliseconds: it changes from start to start.
            member: Member {
                id,
                boot: (session >> 10) as u16,
            },
            session,
            counter: 0,
            heard: Heard::default(),
            lockstep: Lockstep::default(),
            account: Account::default(),
        }
    }

    /// Returns the counters, to be read later.
    #[must_use]
    pub fn account(&self) -> Account {
        self.account.clone()
    }

    fn seal(&mut self, kind: Kind, body: &[u8]) -> Vec<u8> {
        self.counter += 1;
        self.key.seal(&Letter {
            kind,
            from: self.member.id,
            session: self.session,
            counter: self.counter,
            body,
        })
    }

    /// Passes on what arrives until every peer has come as far as this robot.
    fn keep_together(&mut self) -> Result<(), LinkError> {
        self.listen()?;
        while self.lockstep.waits(Instant::now()) {
            std::thread::sleep(LOOK_EVERY);
            self.listen()?;
        }
        self.lockstep.step();
        Ok(())
    }

    /// Passes on what arrived.
    fn listen(&mut self) -> Result<(), LinkError> {
        for _ in 0..MOST_TAKEN {
            let Some(arrived) = self.carrier.receive() else {
                break;
            };
            if let Some(packet) = self.accept(&arrived) {
                self.lockstep.hear(packet.from.id, Instant::now());
                self.link.hear(&packet)?;
            }
        }
        Ok(())
    }

    /// Returns the packet of a datagram that is good, and counts any other.
    fn accept(&mut self, arrived: &Arrived) -> Option<Packet> {
        self.account.add(|it| it.received += 1);
        let letter = match self.key.open(&arrived.bytes) {
            Ok(letter) => letter,
            Err(refused) => {
                self.account.add(|it| match refused {
                    Refused::Malformed => it.malformed += 1,
                    Refused::Unauthentic => it.unauthentic += 1,
                });
                return None;
            }
        };
        if letter.from == self.member.id {
            self.account.add(|it| it.own += 1);
            return None;
        }
        let is_hello = letter.kind == Kind::Hello;
        if !is_hello && !arrived.is_known && !self.key.is_secret() {
            self.account.add(|it| it.foreign += 1);
            return None;
        }
        if !self.heard.is_new(&letter) {
            self.account.add(|it| it.replayed += 1);
            return None;
        }
        if is_hello {
            let port = letter.body.try_into().map(u16::from_le_bytes);
            match (port, arrived.from) {
                (Ok(port), Some(from)) => self.carrier.found(letter.from, from, port),
                _ => self.account.add(|it| it.malformed += 1),
            }
            return None;
        }
        let packet = decode_packet(letter.body).filter(|it| it.from.id == letter.from);
        self.account.add(|it| match &packet {
            Some(_) => it.heard += 1,
            None => it.malformed += 1,
        });
        packet
    }

    /// Sends what the planner says.
    fn speak(&mut self) -> Result<(), LinkError> {
        if let Some(port) = self.carrier.hello() {
            let hello = self.seal(Kind::Hello, &port.to_le_bytes());
            self.carrier.say_hello(&hello);
        }
        let mut said = Said::new();
        while let Some(bytes) = said.next(self.link.as_mut())? {
            let datagram = self.seal(Kind::Packet, bytes);
            let sent = self.carrier.send(&datagram);
            self.account.add(|it| {
                it.said += 1;
                it.sent += sent;
            });
        }
        Ok(())
    }
}

impl Link for Networked {
    fn hello(&mut self) -> Result<Identity, LinkError> {
        self.link.hello()
    }

    /// A session starts as a member of the team.
    fn control(&mut self, control: &Control) -> Result<Status, LinkError> {
        let Control::Start(start) = control else {
            return self.link.control(control);
        };
        let mut start = start.clone();
        start.team = Some(Team {
            member: self.member,
            ..start.team.unwrap_or_default()
        });
        self.link.control(&Control::Start(start))
    }

    fn observe(&mut self, observation: &Observation) -> Result<Command, LinkError> {
        self.keep_together()?;
        let command = self.link.observe(observation)?;
        self.speak()?;
        Ok(command)
    }

    fn tile(&mut self, x: i16, y: i16) -> Result<Option<Tile>, LinkError> {
        self.link.tile(x, y)
    }

    fn field_row(&mut self, row: u8) -> Result<Option<FieldRow>, LinkError> {
        self.link.field_row(row)
    }

    fn frontiers(&mut self) -> Result<Vec<ResidualFrontier>, LinkError> {
        self.link.frontiers()
    }

    fn path(&mut self, from: u8) -> Result<Path, LinkError> {
        self.link.path(from)
    }

    fn hear(&mut self, packet: &Packet) -> Result<(), LinkError> {
        self.link.hear(packet)
    }

    fn say(&mut self) -> Result<Option<Packet>, LinkError> {
        self.link.say()
    }

    fn open_correction(&mut self, correct: &Correct) -> Result<CorrectionProgress, LinkError> {
        self.link.open_correction(correct)
    }

    fn send_tiles(&mut self, part: &CorrectedTiles) -> Result<CorrectionProgress, LinkError> {
        self.link.send_tiles(part)
    }

    fn recall(&mut self, recall: &Recall) -> Result<(), LinkError> {
        self.link.recall(recall)
    }

    fn inside(&self) -> Option<Box<dyn Inside + '_>> {
        self.link.inside()
    }

    fn stats(&self) -> LinkStats {
        self.link.stats()
    }

    fn take_log(&mut self) -> Vec<u8> {
        self.link.take_log()
    }
}

#[cfg(test)]
mod tests;

//! Members that find each other, and datagrams that no member may accept.

use std::collections::VecDeque;

use fieldline_protocol::message::{Beacon, Body, Start, Strategy};
use fieldline_protocol::packet::{MAX_PACKET, encode_packet};
use fixed::types::I4F12;

use super::spec::TeamSpec;
use super::udp::Udp;
use super::*;
use crate::link::direct::Direct;
use crate::sim::{SimConfig, Simulator};
use crate::world::World;

/// Datagrams that a test hands over; keeps what is sent.
#[derive(Clone, Debug, Default)]
struct Tray {
    arriving: Arc<Mutex<VecDeque<Arrived>>>,
    sent: Arc<Mutex<Vec<Vec<u8>>>>,
}

impl Carrier for Tray {
    fn send(&mut self, bytes: &[u8]) -> u64 {
        self.sent.lock().unwrap().push(bytes.to_vec());
        1
    }

    fn receive(&mut self) -> Option<Arrived> {
        self.arriving.lock().unwrap().pop_front()
    }
}

impl Tray {
    fn put(&self, bytes: &[u8], is_known: bool) {
        self.arriving.lock().unwrap().push_back(Arrived {
            bytes: bytes.to_vec(),
            from: None,
            is_known,
        });
    }
}

fn key() -> Key {
    Key::new(b"0123456789abcdef")
}

fn member(carrier: impl Carrier + 'static, key: Key, id: u8) -> Networked {
    Networked::new(Box::new(Direct::new()), Box::new(carrier), key, id)
}

/// Starts a member's session and makes steps.
fn steps(member: &mut Networked, steps: u32) {
    let world = World::builtin("office").expect("built in");
    let mut simulator = Simulator::new(&world, SimConfig::default()).expect("fits");
    let start: Start = simulator.start_message(Strategy::Frontier);
    member.control(&Control::Start(start)).expect("starts");
    for _ in 0..steps {
        let command = member.observe(&simulator.observe()).expect("a command");
        simulator.drive(Some(command.velocity));
    }
}

fn packet(from: u8) -> Vec<u8> {
    let packet = Packet {
        from: Member { id: from, boot: 9 },
        sequence: 1,
        body: Body::Beacon(Beacon {
            yaw: I4F12::ZERO,
            ..Beacon::default()
        }),
    };
    let mut bytes = [0; MAX_PACKET];
    let length = encode_packet(&packet, &mut bytes).expect("fits");
    bytes[..length].to_vec()
}

fn letter(from: u8, counter: u64, body: &[u8]) -> Letter<'_> {
    Letter {
        kind: Kind::Packet,
        from,
        session: 5,
        counter,
        body,
    }
}

#[test]
fn only_new_packets_of_the_team_are_heard_and_every_other_datagram_is_counted() {
    let tray = Tray::default();
    let mut member = member(tray.clone(), key(), 0);
    let body = packet(1);
    let good = key().seal(&letter(1, 1, &body));
    tray.put(&good, false);
    tray.put(&good, true);
    tray.put(b"FL", true);
    tray.put(&Key::default().seal(&letter(1, 2, &body)), true);
    tray.put(&key().seal(&letter(0, 3, &body)), true);
    // The packet of another robot, a packet that is cut, and none.
    tray.put(&key().seal(&letter(2, 1, &body)), true);
    tray.put(&key().seal(&letter(1, 4, &body[1..])), true);
    tray.put(&key().seal(&letter(1, 5, b"")), true);
    tray.put(&key().seal(&letter(1, 6, &body)), true);
    steps(&mut member, 1);
    let expected = Counters {
        said: 1,
        sent: 1,
        received: 9,
        heard: 2,
        malformed: 4,
        unauthentic: 1,
        replayed: 1,
        foreign: 0,
        own: 1,
    };
    assert_eq!(member.account().read(), expected);
    let sent = tray.sent.lock().unwrap();
    let opened = key().open(&sent[0]).expect("its own key opens it");
    assert_eq!(decode_packet(opened.body).map(|it| it.from.id), Some(0));
}

#[test]
fn without_a_key_only_peers_are_heard() {
    let tray = Tray::default();
    let mut member = member(tray.clone(), Key::default(), 0);
    let body = packet(1);
    tray.put(&Key::default().seal(&letter(1, 1, &body)), false);
    tray.put(&Key::default().seal(&letter(1, 2, &body)), true);
    tray.put(&key().seal(&letter(1, 3, &body)), true);
    steps(&mut member, 1);
    let counters = member.account().read();
    assert_eq!(
        (counters.foreign, counters.heard, counters.unauthentic),
        (1, 1, 1)
    );
}

#[test]
fn a_later_session_of_a_sender_ends_the_earlier_one() {
    let tray = Tray::default();
    let mut member = member(tray.clone(), key(), 0);
    let body = packet(1);
    let of = |session: u64, counter: u64| {
        key().seal(&Letter {
            session,
            ..letter(1, counter, &body)
        })
    };
    for (session, counter) in [(5, 7), (6, 1), (5, 8), (6, 1), (6, 2)] {
        tray.put(&of(session, counter), true);
    }
    steps(&mut member, 1);
    let counters = member.account().read();
    assert_eq!((counters.heard, counters.replayed), (3, 2));
}

#[test]
fn a_flood_of_garbage_does_not_stop_the_robot() {
    let tray = Tray::default();
    let mut member = member(tray.clone(), key(), 0);
    for k in 0..2_000_u32 {
        tray.put(&k.to_le_bytes(), true);
    }
    steps(&mut member, 3);
    let counters = member.account().read();
    assert_eq!(
        (counters.malformed, counters.said),
        (3 * MOST_TAKEN as u64, 3)
    );
}

#[test]
fn members_find_each_other_in_a_multicast_group() {
    let socket = std::net::UdpSocket::bind("127.0.0.1:0").expect("a port");
    let port = socket.local_addr().expect("an address").port();
    drop(socket);
    let open = |id: u8| {
        let text = format!("id={id},bind=127.0.0.1:0,find=239.70.76.9:{port},interface=127.0.0.1");
        let spec: TeamSpec = text.parse().expect("a specification");
        Udp::open(&spec).expect("opens")
    };
    let mut members = [0, 1].map(|id| member(open(id), key(), id));
    // The first hears of the second in its second round, and the second of the first at once.
    for _ in 0..3 {
        for member in &mut members {
            steps(member, 1);
        }
    }
    for member in &members {
        let counters = member.account().read();
        assert!(counters.heard >= 1, "{counters:?}");
        assert_eq!(counters.malformed + counters.unauthentic, 0, "{counters:?}");
    }
}

#[test]
fn any_bytes_are_refused_and_none_panics() {
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::{Rng as _, SeedableRng as _};
    let mut rng = ChaCha8Rng::seed_from_u64(14);
    let key = key();
    for round in 0..200_000_u32 {
        let mut bytes = vec![0; (rng.next_u32() % 64) as usize];
        rng.fill_bytes(&mut bytes);
        if round % 2 == 0 && bytes.len() > 5 {
            bytes[..5].copy_from_slice(&[b'F', b'L', 1, 0, 3]);
        }
        assert!(key.open(&bytes).is_err());
    }
}

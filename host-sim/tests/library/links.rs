//! Links without hardware.
//!
//! Direct and loopback give the same commands, and faults on the line change none. A device that
//! resets or falls silent ends the run with a typed error within the stale limit.

use core::time::Duration;

use crate::drive::{Robot, digest_of, start};
use fieldline_device::STALE_MS;
use fieldline_protocol::message::{
    Beacon, Body, Control, Finish, Member, Observation, Packet, Path, Start, Status, Strategy, Team,
};
use host_sim::link::direct::Direct;
use host_sim::link::endpoint::{Endpoint, RetryPolicy};
use host_sim::link::fault::{Faults, Faulty};
use host_sim::link::line::Line;
use host_sim::link::loopback::{LocalDevice, loopback};
use host_sim::link::spec::{LinkSpec, Options};
use host_sim::link::{Link, LinkError};
use host_sim::sim::{SimConfig, Simulator};
use host_sim::world::World;

const STEPS: u32 = 400;

fn faulty(faults: &str, seed: u64) -> Endpoint<Faulty<LocalDevice>> {
    let faults: Faults = faults.parse().unwrap();
    let line = Faulty::new(LocalDevice::new(), faults, seed);
    Endpoint::new(line, RetryPolicy::VIRTUAL, 1)
}

#[test]
fn direct_and_loopback_give_the_same_commands() {
    assert_eq!(
        digest_of(&mut Direct::new(), STEPS),
        digest_of(&mut loopback(), STEPS)
    );
}

/// Returns what a member of a team says on a drive, while a peer crosses its way.
fn words_of(link: &mut impl Link) -> Vec<Packet> {
    let member = Member { id: 1, boot: 1 };
    let team = Team {
        member,
        ..Team::default()
    };
    let start = Start {
        team: Some(team),
        ..start()
    };
    link.hello().unwrap();
    link.control(&Control::Start(start)).unwrap();
    let mut robot = Robot::new();
    let mut said = Vec::new();
    for sequence in 0..100 {
        robot.step(link).unwrap();
        while let Some(packet) = link.say().unwrap() {
            said.push(packet);
        }
        let beacon = Beacon {
            x_cm: 100 + sequence as i16,
            ..Beacon::default()
        };
        let from = Member { id: 2, boot: 0 };
        let body = Body::Beacon(beacon);
        let packet = Packet {
            from,
            sequence,
            body,
        };
        link.hear(&packet).unwrap();
    }
    said
}

#[test]
fn direct_and_loopback_say_the_same_to_the_team() {
    let said = words_of(&mut Direct::new());
    assert!(said.len() >= 100, "a beacon in every step");
    assert_eq!(said, words_of(&mut loopback()));
    assert_eq!(said, words_of(&mut faulty("drop=0.02,duplicate=0.02", 1)));
}

#[test]
fn no_byte_fault_changes_a_command() {
    let clean = digest_of(&mut Direct::new(), STEPS);
    for faults in [
        "drop=0.02",
        "duplicate=0.02",
        "corrupt=0.02",
        "truncate=0.02",
        "delay=0.05",
        "drop=0.02,duplicate=0.02,corrupt=0.02,truncate=0.01,delay=0.05",
        "drop=0.04,duplicate=0.04,corrupt=0.04,truncate=0.04,delay=0.08",
    ] {
        for seed in 0..4 {
            let mut link = faulty(faults, seed);
            assert_eq!(digest_of(&mut link, STEPS), clean, "{faults}, seed {seed}");
            let stats = link.end().stats();
            assert_eq!(stats.sent, u64::from(STEPS) + 2 + stats.retries);
            if !faults.starts_with("duplicate") {
                assert!(stats.retries > 0, "{faults}, seed {seed}: {stats:?}");
            }
        }
    }
}

#[test]
fn every_kind_of_fault_is_made() {
    let faults: Faults = "drop=0.02,duplicate=0.02,corrupt=0.02,truncate=0.02,delay=0.05"
        .parse()
        .unwrap();
    let mut line = Faulty::new(LocalDevice::new(), faults, 5);
    let mut heard = Vec::new();
    for _ in 0..3000 {
        line.send(&[2, 7, 0]).unwrap();
        line.receive(&mut heard, Duration::from_millis(1)).unwrap();
    }
    let made = line.made();
    // 3000 draws each: 60 or 150 are expected; four standard deviations are 31 and 48.
    for (count, expected, margin) in [
        (made.dropped, 60, 31),
        (made.duplicated, 60, 31),
        (made.corrupted, 60, 31),
        (made.truncated, 60, 31),
        (made.delayed, 150, 48),
    ] {
        assert!(count.abs_diff(expected) <= margin, "{made:?}");
    }
    assert!(
        line.line().session().counters().dropped > 2500,
        "the rest came through"
    );
}

/// Drives to the error: returns it, the number of steps before it, and the time of the last call on
/// the line's clock.
fn ending(faults: &str) -> (LinkError, u32, Duration) {
    let mut link = faulty(faults, 1);
    let mut robot = Robot::new();
    // Before the fault every request takes one frame and no time.
    let error = robot.run(&mut link, STEPS).unwrap_err();
    (error, robot.steps, link.now())
}

#[test]
fn a_reset_is_reported_within_the_stale_limit() {
    let (error, steps, took) = ending("reset@120");
    assert_eq!((error, steps), (LinkError::Reset, 117));
    assert!(took.as_millis() <= u128::from(STALE_MS), "{took:?}");
}

#[test]
fn silence_is_reported_within_the_stale_limit() {
    let (error, steps, took) = ending("silent@200");
    assert_eq!((error, steps), (LinkError::Silent, 197));
    assert!(
        took > Duration::ZERO && took.as_millis() <= u128::from(STALE_MS),
        "{took:?}"
    );
}

#[test]
fn a_reset_among_byte_faults_is_reported_as_a_reset() {
    for seed in 0..8 {
        let spec = "drop=0.05,corrupt=0.05,truncate=0.05,duplicate=0.05,delay=0.1,reset@50";
        let mut link = faulty(spec, seed);
        let mut robot = Robot::new();
        let error = robot.run(&mut link, STEPS).unwrap_err();
        assert_eq!(error, LinkError::Reset, "seed {seed}");
        assert!(robot.steps < 50);
    }
}

#[test]
fn a_silent_host_makes_the_device_stop() {
    let mut device = LocalDevice::new();
    let mut link = Endpoint::new(&mut device, RetryPolicy::VIRTUAL, 1);
    Robot::new().run(&mut link, 3).unwrap();
    assert!(!device.session().is_stale());
    device.receive(&mut Vec::new(), Duration::ZERO).unwrap();
    device
        .receive(&mut Vec::new(), Duration::from_millis(501))
        .unwrap();
    assert!(device.session().is_stale());
    assert_eq!(device.session().counters().stale_stops, 1);
}

#[test]
fn the_emergency_stop_reaches_the_host() {
    let mut device = LocalDevice::new();
    device.set_emergency_stop(true);
    let mut link = Endpoint::new(device, RetryPolicy::VIRTUAL, 1);
    let status = link.control(&Control::Start(start())).unwrap();
    assert_eq!(status, Status::EmergencyStop);
    let command = link.observe(&Robot::new().sense()).unwrap();
    assert_eq!(
        (command.status, command.velocity),
        (Status::EmergencyStop, Default::default())
    );
}

#[test]
fn logs_arrive_beside_the_replies() {
    let mut device = LocalDevice::new();
    let log: Vec<u8> = (0..100).collect();
    assert_eq!(device.log(&log), 100);
    let mut link = Endpoint::new(device, RetryPolicy::VIRTUAL, 1);
    link.hello().unwrap();
    assert_eq!(link.take_log(), log);
    assert!(link.take_log().is_empty());
}

/// Always sends the same bytes.
struct Parrot(Vec<u8>, Duration);

impl Line for Parrot {
    fn send(&mut self, _: &[u8]) -> Result<(), LinkError> {
        Ok(())
    }
    fn receive(&mut self, into: &mut Vec<u8>, wait: Duration) -> Result<(), LinkError> {
        into.extend(&self.0);
        self.1 += wait;
        Ok(())
    }
    fn now(&self) -> Duration {
        self.1
    }
}

#[test]
fn a_peer_that_is_no_device_is_named() {
    let login = b"\r\nDebian GNU/Linux 12 tty1\r\n\0login: ".to_vec();
    let mut link = Endpoint::new(Parrot(login, Duration::ZERO), RetryPolicy::VIRTUAL, 1);
    let error = link.hello().unwrap_err();
    assert!(matches!(&error, LinkError::Incompatible(_)), "{error:?}");
    assert!(
        error
            .to_string()
            .contains("check the device, the baud rate"),
        "{error}"
    );

    let mut nobody = Endpoint::new(Parrot(Vec::new(), Duration::ZERO), RetryPolicy::VIRTUAL, 1);
    assert_eq!(nobody.hello().unwrap_err(), LinkError::Silent);
}

/// Receives its own bytes, like a plug with shorted lines.
#[derive(Default)]
struct Shorted(Vec<u8>, Duration);

impl Line for Shorted {
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.0.extend(bytes);
        Ok(())
    }
    fn receive(&mut self, into: &mut Vec<u8>, wait: Duration) -> Result<(), LinkError> {
        into.append(&mut self.0);
        self.1 += wait;
        Ok(())
    }
    fn now(&self) -> Duration {
        self.1
    }
}

#[test]
fn an_echo_is_no_device() {
    let mut link = Endpoint::new(Shorted::default(), RetryPolicy::VIRTUAL, 1);
    let error = link.hello().unwrap_err();
    assert!(matches!(error, LinkError::Incompatible(_)), "{error:?}");
}

/// A device of another version answers the hello with bytes that never change.
#[test]
fn another_version_is_incompatible() {
    use fieldline_protocol::frame::{MAX_REPLY_FRAME, encode_reply};
    let mut frame = [0; MAX_REPLY_FRAME];
    let reply = fieldline_protocol::message::Reply::Incompatible {
        version: 9,
        schema: 1,
    };
    let length = encode_reply(1, &reply, &mut frame).unwrap();
    let answer = Parrot(frame[..length].to_vec(), Duration::ZERO);
    let mut link = Endpoint::new(answer, RetryPolicy::VIRTUAL, 1);
    let LinkError::Incompatible(text) = link.hello().unwrap_err() else {
        panic!("compatible with version 9");
    };
    assert!(
        text.contains("protocol 9") && text.contains("same source"),
        "{text}"
    );
}

#[test]
fn refusals_are_the_same_on_both_links() {
    let bad = Control::Start(Start {
        robot_radius_mm: 0,
        ..start()
    });
    let links: [Box<dyn Link>; 2] = [Box::new(Direct::new()), Box::new(loopback())];
    for mut link in links {
        link.hello().unwrap();
        let error = link.control(&bad).unwrap_err();
        assert!(
            error.to_string().contains("radius must be 50 to 600 mm"),
            "{error}"
        );
        let error = link.observe(&Observation::default()).unwrap_err();
        assert!(matches!(&error, LinkError::Refused(why) if why.contains("start one first")));
        link.control(&Control::Start(start())).unwrap();
        let stopped = link.control(&Control::Stop).unwrap();
        assert_eq!(stopped, Status::Finished(Finish::Stopped));
        assert_eq!(link.tile(90, 90).unwrap(), None);
        assert_eq!(link.frontiers().unwrap(), []);
    }
}

#[test]
fn a_requested_reset_is_no_error() {
    let mut link = loopback();
    Robot::new().run(&mut link, 2).unwrap();
    link.control(&Control::Reset).unwrap();
    let identity = link.hello().unwrap();
    assert_eq!(identity.boots, 2);
    Robot::new().run(&mut link, 2).unwrap();
}

/// The roads of every tenth step of a short drive in `office`, whole and without the first cell.
fn roads(link: &mut dyn Link) -> Vec<[Path; 2]> {
    let world = World::builtin("office").expect("built in");
    let mut simulator = Simulator::new(&world, SimConfig::default()).expect("the start is free");
    let start = simulator.start_message(Strategy::Frontier);
    link.control(&Control::Start(start)).unwrap();
    let mut roads = Vec::new();
    for step in 0..100 {
        let command = link.observe(&simulator.observe()).unwrap();
        simulator.drive(Some(command.velocity));
        if step % 10 == 9 {
            roads.push([0, 1].map(|from| link.path(from).unwrap()));
        }
    }
    roads
}

#[test]
fn every_link_forwards_the_request_for_the_road() {
    let direct = roads(&mut Direct::new());
    let long: Vec<_> = direct.iter().filter(|[all, _]| all.length > 1).collect();
    assert!(!long.is_empty(), "{direct:?}");
    for [all, rest] in long {
        assert_eq!(all.cells[1], rest.cells[0]);
    }
    assert_eq!(roads(&mut loopback()), direct);
    assert_eq!(roads(&mut faulty("drop=0.05,corrupt=0.05", 2)), direct);
}

#[test]
fn links_open_by_name() {
    let faults = "drop=0.05,corrupt=0.05".parse().unwrap();
    let options = Options {
        faults,
        seed: 3,
        ..Options::default()
    };
    let mut broken = LinkSpec::Loopback.open(&options).unwrap();
    let mut direct = LinkSpec::Direct.open(&Options::default()).unwrap();
    assert_eq!(
        digest_of(broken.as_mut(), 50),
        digest_of(direct.as_mut(), 50)
    );
    assert!(broken.end().stats().retries > 0);
    assert_eq!(direct.end().stats().retries, 0);
}

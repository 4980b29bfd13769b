//! The rules of the conversation, each as a script of requests and replies.

mod talk;

use std::vec;
use std::vec::Vec;

use fieldline_protocol::check::Kind;
use fieldline_protocol::frame::{MAX_REQUEST_FRAME, encode_body};
use fieldline_protocol::message::{
    Control, Counters, Crash, Fault, Refusal, Reply, Request, Stages, Status, Twist,
};
use fieldline_protocol::{SCHEMA, VERSION};

use super::Boot;
use crate::pilot::tests::{observation, start};
use crate::signal::Signal;
use talk::{Talk, frame, hello, refused};

#[test]
fn a_booted_device_sends_its_identity() {
    let crash = Crash {
        at: 12,
        ..Crash::default()
    };
    let boot = Boot {
        boots: 3,
        crash: Some(crash.clone()),
    };
    let mut talk = Talk::booted(boot);
    assert_eq!(talk.session.signal(), Signal::Crashed);
    let heard = talk.hear();
    let [(0, Reply::Hello(identity))] = heard.as_slice() else {
        panic!("{heard:?}");
    };
    assert_eq!((identity.version, identity.schema), (VERSION, SCHEMA));
    assert_eq!((identity.boots, identity.crash.as_ref()), (3, Some(&crash)));
    assert_eq!((identity.tile_pool, identity.tile_slots), (192, 400));
    assert_eq!(usize::from(identity.max_frame), MAX_REQUEST_FRAME);
    let mut again = identity.clone();
    again.counters.received = 1;
    assert_eq!(talk.say(9, &hello(1)), [(9, Reply::Hello(again))]);
    assert_eq!(talk.session.signal(), Signal::Ready);
}

#[test]
fn every_request_before_a_hello_is_refused() {
    let mut talk = Talk::booted(Boot::default());
    talk.hear();
    assert_eq!(talk.session.signal(), Signal::Waiting);
    for request in [
        Request::Frontiers,
        Request::Control(Control::Start(start())),
        Request::Observation(observation(0)),
    ] {
        assert_eq!(talk.say(4, &request), refused(4, Refusal::NotGreeted));
    }
    assert_eq!(talk.steps.0, 0);
}

#[test]
fn another_protocol_is_refused_until_a_matching_hello() {
    let mut talk = Talk::started();
    for (version, schema) in [(VERSION + 1, SCHEMA), (VERSION, SCHEMA ^ 1)] {
        let foreign = Request::Hello {
            version,
            schema,
            nonce: 9,
        };
        let ours = Reply::Incompatible {
            version: VERSION,
            schema: SCHEMA,
        };
        assert_eq!(talk.say(5, &foreign), [(5, ours)]);
        assert_eq!(talk.session.signal(), Signal::Trouble);
        assert_eq!(
            talk.say(6, &Request::Frontiers),
            refused(6, Refusal::NotGreeted)
        );
    }
    assert!(matches!(
        talk.say(7, &hello(9)).as_slice(),
        [(7, Reply::Hello(_))]
    ));
    assert_eq!(talk.session.signal(), Signal::Exploring);
}

#[test]
fn an_observation_gets_a_command_with_its_cost() {
    let mut talk = Talk::started();
    let command = talk.observe(2);
    assert_eq!(talk.steps.0, 1);
    assert_eq!(command.cost.stack_bytes, 77);
    let stages = Stages {
        session: 2000,
        sense: 1000,
        topology: 1000,
        window: 1000,
        ..Stages::default()
    };
    assert_eq!(command.cost.stages, stages);
    assert_eq!(command.cost.instructions, 5000);
    let counters = Counters {
        received: 3,
        ..Counters::default()
    };
    assert_eq!(command.counters, counters);
    let next = talk.observe(3);
    assert_eq!(
        next.cost.stages.session, 3000,
        "includes the reply before it"
    );
}

#[test]
fn a_wrong_observation_stops_the_robot_for_one_step() {
    let mut talk = Talk::started();
    let mut wrong = observation(200);
    wrong.scans[1].ranges_mm.pop();
    let heard = talk.say(2, &Request::Observation(wrong));
    let [(2, Reply::Command(command))] = heard.as_slice() else {
        panic!("{heard:?}");
    };
    assert_eq!(command.status, Status::Fault(Fault::BadObservation));
    assert_eq!(command.velocity, Twist::default());
    assert_eq!(command.cost.stages.sense, 0, "no step");
    let mut missing = observation(300);
    missing.scans.pop();
    let heard = talk.say(3, &Request::Observation(missing));
    assert!(
        matches!(heard.as_slice(), [(3, Reply::Command(command))]
            if command.status == Status::Fault(Fault::BadObservation)),
        "{heard:?}"
    );
    let command = talk.observe(4);
    assert_ne!(command.status, Status::Fault(Fault::BadObservation));
    assert_eq!(command.cost.stages.sense, 1000);
}

/// The schema hash covers the strategies, so a host of this schema cannot send another one. Its
/// bytes are dropped like any other malformed body.
#[test]
fn an_unknown_strategy_starts_no_session() {
    let mut talk = Talk::booted(Boot::default());
    talk.hear();
    talk.say(0, &hello(7));
    let unknown_strategy = [1, 0, 3, 20, 20, 0, 0, 0, 0, 0, 0, 0, 0];
    let mut out = [0; MAX_REQUEST_FRAME];
    let length = encode_body(Kind::Request, 1, &unknown_strategy, &mut out).unwrap();
    talk.feed(&out[..length]);
    assert_eq!(talk.hear(), []);
    assert_eq!(talk.session.counters().dropped, 1);
    let observation = Request::Observation(observation(0));
    assert_eq!(talk.say(1, &observation), refused(1, Refusal::NotStarted));
}

#[test]
fn a_repeated_number_gets_the_same_reply_and_no_step() {
    let mut talk = Talk::started();
    let request = frame(2, &Request::Observation(observation(200)));
    talk.feed(&request);
    let first = talk.bytes();
    talk.feed(&request);
    assert_eq!(talk.bytes(), first, "bit for bit, with the same counters");
    assert_eq!(talk.steps.0, 1);
    // The number decides, even if the bytes of the request differ.
    talk.feed(&frame(2, &Request::Frontiers));
    assert_eq!(talk.bytes(), first);
    assert_eq!(talk.session.counters().duplicates, 2);
}

#[test]
fn an_older_number_is_refused_without_a_step() {
    let mut talk = Talk::started();
    talk.observe(2);
    talk.observe(3);
    let late = talk.say(2, &Request::Observation(observation(200)));
    assert_eq!(late, refused(2, Refusal::OutOfOrder));
    assert_eq!(talk.steps.0, 2);
    // The last reply is still stored.
    let repeated = talk.observe(3);
    assert_eq!((talk.steps.0, repeated.counters.duplicates), (2, 0));
    assert_eq!(talk.session.counters().duplicates, 1);
    assert_eq!(talk.session.counters().dropped, 1);
}

#[test]
fn sequence_numbers_wrap() {
    let mut talk = Talk::started();
    for sequence in [0x7000, 0xe000, 0xffff, 0, 1] {
        talk.observe(sequence);
    }
    assert_eq!(talk.steps.0, 5);
}

#[test]
fn only_a_new_nonce_restarts_the_numbers() {
    let mut talk = Talk::started();
    talk.observe(500);
    assert!(matches!(
        talk.say(0, &hello(7)).as_slice(),
        [(0, Reply::Hello(_))]
    ));
    let late = talk.say(499, &Request::Frontiers);
    assert_eq!(late, refused(499, Refusal::OutOfOrder));
    talk.say(0, &hello(8));
    assert_eq!(
        talk.say(1, &Request::Tile { x: 100, y: 100 }),
        [(1, Reply::Tile(None))]
    );
}

#[test]
fn refusals_are_stored_and_repeated() {
    let mut talk = Talk::booted(Boot::default());
    talk.hear();
    talk.say(0, &hello(7));
    let observation = Request::Observation(observation(0));
    for _ in 0..2 {
        assert_eq!(talk.say(1, &observation), refused(1, Refusal::NotStarted));
    }
    assert_eq!(talk.session.counters().duplicates, 1);
}

#[test]
fn noise_only_changes_counters() {
    let mut talk = Talk::started();
    let mut broken = frame(2, &Request::Frontiers);
    broken[3] ^= 0x10;
    talk.feed(&broken);
    talk.feed(&[3, 1, 0]);
    assert_eq!(talk.hear(), []);
    let counters = talk.observe(2).counters;
    assert_eq!((counters.crc_errors, counters.dropped), (1, 1));
}

#[test]
fn silence_is_one_stale_stop_until_an_observation() {
    let mut talk = Talk::started();
    talk.session.tick(500);
    assert!(!talk.session.is_stale());
    talk.session.tick(501);
    assert!(talk.session.is_stale());
    assert_eq!(talk.session.signal(), Signal::Trouble);
    talk.session.tick(5000);
    assert_eq!(talk.session.counters().stale_stops, 1);
    talk.observe(2);
    assert!(!talk.session.is_stale());
    talk.session.tick(5500);
    assert_eq!(talk.session.counters().stale_stops, 1);
    talk.session.tick(5501);
    assert_eq!(talk.session.counters().stale_stops, 2);
}

#[test]
fn a_wrapping_clock_causes_no_stop() {
    let mut talk = Talk::started();
    talk.session.tick(u32::MAX - 100);
    talk.observe(2);
    talk.session.tick(300);
    assert!(!talk.session.is_stale());
    talk.session.tick(500);
    assert!(talk.session.is_stale());
}

#[test]
fn only_a_driving_session_can_be_stale() {
    let mut talk = Talk::started();
    talk.say(2, &Request::Control(Control::Pause));
    talk.session.tick(10_000);
    assert!(!talk.session.is_stale());
}

#[test]
fn the_emergency_stop_holds_until_resumed() {
    let mut talk = Talk::started();
    talk.session.set_emergency_stop(true);
    let command = talk.observe(2);
    assert_eq!(
        (command.status, command.velocity),
        (Status::EmergencyStop, Twist::default())
    );
    assert_eq!(talk.session.signal(), Signal::EmergencyStop);
    talk.session.set_emergency_stop(false);
    assert_eq!(talk.observe(3).status, Status::EmergencyStop);
    let resumed = talk.say(4, &Request::Control(Control::Resume));
    assert_eq!(resumed, [(4, Reply::Control(Status::Exploring))]);
}

#[test]
fn a_reset_is_answered_and_requested() {
    let mut talk = Talk::started();
    assert!(!talk.session.wants_reset());
    let reply = talk.say(2, &Request::Control(Control::Reset));
    assert_eq!(reply, [(2, Reply::Control(Status::Idle))]);
    assert!(talk.session.wants_reset());
}

#[test]
fn a_log_never_displaces_a_reply() {
    let mut talk = Talk::started();
    let log: Vec<u8> = (0..=255).collect();
    let mut sent = vec![];
    while talk.session.log_room() > 0 {
        let count = talk.session.log(&log);
        assert!(count > 0);
        sent.extend_from_slice(&log[..count]);
    }
    assert_eq!(talk.session.log(&log), 0);
    talk.feed(&frame(2, &Request::Frontiers));
    let (mut logged, mut sequences, mut replies) = (vec![], vec![], 0);
    for byte in talk.bytes() {
        if let Some(frame) = talk.host.push(byte) {
            match frame.kind {
                Kind::Log => {
                    logged.extend_from_slice(frame.body);
                    sequences.push(frame.sequence);
                }
                _ => replies += 1,
            }
        }
    }
    assert_eq!((logged, replies), (sent, 1));
    assert!(
        sequences
            .iter()
            .enumerate()
            .all(|(at, sequence)| at == usize::from(*sequence))
    );
}

#[test]
fn a_slow_host_loses_only_whole_replies() {
    let mut talk = Talk::started();
    for sequence in 2..200 {
        talk.feed(&frame(sequence, &Request::Tile { x: 90, y: 90 }));
    }
    assert!(talk.session.counters().dropped > 0);
    let heard = talk.hear();
    let numbers: Vec<u16> = heard.iter().map(|(sequence, _)| *sequence).collect();
    let expected: Vec<u16> = (2..).take(numbers.len()).collect();
    assert_eq!(numbers, expected);
    assert_eq!(talk.host.tally().crc_errors + talk.host.tally().dropped, 0);
    // The last one was dropped but stored.
    assert_eq!(
        talk.say(199, &Request::Frontiers),
        [(199, Reply::Tile(None))]
    );
}

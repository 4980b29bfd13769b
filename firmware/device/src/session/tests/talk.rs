//! A host and a device that exchange frames.

use std::vec;
use std::vec::Vec;

use fieldline_protocol::frame::{
    MAX_REPLY_FRAME, MAX_REQUEST_FRAME, Receiver, Side, encode_request,
};
use fieldline_protocol::message::{Command, Control, Refusal, Reply, Request, Status};
use fieldline_protocol::{SCHEMA, VERSION};

use crate::meter::{Mark, Meter};
use crate::pilot::tests::{Bench, observation, start};
use crate::session::{Boot, Session};

/// A meter that counts its steps. Its count grows by a thousand with each call.
#[derive(Default)]
pub(super) struct Steps(pub(super) u32, u32);

impl Meter for Steps {
    fn start(&mut self) {
        self.0 += 1;
    }
    fn stop(&mut self) {}
    fn mark(&mut self, _: Mark) -> u32 {
        self.1 += 1000;
        self.1
    }
    fn stack_bytes(&self) -> u32 {
        77
    }
}

/// A host and a device that exchange frames.
pub(super) struct Talk {
    pub(super) session: Session,
    bench: Bench,
    pub(super) steps: Steps,
    pub(super) host: Receiver<MAX_REPLY_FRAME>,
}

impl Talk {
    pub(super) fn booted(boot: Boot) -> Self {
        let mut session = Session::new();
        assert!(session.pending().is_empty());
        session.boot(boot, 192, 400);
        Self {
            session,
            bench: Bench::new(),
            steps: Steps::default(),
            host: Receiver::new(Side::Host),
        }
    }

    /// Returns a started session. The sequence numbers 0 and 1 are used.
    pub(super) fn started() -> Self {
        let mut talk = Self::booted(Boot::default());
        talk.hear();
        talk.say(0, &hello(7));
        let started = talk.say(1, &Request::Control(Control::Start(start())));
        assert_eq!(started, [(1, Reply::Control(Status::Exploring))]);
        talk
    }

    pub(super) fn feed(&mut self, bytes: &[u8]) {
        let mut memory = self.bench.memory();
        for byte in bytes {
            self.session.receive(*byte, &mut memory, &mut self.steps);
        }
    }

    pub(super) fn bytes(&mut self) -> Vec<u8> {
        let mut bytes = vec![];
        while !self.session.pending().is_empty() {
            bytes.extend_from_slice(self.session.pending());
            self.session.sent(self.session.pending().len());
        }
        bytes
    }

    pub(super) fn hear(&mut self) -> Vec<(u16, Reply)> {
        let mut heard = vec![];
        for byte in self.bytes() {
            if let Some(frame) = self.host.push(byte) {
                heard.push((frame.sequence, frame.reply().unwrap()));
            }
        }
        heard
    }

    pub(super) fn say(&mut self, sequence: u16, request: &Request) -> Vec<(u16, Reply)> {
        self.feed(&frame(sequence, request));
        self.hear()
    }

    pub(super) fn observe(&mut self, sequence: u16) -> Command {
        let observation = Request::Observation(observation(u32::from(sequence) * 100));
        match self.say(sequence, &observation).as_slice() {
            [(heard, Reply::Command(command))] if *heard == sequence => *command,
            other => panic!("{other:?}"),
        }
    }
}

pub(super) fn frame(sequence: u16, request: &Request) -> Vec<u8> {
    let mut out = [0; MAX_REQUEST_FRAME];
    let length = encode_request(sequence, request, &mut out).unwrap();
    out[..length].to_vec()
}

pub(super) fn hello(nonce: u32) -> Request {
    Request::Hello {
        version: VERSION,
        schema: SCHEMA,
        nonce,
    }
}

pub(super) fn refused(sequence: u16, refusal: Refusal) -> Vec<(u16, Reply)> {
    vec![(sequence, Reply::Refused(refusal))]
}

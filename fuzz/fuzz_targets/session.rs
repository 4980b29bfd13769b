//! Any requests to a whole device: it never panics, and it still answers a hello.
#![no_main]

use std::cell::RefCell;

use fieldline_device::meter::NoMeter;
use fieldline_device::{Boot, Memory, Session};
use fieldline_planner::{State, Tuning, Workspace};
use fieldline_protocol::check::Kind;
use fieldline_protocol::frame::{MAX_REQUEST_FRAME, encode_request};
use fieldline_protocol::message::Request;
use fieldline_protocol::{SCHEMA, VERSION};
use libfuzzer_sys::fuzz_target;

#[path = "sealed.rs"]
mod sealed;

const TILES: usize = 8;
const SLOTS: usize = 64;

thread_local! {
    static MEMORY: RefCell<(Box<State<TILES, SLOTS>>, Box<Workspace>)> =
        RefCell::new((Box::new(State::new()), Box::new(Workspace::new())));
}

fn request(sequence: u16, request: &Request) -> Vec<u8> {
    let mut out = [0; MAX_REQUEST_FRAME];
    let length = encode_request(sequence, request, &mut out).expect("every request fits");
    out[..length].to_vec()
}

fuzz_target!(|data: &[u8]| {
    MEMORY.with_borrow_mut(|(state, workspace)| {
        **workspace = Workspace::new();
        let mut memory = Memory {
            state,
            workspace,
            tuning: &Tuning::DEFAULT,
        };
        let mut session = Session::new();
        session.boot(Boot::default(), TILES, SLOTS);
        let hello = Request::Hello {
            version: VERSION,
            schema: SCHEMA,
            nonce: 1,
        };
        let mut feed = |session: &mut Session, bytes: &[u8]| {
            for byte in bytes {
                session.receive(*byte, &mut memory, &mut NoMeter);
            }
            let mut answered = 0;
            while !session.pending().is_empty() {
                answered += session.pending().len();
                session.sent(session.pending().len());
            }
            answered
        };
        feed(&mut session, &request(0, &hello));
        // Split the input into bodies at a byte that is rare in varints. Send each body in a
        // checked frame with its own sequence number.
        for (step, body) in data.split(|byte| *byte == 0xfe).enumerate() {
            feed(
                &mut session,
                &sealed::frame(Kind::Request, step as u16 + 1, body),
            );
            session.tick(step as u32 * 100);
        }
        feed(&mut session, data);
        feed(&mut session, &[0]);
        assert!(
            feed(&mut session, &request(40_000, &hello)) > 0,
            "the session does not answer"
        );
    });
});

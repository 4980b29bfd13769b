//! The port on a scripted line with scripted pins.

use std::collections::VecDeque;
use std::vec;
use std::vec::Vec;

use embedded_hal_mock::eh1::digital::{Mock as Pin, State, Transaction};
use embedded_io::{ErrorKind, ErrorType, Read, ReadReady, Write};
use fieldline_protocol::check::Kind;
use fieldline_protocol::frame::{
    MAX_REPLY_FRAME, MAX_REQUEST_FRAME, Receiver, Side, encode_request,
};
use fieldline_protocol::message::{Control, Reply, Request, Status};
use fieldline_protocol::{SCHEMA, VERSION};

use super::{Board, Port, PortError, Turn};
use crate::meter::{Mark, Meter, NoMeter};
use crate::pilot::tests::Bench;
use crate::session::{Boot, Session};

/// A serial line: bytes to the device, bytes to the host, and a fault on request.
#[derive(Default)]
struct Line {
    to_device: VecDeque<u8>,
    to_host: Vec<u8>,
    broken: bool,
}

impl ErrorType for Line {
    type Error = ErrorKind;
}

impl ReadReady for Line {
    fn read_ready(&mut self) -> Result<bool, ErrorKind> {
        Ok(!self.to_device.is_empty())
    }
}

impl Read for Line {
    fn read(&mut self, out: &mut [u8]) -> Result<usize, ErrorKind> {
        if self.broken {
            return Err(ErrorKind::InvalidData);
        }
        let count = out.len().min(self.to_device.len()).min(7);
        for (place, byte) in out.iter_mut().zip(self.to_device.drain(..count)) {
            *place = byte;
        }
        Ok(count)
    }
}

impl Write for Line {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, ErrorKind> {
        if self.broken {
            return Err(ErrorKind::BrokenPipe);
        }
        let count = bytes.len().min(5);
        self.to_host.extend_from_slice(&bytes[..count]);
        Ok(count)
    }

    fn flush(&mut self) -> Result<(), ErrorKind> {
        Ok(())
    }
}

/// A board with a clock and a log.
#[derive(Default)]
struct Bare {
    now_ms: u32,
    log: Vec<u8>,
}

impl Meter for Bare {
    fn start(&mut self) {
        NoMeter.start();
    }
    fn stop(&mut self) {
        NoMeter.stop();
    }
    fn mark(&mut self, mark: Mark) -> u32 {
        NoMeter.mark(mark)
    }
    fn stack_bytes(&self) -> u32 {
        NoMeter.stack_bytes()
    }
}

impl Board for Bare {
    fn now_ms(&mut self) -> u32 {
        self.now_ms
    }
    fn take_log(&mut self, out: &mut [u8]) -> usize {
        let count = out.len().min(self.log.len());
        out[..count].copy_from_slice(&self.log[..count]);
        self.log.drain(..count);
        count
    }
}

fn frame(sequence: u16, request: &Request) -> Vec<u8> {
    let mut out = [0; MAX_REQUEST_FRAME];
    let length = encode_request(sequence, request, &mut out).unwrap();
    out[..length].to_vec()
}

fn booted() -> Session {
    let mut session = Session::new();
    session.boot(Boot::default(), 4, 400);
    session
}

fn greeting() -> Vec<u8> {
    let hello = Request::Hello {
        version: VERSION,
        schema: SCHEMA,
        nonce: 1,
    };
    frame(0, &hello)
}

/// Makes one turn per pair of `pins`: each turn reads the emergency stop and sets the LED once.
fn turn_through(
    line: Line,
    session: &mut Session,
    board: &mut Bare,
    pins: &[(State, State)],
) -> (Line, Vec<Turn>) {
    let stops: Vec<_> = pins
        .iter()
        .map(|(stop, _)| Transaction::get(*stop))
        .collect();
    let leds: Vec<_> = pins.iter().map(|(_, led)| Transaction::set(*led)).collect();
    let (mut stop, mut led) = (Pin::new(&stops), Pin::new(&leds));
    let mut port = Port {
        serial: line,
        emergency_stop: stop.clone(),
        led: led.clone(),
    };
    let mut bench = Bench::new();
    let turns = pins
        .iter()
        .map(|_| port.turn(session, &mut bench.memory(), board).unwrap())
        .collect();
    stop.done();
    led.done();
    (port.serial, turns)
}

fn kinds(bytes: &[u8]) -> Vec<Kind> {
    let mut host = Receiver::<MAX_REPLY_FRAME>::new(Side::Host);
    let mut kinds = vec![];
    for byte in bytes {
        kinds.extend(host.push(*byte).map(|frame| frame.kind));
    }
    kinds
}

#[test]
fn bytes_move_until_the_board_may_sleep() {
    let mut session = booted();
    let mut board = Bare {
        log: vec![1, 2, 3],
        ..Bare::default()
    };
    let line = Line {
        to_device: greeting().into(),
        ..Line::default()
    };
    // The stop is released. The LED shows "waiting". The line gives seven bytes at a time.
    let busy = greeting().len().div_ceil(7);
    let pins = [(State::Low, State::High); 4];
    let (line, turns) = turn_through(line, &mut session, &mut board, &pins);
    let expected: Vec<Turn> = (0..4)
        .map(|turn| if turn < busy { Turn::Busy } else { Turn::Idle })
        .collect();
    assert_eq!(turns, expected);
    assert_eq!(
        kinds(&line.to_host),
        [Kind::Welcome, Kind::Log, Kind::Welcome]
    );
}

#[test]
fn a_pressed_stop_lights_the_led() {
    let mut session = booted();
    let mut board = Bare::default();
    let pins = [(State::High, State::High), (State::High, State::High)];
    turn_through(Line::default(), &mut session, &mut board, &pins);
    board.now_ms = 1000;
    // One second into the cycle only the emergency stop lights the LED.
    turn_through(
        Line::default(),
        &mut session,
        &mut board,
        &[(State::High, State::High)],
    );
}

#[test]
fn the_led_follows_the_clock() {
    let mut session = booted();
    let mut board = Bare {
        now_ms: 125,
        ..Bare::default()
    };
    turn_through(
        Line::default(),
        &mut session,
        &mut board,
        &[(State::Low, State::Low)],
    );
}

#[test]
fn a_reset_is_reported_after_its_reply_is_sent() {
    let mut session = booted();
    let mut board = Bare::default();
    let mut bytes = greeting();
    bytes.extend(frame(1, &Request::Control(Control::Reset)));
    let line = Line {
        to_device: bytes.into(),
        ..Line::default()
    };
    let pins = [(State::Low, State::High); 4];
    let (line, turns) = turn_through(line, &mut session, &mut board, &pins);
    assert_eq!(turns.last(), Some(&Turn::Reset));
    let mut host = Receiver::<MAX_REPLY_FRAME>::new(Side::Host);
    let mut last = None;
    for byte in &line.to_host {
        last = host.push(*byte).map(|frame| frame.reply()).or(last);
    }
    assert_eq!(last, Some(Ok(Reply::Control(Status::Idle))));
}

#[test]
fn a_broken_line_is_an_error_with_a_name() {
    let mut session = booted();
    let mut bench = Bench::new();
    let turn = |line: Line, session: &mut Session, bench: &mut Bench| {
        let (mut stop, mut led) = (
            Pin::new(&[Transaction::get(State::Low)]),
            Pin::new(&[Transaction::set(State::High)]),
        );
        let mut port = Port {
            serial: line,
            emergency_stop: stop.clone(),
            led: led.clone(),
        };
        let result = port.turn(session, &mut bench.memory(), &mut Bare::default());
        stop.done();
        led.done();
        result
    };
    let broken = Line {
        broken: true,
        ..Line::default()
    };
    let error = turn(broken, &mut session, &mut bench).unwrap_err();
    assert_eq!(error, PortError::Write(ErrorKind::BrokenPipe));
    let noisy = Line {
        broken: true,
        to_device: [1].into(),
        ..Line::default()
    };
    let error = turn(noisy, &mut session, &mut bench).unwrap_err();
    assert_eq!(error, PortError::Read(ErrorKind::InvalidData));
    assert!(std::format!("{error}").contains("check the wiring"));
}

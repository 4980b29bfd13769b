//! Other peers on a serial port: none, a foreign one, a device of another schema, a device that
//! still boots.
//!
//! The program names the peer in one line and starts no run, within 5 s on the line's clock, or the
//! seconds of `--wait`.
#![cfg(unix)]

use core::sync::atomic::{AtomicBool, Ordering};
use core::time::Duration;
use std::io::{ErrorKind, Read as _, Write as _};
use std::sync::Arc;
use std::thread::JoinHandle;

use assert_cmd::Command;
use fieldline_protocol::frame::{
    BodyError, MAX_REPLY_FRAME, MAX_REQUEST_FRAME, Receiver, Side, encode_reply,
};
use fieldline_protocol::message::{Reply, Request};
use fieldline_protocol::{BAUD, SCHEMA, VERSION};
use host_sim::link::endpoint::{Endpoint, RetryPolicy};
use host_sim::link::line::Line;
use host_sim::link::loopback::LocalDevice;
use host_sim::link::{Link, LinkError, serial};
use serialport::{SerialPort as _, TTYPort};

/// A peer at the far end of a pty: it gets the received bytes and returns its answer.
trait Peer: Send + 'static {
    fn hear(&mut self, bytes: &[u8]) -> Vec<u8>;
}

impl<F: FnMut(&[u8]) -> Vec<u8> + Send + 'static> Peer for F {
    fn hear(&mut self, bytes: &[u8]) -> Vec<u8> {
        self(bytes)
    }
}

/// A port with a peer; dropping this value ends the peer.
struct Port {
    name: String,
    over: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Port {
    fn with(mut peer: impl Peer) -> Self {
        let (mut master, slave) = TTYPort::pair().expect("a pty");
        let name = slave.name().expect("a name");
        // The program opens it.
        drop(slave);
        master.set_timeout(Duration::from_millis(5)).expect("a pty");
        let over = Arc::new(AtomicBool::new(false));
        let told = over.clone();
        let thread = std::thread::spawn(move || {
            let mut bytes = [0; 4096];
            while !told.load(Ordering::Relaxed) {
                let count = match master.read(&mut bytes) {
                    Ok(count) => count,
                    Err(error) if error.kind() == ErrorKind::TimedOut => 0,
                    // The other end is not open.
                    Err(_) => {
                        std::thread::sleep(Duration::from_millis(5));
                        continue;
                    }
                };
                // A full line loses these bytes.
                let _ = master.write(&peer.hear(&bytes[..count]));
            }
        });
        Self {
            name,
            over,
            thread: Some(thread),
        }
    }
}

impl Drop for Port {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn silent(_: &[u8]) -> Vec<u8> {
    Vec::new()
}

/// Random bytes, so also frames of random bytes.
fn gibberish() -> impl FnMut(&[u8]) -> Vec<u8> + Send {
    let mut state = 1_u32;
    move |_| {
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        };
        (0..40).map(|_| next()).collect()
    }
}

/// A device built from other sources; it understands only the hello.
fn foreigner() -> impl FnMut(&[u8]) -> Vec<u8> + Send {
    let mut receiver = Receiver::<MAX_REQUEST_FRAME>::new(Side::Device);
    move |bytes| {
        let mut said = Vec::new();
        for byte in bytes {
            let Some(frame) = receiver.push(*byte) else {
                continue;
            };
            let sequence = frame.sequence;
            let greeted = matches!(
                frame.request(),
                Ok(Request::Hello { .. }) | Err(BodyError::Foreign { .. })
            );
            assert!(greeted, "only hellos");
            let reply = Reply::Incompatible {
                version: VERSION,
                schema: SCHEMA ^ 1,
            };
            let mut out = [0; MAX_REPLY_FRAME];
            let length = encode_reply(sequence, &reply, &mut out).expect("it fits");
            said.extend_from_slice(&out[..length]);
        }
        said
    }
}

/// A device that misses the first `deaf` hellos and then boots and sends its own hello.
fn booting(deaf: usize) -> impl FnMut(&[u8]) -> Vec<u8> + Send {
    let mut device = None;
    let mut zeros = 0;
    move |bytes| {
        zeros += bytes.iter().filter(|byte| **byte == 0).count();
        // A repeated hello begins with a zero too.
        if zeros < 2 * deaf {
            return Vec::new();
        }
        let device = device.get_or_insert_with(LocalDevice::new);
        device.send(bytes).expect("a device in this process");
        let mut said = Vec::new();
        let heard = device.receive(&mut said, Duration::ZERO);
        heard.expect("a device in this process");
        said
    }
}

/// The program's exit status and error output of an exploration over this port, which waits so many
/// seconds for a board.
fn explore(port: &Port, wait: &str) -> (i32, String) {
    let folder = tempfile::tempdir().expect("a folder");
    let output = Command::new(env!("CARGO_BIN_EXE_host-sim"))
        .current_dir(folder.path())
        .args(["explore", "loop", "--time-limit", "2", "--json"])
        .args(["--wait", wait, "--link"])
        .arg(format!("serial:{}", port.name))
        .output()
        .expect("runs");
    let said = String::from_utf8(output.stderr).expect("text");
    (output.status.code().expect("an exit status"), said)
}

#[track_caller]
fn refused(peer: impl Peer, words: &[&str]) {
    let port = Port::with(peer);
    let (status, said) = explore(&port, "0");
    assert_eq!(status, 2, "{said}");
    assert_eq!(said.lines().count(), 1, "{said}");
    for word in [&port.name, "host-sim: --link serial:"]
        .into_iter()
        .map(|word| word as &str)
        .chain(words.iter().copied())
    {
        assert!(said.contains(word), "no {word:?} in: {said}");
    }
}

#[test]
fn a_silent_port_is_named() {
    refused(silent, &["does not answer", "baud rate"]);
}

#[test]
fn a_foreign_peer_is_named() {
    refused(
        gibberish(),
        &["no Fieldline frame", "check the device, the baud rate"],
    );
}

#[test]
fn a_device_of_another_schema_is_named() {
    let foreign = format!("{:#010x}", SCHEMA ^ 1);
    refused(foreigner(), &[&foreign, "same source"]);
}

#[test]
fn the_program_waits_for_a_device_that_still_boots() {
    let port = Port::with(booting(3));
    let (status, said) = explore(&port, "0");
    assert_eq!(status, 1, "{said}");
    assert!(said.contains("the simulated time ran out"), "{said}");
}

/// Six seconds of hellos, one each 0.2 s.
#[test]
fn a_board_that_boots_for_six_seconds_is_waited_for_and_the_user_is_told() {
    let port = Port::with(booting(30));
    let (status, said) = explore(&port, "15");
    assert_eq!(status, 1, "{said}");
    for words in [
        "waits up to 15 s for the board to boot",
        "the simulated time ran out",
    ] {
        assert!(said.contains(words), "{said}");
    }
}

#[test]
fn a_device_on_a_pty_answers_and_its_port_is_locked() {
    let port = Port::with(booting(0));
    let mut link = serial::serial(&port.name, BAUD).expect("a port");
    assert_eq!(link.hello().expect("a device").boots, 1);
    let (status, said) = explore(&port, "0");
    assert_eq!(status, 2, "{said}");
    assert!(said.contains("another program has it open"), "{said}");
}

/// A line with a peer, on which time passes only in waiting.
struct Imagined<P> {
    peer: P,
    waiting: Vec<u8>,
    now: Duration,
}

impl<P: Peer> Line for Imagined<P> {
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        let said = self.peer.hear(bytes);
        self.waiting.extend(said);
        Ok(())
    }
    fn receive(&mut self, into: &mut Vec<u8>, wait: Duration) -> Result<(), LinkError> {
        self.now += wait;
        into.append(&mut self.waiting);
        Ok(())
    }
    fn now(&self) -> Duration {
        self.now
    }
}

/// Results of the hello in lockstep and in real time; each must take at most 5 s.
fn greeted(peer: impl Fn() -> Box<dyn FnMut(&[u8]) -> Vec<u8> + Send>) -> Vec<Option<LinkError>> {
    let outcomes = [RetryPolicy::SERIAL, RetryPolicy::REAL_TIME].map(|policy| {
        let line = Imagined {
            peer: peer(),
            waiting: Vec::new(),
            now: Duration::ZERO,
        };
        let mut link = Endpoint::new(line, policy, 7);
        let outcome = link.hello().err();
        assert!(link.now() <= Duration::from_secs(5), "{:?}", link.now());
        outcome
    });
    outcomes.into()
}

#[test]
fn a_hello_fails_within_5_s_and_a_board_has_3_s_to_boot() {
    for outcome in greeted(|| Box::new(silent)) {
        assert_eq!(outcome, Some(LinkError::Silent));
    }
    for outcome in greeted(|| Box::new(gibberish())) {
        assert!(
            matches!(outcome, Some(LinkError::Incompatible(_))),
            "{outcome:?}"
        );
    }
    for outcome in greeted(|| Box::new(foreigner())) {
        assert!(
            matches!(outcome, Some(LinkError::Incompatible(_))),
            "{outcome:?}"
        );
    }
    // With a hello every 0.2 s, it misses 3 s.
    for outcome in greeted(|| Box::new(booting(15))) {
        assert_eq!(outcome, None);
    }
}

//! Visitors that a run must not notice: strangers, liars, sleepers, crowds.

use core::net::SocketAddr;
use core::time::Duration;
use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::thread;
use std::time::Instant;

use host_sim::link::loopback::loopback;
use host_sim::live::{Ask, Limits, Live};
use tungstenite::Message;

use crate::client::{Viewer, knock, say};
use crate::{mission, open, shown, unseen};

fn page_at(address: SocketAddr, query: &str) -> String {
    say(
        address,
        &format!("GET /{query} HTTP/1.1\r\nHost: {address}\r\n\r\n"),
    )
}

fn wait(what: &str, mut holds: impl FnMut() -> bool) {
    let begun = Instant::now();
    while !holds() {
        assert!(begun.elapsed() < Duration::from_secs(30), "{what}");
        thread::sleep(Duration::from_millis(10));
    }
}

#[test]
fn a_page_of_another_origin_is_refused() {
    let live = open(Limits::default());
    let at = live.address();
    for origin in ["http://evil.example", "null", "http://127.0.0.1:1"] {
        assert_eq!(knock(at, "", origin).err(), Some(403), "{origin}");
    }
    let rebound = "GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n";
    assert!(say(at, rebound).starts_with("HTTP/1.1 403 "));
    assert!(knock(at, "", &format!("http://{at}")).is_ok());
    assert_eq!(live.counts().turned_away, 4);
}

#[test]
fn another_address_than_loopback_needs_the_token() {
    let any = SocketAddr::from(([0, 0, 0, 0], 0));
    let live = Live::open(any, 0.0, Limits::default()).expect("a port");
    let at = SocketAddr::from(([127, 0, 0, 1], live.address().port()));
    let url = live.url();
    let (_, token) = url.split_once("/?token=").expect("a token");
    assert_eq!(token.len(), 32);
    let (query, origin) = (format!("?token={token}"), format!("http://{at}"));
    assert!(page_at(at, &query).starts_with("HTTP/1.1 200 "));
    assert!(knock(at, &query, &origin).is_ok());
    let wrong = format!("?token={}", "0".repeat(32));
    for query in ["", "?token=", &wrong] {
        assert!(page_at(at, query).starts_with("HTTP/1.1 403 "));
        assert_eq!(knock(at, query, &origin).err(), Some(403));
    }
    let second = Live::open(any, 0.0, Limits::default()).expect("a port");
    assert!(
        !second.url().ends_with(token),
        "every program has a token of its own"
    );
}

#[test]
fn heads_that_are_too_long_too_slow_or_no_http_are_refused() {
    let limits = Limits {
        head: Duration::from_millis(300),
        ..Limits::default()
    };
    let live = open(limits);
    let at = live.address();
    let long = format!(
        "GET / HTTP/1.1\r\nHost: {at}\r\nX: {}\r\n\r\n",
        "x".repeat(10_000)
    );
    assert!(say(at, &long).starts_with("HTTP/1.1 431 "));
    assert!(say(at, "GET / HTTP/1.1\r\nHost: ").starts_with("HTTP/1.1 408 "));
    assert!(say(at, "\u{1}\u{2}\u{3} hello\r\n\r\n").starts_with("HTTP/1.1 400 "));
    let counts = live.counts();
    assert_eq!((counts.slow_heads, counts.turned_away), (2, 1));
    assert!(page_at(at, "").starts_with("HTTP/1.1 200 "));
}

#[test]
fn two_hundred_connections_are_counted_and_the_page_comes_back() {
    let live = open(Limits::default());
    let at = live.address();
    let crowd: Vec<_> = (0..200)
        .map(|_| TcpStream::connect(at).expect("a connection"))
        .collect();
    let most = Limits::default().connections as u64;
    wait("the crowd is turned away", || {
        live.counts().too_many >= 200 - most
    });
    // The digest of a run beside a crowd is checked with the ones that never read.
    drop(crowd);
    wait("the page is back", || {
        page_at(at, "").starts_with("HTTP/1.1 200 ")
    });
}

#[test]
fn oversized_and_broken_frames_cost_only_their_viewer() {
    let live = open(Limits::default());
    let at = live.address();
    let mut good = Viewer::come(at);
    let mut large = Viewer::come(at);
    // The server may close before all of it is sent.
    let _ = large.socket.send(Message::text("x".repeat(100_000)));
    let mut binary = Viewer::come(at);
    let _ = binary.socket.send(Message::binary(vec![1, 2, 3]));
    // Without a mask, with a reserved bit, not UTF-8, a length beyond the limit.
    let frames: [&[u8]; 4] = [
        &[0x81, 0x02, b'h', b'i'],
        &[0xf1, 0x80, 0, 0, 0, 0],
        &[0x81, 0x82, 0, 0, 0, 0, 0xff, 0xfe],
        &[
            0x81, 0xff, 0x7f, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0, 0, 0, 0,
        ],
    ];
    let mut broken = Vec::new();
    for frame in frames {
        let mut viewer = Viewer::come(at);
        viewer.socket.get_mut().write_all(frame).expect("sent");
        broken.push(viewer);
    }
    wait("all are dropped", || {
        live.counts().broken == 6 && live.counts().viewers == 1
    });
    let (report, _) = shown(&live, &mut loopback());
    assert_eq!(
        good.until_end().end.as_ref().unwrap()["digest"],
        report.digest
    );
    assert_eq!(report.digest, unseen(&mission()).digest);
}

#[test]
fn a_flood_of_messages_is_refused() {
    let live = open(Limits::default());
    let mut viewer = Viewer::come(live.address());
    for _ in 0..200 {
        viewer.ask(r#"{"do":"step"}"#);
    }
    viewer.until("a refusal", |told| {
        told.refused.iter().any(|it| it.contains("too many"))
    });
    wait("all are counted", || live.counts().refused >= 100);
}

#[test]
fn viewers_that_never_read_are_dropped_and_do_not_slow_the_run() {
    let time = |live: &Live| {
        let begun = Instant::now();
        let (report, _) = shown(live, &mut loopback());
        (report.digest, begun.elapsed())
    };
    let (digest, alone) = time(&open(Limits::default()));
    let limits = Limits {
        patience: Duration::from_millis(400),
        ..Limits::default()
    };
    let live = open(limits);
    let sleepers: Vec<_> = (0..10).map(|_| Viewer::come(live.address())).collect();
    wait("they are in", || live.counts().viewers == 10);
    let (with_sleepers, beside) = time(&live);
    assert_eq!(with_sleepers, digest);
    // Ten threads that copy share the processor; none of them holds the run up.
    assert!(
        beside < alone * 4 + Duration::from_secs(2),
        "{beside:?} after {alone:?}"
    );
    wait("they are dropped", || live.counts().dropped == 10);
    assert_eq!(live.counts().viewers, 0);
    drop(sleepers);
}

#[test]
fn a_clock_that_is_held_goes_on_when_nobody_is_left() {
    let live = open(Limits::default());
    let mut viewer = Viewer::come(live.address());
    wait("it is in", || live.counts().viewers == 1);
    live.ask(Ask::Hold { on: true }).expect("held");
    thread::scope(|scope| {
        let run = scope.spawn(|| shown(&live, &mut loopback()));
        viewer.until("a first step", |told| !told.steps.is_empty());
        thread::sleep(Duration::from_millis(200));
        assert!(viewer.told.steps.len() < 3);
        drop(viewer);
        let (report, _) = run.join().expect("a run");
        assert!(report.explored());
    });
}

#[test]
fn the_program_prints_the_address_shows_the_run_and_ends_by_the_interrupt_key() {
    let folder = tempfile::tempdir().expect("a folder");
    let program = assert_cmd::cargo::cargo_bin!("host-sim");
    let out = folder.path().join("run");
    let mut child = std::process::Command::new(program)
        .args([
            "explore",
            "unreachable-room",
            "--live",
            "127.0.0.1:0",
            "--json",
            "--out",
        ])
        .arg(&out)
        .stderr(std::process::Stdio::piped())
        .stdout(std::process::Stdio::piped())
        .spawn()
        .expect("a program");
    let mut said = std::io::BufReader::new(child.stderr.take().expect("stderr"));
    let mut line = String::new();
    std::io::BufRead::read_line(&mut said, &mut line).expect("a line");
    let address = line
        .trim()
        .strip_prefix("host-sim: live page at http://")
        .expect("an address");
    let address: SocketAddr = address.trim_end_matches('/').parse().expect("an address");
    assert!(page_at(address, "").starts_with("HTTP/1.1 200 "));
    let mut viewer = Viewer::come(address);
    assert_eq!(
        viewer.until_end().end.as_ref().unwrap()["reason"],
        "explored"
    );
    assert!(
        child.try_wait().expect("a state").is_none(),
        "the page stays"
    );
    let interrupted = std::process::Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(interrupted.is_ok_and(|it| it.success()));
    assert!(child.wait().expect("an end").success());
    let mut report = String::new();
    let mut stdout = child.stdout.take().expect("stdout");
    stdout.read_to_string(&mut report).expect("a report");
    let report: serde_json::Value = serde_json::from_str(&report).expect("JSON");
    assert!(report.get("live_requests").is_none());
    assert!(
        report["made_by"]["options"].get("live").is_none(),
        "a page makes no other run"
    );
}

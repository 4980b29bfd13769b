//! The image in the emulator: the same commands as a direct call, exact costs, reboots and crashes.
//!
//! Most of these tests need QEMU and the thumb target, so they are ignored by default.
#![cfg(unix)]

mod drive;

use core::time::Duration;
use std::path::PathBuf;

use drive::{Robot, digest_of, start};
use fieldline_protocol::message::{Cause, Control, Status};
use host_sim::link::direct::Direct;
use host_sim::link::endpoint::{Endpoint, RetryPolicy};
use host_sim::link::fault::Faulty;
use host_sim::link::qemu::{self, PtyBoard, QemuLine};
use host_sim::link::{Link, LinkError, image, serial};

const STEPS: u32 = 60;

/// Builds the image.
fn image() -> PathBuf {
    image::image().expect("the image builds")
}

fn board(image: &std::path::Path) -> Endpoint<QemuLine> {
    let line = qemu::open_line(image).expect("QEMU starts");
    Endpoint::new(line, RetryPolicy::LOCKSTEP, 1)
}

#[test]
#[ignore = "needs QEMU and the thumb target"]
fn the_emulated_chip_gives_the_same_commands_as_a_call() {
    let image = image();
    let mut link = board(&image);
    assert_eq!(
        digest_of(&mut link, STEPS),
        digest_of(&mut Direct::new(), STEPS)
    );
    let stats = link.end().stats();
    assert_eq!((stats.dropped, stats.crc_errors), (0, 0), "{stats:?}");
    assert!(
        !link.take_log().is_empty(),
        "the log has its boot and start"
    );
}

#[test]
#[ignore = "needs QEMU and the thumb target"]
fn a_pty_gives_the_same_commands_as_a_call() {
    let image = image();
    let board = PtyBoard::start(&image).unwrap();
    let mut link = serial::serial(board.device(), fieldline_protocol::BAUD).unwrap();
    assert_eq!(
        digest_of(&mut link, STEPS),
        digest_of(&mut Direct::new(), STEPS)
    );
}

#[test]
#[ignore = "needs QEMU and the thumb target"]
fn byte_faults_to_the_emulated_chip_change_no_command() {
    let image = image();
    let faults = "drop=0.02,duplicate=0.02,corrupt=0.02,truncate=0.01,delay=0.05".parse();
    let line = Faulty::new(qemu::open_line(&image).unwrap(), faults.unwrap(), 7);
    // A lost frame costs wall-clock time here. On a loaded machine other frames are repeated too.
    let policy = RetryPolicy {
        attempt: Duration::from_millis(400),
        attempts: 40,
        ..RetryPolicy::LOCKSTEP
    };
    let mut link = Endpoint::new(line, policy, 1);
    assert_eq!(
        digest_of(&mut link, STEPS),
        digest_of(&mut Direct::new(), STEPS)
    );
    assert!(link.end().stats().retries > 0);
}

#[cfg(feature = "logs")]
#[test]
#[ignore = "needs QEMU and the thumb target"]
fn the_log_is_decoded_with_the_image() {
    let image = image();
    let mut link = board(&image);
    Robot::new().run(&mut link, 1).unwrap();
    let mut decoder = host_sim::link::logs::Decoder::of(&image).unwrap();
    let lines = decoder.lines(&link.take_log());
    let text = lines.join("\n");
    assert!(
        text.contains("INFO boot number 1 (firmware/device/src/session.rs:"),
        "{text}"
    );
    assert!(
        text.contains("INFO session started: 2 lasers, radius 300 mm"),
        "{text}"
    );
}

/// Two runs of the same observations cost the same instructions in every step: the emulator counts
/// them.
#[test]
#[ignore = "needs QEMU and the thumb target"]
fn costs_are_exact() {
    let image = image();
    let costs = || {
        let mut link = board(&image);
        let mut robot = Robot::new();
        link.control(&Control::Start(start())).unwrap();
        let mut costs = Vec::new();
        for _ in 0..10 {
            let cost = link.observe(&robot.sense()).unwrap().cost;
            assert!(cost.instructions > 100, "{cost:?}");
            assert!((512..=16 * 1024).contains(&cost.stack_bytes), "{cost:?}");
            costs.push(cost.instructions);
            robot.wait();
        }
        costs
    };
    assert_eq!(costs(), costs());
}

#[test]
#[ignore = "needs QEMU and the thumb target"]
fn a_reset_reboots_the_chip_and_is_counted() {
    let image = image();
    let mut link = board(&image);
    assert_eq!(link.hello().unwrap().boots, 1);
    assert_eq!(link.control(&Control::Reset).unwrap(), Status::Idle);
    let identity = link.hello().unwrap();
    assert_eq!((identity.boots, identity.crash), (2, None));
}

/// The test image crashes in its third step: first by a panic, then by a bus fault, then by a stack
/// overflow.
#[test]
#[ignore = "needs QEMU and the thumb target"]
fn every_crash_is_reported_and_remembered() {
    let arguments = ["--bin", "fieldline-crash-test", "--features", "crash-test"];
    let image = image::build(&arguments).expect("the test image builds");
    let mut line = qemu::open_line(&image).unwrap();
    for (boots, cause, words) in [
        (1, Cause::Panic, "panic at "),
        (2, Cause::Fault, "processor fault at 0x080"),
        (3, Cause::StackOverflow, "stack overflow"),
    ] {
        let mut link = Endpoint::new(&mut line, RetryPolicy::LOCKSTEP, boots);
        assert_eq!(link.hello().unwrap().boots, boots);
        let mut robot = Robot::new();
        let LinkError::Crashed(place) = robot.run(&mut link, 5).unwrap_err() else {
            panic!("no crash in boot {boots}");
        };
        assert_eq!(robot.steps, 2);
        assert!(place.starts_with(words), "{place}");
        assert!(
            boots > 1 || place.contains("src/image/crash.rs:"),
            "{place}"
        );
        let mut after = Endpoint::new(&mut line, RetryPolicy::LOCKSTEP, 10 + boots);
        let identity = after.hello().unwrap();
        assert_eq!(identity.boots, boots + 1);
        assert_eq!(identity.crash.map(|crash| crash.cause), Some(cause));
    }
}

#[test]
fn a_missing_image_is_named() {
    let nothing = std::env::temp_dir().join("fieldline-no-image");
    let error = qemu::open_line(&nothing)
        .err()
        .map(|error| error.to_string());
    assert!(error.is_some_and(|error| error.contains("fieldline-no-image")));
}

/// QEMU ends on a file that it cannot run; the error has its last line.
#[test]
#[ignore = "needs QEMU and the thumb target"]
fn an_emulator_that_ends_is_named() {
    let nonsense = std::env::temp_dir().join(format!("fieldline-nonsense-{}", std::process::id()));
    std::fs::write(&nonsense, vec![0; 2_000_000]).unwrap();
    let opened = qemu::open_line(&nonsense);
    let error = opened.and_then(|line| {
        Endpoint::new(line, RetryPolicy::LOCKSTEP, 1)
            .hello()
            .map(|_| ())
    });
    std::fs::remove_file(&nonsense).unwrap();
    let error = error.unwrap_err().to_string();
    assert!(error.contains("qemu-system-arm ended"), "{error}");
}

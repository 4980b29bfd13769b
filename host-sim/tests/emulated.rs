//! The image in the emulator: the same commands as a direct call, exact costs, reboots and crashes.
//!
//! If QEMU or the thumb target is missing, these tests print what to install and pass. With
//! `FIELDLINE_HIL=1` they fail instead, and with `FIELDLINE_HIL=0` they do nothing.
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

/// The image, or `None` with a printed reason if it cannot be built or run here.
fn available(built: impl FnOnce() -> Result<PathBuf, LinkError>) -> Option<PathBuf> {
    let wanted = std::env::var("FIELDLINE_HIL").unwrap_or_default();
    if wanted == "0" {
        println!("skipped: FIELDLINE_HIL=0");
        return None;
    }
    let tried = built().and_then(|image| qemu::open_line(&image).map(|_| image));
    match tried {
        Ok(image) => Some(image),
        Err(error) if wanted == "1" => panic!("{error}"),
        Err(error) => {
            println!("skipped: {error}");
            None
        }
    }
}

fn board(image: &std::path::Path) -> Endpoint<QemuLine> {
    let line = qemu::open_line(image).expect("it started before");
    Endpoint::new(line, RetryPolicy::LOCKSTEP, 1)
}

#[test]
fn the_emulated_chip_gives_the_same_commands_as_a_call() {
    let Some(image) = available(image::image) else {
        return;
    };
    let mut link = board(&image);
    assert_eq!(
        digest_of(&mut link, STEPS),
        digest_of(&mut Direct::new(), STEPS)
    );
    let stats = link.stats();
    assert_eq!((stats.dropped, stats.crc_errors), (0, 0), "{stats:?}");
    assert!(
        !link.take_log().is_empty(),
        "the log has its boot and start"
    );
}

#[test]
fn a_pty_gives_the_same_commands_as_a_call() {
    let Some(image) = available(image::image) else {
        return;
    };
    let board = PtyBoard::start(&image).unwrap();
    let mut link = serial::serial(board.device(), fieldline_protocol::BAUD).unwrap();
    assert_eq!(
        digest_of(&mut link, STEPS),
        digest_of(&mut Direct::new(), STEPS)
    );
}

#[test]
fn byte_faults_to_the_emulated_chip_change_no_command() {
    let Some(image) = available(image::image) else {
        return;
    };
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
    assert!(link.stats().retries > 0);
}

#[cfg(feature = "logs")]
#[test]
fn the_log_is_decoded_with_the_image() {
    let Some(image) = available(image::image) else {
        return;
    };
    let mut link = board(&image);
    Robot::new().run(&mut link, 1).unwrap();
    let mut decoder = host_sim::link::logs::Decoder::of(&image).unwrap();
    let lines = decoder.lines(&link.take_log());
    let text = lines.join("\n");
    assert!(
        text.contains("INFO boot 1 (firmware/device/src/session.rs:"),
        "{text}"
    );
    assert!(
        text.contains("INFO start: box 20 x 20 tiles, 2 lasers, radius 300 mm"),
        "{text}"
    );
}

/// Two runs of the same observations cost the same instructions in every step: the emulator counts
/// them.
#[test]
fn costs_are_exact() {
    let Some(image) = available(image::image) else {
        return;
    };
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
fn a_reset_reboots_the_chip_and_is_counted() {
    let Some(image) = available(image::image) else {
        return;
    };
    let mut link = board(&image);
    assert_eq!(link.hello().unwrap().boots, 1);
    assert_eq!(link.control(&Control::Reset).unwrap(), Status::Idle);
    let identity = link.hello().unwrap();
    assert_eq!((identity.boots, identity.crash), (2, None));
}

/// The test image crashes in its third step: first by a panic, then by a bus fault, then by a stack
/// overflow.
#[test]
fn every_crash_is_reported_and_remembered() {
    let arguments = ["--bin", "fieldline-crash-test", "--features", "crash-test"];
    let Some(image) = available(|| image::build(&arguments)) else {
        return;
    };
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
fn an_emulator_that_ends_is_named() {
    let Some(_) = available(image::image) else {
        return;
    };
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

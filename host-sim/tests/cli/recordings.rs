//! `explore --record FILE.mcap`, and `replay FILE.mcap`: the run is the same, the file is whole or
//! readable up to its cut, and a device does it again.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

use mcap::read::Options;
use serde_json::Value;
use tempfile::TempDir;

use crate::refusals::refused;
use crate::replay::with_log;
use crate::{folder, outcome, reports};

/// A run of a minute.
const RUN: [&str; 7] = [
    "explore",
    "office",
    "--seed",
    "4",
    "--time-limit",
    "60",
    "--json",
];

/// Makes the run with more options; returns its digest.
fn run(folder: &TempDir, more: &[&str]) -> String {
    let (_, stdout, stderr) = outcome(folder, &[&RUN[..], more].concat());
    let reports = reports(&stdout);
    let [report] = reports.as_slice() else {
        panic!("one report: {stderr}");
    };
    report["digest"].as_str().expect("a digest").to_owned()
}

fn file(folder: &TempDir) -> PathBuf {
    folder.path().join("run.mcap")
}

fn recorded(more: &[&str]) -> (TempDir, String) {
    let folder = folder();
    let digest = run(&folder, &[&["--record", "run.mcap"], more].concat());
    (folder, digest)
}

fn replayed(folder: &TempDir, name: &str, more: &[&str]) -> (i32, Value, String) {
    let (status, stdout, stderr) = outcome(folder, &[&["replay", name, "--json"], more].concat());
    let replayed = serde_json::from_str(&stdout).unwrap_or(Value::Null);
    (status, replayed, stderr)
}

/// Returns the number of messages of each topic, and of bytes that could be read.
fn topics(bytes: &[u8]) -> BTreeMap<String, usize> {
    let mut topics = BTreeMap::new();
    let stream = mcap::MessageStream::new_with_options(bytes, Options::IgnoreEndMagic.into());
    for message in stream.expect("a head").map_while(Result::ok) {
        *topics.entry(message.channel.topic.clone()).or_default() += 1;
    }
    topics
}

#[test]
fn a_recorded_run_is_the_same_and_a_device_does_it_again() {
    let (folder, digest) = recorded(&[]);
    assert_eq!(run(&folder, &[]), digest, "without a recording");
    let bytes = fs::read(file(&folder)).expect("a file");
    let summary = mcap::Summary::read(&bytes).expect("whole").expect("an end");
    assert_eq!(summary.attachment_indexes.len(), 1, "the report");

    let topics = topics(&bytes);
    let steps = topics["/scan"];
    assert!((290..=301).contains(&steps), "{steps}");
    for topic in [
        "/scan_2",
        "/odom",
        "/tf",
        "/pose",
        "/true_pose",
        "/cmd_vel",
        "/coverage",
        "/fieldline/step",
    ] {
        assert_eq!(topics[topic], steps, "{topic}");
    }
    for (topic, least) in [("/map", 10), ("/plan", 10), ("/field", 50), ("/rosout", 1)] {
        assert!(topics[topic] >= least, "{topic}: {}", topics[topic]);
    }
    assert!(topics["/fieldline/request"] > steps);
    assert_eq!(topics["/fieldline/reply"], topics["/fieldline/request"]);

    for link in ["direct", "loopback"] {
        let (status, replayed, stderr) = replayed(&folder, "run.mcap", &["--link", link]);
        assert_eq!((status, stderr.as_str()), (0, ""), "{link}");
        assert_eq!(replayed["now"], digest, "{link}");
        assert_eq!(replayed["commands"], steps, "{link}");
    }
}

/// The device's map is corrected, and a reset gets it its map back: all that the session is told.
#[test]
fn corrections_and_resets_are_done_again() {
    for more in [
        &[
            "--odometry",
            "papers",
            "--slam",
            "host",
            "--strategy",
            "ouroboros",
        ][..],
        &["--fault", "reset@40", "--resume"],
        &["--ground", "uneven"],
    ] {
        let (folder, digest) = recorded(more);
        let (status, replayed, stderr) = replayed(&folder, "run.mcap", &[]);
        assert_eq!((status, stderr.as_str()), (0, ""), "{more:?}");
        assert_eq!(replayed["now"], digest, "{more:?}");
    }
}

/// Robots that talk over a bad radio, one of which leaves and joins again.
#[test]
fn each_robot_of_a_team_is_recorded_and_done_again() {
    const TEAM: &str = "team hall --odometry noisy --start-error 0.3,5 --radio loss=0.2 \
                        --leave 1@10 --join 1@20 --time-limit 40 --json";
    let folder = folder();
    let run = |more: &[&str]| {
        let words: Vec<&str> = TEAM
            .split_whitespace()
            .chain(more.iter().copied())
            .collect();
        let (_, stdout, stderr) = outcome(&folder, &words);
        let report = reports(&stdout).pop().unwrap_or_else(|| panic!("{stderr}"));
        [0, 1].map(|robot| report["robots"][robot]["digest"].clone())
    };
    let digests = run(&["--record", "team"]);
    assert!(digests[0].is_string(), "{digests:?}");
    assert_eq!(run(&["--force"]), digests, "without a recording");
    for (robot, least) in [(0, 200), (1, 140)] {
        let name = format!("team/robot-{robot}.mcap");
        let bytes = fs::read(folder.path().join(&name)).expect("a file");
        let topics = topics(&bytes);
        assert!(topics["/scan"] >= least, "{name}: {}", topics["/scan"]);
        assert!(topics["/map"] > 1, "{name}: {}", topics["/map"]);
        let (status, replayed, stderr) = replayed(&folder, &name, &[]);
        assert_eq!((status, stderr.as_str()), (0, ""), "{name}");
        assert!(replayed["commands"].as_u64() >= Some(least as u64));
    }
    let again: Vec<&str> = TEAM
        .split_whitespace()
        .chain(["--out", "o", "--record", "team"])
        .collect();
    refused(&folder, &again, &["robot-0.mcap", "--force"]);
}

/// A log has no truth, and no world of which a share is known.
#[test]
fn a_replayed_log_is_recorded_and_done_again() {
    let folder = with_log(180);
    let replay = |more: &[&str]| {
        let words = [
            "replay",
            "a.log",
            "--degrade",
            "4",
            "--json",
            "--out",
            "out",
        ];
        let (status, stdout, stderr) = outcome(&folder, &[&words[..], more].concat());
        assert_eq!(status, 0, "{stderr}");
        let mut report = reports(&stdout).pop().expect("a report");
        report["made_by"] = Value::Null;
        report
    };
    let plain = replay(&[]);
    assert_eq!(replay(&["--record", "log.mcap"]), plain);
    let topics = topics(&fs::read(folder.path().join("log.mcap")).expect("a file"));
    for topic in ["/scan", "/odom", "/pose"] {
        assert_eq!(topics[topic], 60, "{topic}");
    }
    assert!(topics["/map"] > 1);
    assert!(!topics.contains_key("/true_pose") && !topics.contains_key("/coverage"));
    let (status, again, stderr) = replayed(&folder, "log.mcap", &["--link", "direct"]);
    assert_eq!((status, stderr.as_str()), (0, ""));
    assert_eq!(again["commands"], 60);
    let is_there = ["replay", "a.log", "--record", "log.mcap"];
    refused(&folder, &is_there, &["log.mcap", "--force"]);
    let twice = ["replay", "log.mcap", "--record", "two.mcap"];
    refused(&folder, &twice, &["--record", "recording"]);
}

#[test]
fn another_device_is_told_from_the_recorded_one() {
    let (folder, _) = recorded(&[]);
    let tuned = ["--tune", "map.free_count=3", "--link", "direct"];
    let (status, replayed, stderr) = replayed(&folder, "run.mcap", &tuned);
    assert_eq!(status, 1, "{stderr}");
    assert!(replayed["differs_at_ms"].as_u64().is_some(), "{replayed}");
    assert_ne!(replayed["now"], replayed["recorded"]);
}

/// A run that is killed leaves such a file.
#[test]
fn a_file_that_is_cut_anywhere_is_readable_up_to_the_cut() {
    let (folder, _) = recorded(&[]);
    let bytes = fs::read(file(&folder)).expect("a file");
    let whole = topics(&bytes)["/scan"];
    let mut before = 0;
    // Beyond the cut at most one chunk of ten seconds is lost.
    for part in 1..=40 {
        let cut = &bytes[..bytes.len() * part / 40];
        let seen = topics(cut).get("/scan").copied().unwrap_or(0);
        assert!(seen >= before, "part {part}: {seen} after {before}");
        let least = (whole * part / 40).saturating_sub(60 + whole / 20);
        assert!(seen >= least, "part {part}: {seen} of {least}");
        before = seen;
    }
    let half = folder.path().join("half.mcap");
    fs::write(&half, &bytes[..bytes.len() / 2]).expect("a file");
    let (status, replayed, stderr) = replayed(&folder, "half.mcap", &[]);
    assert_eq!(status, 0, "{stderr}");
    assert!(stderr.contains("the file was cut"), "{stderr}");
    assert!(replayed["commands"].as_u64().is_some_and(|it| it > 50));
}

#[test]
fn what_cannot_be_recorded_or_replayed_is_refused() {
    let (folder, _) = recorded(&[]);
    let is_there = ["explore", "loop", "--record", "run.mcap"];
    refused(&folder, &is_there, &["run.mcap", "--force"]);
    let two = ["explore", "loop", "hall", "--record", "two.mcap"];
    refused(&folder, &two, &["two.mcap", "one world"]);
    let nowhere = ["explore", "loop", "--record", "no/such/folder.mcap"];
    refused(&folder, &nowhere, &["no/such/folder.mcap"]);
    let log = ["replay", "run.mcap", "--relations", "x"];
    refused(&folder, &log, &["--relations", "recording"]);

    let mut bytes = fs::read(file(&folder)).expect("a file");
    bytes.truncate(8);
    bytes.extend([0; 64]);
    fs::write(folder.path().join("no.mcap"), bytes).expect("a file");
    let (status, _, stderr) = replayed(&folder, "no.mcap", &[]);
    assert_eq!(status, 2, "{stderr}");
    assert!(stderr.contains("no.mcap"), "{stderr}");
}

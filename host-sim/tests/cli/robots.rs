//! Robots and lidars of one's own: presets, robot files, and what is refused.

use core::fmt::Write as _;
use std::fs;

use tempfile::TempDir;

use crate::refusals::refused;
use crate::{folder, outcome, reports};

/// A robot file whose drive ends in line 2 and whose laser has its beams in line 7.
const ROBOT: &str = "\
hull: {radius: 0.2, height: 0.2}
drive: {track: 0.3, speed: 0.5, turn_rate: 90, acceleration: 0.4, turn_acceleration: 90}
lasers:
  - x: 0
    y: 0
    z: 0.2
    beams: 450
    field: 360
    range: 12
    upside_down: true
";

fn with_robot(text: &str) -> TempDir {
    let folder = folder();
    fs::write(folder.path().join("my.yaml"), text).unwrap();
    folder
}

/// Explores for ten seconds; returns the report.
fn ten_seconds(folder: &TempDir, more: &[&str]) -> serde_json::Value {
    let usual = "explore office --link direct --time-limit 10 --json --force";
    let words: Vec<&str> = usual.split(' ').chain(more.iter().copied()).collect();
    let (status, stdout, stderr) = outcome(folder, &words);
    assert_eq!(status, 1, "{more:?}: {stderr}");
    reports(&stdout)[0].clone()
}

#[test]
fn presets_are_listed_and_printed_as_robot_files() {
    let folder = folder();
    let (status, stdout, _) = outcome(&folder, &["robots", "--json"]);
    assert_eq!(status, 0);
    let presets = reports(&stdout);
    assert_eq!(presets.len(), 5);
    for preset in &presets {
        let name = preset["name"].as_str().unwrap();
        let (status, yaml, _) = outcome(&folder, &["robots", name]);
        assert_eq!(status, 0);
        fs::write(folder.path().join("printed.yaml"), yaml).unwrap();
        let by_name = ten_seconds(&folder, &["--robot", name]);
        let by_file = ten_seconds(&folder, &["--robot", "printed.yaml"]);
        assert_eq!(by_name["digest"], by_file["digest"], "{name}");
        assert_eq!(by_file["robot_name"], "printed");
    }
    let (_, text, _) = outcome(&folder, &["robots"]);
    assert_eq!(text.lines().count(), 5);
    refused(&folder, &["robots", "r2d2"], &["r2d2", "turtlebot3-burger"]);
}

#[test]
fn the_usual_robot_is_the_default_and_has_no_key() {
    let folder = folder();
    let usual = ten_seconds(&folder, &[]);
    let named = ten_seconds(&folder, &["--robot", "pioneer-3at"]);
    assert_eq!(usual["digest"], named["digest"]);
    assert!(usual.get("robot_name").is_none() && named.get("robot_name").is_none());
}

#[test]
fn a_robot_file_and_a_sweep_change_the_run() {
    let folder = with_robot(ROBOT);
    let usual = ten_seconds(&folder, &[]);
    let own = ten_seconds(&folder, &["--robot", "my.yaml"]);
    let swept = ten_seconds(&folder, &["--laser", "-135,0.5,541,12"]);
    assert_eq!(own["robot_name"], "my");
    assert_ne!(own["digest"], usual["digest"]);
    assert_ne!(swept["digest"], usual["digest"]);
    for report in [&own, &swept] {
        assert_eq!(report["safety"]["collisions"], 0);
        assert!(report["coverage"]["fraction"].as_f64().unwrap() > 0.2);
    }
}

#[test]
fn a_team_has_the_robot_too() {
    let folder = with_robot(ROBOT);
    let line = "team office --robots 2 --time-limit 5 --json --robot my.yaml";
    let words: Vec<&str> = line.split(' ').collect();
    let (status, stdout, stderr) = outcome(&folder, &words);
    assert_eq!(status, 1, "{stderr}");
    assert!(reports(&stdout)[0]["safety"]["collisions"] == 0, "{stdout}");
}

#[test]
fn bad_robots_are_refused_in_one_line() {
    for (text, words) in [
        (ROBOT.replace("450", "3"), ["my.yaml:7:", "4 to 4096"]),
        (ROBOT.replace("track", "trak"), ["my.yaml:2:", "trak"]),
        (ROBOT.replace("0.4", "0.1"), ["my.yaml:2:", "acceleration"]),
    ] {
        let folder = with_robot(&text);
        refused(&folder, &["explore", "--robot", "my.yaml"], &words);
        refused(&folder, &["team", "--robot", "my.yaml"], &words);
    }
    let folder = with_robot(ROBOT);
    for (arguments, words) in [
        (
            vec!["--robot", "none.yaml"],
            vec!["none.yaml", "pioneer-3dx"],
        ),
        (vec!["--laser", "0,1,360"], vec!["FIRST,STEP,BEAMS,RANGE"]),
        (vec!["--laser", "0,2,360,8"], vec!["less than a turn"]),
        (
            vec!["--robot", "my.yaml", "--ground", "uneven"],
            vec!["second laser", "--ground flat"],
        ),
    ] {
        refused(&folder, &[vec!["explore"], arguments].concat(), &words);
    }
}

/// A log of a robot that stands in a square room of 6 m, with a lidar all round.
fn log(beams: usize) -> String {
    let mut out = String::new();
    for step in 0..30 {
        write!(out, "FLASER {beams}").unwrap();
        for beam in 0..beams {
            let bearing = core::f64::consts::TAU * beam as f64 / beams as f64;
            let range = 3.025 / bearing.cos().abs().max(bearing.sin().abs());
            write!(out, " {range:.3}").unwrap();
        }
        let time = 0.2 * f64::from(step);
        writeln!(out, " 0 0 0 0 0 0 {time} host {time}").unwrap();
    }
    out
}

#[test]
fn a_log_is_replayed_with_the_lidar_that_made_it() {
    let folder = with_robot(ROBOT);
    fs::write(folder.path().join("a.log"), log(451)).unwrap();
    let replay = |more: &[&str]| {
        let usual = ["replay", "a.log", "--link", "direct", "--json", "--force"];
        let (status, stdout, stderr) = outcome(&folder, &[&usual[..], more].concat());
        assert_eq!(status, 0, "{stderr}");
        reports(&stdout)[0]["occupied_cells_5cm"].as_u64().unwrap()
    };
    // The walls are in the middle of cells, and have 484 of them. Half a turn folds the room.
    let own = replay(&["--robot", "my.yaml"]);
    assert!((300..=600).contains(&own), "{own}");
    assert_ne!(own, replay(&["--laser", "-90,0.4,451,12"]));
    let words = ["451 beams", "--laser -180,", "--robot FILE"];
    refused(&folder, &["replay", "a.log"], &words);
    let usual = ["replay", "a.log", "--robot", "pioneer-3at"];
    refused(&folder, &usual, &["451", "181", "beams: 451"]);
}

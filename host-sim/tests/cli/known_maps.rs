//! `explore --known MAP.yaml`: a saved map is known space from the first step on.

use std::fs;
use std::path::Path;

use serde_json::Value;
use tempfile::TempDir;

use crate::refusals::refused;
use crate::{folder, outcome, reports};

/// Grey of an unknown pixel.
const UNKNOWN: u8 = 205;

/// Explores the office and keeps its map in the folder `all`.
fn explored() -> (TempDir, Value) {
    let folder = folder();
    let report = explore(&folder, &["--out", "all"]);
    assert_eq!(report["outcome"]["reason"], "explored");
    (folder, report)
}

fn explore(folder: &TempDir, more: &[&str]) -> Value {
    let usual = ["explore", "office", "--json", "--force"];
    let (status, stdout, stderr) = outcome(folder, &[&usual[..], more].concat());
    assert!(status < 2, "{stderr}");
    reports(&stdout).remove(0)
}

/// Copies the map of `all` into a folder, with its pixels changed. They come row by row from the
/// greatest y.
fn changed(folder: &Path, name: &str, change: impl Fn([usize; 2], u8) -> u8) {
    let (from, to) = (folder.join("all"), folder.join(name));
    fs::create_dir_all(&to).unwrap();
    fs::copy(from.join("map.yaml"), to.join("map.yaml")).unwrap();
    let mut pgm = fs::read(from.join("map.pgm")).unwrap();
    let header = pgm.iter().enumerate().filter(|(_, byte)| **byte == b'\n');
    let header = header.map(|(at, _)| at + 1).nth(2).expect("three lines");
    let text = String::from_utf8(pgm[..header].to_vec()).unwrap();
    let width: usize = text.split_whitespace().nth(1).unwrap().parse().unwrap();
    for (k, pixel) in pgm[header..].iter_mut().enumerate() {
        *pixel = change([k % width, k / width], *pixel);
    }
    fs::write(to.join("map.pgm"), pgm).unwrap();
}

fn time_s(report: &Value) -> f64 {
    report["sim_time_s"].as_f64().expect("seconds")
}

fn coverage(report: &Value) -> f64 {
    report["coverage"]["fraction"].as_f64().expect("a share")
}

#[test]
fn a_robot_that_knows_all_has_explored_at_once_and_drives_to_a_goal_and_home() {
    let (folder, all) = explored();
    let known = explore(&folder, &["--known", "all/map.yaml"]);
    assert_eq!(known["outcome"]["reason"], "explored");
    assert!(time_s(&known) < 5.0, "{}", time_s(&known));
    assert!(
        coverage(&known) > 0.995 && coverage(&all) > 0.995,
        "{}",
        coverage(&known)
    );
    assert_eq!(known["known"]["file"], "all/map.yaml");
    assert!(known["known"]["tiles"].as_u64().expect("a number") > 10);
    // The copy of the map that host keeps is the device's.
    assert_eq!(known["debug"]["map_matches_mirror"], true);
    let same = explore(&folder, &["--known", "all/map.yaml", "--link", "direct"]);
    assert_eq!(same["digest"], known["digest"]);

    let tour = ["--known", "all/map.yaml", "--goto=8,5", "--then=home"];
    let tour = explore(&folder, &tour);
    let trips = tour["trips"].as_array().expect("trips");
    assert_eq!(trips.len(), 2);
    assert!(
        trips.iter().all(|trip| trip["reached"] == true),
        "{trips:?}"
    );
}

#[test]
fn a_robot_that_knows_a_half_explores_the_other_one_in_less_time() {
    let (folder, all) = explored();
    changed(
        folder.path(),
        "half",
        |[x, _], pixel| {
            if x > 125 { UNKNOWN } else { pixel }
        },
    );
    fs::write(
        folder.path().join("half/mission.toml"),
        "known = \"map.yaml\"\n",
    )
    .unwrap();
    let half = explore(&folder, &["--mission", "half/mission.toml"]);
    assert_eq!(half["outcome"]["reason"], "explored");
    assert!(coverage(&half) > 0.99, "{}", coverage(&half));
    let (half_s, all_s) = (time_s(&half), time_s(&all));
    assert!(half_s > 5.0 && half_s < 0.8 * all_s, "{half_s} {all_s}");
    assert_eq!(half["safety"]["collisions"], 0);
    // The frame of a file may be any, if the robot's pose in it is told.
    let yaml = fs::read_to_string(folder.path().join("half/map.yaml")).unwrap();
    let origin = yaml
        .lines()
        .find(|line| line.starts_with("origin"))
        .expect("an origin");
    let numbers = origin.split(['[', ']']).nth(1).expect("numbers");
    let numbers: Vec<f64> = numbers
        .split(',')
        .map(|it| it.trim().parse().unwrap())
        .collect();
    // A quarter turn about the frame's origin, then 100 m east.
    let moved = format!(
        "origin: [{}, {}, {}]",
        100.0 - numbers[1],
        numbers[0],
        core::f64::consts::FRAC_PI_2
    );
    fs::write(
        folder.path().join("half/turned.yaml"),
        yaml.replace(origin, &moved),
    )
    .unwrap();
    let start = explore(&folder, &["--known", "half/map.yaml", "--time-limit", "1"]);
    let start = &start["known"];
    let turned = ["--known", "half/turned.yaml", "--known-pose=93,12,90"];
    let turned = explore(&folder, &turned);
    assert_eq!(turned["outcome"]["reason"], "explored");
    let area = |known: &Value| known["known_m2"].as_f64().expect("square metres");
    let (plain_m2, turned_m2) = (area(start), area(&turned["known"]));
    assert!(
        (plain_m2 - turned_m2).abs() < 0.02 * plain_m2,
        "{plain_m2} {turned_m2}"
    );
    assert!(time_s(&turned) < 0.8 * all_s, "{}", time_s(&turned));
}

/// A run that goes on after a kill has the known map as well.
#[test]
fn a_run_with_a_known_map_goes_on() {
    let (folder, _) = explored();
    changed(
        folder.path(),
        "half",
        |[x, _], pixel| {
            if x > 125 { UNKNOWN } else { pixel }
        },
    );
    let known = ["--known", "half/map.yaml"];
    let first = [&known[..], &["--out", "run", "--time-limit", "12"]].concat();
    assert_eq!(explore(&folder, &first)["outcome"]["status"], "time-limit");
    let on = explore(&folder, &[&known[..], &["--resume", "run"]].concat());
    assert_eq!(on["outcome"]["reason"], "explored");
    assert!(coverage(&on) > 0.99, "{}", coverage(&on));
}

#[test]
fn what_cannot_be_known_is_refused_in_one_line() {
    let (folder, _) = explored();
    changed(folder.path(), "blank", |_, _| UNKNOWN);
    let all = "all/map.yaml";
    for (arguments, words) in [
        (&["--known", "none.yaml"][..], "cannot read this map"),
        (&["--known", "blank/map.yaml"], "every pixel is unknown"),
        (
            &["--known", all, "--known-pose=90,0,0"],
            "lies outside of the known part",
        ),
        (&["--known", all, "--known-pose=1,2"], "give x,y,degrees"),
        (&["--known-pose=1,2,3"], "give the map with --known"),
        (&["--known", all, "--ground", "uneven"], "no heights"),
        (&["--known", all, "--slam", "host"], "--slam off"),
        (&["--known", all, "--strategy", "bvp"], "runs on the host"),
        (
            &[
                "--known",
                all,
                "--team",
                "id=1,bind=127.0.0.1:0,peers=127.0.0.1:9",
            ],
            "a robot alone",
        ),
    ] {
        let arguments = [&["explore", "office"], arguments].concat();
        refused(&folder, &arguments, &[words]);
    }
}

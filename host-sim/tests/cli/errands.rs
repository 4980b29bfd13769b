//! What a robot does beside exploring: bounds, goals, the way home, a budget; and the log of it.

use std::fs;

use serde_json::Value;

use crate::{folder, outcome, reports};

#[test]
fn a_robot_keeps_to_its_bounds_drives_to_a_goal_and_home() {
    let folder = folder();
    let args = [
        "explore",
        "office",
        "--json",
        "--bounds=6,3,18,11",
        "--no-go=13.5,8,14.5,9",
        "--goto=8,5",
        "--then=home",
    ];
    let (status, stdout, stderr) = outcome(&folder, &args);
    assert_eq!(status, 0, "{stderr}");
    let report: Value = serde_json::from_str(&stdout).expect("one report");
    assert_eq!(report["outcome"]["reason"], "explored");
    assert!(report["fence"]["deepest_m"].as_f64().expect("metres") < 0.1);
    let trips = report["trips"].as_array().expect("two trips");
    let to: Vec<&Value> = trips.iter().map(|trip| &trip["to"]).collect();
    assert_eq!(to, ["goal", "home"]);
    for trip in trips {
        assert_eq!(trip["reached"], true, "{trip}");
        assert!(trip["error_m"].as_f64().expect("metres") <= 0.2, "{trip}");
    }
    assert!(trips[1]["error_deg"].as_f64().expect("degrees") <= 10.0);
}

#[test]
fn a_robot_with_a_budget_is_home_before_it_is_spent() {
    let folder = folder();
    let args = ["explore", "office", "--json", "--range-m=40"];
    let (status, stdout, stderr) = outcome(&folder, &args);
    assert_eq!(status, 1, "{stderr}");
    let report: Value = serde_json::from_str(&stdout).expect("one report");
    assert_eq!(report["outcome"]["reason"], "at-home");
    assert_eq!(report["trips"][0]["reached"], true);
    let driven_m = report["path_length_m"].as_f64().expect("metres");
    assert!((20.0..=40.0).contains(&driven_m), "{driven_m}");
}

/// The log tells the end and its reasons. Printed lines, file and report are one, on every link.
#[test]
fn the_log_of_the_mission_is_printed_and_kept() {
    let folder = folder();
    let log = |link: &str| {
        let arguments = [
            "explore",
            "unreachable-room",
            "--link",
            link,
            "--out",
            link,
            "--log",
            "mission",
            "--json",
        ];
        let (status, stdout, stderr) = outcome(&folder, &arguments);
        assert_eq!(status, 0, "{stderr}");
        let kept = fs::read_to_string(folder.path().join(link).join("mission.log"));
        let kept = kept.expect("a log");
        let printed: Vec<&str> = stderr.lines().filter(|it| it.contains(" s  (")).collect();
        assert_eq!(printed, kept.lines().collect::<Vec<_>>());
        let report = reports(&stdout).remove(0);
        let entries = report["mission"].as_array().expect("entries");
        assert_eq!(entries.len(), kept.lines().count().min(20));
        kept
    };
    let told = log("direct");
    assert_eq!(told, log("loopback"));
    let last = told.lines().last().expect("a line");
    assert!(last.ends_with("finished(explored)"), "{told}");
    let why = "nothing is left to drive to, so it goes to look through a gap";
    assert!(told.contains(why), "{told}");
}

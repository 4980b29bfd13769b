//! `explore --mission FILE`: the page's sample, what is said twice, and faults with their line.

use std::fs;

use crate::refusals::refused;
use crate::{folder, outcome, reports};

/// Returns the mission file of docs/MISSIONS.md.
fn sample() -> &'static str {
    let page = include_str!("../../../docs/MISSIONS.md");
    let block = page.split("```toml\n").nth(1).expect("a sample");
    block.split("```").next().expect("its end")
}

#[test]
fn the_sample_of_the_page_runs_and_the_report_has_its_text() {
    let folder = folder();
    fs::write(folder.path().join("mission.toml"), sample()).unwrap();
    let arguments = ["explore", "office", "--link", "direct", "--json"];
    let with = |more: &[&str]| {
        let arguments = [&arguments[..], more].concat();
        let (status, stdout, stderr) = outcome(&folder, &arguments);
        assert!(status < 2, "{stderr}");
        reports(&stdout).remove(0)
    };
    let report = with(&["--mission", "mission.toml"]);
    let reached = report["trips"].as_array().expect("trips").iter();
    let reached: Vec<_> = reached.map(|it| (&it["to"], &it["reached"])).collect();
    assert_eq!(reached.len(), 2, "{reached:?}");
    assert!(
        reached.iter().all(|(_, reached)| *reached == true),
        "{reached:?}"
    );
    assert_eq!(report["made_by"]["options"]["mission-text"], sample());
    assert!(report["fence"]["deepest_m"].as_f64().unwrap() < 0.2);
    // The options that mean the same make the same run.
    let same = with(&[
        "--bounds",
        "4,2,20,2,20,12,4,12",
        "--no-go",
        "13.5,8,14.5,9",
        "--goto",
        "15,7",
        "--then",
        "home",
        "--time-s",
        "600",
        "--pause",
        "20-30",
    ]);
    assert_eq!(same["digest"], report["digest"]);
}

#[test]
fn faults_of_a_mission_file_are_told_in_one_line() {
    let folder = folder();
    let path = folder.path().join("m.toml");
    for (text, more, words) in [
        (
            "\nrange = 30",
            &[][..],
            &["m.toml:2", "did you mean range_m?"][..],
        ),
        ("then = \"hom\"", &[], &["m.toml:1", "give \"home\""]),
        (
            "range_m = 30",
            &["--range-m", "40"],
            &["m.toml:1", "range_m", "--range-m", "leave one of them out"],
        ),
        ("time_s = 30", &["--strategy", "bvp"], &["takes no orders"]),
        ("no_go_m = [[[0, 0], [24, 14]]]", &[], &["no-go polygon"]),
    ] {
        fs::write(&path, text).unwrap();
        let arguments = [&["explore", "office", "--mission", "m.toml"], more].concat();
        refused(&folder, &arguments, words);
    }
    refused(
        &folder,
        &["explore", "--mission", "none.toml"],
        &["none.toml", "cannot read"],
    );
}

/// At the time the robot goes home, whatever is left to explore.
#[test]
fn a_robot_that_is_to_be_home_by_a_time_goes_home() {
    let folder = folder();
    let (status, stdout, stderr) = outcome(
        &folder,
        &[
            "explore",
            "office",
            "--link",
            "direct",
            "--json",
            "--home-at",
            "40",
            "--pause",
            "5-15",
        ],
    );
    assert_eq!(status, 1, "{stderr}");
    let report = reports(&stdout).remove(0);
    assert_eq!(report["outcome"]["reason"], "at-home");
    assert_eq!(report["trips"][0]["to"], "home");
    assert_eq!(report["trips"][0]["reached"], true);
    let began_s =
        report["sim_time_s"].as_f64().unwrap() - report["trips"][0]["time_s"].as_f64().unwrap();
    assert!((39.5..45.0).contains(&began_s), "{began_s}");
}

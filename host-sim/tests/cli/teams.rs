//! Runs of a team: their folders and reports.

use serde_json::Value;

use crate::refusals::refused;
use crate::{FILES, files, folder, outcome, reports};

#[test]
fn a_team_takes_the_impatience_of_a_space_field() {
    let folder = folder();
    let impatience = |more: &[&str]| {
        let args = [
            "team",
            "partition@1",
            "--json",
            "--force",
            "--strategy",
            "esbpf",
        ];
        let (_, stdout, _) = outcome(&folder, &[&args, more].concat());
        let report: Value = serde_json::from_str(&stdout).expect("one report");
        report["robots"][0]["space_field"]["impatience"].clone()
    };
    assert_eq!(impatience(&[]), "5");
    assert_eq!(impatience(&["--sbpf-impatience", "never"]), "never");
    assert_eq!(impatience(&["--sbpf-impatience", "20"]), "20");
}

#[test]
fn a_team_leaves_a_folder_of_its_own_and_one_of_each_robot() {
    let folder = folder();
    let arguments = [
        "team",
        "loop",
        "--robots",
        "2",
        "--radio",
        "loss=0.5",
        "--time-limit",
        "20",
        "--json",
    ];
    let (status, stdout, stderr) = outcome(&folder, &arguments);
    assert_eq!(status, 1, "{stderr}");
    let report = &reports(&stdout)[0];
    for key in ["world", "coverage", "digest", "sim_time_s", "planner"] {
        assert!(!report[key].is_null(), "{key}");
    }
    assert_eq!(report["outcome"]["status"], "time-limit");
    assert_eq!(report["link"], "loopback");
    assert_eq!(report["robots"].as_array().unwrap().len(), 2);
    assert_eq!(report["robots"][1]["robot"], 1);
    assert!(report["robots"][1]["digest"].is_string());
    assert!(report["safety"]["robot_contacts"].is_u64());
    assert!(report["radio"]["sent_bytes"].as_u64().unwrap() > 0);
    assert!(report["radio"]["lost"].as_u64().unwrap() > 0);
    let run = folder.path().join("out/loop-frontier-team-2-0");
    let of_team = [
        "map.pgm",
        "map.yaml",
        "report.json",
        "robot-0",
        "robot-1",
        "run.png",
    ];
    assert_eq!(files(&run), of_team);
    assert_eq!(files(&run.join("robot-1")), FILES);
}

#[test]
fn all_robots_of_a_team_keep_to_the_bounds() {
    let folder = folder();
    let team = [
        "team", "office", "--robots", "3", "--json", "--link", "direct",
    ];
    let bounds = ["--bounds=6,3,18,11", "--no-go=13.5,8,14.5,9"];
    let (status, stdout, stderr) = outcome(&folder, &[&team[..], &bounds].concat());
    assert_eq!(status, 0, "{stderr}");
    let report = &reports(&stdout)[0];
    let deepest = |report: &Value| report["fence"]["deepest_m"].as_f64().expect("metres");
    let robots = report["robots"].as_array().expect("robots");
    let each: Vec<f64> = robots.iter().map(deepest).collect();
    assert!(each.iter().all(|it| *it < 0.1), "{each:?}");
    assert_eq!(deepest(report), each.iter().copied().fold(0.0, f64::max));
    assert_eq!(
        report["fence"]["bounds_m"][0]
            .as_array()
            .expect("corners")
            .len(),
        4
    );
    // What lies beyond them is known less.
    assert!(report["coverage"]["fraction"].as_f64().expect("a share") < 0.9);

    let no_room = "where --bounds and --no-go let them stand";
    for (bounds, words) in [
        ("--bounds=0,0,3,3", no_room),
        ("--bounds=11.4,6.4,12.6,7.6", no_room),
        ("--bounds=0,0,9,9,0,9,9,0", "--bounds and --no-go: "),
    ] {
        refused(&folder, &[&team[..], &[bounds]].concat(), &[words]);
    }
    let baseline = ["--strategy", "bvp", "--radio", "off", "--bounds=6,3,18,11"];
    let baseline = ["team", "office"].iter().chain(&baseline).copied();
    refused(&folder, &baseline.collect::<Vec<_>>(), &["knows no bounds"]);
}

/// The second robot is told a wrong start, and finds out how its map lies in the team's.
#[test]
fn a_team_with_rough_starts_reports_what_its_maps_agree_on() {
    let folder = folder();
    let arguments = [
        "team",
        "hall",
        "--link",
        "direct",
        "--odometry",
        "noisy",
        "--start-error",
        "0.3,5",
        "--time-limit",
        "40",
        "--json",
    ];
    let (_, stdout, stderr) = outcome(&folder, &arguments);
    let report = &reports(&stdout).pop().expect(&stderr);
    let team = &report["team"];
    assert_eq!(team["start_error"], serde_json::json!([0.3, 5.0]));
    assert!(report["robots"][1]["met_s"].as_f64().unwrap() > 0.0);
    assert!(team["agreement"]["median_m"].as_f64().unwrap() < 0.1);
    assert!(team["agreement"]["median_deg"].as_f64().unwrap() < 1.0);
}

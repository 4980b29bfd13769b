//! The other commands: the list of worlds, and the solution of one window.

use std::fs;

use fieldline_planner::Tuning;
use serde_json::Value;

use crate::{folder, outcome, reports};

#[test]
fn the_worlds_are_listed_with_their_names() {
    let folder = folder();
    let (status, stdout, stderr) = outcome(&folder, &["worlds", "--json"]);
    assert_eq!((status, stderr.as_str()), (0, ""));
    let worlds = reports(&stdout);
    let name = |world: &Value| world["name"].as_str().unwrap().to_owned();
    let names: Vec<String> = worlds.iter().map(name).collect();
    for expected in ["office", "cave", "loop", "cluttered", "hall"] {
        assert!(names.iter().any(|name| name == expected), "{expected}");
    }
    for world in &worlds {
        assert!(!world["description"].as_str().unwrap().is_empty());
        assert!(world["size_m"][0].as_f64().unwrap() > 1.0);
        assert!(!world["starts"].as_array().unwrap().is_empty());
    }
    let (status, stdout, _) = outcome(&folder, &["worlds"]);
    assert_eq!(status, 0);
    assert!(names.iter().all(|name| stdout.contains(name.as_str())));
    for kind in ["maze:SEED ", "rooms:SEED ", "dungeon:SEED "] {
        assert!(stdout.contains(kind), "{kind}");
    }
}

#[test]
fn the_tuned_constants_are_listed_with_their_ranges() {
    let folder = folder();
    let (status, stdout, stderr) = outcome(&folder, &["tuning", "--json"]);
    assert_eq!((status, stderr.as_str()), (0, ""));
    let constants = reports(&stdout);
    assert_eq!(constants.len(), Tuning::COUNT);
    for constant in &constants {
        let number = |key: &str| constant[key].as_f64().unwrap();
        let range = number("least")..=number("most");
        assert!(range.contains(&number("default")), "{constant}");
        assert!(!constant["meaning"].as_str().unwrap().is_empty());
    }
    let (status, stdout, _) = outcome(&folder, &["tuning"]);
    assert_eq!((status, stdout.lines().count()), (0, constants.len()));
}

#[test]
fn a_window_is_solved_into_a_file_and_an_answer() {
    let folder = folder();
    fs::write(folder.path().join("w.txt"), "#####\n#R.G#\n#####\n").unwrap();
    fs::write(
        folder.path().join("e.csv"),
        "0,0,0,0,0\n0,0.5,0.5,0,0\n0,0,0,0,0\n",
    )
    .unwrap();
    for solver in ["multigrid", "gauss-seidel"] {
        let arguments = [
            "solve", "w.txt", "--solver", solver, "--out", "f.csv", "--json",
        ];
        let (status, stdout, _) = outcome(&folder, &arguments);
        assert_eq!(status, 0);
        let answer = &reports(&stdout)[0];
        assert_eq!(answer["solver"], solver);
        assert_eq!(answer["stop"], "converged");
        assert_eq!(answer["heading_rad"], 0.0);
        assert_eq!(answer["flat"], false);
        let spent = if solver == "multigrid" {
            "cycles"
        } else {
            "sweeps"
        };
        assert!(answer[spent].as_u64().unwrap() > 0);
        // By hand: q2 = (q1 + 1)/4 and q1 = q2/4, so q1 = 1/15.
        let field = fs::read_to_string(folder.path().join("f.csv")).unwrap();
        let middle: Vec<f64> = field
            .lines()
            .nth(1)
            .unwrap()
            .split(',')
            .map(|q| q.parse().unwrap())
            .collect();
        assert!((middle[1] - 1.0 / 15.0).abs() < 1e-6, "{middle:?}");
        assert!((middle[2] - 4.0 / 15.0).abs() < 1e-6, "{middle:?}");
        assert_eq!([middle[0], middle[3], middle[4]], [0.0, 1.0, 0.0]);
        let arguments = [
            "solve",
            "w.txt",
            "--preference",
            "e.csv",
            "--solver",
            solver,
            "--out",
            "p.csv",
        ];
        let (status, stdout, _) = outcome(&folder, &arguments);
        assert_eq!(status, 0);
        assert!(stdout.contains("heading 0.00000 rad"), "{stdout}");
        let attracted = fs::read_to_string(folder.path().join("p.csv")).unwrap();
        assert_ne!(attracted, field);
    }
}

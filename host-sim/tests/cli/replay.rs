//! Recorded logs: a hand-made one gives the same poses over every link, and a bad one writes
//! nothing.

use core::fmt::Write as _;
use std::fs;
use std::path::Path;

use serde_json::Value;
use tempfile::TempDir;

use crate::{folder, outcome, reports};

/// Half the sides of the room around the start, metres.
const ROOM_M: [f64; 2] = [4.0, 2.5];

/// The robot's pose after so many steps: ahead by 5 cm a step, and a weave.
fn pose(step: u32) -> [f64; 3] {
    let along = 0.05 * f64::from(step);
    [along - 1.5, 0.3 * along.sin(), 0.3 * along.cos()]
}

/// The range of a beam at this angle in the room.
fn range_m([x, y, yaw]: [f64; 3], angle: f64) -> f64 {
    let (sin, cos) = (yaw + angle).sin_cos();
    let wall = |at: f64, direction: f64, half: f64| {
        if direction.abs() < 1e-9 {
            return f64::INFINITY;
        }
        (half * direction.signum() - at) / direction
    };
    wall(x, cos, ROOM_M[0]).min(wall(y, sin, ROOM_M[1]))
}

/// A log of a drive through the room, with `beams` over 180°.
fn log(beams: u32) -> String {
    let mut out = String::from("# made by hand\nPARAM laser_front_laser_fov 180 0 host 0\n");
    for step in 0..60 {
        let at = pose(step);
        let gaps = if beams % 2 == 1 { beams - 1 } else { beams };
        let angle = |beam: u32| (180.0 * f64::from(beam) / f64::from(gaps) - 90.0).to_radians();
        let [x, y, yaw] = at;
        let t = 0.2 * f64::from(step);
        write!(
            out,
            "ODOM {x} {y} {yaw} 0.25 0 0 {t} host {t}\nFLASER {beams}"
        )
        .unwrap();
        for beam in 0..beams {
            write!(out, " {:.3}", range_m(at, angle(beam))).unwrap();
        }
        writeln!(out, " {x} {y} {yaw} {x} {y} {yaw} {t} host {t}").unwrap();
    }
    out
}

/// True motions of one second each, told by a clock that is so many seconds ahead.
fn relations(ahead: f64) -> String {
    let mut out = String::new();
    for step in (0..50).step_by(5) {
        let ([x, y, yaw], [to_x, to_y, to_yaw]) = (pose(step), pose(step + 5));
        let (sin, cos) = yaw.sin_cos();
        let (dx, dy) = (to_x - x, to_y - y);
        let from = 0.2 * f64::from(step) + ahead;
        let (along, across) = (cos * dx + sin * dy, cos * dy - sin * dx);
        let (to, turn) = (from + 1.0, to_yaw - yaw);
        writeln!(out, "{from} {to} {along} {across} 0 0 0 {turn}").unwrap();
    }
    out
}

/// Returns a folder with a log, `a.log`.
pub(crate) fn with_log(beams: u32) -> TempDir {
    let folder = folder();
    fs::write(folder.path().join("a.log"), log(beams)).unwrap();
    folder
}

#[test]
fn a_replay_prints_its_figures_and_writes_its_files() {
    for beams in [180, 181, 360] {
        let folder = with_log(beams);
        fs::write(folder.path().join("r"), relations(0.0)).unwrap();
        let line = "replay a.log --relations r --link direct --json --out out";
        let words: Vec<&str> = line.split(' ').collect();
        let (status, stdout, stderr) = outcome(&folder, &words);
        assert_eq!(status, 0, "{stdout}{stderr}");
        let report = &reports(&stdout)[0];
        let keys: Vec<&String> = report.as_object().unwrap().keys().collect();
        let expected = "degrade input_faults laser late_scans link log made_by map_full_at \
                        occupied_cells_5cm quality relations resampled seed skipped steps";
        assert_eq!(keys, expected.split(' ').collect::<Vec<_>>());
        assert_eq!(report["steps"], 60);
        assert_eq!(report["degrade"], Value::Null);
        assert_eq!(report["relations"]["used"], 10);
        let mean = report["relations"]["translation_m"]["mean"]
            .as_f64()
            .unwrap();
        assert!(mean < 0.03, "{beams} beams: {mean}");
        assert_eq!(report["quality"]["lost"], 0.0);
        let names = [
            "map.pgm",
            "map.yaml",
            "relations.csv",
            "report.json",
            "run.png",
            "trajectory.tum",
        ];
        for name in names {
            assert!(folder.path().join("out").join(name).exists(), "{name}");
        }
        let tum = fs::read_to_string(folder.path().join("out/trajectory.tum")).unwrap();
        assert_eq!(tum.lines().count(), 60);
        assert!(tum.lines().nth(5).unwrap().starts_with("1.000000 "));
    }
}

/// The same drive, with two scans swapped and in the newer form, gives the same figures.
#[test]
fn late_scans_are_sorted_and_the_newer_form_is_read() {
    let folder = with_log(180);
    let plain = log(180);
    let mut lines: Vec<&str> = plain.lines().collect();
    // Lines 2 and on are ODOM and FLASER in turn.
    lines.swap(13, 15);
    fs::write(folder.path().join("late.log"), lines.join("\n")).unwrap();
    fs::write(folder.path().join("new.log"), newer(&plain, 180)).unwrap();
    let figures = |name: &str| {
        let words = [
            "replay",
            name,
            "--link",
            "direct",
            "--json",
            "--out",
            name.trim_end_matches(".log"),
        ];
        let (status, stdout, stderr) = outcome(&folder, &words);
        assert_eq!(status, 0, "{stderr}");
        let tum = name.replace(".log", "/trajectory.tum");
        (
            reports(&stdout)[0].clone(),
            stderr,
            fs::read(folder.path().join(tum)).unwrap(),
        )
    };
    let (plain, said, path) = figures("a.log");
    assert_eq!(
        (&plain["late_scans"], said.contains("sorted")),
        (&0.into(), false)
    );
    assert_eq!(plain["map_full_at"], Value::Null);
    let (late, said, late_path) = figures("late.log");
    assert_eq!(late["late_scans"], 1);
    assert!(
        said.contains("late.log: the times of 1 scans go back, by 0.20 s at most; sorted"),
        "{said}"
    );
    assert!(path == late_path);
    let (new, _, new_path) = figures("new.log");
    assert_eq!(new["occupied_cells_5cm"], plain["occupied_cells_5cm"]);
    assert!(path == new_path);
}

/// Turns FLASER lines into ROBOTLASER1 lines.
fn newer(log: &str, beams: usize) -> String {
    let (first, step) = (
        -core::f64::consts::FRAC_PI_2,
        core::f64::consts::PI / beams as f64,
    );
    let line = |line: &str| {
        let words: Vec<&str> = line.split(' ').collect();
        if words[0] != "FLASER" {
            return String::new();
        }
        let (ranges, rest) = (words[2..beams + 2].join(" "), &words[beams + 2..]);
        let (poses, time) = (rest[..6].join(" "), rest[6..].join(" "));
        format!(
            "ROBOTLASER1 0 {first} 3.14159 {step} 81.9 0.01 0 {beams} {ranges} 0 {poses} 0.25 0 \
             0.1 0.1 1e6 {time}\n"
        )
    };
    log.lines().map(line).collect()
}

/// A log as drivers write it gives the figures of the clean one, and tells what it left out.
#[test]
fn what_drivers_write_is_read_skipped_and_counted() {
    let folder = with_log(181);
    let clean = log(181);
    let mut lines: Vec<String> = clean.lines().map(str::to_owned).collect();
    // Lines 3, 5, … are ODOM, from the third on; the scans are behind them.
    let scan = lines[21].clone();
    let words: Vec<&str> = scan.split(' ').collect();
    let with_ranges = |code: &str| {
        let mut words = words.clone();
        words[2..183].fill(code);
        words.join(" ")
    };
    let late = scan
        .replace(" host ", " host 0 ")
        .replacen(" 1.8 host 0 1.8", " -9 host 1.8", 1);
    let extra = [with_ranges("0"), late, words[..100].join(" ")];
    lines[30] = lines[30].replacen(" 0.25 ", " nan ", 1);
    lines.splice(22..22, extra);
    fs::write(folder.path().join("wild.log"), lines.join("\n")).unwrap();
    let figures = |name: &str, more: &[&str]| {
        let start = [
            "replay",
            name,
            "--link",
            "direct",
            "--out",
            name.trim_end_matches(".log"),
        ];
        let (status, stdout, stderr) = outcome(&folder, &[&start, more].concat());
        assert_eq!(status, 0, "{stderr}");
        stdout
    };
    let report = |name| reports(&figures(name, &["--json"]))[0].clone();
    let (plain, wild) = (report("a.log"), report("wild.log"));
    for key in ["steps", "occupied_cells_5cm", "quality"] {
        assert_eq!(plain[key], wild[key], "{key}");
    }
    assert_eq!(plain["skipped"], serde_json::json!({}));
    let expected = serde_json::json!({
        "time_back": {"lines": 1, "first_line": 24},
        "empty": {"lines": 1, "first_line": 23},
        "not_finite": {"lines": 1, "first_line": 34},
        "garbled": {"lines": 1, "first_line": 25},
    });
    assert_eq!(wild["skipped"], expected);
    let text = figures("wild.log", &[]);
    assert!(
        text.contains("skipped    1 line whose time goes back (line 24)"),
        "{text}"
    );
}

#[test]
fn a_sweep_is_told_by_the_option() {
    let folder = with_log(181);
    let line = "replay a.log --link direct --json --out out --laser";
    let run = |sweep: &str| {
        let words: Vec<&str> = line.split(' ').chain([sweep]).collect();
        outcome(&folder, &words)
    };
    let (status, stdout, stderr) = run("-90,1,181,12");
    assert_eq!(status, 0, "{stderr}");
    let laser = &reports(&stdout)[0]["laser"];
    assert_eq!(
        (&laser["known_by"], &laser["step_deg"]),
        (&"option".into(), &1.0.into())
    );
    let (status, _, stderr) = run("-180,1,360,12");
    assert_eq!(status, 2);
    assert!(
        stderr.contains("the scans have 181 beams, and --laser has 360"),
        "{stderr}"
    );
}

#[test]
fn call_and_bytes_give_the_same_poses_and_map() {
    let folder = with_log(180);
    let files = |link: &str| {
        let (status, _, stderr) = outcome(
            &folder,
            &[
                "replay",
                "a.log",
                "--degrade",
                "2",
                "--link",
                link,
                "--out",
                link,
            ],
        );
        assert_eq!(status, 0, "{stderr}");
        ["trajectory.tum", "map.pgm"].map(|name| fs::read(folder.path().join(link).join(name)))
    };
    let [call, bytes] = ["direct", "loopback"].map(|link| files(link).map(Result::unwrap));
    assert!(call == bytes);
}

#[test]
fn drift_is_corrected_and_without_a_factor_there_is_none() {
    let folder = with_log(181);
    fs::write(folder.path().join("r"), relations(0.0)).unwrap();
    let line = |more: &str| {
        let line = format!("replay a.log --relations r --link direct --json --force{more}");
        let words: Vec<&str> = line.split(' ').collect();
        let (status, stdout, stderr) = outcome(&folder, &words);
        assert_eq!(status, 0, "{stderr}");
        reports(&stdout)[0].clone()
    };
    let (one, other) = (line(" --degrade 4 --seed 1"), line(" --degrade 4 --seed 2"));
    assert_eq!(one, line(" --degrade 4 --seed 1"));
    assert_ne!(one["relations"], other["relations"]);
    assert!(one["relations"]["translation_m"]["mean"].as_f64().unwrap() < 0.05);
}

#[test]
fn the_clock_of_relations_is_found_or_said() {
    let folder = with_log(180);
    fs::write(folder.path().join("r"), relations(100.0)).unwrap();
    let said = ["--relations-offset", "100"];
    for more in [&[][..], &said] {
        let start = [
            "replay",
            "a.log",
            "--relations",
            "r",
            "--link",
            "direct",
            "--json",
            "--force",
        ];
        let (status, stdout, stderr) = outcome(&folder, &[&start, more].concat());
        assert_eq!(status, 0, "{stderr}");
        assert_eq!(reports(&stdout)[0]["relations"]["used"], 10, "{stderr}");
        assert!(stderr.contains("s ahead of the log"), "{stderr}");
    }
}

/// The program refuses in one line, and writes nothing.
#[track_caller]
fn refused(folder: &TempDir, more: &[&str], words: &[&str]) {
    let start = [
        "replay", "bad.log", "--link", "direct", "--json", "--out", "out",
    ];
    let (status, stdout, stderr) = outcome(folder, &[&start, more].concat());
    assert_eq!((status, stdout.as_str()), (2, ""), "{stderr}");
    assert_eq!(stderr.lines().count(), 1, "{stderr}");
    for word in words {
        assert!(stderr.contains(word), "no {word:?} in {stderr}");
    }
    assert!(!folder.path().join("out").exists() && !Path::new("out").exists());
}

#[test]
fn a_bad_log_is_refused_with_file_and_line_and_writes_nothing() {
    let folder = folder();
    let good = log(4);
    let poses = good.replace(" host ", " NaN host ");
    let cut = good.replace("FLASER 4 ", "FLASER 4 1 ");
    for (text, words) in [
        (
            poses.as_str(),
            [
                "bad.log:",
                "of 60 scans 60 cannot be used",
                "mend or delete",
            ],
        ),
        (&cut, ["bad.log:4: ", "FLASER says 4", "mend or delete"]),
        (
            "",
            [
                "bad.log:1: ",
                "no FLASER, RLASER or ROBOTLASER1 line",
                "give a CARMEN log",
            ],
        ),
    ] {
        fs::write(folder.path().join("bad.log"), text).unwrap();
        refused(&folder, &[], &words);
    }
    // The header of a gzip file, and nothing behind it.
    let packed = [0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 0, 3];
    fs::write(folder.path().join("bad.log"), packed).unwrap();
    refused(&folder, &[], &["bad.log:1: ", "gzip", "copy it again"]);
    fs::remove_file(folder.path().join("bad.log")).unwrap();
    refused(&folder, &[], &["bad.log", "give an existing file"]);
}

#[test]
fn relations_of_another_log_are_refused() {
    let folder = folder();
    fs::write(folder.path().join("bad.log"), log(180)).unwrap();
    let other = "1 2 -2 1 0 0 0 1\n2 3 0 3 0 0 0 0\n";
    fs::write(folder.path().join("other"), other).unwrap();
    let relations = ["--relations", "other"];
    refused(
        &folder,
        &relations,
        &["other:1: ", "bad.log", "--relations-offset"],
    );
    let far = ["--relations", "other", "--relations-offset", "500"];
    refused(&folder, &far, &["other:1: ", "no relation has its times"]);
    fs::write(folder.path().join("other"), "1 2 0 0 0 0 0 0\n1 2 NaN\n").unwrap();
    refused(&folder, &relations, &["other:2: "]);
}

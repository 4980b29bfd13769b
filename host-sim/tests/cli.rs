//! The program as a user meets it: what it leaves behind, what it prints where, and what it says to bad input.

use std::fs;
use std::path::Path;

use assert_cmd::Command;
use serde_json::Value;
use tempfile::TempDir;

/// The program, in a folder of its own.
fn host_sim(folder: &TempDir) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_host-sim"));
    command
        .current_dir(folder.path())
        .env("RUST_BACKTRACE", "1");
    command
}

fn folder() -> TempDir {
    tempfile::tempdir().expect("a folder")
}

/// What it did: exit status, standard output, standard error.
fn outcome(folder: &TempDir, arguments: &[&str]) -> (i32, String, String) {
    let output = host_sim(folder).args(arguments).output().expect("runs");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("text");
    (
        output.status.code().expect("an exit status"),
        text(output.stdout),
        text(output.stderr),
    )
}

/// The reports that a `--json` run printed: every line is one, or the test fails.
fn reports(stdout: &str) -> Vec<Value> {
    let parse = |line| serde_json::from_str(line).expect("a JSON object a line");
    stdout.lines().map(parse).collect()
}

/// It refused: status 2, nothing on standard output, and one line that has all these words in it.
#[track_caller]
fn refused(folder: &TempDir, arguments: &[&str], words: &[&str]) {
    let (status, stdout, stderr) = outcome(folder, arguments);
    assert_eq!(
        (status, stdout.as_str()),
        (2, ""),
        "{arguments:?}: {stderr}"
    );
    assert!(stderr.starts_with("host-sim: "), "{arguments:?}: {stderr}");
    assert_eq!(stderr.lines().count(), 1, "{arguments:?}: {stderr}");
    for panic in ["panicked", "backtrace"] {
        assert!(!stderr.contains(panic), "{arguments:?}: {stderr}");
    }
    for word in words {
        assert!(
            stderr.contains(word),
            "{arguments:?}: no {word:?} in: {stderr}"
        );
    }
}

const FILES: [&str; 7] = [
    "commands.csv",
    "map.pgm",
    "map.yaml",
    "report.json",
    "run.png",
    "trajectory.tum",
    "trajectory_truth.tum",
];

fn files(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("a folder");
    let name = |entry: std::io::Result<fs::DirEntry>| {
        entry
            .expect("readable")
            .file_name()
            .into_string()
            .expect("text")
    };
    let mut names: Vec<String> = entries.map(name).collect();
    names.sort();
    names
}

#[test]
fn without_arguments_it_explores_the_office_and_leaves_a_folder() {
    let folder = folder();
    let (status, stdout, stderr) = outcome(&folder, &[]);
    assert_eq!(status, 0, "{stdout}{stderr}");
    assert!(
        stdout.starts_with("office · frontier · seed 0: explored, "),
        "{stdout}"
    );
    assert!(
        stderr.contains("office: files in out/office-frontier-0"),
        "{stderr}"
    );
    let run = folder.path().join("out/office-frontier-0");
    assert_eq!(files(&run), FILES);
    let report = fs::read_to_string(run.join("report.json")).unwrap();
    let report: Value = serde_json::from_str(&report).unwrap();
    assert_eq!(report["outcome"]["reason"], "explored");
    assert_eq!(report["link"], "loopback");
    assert_eq!(report["debug"]["map_matches_mirror"], true);
    assert!(report["coverage"]["fraction"].as_f64().unwrap() > 0.98);
    let steps = report["steps"].as_u64().unwrap() as usize;
    let lines = |name: &str| fs::read_to_string(run.join(name)).unwrap().lines().count();
    assert_eq!(lines("commands.csv"), steps + 1);
    assert_eq!(lines("trajectory.tum"), steps);
    assert_eq!(lines("trajectory_truth.tum"), steps);
}

#[test]
fn json_is_one_report_a_line_and_nothing_else() {
    let folder = folder();
    let arguments = ["explore", "loop", "cave", "loop", "--json", "--out", "runs"];
    let (status, stdout, _) = outcome(&folder, &arguments);
    let reports = reports(&stdout);
    let words: Vec<_> = reports
        .iter()
        .map(|r| {
            (
                r["world"].as_str().unwrap(),
                r["outcome"]["reason"].as_str().unwrap(),
            )
        })
        .collect();
    assert_eq!(
        words,
        [
            ("loop", "explored"),
            ("cave", "explored"),
            ("loop", "explored")
        ]
    );
    assert_eq!(status, 0, "every run ended explored");
    let runs = folder.path().join("runs");
    assert_eq!(
        files(&runs),
        ["cave-frontier-0", "loop-frontier-0", "loop-frontier-0-2"]
    );
    for (name, report) in files(&runs).iter().zip([1, 0, 2]) {
        assert_eq!(files(&runs.join(name)), FILES);
        let file = fs::read_to_string(runs.join(name).join("report.json")).unwrap();
        let file: Value = serde_json::from_str(&file).unwrap();
        assert_eq!(file, reports[report], "file and line say the same");
    }
}

#[test]
fn one_world_goes_straight_into_out_and_the_time_limit_ends_it() {
    let folder = folder();
    let arguments = [
        "explore",
        "hall",
        "--time-limit",
        "3",
        "--json",
        "--out",
        "here",
    ];
    let (status, stdout, stderr) = outcome(&folder, &arguments);
    assert_eq!(status, 1);
    let report = &reports(&stdout)[0];
    assert_eq!(report["outcome"]["status"], "time-limit");
    assert_eq!(report["sim_time_s"], 3.0);
    assert_eq!(files(&folder.path().join("here")), FILES);
    assert!(stderr.contains("allow more with --time-limit"), "{stderr}");
}

#[test]
fn snapshots_of_an_uneven_run_change_nothing_but_leave_pictures() {
    let folder = folder();
    let run = |more: &[&str]| {
        let arguments = ["explore", "causeway@1", "--time-limit", "13", "--json"];
        let (status, stdout, _) = outcome(&folder, &[&arguments, more].concat());
        assert_eq!(status, 1, "the time is up");
        reports(&stdout).remove(0)
    };
    let plain = run(&["--link", "direct"]);
    assert_eq!(plain["start"], 1);
    assert_eq!(plain["terrain"]["working"]["climb_deg"], 20.0);
    assert!(plain["terrain"]["classes"]["cells"][0][1].as_u64().unwrap() > 1_000);
    let home = folder.path().join("out/causeway@1-frontier-0");
    assert_eq!(files(&home), FILES, "no series unless asked for");
    for link in ["direct", "loopback"] {
        let taken = run(&["--link", link, "--snapshots", "3"]);
        assert_eq!(taken["digest"], plain["digest"]);
        assert_eq!(taken["coverage"], plain["coverage"]);
        let series = home.join("snapshots");
        assert_eq!(files(&series), ["001.png", "002.png", "003.png"]);
        let pictures = files(&series).into_iter().map(|name| series.join(name));
        let pictures: Vec<_> = pictures.chain([home.join("run.png")]).collect();
        let sizes = pictures.iter().map(|path| {
            let png = fs::read(path).unwrap();
            assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
            // Width and height.
            png[16..24].to_vec()
        });
        let mut sizes: Vec<_> = sizes.collect();
        sizes.dedup();
        assert_eq!(sizes.len(), 1, "all of one size: they make a film");
    }
}

#[test]
fn the_rung_and_faults_on_it_change_no_command() {
    let folder = folder();
    let digest = |more: &[&str]| {
        let arguments = ["explore", "cluttered", "--time-limit", "20", "--json"];
        let (_, stdout, _) = outcome(&folder, &[&arguments, more].concat());
        let report = reports(&stdout).remove(0);
        (
            report["digest"].clone(),
            report["link_stats"]["retries"].clone(),
        )
    };
    let clean = digest(&["--link", "direct"]);
    assert_eq!(digest(&["--link", "loopback"]).0, clean.0);
    let faults = "drop=0.02,duplicate=0.02,corrupt=0.02,truncate=0.02,delay=0.02";
    let faulty = digest(&["--link", "loopback", "--fault", faults]);
    assert_eq!(faulty.0, clean.0);
    assert!(faulty.1.as_u64().unwrap() > 0, "the faults were felt");
    assert_ne!(digest(&["--seed", "1"]).0, clean.0);
}

#[test]
fn a_device_that_falls_silent_or_resets_ends_the_run_with_a_typed_fault() {
    let folder = folder();
    for (fault, reason) in [("silent@60", "link-silent"), ("reset@60", "device-reset")] {
        let arguments = ["explore", "loop", "--json", "--fault", fault];
        let (status, stdout, stderr) = outcome(&folder, &arguments);
        let report = &reports(&stdout)[0];
        assert_eq!(status, 1);
        assert_eq!(report["outcome"]["status"], "fault", "{fault}");
        assert_eq!(report["outcome"]["reason"], reason, "{fault}");
        assert_eq!(report["fault"], fault);
        assert_eq!(report["safety"]["collisions"], 0, "{fault}");
        assert!(stderr.contains("host-sim: loop: "), "{stderr}");
        assert_eq!(files(&folder.path().join("out/loop-frontier-0")), FILES);
    }
}

#[test]
fn check_field_fills_the_heading_error() {
    let folder = folder();
    let arguments = [
        "explore",
        "loop",
        "--time-limit",
        "10",
        "--json",
        "--check-field",
    ];
    let (_, stdout, _) = outcome(&folder, &arguments);
    let report = &reports(&stdout)[0];
    let field = &report["field"];
    assert!(report["debug"]["checked_windows"].as_u64().unwrap() > 30);
    let worst = field["worst_heading_error_deg"].as_f64().unwrap();
    assert!((0.0..=180.0).contains(&worst));
    assert_eq!(field["heading_error_deg"]["max"].as_f64(), Some(worst));
    assert!(
        field["heading_error_deg"]["p50"].as_f64().unwrap() < 2.0,
        "{field}"
    );
}

/// The interrupt key stops the robot, and the report is still written.
#[cfg(unix)]
#[test]
fn the_interrupt_key_ends_a_run_in_good_order() {
    use std::process::{Command, Stdio};
    let folder = folder();
    let child = Command::new(env!("CARGO_BIN_EXE_host-sim"))
        .args(["explore", "hall", "--realtime", "--json", "--out", "run"])
        .current_dir(folder.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(core::time::Duration::from_secs(3));
    let id = child.id().to_string();
    assert!(
        Command::new("kill")
            .args(["-INT", &id])
            .status()
            .unwrap()
            .success()
    );
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    let report = reports(&String::from_utf8(output.stdout).unwrap()).remove(0);
    assert_eq!(report["outcome"]["status"], "interrupted");
    let time_s = report["sim_time_s"].as_f64().unwrap();
    assert!(
        time_s < 3.5,
        "{time_s} s: faster than the clock on the wall"
    );
    assert_eq!(files(&folder.path().join("run")), FILES);
}

#[test]
fn worlds_are_listed_and_their_names_work() {
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
}

#[test]
fn a_window_is_solved_into_file_and_answer() {
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

#[test]
fn bad_worlds_are_refused_in_one_line() {
    let folder = folder();
    let world = |name: &str, more: &str| {
        let text = format!(
            "image: walls.pgm\nresolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\n\
             free_thresh: 0.196\nrobots: [[2, 2, 0]]\n{more}"
        );
        fs::write(folder.path().join(name), text).unwrap();
    };
    let mut walls = b"P5\n40 40\n255\n".to_vec();
    walls.extend([254; 1600]);
    fs::write(folder.path().join("walls.pgm"), &walls).unwrap();
    world("good.yaml", "");
    assert_ne!(
        outcome(&folder, &["explore", "good.yaml", "--time-limit", "1"]).0,
        2
    );

    refused(
        &folder,
        &["explore", "nowhere.yaml"],
        &["nowhere.yaml", "office"],
    );
    world("key.yaml", "colour: red\n");
    refused(
        &folder,
        &["explore", "key.yaml"],
        &["key.yaml", "colour", "occupied_thresh"],
    );
    world("height.yaml", "wall_height: tall\n");
    refused(
        &folder,
        &["explore", "height.yaml"],
        &["height.yaml", "wall_height"],
    );
    let edit = |name: &str, from: &str, to: &str| {
        let text = fs::read_to_string(folder.path().join("good.yaml")).unwrap();
        fs::write(folder.path().join(name), text.replace(from, to)).unwrap();
    };
    edit("image.yaml", "walls.pgm", "missing.pgm");
    refused(
        &folder,
        &["explore", "image.yaml"],
        &["image.yaml", "missing.pgm", "relative"],
    );
    edit("threshold.yaml", "0.65", "1.65");
    refused(
        &folder,
        &["explore", "threshold.yaml"],
        &["occupied_thresh", "1.65"],
    );
    edit("outside.yaml", "[2, 2, 0]", "[-2, 2, 0]");
    refused(
        &folder,
        &["explore", "outside.yaml"],
        &["robots[0]", "(-2.00, 2.00)"],
    );
    let mut walled = walls.clone();
    walled[13..].fill(0);
    fs::write(folder.path().join("solid.pgm"), &walled).unwrap();
    edit("wall.yaml", "walls.pgm", "solid.pgm");
    refused(&folder, &["explore", "wall.yaml"], &["robots[0]", "wall"]);
    fs::write(folder.path().join("short.pgm"), &walls[..500]).unwrap();
    edit("short.yaml", "walls.pgm", "short.pgm");
    refused(
        &folder,
        &["explore", "short.yaml"],
        &["short.pgm", "truncated"],
    );
    // The signature and a header without an end.
    let png = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0(\0\0\0(\x08\0\0\0\0";
    fs::write(folder.path().join("short.png"), png).unwrap();
    edit("png.yaml", "walls.pgm", "short.png");
    refused(&folder, &["explore", "png.yaml"], &["short.png"]);
    let mut png = Vec::new();
    let mut header = png::Encoder::new(&mut png, 40, 40);
    header.set_color(png::ColorType::Grayscale);
    let mut writer = header.write_header().unwrap();
    let speckled: Vec<u8> = (0..1600_u32).map(|k| ((k * k * 37) >> 3) as u8).collect();
    writer.write_image_data(&speckled).unwrap();
    writer.finish().unwrap();
    for length in [8, 20, 40, png.len() / 2, png.len() - 13] {
        fs::write(folder.path().join("short.png"), &png[..length]).unwrap();
        refused(
            &folder,
            &["explore", "png.yaml"],
            &["short.png", "truncated", "copy the whole file"],
        );
    }
    // Numbers that are none, or none that a robot could drive in.
    for (from, to, words) in [
        ("resolution: 0.1", "resolution: .nan", "finite"),
        ("resolution: 0.1", "resolution: -0.1", "above 0 m"),
        ("resolution: 0.1", "resolution: 1e9", "1000 m a side"),
        ("origin: [0, 0, 0]", "origin: [.inf, 0, 0]", "finite"),
        ("origin: [0, 0, 0]", "origin: [500000, 0, 0]", "3000 m"),
        ("origin: [0, 0, 0]", "origin: [0, 0, 1]", "yaw"),
        (
            "free_thresh: 0.196",
            "free_thresh: 0.9",
            "free_thresh (0.9)",
        ),
        ("negate: 0", "negate: 2", "0 or 1"),
        ("[2, 2, 0]", "[.nan, 2, 0]", "finite"),
    ] {
        edit("number.yaml", from, to);
        refused(
            &folder,
            &["explore", "number.yaml"],
            &["number.yaml", words],
        );
    }
    // A good world before a bad one is not run.
    refused(&folder, &["explore", "good.yaml", "key.yaml"], &["colour"]);
}

#[test]
fn bad_arguments_are_refused_in_one_line() {
    let folder = folder();
    let explore = |more: &[&str], words: &[&str]| {
        refused(&folder, &[&["explore", "loop"], more].concat(), words);
    };
    explore(&["--strategy", "magic"], &["magic", "frontier"]);
    explore(
        &["--link", "tcp"],
        &["tcp", "direct, loopback, qemu or serial:DEVICE[@BAUD]"],
    );
    explore(&["--link", "serial:"], &["serial:/dev/"]);
    explore(
        &["--link", "serial:/dev/fieldline-none"],
        &["/dev/fieldline-none"],
    );
    explore(&["--link", "serial:/dev/null@0"], &["baud"]);
    explore(&["--fault", "drop=7"], &["drop=7", "0 to 0.5"]);
    explore(&["--fault", "rain=0.1"], &["rain", "duplicate"]);
    explore(
        &["--link", "direct", "--fault", "drop=0.1"],
        &["direct", "loopback"],
    );
    explore(&["--odometry", "gps"], &["gps", "truth, noisy"]);
    explore(&["--start", "7"], &["robots[7]", "2 starts"]);
    for bad in ["x", "-1", "1.5", "99999999999999999999"] {
        explore(&["--start", bad], &[bad, "whole number"]);
        explore(&["--seed", bad], &[bad, "whole number"]);
    }
    for bad in ["0", "-5", "nan", "inf", "1e300"] {
        explore(&["--time-limit", bad], &[bad, "above 0"]);
    }
    explore(&["--snapshots", "501"], &["'501'", "0 to 500"]);
    explore(&["--imu-noise", "90"], &["'90'", "degrees from 0 to 20"]);
    explore(&["--laser-noise", "-1"], &["'-1'", "metres from 0 to 1"]);
    explore(
        &["--limits", "climb=steep"],
        &["climb", "degrees and metres"],
    );
    explore(
        &["--limits", "climb=40"],
        &["--limits climb=40", "--failing"],
    );
    refused(&folder, &["explore", "loop@7"], &["robots[7]", "2 starts"]);
    for bad in ["64", "-5x5", "nanx5", "infx5", "0x9"] {
        explore(&["--map-shape", bad], &[bad, "128x32"]);
    }
    for bad in ["", ","] {
        explore(&["--fault", bad], &["no fault is named", "drop=P"]);
    }
    explore(&["--fault", "drop=nan"], &["drop=nan", "0 to 0.5"]);
    explore(&["--fault", "reset@-1"], &["reset@-1", "from 1 on"]);
    explore(
        &["--fault", "drop=0.1,drop=0.2"],
        &["'drop'", "given twice"],
    );
    explore(
        &["--strategy", "greedy-frontier", "--preference", "off"],
        &["greedy-frontier", "leave --preference and --terrain out"],
    );
    explore(
        &["--strategy", "bvp", "--fault", "drop=0.1"],
        &["bvp", "leave --fault out"],
    );
    explore(
        &["--strategy", "bvp", "--link", "qemu"],
        &["bvp", "leave --link out"],
    );
    refused(&folder, &["explore", ""], &["without a name", "office"]);
    explore(&["--map-shape", "500x500"], &["--map-shape", "400"]);
    fs::write(folder.path().join("file"), "").unwrap();
    explore(&["--out", "file/sub"], &["file/sub", "--out"]);
    explore(&["--out", "file"], &["file", "--out"]);
    refused(&folder, &["explor"], &["explor", "--help"]);
    refused(&folder, &["explore", "--fast"], &["--fast", "--help"]);
}

#[test]
fn bad_windows_are_refused_in_one_line() {
    let folder = folder();
    let write = |name: &str, bytes: &[u8]| fs::write(folder.path().join(name), bytes).unwrap();
    refused(&folder, &["solve", "none.txt"], &["none.txt", "existing"]);
    write("empty.txt", b"");
    refused(
        &folder,
        &["solve", "empty.txt"],
        &["empty.txt", "at least one cell"],
    );
    write("letter.txt", b"...\n.x.\n");
    refused(
        &folder,
        &["solve", "letter.txt"],
        &["letter.txt", "line 2, column 2", "'x'", "R robot"],
    );
    write("ragged.txt", b"...\n..\n");
    refused(&folder, &["solve", "ragged.txt"], &["line 2", "2 cells"]);
    write("tall.txt", "...\n".repeat(62).as_bytes());
    refused(&folder, &["solve", "tall.txt"], &["line 62", "61"]);
    write("wide.txt", ".".repeat(62).as_bytes());
    refused(
        &folder,
        &["solve", "wide.txt"],
        &["line 1, column 62", "61"],
    );
    write("bytes.txt", b"\xff\xfe\x00");
    refused(&folder, &["solve", "bytes.txt"], &["bytes.txt", "text"]);
    write("w.txt", b"R.G\n");
    write("e.csv", b"0,3,0\n");
    let preferred = ["solve", "w.txt", "--preference", "e.csv"];
    refused(
        &folder,
        &preferred,
        &["e.csv", "line 1, column 2", "within -2 and 2"],
    );
    write("e.csv", b"0,0\n");
    refused(&folder, &preferred, &["e.csv", "line 1"]);
    refused(
        &folder,
        &["solve", "w.txt", "--solver", "cholesky"],
        &["cholesky", "multigrid"],
    );
    refused(
        &folder,
        &["solve", "w.txt", "--out", "no/where.csv"],
        &["no/where.csv", "--out"],
    );
}

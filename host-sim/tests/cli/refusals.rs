//! Bad input is refused in one line that names the fault.

use std::fs;

use tempfile::TempDir;

use crate::{folder, outcome};

/// The program refuses: status 2, no standard output, and one error line with all these words.
#[track_caller]
pub(crate) fn refused(folder: &TempDir, arguments: &[&str], words: &[&str]) {
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

#[test]
fn bad_names_of_generated_worlds_are_refused_in_one_line() {
    let folder = folder();
    for (name, words) in [
        ("maze", "the seed must be a whole number"),
        ("rooms:x", "rooms:x: the seed must be a whole number"),
        ("rooms:7:40", "say rooms:1:20x15"),
        ("dungeon:7:5x20", "too small; say 8x8"),
        ("dungeon:7:100x100", "say 64x64, 128x32 or less"),
    ] {
        refused(&folder, &["explore", name], &[name, words]);
    }
    let generated = ["maze:SEED", "rooms:SEED", "dungeon:SEED"];
    refused(&folder, &["explore", "mazes"], &generated);
}

#[test]
fn bad_worlds_are_refused_in_one_line() {
    let folder = folder();
    let world = |name: &str, more: &str| {
        let text = format!(
            "image: walls.pgm\nresolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\n\
             occupied_thresh: 0.65\nfree_thresh: 0.196\nrobots: [[2, 2, 0]]\n{more}"
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
    // The signature and an incomplete header.
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
    // Values that are no numbers, or impossible worlds.
    for (from, to, words) in [
        ("resolution: 0.1", "resolution: .nan", "finite"),
        ("resolution: 0.1", "resolution: -0.1", "above 0 m"),
        ("resolution: 0.1", "resolution: 1e9", "1000 m a side"),
        ("origin: [0, 0, 0]", "origin: [.inf, 0, 0]", "finite"),
        ("origin: [0, 0, 0]", "origin: [500000, 0, 0]", "3000 m"),
        ("origin: [0, 0, 0]", "origin: [0, 0, 90]", "yaw"),
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
    // A good world before a bad one is not explored.
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
    explore(&["--start", "7"], &["robots[7]", "2 starts", "--start"]);
    for bad in ["x", "-1", "1.5", "99999999999999999999"] {
        explore(&["--start", bad], &[bad, "whole number"]);
        explore(&["--seed", bad], &[bad, "whole number"]);
    }
    for bad in ["0", "-5", "nan", "inf", "1e300"] {
        explore(&["--time-limit", bad], &[bad, "above 0"]);
    }
    explore(&["--snapshots", "501"], &["'501'", "0 to 500"]);
    explore(&["--people", "51"], &["'51'", "0 to 50"]);
    explore(&["--patrol-for", "65536"], &["'65536'", "0 to 65535"]);
    explore(&["--imu-noise", "90"], &["'90'", "degrees from 0 to 20"]);
    explore(&["--laser-noise", "-1"], &["'-1'", "metres from 0 to 1"]);
    explore(
        &["--working-limits", "climb=steep"],
        &["climb", "degrees and metres"],
    );
    explore(
        &["--working-limits", "climb=40"],
        &["--working-limits climb=40", "--failing-limits"],
    );
    refused(&folder, &["explore", "loop@7"], &["robots[7]", "2 starts"]);
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
        &[
            "greedy-frontier",
            "leave --ground, --preference, --levels and --ground-parameters out",
        ],
    );
    explore(
        &["--ground", "flat", "--preference", "off"],
        &["--ground flat", "say --ground uneven"],
    );
    explore(
        &["--ground", "flat", "--levels", "off"],
        &["--ground flat", "leave --preference, --levels"],
    );
    explore(
        &["--strategy", "bvp", "--levels", "on"],
        &["bvp has no height levels", "leave --levels out"],
    );
    explore(&["--levels", "maybe"], &["maybe", "on, off"]);
    explore(
        &["--strategy", "bvp", "--localise", "on"],
        &["--strategy bvp runs on the host", "leave --localise out"],
    );
    explore(
        &["--strategy", "bvp", "--slam", "host"],
        &["--slam corrects the map of a device", "say --slam off"],
    );
    explore(
        &["--strategy", "terrain", "--ground", "flat"],
        &["means --strategy frontier", "leave --ground flat out"],
    );
    explore(
        &["--ground-parameters", "eps_gmax=3"],
        &["--ground-parameters", "eps_gmax", "from 0 to 2"],
    );
    explore(
        &["--ground", "hilly"],
        &["hilly", "flat, uneven", "host-sim explore --help"],
    );
    explore(
        &["--ground", "uneven", "--check-field"],
        &["--check-field", "say --preference off"],
    );
    explore(
        &["--live", "hall"],
        &["hall", "as 127.0.0.1:8047", "a world stands before --live"],
    );
    let taken = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    let taken = taken.local_addr().expect("an address").to_string();
    explore(
        &["--live", &taken],
        &["--live 127.0.0.1:", "no page can be served there"],
    );
    explore(
        &["--patrol-for", "9"],
        &["frontier", "leave --patrol-for out"],
    );
    explore(
        &["--tdbvp-impatience", "9"],
        &["frontier", "leave --tdbvp-impatience out"],
    );
    explore(&["--tdbvp-impatience", "-1"], &["-1", "or never"]);
    for option in [["--bvp-sweeps", "9"], ["--bvp-precision", "f32"]] {
        explore(&option, &["frontier", "or say bvp-papers"]);
    }
    explore(
        &["--strategy", "bvp-papers", "--bvp-sweeps", "0"],
        &["from 1 to 10000"],
    );
    explore(
        &["--strategy", "bvp-papers", "--bvp-precision", "f16"],
        &["f16", "f32, f64"],
    );
    explore(
        &["--strategy", "bvp-papers", "--ground", "uneven"],
        &["bvp-papers takes all ground for flat"],
    );
    for option in [
        ["--until", "0.9"],
        ["--area", "0,0,9,9"],
        ["--sbpf-impatience", "9"],
    ] {
        explore(&option, &["frontier", "or say esbpf"]);
    }
    explore(&["--strategy", "sbpf", "--until", "0"], &["0.001 to 1"]);
    explore(
        &["--strategy", "sbpf", "--area", "0,0,9"],
        &["x,y,width,height"],
    );
    explore(
        &["--strategy", "esbpf", "--check-field"],
        &["esbpf", "leave --check-field out"],
    );
    explore(
        &["--strategy", "bvp", "--fault", "drop=0.1"],
        &["bvp", "leave --fault out"],
    );
    explore(
        &["--strategy", "bvp", "--link", "qemu"],
        &["bvp", "leave --link out"],
    );
    explore(&["--hull", "0.9x0.6"], &["--hull", "0.9x0.6x0.4"]);
    explore(&["--hull", "9x0.6x0.4"], &["--hull", "0.001 to 4 m"]);
    explore(&["--radius", "0.7"], &["--radius", "0.05 to 0.6 m"]);
    explore(&["--loops", "least=-1"], &["--loops", "0 to 32767"]);
    explore(&["--loops", "longest=9"], &["longest", "least, most"]);
    explore(&["--loops", "revisits=no"], &["'no'", "on nor off"]);
    explore(
        &["--loops", "revisits=off", "--link", "loopback"],
        &["revisits=off", "say --link direct"],
    );
    explore(
        &["--tune", "ouroboros.none=1"],
        &["none", "host-sim tuning"],
    );
    explore(&["--tune", "ouroboros.reached_m"], &["say NAME=VALUE"]);
    explore(&["--tune", "ouroboros.reached_m=99"], &["within 0.2 and 5"]);
    explore(
        &["--tune", "ouroboros.reached_m=1", "--link", "loopback"],
        &["--link direct"],
    );
    refused(&folder, &["explore", ""], &["has no name", "office"]);
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

#[test]
fn bad_teams_are_refused_in_one_line() {
    let folder = folder();
    let team = |arguments: &[&str], words: &[&str]| {
        refused(&folder, &[&["team", "loop"], arguments].concat(), words);
    };
    for robots in ["0", "9", "-1", "two"] {
        team(&["--robots", robots], &["--robots", "1 to 8"]);
    }
    team(
        &["--radio", "power=3"],
        &["--radio", "'power=3'", "range=M"],
    );
    team(&["--radio", "loss=1"], &["loss=1", "0 to 0.95"]);
    team(&["--radio", "partition@60-50"], &["partition@60-50"]);
    team(&["--radio", "partition@6-9:0/2"], &["robot 2", "partition"]);
    team(&["--leave", "2@9"], &["no robot 2", "0 to 1"]);
    team(&["--leave", "soon"], &["'soon'", "2@90"]);
    team(&["--join", "1@9"], &["robot 1", "must leave before"]);
    team(&["--link", "direct,tcp"], &["'tcp'", "loopback"]);
    team(
        &["--robots", "3", "--link", "direct,direct"],
        &["2 links", "3 robots"],
    );
    team(&["--strategy", "bvp"], &["bvp", "--radio off"]);
    team(
        &["--strategy", "bvp", "--radio", "off", "--slam", "host"],
        &["--slam corrects the map of a device", "say --slam off"],
    );
    team(&["--sbpf-impatience", "9"], &["frontier", "or say esbpf"]);
    team(
        &["--strategy", "esbpf", "--sbpf-impatience", "-1"],
        &["-1", "or never"],
    );
    team(&["--slam", "chip"], &["--slam", "off", "host"]);
    team(
        &["--slam", "host", "--ground", "uneven"],
        &["--slam corrects a team's maps", "--slam off"],
    );
    team(&["--start", "99"], &["starts", "--start"]);
    for error in ["0.3", "0,5", "9,5", "0.3,90", "far"] {
        team(&["--start-error", error], &["--start-error", "0.3,5"]);
    }
    let boxed = ["team", "boxed-in", "--robots", "8"];
    refused(&folder, &boxed, &["of 8 robots", "--apart"]);
    refused(
        &folder,
        &["team", "nowhere.yaml"],
        &["nowhere.yaml", "office"],
    );
}

#[test]
fn a_bad_particle_filter_is_refused_in_one_line() {
    let folder = folder();
    for (spec, words) in [
        ("0", "1 to 1000"),
        ("300,proposal=best", "use motion or matched"),
        ("300,noise=-1", "0 to 1000"),
    ] {
        let (status, _, stderr) = outcome(&folder, &["explore", "--particles", spec]);
        assert_eq!(status, 2, "{spec}: {stderr}");
        assert!(stderr.contains(words), "{spec}: {stderr}");
    }
    let uneven = [
        "explore",
        "slope",
        "--ground",
        "uneven",
        "--particles",
        "30",
    ];
    refused(&folder, &uneven, &["--particles", "--ground flat"]);
}

#[test]
fn fences_orders_and_budgets_that_are_none() {
    let folder = folder();
    let explore = |options: &[&str], words: &[&str]| {
        refused(&folder, &[&["explore", "office"], options].concat(), words);
    };
    explore(&["--bounds", "0,0,1"], &["--bounds", "corners x0,y0"]);
    explore(&["--no-go", "0,0,nan,1"], &["--no-go", "corners x0,y0"]);
    explore(&["--no-go", "0,0,1,1,1,0,0,1"], &["crossings"]);
    explore(&["--no-go", "0,0,0,1"], &["area of a polygon"]);
    explore(
        &["--bounds", "0,0,5,5"],
        &["robots[0]", "out of the bounds"],
    );
    explore(&["--no-go", "11,6,13,8"], &["robots[0]", "no-go"]);
    explore(
        &["--strategy", "bvp", "--bounds", "6,3,18,11"],
        &["bvp knows no bounds"],
    );
    explore(
        &["--strategy", "greedy-frontier", "--then", "home"],
        &["greedy-frontier takes no orders"],
    );
    explore(&["--goto", "1"], &["--goto", "x,y in metres"]);
    explore(&["--range-m", "0"], &["--range-m", "1 to 65535"]);
}

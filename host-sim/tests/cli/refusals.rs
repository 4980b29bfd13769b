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

/// `refusals.txt` has a command in a line, and after each `|` words of the error.
#[test]
fn bad_arguments_are_refused_in_one_line() {
    let folder = folder();
    fs::write(folder.path().join("file"), "").unwrap();
    let lines = include_str!("refusals.txt").lines();
    let lines: Vec<&str> = lines.filter(|line| !line.is_empty()).collect();
    assert!(lines.len() > 100, "{}", lines.len());
    for line in lines {
        let mut parts = line.split(" | ");
        let command = parts.next().unwrap_or_default().split(' ');
        let command = command.map(|word| word.trim_matches('\''));
        refused(
            &folder,
            &command.collect::<Vec<_>>(),
            &parts.collect::<Vec<_>>(),
        );
    }
}

/// A folder with a picture of a floor, `good.yaml`, and a function that writes the same world with
/// one text replaced.
fn worlds() -> (TempDir, impl Fn(&str, &str, &str)) {
    let folder = folder();
    let good = "image: walls.pgm\nresolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\n\
                occupied_thresh: 0.65\nfree_thresh: 0.196\nrobots: [[2, 2, 0]]\n";
    let path = folder.path().to_owned();
    let edit = move |name: &str, from: &str, to: &str| {
        fs::write(path.join(name), good.replace(from, to)).unwrap();
    };
    let mut walls = b"P5\n40 40\n255\n".to_vec();
    walls.extend([254; 1600]);
    fs::write(folder.path().join("walls.pgm"), &walls).unwrap();
    fs::write(folder.path().join("short.pgm"), &walls[..500]).unwrap();
    walls[13..].fill(0);
    fs::write(folder.path().join("solid.pgm"), &walls).unwrap();
    edit("good.yaml", "", "");
    (folder, edit)
}

#[test]
fn bad_worlds_are_refused_in_one_line() {
    let (folder, edit) = worlds();
    let good = ["explore", "good.yaml", "--time-limit", "1"];
    assert_ne!(outcome(&folder, &good).0, 2);
    let nowhere = ["explore", "nowhere.yaml"];
    refused(&folder, &nowhere, &["nowhere.yaml", "office"]);
    for (from, to, words) in [
        (
            "negate",
            "colour: red\nnegate",
            &["colour", "occupied_thresh"][..],
        ),
        ("negate", "wall_height: tall\nnegate", &["wall_height"]),
        ("walls.pgm", "missing.pgm", &["missing.pgm", "relative"]),
        ("0.65", "1.65", &["occupied_thresh", "1.65"]),
        ("[2, 2, 0]", "[-2, 2, 0]", &["robots[0]", "(-2.00, 2.00)"]),
        ("walls.pgm", "solid.pgm", &["robots[0]", "wall"]),
        ("walls.pgm", "short.pgm", &["short.pgm", "truncated"]),
        // Values that are no numbers, or impossible worlds.
        ("resolution: 0.1", "resolution: .nan", &["finite"]),
        ("resolution: 0.1", "resolution: -0.1", &["above 0 m"]),
        ("resolution: 0.1", "resolution: 1e9", &["1000 m a side"]),
        ("origin: [0, 0, 0]", "origin: [.inf, 0, 0]", &["finite"]),
        ("origin: [0, 0, 0]", "origin: [500000, 0, 0]", &["3000 m"]),
        ("origin: [0, 0, 0]", "origin: [0, 0, 90]", &["yaw"]),
        (
            "free_thresh: 0.196",
            "free_thresh: 0.9",
            &["free_thresh (0.9)"],
        ),
        ("negate: 0", "negate: 2", &["0 or 1"]),
        ("[2, 2, 0]", "[.nan, 2, 0]", &["finite"]),
    ] {
        edit("bad.yaml", from, to);
        refused(
            &folder,
            &["explore", "bad.yaml"],
            &[&["bad.yaml"], words].concat(),
        );
    }
    // A good world before a bad one is not explored.
    edit("key.yaml", "negate", "colour: red\nnegate");
    refused(&folder, &["explore", "good.yaml", "key.yaml"], &["colour"]);
}

#[test]
fn a_picture_that_ends_early_is_refused_in_one_line() {
    let (folder, edit) = worlds();
    edit("png.yaml", "walls.pgm", "short.png");
    let explore = ["explore", "png.yaml"];
    // The signature and an incomplete header.
    let png = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0(\0\0\0(\x08\0\0\0\0";
    fs::write(folder.path().join("short.png"), png).unwrap();
    refused(&folder, &explore, &["short.png"]);
    let mut png = Vec::new();
    let mut header = png::Encoder::new(&mut png, 40, 40);
    header.set_color(png::ColorType::Grayscale);
    let mut writer = header.write_header().unwrap();
    let speckled: Vec<u8> = (0..1600_u32).map(|k| ((k * k * 37) >> 3) as u8).collect();
    writer.write_image_data(&speckled).unwrap();
    writer.finish().unwrap();
    let words = ["short.png", "truncated", "copy the whole file"];
    for length in [8, 20, 40, png.len() / 2, png.len() - 13] {
        fs::write(folder.path().join("short.png"), &png[..length]).unwrap();
        refused(&folder, &explore, &words);
    }
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
fn a_bad_particle_filter_is_refused_in_one_line() {
    let folder = folder();
    for (spec, words) in [
        ("0", "1 to 1000"),
        ("300,proposal=best", "motion or matched"),
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
fn a_port_that_is_taken_is_refused() {
    let folder = folder();
    let taken = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    let taken = taken.local_addr().expect("an address").to_string();
    refused(
        &folder,
        &["explore", "loop", "--live", &taken],
        &["--live 127.0.0.1:", "no page can be served there"],
    );
}

//! Sessions: attacked, replayed, and refused if their file is bad.

use std::fs;

use crate::refusals::refused;
use crate::{folder, outcome};

/// A session of a robot with one beam: two steps among walls.
const SESSION: &str = concat!(
    r#"{"fieldline_session":1,"tiles":8,"slots":64}"#,
    "\n# A robot with one beam.\n",
    r#"{"start":{"lasers":[{"beams":1,"bearing_step":"0.1","range_limit_mm":4000,"z":"0.3"}],"#,
    r#""robot_radius_mm":300,"max_linear":"0.5","max_angular":"1","linear_accel":"0.5","#,
    r#""angular_accel":"1","period_ms":200}}"#,
    "\n",
    r#"{"observation":{"scans":[{"ranges_mm":[2000]}]}}"#,
    "\n\"pause\"\n",
    r#"{"observation":{"time_ms":200,"scans":[{"ranges_mm":"2000x1"}]}}"#,
    "\n",
    r#"{"field_row":{"row":30}}"#,
    "\n\"reset\"\n",
);

#[test]
fn a_session_is_replayed_over_any_link() {
    let folder = folder();
    fs::write(folder.path().join("s.jsonl"), SESSION).unwrap();
    for link in ["device", "direct", "loopback"] {
        let (status, stdout, stderr) =
            outcome(&folder, &["replay-session", "s.jsonl", "--link", link]);
        assert_eq!((status, stderr.as_str()), (0, ""), "{stdout}");
        assert!(
            stdout.starts_with("6 requests, 2 steps, 0 refused"),
            "{stdout}"
        );
        assert!(stdout.ends_with("no findings\n"), "{stdout}");
    }
}

#[test]
fn a_bad_session_is_refused_with_file_and_line() {
    let folder = folder();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("field.jsonl", &SESSION.replace("max_linear", "top_speed"));
    write("size.jsonl", &SESSION.replace("\"tiles\":8", "\"tiles\":9"));
    write("head.jsonl", "\"pause\"\n");
    for (file, words) in [
        (
            "field.jsonl",
            ["field.jsonl:3:", "'top_speed'", "leave it out"],
        ),
        ("size.jsonl", ["9 tiles", "64 slots", "give 8 and 64"]),
        ("head.jsonl", ["head.jsonl:1:", "no head", "begin it with"]),
        (
            "none.jsonl",
            ["none.jsonl", "cannot be read", "name a file"],
        ),
    ] {
        refused(&folder, &["replay-session", file], &words);
    }
}

#[test]
fn sessions_are_counted_and_findings_are_files() {
    let folder = folder();
    let arguments = ["sessions", "--generator", "tame", "--seeds", "0..3"];
    let (status, stdout, _) = outcome(&folder, &arguments);
    assert_eq!(status, 0, "{stdout}");
    assert!(stdout.starts_with("3 sessions, "), "{stdout}");
    // No answer takes no time.
    let more = ["--most-ms", "0", "--trials", "5", "--out", "found"];
    let (status, stdout, stderr) = outcome(&folder, &[&arguments[..], &more].concat());
    assert_eq!(status, 1, "{stdout}");
    assert!(
        stdout.contains("finding: slow answer: 3 sessions"),
        "{stdout}"
    );
    let file = "found/slow-answer-tame-0.jsonl";
    assert!(stderr.contains(file), "{stderr}");
    let (status, stdout, _) = outcome(&folder, &["replay-session", file, "--most-ms", "0"]);
    assert_eq!(status, 1, "{stdout}");
}

#[test]
fn bad_arguments_are_refused() {
    let folder = folder();
    for (arguments, words) in [
        (["--seeds", "7"], "0..1000"),
        (["--seeds", "9..3"], "0..1000"),
        (["--generator", "wild"], "absurd, tame or plausible"),
        (["--link", "tcp"], "unknown link 'tcp'"),
    ] {
        refused(&folder, &[&["sessions"][..], &arguments].concat(), &[words]);
    }
}

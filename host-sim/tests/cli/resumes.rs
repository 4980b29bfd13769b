//! `explore --resume DIR`: a run goes on after its host was killed, and bad states are refused.

use core::time::Duration;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;

use serde_json::Value;
use tempfile::TempDir;

use crate::refusals::refused;
use crate::{folder, outcome, reports};

/// A run whose states are many, and that is slow enough to be killed between two of them.
const RUN: [&str; 7] = [
    "explore",
    "office",
    "--seed",
    "3",
    "--link",
    "direct",
    "--check-field",
];
const KILLS: usize = 10;

/// Begins the run, or goes on with it, and kills the host once it has kept a state more. Returns
/// false if the run ended before.
fn killed(folder: &TempDir, more: &[&str]) -> bool {
    let state = folder.path().join("run/session.state");
    let kept = |path: &Path| fs::metadata(path).and_then(|it| it.modified()).ok();
    let before = kept(&state);
    let mut host = Command::new(env!("CARGO_BIN_EXE_host-sim"))
        .current_dir(folder.path())
        .args(RUN)
        .args(more)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("it runs");
    let begun = Instant::now();
    while kept(&state) == before {
        if host.try_wait().expect("a process").is_some() {
            return false;
        }
        assert!(
            begun.elapsed() < Duration::from_secs(300),
            "no state is kept"
        );
        std::thread::sleep(Duration::from_millis(1));
    }
    // SIGKILL, which no process can catch.
    host.kill().expect("killed");
    host.wait().expect("a process");
    true
}

fn state(folder: &TempDir) -> Value {
    let (status, stdout, stderr) = outcome(folder, &["state", "run", "--json"]);
    assert_eq!(status, 0, "{stderr}");
    serde_json::from_str(&stdout).expect("JSON")
}

#[test]
fn a_run_whose_host_is_killed_ten_times_ends_as_an_undisturbed_one() {
    let folder = folder();
    let explored = |out: &str, more: &[&str]| {
        let arguments = [&RUN[..], &["--json", "--out", out], more].concat();
        let (status, stdout, stderr) = outcome(&folder, &arguments);
        assert_eq!(status, 0, "{stdout}{stderr}");
        reports(&stdout).remove(0)
    };
    let undisturbed = explored("whole", &[]);
    assert!(killed(&folder, &["--out", "run"]), "it ended too early");
    let mut last = state(&folder);
    for _ in 1..KILLS {
        assert!(killed(&folder, &["--resume", "run"]), "it ended too early");
        let next = state(&folder);
        for key in ["time_s", "coverage"] {
            let [before, now] = [&last, &next].map(|it| it[key].as_f64().expect(key));
            assert!(now >= before, "{key} fell from {before} to {now}");
        }
        last = next;
    }
    let report = explored("run", &["--resume", "run"]);
    assert_eq!(report["outcome"]["reason"], "explored");
    assert_eq!(report["safety"]["collisions"], 0);
    assert_eq!(report["debug"]["map_matches_mirror"], true);
    let [with, without] =
        [&report, &undisturbed].map(|it| it["coverage"]["fraction"].as_f64().expect("a share"));
    assert!(with > without - 0.01, "{with} and {without}");
    // The report and the trajectory are those of the whole run.
    let steps = report["steps"].as_u64().expect("steps") as usize;
    let trajectory = fs::read_to_string(folder.path().join("run/trajectory.tum")).expect("text");
    assert_eq!(trajectory.lines().count(), steps);
    assert!(trajectory.starts_with("0.0"), "from the beginning");
    assert!(
        !folder.path().join("run/session.state").exists(),
        "nothing is left to resume"
    );
}

/// A run that its time limit ended goes on over another link.
#[test]
fn a_run_goes_on_over_another_link_with_its_orders() {
    let folder = folder();
    let office = [
        "explore", "office", "--then", "home", "--json", "--out", "run",
    ];
    let limited = [&office[..], &["--link", "direct", "--time-limit", "50"]].concat();
    assert_eq!(outcome(&folder, &limited).0, 1);
    let (status, stdout, stderr) = outcome(
        &folder,
        &[&office[..], &["--link", "loopback", "--resume", "run"]].concat(),
    );
    assert_eq!(status, 0, "{stdout}{stderr}");
    assert!(
        stderr.contains("goes on after 50.0 s and 251 steps"),
        "{stderr}"
    );
    let report = reports(&stdout).remove(0);
    assert_eq!(report["outcome"]["reason"], "explored");
    let home = &report["trips"][0];
    assert!(
        home["reached"] == true && home["true_error_m"].as_f64().unwrap() < 0.5,
        "{home}"
    );
}

/// A run of 30 s in folder `run`, which may go on.
fn unfinished() -> TempDir {
    let folder = folder();
    let run = [
        "explore",
        "office",
        "--link",
        "direct",
        "--time-limit",
        "30",
        "--out",
        "run",
    ];
    assert_eq!(outcome(&folder, &run).0, 1);
    folder
}

fn resume(more: &[&'static str]) -> Vec<&'static str> {
    [&["explore", "office", "--resume", "run"], more].concat()
}

#[test]
fn a_state_of_other_options_is_refused_in_one_line() {
    let folder = unfinished();
    let of_other = [
        (
            resume(&["--seed", "4"]),
            &["--seed 4", "give the same options"][..],
        ),
        (
            resume(&["--time-limit", "20"]),
            &["--time-limit 20", "allow more"],
        ),
        (resume(&["--snapshots", "3"]), &["--snapshots"]),
        (resume(&["--strategy", "bvp"]), &["strategy on the device"]),
        (resume(&["cave"]), &["only its world"]),
        (
            vec!["explore", "cave", "--resume", "run"],
            &["--worlds cave"],
        ),
        (
            vec!["explore", "--resume", "nowhere"],
            &["nowhere", "killed or interrupted"],
        ),
    ];
    for (arguments, words) in of_other {
        refused(&folder, &arguments, words);
    }
}

#[test]
fn a_state_that_is_cut_or_damaged_is_refused_in_one_line() {
    let folder = unfinished();
    let path = folder.path().join("run/session.state");
    let whole = fs::read(&path).expect("a state");
    let mut newer = whole.clone();
    newer[8] = 9;
    let mut damaged = whole.clone();
    damaged[whole.len() / 2] ^= 4;
    for (bytes, words) in [
        (
            &whole[..whole.len() - 7],
            &["it was cut", "leave --resume out"][..],
        ),
        (&damaged, &["damaged", "checksum"]),
        (&newer, &["format 9", "the program that kept it"]),
        (b"no state", &["no state of a run"]),
    ] {
        fs::write(&path, bytes).expect("written");
        refused(&folder, &resume(&[]), &[&["session.state"], words].concat());
        refused(&folder, &["state", "run"], words);
    }
    fs::write(&path, whole).expect("written");
    let (status, stdout, _) = outcome(&folder, &["state", "run"]);
    assert!(
        status == 0 && stdout.contains("at        30.0 s"),
        "{stdout}"
    );
}

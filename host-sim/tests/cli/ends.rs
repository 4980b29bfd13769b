//! Ends of a run: a target, the time limit, faults of the link, the interrupt key.

use serde_json::Value;

use crate::{files, folder, kept_files, outcome, reports};

#[test]
fn a_space_field_ends_with_its_target_and_its_reason() {
    let folder = folder();
    let run = |strategy| {
        let args = [
            "explore",
            "c-room",
            "--json",
            "--until",
            "0.95",
            "--strategy",
            strategy,
        ];
        let (status, stdout, stderr) = outcome(&folder, &args);
        let report: Value = serde_json::from_str(&stdout).expect("one report");
        (status, stderr, report)
    };
    let (status, _, report) = run("esbpf");
    assert_eq!(
        (status, &report["outcome"]["reason"]),
        (0, &"covered".into())
    );
    let field = &report["space_field"];
    assert_eq!(field["area_m"], serde_json::json!([0.2, 0.2, 10.0, 10.0]));
    assert_eq!(
        (&field["until"], &field["impatience"]),
        (&0.95.into(), &"5".into())
    );
    let (status, stderr, report) = run("sbpf");
    assert_eq!(
        (status, &report["outcome"]["reason"]),
        (1, &"trapped".into())
    );
    assert!(stderr.contains("--sbpf-impatience 5"), "{stderr}");
}

#[test]
fn one_world_goes_into_out_and_the_time_limit_ends_it() {
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
    assert_eq!(files(&folder.path().join("here")), kept_files());
    assert!(stderr.contains("allow more with --time-limit"), "{stderr}");
}

#[test]
fn silence_or_a_reset_ends_the_run_with_a_typed_fault() {
    let folder = folder();
    for (fault, reason) in [("silent@60", "link-silent"), ("reset@60", "device-reset")] {
        let arguments = ["explore", "loop", "--json", "--force", "--fault", fault];
        let (status, stdout, stderr) = outcome(&folder, &arguments);
        let report = &reports(&stdout)[0];
        assert_eq!(status, 1);
        assert_eq!(report["outcome"]["status"], "fault", "{fault}");
        assert_eq!(report["outcome"]["reason"], reason, "{fault}");
        assert_eq!(report["injected_faults"], fault);
        assert_eq!(report["safety"]["collisions"], 0, "{fault}");
        assert!(stderr.contains("host-sim: loop: "), "{stderr}");
        assert_eq!(
            files(&folder.path().join("out/loop-frontier-0")),
            kept_files()
        );
    }
}

/// The interrupt key stops the robot, and the program still writes the report.
#[cfg(unix)]
#[test]
fn the_interrupt_key_ends_a_run_with_a_report() {
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
    assert_eq!(files(&folder.path().join("run")), kept_files());
}

/// The key ends the run in hand, and no further one begins.
#[cfg(unix)]
#[test]
fn the_interrupt_key_begins_no_further_run() {
    use std::process::{Command, Stdio};
    let folder = folder();
    let child = Command::new(env!("CARGO_BIN_EXE_host-sim"))
        .args(["explore", "hall", "loop", "--realtime", "--json"])
        .current_dir(folder.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    std::thread::sleep(core::time::Duration::from_secs(3));
    let id = child.id().to_string();
    let status = Command::new("kill").args(["-INT", &id]).status();
    assert!(status.unwrap().success());
    let output = child.wait_with_output().unwrap();
    let reports = reports(&String::from_utf8(output.stdout).unwrap());
    assert_eq!(reports.len(), 1);
    assert_eq!(reports[0]["world"], "hall");
}

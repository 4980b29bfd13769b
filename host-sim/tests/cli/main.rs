//! The program on the command line: its files, its output, and its errors.

mod campaigns;
mod commands;
mod ends;
mod errands;
mod known_maps;
mod mission_files;
#[cfg(feature = "record")]
mod recordings;
mod refusals;
mod replay;
mod resumes;
mod robots;
mod runs;
mod sessions;
mod teams;

use std::fs;
use std::path::Path;

use assert_cmd::Command;
use serde_json::Value;
use tempfile::TempDir;

/// The program, in a folder of the test.
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

/// Runs the program: exit status, standard output, standard error.
fn outcome(folder: &TempDir, arguments: &[&str]) -> (i32, String, String) {
    let output = host_sim(folder).args(arguments).output().expect("runs");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("text");
    (
        output.status.code().expect("an exit status"),
        text(output.stdout),
        text(output.stderr),
    )
}

/// The reports that a `--json` run printed; the test fails if a line is no report.
fn reports(stdout: &str) -> Vec<Value> {
    let parse = |line| serde_json::from_str(line).expect("a JSON object a line");
    stdout.lines().map(parse).collect()
}

/// The files of a run.
const FILES: [&str; 8] = [
    "commands.csv",
    "map.pgm",
    "map.yaml",
    "mission.log",
    "report.json",
    "run.png",
    "trajectory.tum",
    "trajectory_truth.tum",
];

/// The files of a run that may go on.
fn kept_files() -> Vec<&'static str> {
    let mut files = FILES.to_vec();
    files.insert(6, "session.state");
    files
}

/// The names in a folder, sorted.
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

//! Campaigns: the same runs as `explore`, resumed after kills, divided into shards, and refusals.

use core::time::Duration;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;

use serde_json::Value;
use tempfile::TempDir;

use crate::refusals::refused;
use crate::{folder, host_sim, outcome, reports};

/// Twelve trials that take a fraction of a second each.
const SMALL: &str = r#"
worlds = ["loop", "cave"]
strategies = ["greedy-frontier", "frontier"]
seeds = "0..3"
odometry = "noisy"
baseline = "frontier"
[options]
time-limit = 40
"#;

fn write(folder: &TempDir, name: &str, text: &str) {
    fs::write(folder.path().join(name), text).expect("a file");
}

fn read(folder: &TempDir, name: &str) -> String {
    let path = folder.path().join(name);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The lines of a campaign's folder.
fn trials(folder: &TempDir, campaign: &str) -> Vec<Value> {
    reports(&read(folder, &format!("{campaign}/trials.jsonl")))
}

/// Runs the small campaign; returns its table as Markdown and as numbers.
fn whole(folder: &TempDir) -> [String; 2] {
    write(folder, "small.toml", SMALL);
    let (status, stdout, stderr) = outcome(folder, &["campaign", "small.toml"]);
    assert_eq!(status, 0, "{stderr}");
    let tables = tables(folder, "out/campaign-small");
    assert_eq!(stdout, tables[0]);
    tables
}

fn tables(folder: &TempDir, campaign: &str) -> [String; 2] {
    ["table.md", "table.csv"].map(|name| read(folder, &format!("{campaign}/{name}")))
}

#[test]
fn a_trial_is_the_run_of_explore_with_its_command() {
    let folder = folder();
    let line = "campaign --worlds loop,cave --strategies frontier,bvp --seeds 1,2 --odometry \
                papers --baseline bvp --name two --jobs 2 -- --time-limit 20 --laser-noise=0.02";
    let words: Vec<&str> = line.split_whitespace().collect();
    let (status, stdout, stderr) = outcome(&folder, &words);
    assert_eq!(status, 0, "{stderr}");
    assert!(stdout.contains("## loop, odometry papers") && stdout.contains("Against bvp"));
    let trials = trials(&folder, "out/campaign-two");
    assert_eq!(trials.len(), 8);
    for (index, trial) in trials.iter().enumerate() {
        assert_eq!(trial["index"], index, "in order at the end");
        let command = trial["command"].as_str().unwrap();
        let mut words: Vec<&str> = command.split(' ').skip(1).collect();
        words.push("--json");
        let (_, stdout, _) = outcome(&folder, &words);
        let report = &reports(&stdout)[0];
        assert_eq!(trial["report"]["digest"], report["digest"], "{command}");
        assert_eq!(trial["report"]["localization"], report["localization"]);
        let last = trial["coverage"].as_array().unwrap().last().unwrap();
        assert_eq!(last[0], report["sim_time_s"], "{command}");
    }
    for plot in [
        "time",
        "error",
        "coverage-loop-odometry-papers",
        "coverage-loop",
    ] {
        let path = folder
            .path()
            .join(format!("out/campaign-two/plots/{plot}.svg"));
        assert_eq!(
            path.exists(),
            plot != "coverage-loop-odometry-papers",
            "{plot}"
        );
    }
}

#[test]
fn four_shards_make_the_table_of_one_run() {
    let folder = folder();
    let tables_of_one = whole(&folder);
    let start = |index: usize| {
        let shard = format!("{index}/4");
        Command::new(env!("CARGO_BIN_EXE_host-sim"))
            .current_dir(folder.path())
            .args(["campaign", "small.toml", "--jobs", "1", "--shard", &shard])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("a process")
    };
    let shards: Vec<_> = (0..4).map(start).collect();
    for mut shard in shards {
        assert!(shard.wait().expect("an end").success());
    }
    let names = [3, 1, 0, 2].map(|index| format!("out/campaign-small-shard-{index}-of-4"));
    let mut words = vec!["campaign", "merge", "--out", "merged"];
    words.extend(names.iter().map(String::as_str));
    let (status, _, stderr) = outcome(&folder, &words);
    assert_eq!(status, 0, "{stderr}");
    assert_eq!(tables(&folder, "merged"), tables_of_one);
    let (one, merged) = (
        trials(&folder, "out/campaign-small"),
        trials(&folder, "merged"),
    );
    for (one, merged) in one.iter().zip(&merged) {
        assert_eq!(one["report"]["digest"], merged["report"]["digest"]);
    }
    refused(
        &folder,
        &["campaign", "merge", "--out", "x", &names[0], &names[1]],
        &["2 of 4 shards are missing: 0/4, 2/4"],
    );
    refused(
        &folder,
        &["campaign", "merge", "--out", "x", "nowhere"],
        &["nowhere/campaign.toml", "cannot read"],
    );
}

/// Runs the small campaign until its file has `lines` lines, and kills it there.
#[cfg(unix)]
fn killed_at(folder: &TempDir, file: &Path, lines: usize) {
    let mut process = Command::new(env!("CARGO_BIN_EXE_host-sim"))
        .current_dir(folder.path())
        .args(["campaign", "small.toml", "--out", "killed"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("a process");
    let began = Instant::now();
    loop {
        let there = fs::read(file).unwrap_or_default();
        if there.iter().filter(|byte| **byte == b'\n').count() >= lines {
            break;
        }
        assert!(
            began.elapsed() < Duration::from_secs(300),
            "no {lines} lines"
        );
        std::thread::sleep(Duration::from_millis(2));
    }
    // SIGKILL on Unix.
    process.kill().expect("a process to kill");
    process.wait().expect("an end");
}

#[test]
#[cfg(unix)]
fn a_campaign_that_is_killed_again_and_again_ends_with_the_same_table() {
    let folder = folder();
    let tables_of_one = whole(&folder);
    let file = folder.path().join("killed/trials.jsonl");
    for lines in [1, 4, 6] {
        killed_at(&folder, &file, lines);
    }
    // The kill may have fallen between two lines: tear the last one in any case.
    let text = fs::read(&file).expect("the lines");
    fs::write(&file, &text[..text.len() - 25]).expect("a torn file");
    let before = text.iter().filter(|byte| **byte == b'\n').count();
    let words = ["campaign", "small.toml", "--out", "killed"];
    let (status, stdout, stderr) = outcome(&folder, &words);
    assert_eq!(status, 0, "{stderr}");
    let torn = "the last line is torn, its trial runs again";
    assert!(
        stderr.contains(torn) && stderr.contains("killed/trials.jsonl:"),
        "{stderr}"
    );
    assert!(
        stderr.contains(&format!("{} of 12 trials are there", before - 1)),
        "{stderr}"
    );
    assert_eq!(tables(&folder, "killed"), tables_of_one);
    assert_eq!(stdout, tables_of_one[0]);
    // Nothing is left to run: the same tables at once.
    let (status, _, stderr) = outcome(&folder, &words);
    assert_eq!(status, 0, "{stderr}");
    assert!(
        stderr.contains("12 of 12 trials are there; 0 to go"),
        "{stderr}"
    );
    assert_eq!(tables(&folder, "killed"), tables_of_one);
}

#[test]
#[cfg(unix)]
fn the_interrupt_key_ends_a_campaign_that_goes_on_later() {
    let folder = folder();
    write(&folder, "small.toml", SMALL);
    let process = Command::new(env!("CARGO_BIN_EXE_host-sim"))
        .current_dir(folder.path())
        .args(["campaign", "small.toml", "--jobs", "1"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("a process");
    let file = folder.path().join("out/campaign-small/trials.jsonl");
    let began = Instant::now();
    while fs::metadata(&file).map_or(0, |it| it.len()) == 0 {
        assert!(began.elapsed() < Duration::from_secs(300), "no line");
        std::thread::sleep(Duration::from_millis(2));
    }
    let kill = Command::new("kill")
        .args(["-INT", &process.id().to_string()])
        .status();
    assert!(kill.expect("kill").success());
    let output = process.wait_with_output().expect("an end");
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{stderr}");
    assert!(
        stderr.contains("of 12 trials are done; the same command goes on"),
        "{stderr}"
    );
    assert!(String::from_utf8_lossy(&output.stdout).contains("of 12 trials"));
    let there = trials(&folder, "out/campaign-small").len();
    assert!((1..12).contains(&there), "{there}");
    assert_eq!(whole(&folder), tables(&folder, "out/campaign-small"));
}

#[test]
fn bad_campaigns_are_refused_in_one_line_with_file_and_line() {
    let folder = folder();
    let head = "worlds = [\"loop\"]\nstrategies = [\"frontier\"]\n";
    for (more, words) in [
        (
            "wrlds = []",
            ["bad.toml:3: unknown field `wrlds`", "did you mean worlds?"],
        ),
        ("starts = 7", ["bad.toml:3: ", "only 2 starts"]),
        ("slam = \"hosts\"", ["bad.toml:2: ", "use off or host"]),
        (
            "odometry = \"nosy\"",
            ["bad.toml:2: ", "a similar value exists: 'noisy'"],
        ),
        (
            "[options]\ntime-limt = 3",
            ["bad.toml:4: ", "'--time-limit'"],
        ),
        (
            "[options]\norder = \"nearest\"\ntime-limit = -3",
            ["bad.toml:5: ", "above 0"],
        ),
        (
            "[options]\npatrol-for = 9",
            ["bad.toml:4: ", "does not patrol"],
        ),
    ] {
        write(&folder, "bad.toml", &format!("{head}{more}\n"));
        refused(&folder, &["campaign", "bad.toml"], &words);
    }
    let text = "worlds = [\"loop\",\n  \"lop\"]\nstrategies = [\"frontier\",\n \"frontir\"]\n";
    write(&folder, "bad.toml", text);
    refused(
        &folder,
        &["campaign", "bad.toml"],
        &["bad.toml:2: ", "lop", "built-in"],
    );
    write(&folder, "bad.toml", &text.replace("lop", "cave"));
    let words = ["bad.toml:4: ", "unknown strategy 'frontir'"];
    refused(&folder, &["campaign", "bad.toml"], &words);
    let mixed = head.replace("[\"frontier\"]", "[\"frontier\", \"bvp\"]");
    write(&folder, "bad.toml", &mixed);
    let words = ["bad.toml: frontier and bvp have different odometry"];
    refused(&folder, &["campaign", "bad.toml"], &words);
    write(&folder, "bad.toml", &head.replace("loop", "loop@1"));
    refused(
        &folder,
        &["campaign", "bad.toml"],
        &["bad.toml:1: ", "say loop and starts 1"],
    );
    refused(&folder, &["campaign", "no.toml"], &["no.toml: cannot read"]);
    assert!(!folder.path().join("out").exists(), "nothing was written");
}

#[test]
fn bad_arguments_of_a_campaign_are_refused_in_one_line() {
    let folder = folder();
    write(&folder, "small.toml", SMALL);
    for (line, word) in [
        ("campaign", "FILE"),
        ("campaign small.toml --worlds loop", "cannot be used with"),
        ("campaign small.toml --shard 4/4", "say 0/4 to 3/4"),
        ("campaign small.toml --shard x", "is no shard"),
        ("campaign small.toml --jobs 0", "--jobs"),
        ("campaign --worlds loop --seeds 3..3", "'3..3'"),
        (
            "campaign --worlds loop --baseline bvp",
            "bvp is no strategy of this campaign",
        ),
        (
            "campaign --worlds loop --columns trial.x",
            "is not measured",
        ),
        ("campaign --worlds loop --name a/b", "no good name"),
        ("campaign --worlds loop -- --json", "leave it out"),
        ("campaign --worlds loop,loop", "`worlds` has loop twice"),
        ("campaign merge x", "--out"),
    ] {
        let words: Vec<&str> = line.split(' ').collect();
        refused(&folder, &words, &[word]);
    }
    let output = host_sim(&folder)
        .args(["campaign", "--help"])
        .output()
        .expect("runs");
    assert!(String::from_utf8_lossy(&output.stdout).contains("--shard"));
}

/// A robot of one of them.
const ROBOT: &str = "two-lasers.yaml";

#[test]
fn the_committed_campaigns_are_good() {
    let folder = folder();
    let campaigns = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/campaigns");
    // They name their files from the root of the repository.
    let beside = folder.path().join("tests/campaigns");
    fs::create_dir_all(&beside).expect("a folder");
    fs::copy(campaigns.join(ROBOT), beside.join(ROBOT)).expect("a robot");
    let mut counts = Vec::new();
    for file in fs::read_dir(campaigns).expect("a folder") {
        let path = file.expect("a file").path();
        if path.ends_with(ROBOT) {
            continue;
        }
        let words = ["campaign", "--list", path.to_str().expect("a name")];
        let (status, stdout, stderr) = outcome(&folder, &words);
        assert_eq!(status, 0, "{stderr}");
        assert!(
            stdout
                .lines()
                .all(|line| line.starts_with("host-sim explore ")),
            "{stdout}"
        );
        counts.push(stdout.lines().count());
    }
    counts.sort_unstable();
    assert_eq!(counts, [26, 36, 36, 60, 72, 180, 450, 450, 600]);
    assert!(!folder.path().join("out").exists(), "nothing was written");
}

#[test]
fn another_campaign_in_the_folder_and_an_unknown_column_are_named() {
    let folder = folder();
    let run = |more: &str| {
        let line = format!(
            "campaign --worlds loop --strategies frontier --out here {more} -- --time-limit 5"
        );
        let words: Vec<&str> = line.split_whitespace().collect();
        outcome(&folder, &words)
    };
    let (status, _, stderr) = run("");
    assert_eq!(status, 0, "{stderr}");
    let (status, _, stderr) = run("--seeds 0..2");
    assert_eq!(status, 2, "{stderr}");
    let words = [
        "here/campaign.toml: this folder has another campaign",
        "seeds = \"0..2\"",
    ];
    assert!(words.iter().all(|word| stderr.contains(word)), "{stderr}");
    let (status, stdout, stderr) = run("--columns coverage.fractoin,sim_time_s");
    assert_eq!(status, 0, "{stderr}");
    assert!(
        stderr.contains("did you mean coverage.fraction?"),
        "{stderr}"
    );
    assert!(stdout.contains("sim_time_s"), "{stdout}");
}

//! Whole sessions against a device, and the corpus of those that once caused a finding.
//!
//! Each case has seeds of its own. The seeds of the long cases are for judging, not for mending: a
//! fault that they find goes into the corpus, and the case gets new seeds.

use std::path::{Path, PathBuf};

use host_sim::session::campaign::Campaign;
use host_sim::session::generate::{Generator, Replayed};
use host_sim::session::judge::{Limits, stages};
use host_sim::session::play::{Played, Trial};
use host_sim::session::script::Script;
use host_sim::session::target::TargetSpec;
use host_sim::session::totals::Totals;

use crate::table::Table;

/// Number of threads that this machine runs at once.
#[must_use]
pub fn threads() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Returns true if debug assertions are on, as without `--release`.
#[must_use]
pub const fn has_assertions() -> bool {
    cfg!(debug_assertions)
}

/// Runs sessions and prints their totals.
///
/// # Panics
/// If no device can be opened.
#[must_use]
pub fn run(campaign: &Campaign) -> Totals {
    let totals = campaign.run(&|line| println!("{line}"));
    let totals = totals.unwrap_or_else(|error| panic!("{error}"));
    println!("{totals}");
    totals
}

/// Asserts that nothing was found.
///
/// # Panics
/// If anything was found. The message has the totals.
pub fn assert_clean(totals: &Totals) {
    assert!(
        totals.findings.is_empty(),
        "`host-sim sessions --generator G --seeds S..S+1` plays one session again:\n{totals}"
    );
}

/// Runs a session of each generator and seed in this process, and asserts that nothing is found and
/// that the sessions are of use: most requests are steps, and some are refused.
///
/// # Panics
/// If not.
pub fn check_in_process(generators: &[Generator], seeds: core::ops::Range<u64>) {
    let totals = run(&Campaign {
        generators: generators.to_vec(),
        seeds,
        threads: threads(),
        ..Campaign::default()
    });
    assert_clean(&totals);
    assert!(totals.steps > 8 * totals.sessions, "{totals}");
    assert!(totals.refused > totals.sessions / 10, "{totals}");
}

/// Makes a table with one line for each generator: the dearest step, the most of each stage, the
/// deepest stack.
#[must_use]
pub fn cost_table(by_generator: &[(Generator, Totals)]) -> Table {
    let names = stages(&Default::default()).map(|(name, _)| name);
    let mut columns = vec!["sessions", "count", "steps", "most"];
    columns.extend(names);
    columns.push("stack bytes");
    let mut table = Table::new(1, &columns);
    for (generator, totals) in by_generator {
        let mut row = vec![generator.name().into()];
        let counts = [totals.sessions, totals.steps, totals.instructions.0.into()];
        row.extend(counts.map(|count| count.to_string()));
        row.extend(totals.stages.iter().map(|(most, _)| most.to_string()));
        row.push(totals.stack_bytes.0.to_string());
        table.row(row);
    }
    table
}

/// Sessions that once caused a finding, with the names of their files, in order.
///
/// # Panics
/// If a file is no session.
#[must_use]
pub fn corpus() -> Vec<(String, Script)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus");
    let entries = folder.read_dir().expect("the corpus is in the repository");
    let mut paths: Vec<PathBuf> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|end| end == "jsonl"))
        .collect();
    paths.sort();
    let load = |path: PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let script = Script::load(&path).unwrap_or_else(|error| panic!("{error}"));
        (name.into_owned(), script)
    };
    paths.into_iter().map(load).collect()
}

/// Replays a session on a new device.
///
/// # Panics
/// If no device can be opened.
#[must_use]
pub fn replay(script: &Script, target: &TargetSpec) -> Played {
    let trial = Trial {
        target: target.clone(),
        capacity: script.head.capacity,
        limits: Limits::default(),
        twin: false,
    };
    let played = trial.play(&mut Replayed::new(&script.asks));
    played.unwrap_or_else(|error| panic!("{error}"))
}

/// Asserts that none of the sessions causes a finding any more.
///
/// # Panics
/// If one does. The message names its file.
pub fn assert_mended(sessions: &[(String, Script)], target: &TargetSpec) {
    let mut left = String::new();
    for (name, script) in sessions {
        for finding in replay(script, target).findings {
            left += &format!("tests/corpus/{name}: {finding}\n");
        }
    }
    assert!(left.is_empty(), "on {target}:\n{left}");
}

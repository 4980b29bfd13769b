//! Rails with and without impatience: whole explorations by `tdbvp` that leave the rails for a path
//! after 15 s without a new place, and as \[Maffei14\] has it, never.
//!
//! `golden/impatience-full.txt` has all 15 starts of the four worlds of \[Jorge15\].

use fieldline_tests::digests::Digest;
use fieldline_tests::loops::TDBVP;
use fieldline_tests::table::Table;
use fieldline_tests::{golden, worlds};
use host_sim::report::Report;
use host_sim::trial::mission::{IMPATIENCE_S, Mission};

use crate::sweep::{COLUMNS, row, sweep};

/// Worlds of the table.
const WORLDS: [&str; 4] = ["ouroboros-a", "ouroboros-b", "ouroboros-c", "ouroboros-d"];

/// Compares all starts of the worlds, with and without impatience, with golden table `name`.
pub(crate) fn check_every_start(name: &str) {
    let head: Vec<&str> = ["world", "impatience s"]
        .into_iter()
        .chain(COLUMNS)
        .collect();
    let mut table = Table::new(2, &head);
    let mut digests = Vec::new();
    for world in worlds::builtins(&WORLDS) {
        for impatience_s in [IMPATIENCE_S, None] {
            let mission = Mission {
                strategy: TDBVP.into(),
                impatience_s,
                ..Mission::default()
            };
            let reports = sweep(&world, &mission);
            let text = impatience_s.map_or("never".into(), |seconds| seconds.to_string());
            let label = [reports[0].world.clone(), text.clone()];
            table.row(label.into_iter().chain(row(&reports)).collect());
            let settings = match impatience_s {
                IMPATIENCE_S => "-".into(),
                _ => format!("impatience={text}"),
            };
            digests.extend(Digest::of_all(&reports, &settings));
            let mut impatient = reports.iter().filter(|_| impatience_s.is_some());
            assert!(impatient.all(Report::explored), "{}", world.name());
        }
    }
    golden::compare_runs(name, &format!("{table}"), &digests);
}

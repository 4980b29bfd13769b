//! Limits of loops: whole explorations by `ouroboros` with the default limits, and without a limit,
//! as \[Jorge15\] has it.
//!
//! `golden/loop-limits-full.txt` has all 15 starts of all worlds of published sizes, and
//! `docs/RESULTS.md` some of its columns.

use fieldline_protocol::message::LoopLimits;
use fieldline_tests::digests::Digest;
use fieldline_tests::loops::OUROBOROS;
use fieldline_tests::runs::mean;
use fieldline_tests::table::{Table, number};
use fieldline_tests::{golden, worlds};
use fixed::types::I16F16;
use host_sim::report::{LoopClosing, Report};
use host_sim::trial::mission::Mission;

use crate::sweep;

/// No limit: a loop of any length is worth closing, however far the robot drives for it.
const NONE: LoopLimits = LoopLimits {
    least: I16F16::ZERO,
    most: I16F16::MAX,
    most_per_frontier: I16F16::ZERO,
    detour: I16F16::MAX,
    slack: I16F16::MAX,
};

/// Columns of the golden table.
const COLUMNS: [&str; 14] = [
    "world",
    "limits",
    "runs",
    "explored",
    "loops",
    "mean s",
    "least s",
    "most s",
    "path m",
    "closed",
    "given up",
    "in vain s",
    "least known %",
    "hits",
];
/// Those of them on the page: `closed` and later ones are the device's own account.
const ON_PAGE: [usize; 9] = [0, 1, 3, 4, 5, 8, 9, 10, 11];

/// Compares all starts of the worlds, with and without limits, with golden table `name`.
pub(crate) fn check_every_start(name: &str) {
    let mut table = Table::new(2, &COLUMNS);
    let mut page = page_row(&COLUMNS) + &page_row(&["---"; COLUMNS.len()]);
    let mut digests = Vec::new();
    for world in worlds::builtins(&worlds::PUBLISHED) {
        for (limits, text) in [(LoopLimits::default(), "default"), (NONE, "none")] {
            let mission = Mission {
                strategy: OUROBOROS.into(),
                loops: limits,
                ..Mission::default()
            };
            let reports = sweep::sweep(&world, &mission);
            let row = row(&reports, text);
            page += &page_row(&row);
            table.row(row);
            let is_default = text == "default";
            let settings = if is_default { "-" } else { "loop-limits=none" };
            digests.extend(Digest::of_all(&reports, settings));
            let explored = reports.iter().all(Report::explored);
            assert!(explored || !is_default, "{}", world.name());
        }
    }
    golden::compare_runs(name, &format!("{table}"), &digests);
    golden::compare_with_docs("loop-limits", &page);
}

/// Returns a row of the page's table.
fn page_row(cells: &[impl AsRef<str>]) -> String {
    let cells = ON_PAGE.map(|column| cells[column].as_ref());
    format!("| {} |\n", cells.join(" | "))
}

/// Returns the row of these runs; the device's own account stands before the last two columns.
fn row(reports: &[Report], limits: &str) -> Vec<String> {
    let all: Vec<&Report> = reports.iter().collect();
    let closing =
        |of: fn(&LoopClosing) -> f64| number(mean(&all, |it| it.loop_closing.as_ref().map(of)), 1);
    let mut row: Vec<String> = vec![reports[0].world.clone(), limits.into()];
    row.extend(sweep::row(reports));
    let account = [
        closing(|it| f64::from(it.closed)),
        closing(|it| it.given_up.len() as f64),
        closing(|it| it.wasted_s),
    ];
    let last = row.len() - 2;
    row.splice(last..last, account);
    row
}

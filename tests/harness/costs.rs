//! Cost of a step on the emulated chip: instructions, counted exactly, and the deepest stack.
//!
//! Instructions are not cycles: a Cortex-M4 takes one or two cycles for most of them.

use host_sim::report::Report;

use crate::golden;
use crate::table::Table;

/// Most instructions of a step on flat ground, alone or in a team: about 50 ms at 168 MHz.
pub const MOST_INSTRUCTIONS: f64 = 6e6;
/// Most instructions of a step on uneven ground.
pub const MOST_UNEVEN: f64 = 7e6;

/// Share by which figures may differ from the golden ones: compilers arrange the code differently.
pub const DRIFT: f64 = 0.05;

/// Makes a table with one line for each run: instructions of a step, then the most of each stage.
///
/// The stages' maxima may come from different steps.
#[must_use]
pub fn table(reports: &[Report]) -> Table {
    let columns = [
        "world",
        "steps",
        "p50",
        "p99",
        "most",
        "session",
        "sense",
        "topology",
        "plan",
        "window",
        "solve",
        "drive",
        "stack bytes",
    ];
    let mut table = Table::new(1, &columns);
    for report in reports {
        let of = report.planner.instructions.unwrap_or_default();
        let mut row = vec![report.world.clone(), report.steps.to_string()];
        row.extend([of.p50, of.p99, of.max].map(|count| format!("{count:.0}")));
        let stages = report.planner.stage_instructions.unwrap_or_default();
        row.extend(stages.by_name().map(|(_, of)| format!("{:.0}", of.max)));
        row.push(report.planner.stack_bytes.unwrap_or(0).to_string());
        table.row(row);
    }
    table
}

/// Asserts that every step was counted and that none took too long.
fn assert_within_budget(reports: &[Report]) {
    for report in reports {
        let most = if report.true_ground.is_some() {
            MOST_UNEVEN
        } else {
            MOST_INSTRUCTIONS
        };
        let world = &report.world;
        let Some(of) = report.planner.instructions else {
            panic!("{world}: nothing was counted");
        };
        assert!(of.p50 > 0.0 && of.max <= most, "{world}: {of:?}");
        assert!(
            report.planner.stack_bytes.is_some(),
            "{world}: no stack was measured"
        );
    }
}

/// Compares with golden file `name` and with the budget.
///
/// # Panics
/// If the figures differ, or a run exceeds the budget.
pub fn check(name: &str, reports: &[Report]) {
    golden::compare_about(name, &table(reports).to_string(), DRIFT);
    assert_within_budget(reports);
}

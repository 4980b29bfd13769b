//! Milliseconds of a step on the chip, by the model of its cycles (`docs/CYCLES.md`).
//!
//! The model runs beside the emulator. It errs to the fast side: a chip takes 4 % more, and between
//! 2 % less and 12 % more.

use fieldline_cycles::{CLOCK_HZ, MODEL, milliseconds};
use host_sim::report::Report;

use crate::costs::DRIFT;
use crate::golden;
use crate::table::Table;

/// Most milliseconds of a step by the model. A period has 200.
pub const MOST_MS: f64 = 60.0;

/// Makes a table with one line for each run: milliseconds of a step, cycles for an instruction, and
/// the stage that takes most in one step.
#[must_use]
pub fn table(reports: &[Report]) -> Table {
    let columns = [
        "world",
        "steps",
        "p50 ms",
        "p99 ms",
        "most ms",
        "cycles/instruction",
        "dearest stage",
        "its p50 ms",
        "its most ms",
    ];
    let mut table = Table::new(1, &columns);
    for report in reports {
        let planner = &report.planner;
        let ms = planner.ms.unwrap_or_default();
        let mut row = vec![report.world.clone(), report.steps.to_string()];
        row.extend([ms.p50, ms.p99, ms.max].map(|ms| format!("{ms:.1}")));
        let cycles = planner.cycles.unwrap_or_default().p50;
        let ratio = cycles / planner.instructions.unwrap_or_default().p50;
        row.push(format!("{ratio:.2}"));
        let stages = planner.stage_cycles.unwrap_or_default().by_name();
        let dearest = stages
            .into_iter()
            .max_by(|(_, a), (_, b)| a.max.total_cmp(&b.max));
        if let Some((name, of)) = dearest {
            row.push(name.into());
            row.extend([of.p50, of.max].map(|cycles| format!("{:.1}", milliseconds(cycles))));
        }
        table.row(row);
    }
    table
}

/// Compares with golden file `name`, and with the limit.
///
/// # Panics
/// If the figures differ, if a run has none, or if a step takes longer than [`MOST_MS`].
pub fn check(name: &str, reports: &[Report]) {
    let head = format!("by the model {MODEL}, at {} MHz", CLOCK_HZ / 1_000_000);
    golden::compare_about(name, &format!("{head}\n{}", table(reports)), DRIFT);
    for report in reports {
        let (world, ms) = (&report.world, report.planner.ms);
        let Some(ms) = ms else {
            panic!("{world}: no cycles were counted");
        };
        assert!(ms.p50 > 1.0 && ms.max <= MOST_MS, "{world}: {ms:?}");
    }
}

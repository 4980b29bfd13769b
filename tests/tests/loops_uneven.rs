//! Loops and patrols on uneven ground: `--strategy ouroboros --preference both`, and `tdbvp` the same. No paper has both.
//!
//! `golden/loops-uneven.txt` has the first start of two worlds: low ground and a plateau with holes to fall into, and a causeway with
//! drops beside it. `tests/run --full` adds three starts of each in the other worlds, `loops-uneven-full.txt`.

use core::fmt::Write as _;

use fieldline_tests::loops::{self, OUROBOROS, TDBVP};
use fieldline_tests::runs::{self, Unseen};
use fieldline_tests::{full, golden, worlds};
use host_sim::link::direct::Direct;
use host_sim::report::Report;
use host_sim::trial::mission::{Mission, explore};
use host_sim::trial::uneven::TABLE_I;

/// Share that must be known at the end.
const LEAST_COVERAGE: f64 = 0.98;

fn run(world: &str, strategy: &str, start: usize) -> Report {
    let mission = Mission {
        strategy: strategy.into(),
        terrain: Some(TABLE_I),
        start,
        ..Mission::default()
    };
    let world = worlds::builtin(world);
    let run = explore(&mission, &world, &mut Direct::new(), &mut Unseen);
    run.expect("the start is free").0
}

fn check(name: &str, names: &[&str], starts: usize) {
    let mut reports = Vec::new();
    for &world in names {
        for strategy in [OUROBOROS, TDBVP] {
            let starts = 0..starts.min(worlds::builtin(world).starts().len());
            reports.extend(starts.map(|start| run(world, strategy, start)));
        }
    }
    let text = format!("{}\n{}", loops::means(&reports), loops::table(&reports));
    golden::compare(name, &text);
    let mut wrong = String::new();
    for report in &reports {
        for fault in runs::faults(report, LEAST_COVERAGE) {
            let (world, strategy, start) = (&report.world, &report.strategy, report.start);
            let _ = writeln!(wrong, "{world} {strategy} start {start}: {fault}");
        }
    }
    assert!(wrong.is_empty(), "\n{wrong}");
}

#[test]
fn loops_and_rails_keep_off_holes_and_drops() {
    check("loops-uneven.txt", &["holes", "causeway"], 1);
}

#[test]
fn loops_and_rails_of_more_starts_keep_off_holes_and_drops() {
    if !full() {
        return println!("skipped: FIELDLINE_FULL=1 or tests/run --full asks for it");
    }
    check(
        "loops-uneven-full.txt",
        &["slope", "holes", "building", "cliff"],
        3,
    );
}

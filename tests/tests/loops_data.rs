//! Loops and patrols in worlds drawn by others: five starts each, both strategies, a golden table.
//!
//! `tests/run --full` makes `golden/loops-data.txt` where there are such worlds. They have one start each; the others are drawn
//! at random, once and for all. The `frontier` of the same starts stands beside.

use core::fmt::Write as _;

use fieldline_tests::loops::{self, OUROBOROS, TDBVP};
use fieldline_tests::runs::{self, FRONTIER, Run};
use fieldline_tests::table::Table;
use fieldline_tests::{full, golden, starts, worlds};
use host_sim::world::World;

/// Share of what can be seen that must be known at the end.
const LEAST_COVERAGE: f64 = 0.98;
/// Starts in each world, and what they are drawn from.
const STARTS: usize = 5;
const SEED: u64 = 4;

/// Where the robot was put down: what a world file's `robots` would say.
fn places(worlds: &[World]) -> Table {
    let mut table = Table::new(1, &["world", "start", "x m", "y m", "yaw rad"]);
    for world in worlds {
        for (start, at) in world.starts().iter().enumerate() {
            table.row(vec![
                world.name().into(),
                start.to_string(),
                format!("{:.3}", at.x_m),
                format!("{:.3}", at.y_m),
                format!("{:.3}", at.yaw_rad),
            ]);
        }
    }
    table
}

#[test]
fn worlds_drawn_by_others_are_explored_from_any_start() {
    if !full() {
        return println!("skipped: FIELDLINE_FULL=1 or tests/run --full asks for it");
    }
    let Some(worlds) = worlds::drawn_by_others() else {
        return;
    };
    let worlds: Vec<World> = worlds
        .iter()
        .map(|world| starts::drawn(world, STARTS, SEED))
        .collect();
    let mut list = Vec::new();
    for world in &worlds {
        for strategy in [OUROBOROS, TDBVP, FRONTIER] {
            list.extend((0..STARTS).map(|start| Run {
                world,
                strategy,
                seed: 0,
                start,
            }));
        }
    }
    let reports = runs::sweep(&list);
    let text = format!(
        "{}\n{}\n{}",
        loops::means(&reports),
        loops::table(&reports),
        places(&worlds)
    );
    golden::compare("loops-data.txt", &text);
    let mut wrong = String::new();
    for report in reports.iter().filter(|r| r.strategy != FRONTIER) {
        for fault in runs::faults(report, LEAST_COVERAGE) {
            let (world, strategy, start) = (&report.world, &report.strategy, report.start);
            let _ = writeln!(wrong, "{world} {strategy} start {start}: {fault}");
        }
    }
    assert!(wrong.is_empty(), "\n{wrong}");
}

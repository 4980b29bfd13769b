//! Loops that are closed on the way: whole explorations of the published worlds, true odometry, a golden table.
//!
//! `golden/loops.txt` has the first start of three worlds. `tests/run --full` adds `loops-full.txt`: all 15 starts of every world.
//! Loops are judged on the true path: islands of the world that the robot went all the way round. Beside the device's strategies stand
//! the BVP exploration over the full grid, which the papers compare with, and the papers' own ratios.

use core::fmt::Write as _;

use fieldline_tests::loops::{self, BVP, OUROBOROS, TDBVP};
use fieldline_tests::runs::{self, FRONTIER, Run};
use fieldline_tests::{full, golden, worlds};
use host_sim::report::Report;
use host_sim::world::World;

/// Share that must be known at the end, of every world and of the one with scattered obstacles.
const LEAST_COVERAGE: f64 = 0.995;
const LEAST_AMONG_TREES: f64 = 0.988;

fn each<'a>(worlds: &'a [World], starts: usize, strategies: &[&'static str]) -> Vec<Run<'a>> {
    let mut runs = Vec::new();
    for world in worlds {
        for &strategy in strategies {
            let starts = 0..starts.min(world.starts().len());
            runs.extend(starts.map(|start| Run {
                world,
                strategy,
                seed: 0,
                start,
            }));
        }
    }
    runs
}

fn faults(report: &Report) -> Vec<String> {
    let least = match report.world.as_str() {
        "ouroboros-d" => LEAST_AMONG_TREES,
        _ => LEAST_COVERAGE,
    };
    let mut faults = runs::faults(report, least);
    let loops = &report.loops;
    if report.strategy == OUROBOROS && loops.loops_closed < loops.loops {
        faults.push(format!(
            "{} of {} loops closed",
            loops.loops_closed, loops.loops
        ));
    }
    faults
}

fn assert_closed(reports: &[Report]) {
    let mut list = String::new();
    // What the baseline does is its own.
    for report in reports.iter().filter(|report| report.strategy != BVP) {
        for fault in faults(report) {
            let (world, strategy, start) = (&report.world, &report.strategy, report.start);
            let _ = writeln!(list, "{world} {strategy} start {start}: {fault}");
        }
    }
    assert!(list.is_empty(), "\n{list}");
}

fn check(name: &str, names: &[&str], starts: usize, strategies: &[&'static str]) {
    let worlds: Vec<World> = names.iter().map(|name| worlds::builtin(name)).collect();
    let reports = runs::sweep(&each(&worlds, starts, strategies));
    let text = format!("{}\n{}", loops::means(&reports), loops::table(&reports));
    golden::compare(name, &text);
    assert_closed(&reports);
}

#[test]
fn loops_are_closed_on_the_way() {
    check(
        "loops.txt",
        &["ouroboros-a", "ouroboros-d", "tdbvp-nested"],
        1,
        &[OUROBOROS, TDBVP, FRONTIER, BVP],
    );
}

#[test]
fn loops_of_every_start_are_closed_on_the_way() {
    if !full() {
        return println!("skipped: FIELDLINE_FULL=1 or tests/run --full asks for it");
    }
    check(
        "loops-full.txt",
        &worlds::PUBLISHED,
        usize::MAX,
        &[OUROBOROS, TDBVP, FRONTIER, BVP],
    );
}

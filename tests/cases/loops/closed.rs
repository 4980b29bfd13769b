//! Loops closed on the way: whole explorations of worlds of published sizes, with true odometry.
//!
//! `golden/loops.txt` has the first start of three worlds, `loops-full.txt` all 15 starts of all
//! worlds. Loops are judged on the true path: islands of the world that the robot went all the way
//! round. The tables also have the exploration over the full grid that the papers compare with, and
//! the papers' own ratios.

use fieldline_tests::digests::Digest;
use fieldline_tests::loops::{self, BVP, OUROBOROS, TDBVP};
use fieldline_tests::runs::{self, FRONTIER, Run, assert_faultless};
use fieldline_tests::{golden, worlds};
use host_sim::report::Report;
use host_sim::world::World;

/// Least share known at the end.
const LEAST_COVERAGE: f64 = 0.995;
/// Least share known at the end of the world with scattered obstacles.
const LEAST_AMONG_TREES: f64 = 0.988;
/// Strategies of the tables.
const STRATEGIES: [&str; 4] = [OUROBOROS, TDBVP, FRONTIER, BVP];

/// Lists runs of every world and strategy from the first `starts` starts, with seed 0.
pub(crate) fn each<'a>(
    worlds: &'a [World],
    starts: usize,
    strategies: &[&'static str],
) -> Vec<Run<'a>> {
    let mut runs = Vec::new();
    for world in worlds {
        for &strategy in strategies {
            let starts = 0..starts.min(world.starts().len());
            runs.extend(starts.map(|start| Run {
                start,
                ..Run::first(world, strategy)
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
    let (closed, all) = (report.loops.circled, report.loops.islands);
    if report.strategy == OUROBOROS && closed < all {
        faults.push(format!("{closed} of {all} loops closed"));
    }
    faults
}

fn check(name: &str, names: &[&str], starts: usize) {
    let worlds = worlds::builtins(names);
    let reports = runs::sweep(&each(&worlds, starts, &STRATEGIES));
    let text = format!("{}\n{}", loops::means(&reports), loops::table(&reports));
    golden::compare_runs(name, &text, &Digest::of_all(&reports, "-"));
    // The baseline is there to compare with; nothing is asked of it.
    let device = reports.iter().filter(|report| report.strategy != BVP);
    assert_faultless(device, faults);
}

/// Compares all starts of all worlds with golden table `name`.
pub(crate) fn check_every_start(name: &str) {
    check(name, &worlds::PUBLISHED, usize::MAX);
}

#[test]
fn loops_are_closed_on_the_way() {
    check("loops", &["ouroboros-a", "ouroboros-d", "tdbvp-nested"], 1);
}

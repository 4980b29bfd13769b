//! Loops and patrols on uneven ground: `ouroboros` and `tdbvp` with `--preference both`. No paper
//! has this combination.
//!
//! `golden/loops-uneven.txt` has the first start of two worlds: low ground and a plateau with
//! holes, and a causeway with drops beside it.

use fieldline_tests::digests::Digest;
use fieldline_tests::loops::{self, OUROBOROS, TDBVP};
use fieldline_tests::runs::{self, Run, assert_faultless, explored, in_parallel};
use fieldline_tests::{golden, worlds};
use host_sim::link::direct::Direct;
use host_sim::report::Report;
use host_sim::trial::mission::Mission;
use host_sim::trial::uneven::TABLE_I;

use crate::closed::each;

/// Least share known at the end.
const LEAST_COVERAGE: f64 = 0.98;

fn go(run: &Run<'_>) -> Report {
    let mission = Mission {
        strategy: run.strategy.into(),
        uneven_ground: Some(TABLE_I),
        start: run.start,
        ..Mission::default()
    };
    explored(&mission, run.world, &mut Direct::new()).0
}

/// Compares runs from the first `starts` starts with golden table `name`.
pub(crate) fn check(name: &str, names: &[&str], starts: usize) {
    let worlds = worlds::builtins(names);
    let reports = in_parallel(&each(&worlds, starts, &[OUROBOROS, TDBVP]), go);
    let text = format!("{}\n{}", loops::means(&reports), loops::table(&reports));
    let digests = Digest::of_all(&reports, "preference=both");
    golden::compare_runs(name, &text, &digests);
    assert_faultless(&reports, |report| runs::faults(report, LEAST_COVERAGE));
}

#[test]
fn loops_and_rails_keep_off_holes_and_drops() {
    check("loops-uneven", &["holes", "causeway"], 1);
}

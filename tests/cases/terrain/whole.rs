//! Every built-in uneven world explored once, and the slope without preferences.
//!
//! `golden/terrain.txt` has the runs, `golden/truth.txt` their maps against the true ground, and
//! `golden/flatness.txt` says how flat their fields were. The documentation shows a part of the
//! first. A changed row is a changed behaviour.

use fieldline_protocol::message::Preference;
use fieldline_tests::uneven::{self, Summary, UnevenRun};
use fieldline_tests::{flatness, golden, truth, worlds};

use crate::shared::{FIRST, assert_explored};

#[test]
fn uneven_worlds_are_explored_and_nothing_is_touched() {
    let mut runs: Vec<Summary> = FIRST.iter().map(|(summary, _)| summary.clone()).collect();
    let slope = worlds::builtin(worlds::UNEVEN[0]);
    let without = UnevenRun {
        preference: Preference::Off,
        ..UnevenRun::of(&slope, 0, 0)
    };
    runs.insert(1, without.go());
    let text = uneven::table(&runs).to_string();
    golden::compare_runs("terrain", &text, &uneven::digests(&runs));
    assert_explored(&runs);
    runs.remove(1);
    let worlds = runs.iter();
    let flatness = worlds.map(|run| (run.report.world.clone(), [&run.flatness]));
    golden::compare("flatness.txt", &flatness::table(flatness).to_string());
    golden::compare("truth.txt", &truth::text(&runs));
    golden::compare_with_docs("uneven", &uneven::markdown(&runs));
    truth::assert_classified(&runs);
}

//! Loops and patrols in worlds drawn by others, which `FIELDLINE_DATA` names: five starts each.
//!
//! The worlds have one start each. The other four are drawn at random from a fixed seed. The table
//! `golden/loops-data.txt` also has `frontier` from the same starts.

use fieldline_tests::digests::Digest;
use fieldline_tests::loops::{self, OUROBOROS, TDBVP};
use fieldline_tests::runs::{self, FRONTIER, assert_faultless};
use fieldline_tests::table::Table;
use fieldline_tests::{golden, starts, worlds};
use host_sim::world::World;

use crate::closed::each;

/// Least share of what can be seen that is known at the end.
const LEAST_COVERAGE: f64 = 0.98;
/// Starts in each world.
const STARTS: usize = 5;
/// Seed of the drawn starts.
const SEED: u64 = 4;

/// Makes a table of the starts, as `robots` of a world file has them.
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
#[ignore = "needs worlds drawn by others (FIELDLINE_DATA) and takes hours"]
fn flat_worlds_are_explored_from_any_start() {
    let worlds: Vec<World> = worlds::drawn_by_others()
        .iter()
        .map(|world| starts::drawn(world, STARTS, SEED))
        .collect();
    let reports = runs::sweep(&each(&worlds, STARTS, &[OUROBOROS, TDBVP, FRONTIER]));
    let text = format!(
        "{}\n{}\n{}",
        loops::means(&reports),
        loops::table(&reports),
        places(&worlds)
    );
    golden::compare_runs(
        "loops-data",
        &text,
        &Digest::of_all(&reports, "starts=drawn"),
    );
    let closing = reports.iter().filter(|report| report.strategy != FRONTIER);
    assert_faultless(closing, |report| runs::faults(report, LEAST_COVERAGE));
}

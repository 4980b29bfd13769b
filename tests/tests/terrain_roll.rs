//! What a limit of the roll changes: five uneven worlds with it and without, in `terrain-roll.txt`.
//!
//! `beyond` is the time spent with more roll or pitch than the 3-AT's limits, 15° and 20°. A changed row is a changed behaviour.

use fieldline_tests::runs::{self, in_parallel};
use fieldline_tests::table::Table;
use fieldline_tests::uneven::{Told, Tour};
use fieldline_tests::{golden, worlds};
use host_sim::world::World;

/// Worlds with slopes that may be climbed and not crossed, and others beside.
const WORLDS: [&str; 5] = ["slope", "holes", "cliff", "waves", "pass"];
/// The limits compared, degrees: the 3-AT's, and as much as the climb, which is none.
const LIMITS_DEG: [f64; 2] = [15.0, 20.0];
/// Share of what can be reached that must be known at the end.
const LEAST_COVERAGE: f64 = 0.97;
/// Share of the time beyond the limits that is left with the limit of the roll, in all worlds together.
const MOST_BEYOND: f64 = 0.2;

fn beyond_s(run: &Told) -> f64 {
    run.report.terrain.unwrap_or_default().over_limits_s
}

/// One line a run.
fn table<'a>(runs: impl Iterator<Item = (&'a Told, f64)>) -> Table {
    let columns = [
        "world",
        "roll limit",
        "ended",
        "known %",
        "time s",
        "path m",
        "climb m",
        "greatest roll deg",
        "beyond s",
    ];
    let mut table = Table::new(1, &columns);
    for (run, limit_deg) in runs {
        let report = &run.report;
        let ride = report.terrain.unwrap_or_default();
        table.row(vec![
            report.world.clone(),
            format!("{limit_deg}"),
            format!("{}({})", report.outcome.status, report.outcome.reason),
            format!("{:.2}", 100.0 * report.coverage.fraction),
            format!("{:.1}", report.sim_time_s),
            format!("{:.1}", report.path_length_m),
            format!("{:.2}", report.climb_m),
            format!("{:.1}", ride.max_side_deg),
            format!("{:.1}", ride.over_limits_s),
        ]);
    }
    table
}

#[test]
fn a_limit_of_the_roll_is_kept_to() {
    let worlds: Vec<World> = WORLDS.map(worlds::builtin).into();
    let tours: Vec<Tour<'_>> = worlds
        .iter()
        .flat_map(|world| {
            LIMITS_DEG.map(|limit_deg| Tour {
                roll_deg: Some(limit_deg),
                ..Tour::of(world, 0, 0)
            })
        })
        .collect();
    let runs = in_parallel(&tours, Tour::go);
    let lines = || runs.iter().zip(LIMITS_DEG.into_iter().cycle());
    golden::compare("terrain-roll.txt", &table(lines()).to_string());
    let beyond_with = |limit_deg: f64| -> f64 {
        let of = lines().filter(|(_, limit)| *limit == limit_deg);
        of.map(|(run, _)| beyond_s(run)).sum()
    };
    let [with, without] = LIMITS_DEG.map(beyond_with);
    assert!(with <= MOST_BEYOND * without, "{with} s of {without} s");
    for run in &runs {
        let faults = runs::faults(&run.report, LEAST_COVERAGE);
        assert!(faults.is_empty(), "{}: {faults:?}", run.report.world);
    }
}

//! The effect of the roll limit: five uneven worlds with a limit of 15° and with one of 20°, which
//! is as much as the climb limit and so no limit of its own. The table is
//! `golden/terrain-roll.txt`.
//!
//! `beyond` is the time with more roll than the 3-AT's 15° or more pitch than its 20°.

use fieldline_tests::golden;
use fieldline_tests::table::Table;
use fieldline_tests::uneven::{Summary, UnevenRun};
use fieldline_tests::worlds;
use host_sim::trial::uneven::{TABLE_I, radians};

use crate::shared::{FIRST, assert_explored, explore};

/// Worlds with slopes that may be climbed and not crossed, and others to compare.
const WORLDS: [&str; 5] = ["slope", "holes", "cliff", "waves", "pass"];
/// The 3-AT's limit, degrees.
const LIMIT_DEG: f64 = 15.0;
/// The usual limit, degrees.
const USUAL_DEG: f64 = 20.0;
/// Most of the time beyond the limits that is left with the limit of the roll, as a share.
const MOST_BEYOND: f64 = 0.2;

fn beyond_s(run: &Summary) -> f64 {
    run.report.true_ground.unwrap_or_default().over_limits_s
}

/// Makes a table with one line for each run and its limit.
fn table(runs: &[(&Summary, f64)]) -> Table {
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
        let ride = report.true_ground.unwrap_or_default();
        table.row(vec![
            report.world.clone(),
            format!("{limit_deg}"),
            format!("{}({})", report.outcome.status, report.outcome.reason),
            format!("{:.2}", 100.0 * report.coverage.fraction),
            format!("{:.1}", report.sim_time_s),
            format!("{:.1}", report.path_length_m),
            format!("{:.2}", report.height_change_m),
            format!("{:.1}", ride.max_roll_deg),
            format!("{:.1}", ride.over_limits_s),
        ]);
    }
    table
}

#[test]
fn the_robot_keeps_to_the_roll_limit() {
    assert_eq!(TABLE_I.roll, radians(USUAL_DEG), "the first runs have it");
    let worlds = worlds::builtins(&WORLDS);
    let to_run: Vec<UnevenRun<'_>> = worlds
        .iter()
        .map(|world| UnevenRun {
            roll_deg: Some(LIMIT_DEG),
            ..UnevenRun::of(world, 0, 0)
        })
        .collect();
    let with = explore(&to_run);
    let without = |world: &str| {
        let runs = FIRST.iter().map(|(summary, _)| summary);
        let mut of_world = runs.filter(|summary| summary.report.world == world);
        of_world.next().expect("every uneven world was run")
    };
    let lines: Vec<(&Summary, f64)> = with
        .iter()
        .flat_map(|run| [(run, LIMIT_DEG), (without(&run.report.world), USUAL_DEG)])
        .collect();
    golden::compare("terrain-roll.txt", &table(&lines).to_string());
    let beyond_with = |limit_deg: f64| -> f64 {
        let of = lines.iter().filter(|(_, limit)| *limit == limit_deg);
        of.map(|(run, _)| beyond_s(run)).sum()
    };
    let [with_s, without_s] = [LIMIT_DEG, USUAL_DEG].map(beyond_with);
    assert!(
        with_s <= MOST_BEYOND * without_s,
        "{with_s} s of {without_s} s"
    );
    assert_explored(lines.iter().map(|(run, _)| *run));
}

//! Explorations of a world from all its starts, and their row in a table.

use fieldline_tests::runs::{explored, in_parallel, mean};
use fieldline_tests::table::number;
use host_sim::link::direct::Direct;
use host_sim::report::Report;
use host_sim::trial::mission::Mission;
use host_sim::world::World;

/// Columns of [`row`], after that of the variant.
pub(crate) const COLUMNS: [&str; 9] = [
    "runs",
    "explored",
    "loops",
    "mean s",
    "least s",
    "most s",
    "path m",
    "least known %",
    "hits",
];

/// Explores from every start.
pub(crate) fn sweep(world: &World, mission: &Mission) -> Vec<Report> {
    let starts: Vec<usize> = (0..world.starts().len()).collect();
    in_parallel(&starts, |&start| {
        let mission = Mission {
            start,
            ..mission.clone()
        };
        explored(&mission, world, &mut Direct::new()).0
    })
}

/// Returns the row of these runs, without world and variant.
pub(crate) fn row(reports: &[Report]) -> [String; COLUMNS.len()] {
    let sum = |of: fn(&Report) -> u32| reports.iter().map(of).sum::<u32>();
    let all: Vec<&Report> = reports.iter().collect();
    let times = || reports.iter().map(|report| report.sim_time_s);
    let known = reports
        .iter()
        .map(|report| 100.0 * report.coverage.fraction);
    let explored = reports.iter().filter(|report| report.explored());
    let (circled, islands) = (sum(|it| it.loops.circled), sum(|it| it.loops.islands));
    [
        reports.len().to_string(),
        explored.count().to_string(),
        format!("{circled}/{islands}"),
        number(mean(&all, |it| Some(it.sim_time_s)), 1),
        number(times().reduce(f64::min), 1),
        number(times().reduce(f64::max), 1),
        number(mean(&all, |it| Some(it.path_length_m)), 1),
        number(known.reduce(f64::min), 2),
        sum(|it| it.safety.collisions).to_string(),
    ]
}

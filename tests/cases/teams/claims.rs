//! What claims on goals buy: teams with claims of different weight. `golden/teams-claims.txt` has
//! the figures, on seeds that no other table of teams has.

use core::ops::Range;

use fieldline_planner::Tuning;
use fieldline_tests::golden;
use fieldline_tests::runs::{in_parallel, tuned};
use fieldline_tests::table::Table;
use fieldline_tests::teams::TeamRun;
use fieldline_tests::worlds;
use host_sim::link::Link;
use host_sim::link::direct::Direct;
use host_sim::report::TeamReport;

/// Seeds of every line.
const SEEDS: Range<u64> = 100..105;
/// Factors of the gain of a claimed goal; 1 is no claims.
const FACTORS: [f32; 4] = [1.0, 0.5, 0.2, 0.05];

/// Explores with tuned constants.
fn go(run: &TeamRun<'_>, tuning: &'static Tuning) -> TeamReport {
    let link = |_| -> Box<dyn Link> { Box::new(Direct::tuned(tuning)) };
    run.go_by((0..run.robots).map(link).collect()).0
}

mod full {
    use super::*;

    #[test]
    #[ignore = "takes minutes: 360 runs of up to four robots; tests/run --full runs it"]
    fn claims_of_different_weight() {
        let worlds = worlds::builtins(&["office", "hall", "cave"]);
        let mut table = Table::new(
            1,
            &[
                "starts",
                "robots",
                "claimed",
                "office T99 s",
                "hall",
                "cave",
                "end s",
                "path m",
                "contacts",
            ],
        );
        for (apart, robots) in [false, true]
            .into_iter()
            .flat_map(|it| (2..=4).map(move |n| (it, n)))
        {
            for factor in FACTORS {
                let tuning = tuned(&[("order.claimed", factor)]);
                let runs: Vec<TeamRun<'_>> = worlds
                    .iter()
                    .flat_map(|world| SEEDS.map(move |seed| (world, seed)))
                    .map(|(world, seed)| TeamRun {
                        apart,
                        seed,
                        ..TeamRun::of(world, robots)
                    })
                    .collect();
                let reports = in_parallel(&runs, |run| go(run, tuning));
                let mean = |reports: &[TeamReport], of: fn(&TeamReport) -> f64| {
                    let sum: f64 = reports.iter().map(of).sum();
                    format!("{:.1}", sum / reports.len() as f64)
                };
                let mut row = vec![
                    if apart { "apart" } else { "beside" }.into(),
                    robots.to_string(),
                    factor.to_string(),
                ];
                for same in reports.chunks(SEEDS.count()) {
                    row.push(mean(same, |it| it.whole.coverage.t99_s.expect("99 %")));
                }
                row.push(mean(&reports, |it| it.whole.sim_time_s));
                row.push(mean(&reports, |it| it.whole.path_length_m));
                let contacts = reports
                    .iter()
                    .filter_map(|it| it.whole.safety.robot_contacts);
                row.push(contacts.sum::<u32>().to_string());
                table.row(row);
                assert!(reports.iter().all(|report| report.whole.explored()));
            }
        }
        golden::compare(
            "teams-claims.txt",
            &format!("Means over seeds {SEEDS:?}.\n\n{table}"),
        );
    }
}

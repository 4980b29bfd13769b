//! Tables of explorations of flat worlds, with the baselines beside.
//!
//! Units: seconds of simulated time, metres, per cent of what can be seen. T90 and T99 are the
//! times at which 90 % and 99 % of it were known.

use host_sim::report::Report;

use crate::runs::{BASELINES, FRONTIER, mean};
use crate::table::{Table, number};

/// Makes a table with one line for each run.
#[must_use]
pub fn table(reports: &[Report]) -> Table {
    let mut table = Table::new(
        3,
        &[
            "world", "strategy", "ended", "seed", "known %", "T90 s", "T99 s", "end s", "path m",
            "overlap", "hits", "clear m", "left",
        ],
    );
    for report in reports {
        let (coverage, safety) = (&report.coverage, &report.safety);
        table.row(vec![
            report.world.clone(),
            report.strategy.clone(),
            format!("{}({})", report.outcome.status, report.outcome.reason),
            report.seed.to_string(),
            format!("{:.2}", coverage.fraction * 100.0),
            number(coverage.t90_s, 1),
            number(coverage.t99_s, 1),
            format!("{:.1}", report.sim_time_s),
            format!("{:.1}", report.path_length_m),
            number(report.path_overlap, 3),
            (safety.collisions + safety.falls + safety.tips).to_string(),
            number(safety.min_clearance_m, 3),
            report.outcome.residual_frontiers.len().to_string(),
        ]);
    }
    table
}

/// Makes a table with one line for each world: the mean T99 of the device's strategy and of the
/// better baseline.
///
/// A baseline with a run that did not reach 99 % is not the better one. The ratio is above 1 where
/// the device is slower.
#[must_use]
pub fn beside(reports: &[Report]) -> Table {
    let mut table = Table::new(
        2,
        &["world", "better baseline", "its T99 s", "T99 s", "ratio"],
    );
    for group in reports.chunk_by(|a, b| a.world == b.world) {
        let t99_s = |strategy: &str| {
            let runs: Vec<&Report> = group.iter().filter(|r| r.strategy == strategy).collect();
            mean(&runs, |report| report.coverage.t99_s)
        };
        let better = BASELINES
            .iter()
            .filter_map(|name| Some((*name, t99_s(name)?)))
            .min_by(|a, b| a.1.total_cmp(&b.1));
        let (own_s, its_s) = (t99_s(FRONTIER), better.map(|(_, t99_s)| t99_s));
        table.row(vec![
            group[0].world.clone(),
            better.map_or("-", |(name, _)| name).into(),
            number(its_s, 1),
            number(own_s, 1),
            number(own_s.zip(its_s).map(|(own, its)| own / its), 2),
        ]);
    }
    table
}

/// Makes a table with one line for each world and strategy, over its seeds.
///
/// T99 is a mean only where every run reached 99 %; `hits` and `unfinished` are sums.
#[must_use]
pub fn means(reports: &[Report]) -> Table {
    let mut table = Table::new(
        2,
        &[
            "world",
            "strategy",
            "known %",
            "T90 s",
            "T99 s",
            "path m",
            "overlap",
            "hits",
            "unfinished",
        ],
    );
    for group in reports.chunk_by(|a, b| (&a.world, &a.strategy) == (&b.world, &b.strategy)) {
        let runs: Vec<&Report> = group.iter().collect();
        let mean = |of: &dyn Fn(&Report) -> Option<f64>| mean(&runs, of);
        let hits = |r: &Report| r.safety.collisions + r.safety.falls + r.safety.tips;
        table.row(vec![
            group[0].world.clone(),
            group[0].strategy.clone(),
            number(mean(&|r| Some(r.coverage.fraction * 100.0)), 2),
            number(mean(&|r| r.coverage.t90_s), 1),
            number(mean(&|r| r.coverage.t99_s), 1),
            number(mean(&|r| Some(r.path_length_m)), 1),
            number(mean(&|r| r.path_overlap), 3),
            group.iter().map(hits).sum::<u32>().to_string(),
            group.iter().filter(|r| !r.explored()).count().to_string(),
        ]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::{beside, means};
    use crate::runs::{FRONTIER, Run};
    use crate::worlds::builtin;
    use host_sim::report::Report;

    /// Reports of one world with the given strategies and times.
    fn reports_of(rows: &[(&str, Option<f64>)]) -> Vec<Report> {
        let world = builtin("boxed-in");
        let blank = Run::first(&world, FRONTIER).go();
        let report = |&(strategy, t99_s): &(&str, Option<f64>)| {
            let mut report = blank.clone();
            report.strategy = strategy.into();
            report.coverage.t99_s = t99_s;
            report
        };
        rows.iter().map(report).collect()
    }

    #[test]
    fn a_baseline_that_did_not_reach_99_percent_is_not_better() {
        let reports = reports_of(&[
            ("frontier", Some(100.0)),
            ("frontier", Some(110.0)),
            ("bvp", Some(60.0)),
            ("bvp", None),
            ("greedy-frontier", Some(80.0)),
            ("greedy-frontier", Some(88.0)),
        ]);
        let text = beside(&reports).to_string();
        let row: Vec<&str> = text.lines().nth(1).unwrap().split_whitespace().collect();
        assert_eq!(
            row,
            ["boxed-in", "greedy-frontier", "84.0", "105.0", "1.25"]
        );
        let text = beside(&reports_of(&[("frontier", None), ("bvp", Some(1.0))])).to_string();
        assert!(
            text.ends_with("bvp                    1.0      -      -\n"),
            "{text}"
        );
    }

    #[test]
    fn a_mean_needs_a_value_of_every_run() {
        let reports = reports_of(&[("bvp", Some(60.0)), ("bvp", None), ("frontier", Some(5.0))]);
        let text = means(&reports).to_string();
        let t99 = |line: usize| text.lines().nth(line).unwrap().split_whitespace().nth(4);
        assert_eq!((t99(1), t99(2)), (Some("-"), Some("5.0")), "{text}");
    }
}

//! How runs ended, in groups: reasons, contacts, clearances, what is known.

use host_sim::report::Report;

use crate::table::{Table, number};

/// Least share of what can be seen that is known at the end of a good run.
pub const LEAST_COVERAGE: f64 = 0.98;

fn contacts(report: &Report) -> u32 {
    report.safety.collisions + report.safety.falls + report.safety.tips
}

/// Returns true if a run ended explored, touched nothing and knows [`LEAST_COVERAGE`].
#[must_use]
pub fn is_good(report: &Report) -> bool {
    report.explored() && contacts(report) == 0 && report.coverage.fraction >= LEAST_COVERAGE
}

/// Makes a table with one line for each group, by its name: how its runs ended, and figures over
/// all of them. `listed` counts the runs that are not good.
#[must_use]
pub fn summary(title: &str, groups: &[(&str, &[Report])]) -> Table {
    let mut table = Table::new(
        1,
        &[
            title,
            "runs",
            "explored",
            "stuck",
            "map",
            "other",
            "listed",
            "hits",
            "clear p5 m",
            "p50 m",
            "known %",
            "least %",
            "end s",
        ],
    );
    for &(name, reports) in groups {
        let ended = |reasons: &[&str]| {
            let of = |report: &&Report| reasons.contains(&report.outcome.reason.as_str());
            reports.iter().filter(of).count()
        };
        let counts = [
            reports.iter().filter(|report| report.explored()).count(),
            ended(&["stuck"]),
            ended(&["out-of-box", "map-full"]),
        ];
        let other = reports.len() - counts.iter().sum::<usize>();
        let listed = reports.iter().filter(|report| !is_good(report)).count();
        let clear_m = sorted(reports, |report| report.safety.min_clearance_m);
        let known = sorted(reports, |report| Some(report.coverage.fraction * 100.0));
        let end_s = sorted(reports, |report| Some(report.sim_time_s));
        let mut row = vec![name.to_owned(), reports.len().to_string()];
        row.extend(counts.map(|count| count.to_string()));
        row.extend([other, listed].map(|count| count.to_string()));
        row.push(reports.iter().map(contacts).sum::<u32>().to_string());
        row.extend([5, 50].map(|per_cent| number(rank(&clear_m, per_cent), 3)));
        row.extend([number(mean(&known), 2), number(known.first().copied(), 2)]);
        row.push(number(mean(&end_s), 1));
        table.row(row);
    }
    table
}

/// Returns a figure of all runs that have it, least first.
fn sorted(reports: &[Report], of: impl Fn(&Report) -> Option<f64>) -> Vec<f64> {
    let mut values: Vec<f64> = reports.iter().filter_map(of).collect();
    values.sort_by(f64::total_cmp);
    values
}

/// Returns a percentile by nearest rank.
fn rank(sorted: &[f64], per_cent: usize) -> Option<f64> {
    let rank = (sorted.len() * per_cent).div_ceil(100).saturating_sub(1);
    sorted.get(rank).copied()
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

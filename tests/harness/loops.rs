//! Tables of explorations that close loops: means of each world and strategy, and every run.
//!
//! The papers compare their strategies with a BVP exploration over the full grid, in worlds whose
//! drawings are not published. Only the ratio of the two times can be compared with theirs.

use host_sim::report::Report;

use crate::runs::{FRONTIER, mean};
use crate::table::{Table, number};

/// The strategy that closes loops on purpose \[Jorge15\].
pub const OUROBOROS: &str = "ouroboros";
/// The strategy that tends to close loops, and can patrol \[Maffei14\].
pub const TDBVP: &str = "tdbvp";
/// The exploration over the full grid that the papers compare with \[Prestes02\].
pub const BVP: &str = "bvp";

/// Ratios from the papers: world, strategy, and its mean time over that of the BVP exploration.
/// \[Maffei14\] gives steps instead of seconds.
const PAPERS: [(&str, &str, f64); 6] = [
    ("ouroboros-a", OUROBOROS, 4399.3 / 4881.9),
    ("ouroboros-b", OUROBOROS, 5231.7 / 8585.4),
    ("ouroboros-c", OUROBOROS, 4985.8 / 3549.7),
    ("ouroboros-d", OUROBOROS, 3691.3 / 5823.9),
    ("tdbvp-adjacent", TDBVP, 1971.1 / 1947.0),
    ("tdbvp-nested", TDBVP, 1604.4 / 1627.4),
];

/// Returns the mean simulated time of a strategy in a world, seconds.
fn time_s(reports: &[Report], world: &str, strategy: &str) -> Option<f64> {
    let of = |r: &&Report| r.world == world && r.strategy == strategy;
    let runs: Vec<&Report> = reports.iter().filter(of).collect();
    mean(&runs, |r| Some(r.sim_time_s))
}

/// Makes a table with one line for each world and strategy.
///
/// It has means over the starts, also of the loops given up and of the seconds spent on loops that
/// were not closed. The last columns are the time over that of `frontier`, over that of `bvp`, and
/// the latter ratio in the paper.
#[must_use]
pub fn means(reports: &[Report]) -> Table {
    let mut table = Table::new(
        2,
        &[
            "world",
            "strategy",
            "runs",
            "time s",
            "path m",
            "loops",
            "known %",
            "least %",
            "hits",
            "not explored",
            "given up",
            "in vain s",
            "time/frontier",
            "time/bvp",
            "paper: time/BVP",
        ],
    );
    for group in reports.chunk_by(|a, b| (&a.world, &a.strategy) == (&b.world, &b.strategy)) {
        let runs: Vec<&Report> = group.iter().collect();
        let (world, strategy) = (group[0].world.as_str(), group[0].strategy.as_str());
        let own_s = time_s(reports, world, strategy);
        let over = |other: &str| {
            let ratio = own_s.zip(time_s(reports, world, other));
            number(ratio.map(|(own_s, its_s)| own_s / its_s), 2)
        };
        let sum = |of: fn(&Report) -> u32| group.iter().map(of).sum::<u32>();
        let known = |r: &Report| 100.0 * r.coverage.fraction;
        let paper = PAPERS
            .iter()
            .find(|(of, by, _)| (*of, *by) == (world, strategy));
        table.row(vec![
            world.into(),
            strategy.into(),
            runs.len().to_string(),
            number(own_s, 1),
            number(mean(&runs, |r| Some(r.path_length_m)), 1),
            format!("{}/{}", sum(|r| r.loops.circled), sum(|r| r.loops.islands)),
            number(mean(&runs, |r| Some(known(r))), 2),
            number(runs.iter().map(|r| known(r)).reduce(f64::min), 2),
            sum(|r| r.safety.collisions).to_string(),
            group.iter().filter(|r| !r.explored()).count().to_string(),
            number(
                mean(&runs, |r| {
                    Some(r.loop_closing.as_ref()?.given_up.len() as f64)
                }),
                1,
            ),
            number(mean(&runs, |r| Some(r.loop_closing.as_ref()?.wasted_s)), 1),
            over(FRONTIER),
            over(BVP),
            number(paper.map(|(_, _, ratio)| *ratio), 2),
        ]);
    }
    table
}

/// Makes a table with one line for each run.
#[must_use]
pub fn table(reports: &[Report]) -> Table {
    let mut table = Table::new(
        3,
        &[
            "world", "strategy", "ended", "start", "time s", "path m", "loops", "known %", "hits",
            "clear m",
        ],
    );
    for report in reports {
        table.row(vec![
            report.world.clone(),
            report.strategy.clone(),
            format!("{}({})", report.outcome.status, report.outcome.reason),
            report.start.to_string(),
            format!("{:.1}", report.sim_time_s),
            format!("{:.1}", report.path_length_m),
            format!("{}/{}", report.loops.circled, report.loops.islands),
            format!("{:.2}", 100.0 * report.coverage.fraction),
            report.safety.collisions.to_string(),
            number(report.safety.min_clearance_m, 3),
        ]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::means;
    use crate::runs::Run;
    use crate::worlds::builtin;

    #[test]
    fn ratios_are_of_times_in_the_same_world() {
        let world = builtin("boxed-in");
        let blank = Run::first(&world, "frontier").go();
        let rows = [
            ("ouroboros-a", "ouroboros", 300.0),
            ("ouroboros-a", "frontier", 200.0),
            ("ouroboros-a", "bvp", 400.0),
            ("ouroboros-b", "ouroboros", 90.0),
        ];
        let reports: Vec<_> = rows
            .iter()
            .map(|&(world, strategy, sim_time_s)| {
                let mut report = blank.clone();
                (report.world, report.strategy) = (world.into(), strategy.into());
                report.sim_time_s = sim_time_s;
                report
            })
            .collect();
        let text = means(&reports).to_string();
        let last = |line: usize| -> Vec<&str> {
            let words: Vec<&str> = text.lines().nth(line).unwrap().split_whitespace().collect();
            words[words.len() - 3..].to_vec()
        };
        assert_eq!(last(1), ["1.50", "0.75", "0.90"], "{text}");
        assert_eq!(last(2), ["1.00", "0.50", "-"]);
        assert_eq!(last(4), ["-", "-", "0.61"]);
    }
}

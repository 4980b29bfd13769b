//! Maps of uneven ground against the true ground: shares of cells by class.
//!
//! ```text
//! P = cells of a class in both / cells of it in the map       precision
//! R = cells of a class in both / cells of it in truth         recall
//! ```

use host_sim::metrics::MapScore as Truth;

use crate::table::{Table, number};
use crate::uneven::Summary;

/// Describes the maps of some runs: shares for each world, and counts of cells of all worlds.
#[must_use]
pub fn text(runs: &[Summary]) -> String {
    format!(
        "Shares of cells, P: of those that the map says; R: of those that are.\n\n{}\n\
         Cells of all worlds.\n\n{}",
        shares(runs),
        confusion(runs)
    )
}

/// Asserts the least shares over all worlds: precision and recall of every class.
///
/// # Panics
/// If a share is less, or there are no runs.
pub fn assert_classified(runs: &[Summary]) {
    let all = pool(runs);
    for (score, name, precision, recall) in [
        (all.traversable, "free", 0.97, 0.95),
        (all.obstacle, "obstacle", 0.97, 0.90),
        (all.negative, "negative", 0.80, 0.95),
    ] {
        assert!(score.precision >= Some(precision), "{name}: {score:?}");
        assert!(score.recall >= Some(recall), "{name}: {score:?}");
    }
}

/// Sums the tables of some runs.
fn pool(runs: &[Summary]) -> Truth {
    let truths = runs.iter().map(|run| run.truth);
    truths.fold(Truth::default(), |a, b| a + b)
}

/// Makes a table of the shares, class by class: one line for each world and one for all.
fn shares(runs: &[Summary]) -> Table {
    let columns = [
        "world",
        "free P",
        "R",
        "obstacle P",
        "R",
        "negative P",
        "R",
        "unknown P",
        "R",
        "negative by name",
    ];
    let mut table = Table::new(1, &columns);
    let mut line = |name: &str, truth: &Truth| {
        let scores = [
            truth.traversable,
            truth.obstacle,
            truth.negative,
            truth.unknown,
        ];
        let shares = scores
            .iter()
            .flat_map(|score| [score.precision, score.recall]);
        let mut row = vec![name.to_owned()];
        row.extend(shares.map(|share| number(share, 4)));
        row.push(number(truth.negative_by_name, 4));
        table.row(row);
    };
    for group in runs.chunk_by(|a, b| a.report.world == b.report.world) {
        line(&group[0].report.world, &pool(group));
    }
    line("all", &pool(runs));
    table
}

/// Makes a table of the cells of all maps by true class and class in the map.
fn confusion(runs: &[Summary]) -> Table {
    let all = pool(runs);
    let mut table = Table::new(1, &["truly", "unknown", "free", "obstacle", "negative"]);
    for (name, row) in [
        "traversable",
        "obstacle",
        "negative",
        "either",
        "out of reach",
    ]
    .iter()
    .zip(all.cells)
    {
        let mut cells = vec![(*name).to_owned()];
        cells.extend(row.map(|count| count.to_string()));
        table.row(cells);
    }
    table
}

//! A campaign's table as Markdown.
//!
//! A number has three digits of its standard deviation's size or four of its own, whichever are
//! fewer, so that a column is short and no digit is noise.

use core::fmt::Write as _;

use super::plan::Plan;
use super::table::{Difference, Entry, Figures, Group, Table};

/// Returns the table as Markdown.
#[must_use]
pub fn text(table: &Table, plan: &Plan) -> String {
    let mut text = format!("# Campaign {}\n\n", table.name);
    let _ = writeln!(
        text,
        "{} of {} trials; starts: {}, seeds: {}. Mean ± standard deviation; (n) where not all \
         trials have a value.",
        table.finished,
        table.trials,
        plan.starts.len(),
        plan.seeds.len()
    );
    for group in &table.groups {
        let _ = write!(text, "\n## {}\n\n", group.title);
        text += &figures(table, group);
        if let Some(baseline) = &table.baseline {
            let _ = write!(text, "\n{}\n\n", explanation(baseline));
            text += &differences(table, group);
        }
    }
    if !table.failures.is_empty() {
        text += "\n## Failed trials\n\n";
        for (command, failure) in &table.failures {
            let _ = writeln!(text, "- `{command}`: {failure}");
        }
    }
    text
}

fn explanation(baseline: &str) -> String {
    format!(
        "Against {baseline}: difference of the means, two-sided p of the rank-sum test, and of the \
         signed-rank and the sign test over pairs of equal start and seed."
    )
}

/// Returns the table of figures of a group.
fn figures(table: &Table, group: &Group) -> String {
    let mut rows = vec![vec!["strategy".to_owned(), "trials".into()]];
    rows[0].extend(table.columns.iter().cloned());
    for entry in &group.entries {
        let trials = match entry.failed {
            0 => entry.trials.to_string(),
            failed => format!("{} ({failed} failed)", entry.trials),
        };
        let mut row = vec![entry.arm.clone(), trials];
        row.extend(entry.figures.iter().map(|it| figure(it, entry)));
        rows.push(row);
    }
    aligned(&rows)
}

fn figure(figures: &Figures, entry: &Entry) -> String {
    match figures {
        Figures::Nothing => "–".into(),
        Figures::Share([yes, of]) => format!("{yes} of {of}"),
        Figures::Texts(texts) => {
            let words = texts.iter().map(|(text, count)| format!("{text} {count}"));
            words.collect::<Vec<_>>().join(", ")
        }
        Figures::Numbers(summary) => {
            let digits = decimals(summary.mean, summary.sd);
            let mut text = rounded(summary.mean, digits);
            if let Some(sd) = summary.sd {
                let _ = write!(text, " ± {}", rounded(sd, digits));
            }
            if summary.n != entry.trials {
                let _ = write!(text, " ({})", summary.n);
            }
            text
        }
    }
}

/// Returns the table of differences of a group.
fn differences(table: &Table, group: &Group) -> String {
    let head = [
        "strategy",
        "column",
        "difference",
        "rank-sum",
        "signed-rank",
        "sign",
        "+ / −",
    ];
    let mut rows = vec![head.map(ToOwned::to_owned).to_vec()];
    for entry in &group.entries {
        for (column, difference) in table.columns.iter().zip(&entry.differences) {
            if let Some(difference) = difference {
                let mut row = vec![entry.arm.clone(), column.clone()];
                row.extend(difference_row(difference));
                rows.push(row);
            }
        }
    }
    aligned(&rows)
}

fn difference_row(difference: &Difference) -> [String; 5] {
    let percent = |value: f64| match value {
        value if value.abs() < 0.05 => "0.0 %".to_owned(),
        value => format!("{value:+.1} %").replace('-', "−"),
    };
    let signs = difference.signs;
    [
        difference.percent.map_or("–".into(), percent),
        difference.rank_sum.map_or("–".into(), |test| p(test.p)),
        paired(difference, difference.signed_rank.p()),
        paired(difference, signs.p),
        format!(
            "{} / {} of {}",
            signs.positive, signs.negative, difference.pairs
        ),
    ]
}

fn paired(difference: &Difference, value: f64) -> String {
    match difference.pairs {
        0 => "–".into(),
        _ => p(value),
    }
}

/// Returns a probability as text.
fn p(value: f64) -> String {
    match value {
        value if value < 0.0001 => "< 0.0001".into(),
        value if value < 0.01 => format!("{value:.4}"),
        value => format!("{value:.3}"),
    }
}

/// Returns how many decimals show a mean and its deviation.
fn decimals(mean: f64, sd: Option<f64>) -> usize {
    if mean == 0.0 && sd.is_none_or(|sd| sd == 0.0) {
        return 0;
    }
    let size = |value: f64| match value.abs() {
        0.0 => 0,
        value => value.log10().floor() as i32,
    };
    let of_mean = 3 - size(mean);
    let of_sd = sd.filter(|sd| *sd > 0.0).map_or(of_mean, |sd| 2 - size(sd));
    of_mean.min(of_sd).clamp(0, 6) as usize
}

fn rounded(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    // No minus before what was rounded to 0.
    match text.strip_prefix('-') {
        Some(rest) if rest.chars().all(|it| "0.".contains(it)) => rest.to_owned(),
        Some(rest) => format!("−{rest}"),
        None => text,
    }
}

/// Returns the rows as a Markdown table whose columns are aligned; the first row is the head.
fn aligned(rows: &[Vec<String>]) -> String {
    let columns = rows.first().map_or(0, Vec::len);
    let width = |column: usize| {
        let widths = rows.iter().filter_map(|row| row.get(column));
        widths.map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let mut text = String::new();
    for (number, row) in rows.iter().enumerate() {
        for (cell, width) in row.iter().zip(&widths) {
            let cell = cell.replace('|', "\\|");
            let _ = write!(text, "| {cell:width$} ");
        }
        text += "|\n";
        if number == 0 {
            for width in &widths {
                let _ = write!(text, "| {} ", "-".repeat((*width).max(3)));
            }
            text += "|\n";
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::{aligned, decimals, p, rounded};

    #[test]
    fn numbers_have_the_digits_that_count() {
        let shown = |mean: f64, sd: f64| {
            let digits = decimals(mean, Some(sd));
            [rounded(mean, digits), rounded(sd, digits)]
        };
        assert_eq!(shown(312.437, 14.22), ["312.4", "14.2"]);
        assert_eq!(shown(0.99123, 0.000456), ["0.9912", "0.0005"]);
        assert_eq!(shown(0.0312, 0.0153), ["0.0312", "0.0153"]);
        assert_eq!(shown(12_345.6, 987.6), ["12346", "988"]);
        assert_eq!(shown(0.0, 0.0), ["0", "0"]);
        assert_eq!(rounded(-0.0004, 2), "0.00");
        assert_eq!(rounded(-0.4, 2), "−0.40");
    }

    #[test]
    fn probabilities_are_never_shown_as_zero() {
        assert_eq!(
            [p(1e-9), p(0.00123), p(0.0421), p(1.0)],
            ["< 0.0001", "0.0012", "0.042", "1.000"]
        );
    }

    #[test]
    fn a_bar_in_a_cell_ends_no_cell() {
        let rows = [vec!["a".to_owned()], vec!["x|y".into()]];
        assert_eq!(aligned(&rows), "| a   |\n| --- |\n| x\\|y |\n");
    }
}

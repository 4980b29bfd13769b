//! A campaign's table as comma-separated values: one line for each group, strategy and column.
//!
//! Numbers have all their digits. Texts of a column are in one cell, with their counts.

use super::table::{Difference, Entry, Figures, Group, Table};

/// The first line.
const HEAD: &str = "world,odometry,strategy,column,trials,failed,n,mean,sd,min,q1,median,q3,max,\
                    texts,baseline,difference_percent,rank_sum_u,rank_sum_p,pairs,\
                    signed_rank_w,signed_rank_p,positive,negative,sign_p";

/// Returns the table as text.
#[must_use]
pub fn text(table: &Table) -> String {
    let mut text = format!("{HEAD}\n");
    for group in &table.groups {
        for entry in &group.entries {
            for (number, column) in table.columns.iter().enumerate() {
                text += &line(table, group, entry, (number, column));
                text.push('\n');
            }
        }
    }
    text
}

fn line(table: &Table, group: &Group, entry: &Entry, (number, column): (usize, &str)) -> String {
    let mut cells = vec![
        group.world.clone(),
        group.odometry.clone().unwrap_or_default(),
        entry.arm.clone(),
        column.to_owned(),
        entry.trials.to_string(),
        entry.failed.to_string(),
    ];
    cells.extend(figures(entry.figures.get(number)));
    let difference = entry.differences.get(number).and_then(Option::as_ref);
    let baseline = table.baseline.clone().filter(|_| difference.is_some());
    cells.push(baseline.unwrap_or_default());
    cells.extend(difference.map_or_else(<[String; 9]>::default, of_difference));
    cells
        .iter()
        .map(|cell| quoted(cell))
        .collect::<Vec<_>>()
        .join(",")
}

/// Returns n, mean, deviation, least, quartiles, greatest, texts.
fn figures(figures: Option<&Figures>) -> [String; 9] {
    let mut cells = <[String; 9]>::default();
    match figures {
        None | Some(Figures::Nothing) => cells[0] = "0".into(),
        Some(Figures::Share([yes, of])) => {
            cells[0] = of.to_string();
            cells[1] = (*yes as f64 / *of as f64).to_string();
        }
        Some(Figures::Texts(texts)) => {
            cells[0] = texts
                .iter()
                .map(|(_, count)| count)
                .sum::<usize>()
                .to_string();
            let words = texts.iter().map(|(text, count)| format!("{text} {count}"));
            cells[8] = words.collect::<Vec<_>>().join("; ");
        }
        Some(Figures::Numbers(summary)) => {
            cells[0] = summary.n.to_string();
            cells[1] = summary.mean.to_string();
            cells[2] = summary.sd.map(|sd| sd.to_string()).unwrap_or_default();
            for (cell, quartile) in cells[3..8].iter_mut().zip(summary.quartiles) {
                *cell = quartile.to_string();
            }
        }
    }
    cells
}

fn of_difference(difference: &Difference) -> [String; 9] {
    let number = |value: Option<f64>| value.map(|it| it.to_string()).unwrap_or_default();
    let paired = |value: f64| number(Some(value).filter(|_| difference.pairs > 0));
    let (signed_rank, signs) = (difference.signed_rank, difference.signs);
    [
        number(difference.percent),
        number(difference.rank_sum.map(|test| test.u)),
        number(difference.rank_sum.map(|test| test.p)),
        difference.pairs.to_string(),
        paired(signed_rank.positive),
        paired(signed_rank.p()),
        signs.positive.to_string(),
        signs.negative.to_string(),
        paired(signs.p),
    ]
}

fn quoted(cell: &str) -> String {
    if cell.contains([',', '"', '\n']) {
        format!("\"{}\"", cell.replace('"', "\"\""))
    } else {
        cell.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::{HEAD, quoted};

    #[test]
    fn a_cell_with_a_comma_or_a_quote_is_quoted() {
        assert_eq!(quoted("a b"), "a b");
        assert_eq!(quoted("a,\"b\""), "\"a,\"\"b\"\"\"");
        assert_eq!(HEAD.split(',').count(), 25);
    }
}

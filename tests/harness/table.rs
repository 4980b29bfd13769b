//! Tables of text: words stand left, numbers right, with two spaces between columns.

use core::fmt;

/// A table with a heading.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Table {
    rows: Vec<Vec<String>>,
    /// Number of columns, from the first, that hold words.
    left: usize,
}

impl Table {
    /// Makes a table with these columns. The first `left` hold words, the others numbers.
    #[must_use]
    pub fn new(left: usize, columns: &[&str]) -> Self {
        let mut table = Self {
            rows: Vec::new(),
            left,
        };
        table.row(columns.iter().map(|&column| column.into()).collect());
        table
    }

    /// Adds a row.
    pub fn row(&mut self, cells: Vec<String>) {
        self.rows.push(cells);
    }

    fn width(&self, column: usize) -> usize {
        let cells = self.rows.iter().filter_map(|row| row.get(column));
        cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for row in &self.rows {
            let mut line = String::new();
            for (column, cell) in row.iter().enumerate() {
                let width = self.width(column);
                let gap = if column > 0 { "  " } else { "" };
                line += &if column < self.left {
                    format!("{gap}{cell:<width$}")
                } else {
                    format!("{gap}{cell:>width$}")
                };
            }
            writeln!(f, "{}", line.trim_end())?;
        }
        Ok(())
    }
}

/// Formats a number with `digits` decimals; a dash stands for `None`.
#[must_use]
pub fn number(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| "-".into(), |value| format!("{value:.digits$}"))
}

#[cfg(test)]
mod tests {
    use super::{Table, number};

    #[test]
    fn words_stand_left_and_numbers_right() {
        let mut table = Table::new(1, &["world", "s"]);
        table.row(vec!["a".into(), number(Some(12.34), 1)]);
        table.row(vec!["office".into(), number(None, 1)]);
        assert_eq!(
            table.to_string(),
            "world      s\na       12.3\noffice     -\n"
        );
    }
}

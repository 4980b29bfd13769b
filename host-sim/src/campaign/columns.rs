//! Columns of the table: a value of each trial, by its path.
//!
//! ```text
//! localization.mean_error_m     a key of the report
//! planner.instructions.max      a key in a key
//! outcome.residual_frontiers.#  the length of a list
//! trial.below_1m                what the campaign itself measured
//! ```
//!
//! A number counts as it is, true as 1 and false as 0, a text by how often it is there. `null` and
//! a key that is not there are no value.

use serde_json::Value;

use super::store::Finished;
use crate::near;

/// First word of the paths to what the campaign itself measured.
const OWN: &str = "trial";
/// Last word of a path to the length of a list.
const LENGTH: &str = "#";

/// The usual columns.
const DEFAULT: [&str; 11] = [
    "outcome.reason",
    "trial.explored",
    "coverage.fraction",
    "coverage.t90_s",
    "coverage.t99_s",
    "sim_time_s",
    "path_length_m",
    "safety.collisions",
    "localization.mean_error_m",
    "localization.end_error_m",
    "trial.below_1m",
];

/// Value of a column in a trial.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// No value.
    Missing,
    /// A number.
    Number(f64),
    /// Yes or no.
    Truth(bool),
    /// A text.
    Text(String),
}

/// A finished trial with its report as a tree.
#[derive(Clone, Debug)]
pub struct Row<'a> {
    /// The line.
    pub line: &'a Finished,
    report: Value,
    own: Value,
}

/// Returns the usual columns.
#[must_use]
pub fn default() -> Vec<String> {
    DEFAULT.map(ToOwned::to_owned).to_vec()
}

/// Checks the form of a path, and the keys below `trial`.
///
/// # Errors
/// The fault and the remedy.
pub fn check(path: &str) -> Result<(), String> {
    if path.is_empty()
        || path
            .split('.')
            .any(|word| word.trim() != word || word.is_empty())
    {
        return Err(format!(
            "column '{path}' is no path into a report; say for example coverage.fraction"
        ));
    }
    let own = ["trial.explored", "trial.below_1m", "trial.wall_s"];
    if path.split('.').next() == Some(OWN) && !own.contains(&path) {
        let hint = near::hint(path, own);
        return Err(format!(
            "column {path} is not measured; known are {}{hint}",
            own.join(", ")
        ));
    }
    Ok(())
}

impl<'a> Row<'a> {
    /// Parses a line's report.
    #[must_use]
    pub fn new(line: &'a Finished) -> Self {
        let report = line.report.as_ref();
        let report = report.and_then(|raw| serde_json::from_str(raw.get()).ok());
        Self {
            line,
            report: report.unwrap_or(Value::Null),
            own: serde_json::to_value(line.trial).unwrap_or(Value::Null),
        }
    }

    /// Returns the value of a column.
    #[must_use]
    pub fn cell(&self, path: &str) -> Cell {
        match self.value(path) {
            Some(Found::Length(length)) => Cell::Number(length as f64),
            Some(Found::Value(Value::Bool(truth))) => Cell::Truth(*truth),
            Some(Found::Value(Value::String(text))) => Cell::Text(text.clone()),
            Some(Found::Value(Value::Number(number))) => {
                number.as_f64().map_or(Cell::Missing, Cell::Number)
            }
            _ => Cell::Missing,
        }
    }

    /// Returns true if the report has this path, with `null` too.
    fn has(&self, path: &str) -> bool {
        self.value(path).is_some()
    }

    fn value(&self, path: &str) -> Option<Found<'_>> {
        let mut words = path.split('.').peekable();
        let mut value = &self.report;
        if words.next_if_eq(&OWN).is_some() {
            value = &self.own;
        }
        for word in words {
            if let (LENGTH, Value::Array(list)) = (word, value) {
                return Some(Found::Length(list.len()));
            }
            // What lies below a `null` was not measured.
            if value.is_null() {
                return Some(Found::Value(value));
            }
            value = match value {
                Value::Array(list) => list.get(word.parse::<usize>().ok()?)?,
                value => value.get(word)?,
            };
        }
        Some(Found::Value(value))
    }
}

enum Found<'a> {
    Value(&'a Value),
    Length(usize),
}

/// Returns a remark for each column that no report has, with the nearest path.
#[must_use]
pub fn unknown(columns: &[String], rows: &[Row<'_>]) -> Vec<String> {
    let reports: Vec<&Row<'_>> = rows.iter().filter(|row| !row.report.is_null()).collect();
    let is_unknown = |path: &&String| !reports.iter().any(|row| row.has(path));
    if reports.is_empty() {
        return Vec::new();
    }
    let paths: Vec<String> = reports
        .first()
        .map_or_else(Vec::new, |row| paths(&row.report));
    let remark = |path: &String| {
        let hint = near::hint(path, paths.iter().map(String::as_str));
        format!("column {path} is in no report{hint}")
    };
    columns.iter().filter(is_unknown).map(remark).collect()
}

/// Returns all paths to values that are no tables.
fn paths(value: &Value) -> Vec<String> {
    let Value::Object(table) = value else {
        return vec![String::new()];
    };
    let below = |(key, value): (&String, &Value)| {
        let join = |rest: String| match rest.as_str() {
            "" => key.clone(),
            rest => format!("{key}.{rest}"),
        };
        paths(value).into_iter().map(join).collect::<Vec<_>>()
    };
    table.iter().flat_map(below).collect()
}

#[cfg(test)]
mod tests {
    use super::{Cell, Row, check, unknown};
    use crate::campaign::store::tests::finished;

    #[test]
    fn values_are_found_by_their_path() {
        let line = finished(0, "office", "frontier", 312.4);
        let row = Row::new(&line);
        assert_eq!(row.cell("sim_time_s"), Cell::Number(312.4));
        assert_eq!(row.cell("map.wall_error_m.p95"), Cell::Number(0.05));
        assert_eq!(row.cell("outcome.reason"), Cell::Text("explored".into()));
        assert_eq!(row.cell("outcome.residual_frontiers.#"), Cell::Number(1.0));
        assert_eq!(
            row.cell("outcome.residual_frontiers.0.cells"),
            Cell::Number(4.0)
        );
        assert_eq!(row.cell("trial.explored"), Cell::Truth(true));
        assert_eq!(row.cell("planner.instructions.max"), Cell::Missing);
        assert_eq!(row.cell("coverage"), Cell::Missing);
        assert_eq!(row.cell("no.such.key"), Cell::Missing);
    }

    #[test]
    fn a_column_that_no_report_has_is_named_with_the_nearest() {
        let line = finished(0, "office", "frontier", 312.4);
        let rows = [Row::new(&line)];
        let columns = ["sim_time_s", "planner.instructions.max", "coverage.t90"];
        let remarks = unknown(&columns.map(String::from), &rows);
        assert_eq!(
            remarks,
            ["column coverage.t90 is in no report; did you mean coverage.t90_s?"]
        );
    }

    #[test]
    fn bad_paths_are_refused() {
        for bad in ["", "a..b", ".a", "a b .c", "trial.explord"] {
            assert!(check(bad).is_err(), "{bad}");
        }
        assert!(
            check("trial.explord")
                .unwrap_err()
                .contains("mean trial.explored?")
        );
        assert!(check("slam.pf_error_m").is_ok());
    }
}

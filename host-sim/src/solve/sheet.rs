//! The text files of `host-sim solve`: a window drawn in characters, and its preferences as
//! numbers.
//!
//! WINDOW.txt has one character per cell, and its first line is the greatest y: `#` obstacle, `G`
//! goal, `.` free, `R` robot (free). EPS.csv has one number within ±2 per cell, separated by
//! commas, in the same layout. Both have at most [`SIDE`] × [`SIDE`] cells. Every error names line
//! and column, both from 1, and the remedy.

use core::fmt;

use thiserror::Error;

use fieldline_planner::field::SIDE;

/// Class of a drawn cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SheetCell {
    /// `#`
    Obstacle,
    /// `G`
    Goal,
    /// `.` or `R`
    Free,
}

/// A drawn window.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sheet {
    /// Rows from the least y, all of one length.
    pub rows: Vec<Vec<SheetCell>>,
    /// Column and row of the robot.
    pub robot: Option<(usize, usize)>,
}

/// Why a drawn window or its preferences are invalid: the place, the fault and the remedy.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{0}")]
pub struct SheetError(String);

/// An error at a line and a column, both from 1.
fn at<T>(line: usize, column: usize, fault: impl fmt::Display) -> Result<T, SheetError> {
    Err(SheetError(format!("line {line}, column {column}: {fault}")))
}

/// Refuses a line that is not as long as the first one.
fn check_length(line: usize, found: usize, expected: usize) -> Result<(), SheetError> {
    if found == expected {
        return Ok(());
    }
    let fault = format!("the line has {found} cells and the first one {expected}: make them equal");
    at(line, found.min(expected) + 1, fault)
}

impl Sheet {
    /// Reads a drawn window.
    ///
    /// # Errors
    /// As [`SheetError`].
    pub fn parse(text: &str) -> Result<Self, SheetError> {
        let mut rows: Vec<Vec<SheetCell>> = Vec::new();
        let mut robot = None;
        for (i, drawn) in text.lines().enumerate() {
            let line = i + 1;
            if line > SIDE {
                let fault = format!("a window has at most {SIDE} lines: remove the rest");
                return at(line, 1, fault);
            }
            let row = parse_line(line, drawn, &mut robot)?;
            let expected = rows.first().map_or(row.len(), Vec::len);
            check_length(line, row.len(), expected)?;
            rows.push(row);
        }
        if rows.first().is_none_or(Vec::is_empty) {
            return Err(SheetError(
                "the file is empty: draw at least one cell".into(),
            ));
        }
        let top = rows.len() - 1;
        rows.reverse();
        let robot = robot.map(|(column, line)| (column, top - line));
        Ok(Self { rows, robot })
    }

    /// Number of columns.
    #[must_use]
    pub fn width(&self) -> usize {
        self.rows.first().map_or(0, Vec::len)
    }

    /// Number of rows.
    #[must_use]
    pub fn height(&self) -> usize {
        self.rows.len()
    }
}

fn parse_line(
    line: usize,
    drawn: &str,
    robot: &mut Option<(usize, usize)>,
) -> Result<Vec<SheetCell>, SheetError> {
    let mut row = Vec::new();
    for (i, found) in drawn.chars().enumerate() {
        let column = i + 1;
        row.push(match found {
            '#' => SheetCell::Obstacle,
            'G' => SheetCell::Goal,
            '.' => SheetCell::Free,
            'R' if robot.is_some() => return at(line, column, "a second robot: keep one R"),
            'R' => {
                *robot = Some((i, line - 1));
                SheetCell::Free
            }
            _ => {
                let fault = "is no cell: use # obstacle, G goal, . free, R robot";
                return at(line, column, format!("{found:?} {fault}"));
            }
        });
    }
    if row.len() > SIDE {
        let found = row.len();
        let fault = format!("the line has {found} cells, a window at most {SIDE}: remove the rest");
        return at(line, SIDE + 1, fault);
    }
    Ok(row)
}

/// Reads the preferences of a drawn window, in rows from the least y.
///
/// # Errors
/// As [`SheetError`].
pub fn preferences(text: &str, sheet: &Sheet) -> Result<Vec<Vec<f32>>, SheetError> {
    let mut rows = Vec::new();
    for (i, written) in text.lines().enumerate() {
        let line = i + 1;
        let numbers: Result<Vec<f32>, SheetError> = written
            .split(',')
            .enumerate()
            .map(|(j, number)| preference(line, j + 1, number))
            .collect();
        let numbers = numbers?;
        check_length(line, numbers.len(), sheet.width())?;
        rows.push(numbers);
    }
    if rows.len() != sheet.height() {
        return Err(SheetError(format!(
            "{} lines of preferences for {} lines of window: give one number per cell",
            rows.len(),
            sheet.height()
        )));
    }
    rows.reverse();
    Ok(rows)
}

fn preference(line: usize, column: usize, written: &str) -> Result<f32, SheetError> {
    let number = written.trim();
    match number.parse::<f32>() {
        Ok(found) if found.abs() <= 2.0 => Ok(found),
        Ok(found) if !found.is_nan() => {
            let fault = format!("preference {found} diverges: keep it within -2 and 2");
            at(line, column, fault)
        }
        _ => {
            let fault = "is no number: write preferences as 0.25,-0.5,...";
            at(line, column, format!("{number:?} {fault}"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Sheet, SheetCell, preferences};

    #[test]
    fn the_first_line_is_the_greatest_y() {
        let sheet = Sheet::parse("G.#\r\n.R.\n").unwrap();
        assert_eq!((sheet.width(), sheet.height()), (3, 2));
        assert_eq!(sheet.robot, Some((1, 0)));
        assert_eq!(sheet.rows[1][0], SheetCell::Goal);
        assert_eq!(sheet.rows[1][2], SheetCell::Obstacle);
        assert_eq!(sheet.rows[0], [SheetCell::Free; 3]);
    }

    #[test]
    fn every_error_names_its_place_and_the_remedy() {
        let error = |text: &str| Sheet::parse(text).unwrap_err().to_string();
        assert_eq!(error(""), "the file is empty: draw at least one cell");
        assert_eq!(
            error("..\n.x\n"),
            "line 2, column 2: 'x' is no cell: use # obstacle, G goal, . free, R robot"
        );
        assert_eq!(
            error("...\n..\n"),
            "line 2, column 3: the line has 2 cells and the first one 3: make them equal"
        );
        assert_eq!(
            error("R.\n.R"),
            "line 2, column 2: a second robot: keep one R"
        );
        assert_eq!(
            error(&"...\n".repeat(62)),
            "line 62, column 1: a window has at most 61 lines: remove the rest"
        );
        assert_eq!(
            error(&".".repeat(70)),
            "line 1, column 62: the line has 70 cells, a window at most 61: remove the rest"
        );
        assert!(Sheet::parse(&format!("{}\n", ".".repeat(61)).repeat(61)).is_ok());
        assert!(
            error("\n..").contains("line 2"),
            "a blank first line has no cells"
        );
    }

    #[test]
    fn preferences_have_the_windows_layout() {
        let sheet = Sheet::parse("G..\n.R.").unwrap();
        let rows = preferences("0,0.5,-2\n1e-3, 0 ,2\n", &sheet).unwrap();
        assert_eq!(rows, [[1e-3, 0.0, 2.0], [0.0, 0.5, -2.0]]);
        let error = |text: &str| preferences(text, &sheet).unwrap_err().to_string();
        assert_eq!(
            error("0,0,0\n0,2.5,0"),
            "line 2, column 2: preference 2.5 diverges: keep it within -2 and 2"
        );
        assert!(error("0,0,0\n0,x,0").starts_with("line 2, column 2: \"x\" is no number"));
        assert!(error("0,0,0\n0,nan,0").contains("is no number"));
        assert!(error("0,0,0\n0,inf,0").contains("preference inf diverges"));
        assert!(error("0,0,0\n0,0").contains("line 2, column 3: the line has 2 cells"));
        assert!(error("0,0,0").contains("1 lines of preferences for 2"));
    }
}

//! CARMEN logs as text: laser scans with the odometry pose at the scan.
//!
//! `FLASER n r1 … rn x y θ ox oy oθ t host t'`, metres and radians. Only FLASER is read so far.
//! 180 or 360 beams lie at −90° + i·180°/n; 181 or 361 beams include both ends.

use std::f64::consts::{FRAC_PI_2, PI};

/// One laser scan of a log. `line` counts from 1.
#[derive(Clone, Debug, PartialEq)]
pub struct LogScan {
    /// Line of the log, from 1.
    pub line: usize,
    /// Seconds.
    pub time: f64,
    /// Metres, from right to left.
    pub ranges: Vec<f64>,
    /// Odometry at the scan: x, y in metres, heading in radians.
    pub odometry: [f64; 3],
}

impl LogScan {
    /// Angle of a beam in the robot's frame, in radians.
    pub fn angle(&self, beam: usize) -> f64 {
        let n = self.ranges.len();
        let gaps = if n % 2 == 1 { n - 1 } else { n };
        -FRAC_PI_2 + beam as f64 * PI / gaps.max(1) as f64
    }
}

/// Read all scans. An error names the file, the line and the remedy.
pub fn scans(file: &str, text: &str) -> Result<Vec<LogScan>, String> {
    let mut found = Vec::new();
    for (index, content) in text.lines().enumerate() {
        let words: Vec<&str> = content.split_whitespace().collect();
        if words.first() == Some(&"FLASER") {
            let at = index + 1;
            let scan = scan(at, &words).map_err(|what| format!("{file}:{at}: {what}"))?;
            found.push(scan);
        }
    }
    if found.is_empty() {
        return Err(format!(
            "{file}: no FLASER line; give a CARMEN log with laser scans"
        ));
    }
    Ok(found)
}

fn scan(line: usize, words: &[&str]) -> Result<LogScan, String> {
    let count = words.get(1).and_then(|word| word.parse::<usize>().ok());
    let count = count.ok_or("FLASER has no number of beams; mend or delete the line")?;
    if count == 0 || words.len().checked_sub(11) != Some(count) {
        return Err(format!(
            "FLASER says {count} beams and has {} words, not beams + 11; mend or delete the line",
            words.len()
        ));
    }
    let number = |at: usize| match words[at].parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!(
            "`{}` is not a finite number; mend or delete the line",
            words[at]
        )),
    };
    let ranges = (2..2 + count).map(number).collect::<Result<_, _>>()?;
    let odometry = [number(count + 5)?, number(count + 6)?, number(count + 7)?];
    Ok(LogScan {
        line,
        time: number(count + 8)?,
        ranges,
        odometry,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scan_has_its_odometry_and_its_angles() {
        let log = "# x\nFLASER 2 1 2 9 9 9 3 4 0.5 7.5 host 7.5\n";
        let scan = &scans("a.log", log).unwrap()[0];
        assert_eq!(
            (scan.line, scan.time, scan.odometry),
            (2, 7.5, [3.0, 4.0, 0.5])
        );
        assert_eq!((scan.angle(0), scan.angle(1)), (-FRAC_PI_2, 0.0));
    }

    #[test]
    fn bad_input_names_file_and_line() {
        for (bad, what) in [
            (
                "FLASER 3 1 2 9 9 9 3 4 0.5 7.5 host 7.5",
                "a.log:1: FLASER says 3",
            ),
            ("FLASER 18446744073709551615 1", "a.log:1: FLASER says"),
            (
                "FLASER 2 1 NaN 9 9 9 3 4 0.5 7.5 host 7.5",
                "a.log:1: `NaN`",
            ),
            ("", "a.log: no FLASER"),
        ] {
            let error = scans("a.log", bad).unwrap_err();
            assert!(error.starts_with(what), "{error}");
        }
    }
}

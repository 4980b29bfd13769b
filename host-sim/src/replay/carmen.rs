//! CARMEN logs: laser scans with the odometry pose at the scan.
//!
//! `FLASER n r1 … rn x y θ ox oy oθ t host t'` is a scan, the laser's pose and the robot's, and
//! `ODOM x y θ v ω a t host t'` the wheels' speed. Other lines are not read. A sweep is 180°: 180
//! or 360 beams lie at −90° + i·180°/n; 181 or 361 beams include both ends.
//!
//! Invariant: all scans have the same number of beams, and times never decrease.
//! Units: metres, radians, seconds.

use core::f64::consts::{FRAC_PI_2, PI};
use std::io::Read as _;
use std::path::Path;

use flate2::read::MultiGzDecoder;

/// One laser scan of a log. `line` counts from 1.
#[derive(Clone, Debug, PartialEq)]
pub struct LogScan {
    /// Line of the log, from 1.
    pub line: usize,
    /// Seconds.
    pub time: f64,
    /// Metres, from right to left.
    pub ranges: Vec<f64>,
    /// Pose of the laser at the scan: x, y in metres, heading in radians.
    pub laser: [f64; 3],
    /// Odometry at the scan: x, y in metres, heading in radians.
    pub odometry: [f64; 3],
    /// Speed and turn rate of the last ODOM line, metres and radians per second.
    pub speed: [f64; 2],
}

/// Reads a file as text. A file that begins as gzip is unpacked.
///
/// # Errors
/// The file, the line after which a gzip file is broken, and the remedy.
pub fn read(path: &Path) -> Result<String, String> {
    let file = path.display();
    let bytes = std::fs::read(path)
        .map_err(|error| format!("cannot read {file} ({error}); give an existing file"))?;
    let mut plain = Vec::new();
    if bytes.starts_with(&[0x1f, 0x8b]) {
        let unpacked = MultiGzDecoder::new(bytes.as_slice()).read_to_end(&mut plain);
        unpacked.map_err(|error| {
            let line = plain.iter().filter(|&&byte| byte == b'\n').count() + 1;
            format!("{file}:{line}: the gzip file is broken here ({error}); copy it again")
        })?;
    } else {
        plain = bytes;
    }
    String::from_utf8(plain).map_err(|error| {
        let good = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = good.iter().filter(|&&byte| byte == b'\n').count() + 1;
        format!("{file}:{line}: this is no text; give a text file, plain or gzip")
    })
}

impl LogScan {
    /// Angle of a beam in the robot's frame, in radians.
    pub fn angle(&self, beam: usize) -> f64 {
        let n = self.ranges.len();
        let gaps = if n % 2 == 1 { n - 1 } else { n };
        -FRAC_PI_2 + beam as f64 * PI / gaps.max(1) as f64
    }
}

/// Reads all scans.
///
/// # Errors
/// The file, the line and the remedy.
pub fn scans(file: &str, text: &str) -> Result<Vec<LogScan>, String> {
    let mut found: Vec<LogScan> = Vec::new();
    let mut speed = [0.0; 2];
    for (index, content) in text.lines().enumerate() {
        let line = index + 1;
        let at = |what: String| format!("{file}:{line}: {what}");
        let words: Vec<&str> = content.split_whitespace().collect();
        match words.first() {
            Some(&"ODOM") => speed = wheels(&words).map_err(at)?,
            Some(&"FLASER") => {
                let scan = LogScan {
                    line,
                    speed,
                    ..scan(&words).map_err(at)?
                };
                if let Some(last) = found.last() {
                    follows(last, &scan).map_err(at)?;
                }
                found.push(scan);
            }
            _ => {}
        }
    }
    if found.is_empty() {
        let end = text.lines().count().max(1);
        return Err(format!(
            "{file}:{end}: no FLASER line up to here; give a CARMEN log with laser scans"
        ));
    }
    Ok(found)
}

/// Checks that a scan can follow another one.
fn follows(last: &LogScan, scan: &LogScan) -> Result<(), String> {
    if scan.ranges.len() != last.ranges.len() {
        return Err(format!(
            "FLASER has {} beams, and line {} has {}; give a log of one laser",
            scan.ranges.len(),
            last.line,
            last.ranges.len()
        ));
    }
    if scan.time < last.time {
        return Err(format!(
            "time {} is before that of line {}; sort the log by time",
            scan.time, last.line
        ));
    }
    Ok(())
}

fn number(words: &[&str], at: usize) -> Result<f64, String> {
    let word = words.get(at).copied().unwrap_or_default();
    let value = word.parse::<f64>().ok().filter(|value| value.is_finite());
    value.ok_or_else(|| format!("`{word}` is not a finite number; mend or delete the line"))
}

/// Reads the speeds of an ODOM line.
fn wheels(words: &[&str]) -> Result<[f64; 2], String> {
    if words.len() < 8 {
        return Err("ODOM has fewer than 7 numbers; mend or delete the line".into());
    }
    for at in 1..8 {
        number(words, at)?;
    }
    Ok([number(words, 4)?, number(words, 5)?])
}

fn scan(words: &[&str]) -> Result<LogScan, String> {
    let count = words.get(1).and_then(|word| word.parse::<usize>().ok());
    let count = count.ok_or("FLASER has no number of beams; mend or delete the line")?;
    if count < 2 || words.len().checked_sub(11) != Some(count) {
        return Err(format!(
            "FLASER says {count} beams and has {} words, not beams + 11; mend or delete the line",
            words.len()
        ));
    }
    let pose = |at: usize| {
        let [x, y, yaw] = [at, at + 1, at + 2].map(|at| number(words, at));
        Ok::<_, String>([x?, y?, yaw?])
    };
    Ok(LogScan {
        line: 0,
        time: number(words, count + 8)?,
        ranges: (2..2 + count)
            .map(|at| number(words, at))
            .collect::<Result<_, _>>()?,
        laser: pose(count + 2)?,
        odometry: pose(count + 5)?,
        speed: [0.0; 2],
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
            ("ODOM 1 2 NaN 0 0 0 1 host 1", "a.log:1: `NaN`"),
            ("", "a.log:1: no FLASER"),
        ] {
            let error = scans("a.log", bad).unwrap_err();
            assert!(error.starts_with(what), "{error}");
        }
    }

    #[test]
    fn scans_of_two_lasers_and_times_that_go_back_are_refused() {
        let line =
            |beams: &str, time: f64| format!("FLASER {beams} 0 0 0 0 0 0 {time} host {time}\n");
        let mixed = line("2 1 2", 1.0) + &line("3 1 2 3", 2.0);
        assert!(
            scans("a", &mixed)
                .unwrap_err()
                .starts_with("a:2: FLASER has 3")
        );
        let back = line("2 1 2", 1.0) + &line("2 1 2", 0.5);
        assert!(scans("a", &back).unwrap_err().starts_with("a:2: time 0.5"));
    }

    #[test]
    fn a_gzip_file_is_unpacked_and_a_broken_one_names_its_line() {
        use std::io::Write as _;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.gz");
        let text: String = (0..2000_u64)
            .map(|k| format!("{} line\n", k * k * 7919))
            .collect();
        let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        packer.write_all(text.as_bytes()).unwrap();
        let packed = packer.finish().unwrap();
        std::fs::write(&path, &packed).unwrap();
        assert_eq!(read(&path).unwrap(), text);
        std::fs::write(&path, &packed[..packed.len() / 2]).unwrap();
        let error = read(&path).unwrap_err();
        assert!(
            error.contains("a.gz:") && error.contains("copy it again"),
            "{error}"
        );
    }
}

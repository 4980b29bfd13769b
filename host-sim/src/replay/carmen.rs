//! CARMEN logs: laser scans with the odometry pose at the scan.
//!
//! `FLASER n r1 … rn x y θ ox oy oθ t host t'` is a scan, the laser's pose and the robot's, and
//! `ODOM x y θ v ω a t host t'` the wheels' speed. A sweep is 180°: 180 or 360 beams lie at
//! −90° + i·180°/n; 181 or 361 beams include both ends.
//!
//! `ROBOTLASER1` is the newer form of a scan. It tells its angles and its range:
//! `type start field step most accuracy mode n r1 … rn m i1 … im x y θ ox oy oθ v ω …`, and at its
//! end `t host t'`. Beam i lies at start + i·step. Other lines are not read.
//!
//! Some logs have scans whose times go back by fractions of a second. They are sorted.
//!
//! Invariant: all scans have the same beams, and times never decrease.
//! Units: metres, radians, seconds.

use core::f64::consts::{FRAC_PI_2, PI};
use std::io::Read as _;
use std::path::Path;

use flate2::read::MultiGzDecoder;

/// Most by which a time may be before one that was read, seconds. A log that goes back by more is
/// two logs.
const MOST_BACK_S: f64 = 1.0;

/// The scans of a log, in the order of time.
#[derive(Clone, Debug, PartialEq)]
pub struct Log {
    /// The scans.
    pub scans: Vec<LogScan>,
    /// Number of scans whose time was before one that was read.
    pub late: usize,
    /// By how much at most, seconds.
    pub late_s: f64,
}

/// The beams of a laser.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beams {
    /// Angle of the first beam in the robot's frame, radians.
    pub first_rad: f64,
    /// Angle from one beam to the next, radians.
    pub step_rad: f64,
    /// A reading that is not below this met nothing, metres.
    pub most_m: f64,
}

/// One laser scan of a log. `line` counts from 1.
#[derive(Clone, Debug, PartialEq)]
pub struct LogScan {
    /// Line of the log, from 1.
    pub line: usize,
    /// Seconds.
    pub time: f64,
    /// Metres, from right to left.
    pub ranges: Vec<f64>,
    /// The laser's beams.
    pub beams: Beams,
    /// Pose of the laser at the scan: x, y in metres, heading in radians.
    pub laser: [f64; 3],
    /// Odometry at the scan: x, y in metres, heading in radians.
    pub odometry: [f64; 3],
    /// Speed and turn rate, of the last ODOM line or of the scan's own, metres and radians per
    /// second.
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
    #[must_use]
    pub fn angle(&self, beam: usize) -> f64 {
        self.beams.first_rad + beam as f64 * self.beams.step_rad
    }
}

impl Beams {
    /// Returns this number of beams over 180°.
    #[must_use]
    pub fn half_turn(count: usize) -> Self {
        let gaps = if count % 2 == 1 { count - 1 } else { count };
        Self {
            first_rad: -FRAC_PI_2,
            step_rad: PI / gaps.max(1) as f64,
            most_m: f64::INFINITY,
        }
    }
}

/// Reads all scans.
///
/// # Errors
/// The file, the line and the remedy.
pub fn log(file: &str, text: &str) -> Result<Log, String> {
    let mut found: Vec<LogScan> = Vec::new();
    let mut speed = [0.0; 2];
    for (index, content) in text.lines().enumerate() {
        let line = index + 1;
        let at = |what: String| format!("{file}:{line}: {what}");
        let words: Vec<&str> = content.split_whitespace().collect();
        let scan = match words.first() {
            Some(&"ODOM") => {
                speed = wheels(&words).map_err(at)?;
                continue;
            }
            Some(&"FLASER") => LogScan {
                speed,
                ..flaser(&words).map_err(at)?
            },
            Some(&"ROBOTLASER1") => robotlaser(&words).map_err(at)?,
            _ => continue,
        };
        if let Some(first) = found.first() {
            is_of_laser(first, &scan).map_err(at)?;
        }
        found.push(LogScan { line, ..scan });
    }
    if found.is_empty() {
        let end = text.lines().count().max(1);
        return Err(format!(
            "{file}:{end}: no FLASER or ROBOTLASER1 line up to here; give a CARMEN log with laser \
             scans"
        ));
    }
    in_order(file, found)
}

/// Checks that a scan is one of the laser of another one.
fn is_of_laser(first: &LogScan, scan: &LogScan) -> Result<(), String> {
    if scan.ranges.len() != first.ranges.len() {
        return Err(format!(
            "the scan has {} beams, and line {} has {}; give a log of one laser",
            scan.ranges.len(),
            first.line,
            first.ranges.len()
        ));
    }
    if scan.beams != first.beams {
        return Err(format!(
            "the scan has other angles or another range than line {}; give a log of one laser",
            first.line
        ));
    }
    Ok(())
}

/// Sorts scans by time. Equal times keep their order.
fn in_order(file: &str, mut scans: Vec<LogScan>) -> Result<Log, String> {
    let (mut late, mut late_s) = (0, 0.0_f64);
    let mut newest: Option<(f64, usize)> = None;
    for scan in &scans {
        let (time, line) = newest.unwrap_or((scan.time, scan.line));
        if time - scan.time > MOST_BACK_S {
            return Err(format!(
                "{file}:{}: time {} is {:.2} s before that of line {line}; sort the log by time, \
                 or cut it there",
                scan.line,
                scan.time,
                time - scan.time
            ));
        }
        if scan.time < time {
            late += 1;
            late_s = late_s.max(time - scan.time);
        } else {
            newest = Some((scan.time, scan.line));
        }
    }
    scans.sort_by(|a, b| a.time.total_cmp(&b.time));
    Ok(Log {
        scans,
        late,
        late_s,
    })
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

/// Reads x, y and heading from a word on.
fn pose(words: &[&str], at: usize) -> Result<[f64; 3], String> {
    let [x, y, yaw] = [at, at + 1, at + 2].map(|at| number(words, at));
    Ok([x?, y?, yaw?])
}

/// Reads numbers from a word on.
fn numbers(words: &[&str], from: usize, count: usize) -> Result<Vec<f64>, String> {
    (from..from + count).map(|at| number(words, at)).collect()
}

fn flaser(words: &[&str]) -> Result<LogScan, String> {
    let count = words.get(1).and_then(|word| word.parse::<usize>().ok());
    let count = count.ok_or("FLASER has no number of beams; mend or delete the line")?;
    if count < 2 || words.len().checked_sub(11) != Some(count) {
        return Err(format!(
            "FLASER says {count} beams and has {} words, not beams + 11; mend or delete the line",
            words.len()
        ));
    }
    Ok(LogScan {
        line: 0,
        time: number(words, count + 8)?,
        ranges: numbers(words, 2, count)?,
        beams: Beams::half_turn(count),
        laser: pose(words, count + 2)?,
        odometry: pose(words, count + 5)?,
        speed: [0.0; 2],
    })
}

/// Words of a `ROBOTLASER1` line without beams: 9 before the ranges, the number of remissions, and
/// 14 behind them.
const ROBOTLASER_WORDS: usize = 24;

fn robotlaser(words: &[&str]) -> Result<LogScan, String> {
    let counted = |at: usize| words.get(at).and_then(|word| word.parse::<usize>().ok());
    let beams = counted(8).filter(|&beams| (2..words.len()).contains(&beams));
    let beams = beams.ok_or("ROBOTLASER1 has no number of beams; mend or delete the line")?;
    let remissions = counted(beams + 9).filter(|&count| count < words.len());
    let remissions =
        remissions.ok_or("ROBOTLASER1 has no number of remissions; mend or delete the line")?;
    if words.len() != beams + remissions + ROBOTLASER_WORDS {
        return Err(format!(
            "ROBOTLASER1 says {beams} beams and {remissions} remissions and has {} words, not \
             both + {ROBOTLASER_WORDS}; mend or delete the line",
            words.len()
        ));
    }
    let (first_rad, step_rad, most_m) = (number(words, 2)?, number(words, 4)?, number(words, 5)?);
    if step_rad <= 0.0 || most_m <= 0.0 {
        return Err(format!(
            "ROBOTLASER1 has the angle {step_rad} between beams and the range {most_m}; give \
             numbers above 0"
        ));
    }
    let behind = beams + remissions + 10;
    Ok(LogScan {
        line: 0,
        time: number(words, behind + 11)?,
        ranges: numbers(words, 9, beams)?,
        beams: Beams {
            first_rad,
            step_rad,
            most_m,
        },
        laser: pose(words, behind)?,
        odometry: pose(words, behind + 3)?,
        speed: [number(words, behind + 6)?, number(words, behind + 7)?],
    })
}

#[cfg(test)]
mod tests;

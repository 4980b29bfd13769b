//! CARMEN logs: laser scans with the odometry pose at the scan.
//!
//! `FLASER n r1 … rn x y θ ox oy oθ t host t'` is a scan, the laser's pose and the robot's, and
//! `ODOM x y θ v ω a t host t'` the wheels' speed. `RLASER` is the same of a laser behind. A sweep
//! is 180°: 180 or 360 beams lie at −90° + i·180°/n; 181 or 361 beams include both ends. Other
//! sweeps are found by [`sweep`](super::sweep).
//!
//! `ROBOTLASER1` is the newer form of a scan. It tells its angles and its range:
//! `type start field step most accuracy mode n r1 … rn m i1 … im x y θ ox oy oθ v ω …`, and at its
//! end `t host t'`. Beam i lies at start + i·step. Other lines are not read.
//!
//! Some logs have scans whose times go back by fractions of a second. They are sorted. What cannot
//! be used is left out and counted, with its first line: [`LeftOut`].
//!
//! Invariant: all scans have the same angles, about as many beams, and times never decrease.
//! Units: metres, radians, seconds.

mod left_out;
mod line;
mod tidy;

use core::f64::consts::{FRAC_PI_2, PI};
use std::io::Read as _;
use std::path::Path;

use flate2::read::MultiGzDecoder;

pub use left_out::{LeftOut, Lines, Why};
use line::Line;
use tidy::tidied;
pub use tidy::{is_near, usual_beams};

/// The scans of a log, in the order of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Log {
    /// The scans.
    pub scans: Vec<LogScan>,
    /// The form of their lines.
    pub form: Form,
    /// Number of scans whose time was before one that was read.
    pub late: usize,
    /// By how much at most, seconds.
    pub late_s: f64,
    /// Scans that have some beams more or less than the usual number.
    pub resampled: Option<Lines>,
    /// Lines that are left out.
    pub left_out: LeftOut,
}

/// The form of a scan's line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Form {
    /// `FLASER`, the laser ahead. The line does not tell its field of view.
    #[default]
    Flaser,
    /// `RLASER`, the laser behind. The line does not tell its field of view.
    Rlaser,
    /// `ROBOTLASER1`, which tells its angles and its range.
    Robotlaser,
}

/// The beams of a laser.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beams {
    /// Angle of the first beam in the robot's frame, radians.
    pub first_rad: f64,
    /// Angle from one beam to the next, radians; below 0 for a laser that turns clockwise.
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

/// Reads all scans of one laser, in the order of time. What cannot be used is left out and counted.
///
/// # Errors
/// If less than half of the scans can be used: the file, a line and the remedy.
pub fn log(file: &str, text: &str) -> Result<Log, String> {
    let mut found: Vec<(Form, LogScan)> = Vec::new();
    let mut log = Log::default();
    let mut worst: Option<(usize, String)> = None;
    let (mut speed, mut laser_lines) = ([0.0; 2], 0);
    for (index, content) in text.lines().enumerate() {
        let line = index + 1;
        let read = line::read(content);
        laser_lines += usize::from(is_scan(content));
        match read {
            Ok(Line::Wheels(wheels)) => speed = wheels,
            Ok(Line::Scan(form, scan)) => {
                let speed = if form == Form::Robotlaser {
                    scan.speed
                } else {
                    speed
                };
                found.push((
                    form,
                    LogScan {
                        line,
                        speed,
                        ..scan
                    },
                ));
            }
            Ok(Line::Other) => {}
            Err((why, what)) => {
                log.left_out.count(why, line);
                worst.get_or_insert((line, what));
            }
        }
    }
    let log = tidied(found, log);
    if laser_lines == 0 {
        let end = text.lines().count().max(1);
        return Err(format!(
            "{file}:{end}: no FLASER, RLASER or ROBOTLASER1 line up to here; give a CARMEN log \
             with laser scans"
        ));
    }
    is_mostly_used(file, &log, laser_lines, worst)?;
    Ok(log)
}

/// Returns true for a line that begins as a scan.
fn is_scan(content: &str) -> bool {
    let first = content.split_whitespace().next();
    matches!(first, Some("FLASER" | "RLASER" | "ROBOTLASER1"))
}

/// Refuses a log of which most scans are left out. Those of another laser are no fault of the log.
fn is_mostly_used(
    file: &str,
    log: &Log,
    laser_lines: usize,
    worst: Option<(usize, String)>,
) -> Result<(), String> {
    let others = log.left_out.of(Why::OtherLaser).map_or(0, |it| it.lines);
    let own = laser_lines - others;
    let used = log.scans.len();
    if used > 0 && 2 * used >= own {
        return Ok(());
    }
    let line = worst.as_ref().map(|(line, _)| *line);
    let line = line.or_else(|| log.left_out.first_line()).unwrap_or(1);
    let what = worst.map_or_else(String::new, |(_, what)| format!(" ({what})"));
    Err(format!(
        "{file}:{line}: of {own} scans {} cannot be used{what}: {}; give a log of one laser and \
         one drive as its driver wrote it, or mend or delete these lines",
        own - used,
        log.left_out
    ))
}

#[cfg(test)]
mod tests;

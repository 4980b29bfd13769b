//! Lines of a CARMEN log: words to numbers.
//!
//! A range may be NaN or infinite: these are codes, which [`Sectors`](crate::robot::Sectors) reads.
//! A pose, a speed or a time may not. Some systems write `1.#INF`, `1.#QNAN` and `-1.#IND`.
//!
//! Invariant: a scan of a line has finite poses, speeds and time, and at least two ranges.
//! Units: metres, radians, seconds.

use super::left_out::Why;
use super::{Beams, Form, LogScan};

/// A fault of a line, and what is wrong in it.
pub(super) type Fault = (Why, String);

/// What a line says.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Line {
    /// Speed and turn rate of the wheels.
    Wheels([f64; 2]),
    /// A scan, and the form that it has.
    Scan(Form, LogScan),
    /// Nothing that is read here.
    Other,
}

/// Reads a line. Its scan has no line number, and `FLASER` and `RLASER` have no speed.
pub(super) fn read(content: &str) -> Result<Line, Fault> {
    let words: Vec<&str> = content.split_whitespace().collect();
    Ok(match words.first() {
        Some(&"ODOM") => Line::Wheels(wheels(&words)?),
        Some(&"FLASER") => Line::Scan(Form::Flaser, flaser(&words)?),
        Some(&"RLASER") => Line::Scan(Form::Rlaser, flaser(&words)?),
        Some(&"ROBOTLASER1") => Line::Scan(Form::Robotlaser, robotlaser(&words)?),
        _ => Line::Other,
    })
}

fn garbled(what: impl Into<String>) -> Fault {
    (Why::Garbled, what.into())
}

/// Reads a word that may be no finite number.
fn reading(words: &[&str], at: usize) -> Result<f64, Fault> {
    let word = words.get(at).copied().unwrap_or_default();
    if let Ok(value) = word.parse() {
        return Ok(value);
    }
    let code = word.to_ascii_uppercase();
    if code.contains("#INF") {
        let sign = if code.starts_with('-') { -1.0 } else { 1.0 };
        return Ok(sign * f64::INFINITY);
    }
    if ["#QNAN", "#SNAN", "#IND", "NAN("]
        .map(|nan| code.contains(nan))
        .contains(&true)
    {
        return Ok(f64::NAN);
    }
    Err(garbled(format!("`{word}` is not a number")))
}

/// Reads a word that is a finite number.
fn number(words: &[&str], at: usize) -> Result<f64, Fault> {
    let value = reading(words, at)?;
    if value.is_finite() {
        return Ok(value);
    }
    let word = words.get(at).copied().unwrap_or_default();
    Err((Why::NotFinite, format!("`{word}` is not a finite number")))
}

/// Reads the speeds of an `ODOM` line.
fn wheels(words: &[&str]) -> Result<[f64; 2], Fault> {
    if words.len() < 8 {
        return Err(garbled("ODOM has fewer than 7 numbers"));
    }
    for at in 1..8 {
        number(words, at)?;
    }
    Ok([number(words, 4)?, number(words, 5)?])
}

/// Reads x, y and heading from a word on.
fn pose(words: &[&str], at: usize) -> Result<[f64; 3], Fault> {
    let [x, y, yaw] = [at, at + 1, at + 2].map(|at| number(words, at));
    Ok([x?, y?, yaw?])
}

/// Reads ranges from a word on.
fn ranges(words: &[&str], from: usize, count: usize) -> Result<Vec<f64>, Fault> {
    (from..from + count).map(|at| reading(words, at)).collect()
}

/// Reads a `FLASER` or `RLASER` line.
fn flaser(words: &[&str]) -> Result<LogScan, Fault> {
    let name = words.first().copied().unwrap_or_default();
    let count = words.get(1).and_then(|word| word.parse::<usize>().ok());
    let count = count.ok_or_else(|| garbled(format!("{name} has no number of beams")))?;
    if count < 2 || words.len().checked_sub(11) != Some(count) {
        return Err(garbled(format!(
            "{name} says {count} beams and has {} words, not beams + 11",
            words.len()
        )));
    }
    Ok(LogScan {
        line: 0,
        time: number(words, count + 8)?,
        ranges: ranges(words, 2, count)?,
        beams: Beams::half_turn(count),
        laser: pose(words, count + 2)?,
        odometry: pose(words, count + 5)?,
        speed: [0.0; 2],
    })
}

/// Words of a `ROBOTLASER1` line without beams: 9 before the ranges, the number of remissions, and
/// 14 behind them.
const ROBOTLASER_WORDS: usize = 24;

/// Reads a `ROBOTLASER1` line.
fn robotlaser(words: &[&str]) -> Result<LogScan, Fault> {
    let counted = |at: usize| words.get(at).and_then(|word| word.parse::<usize>().ok());
    let beams = counted(8).filter(|&beams| (2..words.len()).contains(&beams));
    let beams = beams.ok_or_else(|| garbled("ROBOTLASER1 has no number of beams"))?;
    let remissions = counted(beams + 9).filter(|&count| count < words.len());
    let remissions =
        remissions.ok_or_else(|| garbled("ROBOTLASER1 has no number of remissions"))?;
    if words.len() != beams + remissions + ROBOTLASER_WORDS {
        return Err(garbled(format!(
            "ROBOTLASER1 says {beams} beams and {remissions} remissions and has {} words, not \
             both + {ROBOTLASER_WORDS}",
            words.len()
        )));
    }
    let behind = beams + remissions + 10;
    Ok(LogScan {
        line: 0,
        time: number(words, behind + 11)?,
        ranges: ranges(words, 9, beams)?,
        beams: told_beams(words)?,
        laser: pose(words, behind)?,
        odometry: pose(words, behind + 3)?,
        speed: [number(words, behind + 6)?, number(words, behind + 7)?],
    })
}

/// Reads the angles and the range that a `ROBOTLASER1` line tells.
fn told_beams(words: &[&str]) -> Result<Beams, Fault> {
    let (first_rad, step_rad) = (number(words, 2)?, number(words, 4)?);
    let most_m = reading(words, 5)?;
    // The comparison is false for NaN.
    if step_rad > 0.0 && most_m > 0.0 {
        return Ok(Beams {
            first_rad,
            step_rad,
            most_m,
        });
    }
    Err(garbled(format!(
        "ROBOTLASER1 has the angle {step_rad} between beams and the range {most_m}; both must be \
         above 0"
    )))
}

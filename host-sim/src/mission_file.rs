//! Mission files: what a robot knows, what it may not enter, where it drives after its exploration,
//! and what it may spend. Strict TOML; docs/MISSIONS.md explains every key.
//!
//! ```toml
//! bounds_m = [[[6, 3], [18, 3], [18, 11], [6, 11]]]
//! goto_m = [[8, 5]]
//! then = "home"
//! time_s = 600
//! ```
//!
//! A fault names the file, the line, what is wrong and what to write. Each key means the same as
//! the option of `explore` that [`KEYS`] names beside it.
//!
//! Units: metres in the frame of the world, seconds.

use core::fmt;
use core::ops::Range;
use std::fs;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use toml::{Spanned, Value};

use crate::fence::Polygon;
use crate::known_map::pose_of;
use crate::near;
use crate::trial::itinerary::{MOST_PAUSES, Pause};
use crate::world::Start;

/// The keys, each with the option of `explore` that means the same.
pub const KEYS: [(&str, &str); 10] = [
    ("known", "known"),
    ("known_pose_m_deg", "known-pose"),
    ("bounds_m", "bounds"),
    ("no_go_m", "no-go"),
    ("goto_m", "goto"),
    ("then", "then"),
    ("range_m", "range-m"),
    ("time_s", "time-s"),
    ("home_at_s", "home-at"),
    ("pauses_s", "pause"),
];

/// Farthest coordinate of a place, metres.
const MOST_M: f64 = 3_200.0;
/// Latest time, seconds.
const MOST_S: f64 = 4e6;

/// Why a text is no mission.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MissionFileError {
    /// The file.
    pub file: String,
    /// Line of the fault, from 1; `None` if the file cannot be read.
    pub line: Option<usize>,
    /// The fault and the remedy.
    pub what: String,
}

impl fmt::Display for MissionFileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            Some(line) => write!(f, "{}:{line}: {}", self.file, self.what),
            None => write!(f, "{}: {}", self.file, self.what),
        }
    }
}

impl core::error::Error for MissionFileError {}

/// A mission as a file tells it. A key that is not in the file is empty or `None`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MissionFile {
    /// The map that the robot knows at its start.
    pub known: Option<PathBuf>,
    /// Where it then stands in that map's frame.
    pub known_pose: Option<Start>,
    /// The robot stays inside of each.
    pub bounds: Vec<Polygon>,
    /// The robot stays out of each.
    pub no_go: Vec<Polygon>,
    /// Places to drive to after the exploration, metres.
    pub goals_m: Vec<[f64; 2]>,
    /// True if the robot then drives home.
    pub home: bool,
    /// Metres that it may drive.
    pub range_m: Option<u16>,
    /// Seconds that it may take.
    pub time_s: Option<u16>,
    /// Time at which it drives home, milliseconds.
    pub home_at_ms: Option<u32>,
    /// When it stands and waits.
    pub pauses: Vec<Pause>,
    /// The lines of the keys that are there, from 1, in the order of [`KEYS`].
    pub lines: Vec<(&'static str, usize)>,
}

type Places = Vec<Spanned<Vec<Value>>>;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    known: Option<Spanned<String>>,
    known_pose_m_deg: Option<Spanned<Vec<Value>>>,
    bounds_m: Option<Spanned<Vec<Spanned<Places>>>>,
    no_go_m: Option<Spanned<Vec<Spanned<Places>>>>,
    goto_m: Option<Spanned<Places>>,
    then: Option<Spanned<String>>,
    range_m: Option<Spanned<Value>>,
    time_s: Option<Spanned<Value>>,
    home_at_s: Option<Spanned<Value>>,
    pauses_s: Option<Spanned<Places>>,
}

/// A fault and its place in the text.
type Fault = (Range<usize>, String);

/// Reads a mission file. Returns the mission and the text.
///
/// # Errors
/// The fault, with file and line.
pub fn read(path: &Path) -> Result<(MissionFile, String), MissionFileError> {
    let file = path.display().to_string();
    let text = fs::read_to_string(path).map_err(|error| MissionFileError {
        file: file.clone(),
        line: None,
        what: format!("cannot read this mission file: {error}"),
    })?;
    Ok((parse(&file, &text)?, text))
}

/// Parses the text of a mission file. `file` is for the error.
///
/// # Errors
/// As [`read`].
pub fn parse(file: &str, text: &str) -> Result<MissionFile, MissionFileError> {
    let fault = |(span, what): Fault| MissionFileError {
        file: file.into(),
        line: Some(line_of(text, &span)),
        what,
    };
    let keys: Keys = toml::from_str(text).map_err(|error| {
        let span = error.span().unwrap_or_default();
        fault((span, with_hint(error.message())))
    })?;
    mission(&keys, (file, text)).map_err(fault)
}

fn mission(keys: &Keys, (file, text): (&str, &str)) -> Result<MissionFile, Fault> {
    let spans = [
        keys.known.as_ref().map(Spanned::span),
        keys.known_pose_m_deg.as_ref().map(Spanned::span),
        keys.bounds_m.as_ref().map(Spanned::span),
        keys.no_go_m.as_ref().map(Spanned::span),
        keys.goto_m.as_ref().map(Spanned::span),
        keys.then.as_ref().map(Spanned::span),
        keys.range_m.as_ref().map(Spanned::span),
        keys.time_s.as_ref().map(Spanned::span),
        keys.home_at_s.as_ref().map(Spanned::span),
        keys.pauses_s.as_ref().map(Spanned::span),
    ];
    let there = KEYS.iter().zip(spans);
    let lines = there.filter_map(|((key, _), span)| Some((*key, line_of(text, &span?))));
    Ok(MissionFile {
        known: keys.known.as_ref().map(|it| beside(file, it.get_ref())),
        known_pose: keys.known_pose_m_deg.as_ref().map(known_pose).transpose()?,
        bounds: polygons("bounds_m", keys.bounds_m.as_ref())?,
        no_go: polygons("no_go_m", keys.no_go_m.as_ref())?,
        goals_m: match &keys.goto_m {
            Some(places) => all(places, |it| point("goto_m", it))?,
            None => Vec::new(),
        },
        home: then(keys.then.as_ref())?,
        range_m: budget("range_m", keys.range_m.as_ref())?,
        time_s: budget("time_s", keys.time_s.as_ref())?,
        home_at_ms: keys.home_at_s.as_ref().map(home_at).transpose()?,
        pauses: pauses(keys.pauses_s.as_ref())?,
        lines: lines.collect(),
    })
}

/// Returns a path that is relative to the mission file.
fn beside(file: &str, path: &str) -> PathBuf {
    Path::new(file).parent().unwrap_or(Path::new("")).join(path)
}

fn known_pose(value: &Spanned<Vec<Value>>) -> Result<Start, Fault> {
    let numbers: Option<Vec<f64>> = value.get_ref().iter().map(number).collect();
    let numbers = numbers.as_deref().map(<[f64; 3]>::try_from);
    match numbers {
        Some(Ok(numbers)) => pose_of(numbers),
        _ => None,
    }
    .ok_or_else(|| {
        let what = "known_pose_m_deg is [x, y, degrees]: metres within 3200, degrees within 360";
        (value.span(), what.into())
    })
}

fn all<T, U>(list: &Spanned<Vec<T>>, of: impl Fn(&T) -> Result<U, Fault>) -> Result<Vec<U>, Fault> {
    list.get_ref().iter().map(of).collect()
}

/// Returns the polygons of a key: lists of corners.
fn polygons(
    key: &str,
    list: Option<&Spanned<Vec<Spanned<Places>>>>,
) -> Result<Vec<Polygon>, Fault> {
    let Some(list) = list else {
        return Ok(Vec::new());
    };
    all(list, |corners| {
        let places = all(corners, |it| point(key, it))?;
        Polygon::of(&places).map_err(|_| {
            let what = format!(
                "a polygon of {key} is [[x, y], [x, y], ...] in metres, with three \
                                corners or more, or two corners of a rectangle"
            );
            (corners.span(), what)
        })
    })
}

/// Returns a place: two finite numbers, not too far away.
fn point(key: &str, place: &Spanned<Vec<Value>>) -> Result<[f64; 2], Fault> {
    let numbers: Vec<f64> = place.get_ref().iter().filter_map(number).collect();
    match numbers[..] {
        [x, y] if place.get_ref().len() == 2 && x.abs().max(y.abs()) <= MOST_M => Ok([x, y]),
        _ => {
            let what = format!("a place of {key} is [x, y] in metres, within {MOST_M} m");
            Err((place.span(), what))
        }
    }
}

fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Integer(whole) => Some(*whole as f64),
        Value::Float(number) if number.is_finite() => Some(*number),
        _ => None,
    }
}

fn then(what: Option<&Spanned<String>>) -> Result<bool, Fault> {
    match what {
        None => Ok(false),
        Some(home) if home.get_ref() == "home" => Ok(true),
        Some(other) => {
            let what = format!("then is \"{}\"; give \"home\"", other.get_ref());
            Err((other.span(), what))
        }
    }
}

fn budget(key: &str, value: Option<&Spanned<Value>>) -> Result<Option<u16>, Fault> {
    let Some(value) = value else {
        return Ok(None);
    };
    let whole = value.get_ref().as_integer();
    match whole.and_then(|it| u16::try_from(it).ok()) {
        Some(whole) if whole > 0 => Ok(Some(whole)),
        _ => {
            let what = format!(
                "{key} is {}; give a whole number, 1 to 65535",
                value.get_ref()
            );
            Err((value.span(), what))
        }
    }
}

fn home_at(value: &Spanned<Value>) -> Result<u32, Fault> {
    let seconds = number(value.get_ref()).filter(|it| (0.0..=MOST_S).contains(it));
    seconds.map(milliseconds).ok_or_else(|| {
        let what = format!(
            "home_at_s is {}; give 0 to {MOST_S} seconds",
            value.get_ref()
        );
        (value.span(), what)
    })
}

fn milliseconds(seconds: f64) -> u32 {
    (seconds * 1000.0).round() as u32
}

fn pauses(list: Option<&Spanned<Places>>) -> Result<Vec<Pause>, Fault> {
    let Some(list) = list else {
        return Ok(Vec::new());
    };
    let pauses = all(list, |pause| {
        let numbers: Vec<f64> = pause.get_ref().iter().filter_map(number).collect();
        match numbers[..] {
            [from, to]
                if pause.get_ref().len() == 2 && 0.0 <= from && from < to && to <= MOST_S =>
            {
                Ok(Pause {
                    from_ms: milliseconds(from),
                    to_ms: milliseconds(to),
                })
            }
            _ => {
                let what =
                    format!("a pause of pauses_s is [from, to] in seconds, from 0 to {MOST_S}");
                Err((pause.span(), what))
            }
        }
    })?;
    if pauses.len() > MOST_PAUSES {
        let what = format!(
            "pauses_s has {} pauses; give {MOST_PAUSES} at most",
            pauses.len()
        );
        return Err((list.span(), what));
    }
    Ok(pauses)
}

/// Returns the line of a place in a text, from 1.
fn line_of(text: &str, span: &Range<usize>) -> usize {
    let before = text.get(..span.start).unwrap_or(text);
    before.matches('\n').count() + 1
}

/// Returns the parser's words on one line, for an unknown key with the known one that is nearest.
fn with_hint(message: &str) -> String {
    let message = message.replace('\n', " ");
    let unknown = message.strip_prefix("unknown field `");
    match unknown.and_then(|rest| rest.split('`').next()) {
        Some(unknown) => {
            let known = KEYS.map(|(key, _)| key);
            let hint = near::hint(unknown, known);
            format!(
                "unknown key {unknown}{hint}; the keys are {}",
                known.join(", ")
            )
        }
        None => message,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_means_what_its_options_mean() {
        let text = "# A floor without its stairs.\n\
                    known = \"maps/floor.yaml\"\nknown_pose_m_deg = [1, 2.5, 90]\n\
                    bounds_m = [[[6, 3], [18, 11]]]\n\
                    no_go_m = [[[13.5, 8], [14.5, 8], [14, 9]]]\n\
                    goto_m = [[8, 5], [15, 7.5]]\n\
                    then = \"home\"\n\
                    range_m = 300\ntime_s = 600\nhome_at_s = 90.5\npauses_s = [[60, 80]]\n";
        let mission = parse("tour/m.toml", text).expect("a mission");
        assert_eq!(mission.known, Some("tour/maps/floor.yaml".into()));
        assert_eq!(mission.known_pose, pose_of([1.0, 2.5, 90.0]));
        let polygon = |text: &str| text.parse::<Polygon>().expect("a polygon");
        assert_eq!(mission.bounds, [polygon("6,3,18,11")]);
        assert_eq!(mission.no_go, [polygon("13.5,8,14.5,8,14,9")]);
        assert_eq!(mission.goals_m, [[8.0, 5.0], [15.0, 7.5]]);
        assert!(mission.home);
        assert_eq!((mission.range_m, mission.time_s), (Some(300), Some(600)));
        assert_eq!(mission.home_at_ms, Some(90_500));
        let pause = Pause {
            from_ms: 60_000,
            to_ms: 80_000,
        };
        assert_eq!(mission.pauses, [pause]);
        assert_eq!(mission.lines.first(), Some(&("known", 2)));
        assert_eq!(mission.lines.len(), KEYS.len());
        assert_eq!(
            parse("m.toml", "").expect("nothing"),
            MissionFile::default()
        );
    }

    #[test]
    fn faults_have_a_line_and_a_remedy() {
        for (text, line, words) in [
            (
                "\nbound_m = []",
                2,
                "unknown key bound_m; did you mean bounds_m?",
            ),
            ("known_pose_m_deg = [1, 2]", 1, "[x, y, degrees]"),
            ("known = 3", 1, "invalid type"),
            ("goto = [[1, 2]]", 1, "did you mean goto_m?"),
            ("then = \"hoem\"", 1, "give \"home\""),
            ("range_m = 0", 1, "1 to 65535"),
            ("range_m = 1.5", 1, "1 to 65535"),
            ("\n\ntime_s = 70000", 3, "1 to 65535"),
            ("home_at_s = -1", 1, "0 to 4000000"),
            ("home_at_s = nan", 1, "0 to 4000000"),
            ("goto_m = [[1, 2],\n [3]]", 2, "[x, y] in metres"),
            ("goto_m = [[1, inf]]", 1, "[x, y] in metres"),
            ("goto_m = [[1, 2, \"x\"]]", 1, "[x, y] in metres"),
            ("goto_m = [[1, 4000]]", 1, "within 3200 m"),
            ("bounds_m = [[[1, 2]]]", 1, "three corners"),
            ("bounds_m = [[1, 2]]", 1, "invalid type"),
            ("pauses_s = [[60, 50]]", 1, "[from, to]"),
            ("then = \"home\"\nthen = \"home\"", 2, "duplicate key"),
            ("range_m = ", 1, ""),
        ] {
            let error = parse("m.toml", text).expect_err(text);
            assert_eq!(error.line, Some(line), "{text}: {error}");
            let told = error.to_string();
            assert!(
                told.contains(words) && !told.contains('\n'),
                "{text}: {told}"
            );
        }
    }
}

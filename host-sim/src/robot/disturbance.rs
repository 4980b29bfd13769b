//! Disturbances: faults of wheels and lasers on a schedule.
//!
//! | word | disturbance |
//! | --- | --- |
//! | `restart@T` | from second T on odometry tells the motion since then: it began anew at zero |
//! | `slip@T` | in the step at second T the wheels count 0.5 m and 20° too much |
//! | `spin@A-B` | from second A to B the wheels turn as commanded, and the robot stands |
//! | `push@A-B` | from A to B the robot moves as commanded, and the wheels count nothing |
//! | `dark@A-B` | from A to B no beam of any laser carries information |
//! | `missing=P` | each beam carries no information with probability P |
//!
//! To odometry a slip is the same whether the wheels or the robot moved alone. Here the wheels do,
//! so that no slip moves the robot into a wall. A slip, a spin and a push change odometry that
//! counts wheels; they do not change the true pose as odometry.
//!
//! Units: milliseconds inside, seconds in the text.

use core::fmt;
use core::str::FromStr;

use crate::spec::{Form, SpecError, Word};

/// Distance and turn that the wheels count too much in a slip, metres and radians.
const SLIP: [f64; 2] = [0.5, 20.0 * core::f64::consts::PI / 180.0];
/// Latest time of a disturbance, seconds.
const LATEST_S: f64 = 86_400.0;

/// From a time on, up to another, milliseconds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    /// The first millisecond.
    pub from_ms: u32,
    /// The first millisecond after it.
    pub to_ms: u32,
}

/// The disturbances of a run; by default none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Disturbances {
    /// Time at which odometry begins anew, milliseconds.
    pub restart_ms: Option<u32>,
    /// Time of a slip, milliseconds.
    pub slip_ms: Option<u32>,
    /// The wheels turn, and the robot stands.
    pub spin: Option<Span>,
    /// The robot moves, and the wheels stand.
    pub push: Option<Span>,
    /// The lasers are silent.
    pub dark: Option<Span>,
    /// Probability that a beam is missing.
    pub missing: f64,
}

impl Span {
    /// Returns true at a time within.
    #[must_use]
    pub const fn holds(self, time_ms: u32) -> bool {
        self.from_ms <= time_ms && time_ms < self.to_ms
    }
}

impl Disturbances {
    /// Returns true if odometry has begun anew.
    #[must_use]
    pub fn has_restarted(&self, time_ms: u32) -> bool {
        self.restart_ms.is_some_and(|at_ms| at_ms <= time_ms)
    }

    /// Returns true if the wheels turn and the robot stands.
    #[must_use]
    pub fn spins(&self, time_ms: u32) -> bool {
        self.spin.is_some_and(|span| span.holds(time_ms))
    }

    /// Returns true if the robot moves and the wheels stand.
    #[must_use]
    pub fn pushes(&self, time_ms: u32) -> bool {
        self.push.is_some_and(|span| span.holds(time_ms))
    }

    /// Returns true if the lasers are silent.
    #[must_use]
    pub fn is_dark(&self, time_ms: u32) -> bool {
        self.dark.is_some_and(|span| span.holds(time_ms))
    }

    /// Returns the distance and turn that the wheels count too much in a period.
    #[must_use]
    pub fn slip(&self, period: Span) -> [f64; 2] {
        let slips = self.slip_ms.is_some_and(|at_ms| period.holds(at_ms));
        if slips { SLIP } else { [0.0; 2] }
    }

    /// Returns true if a disturbance needs odometry that counts wheels.
    #[must_use]
    pub const fn needs_wheels(&self) -> bool {
        self.slip_ms.is_some() || self.spin.is_some() || self.push.is_some()
    }

    fn read(&mut self, word: &Word<'_>) -> Result<(), SpecError> {
        let to_ms = |seconds: f64| (seconds * 1000.0).round() as u32;
        let moment = || {
            let seconds = word.number(0.0..=LATEST_S, "a time from 0 to 86400 s")?;
            Ok(Some(to_ms(seconds)))
        };
        let span = || {
            let [from_ms, to_ms] = word.span_s(word.value, LATEST_S)?.map(to_ms);
            Ok(Some(Span { from_ms, to_ms }))
        };
        match word.key.as_str() {
            "restart@" => self.restart_ms = moment()?,
            "slip@" => self.slip_ms = moment()?,
            "spin@" => self.spin = span()?,
            "push@" => self.push = span()?,
            "dark@" => self.dark = span()?,
            "missing=" => self.missing = word.number(0.0..=0.9, "a share from 0 to 0.9")?,
            _ => return Err(word.unknown()),
        }
        Ok(())
    }
}

const FORM: Form = Form {
    what: "disturbance",
    usage: "restart@T, slip@T, spin@A-B, push@A-B, dark@A-B (seconds) and missing=P, separated by \
            commas",
    repeated: "",
};

impl FromStr for Disturbances {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, SpecError> {
        let mut disturbances = Self::default();
        FORM.read(text, |word| disturbances.read(word))?;
        Ok(disturbances)
    }
}

impl fmt::Display for Disturbances {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let seconds = |time_ms: u32| f64::from(time_ms) / 1000.0;
        let spans = [
            ("spin", self.spin),
            ("push", self.push),
            ("dark", self.dark),
        ];
        let moments = [("restart", self.restart_ms), ("slip", self.slip_ms)];
        let moments = moments
            .iter()
            .filter_map(|(name, at_ms)| Some(format!("{name}@{}", seconds((*at_ms)?))));
        let spans = spans.iter().filter_map(|(name, span)| {
            let span = span.as_ref()?;
            let [from, to] = [span.from_ms, span.to_ms].map(seconds);
            Some(format!("{name}@{from}-{to}"))
        });
        let missing = (self.missing > 0.0).then(|| format!("missing={}", self.missing));
        let words: Vec<String> = moments.chain(spans).chain(missing).collect();
        f.write_str(&words.join(","))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_read_and_written() {
        let text = "restart@50,slip@60,spin@61.5-64,push@70-71,dark@80-82,missing=0.3";
        let read: Disturbances = text.parse().expect("valid");
        assert_eq!(read.to_string(), text);
        assert_eq!(read.slip_ms, Some(60_000));
        assert!(read.has_restarted(50_000) && !read.has_restarted(49_999));
        assert!(read.spins(61_500) && read.spins(63_999) && !read.spins(64_000));
        assert!(read.pushes(70_000) && read.is_dark(81_000) && !read.is_dark(79_999));
        assert!(read.needs_wheels());
        assert!(!Disturbances::default().needs_wheels());
    }

    #[test]
    fn a_slip_is_counted_in_one_period_only() {
        let read: Disturbances = "slip@60".parse().expect("valid");
        let slip = |from_ms| {
            read.slip(Span {
                from_ms,
                to_ms: from_ms + 200,
            })
        };
        assert_eq!(
            [slip(59_800), slip(60_000), slip(60_200)],
            [[0.0; 2], SLIP, [0.0; 2]]
        );
    }

    #[test]
    fn a_bad_word_is_named() {
        for (text, word) in [
            ("", "slip@T"),
            ("slip", "'slip'"),
            ("slip@60,slip@61", "'slip' is given twice"),
            ("spin@3", "'spin@3'"),
            ("dark@5-4", "'dark@5-4'"),
            ("push@-1-4", "'push@-1-4'"),
            ("missing=1", "'missing=1'"),
            ("missing=NaN", "'missing=NaN'"),
            ("storm@1-2", "'storm@1-2'; use restart@T, slip@T"),
        ] {
            let error = text.parse::<Disturbances>().expect_err(text).to_string();
            assert!(error.contains(word), "{error}");
        }
    }
}

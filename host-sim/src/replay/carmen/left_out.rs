//! Lines of a log that are left out, counted by the reason.
//!
//! Invariant: a reason that is counted has at least one line.

use core::fmt;
use std::collections::BTreeMap;

use serde::Serialize;

/// Why a line is left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Why {
    /// Its time is before that of lines before it, and it cannot be sorted in.
    TimeBack,
    /// It has far more or far fewer beams than the others.
    Beams,
    /// None of its readings carries information.
    Empty,
    /// A pose, a speed or a time is NaN or infinite.
    NotFinite,
    /// It is cut, or a word is no number.
    Garbled,
    /// It is of another laser than most lines.
    OtherLaser,
}

/// Lines of one kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Lines {
    /// Number of lines.
    pub lines: usize,
    /// The first of them, from 1.
    pub first_line: usize,
}

impl Lines {
    /// Counts a line more in `counted`.
    pub(super) fn count(counted: &mut Option<Self>, line: usize) {
        let before = counted.unwrap_or(Self {
            lines: 0,
            first_line: line,
        });
        *counted = Some(Self {
            lines: before.lines + 1,
            first_line: before.first_line.min(line),
        });
    }
}

/// The lines that are left out, by reason.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(transparent)]
pub struct LeftOut(BTreeMap<Why, Lines>);

impl LeftOut {
    /// Counts a line.
    pub(super) fn count(&mut self, why: Why, line: usize) {
        let mut counted = self.0.get(&why).copied();
        Lines::count(&mut counted, line);
        self.0.extend(counted.map(|lines| (why, lines)));
    }

    /// Returns the lines that are left out for a reason.
    #[must_use]
    pub fn of(&self, why: Why) -> Option<Lines> {
        self.0.get(&why).copied()
    }

    /// Returns the first line that is left out.
    pub(super) fn first_line(&self) -> Option<usize> {
        self.0.values().map(|it| it.first_line).min()
    }

    /// Returns true if no line is left out.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl Why {
    /// Returns the reason, as it follows "lines".
    const fn words(self) -> &'static str {
        match self {
            Self::TimeBack => "whose time goes back",
            Self::Beams => "with another number of beams",
            Self::Empty => "without any information (all 0 or NaN)",
            Self::NotFinite => "with NaN or infinity in pose, speed or time",
            Self::Garbled => "cut or garbled",
            Self::OtherLaser => "of another laser",
        }
    }
}

/// Writes `3 lines that go back in time (the first is line 102), 1 line …`.
impl fmt::Display for LeftOut {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (place, (why, counted)) in self.0.iter().enumerate() {
            let Lines { lines, first_line } = counted;
            let comma = if place == 0 { "" } else { ", " };
            let noun = if *lines == 1 { "line" } else { "lines" };
            write!(f, "{comma}{lines} {noun} {}", why.words())?;
            let the = if *lines == 1 { "" } else { "the first is " };
            write!(f, " ({the}line {first_line})")?;
        }
        Ok(())
    }
}

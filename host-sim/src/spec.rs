//! The small languages of options: lists of words like `drop=0.02,reset@120`, lists of numbers like
//! `-135,0.5,541,12`, and one name of several.
//!
//! A word is `name`, `name=value` or `name@value`; commas part words, and spaces around them do not
//! count. Each name stands once. An error names the part, what was expected, and the known name
//! that an unknown one is near to.

use core::ops::RangeInclusive;
use core::str::FromStr;
use thiserror::Error;

use crate::near;

/// Why a text is not in an option's language: the part, and the remedy.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{0}")]
pub struct SpecError(String);

impl SpecError {
    /// An error with this sentence.
    #[must_use]
    pub fn new(reason: impl Into<String>) -> Self {
        Self(reason.into())
    }
}

/// A language of words.
#[derive(Debug)]
pub struct Form {
    /// What a word stands for, as in `fault`.
    pub what: &'static str,
    /// The words that there are, as in `drop=P, reset@N, separated by commas`.
    pub usage: &'static str,
    /// The name that may stand more than once, if any.
    pub repeated: &'static str,
}

/// A word of a list.
#[derive(Debug)]
pub struct Word<'a> {
    form: &'a Form,
    /// The whole word.
    text: &'a str,
    /// The name with its `=` or `@`, as in `drop=`, or alone.
    pub key: String,
    /// What follows; empty for a name alone.
    pub value: &'a str,
}

impl Form {
    /// Gives each word to `read`, which refuses those that it does not know by [`Word::unknown`].
    ///
    /// # Errors
    /// A word that `read` refuses, a name that stands twice, or no word at all.
    pub fn read(
        &self,
        text: &str,
        mut read: impl FnMut(&Word<'_>) -> Result<(), SpecError>,
    ) -> Result<(), SpecError> {
        let mut names = Vec::new();
        let words = text.split(',').map(str::trim);
        for text in words.filter(|word| !word.is_empty()) {
            let (name, value) = text.split_once(['=', '@']).unwrap_or((text, ""));
            let mark = &text[name.len()..text.len() - value.len()];
            let name = name.trim();
            read(&Word {
                form: self,
                text,
                key: format!("{name}{mark}"),
                value: value.trim(),
            })?;
            if name != self.repeated && names.contains(&name) {
                let reason = format!("'{name}' is given twice; keep one");
                return Err(SpecError(reason));
            }
            names.push(name);
        }
        if names.is_empty() {
            let Self { what, usage, .. } = self;
            return Err(SpecError(format!("no {what} is named; use {usage}")));
        }
        Ok(())
    }
}

impl Word<'_> {
    /// The name without its mark.
    #[must_use]
    pub fn name(&self) -> &str {
        self.key.trim_end_matches(['=', '@'])
    }

    /// The error of a word that the language does not have.
    #[must_use]
    pub fn unknown(&self) -> SpecError {
        let Form { what, usage, .. } = self.form;
        let parts = usage.split([',', ' ', '\n']);
        let known = parts.filter_map(|part| part.split(['=', '@']).next());
        let near = near::hint(self.name(), known.filter(|name| *name != self.name()));
        SpecError(format!("unknown {what} '{}'; use {usage}{near}", self.text))
    }

    /// The error of a value that is not as it must be.
    #[must_use]
    pub fn bad(&self, must: &str) -> SpecError {
        let text = self.text;
        SpecError(format!("bad value in '{text}'; it must be {must}"))
    }

    /// The value, if it is of the type and fits.
    ///
    /// # Errors
    /// As [`Word::bad`].
    pub fn parse<T: FromStr>(
        &self,
        fits: impl FnOnce(&T) -> bool,
        must: &str,
    ) -> Result<T, SpecError> {
        let value = self.value.parse().ok().filter(fits);
        value.ok_or_else(|| self.bad(must))
    }

    /// The value as a number in a range.
    ///
    /// # Errors
    /// As [`Word::bad`].
    pub fn number(&self, range: RangeInclusive<f64>, must: &str) -> Result<f64, SpecError> {
        self.parse(|number| range.contains(number), must)
    }

    /// A text `A-B`: two times in seconds, the first one earlier.
    ///
    /// # Errors
    /// As [`Word::bad`].
    pub fn span_s(&self, text: &str, latest_s: f64) -> Result<[f64; 2], SpecError> {
        let times = text.split_once('-').and_then(|(from, to)| {
            let [from, to]: [f64; 2] = [from.trim().parse().ok()?, to.trim().parse().ok()?];
            (from >= 0.0 && from < to && to <= latest_s).then_some([from, to])
        });
        times.ok_or_else(|| {
            self.bad(&format!(
                "two times from 0 to {latest_s} s, the first one earlier, A-B"
            ))
        })
    }
}

/// Parses finite numbers with commas between.
#[must_use]
pub fn numbers(text: &str) -> Option<Vec<f64>> {
    let numbers = text.split(',').map(|part| part.trim().parse().ok());
    numbers
        .map(|it: Option<f64>| it.filter(|it| it.is_finite()))
        .collect()
}

/// Returns the one of several whose name the text is.
///
/// # Errors
/// The text is none of the names.
pub fn choice<T>(
    what: &str,
    text: &str,
    all: impl IntoIterator<Item = (&'static str, T)>,
) -> Result<T, SpecError> {
    let mut names = Vec::new();
    for (name, value) in all {
        if name == text {
            return Ok(value);
        }
        names.push(name);
    }
    let near = near::hint(text, names.iter().copied());
    let (last, others) = names.split_last().unwrap_or((&"", &[]));
    let others = others.join(", ");
    let reason = format!("unknown {what} '{text}'; use {others} or {last}{near}");
    Err(SpecError(reason))
}

#[cfg(test)]
mod tests {
    use super::*;

    const FORM: Form = Form {
        what: "fault",
        usage: "drop=P, reset@N, quiet, hole@A-B, separated by commas",
        repeated: "hole",
    };

    fn read(text: &str) -> Result<Vec<String>, SpecError> {
        let mut read = Vec::new();
        FORM.read(text, |word| {
            match word.key.as_str() {
                "drop=" => drop(word.number(0.0..=0.5, "0 to 0.5")?),
                "reset@" => drop(word.parse(|n: &u64| *n > 0, "from 1 on")?),
                "hole@" => drop(word.span_s(word.value, 60.0)?),
                "quiet" => {}
                _ => return Err(word.unknown()),
            }
            read.push(format!("{}|{}", word.key, word.value));
            Ok(())
        })?;
        Ok(read)
    }

    #[test]
    fn words_have_a_name_and_maybe_a_value() {
        let words = read(" drop = 0.1, reset@3,quiet,hole@1-2 ,hole@3-4.5,").expect("valid");
        assert_eq!(
            words,
            [
                "drop=|0.1",
                "reset@|3",
                "quiet|",
                "hole@|1-2",
                "hole@|3-4.5"
            ]
        );
    }

    #[test]
    fn an_error_names_the_part_and_the_remedy() {
        for (text, words) in [
            ("", &["no fault is named", "drop=P"][..]),
            (" , ", &["no fault is named"]),
            (
                "dorp=0.1",
                &["unknown fault 'dorp=0.1'", "did you mean drop?"],
            ),
            ("drop", &["unknown fault 'drop'", "drop=P"]),
            ("drop@1", &["unknown fault 'drop@1'"]),
            ("drop=0.1,drop=0.2", &["'drop' is given twice"]),
            ("drop=1", &["'drop=1'", "0 to 0.5"]),
            ("drop=nan", &["'drop=nan'"]),
            ("reset@1.5", &["'reset@1.5'", "from 1 on"]),
            ("hole@2-1", &["'hole@2-1'", "earlier"]),
            ("hole@2", &["'hole@2'", "A-B"]),
            ("hole@2-61", &["from 0 to 60 s"]),
        ] {
            let error = read(text).expect_err(text).to_string();
            assert!(
                words.iter().all(|word| error.contains(word)),
                "{text}: {error}"
            );
        }
    }

    #[test]
    fn numbers_are_finite_and_choices_have_near_names() {
        assert_eq!(numbers("1, -2.5"), Some(vec![1.0, -2.5]));
        assert!(numbers("1,inf").is_none() && numbers("").is_none());
        let choose = |text| choice("size", text, [("small", 1), ("large", 2)]);
        assert_eq!(choose("large"), Ok(2));
        let error = choose("larg").expect_err("unknown").to_string();
        assert!(
            error.contains("use small or large; did you mean large?"),
            "{error}"
        );
    }
}

//! Fault specifications: a list like `drop=0.02,reset@120`.

use core::str::FromStr;

use crate::spec::{Form, SpecError};

/// The faults of a line, and their probabilities.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Faults {
    /// Probability that a frame loses bytes.
    pub drop: f64,
    /// Probability that bytes of a frame come twice.
    pub duplicate: f64,
    /// Probability that bytes of a frame change.
    pub corrupt: f64,
    /// Probability that a frame is cut.
    pub truncate: f64,
    /// Probability that a frame is late.
    pub delay: f64,
    /// The device reboots before this frame of the host, counted from 1.
    pub reset_at: Option<u64>,
    /// The line is dead from this frame of the host on.
    pub silent_at: Option<u64>,
}

const FORM: Form = Form {
    what: "fault",
    usage: "drop=P, duplicate=P, corrupt=P, truncate=P, delay=P, reset@N, silent@N, separated by \
            commas",
    repeated: "",
};

impl FromStr for Faults {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, SpecError> {
        let mut faults = Self::default();
        FORM.read(text, |word| {
            let frame = || {
                let must = "the number of a frame, a whole number from 1 on";
                word.parse(|frame: &u64| *frame > 0, must).map(Some)
            };
            let share = || word.number(0.0..=0.5, "a probability from 0 to 0.5");
            match word.key.as_str() {
                "drop=" => faults.drop = share()?,
                "duplicate=" => faults.duplicate = share()?,
                "corrupt=" => faults.corrupt = share()?,
                "truncate=" => faults.truncate = share()?,
                "delay=" => faults.delay = share()?,
                "reset@" => faults.reset_at = frame()?,
                "silent@" => faults.silent_at = frame()?,
                _ => return Err(word.unknown()),
            }
            Ok(())
        })?;
        Ok(faults)
    }
}

#[cfg(test)]
mod tests {
    use super::Faults;

    #[test]
    fn a_specification_is_read() {
        let faults: Faults =
            "drop=0.02, duplicate=0.01,corrupt=0.5,truncate=0,delay=0.05,reset@120,silent@200"
                .parse()
                .unwrap();
        assert_eq!(
            faults,
            Faults {
                drop: 0.02,
                duplicate: 0.01,
                corrupt: 0.5,
                truncate: 0.0,
                delay: 0.05,
                reset_at: Some(120),
                silent_at: Some(200),
            }
        );
    }

    #[test]
    fn an_invalid_specification_is_named() {
        let error = |text: &str| text.parse::<Faults>().unwrap_err().to_string();
        for (text, words) in [
            ("drop=0.1,loss=0.1", ["unknown", "'loss=0.1'"]),
            ("", ["no fault is named", "drop=P"]),
            (" , ", ["no fault is named", "drop=P"]),
            ("drop=0.1,drop=0.2", ["'drop'", "twice"]),
            ("reset@3, drop=0, reset @4", ["'reset'", "twice"]),
            ("drop", ["unknown", "'drop'"]),
            ("explode@3", ["unknown", "'explode@3'"]),
        ] {
            let error = error(text);
            assert!(words.iter().all(|it| error.contains(it)), "{error}");
        }
        for text in ["drop=1", "drop=-0.1", "drop=", "drop=NaN", "drop=2%"] {
            let error = error(text);
            assert!(
                error.contains(text) && error.contains("0 to 0.5"),
                "{error}"
            );
        }
        for text in ["reset@0", "silent@", "reset@-1", "reset@1.5"] {
            let error = error(text);
            assert!(
                error.contains(text) && error.contains("from 1 on"),
                "{error}"
            );
        }
        assert!(error("loss=1").contains("use drop=P"));
    }
}

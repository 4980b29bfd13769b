//! Fault specifications: a list like `drop=0.02,reset@120`.

use core::fmt;
use core::str::FromStr;

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

/// Why a fault specification is invalid.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FaultsError {
    /// It has no fault.
    Nothing,
    /// A word is no fault.
    Unknown(String),
    /// A fault is given twice.
    Twice(String),
    /// A value is not a probability.
    BadProbability(String),
    /// A value is not the number of a frame.
    BadCount(String),
}

impl fmt::Display for FaultsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const KNOWN: &str = "use drop=P, duplicate=P, corrupt=P, truncate=P, delay=P, \
                             reset@N, silent@N, separated by commas";
        match self {
            Self::Nothing => write!(f, "no fault is named; {KNOWN}"),
            Self::Unknown(word) => write!(f, "unknown fault '{word}'; {KNOWN}"),
            Self::Twice(name) => write!(f, "'{name}' is given twice; keep one"),
            Self::BadProbability(word) => {
                write!(f, "bad probability in '{word}'; it must be 0 to 0.5")
            }
            Self::BadCount(word) => {
                write!(
                    f,
                    "bad frame number in '{word}'; it must be a whole number from 1 on"
                )
            }
        }
    }
}

impl core::error::Error for FaultsError {}

impl FromStr for Faults {
    type Err = FaultsError;

    fn from_str(text: &str) -> Result<Self, FaultsError> {
        let mut faults = Self::default();
        let mut named = Vec::new();
        let words = text.split(',').map(str::trim);
        for word in words.filter(|word| !word.is_empty()) {
            faults.read(word)?;
            let name = word.split(['=', '@']).next().unwrap_or(word).trim();
            if named.contains(&name) {
                return Err(FaultsError::Twice(name.into()));
            }
            named.push(name);
        }
        if named.is_empty() {
            return Err(FaultsError::Nothing);
        }
        Ok(faults)
    }
}

impl Faults {
    fn read(&mut self, word: &str) -> Result<(), FaultsError> {
        if let Some((name, count)) = word.split_once('@') {
            let place = match name.trim() {
                "reset" => &mut self.reset_at,
                "silent" => &mut self.silent_at,
                _ => return Err(FaultsError::Unknown(word.into())),
            };
            let count: Option<u64> = count.trim().parse().ok();
            *place = Some(
                count
                    .filter(|count| *count > 0)
                    .ok_or_else(|| FaultsError::BadCount(word.into()))?,
            );
            return Ok(());
        }
        let (name, value) = word
            .split_once('=')
            .ok_or_else(|| FaultsError::Unknown(word.into()))?;
        let place = match name.trim() {
            "drop" => &mut self.drop,
            "duplicate" => &mut self.duplicate,
            "corrupt" => &mut self.corrupt,
            "truncate" => &mut self.truncate,
            "delay" => &mut self.delay,
            _ => return Err(FaultsError::Unknown(word.into())),
        };
        let value: Option<f64> = value.trim().parse().ok();
        let possible = |value: &f64| (0.0..=0.5).contains(value);
        *place = value
            .filter(possible)
            .ok_or_else(|| FaultsError::BadProbability(word.into()))?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::{Faults, FaultsError};

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
        let error = |text: &str| text.parse::<Faults>().unwrap_err();
        assert_eq!(
            error("drop=0.1,loss=0.1"),
            FaultsError::Unknown("loss=0.1".into())
        );
        for text in ["", " , "] {
            assert_eq!(error(text), FaultsError::Nothing);
        }
        for (text, name) in [
            ("drop=0.1,drop=0.2", "drop"),
            ("reset@3, drop=0, reset @4", "reset"),
        ] {
            assert_eq!(error(text), FaultsError::Twice(name.into()));
        }
        assert_eq!(error("drop"), FaultsError::Unknown("drop".into()));
        assert_eq!(error("explode@3"), FaultsError::Unknown("explode@3".into()));
        for text in ["drop=1", "drop=-0.1", "drop=", "drop=NaN", "drop=2%"] {
            assert_eq!(error(text), FaultsError::BadProbability(text.into()));
        }
        for text in ["reset@0", "silent@", "reset@-1", "reset@1.5"] {
            assert_eq!(error(text), FaultsError::BadCount(text.into()));
        }
        assert!(error("loss=1").to_string().contains("use drop=P"));
    }
}

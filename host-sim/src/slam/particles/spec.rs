//! A particle filter by name, as in `300`, `300,proposal=motion`, `200,noise=4`.

use core::fmt;
use core::str::FromStr;

use super::proposal::Proposal;
use crate::spec::{Form, SpecError, Word};

/// Most particles.
pub const MOST_PARTICLES: usize = 1_000;

/// A particle filter beside a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParticleSpec {
    /// Number of particles, 1 to [`MOST_PARTICLES`].
    pub count: usize,
    /// How they move.
    pub proposal: Proposal,
    /// Variances of the random walk of an odometry of its own, in multiples of the usual ones, 0 to
    /// 1,000. `None` for the odometry of the run.
    pub noise: Option<f64>,
}

const FORM: Form = Form {
    what: "word",
    usage: "proposal=motion, proposal=matched or noise=20, separated by commas",
    repeated: "",
};

impl FromStr for ParticleSpec {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, SpecError> {
        let (count, words) = text.split_once(',').unwrap_or((text, ""));
        let count = count.parse().ok();
        let count = count.filter(|count| (1..=MOST_PARTICLES).contains(count));
        let mut spec = Self {
            count: count.ok_or_else(|| {
                SpecError::new(format!(
                    "begin with a number of particles from 1 to {MOST_PARTICLES}, as in 300"
                ))
            })?,
            proposal: Proposal::default(),
            noise: None,
        };
        let read = |word: &Word<'_>| {
            match (word.key.as_str(), word.value) {
                ("proposal=", "motion") => spec.proposal = Proposal::Motion,
                ("proposal=", "matched") => spec.proposal = Proposal::Matched,
                ("proposal=", _) => return Err(word.bad("motion or matched")),
                ("noise=", _) => spec.noise = Some(word.number(0.0..=1e3, "from 0 to 1000")?),
                _ => return Err(word.unknown()),
            }
            Ok(())
        };
        if !words.is_empty() {
            FORM.read(words, read)?;
        }
        Ok(spec)
    }
}

impl fmt::Display for ParticleSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{},proposal={}", self.count, self.proposal.name())?;
        self.noise
            .map_or(Ok(()), |noise| write!(f, ",noise={noise}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_shown_is_read_again() {
        for text in [
            "300,proposal=matched",
            "1,proposal=motion",
            "1000,proposal=matched,noise=0.5",
        ] {
            let spec: ParticleSpec = text.parse().expect("valid");
            assert_eq!(spec.to_string(), text);
        }
        assert_eq!(
            "300".parse(),
            "300,proposal=matched".parse::<ParticleSpec>()
        );
    }

    #[test]
    fn each_mistake_names_its_remedy() {
        for (text, remedy) in [
            ("", "as in 300"),
            ("0", "1 to 1000"),
            ("1001", "1 to 1000"),
            ("many", "as in 300"),
            ("300,proposal=best", "motion or matched"),
            ("300,noise=-1", "0 to 1000"),
            ("300,noise=NaN", "0 to 1000"),
            ("300,matched", "proposal=matched"),
        ] {
            let error = text.parse::<ParticleSpec>().expect_err(text).to_string();
            assert!(error.contains(remedy), "{text}: {error}");
        }
    }
}

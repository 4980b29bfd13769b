//! Generators of sessions, from absurd to plausible.
//!
//! | generator | session | observations and packets |
//! | --- | --- | --- |
//! | absurd | permitted ones, and some refused | any that the wire can carry |
//! | tame | of an ordinary Pioneer 3-AT | any that the wire can carry |
//! | plausible | of an ordinary Pioneer 3-AT | of a simulated robot in a world, sometimes spoilt |
//!
//! Half of the sessions are short. The lengths have a heavy tail, up to [`LONGEST`] requests. A
//! plausible session has four times as many steps.

mod absurd;
mod companion;
mod corrections;
mod fences;
mod packets;
mod plausible;
mod quantities;
mod scans;
mod spoil;
mod starts;

use core::str::FromStr;

use super::ask::{Answer, Ask};
use super::choices::{Bytes, Choices};
use super::target::Capacity;
use crate::spec::{self, SpecError};

/// Most requests of a session, or steps of a plausible one.
pub const LONGEST: usize = 2_000;

/// A host: it makes one request after the other.
pub trait Host {
    /// Returns the next request, given the answer to the last one; `None` at the end.
    fn next(&mut self, last: Option<&Answer>) -> Option<Ask>;
}

/// A host that repeats recorded requests.
#[derive(Clone, Debug)]
pub struct Replayed<'a>(core::slice::Iter<'a, Ask>);

impl<'a> Replayed<'a> {
    /// Repeats these requests.
    #[must_use]
    pub fn new(asks: &'a [Ask]) -> Self {
        Self(asks.iter())
    }
}

impl Host for Replayed<'_> {
    fn next(&mut self, _: Option<&Answer>) -> Option<Ask> {
        self.0.next().cloned()
    }
}

/// A kind of generator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Generator {
    /// Any session, any observation.
    Absurd,
    /// An ordinary session, any observation.
    Tame,
    /// An ordinary session in a world, spoilt.
    Plausible,
}

impl FromStr for Generator {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, SpecError> {
        spec::choice("generator", text, Self::ALL.map(|it| (it.name(), it)))
    }
}

impl Generator {
    /// Every kind.
    pub const ALL: [Self; 3] = [Self::Absurd, Self::Tame, Self::Plausible];

    /// The name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Absurd => "absurd",
            Self::Tame => "tame",
            Self::Plausible => "plausible",
        }
    }

    /// Returns a host that takes its choices from `choices` and makes at most `longest` requests,
    /// or `longest` steps if it simulates a robot.
    pub fn host<'a, C: Choices + 'a>(self, mut choices: C, longest: usize) -> Box<dyn Host + 'a> {
        let length = length(&mut choices).min(longest);
        match self {
            Self::Absurd => Box::new(absurd::Absurd::new(choices, length, false)),
            Self::Tame => Box::new(absurd::Absurd::new(choices, length, true)),
            Self::Plausible => {
                let steps = (4 * length).min(longest);
                Box::new(plausible::Plausible::new(choices, steps))
            }
        }
    }
}

/// Returns the session of a fuzzer's input: generator, size of the device's map, and the host.
#[must_use]
pub fn of_bytes(bytes: &[u8]) -> (Generator, Capacity, Box<dyn Host + '_>) {
    let mut choices = Bytes::new(bytes);
    let generator = choices.pick(&Generator::ALL);
    let capacity = choices.pick(&Capacity::ALL);
    (generator, capacity, generator.host(choices, LONGEST))
}

/// Draws a length: n or more with probability 4 / n.
fn length(choices: &mut impl Choices) -> usize {
    let draw = choices.bits(16) as usize + 1;
    ((4 << 16) / draw).min(LONGEST)
}

#[cfg(test)]
mod tests {
    use super::{Generator, LONGEST, length};
    use crate::session::ask::{Answer, Ask};
    use crate::session::choices::{Bytes, Choices as _, Seeded};

    fn asks(generator: Generator, seed: u64) -> Vec<Ask> {
        let mut host = generator.host(Seeded::new(seed), 60);
        let answer = Answer::Command(Box::default());
        core::iter::from_fn(|| host.next(Some(&answer))).collect()
    }

    #[test]
    fn the_same_seed_gives_the_same_requests() {
        for generator in Generator::ALL {
            assert_eq!(asks(generator, 3), asks(generator, 3));
            assert_ne!(asks(generator, 3), asks(generator, 4));
        }
    }

    #[test]
    fn every_session_begins_with_a_start_and_ends() {
        for generator in Generator::ALL {
            for seed in 0..10 {
                let asks = asks(generator, seed);
                assert!(matches!(asks[0], Ask::Start(_)), "{generator:?} {seed}");
                assert!(asks.len() <= 1 + 60 * 32, "{generator:?} {seed}");
            }
            let no_bytes = || Bytes::new(&[]);
            let mut host = generator.host(no_bytes(), LONGEST);
            assert!((0..100).any(|_| host.next(None).is_none()), "{generator:?}");
        }
    }

    #[test]
    fn lengths_have_a_heavy_tail() {
        let mut source = Seeded::new(1);
        let mut lengths: Vec<usize> = (0..10_000).map(|_| length(&mut source)).collect();
        lengths.sort_unstable();
        assert!((6..10).contains(&lengths[5_000]), "{}", lengths[5_000]);
        assert!((300..500).contains(&lengths[9_900]), "{}", lengths[9_900]);
        assert!(source.below(2) < 2);
    }
}

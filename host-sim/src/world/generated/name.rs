//! Names of generated worlds: `KIND:SEED` or `KIND:SEED:WIDTHxHEIGHT`, metres.

use core::fmt;

use super::{KINDS, Kind};
use crate::world::WorldError;
use crate::world::canvas::Canvas;

/// Shortest side, metres.
const LEAST_M: f64 = 8.0;
/// Longest side, metres.
const MOST_M: f64 = 128.0;
/// Largest area, square metres.
const MOST_M2: f64 = 4_096.0;

/// The name of a generated world. It has everything that decides the drawing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Name {
    /// Kind of building.
    pub(super) kind: Kind,
    /// Seed of the drawing.
    pub(super) seed: u64,
    /// Width and height, metres, whole cells; drawn from the seed if `None`.
    pub(super) size_m: Option<[f64; 2]>,
}

impl Name {
    /// Reads a name. Returns `None` if it does not begin as that of a generated world.
    pub(super) fn parse(text: &str) -> Option<Result<Self, WorldError>> {
        let mut parts = text.split(':');
        let word = parts.next()?;
        let kind = KINDS.iter().find(|kind| kind.word() == word)?;
        let error = |reason| WorldError::Generated {
            name: text.to_owned(),
            reason,
        };
        Some(Self::read(*kind, parts).map_err(error))
    }

    /// Reads what follows the kind; the error is the fault and the remedy.
    fn read<'a>(kind: Kind, mut parts: impl Iterator<Item = &'a str>) -> Result<Self, String> {
        let word = kind.word();
        let seed = parts.next().unwrap_or_default();
        let digits = !seed.is_empty() && seed.bytes().all(|byte| byte.is_ascii_digit());
        let seed = seed.parse().ok().filter(|_| digits).ok_or_else(|| {
            format!(
                "the seed must be a whole number from 0 to {}; say {word}:1",
                u64::MAX
            )
        })?;
        let size_m = parts.next().map(|size| read_size(word, size)).transpose()?;
        if parts.next().is_some() {
            return Err(format!("nothing follows the size; say {word}:{seed}:20x15"));
        }
        Ok(Self { kind, seed, size_m })
    }
}

/// Reads `WIDTHxHEIGHT`; returns whole cells in metres.
fn read_size(word: &str, text: &str) -> Result<[f64; 2], String> {
    let side = |text: &str| text.parse::<f64>().ok().filter(|m| m.is_finite());
    let sides = text.split_once('x');
    let Some((width_m, height_m)) = sides.and_then(|(a, b)| side(a).zip(side(b))) else {
        return Err(format!(
            "the size must be width x height in metres; say {word}:1:20x15"
        ));
    };
    // Divided by a whole number, so that a side prints without a rounding error.
    let cells_a_metre = (1.0 / Canvas::RESOLUTION_M).round();
    let size_m = [width_m, height_m].map(|m| (m * cells_a_metre).round() / cells_a_metre);
    if size_m.iter().any(|m| *m < LEAST_M) {
        return Err(format!(
            "a size of {text} m is too small; say {LEAST_M}x{LEAST_M} or more"
        ));
    }
    if size_m.iter().any(|m| *m > MOST_M) || size_m[0] * size_m[1] > MOST_M2 {
        return Err(format!(
            "a size of {text} m is too large; say 64x64, 128x32 or less"
        ));
    }
    Ok(size_m)
}

impl fmt::Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.kind.word(), self.seed)?;
        match self.size_m {
            Some([width, height]) => write!(f, ":{width}x{height}"),
            None => Ok(()),
        }
    }
}

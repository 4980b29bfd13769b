//! Strategies on the device by name, and their usual impatience. Units: seconds.

use fieldline_protocol::message::{SpaceField, Strategy};
use fixed::types::I16F16;

/// The usual impatience of strategy tdbvp, seconds (measured: docs/MEASURED.md, "Impatience of
/// tdbvp").
pub const IMPATIENCE_S: Option<u16> = Some(15);

/// The baseline that stores its potential from step to step.
pub const BVP_PAPERS: &str = "bvp-papers";

/// The usual impatience of strategy esbpf, seconds. Strategy sbpf has none.
pub(super) const ESBPF_IMPATIENCE_S: Option<u16> = Some(5);

/// Strategies on the device, by name.
pub const STRATEGIES: [(&str, Strategy); 5] = [
    ("frontier", Strategy::Frontier),
    ("ouroboros", Strategy::Ouroboros),
    (
        "tdbvp",
        Strategy::Tdbvp {
            patrol_s: 0,
            impatience_s: IMPATIENCE_S,
        },
    ),
    ("sbpf", Strategy::Sbpf(NO_FIELD)),
    ("esbpf", Strategy::Esbpf(NO_FIELD)),
];

/// A field without an area, for the list of strategies. A mission has the area of its world.
const NO_FIELD: SpaceField = SpaceField {
    origin: (I16F16::ZERO, I16F16::ZERO),
    size: (I16F16::ZERO, I16F16::ZERO),
    until_permille: 0,
    impatience_s: None,
};

/// Returns the strategy on the device of this name; a baseline has none.
#[must_use]
pub fn on_device(name: &str) -> Option<Strategy> {
    let mut known = STRATEGIES.iter();
    known
        .find(|(known, _)| *known == name)
        .map(|(_, strategy)| *strategy)
}

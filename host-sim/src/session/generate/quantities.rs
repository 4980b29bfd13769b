//! Quantities of the wire, at random.

use fixed::types::{I4F12, I16F16};

use crate::session::choices::Choices;

/// Half a turn in the wire's bits.
const HALF_TURN: i64 = 205_887;

/// Draws any number of 32 bits.
pub(super) fn wide(choices: &mut impl Choices) -> I16F16 {
    I16F16::from_bits(choices.bits(32) as i32)
}

/// Draws any number of 16 bits.
pub(super) fn narrow(choices: &mut impl Choices) -> I4F12 {
    I4F12::from_bits(choices.bits(16) as i16)
}

/// Draws a number of 32 bits from a range of bits.
pub(super) fn wide_within(choices: &mut impl Choices, low: i64, high: i64) -> I16F16 {
    I16F16::from_bits(choices.between(low, high) as i32)
}

/// Draws a number of 16 bits from a range of bits.
pub(super) fn narrow_within(choices: &mut impl Choices, low: i64, high: i64) -> I4F12 {
    I4F12::from_bits(choices.between(low, high) as i16)
}

/// Draws an angle within half a turn; rarely, any number.
pub(super) fn angle(choices: &mut impl Choices) -> I16F16 {
    if choices.once_in(50) {
        wide(choices)
    } else {
        wide_within(choices, -HALF_TURN, HALF_TURN)
    }
}

/// Draws a time origin: 0, near 2³¹, shortly before the wrap, or any.
pub(super) fn origin_ms(choices: &mut impl Choices) -> u32 {
    match choices.below(4) {
        0 => 0,
        1 => u32::MAX - choices.below(100_000) as u32,
        2 => (1 << 31) - choices.below(50_000) as u32,
        _ => choices.bits(32) as u32,
    }
}

/// Returns centimetres; it saturates.
pub(super) fn centimetres(metres: I16F16) -> i16 {
    let cm = (metres.to_num::<f64>() * 100.0).round();
    cm.clamp(f64::from(i16::MIN), f64::from(i16::MAX)) as i16
}

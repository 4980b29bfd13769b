//! Scans that no world need have caused.

use fieldline_protocol::message::{INVALID_MM, MAX_BEAMS, NO_RETURN_MM, Scan};

use crate::session::choices::{Choices, Seeded};

/// Longest step of a range that wanders, millimetres.
const WANDER_MM: i64 = 300;

/// Draws a scan: even, random, dark, a comb, rooms of steps, or ranges that wander with gaps.
pub(super) fn scan(choices: &mut impl Choices, beams: u16) -> Scan {
    let beams = usize::from(beams).min(MAX_BEAMS);
    let shape = choices.below(12);
    let mut bulk = choices.fork();
    let ranges: Vec<u16> = match shape {
        0 => vec![bulk.bits(16) as u16; beams],
        1 => (0..beams).map(|_| bulk.bits(16) as u16).collect(),
        2 => vec![NO_RETURN_MM; beams],
        3 => vec![INVALID_MM; beams],
        4 | 5 => comb(&mut bulk, beams),
        6 | 7 => steps(&mut bulk, beams),
        8 => ramp(&mut bulk, beams),
        _ => wander(&mut bulk, beams),
    };
    Scan {
        ranges_mm: ranges.into_iter().collect(),
    }
}

/// Two ranges in turn.
fn comb(bulk: &mut Seeded, beams: usize) -> Vec<u16> {
    let tooth = 1 + bulk.below(6) as usize;
    let (near, far) = (bulk.between(100, 4_000), bulk.between(2_000, 16_383));
    let is_near = |beam: usize| (beam / tooth).is_multiple_of(2);
    let range = |beam| if is_near(beam) { near } else { far };
    (0..beams).map(|beam| range(beam) as u16).collect()
}

/// Pieces of one range each.
fn steps(bulk: &mut Seeded, beams: usize) -> Vec<u16> {
    let longest = bulk.between(2, 40) as u64;
    let mut ranges = Vec::with_capacity(beams);
    while ranges.len() < beams {
        let range = bulk.between(150, 9_000) as u16;
        let piece = 1 + bulk.below(longest) as usize;
        ranges.extend(vec![range; piece.min(beams - ranges.len())]);
    }
    ranges
}

/// From one range to another.
fn ramp(bulk: &mut Seeded, beams: usize) -> Vec<u16> {
    let (from, to) = (bulk.between(100, 12_000), bulk.between(100, 12_000));
    let last = (beams as i64 - 1).max(1);
    let range = |beam: usize| from + (to - from) * beam as i64 / last;
    (0..beams).map(|beam| range(beam) as u16).collect()
}

/// A range that wanders, with gaps and random values.
fn wander(bulk: &mut Seeded, beams: usize) -> Vec<u16> {
    let mut range = bulk.between(50, 12_000);
    let draw = |_| {
        range = (range + bulk.between(-WANDER_MM, WANDER_MM)).clamp(1, 16_000);
        match bulk.below(12) {
            0 => NO_RETURN_MM,
            1 => bulk.bits(16) as u16,
            _ => range as u16,
        }
    };
    (0..beams).map(draw).collect()
}

//! Corrections of a hostile host: any epochs, motions, tiles, shifts and cells; in order, and lost,
//! doubled or cut short.

use fieldline_protocol::message::{
    Correct, CorrectedTile, CorrectedTiles, MOST_CORRECTED, Motion, RECALLED_POINTS,
    RECALLED_TRACK, Recall, RecalledPoint,
};

use fixed::types::I16F16;

use super::packets::cells;
use super::quantities::{angle, wide, wide_within};
use crate::session::ask::Ask;
use crate::session::choices::Choices;

/// Greatest ordinary shift of the pose, and turn, in the wire's bits: 2 m and 0.1 rad.
const MOVES: (i64, i64) = (131_072, 6_554);

/// The corrections of a session.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Corrections {
    epoch: u16,
}

impl Corrections {
    /// Draws the requests of a correction.
    pub(super) fn requests(&mut self, choices: &mut impl Choices) -> Vec<Ask> {
        self.epoch = match choices.below(16) {
            14 => choices.bits(16) as u16,
            15 => self.epoch,
            _ => self.epoch.saturating_add(1),
        };
        let parts = choices.below(5) as u16;
        let mut asks = Vec::new();
        let mut tiles = 0;
        for number in 0..parts {
            let mut part = self.part(choices, tiles);
            tiles += part.tiles.len() as u16;
            part.last = number + 1 == parts || choices.once_in(8);
            if choices.once_in(8) {
                part.first = choices.bits(16) as u16;
            }
            let times = choices.pick(&[1, 1, 1, 1, 1, 1, 2, 0]);
            asks.extend((0..times).map(|_| Ask::CorrectTiles(Box::new(part.clone()))));
        }
        let count = match choices.below(16) {
            14 => choices.bits(16) as u16,
            15 => MOST_CORRECTED + 1,
            _ => tiles,
        };
        asks.insert(0, Ask::Correct(Box::new(self.opening(choices, count))));
        if choices.once_in(4) {
            asks.push(Ask::Recall(Box::new(self.recall(choices))));
        }
        asks
    }

    /// Draws what lies around a robot: any points and any track.
    fn recall(self, choices: &mut impl Choices) -> Recall {
        let mut recall = Recall {
            epoch: self.epoch,
            ..Recall::default()
        };
        let is_far = choices.once_in(8);
        recall.origin = (place(choices, is_far), place(choices, is_far));
        for _ in 0..choices.below(RECALLED_POINTS as u64 + 1) {
            let mut near = || choices.between(-1_500, 1_500) as i16;
            let point = RecalledPoint {
                x_mm: near(),
                y_mm: near(),
                returns: choices.pick(&[1, 2, 8, 8, 8, 255, 255, 9, 0]),
            };
            // There is room for as many as are drawn.
            let _ = recall.points.push(point);
        }
        if !choices.once_in(4) {
            recall.track_end = Some(Motion {
                x: place(choices, is_far),
                y: place(choices, is_far),
                yaw: angle(choices),
            });
        }
        for _ in 0..choices.below(RECALLED_TRACK as u64 + 1) {
            let mut by = || choices.bits(8) as i8;
            let _ = recall.track.push([by(), by(), by()]);
        }
        recall
    }

    fn opening(self, choices: &mut impl Choices, tiles: u16) -> Correct {
        let motion = if choices.once_in(8) {
            Motion {
                x: wide(choices),
                y: wide(choices),
                yaw: angle(choices),
            }
        } else {
            let (most, most_turn) = MOVES;
            Motion {
                x: wide_within(choices, -most, most),
                y: wide_within(choices, -most, most),
                yaw: wide_within(choices, -most_turn, most_turn),
            }
        };
        Correct {
            epoch: self.epoch,
            motion,
            tiles,
        }
    }

    fn part(self, choices: &mut impl Choices, first: u16) -> CorrectedTiles {
        let mut part = CorrectedTiles {
            epoch: if choices.once_in(16) {
                choices.bits(16) as u16
            } else {
                self.epoch
            },
            first,
            ..CorrectedTiles::default()
        };
        for _ in 0..choices.below(11) {
            let bytes = if choices.once_in(4) {
                heapless::Vec::new()
            } else {
                cells(choices)
            };
            let is_near = !choices.once_in(8);
            let mut place = || match is_near {
                true => choices.between(-6, 6) as i16,
                false => choices.bits(16) as i16,
            };
            let (x, y) = (place(), place());
            let mut by = || choices.bits(8) as i8;
            let shift = (by(), by());
            // What does not fit is left out, and a length may be wrong then.
            if part.cells.extend_from_slice(&bytes).is_ok() || choices.once_in(8) {
                let tile = CorrectedTile {
                    x,
                    y,
                    shift,
                    bytes: bytes.len() as u16,
                    trail: choices.once_in(8),
                };
                let _ = part.tiles.push(tile);
            }
        }
        part
    }
}

/// Draws a coordinate: near the robot's start, or anything.
fn place(choices: &mut impl Choices, is_far: bool) -> I16F16 {
    let (most, _) = MOVES;
    match is_far {
        true => wide(choices),
        false => wide_within(choices, -most, most),
    }
}

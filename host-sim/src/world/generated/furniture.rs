//! Furniture: desks, cupboards, tables and chairs on legs, plants, and rubble.
//!
//! A piece stands at a wall, or free in the room. The gap to what stands there already is drawn for
//! each piece, from one that the robot cannot pass to one that it passes easily. Doors stay clear.

use core::f64::consts::PI;

use super::dice::Dice;
use super::sheet::{Sheet, squared};
use crate::world::occupancy::Class;

/// Least gap between two pieces, least and most, metres.
const GAP_M: [f64; 2] = [0.4, 1.0];
/// Distance from the middle of a door to the nearest furniture, metres.
const DOORWAY_M: f64 = 0.9;
/// Distance between the legs of a chair, metres. Legs are 4 cm thick, so each fills one cell.
const SEAT_M: f64 = 0.4;

/// A kind of furniture.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Piece {
    /// A solid box down to the floor.
    Block,
    /// Four legs.
    Legs,
    /// A disc.
    Round,
}

/// A room that is being furnished.
pub(super) struct Room {
    /// Its floor, from (x0, y0) to (x1, y1).
    floor: [f64; 4],
    /// Centre and radius of circles around pieces, and around doors.
    taken: Vec<([f64; 2], f64)>,
}

impl Room {
    /// An empty room of a plan that has all of its doors.
    pub(super) fn new(sheet: &Sheet, floor: [f64; 4]) -> Self {
        let doors = sheet.doors().iter();
        Self {
            floor,
            taken: doors.map(|door| (door.middle, DOORWAY_M)).collect(),
        }
    }

    /// Puts in furniture: `density` tries for each square metre; most find no place.
    pub(super) fn furnish(&mut self, dice: &mut Dice, sheet: &mut Sheet, density: f64) {
        let [x0, y0, x1, y1] = self.floor;
        let trials = ((x1 - x0) * (y1 - y0) * density) as usize;
        for _ in 0..trials {
            if dice.chance(0.55) {
                self.at_a_wall(dice, sheet);
            } else {
                self.in_the_room(dice, sheet);
            }
        }
    }

    /// A cupboard, a shelf or a desk with a chair, its back to a wall.
    fn at_a_wall(&mut self, dice: &mut Dice, sheet: &mut Sheet) {
        let [x0, y0, x1, y1] = self.floor;
        let desk = dice.chance(0.5);
        let (long_m, deep_m) = if desk {
            (dice.metres(1.2, 1.8), dice.metres(0.6, 0.8))
        } else {
            (dice.metres(0.6, 2.0), dice.metres(0.3, 0.6))
        };
        let wall = dice.index(4);
        let upright = wall < 2;
        let [w, h] = if upright {
            [deep_m, long_m]
        } else {
            [long_m, deep_m]
        };
        if x1 - x0 < w + GAP_M[1] || y1 - y0 < h + GAP_M[1] {
            return;
        }
        let x = [
            x0 + w / 2.0,
            x1 - w / 2.0,
            dice.metres(x0, x1 - w) + w / 2.0,
        ];
        let y = [
            y0 + h / 2.0,
            y1 - h / 2.0,
            dice.metres(y0, y1 - h) + h / 2.0,
        ];
        let centre = match wall {
            0 | 1 => [x[wall], y[2]],
            _ => [x[2], y[wall - 2]],
        };
        let gap_m = dice.between(GAP_M[0], GAP_M[1]);
        if !self.take(centre, [w / 2.0, h / 2.0], gap_m) {
            return;
        }
        let piece = if desk && dice.chance(0.4) {
            Piece::Legs
        } else {
            Piece::Block
        };
        put(sheet, piece, centre, ([w / 2.0, h / 2.0], [1.0, 0.0]));
        if desk {
            let inward = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]][wall];
            let away_m = deep_m / 2.0 + SEAT_M / 2.0 + dice.metres(0.05, 0.4);
            let seat = [0, 1].map(|k| centre[k] + inward[k] * away_m);
            self.chair(dice, sheet, seat);
        }
    }

    /// A table with chairs, a block or a plant, at any angle, away from the walls.
    fn in_the_room(&mut self, dice: &mut Dice, sheet: &mut Sheet) {
        let [x0, y0, x1, y1] = self.floor;
        let gap_m = dice.between(GAP_M[0], GAP_M[1]);
        let (piece, half) = match dice.index(4) {
            0 => (Piece::Legs, [dice.metres(0.5, 0.9), dice.metres(0.35, 0.5)]),
            1 => (Piece::Block, [dice.metres(0.3, 0.9), dice.metres(0.2, 0.4)]),
            2 => (Piece::Round, [dice.between(0.1, 0.3); 2]),
            _ => (Piece::Legs, [SEAT_M / 2.0; 2]),
        };
        let along = if dice.chance(0.5) {
            [[1.0, 0.0], [0.0, 1.0]][dice.index(2)]
        } else {
            dice.turn(PI)
        };
        let reach_m = (half[0] * half[0] + half[1] * half[1]).sqrt();
        let margin_m = reach_m + gap_m;
        if x1 - x0 < 2.0 * margin_m || y1 - y0 < 2.0 * margin_m {
            return;
        }
        let x = dice.metres(x0 + margin_m, x1 - margin_m);
        let y = dice.metres(y0 + margin_m, y1 - margin_m);
        if !self.take([x, y], half, gap_m) {
            return;
        }
        put(sheet, piece, [x, y], (half, along));
        if piece == Piece::Legs && half[0] > 0.4 {
            for side in [1.0, -1.0] {
                let away_m = side * (half[1] + dice.metres(0.05, 0.35));
                self.chair(dice, sheet, [x - along[1] * away_m, y + along[0] * away_m]);
            }
        }
    }

    /// A chair that belongs to a table or a desk, so it may stand close to it.
    fn chair(&mut self, dice: &mut Dice, sheet: &mut Sheet, seat: [f64; 2]) {
        let [x0, y0, x1, y1] = self.floor;
        let inside = |m: f64, low: f64, high: f64| m > low + SEAT_M && m < high - SEAT_M;
        let clear = |door: &super::sheet::Door| !door.is_near(seat, DOORWAY_M + SEAT_M / 2.0);
        if dice.chance(0.8)
            && inside(seat[0], x0, x1)
            && inside(seat[1], y0, y1)
            && sheet.doors().iter().all(clear)
        {
            put(sheet, Piece::Legs, seat, ([SEAT_M / 2.0; 2], dice.turn(PI)));
            self.taken.push((seat, SEAT_M * 0.7));
        }
    }

    /// Takes the place of a piece, as circles along its longer side; false if something is nearer
    /// than the gap.
    fn take(&mut self, centre: [f64; 2], half: [f64; 2], gap_m: f64) -> bool {
        let short = half[0].min(half[1]);
        let radius_m = short * 1.2;
        let run = [half[0] - short, half[1] - short];
        let circles = [-1.0, -0.5, 0.0, 0.5, 1.0].map(|k| {
            let middle = [centre[0] + k * run[0], centre[1] + k * run[1]];
            (middle, radius_m)
        });
        let free = circles.iter().all(|(point, radius_m)| {
            self.taken.iter().all(|(other, reach_m)| {
                let apart = radius_m + reach_m + gap_m;
                squared(*point, *other) > apart * apart
            })
        });
        if free {
            self.taken.extend(circles);
        }
        free
    }
}

/// Draws a piece of half size `half` around its centre, its length along a unit vector.
fn put(sheet: &mut Sheet, piece: Piece, centre: [f64; 2], (half, along): ([f64; 2], [f64; 2])) {
    match piece {
        Piece::Block => sheet.slab(Class::Wall, centre, half, along),
        Piece::Round => sheet.disc(Class::Wall, centre, half[0]),
        Piece::Legs => {
            for [a, b] in [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]] {
                let (a, b) = (a * half[0], b * half[1]);
                sheet.post([
                    centre[0] + a * along[0] - b * along[1],
                    centre[1] + a * along[1] + b * along[0],
                ]);
            }
        }
    }
}

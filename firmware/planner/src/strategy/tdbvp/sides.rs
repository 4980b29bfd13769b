//! Side preference: at a fork the robot turns to the side where it last saw openings [Maffei14, V].
//!
//! The half disc before the robot is parted into left and right; the preferred side attracts with +ε, the other repels with −ε. An
//! *opening* is a sudden increase of the ranges to one side, and votes for that side; the preference changes only when two votes
//! in a row are equal. So a robot that passed a way to its left, and then another, turns left at the next fork, which is how a
//! loop is closed.
//!
//! Openings to both sides at once vote for neither.
//!
//! The paper gives neither ε nor the size of the disc. They were measured on a symmetric T and a symmetric cross (`tests/tests/sides.rs`),
//! in 20 approaches to each with openings on the left, and with openings on the right; how many turned there:
//!
//! | ε | T | cross |
//! | --- | --- | --- |
//! | 0 | 6, 13 | 0, 9 |
//! | 0.1 | 20, 20 | 3, 11 |
//! | 0.2 | 20, 20 | 20, 20 |
//! | 0.3 | 20, 20 | 20, 20 |
//! | 0.6 | 14, 12 | 14, 13 |
//!
//! Of 100 approaches 100, 100, 99 and 99 turn there with ε = 0.2, the least that suffices; a strong one draws the robot past the ways.
//! The disc's 2 m are those of the local goal.
//!
//! Departs from the paper: the preference acts where the way parts within the disc, and not all the time. In a corridor there is nothing to prefer:
//! there it drew the robot to a wall, turned the disc with it and made it swing, with a third of the time spent on the spot.
//!
//! Units: metres, radians.

use crate::robot::LaserMount;

/// Greatest range that counts, metres: what is farther is open anyhow.
const FARTHEST_M: f32 = 4.0;
/// Increase of the mean range to a side that is an opening, metres.
const OPENING_M: f32 = 1.0;
/// The side's beams, radians from straight ahead.
const SECTOR_RAD: (f32, f32) = (1.2, core::f32::consts::FRAC_PI_2);
/// Radius of the disc, metres.
pub const DISC_M: f32 = 2.0;
/// Preference of a half.
pub const EPSILON: f32 = 0.2;

/// Left or right.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// To the left.
    Left,
    /// To the right.
    Right,
}

/// The ranges to one side.
#[derive(Clone, Copy, Debug)]
struct Flank {
    /// The least mean range since the last opening, metres; infinite at first.
    least_m: f32,
    /// An opening is beside the robot, and has voted.
    is_open: bool,
}

impl Flank {
    const NEW: Self = Self {
        least_m: f32::INFINITY,
        is_open: false,
    };

    /// The mean range now; whether an opening begins.
    fn note(&mut self, mean_m: f32) -> bool {
        let opens = mean_m > self.least_m + OPENING_M;
        let begins = opens && !self.is_open;
        if self.is_open && mean_m < self.least_m + 0.5 * OPENING_M {
            *self = Self::NEW;
        }
        self.is_open |= begins;
        self.least_m = self.least_m.min(mean_m);
        begins
    }
}

/// The votes so far.
#[derive(Clone, Copy, Debug)]
pub struct Sides {
    flanks: [Flank; 2],
    last_vote: Option<Side>,
    preferred: Option<Side>,
}

impl Sides {
    /// No vote yet, no preference.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            flanks: [Flank::NEW; 2],
            last_vote: None,
            preferred: None,
        }
    }

    /// The side that is preferred, after two equal votes.
    #[must_use]
    pub const fn preferred(&self) -> Option<Side> {
        self.preferred
    }

    /// A vote for a side.
    pub fn vote(&mut self, side: Side) {
        if self.last_vote.replace(side) == Some(side) {
            self.preferred = Some(side);
        }
    }

    /// A scan of the level laser.
    pub fn note(&mut self, laser: &LaserMount, ranges_mm: &[u16]) {
        let [left, right] = &mut self.flanks;
        let opens = |flank: &mut Flank, side| {
            mean_range(laser, ranges_mm, side).is_some_and(|mean_m| flank.note(mean_m))
        };
        match (opens(left, Side::Left), opens(right, Side::Right)) {
            (true, false) => self.vote(Side::Left),
            (false, true) => self.vote(Side::Right),
            // Both are no side.
            _ => {}
        }
    }
}

impl Default for Sides {
    fn default() -> Self {
        Self::new()
    }
}

/// Mean of the ranges to a side, none counted farther than [`FARTHEST_M`].
fn mean_range(laser: &LaserMount, ranges_mm: &[u16], side: Side) -> Option<f32> {
    let is_beside = |bearing: f32| {
        let left = if side == Side::Left {
            bearing
        } else {
            -bearing
        };
        (SECTOR_RAD.0..=SECTOR_RAD.1).contains(&left)
    };
    let (mut sum_m, mut beams) = (0.0, 0.0);
    for (k, &range_mm) in ranges_mm.iter().enumerate() {
        let bearing = laser.first_bearing_rad + k as f32 * laser.bearing_step_rad;
        if range_mm != crate::input::INVALID_MM && is_beside(bearing) {
            sum_m += (f32::from(range_mm) * 1e-3).min(FARTHEST_M);
            beams += 1.0;
        }
    }
    (beams > 0.0).then(|| sum_m / beams)
}

#[cfg(test)]
mod tests {
    use super::{Side, Sides};
    use crate::robot::LaserMount;

    const LASER: LaserMount = LaserMount {
        x_m: 0.0,
        y_m: 0.0,
        z_m: 0.3,
        pitch_rad: 0.0,
        first_bearing_rad: -core::f32::consts::FRAC_PI_2,
        bearing_step_rad: core::f32::consts::PI / 180.0,
        beams: 181,
        range_limit_mm: 12_000,
    };

    /// A scan with walls at 1 m, and nothing near on the open sides.
    fn scan(open: &[Side]) -> [u16; 181] {
        core::array::from_fn(|k| {
            let side = if k > 90 { Side::Left } else { Side::Right };
            if open.contains(&side) { 16_383 } else { 1_000 }
        })
    }

    fn preferred(passed: &[Side]) -> Option<Side> {
        let mut sides = Sides::new();
        for &side in passed {
            for _ in 0..5 {
                sides.note(&LASER, &scan(&[]));
            }
            for _ in 0..9 {
                sides.note(&LASER, &scan(&[side]));
            }
        }
        sides.preferred()
    }

    #[test]
    fn two_equal_votes_in_a_row_set_the_side_and_one_does_not() {
        use Side::{Left, Right};
        assert_eq!(preferred(&[]), None);
        assert_eq!(preferred(&[Left]), None);
        assert_eq!(preferred(&[Left, Right]), None);
        assert_eq!(preferred(&[Left, Left]), Some(Left));
        assert_eq!(preferred(&[Left, Left, Right]), Some(Left));
        assert_eq!(preferred(&[Left, Left, Right, Left]), Some(Left));
        assert_eq!(preferred(&[Left, Left, Right, Right]), Some(Right));
    }

    #[test]
    fn openings_to_both_sides_at_once_are_no_vote() {
        let mut sides = Sides::new();
        for _ in 0..4 {
            sides.note(&LASER, &scan(&[]));
            sides.note(&LASER, &scan(&[Side::Left, Side::Right]));
        }
        assert_eq!((sides.last_vote, sides.preferred()), (None, None));
    }

    #[test]
    fn an_opening_votes_once_and_noise_does_not() {
        let mut sides = Sides::new();
        sides.note(&LASER, &scan(&[]));
        for k in 0..50 {
            let ranges = scan(&[Side::Left]).map(|range| range.min(3_000) + k * 17 % 90);
            sides.note(&LASER, &ranges);
        }
        assert_eq!(sides.preferred(), None, "one long opening is one vote");
        assert_eq!(sides.last_vote, Some(Side::Left));
    }
}

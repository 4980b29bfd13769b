//! Side preference: at a fork the robot turns to the side where it last passed openings
//! \[Maffei14, V\].
//!
//! ```text
//! ε = +`side_preference` on the preferred side, minus that on the other   in the half disc ahead
//! ```
//!
//! An *opening* is a sudden increase of the mean range to one side, and a vote for that side. The
//! first vote sets the preference, and two equal votes in a row change it. So a robot that passed
//! two openings on its left turns left at the next fork, which closes a loop. Openings on both
//! sides at once are no vote.
//!
//! The paper gives neither ε nor the disc's radius. A smaller ε does not turn every robot at a
//! cross, and a larger one draws it past the arms (measured: docs/MEASURED.md, "Side preference at
//! a fork").
//!
//! Departs from \[Maffei14, V\]: the preference acts only where the skeleton has a junction in the
//! disc. In a corridor it draws the robot to a wall, turns the disc with it and makes it swing.
//!
//! Units: metres, radians.

use core::f32::consts::FRAC_PI_2;

use crate::config::TdbvpTuning;
use crate::robot::LaserMount;

/// Left or right.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// To the left.
    Left,
    /// To the right.
    Right,
}

/// Detects openings on one side.
#[derive(Clone, Copy, Debug)]
struct OpeningDetector {
    /// The least mean range since the last opening, metres; infinite at first.
    least_m: f32,
    /// An opening is beside the robot, and has voted.
    is_open: bool,
}

impl OpeningDetector {
    const NEW: Self = Self {
        least_m: f32::INFINITY,
        is_open: false,
    };

    /// Takes the present mean range. Returns true if an opening begins.
    fn note(&mut self, mean_m: f32, tuning: &TdbvpTuning) -> bool {
        let opens = mean_m > self.least_m + tuning.opening_m;
        let begins = opens && !self.is_open;
        if self.is_open && mean_m < self.least_m + tuning.closed_share * tuning.opening_m {
            *self = Self::NEW;
        }
        self.is_open |= begins;
        self.least_m = self.least_m.min(mean_m);
        begins
    }
}

/// The votes so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct SideVotes {
    /// To the left and to the right.
    detectors: [OpeningDetector; 2],
    last_vote: Option<Side>,
    preferred: Option<Side>,
}

impl SideVotes {
    /// No vote and no preference.
    pub(super) const NEW: Self = Self {
        detectors: [OpeningDetector::NEW; 2],
        last_vote: None,
        preferred: None,
    };

    /// Returns the preferred side; `None` before the first vote.
    pub(super) const fn preferred(&self) -> Option<Side> {
        self.preferred
    }

    /// Votes for a side.
    fn vote(&mut self, side: Side) {
        if self.last_vote.replace(side) == Some(side) || self.preferred.is_none() {
            self.preferred = Some(side);
        }
    }

    /// Takes a scan of the level laser.
    pub(super) fn note(&mut self, laser: &LaserMount, ranges_mm: &[u16], tuning: &TdbvpTuning) {
        let [left, right] = &mut self.detectors;
        let opens = |detector: &mut OpeningDetector, side| {
            mean_range_m(laser, ranges_mm, side, tuning)
                .is_some_and(|mean_m| detector.note(mean_m, tuning))
        };
        match (opens(left, Side::Left), opens(right, Side::Right)) {
            (true, false) => self.vote(Side::Left),
            (false, true) => self.vote(Side::Right),
            _ => {}
        }
    }
}

/// Returns the mean of the ranges to a side, each at most `farthest_m`; `None` without a valid beam
/// there.
fn mean_range_m(
    laser: &LaserMount,
    ranges_mm: &[u16],
    side: Side,
    tuning: &TdbvpTuning,
) -> Option<f32> {
    let is_beside = |bearing: f32| {
        let to_side = match side {
            Side::Left => bearing,
            Side::Right => -bearing,
        };
        (tuning.beside_rad..=FRAC_PI_2).contains(&to_side)
    };
    let (mut sum_m, mut beams) = (0.0, 0.0);
    for (k, &range_mm) in ranges_mm.iter().enumerate() {
        let bearing = laser.first_bearing_rad + k as f32 * laser.bearing_step_rad;
        if range_mm != crate::input::INVALID_MM && is_beside(bearing) {
            sum_m += (f32::from(range_mm) * 1e-3).min(tuning.farthest_m);
            beams += 1.0;
        }
    }
    (beams > 0.0).then(|| sum_m / beams)
}

#[cfg(test)]
mod tests {
    use super::{Side, SideVotes};
    use crate::config::TdbvpTuning;
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
        turn_time_ms: 0,
        newest_first: false,
    };

    /// A scan with walls at 1 m, and nothing within range on the open sides.
    fn scan(open: &[Side]) -> [u16; 181] {
        core::array::from_fn(|k| {
            let side = if k > 90 { Side::Left } else { Side::Right };
            if open.contains(&side) { 16_383 } else { 1_000 }
        })
    }

    fn preferred(passed: &[Side]) -> Option<Side> {
        let mut votes = SideVotes::NEW;
        for &side in passed {
            for _ in 0..5 {
                votes.note(&LASER, &scan(&[]), &TdbvpTuning::DEFAULT);
            }
            for _ in 0..9 {
                votes.note(&LASER, &scan(&[side]), &TdbvpTuning::DEFAULT);
            }
        }
        votes.preferred()
    }

    #[test]
    fn the_first_vote_sets_the_side_and_two_in_a_row_change_it() {
        use Side::{Left, Right};
        assert_eq!(preferred(&[]), None);
        assert_eq!(preferred(&[Left]), Some(Left));
        assert_eq!(preferred(&[Right]), Some(Right));
        assert_eq!(preferred(&[Left, Right]), Some(Left));
        assert_eq!(preferred(&[Left, Right, Right]), Some(Right));
        assert_eq!(preferred(&[Left, Left]), Some(Left));
        assert_eq!(preferred(&[Left, Left, Right]), Some(Left));
        assert_eq!(preferred(&[Left, Left, Right, Left]), Some(Left));
        assert_eq!(preferred(&[Left, Left, Right, Right]), Some(Right));
    }

    #[test]
    fn openings_to_both_sides_at_once_are_no_vote() {
        let mut votes = SideVotes::NEW;
        for _ in 0..4 {
            votes.note(&LASER, &scan(&[]), &TdbvpTuning::DEFAULT);
            votes.note(
                &LASER,
                &scan(&[Side::Left, Side::Right]),
                &TdbvpTuning::DEFAULT,
            );
        }
        assert_eq!((votes.last_vote, votes.preferred()), (None, None));
    }

    #[test]
    fn an_opening_votes_once_and_noise_does_not() {
        let mut votes = SideVotes::NEW;
        votes.vote(Side::Right);
        votes.note(&LASER, &scan(&[]), &TdbvpTuning::DEFAULT);
        for k in 0..50 {
            let ranges = scan(&[Side::Left]).map(|range| range.min(3_000) + k * 17 % 90);
            votes.note(&LASER, &ranges, &TdbvpTuning::DEFAULT);
        }
        assert_eq!(votes.last_vote, Some(Side::Left));
        let preferred = votes.preferred();
        assert_eq!(preferred, Some(Side::Right), "one long opening is one vote");
    }
}

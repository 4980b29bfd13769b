//! Goals that are worth a trip together, although none of them is worth it alone.
//!
//! ```text
//! Sᵢ = Gᵢ + Σⱼ max(0, Gⱼ − worth · dᵢⱼ)        worth together if Sᵢ ≥ worth · max(tᵢ, 1 m)
//! ```
//!
//! G is a goal's gain, t the length of the trip to it, and d the distance of two goals in a
//! straight line. So a goal's trip is paid by its own gain, and by what is worth a trip from there.
//! Without this rule the far end of a building is left, because each of its frontiers is small.
//!
//! Units: metres, square metres.

use heapless::Vec;

use crate::geometry::Cell;
use crate::path::candidates::Candidate;
use crate::path::goal_choice::MOST_JUDGED;
use crate::path::utility::{GoalOrder, utility};

/// A candidate that was judged.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Judged {
    pub(crate) candidate: Candidate,
    /// Its goal.
    pub(crate) cell: Cell,
    pub(crate) gain_m2: f32,
    /// Length of the trip to it.
    pub(crate) trip_m: f32,
}

/// The candidates of a round, and the present goal.
pub(crate) type AllJudged = Vec<Judged, { MOST_JUDGED + 1 }>;

/// Returns the goal that is best to begin with, of those that are worth their trip together with
/// others: that of the greatest S for its trip.
pub(crate) fn begin_of_trip(judged: &AllJudged, order: &GoalOrder<'_>) -> Option<Candidate> {
    let together = |one: &Judged| {
        let others = judged.iter().map(|other| {
            let hop_m = one.cell.distance_m(other.cell);
            (other.gain_m2 - order.worth * hop_m).max(0.0)
        });
        // The goal itself is at no distance.
        others.sum::<f32>()
    };
    let mut best: Option<(f32, Candidate)> = None;
    for one in judged {
        let sum_m2 = together(one);
        let score = utility(sum_m2, one.trip_m);
        if order.is_worth(sum_m2, one.trip_m) && best.is_none_or(|(most, _)| score > most) {
            best = Some((score, one.candidate));
        }
    }
    best.map(|(_, candidate)| candidate)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{Order, Tuning};
    use crate::grid::Site;

    const ORDER: GoalOrder<'_> = GoalOrder::new(Order::Gain { worth: 0.3 }, &Tuning::DEFAULT.order);

    /// Goals on a line, by metres from the robot, each with this gain.
    fn goals<const N: usize>(gain_m2: f32, at_m: [u16; N]) -> AllJudged {
        let judged = |x_m: u16| Judged {
            candidate: Candidate {
                site: Site { x: x_m * 5, y: 0 },
                steps: x_m * 5,
                cells: 1,
            },
            cell: Cell {
                x: i32::from(x_m) * 10,
                y: 0,
            },
            gain_m2,
            trip_m: f32::from(x_m),
        };
        at_m.into_iter().map(judged).collect()
    }

    fn begin<const N: usize>(gain_m2: f32, at_m: [u16; N]) -> Option<u16> {
        begin_of_trip(&goals(gain_m2, at_m), &ORDER).map(|candidate| candidate.site.x / 5)
    }

    #[test]
    fn far_goals_near_each_other_are_worth_a_trip_that_none_is_worth_alone() {
        assert_eq!(begin(4.0, [40]), None);
        assert_eq!(begin(4.0, [40, 42, 44, 46, 48, 50]), Some(44));
        assert_eq!(begin(4.0, [40, 52, 64, 76]), None, "far from each other");
    }

    #[test]
    fn the_sum_of_gains_decides_and_not_the_number_of_goals() {
        assert_eq!(begin(0.1, [20, 21, 22, 23, 24, 25, 26]), None);
        assert_eq!(begin(2.0, [20, 21, 22, 23, 24, 25, 26]), Some(22));
    }
}

//! Claims of the other robots on goals.
//!
//! A peer *claims* what it would see from the goal that it drives to: the goals within `gain_m` of
//! its own to which a peer has fewer steps than this robot. Only the gain of a claimed goal counts
//! less, so it is taken when nothing better is left.
//!
//! ```text
//! gain of a goal = claimed · G if a peer is nearer, and drives to a goal within gain_m of it
//!                  G           else
//! ```
//!
//! One wave from all peers at once finds their steps, before the robot's own wave. So of two robots
//! that drive to one goal the nearer one keeps it, and both know which. A peer that is silent,
//! stands by order, is stuck or has finished claims nothing.
//!
//! Units: coarse steps of 20 cm; sites of the skeleton's plane.

use heapless::Vec;

use crate::geometry::Cell;
use crate::grid::{Plane, Site};
use crate::path::PlanningContext;
use crate::path::residual_frontiers::is_near;
use crate::path::search::PathSearch;
use crate::team::peers::MOST_PEERS;

/// Maximum number of groups of frontier cells whose steps are kept. The peers are farther from the
/// others.
const MOST_GROUPS: usize = 64;
/// A frontier cell at most this far from a group's first along either axis belongs to it, coarse
/// cells.
const GROUP_CELLS: u16 = 5;

/// What the peers claim.
#[derive(Debug, Default)]
pub(crate) struct Claims {
    /// Groups of frontier cells, with the steps of the nearest peer to the group's first.
    groups: Vec<(Site, u16), MOST_GROUPS>,
    /// The goals that the peers drive to.
    goals: Vec<Cell, MOST_PEERS>,
}

impl Claims {
    /// Finds the claims; none without a peer that may move.
    #[inline(never)]
    pub(crate) fn find<const TILES: usize, const SLOTS: usize>(
        search: &mut PathSearch<'_, TILES, SLOTS>,
        context: &PlanningContext<'_, TILES, SLOTS>,
        frontier: Plane<'_>,
    ) -> Self {
        let mut claims = Self::default();
        let Some(team) = context.team.filter(|_| context.tuning.order.claimed < 1.0) else {
            return claims;
        };
        let mut entries: Vec<(Site, u32), MOST_PEERS> = Vec::new();
        for peer in team.rivals(context.time_ms) {
            let place = peer.pose(context.time_ms).point().cell();
            let Some(entry) = search.entry_near(place) else {
                continue;
            };
            // Both lists have room for all peers.
            let _ = entries.push(entry);
            if let Some(goal) = peer.beacon.goal_cell() {
                let _ = claims.goals.push(goal);
            }
        }
        if claims.goals.is_empty() {
            return claims;
        }
        search.spread_entering(&entries, frontier, |site, steps| {
            let is_in = |(first, _): &(Site, u16)| is_in_group(*first, site);
            if !claims.groups.iter().any(is_in) {
                let steps = u16::try_from(steps).unwrap_or(u16::MAX);
                // The farthest ones do not fit.
                let _ = claims.groups.push((site, steps));
            }
        });
        claims
    }

    /// Returns true if a goal that is `steps` away from this robot is claimed by a peer.
    pub(crate) fn hold(&self, site: Site, cell: Cell, steps: u16, gain_m: f32) -> bool {
        let is_beside = |goal: &Cell| is_near(*goal, cell, gain_m);
        let group = || {
            let mut groups = self.groups.iter();
            groups.find(|(first, _)| is_in_group(*first, site))
        };
        self.goals.iter().any(is_beside) && group().is_some_and(|(_, theirs)| *theirs < steps)
    }
}

fn is_in_group(first: Site, site: Site) -> bool {
    first.x.abs_diff(site.x) <= GROUP_CELLS && first.y.abs_diff(site.y) <= GROUP_CELLS
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn site(x: u16) -> Site {
        Site { x, y: 10 }
    }

    fn cell(x: i32) -> Cell {
        Cell { x, y: 20 }
    }

    /// A peer with 8 steps to the frontier at site 10, and 30 to that at site 40.
    fn claims(goal: Option<Cell>) -> Claims {
        Claims {
            groups: [(site(10), 8), (site(40), 30)].into_iter().collect(),
            goals: goal.into_iter().collect(),
        }
    }

    #[test]
    fn a_peer_holds_what_it_sees_from_its_goal_if_it_is_nearer() {
        let claims = claims(Some(cell(20)));
        assert!(claims.hold(site(10), cell(20), 9, 3.0));
        assert!(claims.hold(site(14), cell(28), 9, 3.0), "of the same group");
        assert!(!claims.hold(site(10), cell(20), 8, 3.0), "as near");
        assert!(!claims.hold(site(10), cell(20), 3, 3.0), "nearer");
        assert!(
            !claims.hold(site(40), cell(80), 99, 3.0),
            "far from its goal"
        );
        assert!(
            !claims.hold(site(20), cell(40), 99, 3.0),
            "not reached by it"
        );
    }

    #[test]
    fn a_peer_without_a_goal_holds_nothing() {
        assert!(!claims(None).hold(site(10), cell(20), 9, 3.0));
    }
}

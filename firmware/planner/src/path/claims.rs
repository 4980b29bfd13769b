//! Claims of the other robots on goals.
//!
//! A peer that drives to a goal *claims* every goal to which it has fewer steps than this robot:
//! its part of a Voronoi partition over the lengths of paths. Only the gain of a claimed goal
//! counts less, so it is taken when nothing better is left.
//!
//! ```text
//! gain of a goal = claimed · G if a peer is nearer
//!                  G           else
//! ```
//!
//! One wave from all peers at once finds their steps, before the robot's own wave. So of two robots
//! that drive to one goal the nearer one keeps it, and both know which. A peer that is silent,
//! stands by order, is stuck or has finished claims nothing.
//!
//! Measured: docs/MEASURED.md, "Goals that a peer claims".
//!
//! Units: coarse steps of 20 cm; sites of the skeleton's plane.

use core::ops::ControlFlow;

use heapless::Vec;

use crate::field::local_grid::SCALES;
use crate::geometry::Cell;
use crate::grid::{Plane, Site};
use crate::path::PlanningContext;
use crate::path::search::PathSearch;
use crate::team::peers::MOST_PEERS;

/// Maximum number of groups of frontier cells whose steps are kept. The peers are farther from the
/// others.
const MOST_GROUPS: usize = 64;
/// Most windows that are read around the peers in a round, counted in windows of the smallest
/// scale. A peer that stands far from every centre cell takes 21. It bounds the time.
const MOST_READ: i32 = 32;
/// A frontier cell at most this far from a group's first along either axis belongs to it, coarse
/// cells.
const GROUP_CELLS: u16 = 5;

/// What the peers claim.
#[derive(Debug, Default)]
pub(crate) struct Claims {
    /// Groups of frontier cells, with the steps of the nearest peer to the group's first.
    groups: Vec<(Site, u16), MOST_GROUPS>,
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
        let now_ms = context.time_ms;
        let rivals = team.rivals(now_ms);
        let mut left = MOST_READ;
        let entries: Vec<(Site, u32), MOST_PEERS> = rivals
            .filter(|peer| peer.beacon.goal_cell().is_some())
            .filter_map(|peer| {
                let place = peer.pose(now_ms).point().cell();
                entry_of(search, place, &mut left)
            })
            .take(MOST_PEERS)
            .collect();
        if entries.is_empty() {
            return claims;
        }
        search.spread_entering(&entries, frontier, |site, steps| {
            let is_in = |(first, _): &(Site, u16)| is_in_group(*first, site);
            if claims.groups.iter().any(is_in) {
                return ControlFlow::Continue(());
            }
            let steps = u16::try_from(steps).unwrap_or(u16::MAX);
            // The farthest ones do not fit.
            match claims.groups.push((site, steps)) {
                Ok(()) => ControlFlow::Continue(()),
                Err(_) => ControlFlow::Break(()),
            }
        });
        claims
    }

    /// Returns true if a goal that is `steps` away from this robot is claimed by a peer.
    pub(crate) fn hold(&self, site: Site, steps: u16) -> bool {
        let mut groups = self.groups.iter();
        groups
            .find(|(first, _)| is_in_group(*first, site))
            .is_some_and(|(_, theirs)| *theirs < steps)
    }
}

/// Returns the centre cell nearest to a peer, and the coarse steps there; `None` if the grids that
/// are left to read hold none.
fn entry_of<const TILES: usize, const SLOTS: usize>(
    search: &mut PathSearch<'_, TILES, SLOTS>,
    place: Cell,
    left: &mut i32,
) -> Option<(Site, u32)> {
    SCALES.iter().find_map(|&scale| {
        *left = left.checked_sub(scale * scale).filter(|&left| left >= 0)?;
        search.entry_at_scale(place, scale)
    })
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

    #[test]
    fn a_peer_holds_the_goals_that_it_is_nearer_to() {
        // The peer has 8 steps to the frontier at site 10, and 30 to that at site 40.
        let claims = Claims {
            groups: [(site(10), 8), (site(40), 30)].into_iter().collect(),
        };
        assert!(claims.hold(site(10), 9));
        assert!(claims.hold(site(14), 9), "of the same group");
        assert!(!claims.hold(site(10), 8), "as near");
        assert!(!claims.hold(site(40), 20), "nearer");
        assert!(!claims.hold(site(20), 99), "not reached by the peer");
    }
}

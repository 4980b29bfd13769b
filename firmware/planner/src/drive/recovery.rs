//! Recovery out of a narrow place: a search over short motions, forwards, backwards, curved and on
//! the spot.
//!
//! In a passage narrower than its diagonal the robot cannot turn everywhere, and following the
//! field alone wedges it. The search (A* over poses, similar to hybrid A*) starts at the robot's
//! pose. It ends at a pose from which the robot can follow the field for its own length
//! ([`crate::drive::roll_out`]): with room to turn to the field's heading *there*, or, at a higher
//! cost, with its back along it. The end must be farther along the field than the start; otherwise
//! the robot oscillates before a tight corner. Of the poses in the same cell of 3 cm × 3 cm × 7.5°
//! only the first counts. Roll-outs end where an earlier one went through before it touched
//! ([`crate::drive::dead_ends`]). The search runs in instalments while the robot stands, so every
//! step is short.
//!
//! Invariant: every pose of a recovery keeps the margin.
//!
//! Units: metres, radians; robot frame at the start.

use crate::drive::dead_ends::{self, DeadEnds};
use crate::drive::hull::Place;
use crate::drive::motion::{DIRECTIONS, MOTIONS, MotionSet, Recovery, TURN_RAD, cell_of};
use crate::drive::open_list::{self, Node, OpenList};
use crate::drive::roll_out::RollOut;
use crate::drive::search_query::SearchQuery;

/// Cost of an end against the field, in motions.
const REVERSE_COST: f32 = 12.0;
/// Cells to each side of the start within which poses count.
const REACH: i32 = 22;
const SIDE: usize = 2 * REACH as usize + 1;
const VISITED_WORDS: usize = (SIDE * SIDE * DIRECTIONS as usize).div_ceil(32);

/// Words of scratch memory that a search needs.
pub const SCRATCH_WORDS: usize = VISITED_WORDS + dead_ends::WORDS + open_list::WORDS;

/// The result of an instalment of a search.
#[derive(Clone, Debug)]
pub(super) enum SearchOutcome {
    /// A recovery.
    Found(Recovery),
    /// None yet; the next instalment continues.
    Pending,
    /// There is none within reach.
    Nothing,
}

/// A search in progress; its poses are in the scratch memory.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Search {
    open: OpenList,
    /// Clearance of its poses, metres.
    pub(super) margin_m: f32,
    /// The motions with which it may begin.
    pub(super) first: MotionSet,
}

/// Limits of an instalment; it ends with the pose that reaches either.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct SearchBudget {
    /// Poses taken from the open list.
    pub(super) poses: u32,
    /// Obstacle points, counted once for each pose checked against all of them.
    pub(super) points: u32,
}

impl Search {
    /// Begins at the robot's pose, with one of the motions `first`: those that the robot can start
    /// with from its present velocity.
    pub(super) fn start(margin_m: f32, first: MotionSet, scratch: &mut [u32]) -> Self {
        let mut search = Self {
            open: OpenList::default(),
            margin_m,
            first,
        };
        if let Some((visited, failed, nodes)) = split(scratch) {
            visited.fill(0);
            DeadEnds(failed).clear();
            visit(visited, Place::default());
            search.open.push(nodes, Node::start());
        }
        search
    }

    /// Runs one instalment.
    pub(super) fn advance<H: Fn(Place) -> Option<f32>>(
        &mut self,
        query: &SearchQuery<'_, H>,
        budget: SearchBudget,
        scratch: &mut [u32],
    ) -> SearchOutcome {
        let Some((visited, failed, nodes)) = split(scratch) else {
            return SearchOutcome::Nothing;
        };
        let (mut dead_ends, margin_m) = (DeadEnds(failed), self.margin_m);
        let mut points = 0;
        for _ in 0..budget.poses {
            if points >= budget.points {
                break;
            }
            let Some((index, node)) = self.open.pop(nodes) else {
                return SearchOutcome::Nothing;
            };
            if node.is_end {
                // It led on before; since then its places may have become dead ends of others.
                dead_ends.clear();
                let on = query.leads_on(node.place, true, margin_m, &mut points, &mut dead_ends);
                let on = on.unwrap_or_default();
                return SearchOutcome::Found(self.trace(nodes, index, &on));
            }
            let may_begin = |on: &RollOut| index != 0 || self.may_begin(on);
            let on = query.leads_on(node.place, false, margin_m, &mut points, &mut dead_ends);
            if let Some(on) = on.filter(may_begin) {
                return SearchOutcome::Found(self.trace(nodes, index, &on));
            }
            let on = query.leads_on(node.place, true, margin_m, &mut points, &mut dead_ends);
            if on.is_some_and(|on| may_begin(&on)) {
                let cost = node.cost + REVERSE_COST;
                self.open.push(
                    nodes,
                    Node {
                        rank: cost,
                        parent: index,
                        is_end: true,
                        ..node
                    },
                );
            }
            let Some(tried) = self.expand(query, (index, node), visited, nodes) else {
                return SearchOutcome::Nothing;
            };
            points += tried * query.checker.points();
        }
        SearchOutcome::Pending
    }

    /// Returns true if the robot can start with a roll-out from its present velocity.
    fn may_begin(&self, on: &RollOut) -> bool {
        on.first()
            .is_some_and(|&first| self.first.has(usize::from(first)))
    }

    /// Adds the poses one motion away. Returns how many places were
    /// checked, or `None` if the open list is
    /// full.
    fn expand<H: Fn(Place) -> Option<f32>>(
        &mut self,
        query: &SearchQuery<'_, H>,
        (index, node): (u16, Node),
        visited: &mut [u32],
        nodes: &mut [u32],
    ) -> Option<u32> {
        let mut tried = 0;
        for (number, motion) in MOTIONS.iter().enumerate() {
            if index == 0 && !self.first.has(number) {
                continue;
            }
            let place = node.place.after(motion.length_m, motion.turn_rad);
            if !visit(visited, place) {
                continue;
            }
            let (length_m, turn_rad, checker) = (motion.length_m, motion.turn_rad, query.checker);
            tried += checker.places_on(length_m, turn_rad, self.margin_m);
            if !checker.is_arc_clear(node.place, length_m, turn_rad, self.margin_m) {
                continue;
            }
            let cost = node.cost + motion.cost;
            let estimate = query
                .misalignment(place)
                .map_or(0.0, |error| error.abs() / TURN_RAD);
            let next = Node {
                place,
                cost,
                rank: cost + estimate,
                parent: index,
                motion: number as u8,
                is_end: false,
            };
            if !self.open.push(nodes, next) {
                return None;
            }
        }
        Some(tried)
    }

    /// Returns the motions from the start to a node and those after it, the first one last; of a
    /// recovery that is too long, its beginning.
    fn trace(&self, nodes: &[u32], end: u16, on: &[u8]) -> Recovery {
        let mut recovery = Recovery::new();
        for &number in on.iter().rev() {
            // A new recovery has room.
            let _ = recovery.motions.push(number);
        }
        let mut index = end;
        while let Some(node) = self.open.node(nodes, index).filter(|_| index != 0) {
            if !node.is_end {
                if recovery.motions.is_full() {
                    recovery.motions.remove(0);
                }
                // There is room now.
                let _ = recovery.motions.push(node.motion);
            }
            index = node.parent;
        }
        recovery
    }
}

/// Returns the memory of the visited cells, of the dead ends and of the open list.
fn split(scratch: &mut [u32]) -> Option<(&mut [u32], &mut [u32], &mut [u32])> {
    let (visited, rest) = scratch.split_at_mut_checked(VISITED_WORDS)?;
    let (failed, nodes) = rest.split_at_mut_checked(dead_ends::WORDS)?;
    Some((visited, failed, nodes))
}

/// Marks the cell of a pose. Returns false if it was marked already or is out of reach.
fn visit(visited: &mut [u32], place: Place) -> bool {
    let [x, y, direction] = cell_of(place);
    if x.abs() > REACH || y.abs() > REACH {
        return false;
    }
    let cell = (y + REACH) as usize * SIDE + (x + REACH) as usize;
    let index = cell * DIRECTIONS as usize + direction as usize;
    let Some(word) = visited.get_mut(index / 32) else {
        return false;
    };
    let fresh = *word >> (index % 32) & 1 == 0;
    *word |= 1 << (index % 32);
    fresh
}

#[cfg(test)]
mod tests;

//! A manoeuvre out of a narrow place: a search over short motions, forwards, backwards, curved and on the spot.
//!
//! In a passage narrower than the robot's diagonal it cannot turn everywhere, and following the field alone wedges it. The
//! search (A* over poses, in the manner of hybrid A*) starts where the robot stands and ends at a pose from which the field
//! can be followed: aligned with the field's heading *there*, with `GO_ON_M` free ahead; or, dearer, aligned against it
//! with as much free behind. The end must also be farther along the field than the start, or the robot would go to and fro
//! before a tight corner. Poses are kept exactly; of those that fall into the same cell of 3 cm × 3 cm × 7.5° only the
//! first is. It works in instalments while the robot stands, so no step takes long.
//!
//! Invariant: every pose on the way keeps the margin. Units: metres, radians; robot frame at the start.

use crate::drive::collision::Place;
use crate::drive::motion::{BACKWARD, FORWARD, LENGTH_M, MOTIONS, TURN_RAD};
pub use crate::drive::motion::{Choice, MOST_MOTIONS, Plan};
use crate::drive::open_list::{Node, Open};
pub use crate::drive::search_query::{Attempt, Ground, Leads};
use crate::math;

/// Straight motions at the end, so that every manoeuvre leads somewhere.
const GO_ON_MOTIONS: u8 = 8;
/// What must be free ahead for them, metres.
const GO_ON_M: f32 = GO_ON_MOTIONS as f32 * LENGTH_M;
/// What it costs to end against the field, motions.
const REVERSE_COST: f32 = 12.0;
/// Cells to each side of the start, and directions, that a pose may fall into.
const REACH: i32 = 18;
const SIDE: usize = 2 * REACH as usize + 1;
const DIRECTIONS: usize = 48;
const VISITED_WORDS: usize = (SIDE * SIDE * DIRECTIONS).div_ceil(32);

/// Words of scratch that a search needs.
pub const SCRATCH_WORDS: usize = VISITED_WORDS + super::open_list::WORDS;

/// How far a search came.
#[derive(Clone, Debug)]
pub enum Found {
    /// A way out.
    Plan(Plan),
    /// Not yet; go on with the next instalment.
    Pending,
    /// There is none within reach.
    Nothing,
}

/// A search in progress; its poses are in the scratch that it was started with.
#[derive(Clone, Copy, Debug, Default)]
pub struct Search {
    open: Open,
    attempt: Attempt,
    first: Choice,
}

/// What an instalment of a search may look at; it ends with the pose that uses up either.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    /// Poses taken from the open list.
    pub poses: u32,
    /// Near points, counted anew for each pose that is tried against all of them.
    pub points: u32,
}

impl Search {
    /// Begin where the robot stands, with one of the motions `first`: those that it can really set out with, braking and all.
    pub fn start(attempt: Attempt, first: Choice, scratch: &mut [u32]) -> Self {
        let mut search = Self {
            open: Open::default(),
            attempt,
            first,
        };
        if let Some((visited, nodes)) = scratch.split_at_mut_checked(VISITED_WORDS) {
            visited.fill(0);
            visit(visited, Place::default());
            search.open.push(nodes, Node::start());
        }
        search
    }

    /// What is asked.
    #[must_use]
    pub const fn attempt(&self) -> Attempt {
        self.attempt
    }

    /// What it may set out with.
    #[must_use]
    pub const fn first(&self) -> Choice {
        self.first
    }

    /// Look at more poses.
    pub fn advance<H: Fn(Place) -> Option<f32>>(
        &mut self,
        ground: &Ground<'_, H>,
        budget: Budget,
        scratch: &mut [u32],
    ) -> Found {
        let Some((visited, nodes)) = scratch.split_at_mut_checked(VISITED_WORDS) else {
            return Found::Nothing;
        };
        let mut points = 0;
        for _ in 0..budget.poses {
            if points >= budget.points {
                break;
            }
            let Some((index, node)) = self.open.pop(nodes) else {
                return Found::Nothing;
            };
            if node.is_end {
                return Found::Plan(self.trace(nodes, index, BACKWARD));
            }
            if ground.leads_on(node.place, GO_ON_M, self.attempt, &mut points) {
                return Found::Plan(self.trace(nodes, index, FORWARD));
            }
            if ground.leads_on(node.place, -GO_ON_M, self.attempt, &mut points) {
                let cost = node.cost + REVERSE_COST;
                self.open.push(
                    nodes,
                    Node {
                        rank: cost,
                        is_end: true,
                        ..node
                    },
                );
            }
            let Some(tried) = self.expand(ground, (index, node), visited, nodes) else {
                return Found::Nothing;
            };
            points += tried * ground.surround.points();
        }
        Found::Pending
    }

    /// Enter the poses one motion away; how many were tried, or `None` when there is no room for more.
    fn expand<H: Fn(Place) -> Option<f32>>(
        &mut self,
        ground: &Ground<'_, H>,
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
            tried += 1;
            if !ground.surround.is_clear(place, self.attempt.margin_m) {
                continue;
            }
            let cost = node.cost + motion.cost;
            let hope = ground
                .misalignment(place)
                .map_or(0.0, |error| error.abs() / TURN_RAD);
            let next = Node {
                place,
                cost,
                rank: cost + hope,
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

    /// The motions from the start to a node and on from there, the first one last; of a way too long, its beginning.
    fn trace(&self, nodes: &[u32], end: u16, go_on: u8) -> Plan {
        let mut plan = Plan::new();
        for _ in 0..GO_ON_MOTIONS {
            // A new plan has room.
            let _ = plan.motions.push(go_on);
        }
        let mut index = end;
        while let Some(node) = self.open.node(nodes, index).filter(|_| index != 0) {
            if !node.is_end {
                if plan.motions.is_full() {
                    plan.motions.remove(0);
                }
                // There is room now.
                let _ = plan.motions.push(node.motion);
            }
            index = node.parent;
        }
        plan
    }
}

/// Mark the cell of a pose; false if it was marked, or is out of reach.
fn visit(visited: &mut [u32], place: Place) -> bool {
    let cell = |at: f32| math::floor(at / LENGTH_M + 0.5);
    let (x, y) = (cell(place.x_m), cell(place.y_m));
    if x.abs() > REACH || y.abs() > REACH {
        return false;
    }
    let direction = math::floor(place.yaw_rad / TURN_RAD + 0.5).rem_euclid(DIRECTIONS as i32);
    let cell = (y + REACH) as usize * SIDE + (x + REACH) as usize;
    let index = cell * DIRECTIONS + direction as usize;
    let Some(word) = visited.get_mut(index / 32) else {
        return false;
    };
    let fresh = *word >> (index % 32) & 1 == 0;
    *word |= 1 << (index % 32);
    fresh
}

#[cfg(test)]
mod tests;

//! A manoeuvre out of a narrow place: a search over short motions, forwards, backwards, curved and on the spot.
//!
//! In a passage narrower than the robot's diagonal it cannot turn everywhere, and following the field alone wedges it. The
//! search (A* over poses, in the manner of hybrid A*) starts where the robot stands and ends at a pose from which the field
//! can be followed: aligned with the field's heading *there*, with [`GO_ON_M`] free ahead. Poses are kept exactly; of those
//! that fall into the same cell of 3 cm × 3 cm × 7.5° only the first is.
//!
//! Invariant: every pose on the way keeps the margin. Units: metres, radians; robot frame at the start.

use heapless::Vec;

use super::surround::{Place, Surround};
use crate::geometry::Twist;
use crate::math;

/// Motions of a plan at the most.
pub const MOST_MOTIONS: usize = 64;
/// Periods that a motion takes.
const PERIODS: u8 = 2;
/// Poses looked at in a search.
const MOST_NODES: usize = 1000;
/// Length of a straight or curved motion, metres.
const LENGTH_M: f32 = 0.03;
/// Turn of a motion on the spot, radians: 7.5°.
const TURN_RAD: f32 = math::PI / 24.0;
/// Turn of a curved motion, radians.
const CURVE_RAD: f32 = 0.1;
/// What must be free ahead at the end, metres.
const GO_ON_M: f32 = 0.25;
/// Alignment with the field at the end, radians.
const ALIGNED_RAD: f32 = 0.2;
/// Cells to each side of the start, and directions, that a pose may fall into.
const REACH: i32 = 15;
const SIDE: usize = 2 * REACH as usize + 1;
const DIRECTIONS: usize = 48;
const VISITED_WORDS: usize = (SIDE * SIDE * DIRECTIONS).div_ceil(32);
const NODE_WORDS: usize = 6;

/// Words of scratch that a search needs.
pub const SCRATCH_WORDS: usize = VISITED_WORDS + MOST_NODES * NODE_WORDS;

/// A short motion: its length and its turn.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Motion {
    length_m: f32,
    turn_rad: f32,
    /// What it costs; driving backwards is blind.
    cost: f32,
}

const fn motion(length_m: f32, turn_rad: f32, cost: f32) -> Motion {
    Motion {
        length_m,
        turn_rad,
        cost,
    }
}

const MOTIONS: [Motion; 8] = [
    motion(0.0, TURN_RAD, 1.0),
    motion(0.0, -TURN_RAD, 1.0),
    motion(LENGTH_M, 0.0, 1.0),
    motion(LENGTH_M, CURVE_RAD, 1.2),
    motion(LENGTH_M, -CURVE_RAD, 1.2),
    motion(-LENGTH_M, 0.0, 1.3),
    motion(-LENGTH_M, CURVE_RAD, 1.5),
    motion(-LENGTH_M, -CURVE_RAD, 1.5),
];

/// A manoeuvre in progress: motions by number, the next one last.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    motions: Vec<u8, MOST_MOTIONS>,
    /// Periods that the present motion still takes.
    periods: u8,
}

impl Plan {
    /// No manoeuvre.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            motions: Vec::new(),
            periods: 0,
        }
    }

    /// Forget it.
    pub fn clear(&mut self) {
        *self = Self::new();
    }

    /// The velocity of the next period, if the manoeuvre goes on.
    pub fn next(&mut self, period_s: f32) -> Option<Twist> {
        let motion = MOTIONS.get(usize::from(*self.motions.last()?))?;
        let seconds = f32::from(PERIODS) * period_s;
        self.periods += 1;
        if self.periods >= PERIODS {
            self.periods = 0;
            self.motions.pop();
        }
        Some(Twist {
            linear_mps: motion.length_m / seconds,
            angular_radps: motion.turn_rad / seconds,
        })
    }
}

/// A pose of the search.
#[derive(Clone, Copy, Debug)]
struct Node {
    place: Place,
    cost: f32,
    /// Cost so far and what is hoped to remain; infinite once looked at.
    rank: f32,
    /// Where it was reached from, and by which motion.
    parent: u16,
    motion: u8,
}

/// The poses found so far, in lent words.
struct Nodes<'a> {
    words: &'a mut [[u32; NODE_WORDS]],
    count: usize,
}

impl Nodes<'_> {
    fn push(&mut self, node: Node) -> bool {
        let Some(words) = self.words.get_mut(self.count) else {
            return false;
        };
        *words = [
            node.place.x_m.to_bits(),
            node.place.y_m.to_bits(),
            node.place.yaw_rad.to_bits(),
            node.cost.to_bits(),
            node.rank.to_bits(),
            u32::from(node.parent) << 8 | u32::from(node.motion),
        ];
        self.count += 1;
        true
    }

    fn get(&self, index: usize) -> Option<Node> {
        let &[x, y, yaw, cost, rank, link] = self.words.get(index)?;
        Some(Node {
            place: Place {
                x_m: f32::from_bits(x),
                y_m: f32::from_bits(y),
                yaw_rad: f32::from_bits(yaw),
            },
            cost: f32::from_bits(cost),
            rank: f32::from_bits(rank),
            parent: (link >> 8) as u16,
            motion: link as u8,
        })
    }

    /// The node of least rank, which is then closed.
    fn pop(&mut self) -> Option<(usize, Node)> {
        let open = self.words.get_mut(..self.count)?;
        let mut best = (0, f32::INFINITY);
        for (index, words) in open.iter().enumerate() {
            let rank = f32::from_bits(words[4]);
            if rank < best.1 {
                best = (index, rank);
            }
        }
        if best.1 == f32::INFINITY {
            return None;
        }
        let node = self.get(best.0)?;
        self.words.get_mut(best.0)?[4] = f32::INFINITY.to_bits();
        Some((best.0, node))
    }
}

/// Mark the cell of a pose; false if it was marked, or is out of reach.
fn visit(visited: &mut [u32], place: Place) -> bool {
    let cell = |at: f32| math::floor(at / LENGTH_M + 0.5);
    let (x, y) = (cell(place.x_m), cell(place.y_m));
    if x.abs() > REACH || y.abs() > REACH {
        return false;
    }
    let direction =
        math::floor(place.yaw_rad / TURN_RAD + 0.5).rem_euclid(DIRECTIONS as i32) as usize;
    let index = ((y + REACH) as usize * SIDE + (x + REACH) as usize) * DIRECTIONS + direction;
    let Some(word) = visited.get_mut(index / 32) else {
        return false;
    };
    let fresh = *word >> (index % 32) & 1 == 0;
    *word |= 1 << (index % 32);
    fresh
}

/// The cheapest manoeuvre to a pose from which the field can be followed; `heading_at` gives the field's heading at a place,
/// radians left of the robot's present one, or `None` where the field says nothing.
pub fn search(
    surround: &Surround,
    heading_at: impl Fn(Place) -> Option<f32>,
    margin_m: f32,
    scratch: &mut [u32],
) -> Option<Plan> {
    let (visited, nodes) = scratch.split_at_mut_checked(VISITED_WORDS)?;
    visited.fill(0);
    let (words, _) = nodes.as_chunks_mut::<NODE_WORDS>();
    let mut nodes = Nodes {
        words: words.get_mut(..MOST_NODES)?,
        count: 0,
    };
    let start = Place::default();
    visit(visited, start);
    nodes.push(Node {
        place: start,
        cost: 0.0,
        rank: 0.0,
        parent: 0,
        motion: 0,
    });
    while let Some((index, node)) = nodes.pop() {
        let error = misalignment(&heading_at, node.place);
        let aligned = error.is_some_and(|error| error.abs() < ALIGNED_RAD);
        if aligned && surround.is_arc_clear(node.place, GO_ON_M, 0.0, margin_m) {
            return Some(trace(&nodes, index));
        }
        for (number, motion) in MOTIONS.iter().enumerate() {
            let place = node.place.after(motion.length_m, motion.turn_rad);
            if !visit(visited, place) || !surround.is_clear(place, margin_m) {
                continue;
            }
            let cost = node.cost + motion.cost;
            let hope = misalignment(&heading_at, place).map_or(0.0, |error| error.abs() / TURN_RAD);
            let next = Node {
                place,
                cost,
                rank: cost + hope,
                parent: index as u16,
                motion: number as u8,
            };
            if !nodes.push(next) {
                return None;
            }
        }
    }
    None
}

fn misalignment(heading_at: &impl Fn(Place) -> Option<f32>, place: Place) -> Option<f32> {
    heading_at(place).map(|heading| math::wrap(heading - place.yaw_rad))
}

/// The motions from the start to a node, the first one last; of a way too long, its beginning.
fn trace(nodes: &Nodes<'_>, end: usize) -> Plan {
    let mut plan = Plan::new();
    let mut index = end;
    while let Some(node) = nodes.get(index).filter(|_| index != 0) {
        if plan.motions.is_full() {
            plan.motions.remove(0);
        }
        // There is room now.
        let _ = plan.motions.push(node.motion);
        index = usize::from(node.parent);
    }
    plan
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point, Pose};

    /// Points of walls given as segments, 2 cm apart.
    fn walls(segments: &[[f32; 4]]) -> std::vec::Vec<Point> {
        let mut points = std::vec::Vec::new();
        for &[x0, y0, x1, y1] in segments {
            let n = (((x1 - x0).abs() + (y1 - y0).abs()) / 0.04) as i32 + 1;
            for k in 0..=n {
                let t = k as f32 / n as f32;
                points.push(Point {
                    x_m: x0 + (x1 - x0) * t,
                    y_m: y0 + (y1 - y0) * t,
                });
            }
        }
        points
    }

    fn drive_out(points: &[Point], pose: Pose, heading: f32) -> (usize, Pose) {
        let mut scratch = [0; SCRATCH_WORDS];
        let surround = Surround::new(&pose, points);
        let plan = search(
            &surround,
            |_| Some(heading - pose.yaw_rad),
            0.02,
            &mut scratch,
        );
        let mut plan = plan.expect("a way out");
        let (mut place, mut motions) = (Place::default(), 0);
        while let Some(twist) = plan.next(0.2) {
            place = place.after(twist.linear_mps * 0.2, twist.angular_radps * 0.2);
            assert!(surround.is_clear(place, 0.01), "touches at {place:?}");
            motions += 1;
        }
        (
            motions,
            Pose {
                yaw_rad: pose.yaw_rad + place.yaw_rad,
                ..pose
            },
        )
    }

    /// In a corridor of 0.66 m with a wider place 0.3 m back, the robot has to back up to turn about.
    #[test]
    fn it_backs_into_the_wider_place_to_turn_about() {
        let corridor = walls(&[
            [-0.2, 0.33, 1.0, 0.33],
            [-0.2, -0.33, 1.0, -0.33],
            [-0.2, 0.33, -0.2, 0.6],
            [-0.2, -0.33, -0.2, -0.6],
            [1.0, -0.33, 1.0, 0.33],
        ]);
        let (motions, end) = drive_out(
            &corridor,
            Pose {
                x_m: 0.25,
                ..Pose::default()
            },
            math::PI,
        );
        assert!(math::wrap(end.yaw_rad - math::PI).abs() < 0.25);
        assert!(motions > 24, "a half turn alone takes 48 periods");
    }

    /// Wedged at a slant in an L of 0.72 m: it gets round the corner.
    #[test]
    fn it_gets_round_a_tight_corner_from_a_slant() {
        let corner = walls(&[
            [-0.36, -0.36, 1.2, -0.36],
            [-0.36, -0.36, -0.36, 1.2],
            [0.36, 0.36, 1.2, 0.36],
            [0.36, 0.36, 0.36, 1.2],
        ]);
        let slant = Pose {
            yaw_rad: math::PI - 0.3,
            ..Pose::default()
        };
        let (_, end) = drive_out(&corner, slant, math::PI / 2.0);
        assert!(math::wrap(end.yaw_rad - math::PI / 2.0).abs() < 0.25);
    }

    #[test]
    fn a_box_has_no_way_out() {
        let closed = walls(&[
            [-0.3, -0.3, 0.3, -0.3],
            [-0.3, 0.3, 0.3, 0.3],
            [-0.3, -0.3, -0.3, 0.3],
            [0.3, -0.3, 0.3, 0.3],
        ]);
        let mut scratch = [0; SCRATCH_WORDS];
        let surround = Surround::new(&Pose::default(), &closed);
        assert!(search(&surround, |_| Some(0.0), 0.02, &mut scratch).is_none());
    }
}

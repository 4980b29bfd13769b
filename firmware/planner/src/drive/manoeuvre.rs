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

use heapless::Vec;

use super::open::{Node, Open};
use super::surround::{Place, Surround};
use crate::geometry::Twist;
use crate::math;

/// Motions of a plan at the most; of a longer way the beginning is driven.
pub const MOST_MOTIONS: usize = 64;
/// Periods that a motion takes.
const PERIODS: u8 = 2;
/// Length of a straight or curved motion, metres.
const LENGTH_M: f32 = 0.03;
/// Turn of a motion on the spot, radians: 7.5°.
const TURN_RAD: f32 = math::PI / 24.0;
/// Turn of a curved motion, radians.
const CURVE_RAD: f32 = 0.1;
/// Straight motions at the end, so that every manoeuvre leads somewhere.
const GO_ON_MOTIONS: u8 = 8;
/// What must be free ahead for them, metres.
const GO_ON_M: f32 = GO_ON_MOTIONS as f32 * LENGTH_M;
/// Alignment with the field at the end, radians.
const ALIGNED_RAD: f32 = 0.2;
/// What it costs to end against the field, motions.
const REVERSE_COST: f32 = 12.0;
/// Cells to each side of the start, and directions, that a pose may fall into.
const REACH: i32 = 18;
const SIDE: usize = 2 * REACH as usize + 1;
const DIRECTIONS: usize = 48;
const VISITED_WORDS: usize = (SIDE * SIDE * DIRECTIONS).div_ceil(32);

/// Words of scratch that a search needs.
pub const SCRATCH_WORDS: usize = VISITED_WORDS + super::open::WORDS;

/// A short motion: its length, its turn and what it costs; driving backwards is blind.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Motion {
    length_m: f32,
    turn_rad: f32,
    cost: f32,
}

const fn motion(length_m: f32, turn_rad: f32, cost: f32) -> Motion {
    Motion {
        length_m,
        turn_rad,
        cost,
    }
}

impl Motion {
    fn velocity(self, period_s: f32) -> Twist {
        let seconds = f32::from(PERIODS) * period_s;
        Twist {
            linear_mps: self.length_m / seconds,
            angular_radps: self.turn_rad / seconds,
        }
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

/// The straight ones, by number.
const FORWARD: u8 = 2;
const BACKWARD: u8 = 5;

/// A set of motions, a bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Choice(u8);

impl Choice {
    /// The motions whose velocity, driven for `period_s` and more, is admitted.
    pub fn of(period_s: f32, admits: impl Fn(Twist) -> bool) -> Self {
        let bit = |(number, motion): (usize, &Motion)| {
            u8::from(admits(motion.velocity(period_s))) << number
        };
        Self(
            MOTIONS
                .iter()
                .enumerate()
                .map(bit)
                .fold(0, |set, bit| set | bit),
        )
    }

    /// Every motion.
    pub const ALL: Self = Self(u8::MAX);

    const fn has(self, number: usize) -> bool {
        self.0 >> number & 1 == 1
    }
}

/// A manoeuvre in progress: motions by number, the next one last.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    motions: Vec<u8, MOST_MOTIONS>,
    /// Periods of the present motion already driven.
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

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.motions.is_empty()
    }

    /// Forget it.
    pub fn clear(&mut self) {
        *self = Self::new();
    }

    /// The velocity of the next period, if the manoeuvre goes on.
    pub fn next(&mut self, period_s: f32) -> Option<Twist> {
        let motion = MOTIONS.get(usize::from(*self.motions.last()?))?;
        self.periods += 1;
        if self.periods >= PERIODS {
            self.periods = 0;
            self.motions.pop();
        }
        Some(motion.velocity(period_s))
    }
}

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

/// What a search asks of a way out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Attempt {
    /// The clearance kept, metres.
    pub margin_m: f32,
    /// Where it must lead.
    pub leads: Leads,
}

/// Where a way out must lead. No value is zero: so an idle drive is all zeros, and takes no place in the image's flash.
#[repr(u8)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Leads {
    /// Elsewhere.
    #[default]
    Elsewhere = 1,
    /// Farther along the field.
    Farther = 2,
}

/// What a search runs on: what stands around, and the field's heading at a place, radians left of the robot's present one, or
/// `None` where the field says nothing.
#[expect(missing_debug_implementations, reason = "it lends closures")]
pub struct Ground<'a, H> {
    /// What stands around.
    pub surround: &'a Surround,
    /// The field's heading.
    pub heading_at: H,
    /// How far along the field a place is (q of its cell); `None` where that is not asked for.
    pub potential_at: Option<&'a dyn Fn(Place) -> f32>,
}

/// By this factor q must grow from the start to the end of a manoeuvre. In a passage of the robot's width it doubles in 0.1 m.
const PROGRESS: f32 = 1.3;

impl<H: Fn(Place) -> Option<f32>> Ground<'_, H> {
    fn misalignment(&self, place: Place) -> Option<f32> {
        (self.heading_at)(place).map(|heading| math::wrap(heading - place.yaw_rad))
    }

    /// Whether a place is farther along the field than the robot.
    fn is_progress(&self, place: Place) -> bool {
        self.potential_at
            .is_none_or(|q| q(place) > PROGRESS * q(Place::default()))
    }

    /// Whether the field asks for `length_m` straight on from here: forwards, or against the alignment backwards.
    fn asks_on(&self, place: Place, length_m: f32, attempt: Attempt) -> bool {
        let aligned = self.misalignment(place).is_some_and(|error| {
            let error = if length_m < 0.0 {
                math::wrap(error + math::PI)
            } else {
                error
            };
            error.abs() < ALIGNED_RAD
        });
        aligned
            && (attempt.leads == Leads::Elsewhere || self.is_progress(place.after(length_m, 0.0)))
    }

    /// Whether that can be followed. Looking costs as many points as there are, for each place on the way.
    fn leads_on(&self, place: Place, length_m: f32, attempt: Attempt, points: &mut u32) -> bool {
        if !self.asks_on(place, length_m, attempt) {
            return false;
        }
        *points += Surround::places_on(length_m) * self.surround.points();
        self.surround
            .is_arc_clear(place, length_m, 0.0, attempt.margin_m)
    }
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

    const BUDGET: Budget = Budget {
        poses: 100,
        points: 2_000,
    };

    fn search(points: &[Point], pose: Pose, heading: f32) -> Option<(Plan, Surround)> {
        let mut scratch = std::vec![0; SCRATCH_WORDS];
        let surround = Surround::new(&pose, points);
        let heading_at = |_: Place| Some(math::wrap(heading - pose.yaw_rad));
        let ground = Ground {
            surround: &surround,
            heading_at,
            potential_at: None,
        };
        let mut search = Search::start(
            Attempt {
                margin_m: 0.02,
                leads: Leads::Farther,
            },
            Choice::ALL,
            &mut scratch,
        );
        loop {
            match search.advance(&ground, BUDGET, &mut scratch) {
                Found::Plan(plan) => return Some((plan, surround)),
                Found::Pending => {}
                Found::Nothing => return None,
            }
        }
    }

    /// Drives a plan as far as it goes; the pose at its end and the periods it took.
    fn drive_out(points: &[Point], pose: Pose, heading: f32) -> (Place, usize) {
        let (mut plan, surround) = search(points, pose, heading).expect("a way out");
        let (mut place, mut periods) = (Place::default(), 0);
        while let Some(twist) = plan.next(0.2) {
            place = place.after(twist.linear_mps * 0.2, twist.angular_radps * 0.2);
            assert!(surround.is_clear(place, 0.01), "touches at {place:?}");
            periods += 1;
        }
        (place, periods)
    }

    /// In a dead end too narrow to turn in, with nothing wider within reach, the robot backs out.
    #[test]
    fn it_backs_out_of_a_dead_end() {
        let dead_end = walls(&[
            [-1.2, 0.32, 0.6, 0.32],
            [-1.2, -0.32, 0.6, -0.32],
            [0.6, 0.32, 0.6, -0.32],
        ]);
        let askew = Pose {
            yaw_rad: 0.1,
            ..Pose::default()
        };
        let (end, _) = drive_out(&dead_end, askew, math::PI);
        assert!(end.yaw_rad.abs() < 0.4 && end.x_m < -0.2, "{end:?}");
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
        let (end, _) = drive_out(&corner, slant, math::PI / 2.0);
        let yaw = slant.yaw_rad + end.yaw_rad;
        assert!(math::wrap(yaw - math::PI / 2.0).abs() < 0.25, "{yaw}");
    }

    #[test]
    fn in_the_open_it_just_turns() {
        let (end, periods) = drive_out(&[], Pose::default(), math::PI / 2.0);
        assert!(
            end.x_m.abs() < 0.05 && (end.y_m - GO_ON_M).abs() < 0.01,
            "{end:?}"
        );
        assert_eq!(
            periods,
            2 * (11 + 8),
            "82.5° are near enough, and on it goes"
        );
    }

    #[test]
    fn a_box_has_no_way_out() {
        let closed = walls(&[
            [-0.3, -0.3, 0.3, -0.3],
            [-0.3, 0.3, 0.3, 0.3],
            [-0.3, -0.3, -0.3, 0.3],
            [0.3, -0.3, 0.3, 0.3],
        ]);
        assert!(search(&closed, Pose::default(), 0.0).is_none());
    }
}

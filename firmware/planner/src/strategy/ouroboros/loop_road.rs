//! The loop road: the two ways from the robot to the tractor point [Jorge15, III-C, third step].
//!
//! The wave has gone out from the tractor point with the robot's surroundings as a blocker. Where it came to the robot by two
//! ways or more there is a loop: the path's *back* is what the shield will be built across, its *front* is where the robot
//! is to go. Neither is stored: each is the descent from its head, down the wave's distances.
//!
//! - Fresh ([`LoopRoad`]): the back is the way most towards where the robot came from, the front the shortest of the others.
//! - While a loop is being closed ([`way_back`]), the back leads to the previous shield: without that, a robot among adjacent loops
//!   might go from one to the next and close none.
//!
//! Departs from the paper [Jorge15, III]:
//!
//! - What blocks is the robot's cell with its eight neighbours, since a skeleton that is two cells thick or a staircase leads past a
//!   single cell, and the heads are the cells just outside.
//! - The two ways may meet before the tractor point, where it is not on the loop but on a branch that leads there: then the loop ends
//!   where they meet ([`LoopRoad::meet`]). A shield farther down would cut both ways, and the robot would leave the loop before it
//!   has come to the tractor point.
//! - The previous shield is asked for by a wave from it, not by the descent to the tractor point: that takes the shortest way, and
//!   with a shorter loop beside the one that is being closed it does not come by the shield, although the loop is there. That the
//!   tractor point can be reached on the shield's other side is what the wave after it shows [line 21].
//!
//! Units: steps along the skeleton, 20 cm and a little more.

use crate::geometry::Cell;
use crate::grid::{Plane, Site};
use crate::math;
use crate::roadmap::Residues;
use crate::roadmap::branches::{MOST_WAYS, ways};
use crate::strategy::ouroboros::ground::Ground;
use crate::strategy::ouroboros::shield::Shield;

/// Steps from the robot's cell to a head.
const TO_HEAD: u32 = 2;

/// A loop through robot and tractor point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LoopRoad {
    /// The first cell of the way back.
    pub back: Site,
    /// The first cell of the way ahead.
    pub front: Site,
    /// Steps from the robot to the tractor point the back way.
    pub back_steps: u32,
    /// And the other way.
    pub front_steps: u32,
    /// Where the two meet: the tractor point, or a junction before it.
    pub meet: Site,
    /// Steps from there to the tractor point.
    pub tail_steps: u32,
}

/// A way to the tractor point.
#[derive(Clone, Copy, Debug)]
struct Way {
    head: Site,
    steps: u32,
    /// How much it leads back: the cosine of the angle to where the robot came from, times the distance there.
    back: f32,
}

impl LoopRoad {
    /// The loop that the wave found round `robot`, the robot's cell, which `came` from there; `None` if there is
    /// none.
    #[must_use]
    pub fn find<const TILES: usize, const SLOTS: usize>(
        ground: &Ground<'_, TILES, SLOTS>,
        residues: &Residues<'_>,
        (robot, came): (Site, Cell),
    ) -> Option<Self> {
        let heads = ways(ground.way, robot);
        let reached = heads.iter().filter(|head| residues.get(**head).is_some());
        let ways: heapless::Vec<Way, MOST_WAYS> = reached
            .map(|&head| Way::measure(ground, residues, (robot, came), head))
            .collect();
        let back = ways.iter().max_by(|a, b| a.back.total_cmp(&b.back))?;
        let others = ways.iter().filter(|way| way.head != back.head);
        let front = others.min_by_key(|way| way.steps)?;
        let (meet, tail_steps) = meet(residues, back, front)?;
        Some(Self {
            back: back.head,
            front: front.head,
            back_steps: back.steps,
            front_steps: front.steps,
            meet,
            tail_steps,
        })
    }

    /// Steps all the way round.
    #[must_use]
    pub const fn steps(&self) -> u32 {
        self.back_steps + self.front_steps - 2 * self.tail_steps
    }

    /// The cells of the back, from its head to where it meets the front.
    pub fn back<'a>(&self, residues: &'a Residues<'_>) -> impl Iterator<Item = Site> + use<'a> {
        let steps = self.back_steps - self.tail_steps - TO_HEAD;
        down(residues, self.back).take(steps as usize + 1)
    }
}

/// The way down from a cell, with the cell itself.
fn down<'a>(residues: &'a Residues<'_>, from: Site) -> impl Iterator<Item = Site> + use<'a> {
    core::iter::once(from).chain(residues.descent(from))
}

/// Where two ways meet, and how many steps are left from there. Ways that have met stay together, and at the latest they
/// meet at the tractor point.
fn meet(residues: &Residues<'_>, one: &Way, other: &Way) -> Option<(Site, u32)> {
    let level = one.steps.min(other.steps);
    let from = |way: &Way| down(residues, way.head).skip((way.steps - level) as usize);
    let met = (0..).zip(from(one).zip(from(other)));
    met.map(|(come, (a, b))| (come, a, b))
        .find(|(_, a, b)| a == b)
        .map(|(come, site, _): (u32, _, _)| (site, level - TO_HEAD - come))
}

impl Way {
    /// Traversal it down to the tractor point.
    fn measure<const TILES: usize, const SLOTS: usize>(
        ground: &Ground<'_, TILES, SLOTS>,
        residues: &Residues<'_>,
        (robot, came): (Site, Cell),
        head: Site,
    ) -> Self {
        let apart = |a: Cell, b: Cell| ((a.x - b.x) as f32, (a.y - b.y) as f32);
        let here = ground.cell(robot);
        let ((x, y), (to_x, to_y)) = (apart(ground.cell(head), here), apart(came, here));
        Self {
            head,
            steps: steps_from(residues, head),
            back: (x * to_x + y * to_y) / math::sqrt(x * x + y * y),
        }
    }
}

/// Steps from the robot's cell by a head to where the wave came from.
fn steps_from(residues: &Residues<'_>, head: Site) -> u32 {
    TO_HEAD + residues.descent(head).count() as u32
}

/// The way back to the previous shield, from which the wave has come: its cells from just behind the robot on. The other ways lead
/// there round the loop.
pub fn way_back<'a>(
    way: Plane<'_>,
    residues: &'a Residues<'_>,
    robot: Site,
) -> Option<impl Iterator<Item = Site> + use<'a>> {
    let heads = ways(way, robot);
    let reached = heads.iter().filter(|head| residues.get(**head).is_some());
    let back = reached.min_by_key(|head| steps_from(residues, **head))?;
    Some(down(residues, *back))
}

/// The first valid shield along the path's back, from the robot on [Jorge15, III-C, fourth step].
///
/// `None` when the cells come to their end, or `MOST_TRIED` of them were looked at, without one.
#[must_use]
pub fn build_shield<const TILES: usize, const SLOTS: usize>(
    ground: &Ground<'_, TILES, SLOTS>,
    back: impl Iterator<Item = Site>,
    robot: Cell,
) -> Option<Shield> {
    let mut span: Span = [None; SPAN];
    back.take(MOST_TRIED + SPAN - 1).find_map(|site| {
        span.rotate_left(1);
        span[SPAN - 1] = Some(ground.cell(site));
        let [near, at, far] = [span[0]?, span[SPAN / 2]?, span[SPAN - 1]?];
        Shield::build(ground, at, [far, near], robot).ok()
    })
}

/// Cells of the path by which its direction at the middle one is known.
const SPAN: usize = 5;
type Span = [Option<Cell>; SPAN];
/// Cells of the path that are tried: the nearest 8 m. What a shield costs is bounded, and so is the search.
const MOST_TRIED: usize = 40;

//! The loop road: the two ways from the robot to the tractor point [Ouroboros, III-C, third step].
//!
//! The wave has gone out from the tractor point with the robot's surroundings as a blocker. Where it came to the robot by two
//! ways or more there is a loop: the road's *back* is what the shield will be built across, its *front* is where the robot
//! is to go. Neither is stored: each is the descent from its head, down the wave's distances.
//!
//! - Fresh: the back is the way most towards where the robot came from, the front the shortest of the others.
//! - While a loop is being closed, the back must pass by the previous shield: without that, a robot among adjacent loops might
//!   go from one to the next and close none.
//!
//! Departs from [Ouroboros]: what blocks is the robot's cell with its eight neighbours, since a skeleton that is two cells thick
//! or a staircase leads past a single cell, and the heads are the cells just outside. And the two ways may meet before the tractor
//! point, where it is not on the loop but on a branch that leads there: then the loop ends where they meet ([`LoopRoad::meet`]). A shield
//! farther down would cut both ways, and the robot would leave the loop before it has come to the tractor point.
//!
//! Units: steps along the skeleton, 20 cm and a little more.

use super::ground::Ground;
use super::shield::Shield;
use crate::geometry::Cell;
use crate::grid::Site;
use crate::math;
use crate::skeleton::Residues;
use crate::skeleton::branches::ways;

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
    /// It passes by the previous shield.
    shielded: bool,
}

impl LoopRoad {
    /// The loop that the wave found round `robot`, the robot's cell, which `came` from there; `None` if there is none, or while a
    /// loop is being closed behind `shield`, none through that.
    #[must_use]
    pub fn find<const TILES: usize, const SLOTS: usize>(
        ground: &Ground<'_, TILES, SLOTS>,
        residues: &Residues<'_>,
        (robot, came): (Site, Cell),
        shield: Option<&Shield>,
    ) -> Option<Self> {
        let heads = ways(ground.way, robot);
        let reached = heads.iter().filter(|head| residues.get(**head).is_some());
        let ways: heapless::Vec<Way, { crate::skeleton::branches::MOST_WAYS }> = reached
            .map(|&head| Way::measure(ground, residues, (robot, came), head, shield))
            .collect();
        let is_back = |way: &&Way| shield.is_none() || way.shielded;
        let back = ways
            .iter()
            .filter(is_back)
            .max_by(|a, b| a.back.total_cmp(&b.back))?;
        let front = ways
            .iter()
            .filter(|way| way.head != back.head && !(shield.is_some() && way.shielded))
            .min_by_key(|way| way.steps)?;
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
    /// Walk it down to the tractor point.
    fn measure<const TILES: usize, const SLOTS: usize>(
        ground: &Ground<'_, TILES, SLOTS>,
        residues: &Residues<'_>,
        (robot, came): (Site, Cell),
        head: Site,
        shield: Option<&Shield>,
    ) -> Self {
        let mut steps = TO_HEAD;
        let mut shielded = false;
        let holds = |site: Site| shield.is_some_and(|shield| shield.holds(ground.cell(site)));
        for site in down(residues, head) {
            steps += 1;
            shielded = shielded || holds(site);
        }
        let apart = |a: Cell, b: Cell| ((a.x - b.x) as f32, (a.y - b.y) as f32);
        let here = ground.cell(robot);
        let ((x, y), (to_x, to_y)) = (apart(ground.cell(head), here), apart(came, here));
        Self {
            head,
            steps: steps - 1,
            back: (x * to_x + y * to_y) / math::sqrt(x * x + y * y),
            shielded,
        }
    }
}

/// The first valid shield along the road's back, from the robot on [Ouroboros, III-C, fourth step].
///
/// `None` when the end of the loop is reached, or [`MOST_TRIED`] cells were looked at, without one.
#[must_use]
pub fn build_shield<const TILES: usize, const SLOTS: usize>(
    ground: &Ground<'_, TILES, SLOTS>,
    residues: &Residues<'_>,
    road: &LoopRoad,
    robot: Cell,
) -> Option<Shield> {
    let mut span: Span = [None; SPAN];
    let mut tried = 0;
    for site in road.back(residues) {
        span.rotate_left(1);
        span[SPAN - 1] = Some(ground.cell(site));
        let (Some(near), Some(at), Some(far)) = (span[0], span[SPAN / 2], span[SPAN - 1]) else {
            continue;
        };
        tried += 1;
        if tried > MOST_TRIED {
            return None;
        }
        if let Ok(shield) = Shield::build(ground, at, [far, near], robot) {
            return Some(shield);
        }
    }
    None
}

/// Cells of the road by which its direction at the middle one is known.
const SPAN: usize = 5;
type Span = [Option<Cell>; SPAN];
/// Cells of the road that are tried: the nearest 8 m. What a shield costs is bounded, and so is the search.
const MOST_TRIED: u32 = 40;

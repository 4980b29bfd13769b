//! The loop road: two arms along the skeleton, from the robot to the tractor point
//! \[Jorge15, III-C, third step\].
//!
//! A wave has spread from the tractor point with the robot's surroundings as a blocker. If it
//! reaches the robot from at least two directions, there is a loop. The *back* is the arm that the
//! shield is built across; the *front* is the arm that the robot drives. Neither is stored: each is
//! the descent of the wave's distances from its *head*, the first cell outside the surroundings.
//!
//! - A new loop [Algorithm 1, line 16], [`LoopRoad::find`]: the back is the arm that leads most
//!   towards where the robot came from; the front is the shortest of the others.
//! - A loop that is being closed [line 14], [`back_to_shield`]: the back leads to the previous
//!   shield. Without that, a robot among adjacent loops may change from one to the next and close
//!   none.
//!
//! Departs from \[Jorge15, III-C\]:
//!
//! - The blocker is the robot's cell with its eight neighbours, and the heads are the cells just
//!   outside. A skeleton that is a staircase or two cells thick leads past a single cell.
//! - The arms may meet before the tractor point, if it is not on the loop but on a branch that
//!   leads there. The loop then ends where they meet ([`LoopRoad::meet`]). A shield farther down
//!   would cut both arms, and the robot would leave the loop before it reaches the tractor point.
//! - The way to the previous shield comes from a wave of its own and not from the descent to the
//!   tractor point. That descent is the shortest way: with a shorter loop beside the one that is
//!   being closed it does not pass the shield, although the loop is there. The next wave [line 20]
//!   shows whether the tractor point can be reached on the shield's other side.
//! - That wave leaves the shield only ahead, where the robot drove on. More than half round the
//!   loop, the shortest way to the shield is the front, which comes to it from behind. A shield
//!   across the front would send the robot back the way it came.
//!
//! Units: steps along the skeleton, 20 cm each; a diagonal step counts the same.

use crate::config::OuroborosTuning;
use crate::geometry::Cell;
use crate::grid::Site;
use crate::math;
use crate::path::nearest::Centres;
use crate::roadmap::Residues;
use crate::roadmap::branches::{MOST_WAYS, ways};
use crate::strategy::ouroboros::shield::Shield;

/// Steps from the robot's cell to a head.
const TO_HEAD: u32 = 2;

/// A loop through the robot and the tractor point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct LoopRoad {
    /// The head of the back.
    pub(super) back: Site,
    /// The head of the front.
    pub(super) front: Site,
    /// Steps from the robot to the tractor point by the back.
    pub(super) back_steps: u32,
    /// Steps from the robot to the tractor point by the front.
    pub(super) front_steps: u32,
    /// The cell where the arms meet: the tractor point, or a junction before it.
    pub(super) meet: Site,
    /// Steps from there to the tractor point.
    pub(super) tail_steps: u32,
}

/// A direction from which the wave reaches the robot.
#[derive(Clone, Copy, Debug)]
struct Arm {
    head: Site,
    /// Steps from the robot to the tractor point.
    steps: u32,
    /// The cosine of the angle between the head and the place that the robot came from, times the
    /// distance to that place.
    backwards: f32,
}

impl LoopRoad {
    /// Returns the loop that the wave found for a robot in the centre cell `robot` that came from
    /// the cell `came`; `None` if there is no loop.
    pub(super) fn find<const TILES: usize, const SLOTS: usize>(
        centres: &Centres<'_, TILES, SLOTS>,
        residues: &Residues<'_>,
        (robot, came): (Site, Cell),
    ) -> Option<Self> {
        let heads = ways(centres.cells, robot);
        let reached = heads.iter().filter(|head| residues.get(**head).is_some());
        let arms: heapless::Vec<Arm, MOST_WAYS> = reached
            .map(|&head| Arm::measure(centres, residues, (robot, came), head))
            .collect();
        let back = arms
            .iter()
            .max_by(|a, b| a.backwards.total_cmp(&b.backwards))?;
        let others = arms.iter().filter(|arm| arm.head != back.head);
        let front = others.min_by_key(|arm| arm.steps)?;
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

    /// Returns the length of the loop, steps.
    pub(super) const fn steps(&self) -> u32 {
        self.back_steps + self.front_steps - 2 * self.tail_steps
    }

    /// Returns the cells of the back, from its head to where it meets the front.
    pub(super) fn back<'a>(
        &self,
        residues: &'a Residues<'_>,
    ) -> impl Iterator<Item = Site> + use<'a> {
        let steps = self.back_steps - self.tail_steps - TO_HEAD;
        descent(residues, self.back).take(steps as usize + 1)
    }
}

/// The descent from a cell, with the cell itself.
fn descent<'a>(residues: &'a Residues<'_>, from: Site) -> impl Iterator<Item = Site> + use<'a> {
    core::iter::once(from).chain(residues.descent(from))
}

/// Returns the cell where two arms meet, and the steps from there to the tractor point. Arms that
/// have met stay together, and they meet at the tractor point at the latest.
fn meet(residues: &Residues<'_>, one: &Arm, other: &Arm) -> Option<(Site, u32)> {
    let level = one.steps.min(other.steps);
    let from = |arm: &Arm| descent(residues, arm.head).skip((arm.steps - level) as usize);
    let pairs = (0..).zip(from(one).zip(from(other)));
    pairs
        .map(|(done, (a, b))| (done, a, b))
        .find(|(_, a, b)| a == b)
        .map(|(done, site, _): (u32, _, _)| (site, level - TO_HEAD - done))
}

impl Arm {
    /// Measures the arm of a head.
    fn measure<const TILES: usize, const SLOTS: usize>(
        centres: &Centres<'_, TILES, SLOTS>,
        residues: &Residues<'_>,
        (robot, came): (Site, Cell),
        head: Site,
    ) -> Self {
        let apart = |a: Cell, b: Cell| ((a.x - b.x) as f32, (a.y - b.y) as f32);
        let here = centres.cell(robot);
        let ((x, y), (to_x, to_y)) = (apart(centres.cell(head), here), apart(came, here));
        Self {
            head,
            steps: steps_from(residues, head),
            backwards: (x * to_x + y * to_y) / math::sqrt(x * x + y * y),
        }
    }
}

/// Returns the steps from the robot's cell by a head to where the wave began.
fn steps_from(residues: &Residues<'_>, head: Site) -> u32 {
    TO_HEAD + residues.descent(head).count() as u32
}

/// Returns the cells from just behind the robot to the previous shield, from which the wave has
/// spread ahead. Of the arms that lead there the shortest is the back; the others lead round other
/// loops.
pub(super) fn back_to_shield<'a, const TILES: usize, const SLOTS: usize>(
    centres: &Centres<'_, TILES, SLOTS>,
    residues: &'a Residues<'_>,
    robot: Site,
) -> Option<impl Iterator<Item = Site> + use<'a, TILES, SLOTS>> {
    let heads = ways(centres.cells, robot);
    let reached = heads.iter().filter(|head| residues.get(**head).is_some());
    let back = reached.min_by_key(|head| steps_from(residues, **head))?;
    Some(descent(residues, *back))
}

/// Returns the first valid shield across the back, from the robot on \[Jorge15, III-C, fourth
/// step\].
///
/// `None` if the back ends, or `most_reach_cells` cells were tried, without one.
pub(super) fn build_shield<const TILES: usize, const SLOTS: usize>(
    centres: &Centres<'_, TILES, SLOTS>,
    back: impl Iterator<Item = Site>,
    robot: Cell,
    tuning: &OuroborosTuning,
) -> Option<Shield> {
    let mut span = [None; SPAN];
    let most = usize::from(tuning.most_reach_cells) + SPAN - 1;
    back.take(most).find_map(|site| {
        span.rotate_left(1);
        span[SPAN - 1] = Some(centres.cell(site));
        let [near, at, far] = [span[0]?, span[SPAN / 2]?, span[SPAN - 1]?];
        Shield::build(centres, at, [far, near], robot, tuning).ok()
    })
}

/// Consecutive cells of the back from which the direction at the middle one is taken.
const SPAN: usize = 5;

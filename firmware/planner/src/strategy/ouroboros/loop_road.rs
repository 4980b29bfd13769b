//! The loop road: the two ways from the robot to the tractor point [Ouroboros, III-C, third step].
//!
//! The wave has gone out from the tractor point with the robot's surroundings as a blocker. Where it came to the robot by two
//! ways or more there is a loop: the road's *back* is what the shield will be built across, its *front* is where the robot
//! is to go. Neither is stored: each is the descent from its head, down the wave's distances.
//!
//! - Fresh: the back is the way most behind the robot, the front the shortest of the others.
//! - While a loop is being closed, the back must pass by the previous shield: without that, a robot among adjacent loops might
//!   go from one to the next and close none.
//!
//! Departs from [Ouroboros]: what blocks is the robot's cell with its eight neighbours, since a skeleton that is two cells thick
//! or a staircase leads past a single cell, and the heads are the cells just outside.
//!
//! Units: steps along the skeleton, 20 cm and a little more.

use super::ground::Ground;
use super::shield::Shield;
use crate::geometry::{Cell, Pose};
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
}

/// A way to the tractor point.
#[derive(Clone, Copy, Debug)]
struct Way {
    head: Site,
    steps: u32,
    /// How much it leads ahead: the cosine of the angle to the robot's heading, times two.
    ahead: f32,
    /// It passes by the previous shield.
    shielded: bool,
}

impl LoopRoad {
    /// The loop that the wave found round `robot`, the robot's cell; `None` if there is none, or while a loop is being closed behind
    /// `shield`, none through that.
    #[must_use]
    pub fn find<const TILES: usize, const SLOTS: usize>(
        ground: &Ground<'_, TILES, SLOTS>,
        residues: &Residues<'_>,
        (robot, pose): (Site, &Pose),
        shield: Option<&Shield>,
    ) -> Option<Self> {
        let heads = ways(ground.way, robot);
        let reached = heads.iter().filter(|head| residues.get(**head).is_some());
        let ways: heapless::Vec<Way, { crate::skeleton::branches::MOST_WAYS }> = reached
            .map(|&head| Way::measure(ground, residues, (robot, pose), head, shield))
            .collect();
        let is_back = |way: &&Way| shield.is_none() || way.shielded;
        let back = ways
            .iter()
            .filter(is_back)
            .min_by(|a, b| a.ahead.total_cmp(&b.ahead))?;
        let front = ways
            .iter()
            .filter(|way| way.head != back.head && !(shield.is_some() && way.shielded))
            .min_by_key(|way| way.steps)?;
        Some(Self {
            back: back.head,
            front: front.head,
            back_steps: back.steps,
            front_steps: front.steps,
        })
    }

    /// Steps all the way round.
    #[must_use]
    pub const fn steps(&self) -> u32 {
        self.back_steps + self.front_steps
    }
}

impl Way {
    /// Walk it down to the tractor point.
    fn measure<const TILES: usize, const SLOTS: usize>(
        ground: &Ground<'_, TILES, SLOTS>,
        residues: &Residues<'_>,
        (robot, pose): (Site, &Pose),
        head: Site,
        shield: Option<&Shield>,
    ) -> Self {
        let mut steps = TO_HEAD;
        let mut shielded = false;
        let holds = |site: Site| shield.is_some_and(|shield| shield.holds(ground.cell(site)));
        for site in core::iter::once(head).chain(residues.descent(head)) {
            steps += 1;
            shielded = shielded || holds(site);
        }
        let (sin, cos) = math::sin_cos(pose.yaw_rad);
        let apart = |a: u16, b: u16| f32::from(a) - f32::from(b);
        let (x, y) = (apart(head.x, robot.x), apart(head.y, robot.y));
        Self {
            head,
            steps: steps - 1,
            ahead: (x * cos + y * sin) * 2.0 / math::sqrt(x * x + y * y),
            shielded,
        }
    }
}

/// The first valid shield along the road's back, from the robot on [Ouroboros, III-C, fourth step].
///
/// `None` when the tractor point is reached, or `rays` cells were looked at, without one.
#[must_use]
pub fn build_shield<const TILES: usize, const SLOTS: usize>(
    ground: &Ground<'_, TILES, SLOTS>,
    residues: &Residues<'_>,
    road: &LoopRoad,
    robot: Cell,
) -> Option<Shield> {
    let mut span: Span = [None; SPAN];
    let mut tried = 0;
    let back = core::iter::once(road.back).chain(residues.descent(road.back));
    for site in back {
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

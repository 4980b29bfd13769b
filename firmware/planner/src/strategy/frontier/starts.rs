//! Starts: when the wave of each frontier cell starts.
//!
//! ```text
//! starts after:  0 beside the present goal | 10 a large frontier's | 22 a small one's     + 50 · level
//! ```
//!
//! with the level of [`crate::path::height_levels`]. To find it takes far longer than to start a wave, and it is asked for once for every other
//! start there is, in each search of a round; so it is found once and kept, five bits a frontier cell.
//!
//! Units: coarse steps of 20 cm.

use crate::geometry::Cell;
use crate::grid::{Plane, Site};
use crate::path::PlanningContext;
use crate::path::height_levels::{LATER_STEPS, MOST_LEVEL};
use crate::strategy::frontier::{DROP_RADIUS_M, Frontier, near};

/// Head start of the present goal, coarse steps: what turning about costs.
const HEAD_START: u32 = 10;
/// A frontier cell with fewer around it, within 2 cells and with itself, is a small one's: a corner, the foot of a wall.
const SMALL_COMPANY: u32 = 4;
/// By so many coarse steps a small frontier is as if farther away. The papers have all unexplored cells start at once; on the
/// built-in worlds, three seeds, the mean time to 99 % is thereby (seconds; 30 steps in the last column):
///
/// | | at once | 12 steps | 30 steps |
/// | --- | --- | --- | --- |
/// | office | 264 | 262 | 282 |
/// | cave | 99 | 98 | 98 |
/// | loop | 112 | 108 | 108 |
/// | cluttered | 67 | 61 | 61 |
/// | hall | 67 | 64 | 64 |
/// | narrow-doors | 83 | 78 | 78 |
const SMALL_LATER: u32 = 12;
/// How much later frontier cells start by their rank: beside the present goal, large, small.
const RANKS_LATER: [u32; 3] = [0, HEAD_START, HEAD_START + SMALL_LATER];
const RANKS: u32 = RANKS_LATER.len() as u32;
/// Bits of a number, and how many fit in a word.
const BITS: usize = 5;
const PER_WORD: usize = u32::BITS as usize / BITS;
/// Number of a frontier cell that does not start at all.
const NEVER: u32 = (1 << BITS) - 1;
const _CHECKS: () = assert!(
    LATER_STEPS > HEAD_START + SMALL_LATER && RANKS * (MOST_LEVEL + 1) <= NEVER,
    "the ranks of a level start before the next level, and each has a number"
);

/// The starts of a plane's frontier cells, numbered in the order of time.
#[derive(Debug)]
pub(super) struct Starts<'a> {
    /// Of the plane's cells, in its order; what does not fit is found anew each time.
    numbers: &'a [u32],
    /// Those that there are, a bit each.
    present: u32,
}

impl Starts<'_> {
    /// The numbers that there are, the first first.
    pub(super) fn in_order(&self) -> impl Iterator<Item = u32> + use<> {
        let present = self.present;
        (0..NEVER).filter(move |number| present >> number & 1 == 1)
    }

    /// The cells that start with a number.
    pub(super) fn sites<'k, const TILES: usize, const SLOTS: usize>(
        &'k self,
        number: u32,
        frontier: &'k Frontier,
        goals: Plane<'k>,
        known: &'k PlanningContext<'_, TILES, SLOTS>,
    ) -> impl Iterator<Item = Site> + use<'k, TILES, SLOTS> {
        let its_number = move |(k, site): (usize, Site)| match self.numbers.get(k / PER_WORD) {
            Some(&numbers) => numbers >> (k % PER_WORD * BITS) & NEVER,
            None => frontier.start_of(goals, site, known),
        };
        let all = goals.sites().enumerate();
        all.filter_map(move |of| (its_number(of) == number).then_some(of.1))
    }
}

/// How much later than the first a number starts.
pub(super) fn later(number: u32) -> u32 {
    let rank = RANKS_LATER.get((number % RANKS) as usize);
    number / RANKS * LATER_STEPS + rank.copied().unwrap_or_default()
}

impl Frontier {
    /// The starts of all frontier cells, in memory that is lent.
    pub(super) fn starts<'a, const TILES: usize, const SLOTS: usize>(
        &self,
        goals: Plane<'_>,
        known: &PlanningContext<'_, TILES, SLOTS>,
        numbers: &'a mut [u32],
    ) -> Starts<'a> {
        let mut present = 0;
        numbers.fill(0);
        for (k, site) in goals.sites().enumerate() {
            let number = self.start_of(goals, site, known);
            if number != NEVER {
                present |= 1 << number;
            }
            if let Some(kept) = numbers.get_mut(k / PER_WORD) {
                *kept |= number << (k % PER_WORD * BITS);
            }
        }
        Starts { numbers, present }
    }

    fn start_of<const TILES: usize, const SLOTS: usize>(
        &self,
        goals: Plane<'_>,
        site: Site,
        known: &PlanningContext<'_, TILES, SLOTS>,
    ) -> u32 {
        let cell = known.topology.frame().cell(site);
        match self.rank(goals, site, cell) {
            Some(rank) => self.level_of(known, cell) * RANKS + rank,
            None => NEVER,
        }
    }

    /// How much later a frontier cell starts for its height. The present goal counts by the storey from which it is preferred most, of those
    /// that the robot was on since it took it: on its way it crosses others, and what is preferred from there would turn it about, and from beyond them
    /// again. So steps and level of the present goal together only become fewer, and no two goals draw the robot to and fro. A goal that recedes up or
    /// down a slope is judged by its height where it is now.
    fn level_of<const TILES: usize, const SLOTS: usize>(
        &self,
        known: &PlanningContext<'_, TILES, SLOTS>,
        cell: Cell,
    ) -> u32 {
        let Some(levels) = &known.levels else {
            return 0;
        };
        let level = levels.of(known.tiles, cell);
        if level > 0 && self.is_present(cell) {
            level.min(levels.from(self.storey_m).of(known.tiles, cell))
        } else {
            level
        }
    }

    /// A goal is taken, or kept: from here if it is another one, or no less preferred from here.
    pub(super) fn note_storey<const TILES: usize, const SLOTS: usize>(
        &mut self,
        known: &PlanningContext<'_, TILES, SLOTS>,
        goal: Cell,
    ) {
        let Some(levels) = &known.levels else {
            return;
        };
        if !self.is_present(goal) || levels.of(known.tiles, goal) <= self.level_of(known, goal) {
            self.storey_m = levels.storey_m;
        }
    }

    /// Whether a cell is beside the present goal.
    fn is_present(&self, cell: Cell) -> bool {
        !self.path.is_empty() && near(self.path.goal(), cell, 2.0 * DROP_RADIUS_M)
    }

    /// In which order frontier cells of one storey start; `None` for one that was dropped.
    fn rank(&self, goals: Plane<'_>, site: Site, cell: Cell) -> Option<u32> {
        if self.is_gone(cell) {
            None
        } else if self.is_present(cell) {
            Some(0)
        } else {
            Some(1 + u32::from(!has_company(goals, site)))
        }
    }
}

/// Whether there are enough frontier cells in the square of five by five around one.
fn has_company(goals: Plane<'_>, site: Site) -> bool {
    let (word, bit) = (usize::from(site.x / 32), site.x % 32);
    let mut count = 0;
    // Most have enough in their own row and the next.
    [2, 3, 1, 4, 0].into_iter().any(|dy| {
        let Some(row) = (usize::from(site.y) + dy).checked_sub(2) else {
            return false;
        };
        let here = goals.word(row, word);
        let near = match bit {
            0 | 1 => {
                let before = word.checked_sub(1).map_or(0, |word| goals.word(row, word));
                here << (2 - bit) | before >> (30 + bit)
            }
            30 | 31 => here >> (bit - 2) | goals.word(row, word + 1) << (34 - bit),
            _ => here >> (bit - 2),
        };
        count += (near & 0x1f).count_ones();
        count >= SMALL_COMPANY
    })
}

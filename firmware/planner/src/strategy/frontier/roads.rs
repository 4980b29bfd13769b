//! Roads: the wave from every frontier cell, each starting the later the less it is preferred, and the way down it from the robot
//! [Ouroboros, Algorithm 1, lines 3, 4, 24].
//!
//! ```text
//! starts after:  0 beside the present goal | 10 a large frontier's | 22 a small one's     + 50 · level
//! ```
//!
//! with the level of [`crate::terrain::storeys`].
//!
//! Where heights are preferred, a road that goes by another storey gives way to one that keeps to its own, if that is no longer than what goals
//! so far off the storey are put back by. Units: map cells, coarse steps of 20 cm.

use super::{DROP_RADIUS_M, Frontier, Known, Lent, near};
use crate::geometry::{Cell, Point};
use crate::grid::{Plane, PlaneMut, Site};
use crate::map::Tiles;
use crate::skeleton::{WaveSpace, Wavefront};
use crate::strategy::Road;
use crate::strategy::nearest::Centres;
use crate::strategy::paths::Paths;
use crate::terrain::storeys::{LATER_STEPS, MOST_LEVEL};
use crate::topology::Frame;

/// A road that leaves the storey by so many levels more than its goal does goes by another storey: 1 m with Table I's parameters.
const OTHER_STOREY: u32 = 4;
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
const _CHECKS: () = assert!(
    LATER_STEPS > HEAD_START + SMALL_LATER,
    "the ranks of a level start before the next level"
);

impl<const TILES: usize, const SLOTS: usize> Known<'_, TILES, SLOTS> {
    /// These centre cells, to look for the nearest of.
    fn centres<'a>(&'a self, way: Plane<'a>) -> Centres<'a, TILES, SLOTS> {
        Centres {
            tiles: self.tiles,
            disc: self.disc,
            frame: self.topology.frame(),
            way,
        }
    }
}

impl Frontier {
    /// The way to a goal; where heights are preferred, one that keeps to the storey if it is not much longer.
    pub(super) fn find_road<const TILES: usize, const SLOTS: usize>(
        &self,
        known: &Known<'_, TILES, SLOTS>,
        robot: Point,
        lent: &mut Lent<'_>,
    ) -> Option<Road> {
        if self.only_looks {
            return None;
        }
        let way = known.topology.skeleton()?;
        let road = self.find_road_on(way, known, robot, lent)?;
        Some(
            self.keep_to_storey(&road, known, robot, lent)
                .unwrap_or(road),
        )
    }

    /// For a road that leaves the storey much farther than its goal does, a way along centre cells that leave it no farther than that (or by one
    /// level); if there is one that is no longer than what goals so far off the storey are put back by.
    fn keep_to_storey<const TILES: usize, const SLOTS: usize>(
        &self,
        road: &Road,
        known: &Known<'_, TILES, SLOTS>,
        robot: Point,
        lent: &mut Lent<'_>,
    ) -> Option<Road> {
        let levels = known.levels.as_ref()?;
        let level = |cell: Cell| levels.of(known.tiles, cell);
        let least = level(road.goal()).max(1);
        let most = road.cells().iter().copied().map(level).max()?;
        let excess = most
            .checked_sub(least)
            .filter(|&excess| excess >= OTHER_STOREY)?;
        let frame = known.topology.frame();
        // A map so large that the way does not fit behind the wave has to do with the shortest road.
        let (residues, spare) = lent.residues.split_at_mut_checked(frame.shape.words())?;
        let mut on_storey = PlaneMut::new(frame.shape, spare.as_flattened_mut()).ok()?;
        on_storey.fill(0);
        for site in known.topology.skeleton()?.sites() {
            if level(frame.cell(site)) <= least {
                on_storey.set(site);
            }
        }
        let mut lent = Lent {
            residues,
            ring: &mut *lent.ring,
            view: &mut *lent.view,
        };
        let detour = self.find_road_on(on_storey.view(), known, robot, &mut lent)?;
        (detour.steps() <= road.steps() + LATER_STEPS * excess).then_some(detour)
    }

    /// The way to a goal along these centre cells.
    fn find_road_on<const TILES: usize, const SLOTS: usize>(
        &self,
        way: Plane<'_>,
        known: &Known<'_, TILES, SLOTS>,
        robot: Point,
        lent: &mut Lent<'_>,
    ) -> Option<Road> {
        let goals = known.topology.frontier()?;
        let mut paths = Paths::open(known.centres(way), lent)?;
        if !self.spread(&mut paths.space, goals, known) {
            return None;
        }
        let robot = robot.cell();
        let found = paths.entry(robot);
        let Paths {
            centres,
            space,
            view,
        } = paths;
        let Some((entry, steps)) = found else {
            // With a centre cell near by that no wave reached, there is no way.
            if centres.nearest(robot, view, |_| true).is_some() {
                return None;
            }
            let is_reached = |site| space.residues.get(site).is_some();
            let (entry, line) = centres.nearest_by_air(robot, is_reached)?;
            return Some(walk_down(&space, centres.frame, known.tiles, line, entry));
        };
        let at_once = core::iter::empty();
        Some(walk_down(&space, centres.frame, known.tiles, at_once, entry).after(steps))
    }

    /// Wave from every frontier cell that was not dropped; those beside the present goal first, and those on another storey last. Whether
    /// there are any.
    fn spread<const TILES: usize, const SLOTS: usize>(
        &self,
        space: &mut WaveSpace<'_>,
        goals: Plane<'_>,
        known: &Known<'_, TILES, SLOTS>,
    ) -> bool {
        let mut any = false;
        let mut wave = Wavefront::new();
        wave.start(space);
        let level = |cell| self.level_of(known, cell);
        let frame = known.topology.frame();
        let present = goals
            .sites()
            .fold(0_u32, |levels, site| levels | 1 << level(frame.cell(site)));
        let mut now = 0;
        for turn in (0..=MOST_LEVEL).filter(|turn| present >> turn & 1 == 1) {
            // Ranks that were met; the first is gone through in any case.
            let mut ranks = 1;
            for (rank, later) in RANKS_LATER.into_iter().enumerate() {
                if ranks >> rank & 1 == 0 {
                    continue;
                }
                let start = turn * LATER_STEPS + later;
                wave.advance_levels(space, start - now);
                now = start;
                for site in goals.sites() {
                    let cell = frame.cell(site);
                    if level(cell) == turn
                        && let Some(its_rank) = self.rank(goals, site, cell)
                    {
                        ranks |= 1 << its_rank;
                        any |= its_rank == rank && wave.seed(space, site);
                    }
                }
            }
        }
        // Without a budget it always comes to its end.
        let _ = wave.advance(space, None, u32::MAX);
        any
    }

    /// How much later a frontier cell starts for its height. The present goal counts by the storey from which it is preferred most, of those
    /// that the robot was on since it took it: on its way it crosses others, and what is preferred from there would turn it about, and from beyond them
    /// again. So steps and level of the present goal together only become fewer, and no two goals draw the robot to and fro. A goal that recedes up or
    /// down a slope is judged by its height where it is now.
    fn level_of<const TILES: usize, const SLOTS: usize>(
        &self,
        known: &Known<'_, TILES, SLOTS>,
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
        known: &Known<'_, TILES, SLOTS>,
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
        !self.road.is_empty() && near(self.road.goal(), cell, 2.0 * DROP_RADIUS_M)
    }

    /// In which order frontier cells of one storey start; `None` for one that was dropped.
    fn rank(&self, goals: Plane<'_>, site: Site, cell: Cell) -> Option<usize> {
        if self.is_gone(cell) {
            None
        } else if self.is_present(cell) {
            Some(0)
        } else {
            Some(1 + usize::from(company(goals, site) < SMALL_COMPANY))
        }
    }
}

/// Frontier cells in the square of five by five around one.
fn company(goals: Plane<'_>, site: Site) -> u32 {
    let (word, bit) = (usize::from(site.x / 32), site.x % 32);
    (0..5)
        .filter_map(|dy| (usize::from(site.y) + dy).checked_sub(2))
        .map(|row| {
            let before = word.checked_sub(1).map_or(0, |word| goals.word(row, word));
            let after = goals.word(row, word + 1);
            let wide = u64::from(before >> 30)
                | u64::from(goals.word(row, word)) << 2
                | u64::from(after & 3) << 34;
            (wide >> bit & 0x1f).count_ones()
        })
        .sum()
}

/// The road to the centre cell nearest to a place.
pub(super) fn road_to<const TILES: usize, const SLOTS: usize>(
    place: Cell,
    known: &Known<'_, TILES, SLOTS>,
    robot: Point,
    lent: &mut Lent<'_>,
) -> Option<Road> {
    let mut paths = Paths::open(known.centres(known.topology.skeleton()?), lent)?;
    let (nearest, _) = paths.centres.nearest(place, paths.view, |_| true)?;
    paths.spread(core::iter::once(nearest));
    paths.road(robot.cell())
}

/// The road from the cells before the entry to the frontier, and one cell into the unexplored beyond it.
fn walk_down<const TILES: usize, const SLOTS: usize>(
    space: &WaveSpace<'_>,
    frame: Frame,
    tiles: &Tiles<TILES, SLOTS>,
    before: impl Iterator<Item = Cell>,
    entry: Site,
) -> Road {
    let way = core::iter::once(entry).chain(space.residues.descent(entry));
    let mut last = entry;
    let cells = way.map(|site| {
        last = site;
        frame.cell(site)
    });
    let mut road = Road::along(before.chain(cells));
    road.extend(unexplored_beside(frame.cell(last), tiles));
    road
}

/// The coarse cell beside `cell` in which most was never measured.
fn unexplored_beside<const TILES: usize, const SLOTS: usize>(
    cell: Cell,
    tiles: &Tiles<TILES, SLOTS>,
) -> Option<Cell> {
    let unknown = |cell: Cell| {
        (0..2)
            .map(|dy| (tiles.row(cell.x, cell.y + dy).unknown() & 3).count_ones())
            .sum::<u32>()
    };
    [(2, 0), (-2, 0), (0, 2), (0, -2)]
        .into_iter()
        .map(|(dx, dy)| Cell {
            x: cell.x + dx,
            y: cell.y + dy,
        })
        .max_by_key(|&beside| unknown(beside))
        .filter(|&beside| unknown(beside) > 0)
}

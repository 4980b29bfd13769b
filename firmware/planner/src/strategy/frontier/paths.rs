//! Roads: the wave from every frontier cell, each starting the later the less it is preferred ([`super::starts`]), and the way down it from
//! the robot [Jorge15, Algorithm 1, lines 3, 4, 24].
//!
//! Where heights are preferred, a path that goes by another storey gives way to one that keeps to its own, if that is no longer than what goals
//! so far off the storey are put back by. Units: map cells, coarse steps of 20 cm.

use crate::geometry::{Cell, Point};
use crate::grid::{Plane, PlaneMut, Site};
use crate::map::Tiles;
use crate::path::Path;
use crate::path::height_levels::LATER_STEPS;
use crate::path::nearest::Centres;
use crate::path::search::PathSearch;
use crate::path::{PlanningContext, PlanningScratch};
use crate::roadmap::skeleton::Frame;
use crate::roadmap::{WaveSpace, Wavefront};
use crate::strategy::frontier::Frontier;
use crate::strategy::frontier::starts::{Starts, later};

/// A path that leaves the storey by so many levels more than its goal does goes by another storey: 1 m with Table I's parameters.
const OTHER_STOREY: u32 = 4;
/// Words of the wave's queue in which the starts of frontier cells are kept, six a word: a wave rarely has so many cells waiting.
const START_WORDS: usize = 170;

impl<const TILES: usize, const SLOTS: usize> PlanningContext<'_, TILES, SLOTS> {
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
    pub(super) fn find_path<const TILES: usize, const SLOTS: usize>(
        &self,
        known: &PlanningContext<'_, TILES, SLOTS>,
        robot: Point,
        lent: &mut PlanningScratch<'_>,
    ) -> Option<Path> {
        if self.only_looks {
            return None;
        }
        let way = known.topology.skeleton()?;
        let goals = known.topology.frontier()?;
        let queue = lent.ring.len().saturating_sub(START_WORDS);
        let (ring, numbers) = lent.ring.split_at_mut(queue);
        let starts = self.starts(goals, known, numbers);
        let mut lent = PlanningScratch {
            residues: &mut *lent.residues,
            ring,
            view: &mut *lent.view,
        };
        let goals = (goals, &starts);
        let path = self.find_path_on(way, goals, known, robot, &mut lent)?;
        match self.keep_to_storey(&path, goals, known, robot, &mut lent) {
            None => Some(path),
            detour => detour,
        }
    }

    /// For a path that leaves the storey much farther than its goal does, a way along centre cells that leave it no farther than that (or by one
    /// level); if there is one that is no longer than what goals so far off the storey are put back by.
    fn keep_to_storey<const TILES: usize, const SLOTS: usize>(
        &self,
        path: &Path,
        goals: (Plane<'_>, &Starts<'_>),
        known: &PlanningContext<'_, TILES, SLOTS>,
        robot: Point,
        lent: &mut PlanningScratch<'_>,
    ) -> Option<Path> {
        let levels = known.levels.as_ref()?;
        let level = |cell: Cell| levels.of(known.tiles, cell);
        let least = level(path.goal()).max(1);
        let most = path.cells().iter().copied().map(level).max()?;
        let excess = most
            .checked_sub(least)
            .filter(|&excess| excess >= OTHER_STOREY)?;
        let frame = known.topology.frame();
        // A map so large that the way does not fit behind the wave has to do with the shortest path.
        let (residues, spare) = lent.residues.split_at_mut_checked(frame.shape.words())?;
        let mut on_storey = PlaneMut::new(frame.shape, spare.as_flattened_mut()).ok()?;
        on_storey.fill(0);
        for site in known.topology.skeleton()?.sites() {
            if level(frame.cell(site)) <= least {
                on_storey.set(site);
            }
        }
        let mut lent = PlanningScratch {
            residues,
            ring: &mut *lent.ring,
            view: &mut *lent.view,
        };
        let detour = self.find_path_on(on_storey.view(), goals, known, robot, &mut lent)?;
        (detour.steps() <= path.steps() + LATER_STEPS * excess).then_some(detour)
    }

    /// The way to a goal along these centre cells.
    fn find_path_on<const TILES: usize, const SLOTS: usize>(
        &self,
        way: Plane<'_>,
        goals: (Plane<'_>, &Starts<'_>),
        known: &PlanningContext<'_, TILES, SLOTS>,
        robot: Point,
        lent: &mut PlanningScratch<'_>,
    ) -> Option<Path> {
        let mut paths = PathSearch::open(known.centres(way), lent)?;
        if !self.spread(&mut paths.space, goals, known) {
            return None;
        }
        let robot = robot.cell();
        let found = paths.entry(robot);
        let PathSearch {
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

    /// Wave from every frontier cell that was not dropped, each at its start. Whether there are any.
    fn spread<const TILES: usize, const SLOTS: usize>(
        &self,
        space: &mut WaveSpace<'_>,
        (goals, starts): (Plane<'_>, &Starts<'_>),
        known: &PlanningContext<'_, TILES, SLOTS>,
    ) -> bool {
        let mut any = false;
        let mut wave = Wavefront::new();
        wave.start(space);
        let mut now = 0;
        for number in starts.in_order() {
            let start = later(number);
            wave.advance_levels(space, start - now);
            now = start;
            for site in starts.sites(number, self, goals, known) {
                any |= wave.seed(space, site);
            }
        }
        // Without a budget it always comes to its end.
        let _ = wave.advance(space, None, u32::MAX);
        any
    }
}

/// The path to the centre cell nearest to a place.
pub(super) fn path_to<const TILES: usize, const SLOTS: usize>(
    place: Cell,
    known: &PlanningContext<'_, TILES, SLOTS>,
    robot: Point,
    lent: &mut PlanningScratch<'_>,
) -> Option<Path> {
    let mut paths = PathSearch::open(known.centres(known.topology.skeleton()?), lent)?;
    let (nearest, _) = paths.centres.nearest(place, paths.view, |_| true)?;
    paths.spread(core::iter::once(nearest));
    paths.path(robot.cell())
}

/// The path from the cells before the entry to the frontier, and one cell into the unexplored beyond it.
fn walk_down<const TILES: usize, const SLOTS: usize>(
    space: &WaveSpace<'_>,
    frame: Frame,
    tiles: &Tiles<TILES, SLOTS>,
    before: impl Iterator<Item = Cell>,
    entry: Site,
) -> Path {
    let way = core::iter::once(entry).chain(space.residues.descent(entry));
    let mut last = entry;
    let cells = way.map(|site| {
        last = site;
        frame.cell(site)
    });
    let mut path = Path::along(before.chain(cells));
    path.extend(unexplored_beside(frame.cell(last), tiles));
    path
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

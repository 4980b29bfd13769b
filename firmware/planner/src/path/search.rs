//! Centre cells opened for a wave, in lent memory, and the path from a place down to where it began.
//!
//! All that plans along the skeleton begins with this: the wave's distances and queue, and the search for the centre cell nearest to the robot,
//! over the same centre cells.
//!
//! Units: map cells, coarse steps of 20 cm; sites of the topology's frame.

use crate::field::local_grid::LocalGrid;
use crate::geometry::{Cell, Point};
use crate::grid::Site;
use crate::path::nearest::Centres;
use crate::path::{Path, PlanningContext, PlanningScratch};
use crate::roadmap::{Residues, WaveSpace, Wavefront};

/// Centre cells, a wave's memory over them, and the window in which the nearest one is looked for.
#[derive(Debug)]
pub(crate) struct PathSearch<'a, const TILES: usize, const SLOTS: usize> {
    pub(crate) centres: Centres<'a, TILES, SLOTS>,
    pub(crate) space: WaveSpace<'a>,
    pub(crate) view: &'a mut LocalGrid,
}

impl<'a, const TILES: usize, const SLOTS: usize> PathSearch<'a, TILES, SLOTS> {
    /// These centre cells, to none of which a wave came yet; `None` if what is lent is too small for them.
    pub(crate) fn open(
        centres: Centres<'a, TILES, SLOTS>,
        lent: &'a mut PlanningScratch<'_>,
    ) -> Option<Self> {
        let residues = Residues::new(centres.frame.shape, &mut *lent.residues).ok()?;
        let space = WaveSpace {
            way: centres.way,
            residues,
            ring: &mut *lent.ring,
        };
        Some(Self {
            centres,
            space,
            view: &mut *lent.view,
        })
    }

    /// Wave from these sites, all at once, to everything that they can be reached from.
    pub(crate) fn spread(&mut self, sites: impl Iterator<Item = Site>) {
        let mut wave = Wavefront::new();
        wave.start(&mut self.space);
        for site in sites {
            wave.seed(&mut self.space, site);
        }
        // Without a budget it always comes to its end.
        let _ = wave.advance(&mut self.space, None, u32::MAX);
    }

    /// The centre cell nearest to a place of those that the wave came to, and the coarse steps there.
    pub(crate) fn entry(&mut self, from: Cell) -> Option<(Site, u32)> {
        let is_reached = |site| self.space.residues.get(site).is_some();
        self.centres.nearest(from, self.view, is_reached)
    }

    /// The path from a place to where the wave began.
    pub(crate) fn path(&mut self, from: Cell) -> Option<Path> {
        let (entry, steps) = self.entry(from)?;
        let (frame, residues) = (self.centres.frame, &self.space.residues);
        Some(Path::down(core::iter::empty(), frame, residues, entry).after(steps))
    }
}

/// Returns the path to the centre cell nearest to a place.
pub(crate) fn path_to<const TILES: usize, const SLOTS: usize>(
    place: Cell,
    context: &PlanningContext<'_, TILES, SLOTS>,
    robot: Point,
    scratch: &mut PlanningScratch<'_>,
) -> Option<Path> {
    let centres = context.centres(context.topology.skeleton()?);
    let mut search = PathSearch::open(centres, scratch)?;
    let (nearest, _) = search.centres.nearest(place, search.view, |_| true)?;
    search.spread(core::iter::once(nearest));
    search.path(robot.cell())
}

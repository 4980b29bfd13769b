//! A path search: a wave over centre cells in lent memory, and the path from a place down to where
//! the wave began.
//!
//! Units: map cells, coarse steps of 20 cm; sites of the skeleton's plane.

use crate::field::local_grid::LocalGrid;
use crate::geometry::Cell;
use crate::grid::Site;
use crate::path::nearest::Centres;
use crate::path::{Path, PlanningContext, PlanningScratch};
use crate::roadmap::{Residues, WaveSpace, Wavefront};

/// The centre cells, the wave's memory over them, and the local grid in which the nearest one is
/// searched for.
#[derive(Debug)]
pub(crate) struct PathSearch<'a, const TILES: usize, const SLOTS: usize> {
    pub(crate) centres: Centres<'a, TILES, SLOTS>,
    pub(crate) space: WaveSpace<'a>,
    pub(crate) local_grid: &'a mut LocalGrid,
}

impl<'a, const TILES: usize, const SLOTS: usize> PathSearch<'a, TILES, SLOTS> {
    /// Opens a search over these centre cells; `None` if the scratch memory is too small for them.
    pub(crate) fn open(
        centres: Centres<'a, TILES, SLOTS>,
        scratch: &'a mut PlanningScratch<'_>,
    ) -> Option<Self> {
        let residues = Residues::new(centres.cells.tiling(), &mut *scratch.residues).ok()?;
        let space = WaveSpace {
            cells: centres.cells,
            residues,
            ring: &mut *scratch.queue,
        };
        Some(Self {
            centres,
            space,
            local_grid: &mut *scratch.local_grid,
        })
    }

    /// Spreads a wave from these sites, all at once, as far as the centre cells go.
    pub(crate) fn spread(&mut self, sites: impl Iterator<Item = Site>) {
        let mut wave = Wavefront::new();
        wave.start(&mut self.space);
        for site in sites {
            wave.seed(&mut self.space, site);
        }
        wave.run(&mut self.space, None);
    }

    /// Returns the centre cell nearest to a place that the wave reached, and the coarse steps
    /// there.
    pub(crate) fn entry(&mut self, from: Cell) -> Option<(Site, u32)> {
        let are_reached = |index| !self.space.residues.unreached(index);
        self.centres.nearest(from, self.local_grid, are_reached)
    }

    /// Returns the centre cell nearest to a place in the grid of a scale, and the coarse steps
    /// there.
    pub(crate) fn entry_at_scale(&mut self, from: Cell, scale: i32) -> Option<(Site, u32)> {
        self.centres
            .nearest_at_scale(from, (self.local_grid, scale), &|_| u32::MAX)
    }

    /// Returns the path from a place to where the wave began; `None` if no centre cell that the
    /// wave reached is near the place.
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
    scratch: &mut PlanningScratch<'_>,
) -> Option<Path> {
    path_between(
        context.pose.point().cell(),
        place,
        context.centres()?,
        scratch,
    )
}

/// Returns the path from a place to the centre cell nearest to another.
#[inline(never)]
pub(crate) fn path_between<const TILES: usize, const SLOTS: usize>(
    from: Cell,
    to: Cell,
    centres: Centres<'_, TILES, SLOTS>,
    scratch: &mut PlanningScratch<'_>,
) -> Option<Path> {
    let mut search = PathSearch::open(centres, scratch)?;
    let (nearest, _) = search
        .centres
        .nearest(to, search.local_grid, |_| u32::MAX)?;
    search.spread(core::iter::once(nearest));
    search.path(from)
}

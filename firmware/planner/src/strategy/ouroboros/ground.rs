//! What a loop is looked for on: the published skeleton and the map under it.
//!
//! Units: coarse cells of 20 cm, named by the least of their four map cells.

use crate::geometry::Cell;
use crate::grid::{Plane, Site};
use crate::map::{Class, Tiles};
use crate::roadmap::configuration_space::{Footprint, is_passable};
use crate::roadmap::skeleton::Frame;

/// The skeleton and the map.
#[derive(Clone, Copy, Debug)]
pub struct Ground<'a, const TILES: usize, const SLOTS: usize> {
    /// The map.
    pub tiles: &'a Tiles<TILES, SLOTS>,
    /// The robot's disc.
    pub disc: &'a Footprint,
    /// Where the skeleton lies.
    pub frame: Frame,
    /// The centre cells, none of them blocked.
    pub way: Plane<'a>,
}

impl<const TILES: usize, const SLOTS: usize> Ground<'_, TILES, SLOTS> {
    /// Whether the robot's centre may be in a coarse cell, by the topology's rule: in any of its four.
    #[must_use]
    pub fn is_open(&self, cell: Cell) -> bool {
        quarters(cell).any(|part| is_passable(self.tiles, self.disc, part))
    }

    /// Whether at most one of a coarse cell's four was never measured: again the topology's rule.
    #[must_use]
    pub fn is_explored(&self, cell: Cell) -> bool {
        let unknown = |part: &Cell| self.tiles.class(*part) == Class::Unknown;
        quarters(cell).filter(unknown).count() < 2
    }

    /// Whether a coarse cell is a centre cell.
    #[must_use]
    pub fn is_centre(&self, cell: Cell) -> bool {
        self.frame.site(cell).is_some_and(|site| self.way.get(site))
    }

    /// The coarse cell of a site.
    pub(super) fn cell(&self, site: Site) -> Cell {
        self.frame.cell(site)
    }
}

/// The four map cells of a coarse cell.
pub fn quarters(cell: Cell) -> impl Iterator<Item = Cell> {
    (0..4).map(move |k| Cell {
        x: cell.x + (k & 1),
        y: cell.y + (k >> 1),
    })
}

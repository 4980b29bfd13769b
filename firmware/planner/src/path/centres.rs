//! Queries about centre cells: by place, by map class, and in a square around a place.
//!
//! Units: map cells; a coarse cell of 20 cm is named by its map cell with the least x and y.

use crate::geometry::Cell;
use crate::grid::Site;
use crate::map::Tiles;
use crate::map::neighbourhood::Neighbourhood;
use crate::path::blocked_passages::BlockedPassages;
use crate::path::nearest::Centres;
use crate::roadmap::configuration_space::{Footprint, is_passable};
use crate::roadmap::skeleton::Skeleton;

impl<'a, const TILES: usize, const SLOTS: usize> Centres<'a, TILES, SLOTS> {
    /// The centre cells of a published skeleton; `None` before the first one.
    pub(crate) fn of(
        skeleton: &'a Skeleton<SLOTS>,
        tiles: &'a Tiles<TILES, SLOTS>,
        footprint: &'a Footprint,
        blocked: &'a BlockedPassages,
    ) -> Option<Self> {
        Some(Self {
            tiles,
            footprint,
            blocked,
            frame: skeleton.frame(),
            cells: skeleton.skeleton()?,
        })
    }

    /// Returns true if the robot's centre may be in at least one of a coarse cell's four map
    /// cells: the rule by which the skeleton's space is loaded.
    pub(crate) fn is_open(&self, cell: Cell) -> bool {
        cell.quarters()
            .any(|part| is_passable(self.tiles, self.footprint, part))
    }

    /// Returns true if at most one of a coarse cell's four map cells was never measured: again the
    /// skeleton's rule.
    pub(crate) fn is_explored(&self, cell: Cell) -> bool {
        Neighbourhood::of(self.tiles).is_explored(cell)
    }

    /// Returns true if a coarse cell is a centre cell.
    pub(crate) fn is_centre(&self, cell: Cell) -> bool {
        self.frame
            .site(cell)
            .is_some_and(|site| self.cells.get(site))
    }

    /// Returns the coarse cell of a site.
    pub(crate) fn cell(&self, site: Site) -> Cell {
        self.frame.cell(site)
    }

    /// Calls `visit` with each centre cell in the square that reaches `half` map cells from a cell
    /// to either side.
    pub(crate) fn for_each_in_square(
        &self,
        middle: Cell,
        half: i32,
        mut visit: impl FnMut(Site, Cell),
    ) {
        let mut is_centre = self.cells.query();
        let even = |at: i32| at & !1;
        let ends = |at: i32| (even(at - half)..=at + half).step_by(2);
        for y in ends(middle.y) {
            for x in ends(middle.x) {
                let Some(site) = self.frame.site(Cell { x, y }) else {
                    continue;
                };
                if is_centre(site) {
                    visit(site, self.cell(site));
                }
            }
        }
    }
}

//! The centre cell nearest to a place, by steps through passable cells [Jorge15, Algorithm 1, lines 4 and 6:
//! `moveToVoronoi`].
//!
//! Not the nearest as the crow flies, which may lie behind a wall. The search grows its window until it finds one. Where the largest
//! window (24 m) has none, as in the middle of a hall whose skeleton is all on one side, the way there is a straight line:
//! walls that end or stand alone would have brought centre cells nearer.
//!
//! Units: map cells; sites of the topology's frame.

use crate::field::SIDE;
use crate::field::local_grid::{LocalGrid, Rows, SCALES};
use crate::geometry::Cell;
use crate::grid::{Plane, Site, flood};
use crate::map::Tiles;
use crate::roadmap::configuration_space::Footprint;
use crate::roadmap::skeleton::Frame;

/// Longest straight way to a centre cell, cells: no map is wider than 128 m but one that is a corridor.
const MOST_BY_AIR: i32 = 1_280;

/// Where centre cells are looked for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Centres<'a, const TILES: usize, const SLOTS: usize> {
    pub(crate) tiles: &'a Tiles<TILES, SLOTS>,
    pub(crate) disc: &'a Footprint,
    pub(crate) frame: Frame,
    pub(crate) way: Plane<'a>,
}

impl<const TILES: usize, const SLOTS: usize> Centres<'_, TILES, SLOTS> {
    /// The centre cell nearest to `from` of those that `accepts` likes, and the coarse steps there; a robot at `from` is let
    /// out.
    pub(crate) fn nearest(
        &self,
        from: Cell,
        view: &mut LocalGrid,
        accepts: impl Fn(Site) -> bool,
    ) -> Option<(Site, u32)> {
        SCALES.iter().find_map(|&scale| {
            view.update(self.tiles, self.disc, from, scale);
            view.free_robot(from);
            let targets = self.targets(view, &accepts);
            let mut seeds: Rows = [0; SIDE];
            LocalGrid::put(&mut seeds, view.place(from)?);
            let met = flood::nearest(&view.passable, &mut seeds, &targets)?;
            let steps = u32::from(met.steps) * scale as u32 / 2;
            Some((self.site_in(view, met.site, &accepts)?, steps))
        })
    }

    /// The centre cell that `accepts` likes nearest to `from` as the crow flies, with the coarse cells on the line there, its own not
    /// among them.
    pub(crate) fn nearest_by_air<A: Fn(Site) -> bool>(
        &self,
        from: Cell,
        accepts: A,
    ) -> Option<(Site, impl Iterator<Item = Cell> + use<A, TILES, SLOTS>)> {
        // A pose may be anywhere; what is farther off than a map is large is no way.
        let apart = |site: Site| {
            let to = self.frame.cell(site);
            let (dx, dy) = (to.x.checked_sub(from.x)?, to.y.checked_sub(from.y)?);
            (dx.checked_abs()? < MOST_BY_AIR && dy.checked_abs()? < MOST_BY_AIR).then_some((dx, dy))
        };
        let (site, (dx, dy)) = self
            .way
            .sites()
            .filter(|&site| accepts(site))
            .filter_map(|site| Some((site, apart(site)?)))
            .min_by_key(|(_, (dx, dy))| dx * dx + dy * dy)?;
        let steps = dx.abs().max(dy.abs()) / 2;
        let line = (0..steps).map(move |k| Cell {
            x: (from.x + dx * k / steps) & !1,
            y: (from.y + dy * k / steps) & !1,
        });
        Some((site, line))
    }

    /// The passable window cells that hold a centre cell.
    fn targets(&self, view: &LocalGrid, accepts: impl Fn(Site) -> bool) -> Rows {
        let mut targets: Rows = [0; SIDE];
        let least = (view.origin.y - self.frame.origin.y).div_euclid(2);
        let first = least.max(0) as usize;
        let last = (least + SIDE as i32 * view.scale / 2 + 1).max(0) as usize;
        for y in first..last.min(self.frame.shape.rows()) {
            for word in 0..self.frame.shape.words_per_row() {
                let mut bits = self.way.word(y, word);
                while bits != 0 {
                    let x = (word * 32) as u16 + bits.trailing_zeros() as u16;
                    bits &= bits - 1;
                    let site = Site { x, y: y as u16 };
                    if accepts(site) {
                        view.mark(&mut targets, self.frame.cell(site));
                    }
                }
            }
        }
        targets
    }

    /// A centre cell in a window cell.
    fn site_in(
        &self,
        view: &LocalGrid,
        place: Site,
        accepts: impl Fn(Site) -> bool,
    ) -> Option<Site> {
        let least = Cell {
            x: view.origin.x + i32::from(place.x) * view.scale,
            y: view.origin.y + i32::from(place.y) * view.scale,
        };
        let coarse = (view.scale / 2).max(1);
        (0..coarse * coarse).find_map(|k| {
            let cell = Cell {
                x: least.x + k % coarse * 2,
                y: least.y + k / coarse * 2,
            };
            let site = self.frame.site(cell)?;
            (self.way.get(site) && accepts(site)).then_some(site)
        })
    }
}

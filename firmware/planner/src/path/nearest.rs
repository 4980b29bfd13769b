//! Centre cells, and the one nearest to a place by steps through passable cells [Jorge15, Algorithm
//! 1, lines 4 and 6: `moveToVoronoi`].
//!
//! The nearest one in a straight line may lie behind a wall, so the search goes by steps. It grows
//! its grid until it finds one. Where the largest grid (24 m) has none, as in the middle of a hall
//! whose skeleton lies on one side, the way there is a straight line: walls that end or stand alone
//! would have brought centre cells nearer.
//!
//! Units: map cells; sites of the skeleton's plane.

use crate::field::SIDE;
use crate::field::local_grid::{LocalGrid, Rows, SCALES};
use crate::geometry::Cell;
use crate::grid::bits::{ones, ones64};
use crate::grid::{PAGE_WORDS, Plane, Site, at, flood};
use crate::map::Tiles;
use crate::map::tiles::TILE_SIDE;
use crate::path::blocked_passages::BlockedPassages;
use crate::roadmap::configuration_space::Footprint;
use crate::roadmap::skeleton::Frame;

/// Maximum length of a straight way to a centre cell, cells: 128 m. Only a corridor's map is wider.
const MOST_LINE_CELLS: i32 = 1_280;

/// Greatest excess of a centre cell's steps over those of the nearest one, coarse steps: 1 m. In a
/// junction or a hall the way to a goal seldom begins at the nearest one.
const ENTRY_STEPS: u32 = 5;

/// The centre cells of a skeleton, with the map under them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Centres<'a, const TILES: usize, const SLOTS: usize> {
    /// The map.
    pub(crate) tiles: &'a Tiles<TILES, SLOTS>,
    /// The robot's footprint.
    pub(crate) footprint: &'a Footprint,
    /// The passages that are closed.
    pub(crate) blocked: &'a BlockedPassages,
    /// The place of the skeleton's plane.
    pub(crate) frame: Frame,
    /// The centre cells.
    pub(crate) cells: Plane<'a>,
}

impl<const TILES: usize, const SLOTS: usize> Centres<'_, TILES, SLOTS> {
    /// Returns the nearest centre cell that is one of `among`, and the coarse steps there from a
    /// robot at `from`, which may stand in an impassable cell. `among` returns the cells of a word
    /// of the plane, by its index, that are looked for.
    pub(crate) fn nearest(
        &self,
        from: Cell,
        grid: &mut LocalGrid,
        among: impl Fn(usize) -> u32,
    ) -> Option<(Site, u32)> {
        let mut scales = SCALES.iter();
        scales.find_map(|&scale| self.nearest_at_scale(from, (grid, scale), &among))
    }

    /// Returns the nearest centre cell, as [`Self::nearest`], in the grid of one scale.
    pub(crate) fn nearest_at_scale(
        &self,
        from: Cell,
        (grid, scale): (&mut LocalGrid, i32),
        among: &impl Fn(usize) -> u32,
    ) -> Option<(Site, u32)> {
        self.read(grid, from, scale);
        self.nearest_in(grid, from, among)
    }

    /// Returns the nearest centre cell in the grid, as [`Self::nearest`]. It is not inlined: its
    /// rows must not be on the stack while the grid is read.
    #[inline(never)]
    fn nearest_in(
        &self,
        grid: &LocalGrid,
        from: Cell,
        among: &impl Fn(usize) -> u32,
    ) -> Option<(Site, u32)> {
        let targets = self.targets(grid, among);
        let mut seeds: Rows = [0; SIDE];
        LocalGrid::put(&mut seeds, grid.place(from)?);
        let met = flood::nearest(&grid.passable, &mut seeds, &targets)?;
        let steps = u32::from(met.steps) * grid.scale as u32 / 2;
        Some((self.site_in(grid, met.site, among)?, steps))
    }

    /// Calls `visit` with the centre cells near a robot at `from` that are some of `among`, as
    /// [`Self::nearest`], and the coarse steps there, the nearest first: those at most
    /// [`ENTRY_STEPS`] farther off than the nearest one. Takes the first of these scales of the
    /// grid that has some. Returns false if there are none.
    pub(crate) fn entries(
        &self,
        from: Cell,
        (grid, scales): (&mut LocalGrid, &[i32]),
        among: impl Fn(usize) -> u32,
        mut visit: impl FnMut(Site, u32),
    ) -> bool {
        scales.iter().any(|&scale| {
            self.read(grid, from, scale);
            self.entries_in(grid, from, &among, &mut visit)
        })
    }

    /// Calls `visit` as [`Self::entries`], for one scale. It is not inlined, as
    /// [`Self::nearest_in`].
    #[inline(never)]
    fn entries_in(
        &self,
        grid: &LocalGrid,
        from: Cell,
        among: &impl Fn(usize) -> u32,
        visit: &mut impl FnMut(Site, u32),
    ) -> bool {
        let scale = grid.scale as u32;
        let mut targets = self.targets(grid, among);
        let mut reached: Rows = [0; SIDE];
        if let Some(place) = grid.place(from) {
            LocalGrid::put(&mut reached, place);
        }
        let (mut changed, mut steps, mut most) = (0..SIDE, 0, None);
        while !changed.is_empty() && most.is_none_or(|most| steps <= most) {
            for y in changed.clone() {
                let met = at(&reached, y) & at(&targets, y);
                if let Some(row) = targets.get_mut(y) {
                    *row &= !met;
                }
                for site in self.sites_in_row(grid, y, met, among) {
                    most.get_or_insert(steps + 2 * ENTRY_STEPS / scale);
                    visit(site, steps * scale / 2);
                }
            }
            let wider = changed.start.saturating_sub(1)..(changed.end + 1).min(SIDE);
            changed = flood::grow(&grid.passable, &mut reached, wider);
            steps += 1;
        }
        most.is_some()
    }

    /// Returns the centre cell nearest to `from` in a straight line, with the coarse cells on the
    /// line there, without the centre cell itself.
    pub(crate) fn nearest_in_line(
        &self,
        from: Cell,
    ) -> Option<(Site, impl Iterator<Item = Cell> + use<TILES, SLOTS>)> {
        // A pose may be anywhere. What is farther off than a map is large has no way to it.
        let apart = |site: Site| {
            let to = self.frame.cell(site);
            let (dx, dy) = (to.x.checked_sub(from.x)?, to.y.checked_sub(from.y)?);
            (dx.checked_abs()? < MOST_LINE_CELLS && dy.checked_abs()? < MOST_LINE_CELLS)
                .then_some((dx, dy))
        };
        let (site, (dx, dy)) = self
            .cells
            .sites()
            .filter_map(|site| Some((site, apart(site)?)))
            .min_by_key(|(_, (dx, dy))| dx * dx + dy * dy)?;
        let steps = dx.abs().max(dy.abs()) / 2;
        let line = (0..steps).map(move |k| Cell {
            x: (from.x + dx * k / steps) & !1,
            y: (from.y + dy * k / steps) & !1,
        });
        Some((site, line))
    }

    /// Reads the grid around a robot at `from`.
    fn read(&self, grid: &mut LocalGrid, from: Cell, scale: i32) {
        let map = (self.tiles, self.footprint);
        self.blocked.read(grid, map, from, scale);
        grid.free_robot(from);
    }

    /// Returns the passable cells of the grid that hold a centre cell.
    fn targets(&self, grid: &LocalGrid, among: impl Fn(usize) -> u32) -> Rows {
        let mut targets: Rows = [0; SIDE];
        let tiling = self.cells.tiling();
        let pages = tiling
            .keys()
            .iter()
            .zip(self.cells.words().chunks(PAGE_WORDS));
        for (place, (&key, words)) in pages.enumerate() {
            if !grid.overlaps(self.frame.cell(key.least()), TILE_SIDE) {
                continue;
            }
            for (index, &word) in (place * PAGE_WORDS..).zip(words) {
                for bit in ones(word & among(index)) {
                    let cell = self.frame.cell(tiling.site(index, bit));
                    grid.mark(&mut targets, cell);
                }
            }
        }
        targets
    }

    /// Returns a centre cell for each of a row's places that are set, where it has one.
    fn sites_in_row(
        &self,
        grid: &LocalGrid,
        y: usize,
        places: u64,
        among: impl Fn(usize) -> u32,
    ) -> impl Iterator<Item = Site> {
        ones64(places).filter_map(move |x| {
            let place = Site {
                x: x as u16,
                y: y as u16,
            };
            self.site_in(grid, place, &among)
        })
    }

    /// Returns a centre cell in a cell of the grid.
    fn site_in(&self, grid: &LocalGrid, place: Site, among: impl Fn(usize) -> u32) -> Option<Site> {
        let least = Cell {
            x: grid.origin.x + i32::from(place.x) * grid.scale,
            y: grid.origin.y + i32::from(place.y) * grid.scale,
        };
        let coarse = (grid.scale / 2).max(1);
        (0..coarse * coarse).find_map(|k| {
            let cell = Cell {
                x: least.x + k % coarse * 2,
                y: least.y + k / coarse * 2,
            };
            let site = self.frame.site(cell)?;
            let index = self.cells.tiling().index(site)?;
            let centres = at(self.cells.words(), index) & among(index);
            (centres & site.bit() != 0).then_some(site)
        })
    }
}

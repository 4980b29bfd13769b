//! The skeleton: centre cells of the passable space at 20 cm, computed anew in instalments.
//!
//! A round loads the map's passable cells into a plane of half the resolution, thins it under a
//! work budget, and publishes the result: [`Skeleton::skeleton`], and the frontier cells on it.
//! [`Space`] says which cells are thinned.
//!
//! The frontier cells (explored, with an unexplored cell at a side) are *anchors*: the thinning
//! keeps them, so every frontier that the robot fits through is on the skeleton and has a way along
//! it. Departs from \[Jorge15, III-C\], where only the unexplored cells that the thinning happens
//! to leave are goals: an unexplored patch beside a wide way leaves none, and the exploration may
//! end early.
//!
//! The planes have memory for the tiles that the map has touched, wherever they lie.
//!
//! Units: coarse cells of 20 cm; a tile is 16 × 16 of them.

use heapless::Vec;

use crate::geometry::{CELL_M, Cell};
use crate::grid::{Block, PAGE_SIDE, PAGE_WORDS, Plane, PlaneMut, SIDES, Site, TileKey, Tiling};
use crate::map::Tiles;
use crate::map::tiles::TILE_SIDE;
use crate::math;
use crate::roadmap::coarse;
use crate::roadmap::configuration_space::{Footprint, Strip, for_each_strip};
use crate::roadmap::{Progress, Thinning};

/// The space whose skeleton is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Space {
    /// The explored passable cells. It has fewer cells to thin, and paths run on measured ground.
    #[default]
    KnownFree,
    /// All passable cells, explored or not, in the touched tiles and those beside them, so that
    /// paths may run through the unexplored \[Jorge15, step 1\].
    NotObstacle,
}

/// The place of the planes in the map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Frame {
    /// Column and row of the map's first tile.
    origin: (i32, i32),
}

impl Frame {
    /// Returns the place of planes over a map.
    pub(crate) fn of<const TILES: usize, const SLOTS: usize>(tiles: &Tiles<TILES, SLOTS>) -> Self {
        Self {
            origin: tiles.origin(),
        }
    }

    /// Returns the least site of the first tile.
    const fn middle() -> Site {
        match TileKey::of(0, 0) {
            Some(key) => key.least(),
            None => Site { x: 0, y: 0 },
        }
    }

    /// Returns the site of a map cell; `None` if it is too far from the first tile.
    #[must_use]
    pub fn site(&self, cell: Cell) -> Option<Site> {
        let Site { x, y } = Self::middle();
        let steps = |at: i32, origin: i32| (at >> 1).wrapping_sub(origin * PAGE_SIDE as i32);
        let x = u16::try_from(steps(cell.x, self.origin.0).wrapping_add(x.into())).ok()?;
        let y = u16::try_from(steps(cell.y, self.origin.1).wrapping_add(y.into())).ok()?;
        let site = Site { x, y };
        (TileKey::at(site) != TileKey::NONE).then_some(site)
    }

    /// Returns the least of a site's four map cells.
    #[must_use]
    pub fn cell(&self, site: Site) -> Cell {
        let Site { x, y } = Self::middle();
        Cell {
            x: self.origin.0 * TILE_SIDE + (i32::from(site.x) - i32::from(x)) * 2,
            y: self.origin.1 * TILE_SIDE + (i32::from(site.y) - i32::from(y)) * 2,
        }
    }

    /// Returns the column and the row of a tile.
    pub(crate) const fn tile(self, key: TileKey) -> (i32, i32) {
        let (columns, rows) = key.offset();
        (self.origin.0 + columns, self.origin.1 + rows)
    }
}

/// The stage of a round.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// Loading the tile at place n.
    Load(usize),
    /// Thinning the plane.
    Thin,
}

/// Cost of loading a tile, in units of a thinning: a word judged, about 100 instructions.
const TILE_UNITS: u32 = 40;

type Words<const SLOTS: usize> = [[u32; PAGE_WORDS]; SLOTS];
type Keys<const SLOTS: usize> = Vec<TileKey, SLOTS>;

/// The published skeleton and the round in progress, for `SLOTS` tiles of 16 × 16 coarse cells.
#[derive(Debug)]
pub struct Skeleton<const SLOTS: usize> {
    /// The published skeleton and its tiles.
    skeleton: Words<SLOTS>,
    keys: Keys<SLOTS>,
    frame: Frame,
    /// The planes of the round in progress. Between the rounds, `next_frontier` holds the frontier
    /// cells of the published skeleton.
    next: Words<SLOTS>,
    next_frontier: Words<SLOTS>,
    next_keys: Keys<SLOTS>,
    stage: Stage,
    space: Space,
    thinning: Thinning<SLOTS>,
}

impl<const SLOTS: usize> Skeleton<SLOTS> {
    /// Makes an empty skeleton.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            skeleton: [[0; PAGE_WORDS]; SLOTS],
            keys: Vec::new(),
            frame: Frame { origin: (0, 0) },
            next: [[0; PAGE_WORDS]; SLOTS],
            next_frontier: [[0; PAGE_WORDS]; SLOTS],
            next_keys: Vec::new(),
            stage: Stage::Load(0),
            space: Space::KnownFree,
            thinning: Thinning::new(),
        }
    }

    /// Forgets everything, and thins this space from now on.
    pub fn reset(&mut self, space: Space) {
        self.space = space;
        self.keys.clear();
        self.stage = Stage::Load(0);
    }

    /// Returns the place of the planes.
    #[must_use]
    pub const fn frame(&self) -> Frame {
        self.frame
    }

    /// Returns the tiles of the published skeleton.
    #[must_use]
    pub fn tiling(&self) -> Tiling<'_> {
        Tiling::new(&self.keys)
    }

    /// Returns the centre cells of the published skeleton; `None` before the first one.
    #[must_use]
    pub fn skeleton(&self) -> Option<Plane<'_>> {
        let plane = Plane::new(Tiling::new(&self.keys), self.skeleton.as_flattened());
        plane.ok().filter(|_| !self.keys.is_empty())
    }

    /// Returns the published skeleton for a blocker; see [`crate::roadmap::Barrier`].
    pub fn skeleton_mut(&mut self) -> Option<PlaneMut<'_>> {
        let is_published = !self.keys.is_empty();
        let words = self.skeleton.as_flattened_mut();
        let plane = PlaneMut::new(Tiling::new(&self.keys), words);
        plane.ok().filter(|_| is_published)
    }

    /// Takes the cells within `radius_m` of a map cell out of the published skeleton.
    pub fn cut(&mut self, around: Cell, radius_m: f32) {
        let reach = math::floor(radius_m / (2.0 * CELL_M)) + 1;
        let frame = self.frame;
        let Some(mut plane) = self.skeleton_mut() else {
            return;
        };
        for dy in -reach..=reach {
            for dx in -reach..=reach {
                let far2 = (dx * dx + dy * dy) as f32 * (4.0 * CELL_M * CELL_M);
                let cell = Cell {
                    x: around.x + 2 * dx,
                    y: around.y + 2 * dy,
                };
                if let Some(site) = frame.site(cell).filter(|_| far2 <= radius_m * radius_m) {
                    plane.clear(site);
                }
            }
        }
    }

    /// Returns the frontier cells of the published skeleton; `None` once the next round has begun,
    /// which needs their memory.
    #[must_use]
    pub fn frontier(&self) -> Option<Plane<'_>> {
        if self.stage != Stage::Load(0) || self.keys.is_empty() {
            return None;
        }
        Plane::new(Tiling::new(&self.keys), self.next_frontier.as_flattened()).ok()
    }

    /// Continues the round with about `budget` units of work. `scratch` needs [`PAGE_WORDS`] words
    /// for each tile and may hold anything. Returns true if it published a skeleton.
    #[inline(never)]
    pub fn advance<const TILES: usize>(
        &mut self,
        tiles: &Tiles<TILES, SLOTS>,
        disc: &Footprint,
        scratch: &mut [u32],
        budget: u32,
    ) -> bool {
        let mut left = budget;
        if self.stage == Stage::Load(0) {
            self.begin(tiles);
        }
        while let Stage::Load(place) = self.stage {
            let Some(&key) = self.next_keys.get(place) else {
                if place == 0 {
                    // The map is empty.
                    return false;
                }
                self.begin_thinning(tiles, scratch);
                break;
            };
            if left < TILE_UNITS {
                return false;
            }
            left -= self.load(tiles, disc, (place, key));
            self.stage = Stage::Load(place + 1);
        }
        self.thin(scratch, left)
    }

    /// Begins a round: lists its tiles.
    fn begin<const TILES: usize>(&mut self, tiles: &Tiles<TILES, SLOTS>) {
        self.frame = Frame::of(tiles);
        self.next_keys.clear();
        // The lists have the same length.
        let _ = self.next_keys.extend_from_slice(tiles.keys());
        if self.space == Space::KnownFree {
            return;
        }
        for &key in tiles.keys() {
            for (columns, rows) in (-1..=1).flat_map(|x| (-1..=1).map(move |y| (x, y))) {
                let beside = key.beside(columns, rows);
                let (x, y) = self.frame.tile(beside);
                if tiles.room(x, y).is_ok()
                    && let Err(place) = self.next_keys.binary_search(&beside)
                {
                    // On a full list, no path runs through what lies there.
                    let _ = self.next_keys.insert(place, beside);
                }
            }
        }
    }

    /// Loads one tile. Returns the units of work that it took.
    fn load<const TILES: usize>(
        &mut self,
        tiles: &Tiles<TILES, SLOTS>,
        disc: &Footprint,
        (place, key): (usize, TileKey),
    ) -> u32 {
        let (tile_x, tile_y) = self.frame.tile(key);
        let corner = (tile_x * TILE_SIDE, tile_y * TILE_SIDE);
        let seen = tiles.is_touched(tile_x, tile_y);
        // A tile that was never touched is unexplored.
        let mut rows = [[0, u16::MAX]; PAGE_SIDE];
        if seen {
            let mut lower = Strip::default();
            for_each_strip(tiles, disc, corner, TILE_SIDE, |y, strip| {
                if (y - corner.1) & 1 == 0 {
                    lower = strip;
                } else if let Some(row) = rows.get_mut(((y - corner.1) / 2) as usize) {
                    *row = coarse::coarse(lower, strip);
                }
            });
        }
        let is_cell = match self.space {
            Space::KnownFree => 0,
            Space::NotObstacle => u16::MAX,
        };
        if let Some((cells, marks)) =
            (self.next.get_mut(place)).zip(self.next_frontier.get_mut(place))
        {
            for ((cells, marks), pair) in cells.iter_mut().zip(marks).zip(rows.chunks_exact(2)) {
                let [[first, first_unexplored], [second, second_unexplored]] = *pair else {
                    continue;
                };
                let word = |lower: u16, upper: u16| u32::from(lower) | u32::from(upper) << 16;
                *cells = word(
                    first | first_unexplored & is_cell,
                    second | second_unexplored & is_cell,
                );
                *marks = word(first_unexplored, second_unexplored);
            }
        }
        if seen { TILE_UNITS } else { 2 }
    }

    /// Turns the unexplored cells into frontier cells after the last tile, and begins to thin.
    fn begin_thinning<const TILES: usize>(
        &mut self,
        tiles: &Tiles<TILES, SLOTS>,
        border: &mut [u32],
    ) {
        let tiling = Tiling::new(&self.next_keys);
        let unexplored = self.next_frontier.as_flattened();
        for (place, &key) in self.next_keys.iter().enumerate() {
            let mut block = Block::read(tiling, unexplored, place);
            for (columns, rows) in SIDES {
                let beside = key.beside(columns, rows);
                let (x, y) = self.frame.tile(beside);
                // A tile that is not in the list is unexplored. If the map has no room for it, its
                // border is no frontier.
                if tiling.place(beside).is_none() && tiles.room(x, y).is_ok() {
                    block.fill_beyond((columns, rows));
                }
            }
            let cells = self.next.get(place).into_iter().flatten();
            let border = border.get_mut(place * PAGE_WORDS..).into_iter().flatten();
            for (k, (&cells, border)) in cells.zip(border).enumerate() {
                *border = coarse::border(cells, &block, k);
            }
        }
        let words = tiling.words();
        let marks = self.next_frontier.as_flattened_mut().iter_mut();
        for (mark, &border) in marks.zip(border.iter()).take(words) {
            *mark = border;
        }
        self.stage = Stage::Thin;
        // The tiles fit the list, so the pages suffice.
        let _ = self.thinning.start(tiling);
    }

    /// Continues the thinning. Returns true if it published the skeleton.
    fn thin(&mut self, losses: &mut [u32], budget: u32) -> bool {
        let tiling = Tiling::new(&self.next_keys);
        let anchors = self.next_frontier.as_flattened();
        let Ok(mut plane) = PlaneMut::new(tiling, self.next.as_flattened_mut()) else {
            return false;
        };
        match self.thinning.advance(&mut plane, anchors, losses, budget) {
            Progress::Pending => false,
            Progress::Done { .. } => {
                let frontier = self.next_frontier.as_flattened_mut().iter_mut();
                for (frontier, skeleton) in frontier.zip(self.next.as_flattened()) {
                    *frontier &= skeleton;
                }
                self.skeleton = self.next;
                self.keys.clone_from(&self.next_keys);
                self.stage = Stage::Load(0);
                true
            }
        }
    }
}

impl<const SLOTS: usize> Default for Skeleton<SLOTS> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests;

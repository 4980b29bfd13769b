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
//! Units: coarse cells of 20 cm; a tile is 16 × 16 of them.

use crate::geometry::{CELL_M, Cell};
use crate::grid::{Plane, PlaneMut, Shape, Site};
use crate::map::Tiles;
use crate::map::tiles::Extent;
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
    /// All passable cells, explored or not, in a box slightly larger than the known area, so that
    /// paths may run through the unexplored \[Jorge15, step 1\].
    NotObstacle,
}

/// The place of a plane in the map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    /// The least map cell of the plane, a tile's corner.
    pub origin: Cell,
    /// Rows and words of the plane.
    pub shape: Shape,
}

impl Frame {
    /// The frame of no plane.
    const NONE: Self = Self {
        origin: Cell { x: 0, y: 0 },
        shape: Shape::UNIT,
    };

    /// Returns the frame of a map's extent, a tile larger on each side where the box (in tiles) has
    /// room: paths may run outside the known area.
    fn around(extent: Extent, (width, height): (i32, i32)) -> Self {
        let widen = |least: i32, greatest: i32, most: i32| {
            let spare = most - (greatest - least + 1);
            let below = (spare > 1) as i32;
            let above = (spare > 0) as i32;
            (least - below, greatest - least + 1 + below + above)
        };
        let (x, across) = widen(extent.least.0, extent.greatest.0, width);
        let (y, up) = widen(extent.least.1, extent.greatest.1, height);
        // A word is two tiles wide. Sides within the box are within the limits of a shape.
        let shape =
            Shape::new((across as usize).div_ceil(2), up as usize * 16).unwrap_or(Shape::UNIT);
        Self {
            origin: Cell {
                x: x * 32,
                y: y * 32,
            },
            shape,
        }
    }

    /// Returns the site of a map cell; `None` outside the plane.
    #[must_use]
    pub fn site(&self, cell: Cell) -> Option<Site> {
        let x = u16::try_from((cell.x - self.origin.x) >> 1).ok()?;
        let y = u16::try_from((cell.y - self.origin.y) >> 1).ok()?;
        let site = Site { x, y };
        self.shape.contains(site).then_some(site)
    }

    /// Returns the least of a site's four map cells.
    #[must_use]
    pub fn cell(&self, site: Site) -> Cell {
        Cell {
            x: self.origin.x + i32::from(site.x) * 2,
            y: self.origin.y + i32::from(site.y) * 2,
        }
    }

    /// Returns the number of tiles in a row, with the spare half of the last word.
    const fn tiles_across(&self) -> usize {
        self.shape.words_per_row() * 2
    }

    /// Returns the number of tiles.
    const fn tiles(&self) -> usize {
        self.tiles_across() * (self.shape.rows() / 16)
    }
}

/// The stage of a round.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// Loading tile number n of the frame.
    Load(usize),
    /// Thinning the plane.
    Thin,
}

/// Cost of loading a tile, in units of a thinning: a word judged, about 100 instructions.
const TILE_UNITS: u32 = 40;

type Words<const SLOTS: usize> = [[u32; 8]; SLOTS];

/// The published skeleton and the round in progress, for `SLOTS` tiles of 16 × 16 coarse cells.
#[derive(Debug)]
pub struct Skeleton<const SLOTS: usize> {
    /// The published skeleton.
    skeleton: Words<SLOTS>,
    frame: Frame,
    /// The planes of the round in progress. Between the rounds, `next_frontier` holds the frontier
    /// cells of the published skeleton.
    next: Words<SLOTS>,
    next_frontier: Words<SLOTS>,
    next_frame: Frame,
    stage: Stage,
    space: Space,
    thinning: Thinning<SLOTS>,
}

impl<const SLOTS: usize> Skeleton<SLOTS> {
    /// Makes an empty skeleton.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            skeleton: [[0; 8]; SLOTS],
            frame: Frame::NONE,
            next: [[0; 8]; SLOTS],
            next_frontier: [[0; 8]; SLOTS],
            next_frame: Frame::NONE,
            stage: Stage::Load(0),
            space: Space::KnownFree,
            thinning: Thinning::new(),
        }
    }

    /// Forgets everything, and thins this space from now on.
    pub fn reset(&mut self, space: Space) {
        self.space = space;
        self.skeleton.as_flattened_mut().fill(0);
        self.frame = Frame::NONE;
        self.stage = Stage::Load(0);
    }

    /// Returns the place of the published plane.
    #[must_use]
    pub const fn frame(&self) -> Frame {
        self.frame
    }

    /// Returns the centre cells of the published skeleton; `None` before the first one.
    #[must_use]
    pub fn skeleton(&self) -> Option<Plane<'_>> {
        Plane::new(self.frame.shape, self.skeleton.as_flattened()).ok()
    }

    /// Returns the published skeleton for a blocker; see [`crate::roadmap::Barrier`].
    pub fn skeleton_mut(&mut self) -> Option<PlaneMut<'_>> {
        PlaneMut::new(self.frame.shape, self.skeleton.as_flattened_mut()).ok()
    }

    /// Takes the cells within `radius_m` of a map cell out of the published skeleton.
    pub fn cut(&mut self, around: Cell, radius_m: f32) {
        let reach = math::floor(radius_m / (2.0 * CELL_M)) + 1;
        let frame = self.frame;
        let Ok(mut plane) = PlaneMut::new(frame.shape, self.skeleton.as_flattened_mut()) else {
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
        if self.stage != Stage::Load(0) {
            return None;
        }
        Plane::new(self.frame.shape, self.next_frontier.as_flattened()).ok()
    }

    /// Continues the round with at most `budget` units of work. Returns true if it published a
    /// skeleton.
    pub fn advance<const TILES: usize>(
        &mut self,
        tiles: &Tiles<TILES, SLOTS>,
        disc: &Footprint,
        budget: u32,
    ) -> bool {
        let mut left = budget;
        if self.stage == Stage::Load(0) {
            let Some(extent) = tiles.extent() else {
                return false;
            };
            self.next_frame = Frame::around(extent, tiles.box_tiles());
        }
        while let Stage::Load(tile) = self.stage {
            if left < TILE_UNITS {
                return false;
            }
            left -= self.load(tiles, disc, tile);
            self.stage = Stage::Load(tile + 1);
            if tile + 1 == self.next_frame.tiles() {
                self.begin_thinning();
            }
        }
        self.thin(left)
    }

    /// Loads one tile. Returns the units of work that it took.
    fn load<const TILES: usize>(
        &mut self,
        tiles: &Tiles<TILES, SLOTS>,
        disc: &Footprint,
        tile: usize,
    ) -> u32 {
        let frame = self.next_frame;
        let (across, up) = (tile % frame.tiles_across(), tile / frame.tiles_across());
        let corner = (
            frame.origin.x + across as i32 * 32,
            frame.origin.y + up as i32 * 32,
        );
        let (tile_x, tile_y) = (corner.0 >> 5, corner.1 >> 5);
        let seen = tiles.is_touched(tile_x, tile_y);
        // A tile that was never touched is unexplored. One that the map has no room for stays so:
        // its border is no frontier.
        let has_room = tiles.room(tile_x, tile_y).is_ok();
        let mut rows = [[0, if has_room { u16::MAX } else { 0 }]; 16];
        if seen {
            let mut lower = Strip::default();
            for_each_strip(tiles, disc, corner, 32, |y, strip| {
                if (y - corner.1) & 1 == 0 {
                    lower = strip;
                } else if let Some(row) = rows.get_mut(((y - corner.1) / 2) as usize) {
                    *row = coarse::coarse(lower, strip);
                }
            });
        }
        let (word, shift) = (across / 2, across % 2 * 16);
        for (k, [explored, unexplored]) in rows.into_iter().enumerate() {
            let index = (up * 16 + k) * frame.shape.words_per_row() + word;
            let cells = match self.space {
                Space::KnownFree => explored,
                Space::NotObstacle => explored | unexplored,
            };
            for (plane, half) in [
                (&mut self.next, cells),
                (&mut self.next_frontier, unexplored),
            ] {
                if let Some(out) = plane.as_flattened_mut().get_mut(index) {
                    *out = *out & !(0xffff << shift) | u32::from(half) << shift;
                }
            }
        }
        if seen { TILE_UNITS } else { 2 }
    }

    /// Turns the unexplored cells into frontier cells after the last tile, and begins to thin.
    fn begin_thinning(&mut self) {
        let shape = self.next_frame.shape;
        let cells = self.next.as_flattened();
        let marks = self.next_frontier.as_flattened_mut();
        let marks = marks.get_mut(..shape.words()).unwrap_or_default();
        coarse::mark_border(cells, marks, shape.words_per_row());
        self.stage = Stage::Thin;
        // The frame fits the box, so the marks suffice.
        let _ = self.thinning.start(shape);
    }

    /// Continues the thinning. Returns true if it published the skeleton.
    fn thin(&mut self, budget: u32) -> bool {
        let shape = self.next_frame.shape;
        let anchors = self.next_frontier.as_flattened();
        let Ok(mut plane) = PlaneMut::new(shape, self.next.as_flattened_mut()) else {
            return false;
        };
        match self.thinning.advance(&mut plane, anchors, budget) {
            Progress::Pending => false,
            Progress::Done { .. } => {
                let frontier = self.next_frontier.as_flattened_mut().iter_mut();
                for (frontier, skeleton) in frontier.zip(self.next.as_flattened()) {
                    *frontier &= skeleton;
                }
                self.skeleton = self.next;
                self.frame = self.next_frame;
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

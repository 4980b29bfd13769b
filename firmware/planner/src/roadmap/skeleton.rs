//! The topology: centre cells of the passable space at 20 cm, made anew in instalments.
//!
//! A round loads the map's passable cells into a plane of half the resolution, thins it to the skeleton under a work
//! budget, and is then published: [`Skeleton::skeleton`] and the frontier cells on it. [`Space`] says which cells are
//! thinned, and what a frontier is.
//!
//! Units: coarse cells of 20 cm; a tile is 16 × 16 of them.

use crate::geometry::{CELL_M, Cell};
use crate::grid::{Plane, PlaneMut, Shape, Site};
use crate::map::Tiles;
use crate::map::tiles::Extent;
use crate::math;
use crate::roadmap::coarse;
use crate::roadmap::coarse::Border;
use crate::roadmap::configuration_space::{Footprint, Strip, for_each_strip};
use crate::roadmap::{Progress, Thinning};

/// Which cells are thinned, and what a frontier cell is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Space {
    /// The explored passable cells. The frontier cells (explored, with an unexplored cell at a side) are *anchors*: the
    /// thinning keeps them, so every frontier that the robot fits through is on the skeleton and has a way along it.
    ///
    /// Departs from [Jorge15, III-C], whose space is [`Self::NotObstacle`] without anchors: there only the unexplored
    /// cells that the thinning happens to leave are goals, and an unexplored patch beside a wide way leaves none. Measured
    /// with the same planner, 3 seeds on 7 built-in worlds and 2 on 13 buildings drawn by others:
    ///
    /// | | known free | not obstacle | not obstacle, anchored |
    /// | --- | --- | --- | --- |
    /// | declared complete in the first two seconds, 3 % known | 0 of 47 | 2 of 47 | 0 of 47 |
    /// | explored, built-in worlds, mean | 99.99 % | 99.92 % | 99.99 % |
    /// | sum of T99, built-in worlds | 2464 s | 2501 s | 2731 s |
    /// | sum of T99, others, where all three have one | 2366 s | 2515 s | 2519 s |
    /// | thinning of a round, office / cave / empty hall, words | 3.0 / 3.8 / 30 k | 11 / 16 / 39 k | 11 / 16 / 44 k |
    ///
    /// So the known free space is the default: no false end, no unknown cell to thin.
    #[default]
    KnownFree,
    /// All passable cells, explored or not, from a box slightly larger than the known area, so that ways may run through
    /// the unexplored [Jorge15, step 1]. The frontier cells are the unexplored cells beside an explored one that the thinning happens to leave, as in the paper.
    NotObstacle,
    /// [`Self::NotObstacle`], with the anchors of [`Self::KnownFree`].
    AnchoredNotObstacle,
}

impl Space {
    const fn border(self) -> Border {
        match self {
            Self::KnownFree | Self::AnchoredNotObstacle => Border::Explored,
            Self::NotObstacle => Border::Unexplored,
        }
    }
}

/// Where a plane lies in the map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Least map cell, a tile's corner.
    pub origin: Cell,
    /// Rows and words of the plane.
    pub shape: Shape,
}

impl Frame {
    const NONE: Self = Self {
        origin: Cell { x: 0, y: 0 },
        shape: Shape::UNIT,
    };

    /// The frame of a map's extent, a tile larger on every side where the box (in tiles) has room: paths may run
    /// outside the known area.
    fn around(extent: Extent, (width, height): (i32, i32)) -> Self {
        let widen = |least: i32, greatest: i32, most: i32| {
            let spare = most - (greatest - least + 1);
            let below = (spare > 1) as i32;
            let above = (spare > 0) as i32;
            (least - below, greatest - least + 1 + below + above)
        };
        let (x, across) = widen(extent.least.0, extent.greatest.0, width);
        let (y, up) = widen(extent.least.1, extent.greatest.1, height);
        // Two tiles are a word across. Sides within the box are within the limits of a shape.
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

    /// The coarse cell of a map cell, if it is in the plane.
    #[must_use]
    pub fn site(&self, cell: Cell) -> Option<Site> {
        let x = u16::try_from((cell.x - self.origin.x) >> 1).ok()?;
        let y = u16::try_from((cell.y - self.origin.y) >> 1).ok()?;
        let site = Site { x, y };
        self.shape.contains(site).then_some(site)
    }

    /// The least of a coarse cell's four map cells.
    #[must_use]
    pub fn cell(&self, site: Site) -> Cell {
        Cell {
            x: self.origin.x + i32::from(site.x) * 2,
            y: self.origin.y + i32::from(site.y) * 2,
        }
    }

    /// Tiles across, counting the spare half of the last word.
    const fn tiles_across(&self) -> usize {
        self.shape.words_per_row() * 2
    }

    const fn tiles(&self) -> usize {
        self.tiles_across() * (self.shape.rows() / 16)
    }
}

/// What a round is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// Loading tile number n of the frame.
    Load(usize),
    /// Thinning.
    Thin,
}

/// Work that a round may do in a step, in units of a thinning word (about a hundred instructions).
const TILE_UNITS: u32 = 40;

type Words<const SLOTS: usize> = [[u32; 8]; SLOTS];

/// The planes and the round in progress. `SLOTS` tiles of 16 × 16 coarse cells.
#[derive(Debug)]
pub struct Skeleton<const SLOTS: usize> {
    /// The published skeleton.
    skeleton: Words<SLOTS>,
    frame: Frame,
    /// The round in progress.
    next: Words<SLOTS>,
    next_frontier: Words<SLOTS>,
    next_frame: Frame,
    stage: Stage,
    space: Space,
    thinning: Thinning<SLOTS>,
}

impl<const SLOTS: usize> Skeleton<SLOTS> {
    /// Nothing known.
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

    /// Forget everything, and thin this space from now on.
    pub fn reset(&mut self, space: Space) {
        self.space = space;
        self.skeleton.as_flattened_mut().fill(0);
        self.frame = Frame::NONE;
        self.stage = Stage::Load(0);
    }

    /// Where the published planes lie.
    #[must_use]
    pub const fn frame(&self) -> Frame {
        self.frame
    }

    /// The published skeleton.
    #[must_use]
    pub fn skeleton(&self) -> Option<Plane<'_>> {
        Plane::new(self.frame.shape, self.skeleton.as_flattened()).ok()
    }

    /// The published skeleton, to block a way for a while; see [`crate::roadmap::Barrier`].
    pub fn skeleton_mut(&mut self) -> Option<PlaneMut<'_>> {
        PlaneMut::new(self.frame.shape, self.skeleton.as_flattened_mut()).ok()
    }

    /// Take the cells within `radius_m` of a map cell out of the published skeleton.
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

    /// The frontier cells of the published skeleton; `None` once the next round has begun, which needs their memory.
    #[must_use]
    pub fn frontier(&self) -> Option<Plane<'_>> {
        if self.stage != Stage::Load(0) {
            return None;
        }
        Plane::new(self.frame.shape, self.next_frontier.as_flattened()).ok()
    }

    /// Go on with the round, `budget` units at the most; true when a skeleton was published.
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

    /// Load one tile; returns the units it took.
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
        // Where nothing was ever stored, everything is unexplored.
        let mut rows = [[0, u16::MAX]; 16];
        let seen = tiles.is_touched(corner.0 >> 5, corner.1 >> 5);
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
                Space::NotObstacle | Space::AnchoredNotObstacle => explored | unexplored,
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

    /// Everything is loaded: turn the unexplored cells into frontier cells and begin to thin.
    fn begin_thinning(&mut self) {
        let shape = self.next_frame.shape;
        let cells = self.next.as_flattened();
        let marks = self.next_frontier.as_flattened_mut();
        let marks = marks.get_mut(..shape.words()).unwrap_or_default();
        coarse::mark_border(self.space.border(), cells, marks, shape.words_per_row());
        self.stage = Stage::Thin;
        // The frame fits the box, so the marks suffice (checked at compile time).
        let _ = self.thinning.start(shape, shape.whole());
    }

    /// Go on thinning; true when done and published.
    fn thin(&mut self, budget: u32) -> bool {
        let shape = self.next_frame.shape;
        let anchors = match self.space.border() {
            Border::Explored => self.next_frontier.as_flattened(),
            Border::Unexplored => &[],
        };
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

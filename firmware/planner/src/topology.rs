//! The topology: centre cells of the passable space at 20 cm, made anew in instalments.
//!
//! A round loads the map's passable cells into a plane of half the resolution, thins it to the skeleton under a work
//! budget, and is then published: [`Topology::skeleton`] and the frontier cells on it. A coarse cell is passable
//! if any of its four map cells is; it is unexplored if two or more of them were never measured.
//!
//! The frontier cells (explored, with an unexplored neighbour) are *anchors*: the thinning keeps them, so every frontier
//! that the robot fits through is on the skeleton and has a way along it.
//! Departs from [Ouroboros, III-C], where only the unexplored cells that thinning happens to leave are goals: an
//! unexplored patch beside a wide way leaves none, and stays unexplored.
//!
//! Units: coarse cells of 20 cm; a tile is 16 × 16 of them.

use crate::clearance::{Disc, for_each_strip};
use crate::geometry::{CELL_M, Cell};
use crate::grid::{Plane, PlaneMut, Shape, Site};
use crate::map::Tiles;
use crate::map::tiles::Extent;
use crate::math;
use crate::skeleton::{Progress, Thinning};

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
pub struct Topology<const SLOTS: usize> {
    /// The published skeleton.
    skeleton: Words<SLOTS>,
    frame: Frame,
    /// The round in progress.
    next: Words<SLOTS>,
    next_frontier: Words<SLOTS>,
    next_frame: Frame,
    stage: Stage,
    thinning: Thinning<SLOTS>,
}

impl<const SLOTS: usize> Topology<SLOTS> {
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
            thinning: Thinning::new(),
        }
    }

    /// Forget everything.
    pub fn reset(&mut self) {
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
        disc: &Disc,
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
        disc: &Disc,
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
            let mut lower = (0, 0);
            for_each_strip(tiles, disc, corner, 32, |y, strip| {
                if (y - corner.1) & 1 == 0 {
                    lower = (strip.passable, strip.unknown);
                } else if let Some(row) = rows.get_mut(((y - corner.1) / 2) as usize) {
                    *row = coarse(lower, (strip.passable, strip.unknown));
                }
            });
        }
        let (word, shift) = (across / 2, across % 2 * 16);
        for (k, [open, unexplored]) in rows.into_iter().enumerate() {
            let index = (up * 16 + k) * frame.shape.words_per_row() + word;
            for (plane, half) in [
                (&mut self.next, open),
                (&mut self.next_frontier, unexplored),
            ] {
                if let Some(out) = plane.as_flattened_mut().get_mut(index) {
                    *out = *out & !(0xffff << shift) | u32::from(half) << shift;
                }
            }
        }
        if seen { TILE_UNITS } else { 2 }
    }

    /// Everything is loaded: turn the unexplored cells into frontier cells and begin to thin the explored ones.
    fn begin_thinning(&mut self) {
        let shape = self.next_frame.shape;
        let per_row = shape.words_per_row();
        let open = self.next.as_flattened_mut();
        let marks = self.next_frontier.as_flattened_mut();
        mark_frontier(open, marks, per_row, shape.rows());
        self.stage = Stage::Thin;
        // The frame fits the box, so the marks suffice (checked at compile time).
        let _ = self.thinning.start(shape, shape.whole());
    }

    /// Go on thinning; true when done and published.
    fn thin(&mut self, budget: u32) -> bool {
        let shape = self.next_frame.shape;
        let keep = self.next_frontier.as_flattened();
        let Ok(mut plane) = PlaneMut::new(shape, self.next.as_flattened_mut()) else {
            return false;
        };
        match self.thinning.advance(&mut plane, keep, budget) {
            Progress::Pending => false,
            Progress::Done { .. } => {
                self.skeleton = self.next;
                self.frame = self.next_frame;
                self.stage = Stage::Load(0);
                true
            }
        }
    }
}

impl<const SLOTS: usize> Default for Topology<SLOTS> {
    fn default() -> Self {
        Self::new()
    }
}

/// Two fine rows (passable, unknown) as one coarse row of explored passable and of unexplored passable cells.
fn coarse(lower: (u32, u32), upper: (u32, u32)) -> [u16; 2] {
    let (one, other) = (lower.1, upper.1);
    let any = (one | one >> 1) & (other | other >> 1);
    let unknown = (one & one >> 1) | (other & other >> 1) | any;
    let passable = lower.0 | upper.0;
    let passable = passable | passable >> 1;
    [even(passable & !unknown), even(passable & unknown)]
}

/// The even bits of a word, packed.
fn even(word: u32) -> u16 {
    let mut bits = word & 0x5555_5555;
    bits = (bits | bits >> 1) & 0x3333_3333;
    bits = (bits | bits >> 2) & 0x0f0f_0f0f;
    bits = (bits | bits >> 4) & 0x00ff_00ff;
    (bits | bits >> 8) as u16
}

/// Turn `marks` from "unexplored" into "explored and beside an unexplored cell", in place.
fn mark_frontier(open: &[u32], marks: &mut [u32], per_row: usize, rows: usize) {
    let mut below = [0u32; crate::grid::MAX_WORDS_PER_ROW];
    for row in 0..rows {
        let mut before = 0;
        for (word, below) in below.iter_mut().enumerate().take(per_row) {
            let index = row * per_row + word;
            let read = |words: &[u32], index: usize| words.get(index).copied().unwrap_or(0);
            let here = read(marks, index);
            let above = if row + 1 < rows {
                read(marks, index + per_row)
            } else {
                0
            };
            let after = if word + 1 < per_row {
                read(marks, index + 1)
            } else {
                0
            };
            let beside = here << 1 | before >> 31 | here >> 1 | after << 31 | *below | above;
            let frontier = beside & read(open, index);
            if let Some(mark) = marks.get_mut(index) {
                *mark = frontier;
            }
            before = here;
            *below = here;
        }
    }
}

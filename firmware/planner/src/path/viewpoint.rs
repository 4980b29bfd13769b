//! Viewpoints: where to stand to see through a gap that the robot does not fit through.
//!
//! A frontier strategy that goes to unexplored cells it can reach leaves what can only be seen: a room behind bars, the floor under
//! a table, the space between two cupboards. When no frontier is within reach, the map is searched for *gaps*: free cells with an
//! unexplored one beside them. From each a ray goes back, away from the unexplored, through free cells, until it meets one
//! that the robot can reach: there it can stand and look along the ray. Of all the gaps that of the least way is taken:
//!
//! ```text
//! gap      free, and unexplored at a side
//! beyond   gap + d, gap + 2 d, … are free, and then five are unexplored      (d nearly along the edge of a shadow)
//! stand    the first reached cell of gap − d, gap − 2 d, …, all free
//! cost     |robot − stand| + |stand − gap|
//! ```
//!
//! None of the four papers has this; their robots leave what they cannot drive to. Done while the robot stands, in lent memory, in
//! instalments of about a million instructions.
//!
//! Units: map cells.

use crate::geometry::{CELL_M, Cell};
use crate::map::tiles::Extent;
use crate::map::{Class, Tiles};
use crate::math;
use crate::roadmap::configuration_space::Footprint;
use crate::roadmap::reachability::Flood;

/// Rays from a gap, all around.
const RAYS: i32 = 64;
/// Unexplored cells that a ray must find at its end, half a metre: less is hardly worth the way.
const LEAST_BEYOND: i32 = 5;
/// Cells that a ray goes on and back at the most: a laser of 8 m sees farther, but little of what is behind.
const MOST_ON: i32 = 30;
const MOST_BACK: i32 = 60;
/// Cells along the side of a block, which is searched at once; a tile has `ALONG` of them along its side.
const BLOCK: i32 = 8;
const ALONG: u16 = 32 / BLOCK as u16;
/// Edge cells that a block must have: gaps narrower than this are left.
const LEAST_EDGE: u32 = 3;
/// Gaps of a block from which rays are sent.
const TRIES: u32 = 4;
/// Tiles loaded in an instalment, sweeps of the flood, and cells that rays go through; those of the last block come on top,
/// `TRIES · RAYS · (MOST_ON + MOST_BACK)` at the most, 23,000.
const TILES_A_STEP: u16 = 40;
const SWEEPS_A_STEP: u32 = 3;
const CELLS_A_STEP: i32 = 20_000;
/// What the edges of a block cost, in cells that rays go through: measured on the chip.
const EDGES_CELLS: i32 = 60;

/// A place to look from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Viewpoint {
    /// Where to stand.
    pub stand: Cell,
    /// The last free cell.
    pub gap: Cell,
    /// An unexplored cell behind it.
    pub beyond: Cell,
}

/// What an instalment of a search says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Found {
    /// Go on with the next instalment.
    Pending,
    /// There is something to see from here.
    Viewpoint(Viewpoint),
    /// Nothing more can be seen.
    Nothing,
}

/// What a search looks at; the same for all its instalments, but for what is measured meanwhile.
#[derive(Debug)]
pub struct Grounds<'a, const TILES: usize, const SLOTS: usize> {
    /// The map.
    pub tiles: &'a Tiles<TILES, SLOTS>,
    /// The robot's disc, and the one it squeezes through with.
    pub discs: [&'a Footprint; 2],
    /// Where the robot stands.
    pub robot: Cell,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Phase {
    #[default]
    Idle,
    /// Tile number n is loaded next.
    Load(u16),
    Flood,
    /// Block number n is searched next.
    Scan(u16),
}

/// A search in progress; what the robot can reach is in the memory that it was begun with.
#[derive(Debug)]
pub struct Search {
    phase: Phase,
    /// The flood found nothing for the robot's own disc: it stands in a narrow place.
    tight: bool,
    /// Least and greatest tile.
    extent: Extent,
    found: bool,
    cost: f32,
    best: Viewpoint,
}

fn distance(a: Cell, b: Cell) -> f32 {
    let (dx, dy) = ((a.x - b.x) as f32, (a.y - b.y) as f32);
    math::sqrt(dx * dx + dy * dy) * CELL_M
}

/// Ray number n: sixteenths of a cell in a step, the longer side a whole one.
const fn ray(number: i32) -> (i32, i32) {
    let slant = number % 16 * 2 - 16;
    match number / 16 {
        0 => (16, slant),
        1 => (-slant, 16),
        2 => (-16, -slant),
        _ => (slant, -16),
    }
}

/// The cell `steps` along a ray.
const fn along(from: Cell, ray: (i32, i32), steps: i32) -> Cell {
    Cell {
        x: (from.x * 16 + 8 + ray.0 * steps) >> 4,
        y: (from.y * 16 + 8 + ray.1 * steps) >> 4,
    }
}

impl Search {
    /// None.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            phase: Phase::Idle,
            tight: false,
            extent: Extent {
                least: (0, 0),
                greatest: (0, 0),
            },
            found: false,
            cost: 0.0,
            best: Viewpoint {
                stand: Cell { x: 0, y: 0 },
                gap: Cell { x: 0, y: 0 },
                beyond: Cell { x: 0, y: 0 },
            },
        }
    }

    /// Whether one was begun and is not over.
    #[must_use]
    pub fn is_running(&self) -> bool {
        self.phase != Phase::Idle
    }

    /// Begin one over what is known, in `scratch` of [`crate::roadmap::reachability::scratch_words`], which must stay as it is left until the
    /// search is over.
    pub fn begin(&mut self, extent: Option<Extent>, scratch: &mut [u32]) {
        *self = Self::new();
        let Some(extent) = extent else {
            return;
        };
        if Flood::new(extent, scratch).is_some() {
            (self.phase, self.extent) = (Phase::Load(0), extent);
        }
    }

    /// Go on; gaps that `is_gone` are passed over.
    pub fn advance<const TILES: usize, const SLOTS: usize>(
        &mut self,
        grounds: &Grounds<'_, TILES, SLOTS>,
        is_gone: impl Fn(Cell) -> bool,
        scratch: &mut [u32],
    ) -> Found {
        let Some(mut flood) = Flood::resume(self.extent, scratch) else {
            self.phase = Phase::Idle;
            return Found::Nothing;
        };
        match self.phase {
            Phase::Idle => return Found::Nothing,
            Phase::Load(tile) => self.load(grounds, &mut flood, tile),
            Phase::Flood => {
                if !(0..SWEEPS_A_STEP).all(|_| flood.sweep()) {
                    self.phase = Phase::Scan(0);
                }
            }
            Phase::Scan(block) => self.scan(grounds, &flood, &is_gone, block),
        }
        match (self.phase, self.found) {
            (Phase::Idle, true) => Found::Viewpoint(self.best),
            (Phase::Idle, false) => Found::Nothing,
            _ => Found::Pending,
        }
    }

    /// Tile number `tile` of the extent.
    fn tile(&self, tile: u16) -> Option<(i32, i32)> {
        let (across, number) = (self.extent.width(), i32::from(tile));
        let (x, y) = (number % across, number / across);
        (y < self.extent.height()).then_some((self.extent.least.0 + x, self.extent.least.1 + y))
    }

    fn load<const TILES: usize, const SLOTS: usize>(
        &mut self,
        grounds: &Grounds<'_, TILES, SLOTS>,
        flood: &mut Flood<'_>,
        first: u16,
    ) {
        let [wide, narrow] = grounds.discs;
        let disc = if self.tight { narrow } else { wide };
        for number in first..first + TILES_A_STEP {
            if let Some(tile) = self.tile(number) {
                flood.load(grounds.tiles, disc, tile);
                continue;
            }
            self.phase = match (flood.start(grounds.robot), self.tight) {
                (true, _) => Phase::Flood,
                (false, false) => Phase::Load(0),
                (false, true) => Phase::Idle,
            };
            self.tight = true;
            return;
        }
        self.phase = Phase::Load(first + TILES_A_STEP);
    }

    fn scan<const TILES: usize, const SLOTS: usize>(
        &mut self,
        grounds: &Grounds<'_, TILES, SLOTS>,
        flood: &Flood<'_>,
        is_gone: &impl Fn(Cell) -> bool,
        first: u16,
    ) {
        let mut left = CELLS_A_STEP;
        let mut number = first;
        while left > 0 {
            let Some((x, y)) = self.tile(number / (ALONG * ALONG)) else {
                self.phase = Phase::Idle;
                return;
            };
            left -= 1;
            if grounds.tiles.is_touched(x, y) {
                let corner = Cell {
                    x: x * 32 + i32::from(number % ALONG) * BLOCK,
                    y: y * 32 + i32::from(number / ALONG % ALONG) * BLOCK,
                };
                left -= EDGES_CELLS + self.scan_block(grounds, flood, is_gone, corner);
            }
            number += 1;
        }
        self.phase = Phase::Scan(number);
    }

    /// Look for gaps in a block, its least cell given; how many cells rays went through.
    fn scan_block<const TILES: usize, const SLOTS: usize>(
        &mut self,
        grounds: &Grounds<'_, TILES, SLOTS>,
        flood: &Flood<'_>,
        is_gone: &impl Fn(Cell) -> bool,
        corner: Cell,
    ) -> i32 {
        let edges = edges(grounds.tiles, corner);
        let count: u32 = edges.iter().map(|row| row.count_ones()).sum();
        if count < LEAST_EDGE {
            return 0;
        }
        let mut walked = 0;
        let apart = count.div_ceil(TRIES) as usize;
        let gaps = cells(&edges, corner).step_by(apart);
        for gap in gaps.filter(|&gap| !is_gone(gap)) {
            if let Some(viewpoint) = look_back(grounds.tiles, flood, gap, &mut walked) {
                self.offer(grounds.robot, viewpoint);
            }
        }
        walked
    }

    fn offer(&mut self, robot: Cell, viewpoint: Viewpoint) {
        let cost = distance(robot, viewpoint.stand) + distance(viewpoint.stand, viewpoint.gap);
        if !self.found || cost < self.cost {
            (self.found, self.cost, self.best) = (true, cost, viewpoint);
        }
    }
}

impl Default for Search {
    fn default() -> Self {
        Self::new()
    }
}

/// Of a block, the free cells with an unexplored one at a side.
fn edges<const TILES: usize, const SLOTS: usize>(
    tiles: &Tiles<TILES, SLOTS>,
    corner: Cell,
) -> [u32; BLOCK as usize] {
    // From the row below the block to the one above it; the block begins at bit 16 of the words.
    let mut reader = tiles.reader(corner.x - 16);
    let rows: [_; BLOCK as usize + 2] =
        core::array::from_fn(|y| reader.row(corner.y + y as i32 - 1));
    let mut edges = [0; BLOCK as usize];
    for (edge, rows) in edges.iter_mut().zip(rows.windows(3)) {
        if let [below, here, above] = rows {
            let unknown = here.unknown();
            let beside = unknown << 1 | unknown >> 1 | below.unknown() | above.unknown();
            *edge = ((here.free() & beside) >> 16) as u32 & ((1 << BLOCK) - 1);
        }
    }
    edges
}

/// The cells of a block's rows.
fn cells(rows: &[u32], corner: Cell) -> impl Iterator<Item = Cell> + '_ {
    rows.iter().enumerate().flat_map(move |(y, &row)| {
        crate::grid::bits::ones(row).map(move |x| Cell {
            x: corner.x + x as i32,
            y: corner.y + y as i32,
        })
    })
}

/// The nearest reached cell from which something unexplored can be seen through a gap.
fn look_back<const TILES: usize, const SLOTS: usize>(
    tiles: &Tiles<TILES, SLOTS>,
    flood: &Flood<'_>,
    gap: Cell,
    walked: &mut i32,
) -> Option<Viewpoint> {
    let mut best: Option<(i32, Viewpoint)> = None;
    for ray in (0..RAYS).map(ray) {
        let Some(beyond) = look_on(tiles, gap, ray, walked) else {
            continue;
        };
        let most = best.map_or(MOST_BACK, |(back, _)| back - 1);
        for back in 0..=most {
            *walked += 1;
            let stand = along(gap, ray, -back);
            if tiles.class(stand) != Class::Free {
                break;
            }
            if flood.is_reached(stand) {
                best = Some((back, Viewpoint { stand, gap, beyond }));
                break;
            }
        }
    }
    best.map(|(_, viewpoint)| viewpoint)
}

/// The middle one of the unexplored cells that a ray ends in, if the map has room for it.
fn look_on<const TILES: usize, const SLOTS: usize>(
    tiles: &Tiles<TILES, SLOTS>,
    gap: Cell,
    ray: (i32, i32),
    walked: &mut i32,
) -> Option<Cell> {
    let is = |class, on| tiles.class(along(gap, ray, on)) == class;
    let first = (1..MOST_ON).find(|&on| !is(Class::Free, on))?;
    *walked += first + 1;
    let dark = first..first + LEAST_BEYOND;
    let middle = along(gap, ray, first + LEAST_BEYOND / 2);
    let has_room = tiles.room(middle.x >> 5, middle.y >> 5).is_ok();
    (has_room && dark.into_iter().all(|on| is(Class::Unknown, on))).then_some(middle)
}

#[cfg(test)]
mod tests;

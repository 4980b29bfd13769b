//! Viewpoints: places from which the robot can see through a gap that it does not fit through.
//!
//! A strategy that drives to unexplored cells leaves what can only be seen: a room behind bars, the
//! floor under a table, the space between two cupboards. When no frontier is within reach, this
//! search looks through the map for *gaps*: free cells with an unexplored one at a side. From each
//! gap a ray leads back, away from the unexplored cells, through free cells, to the first one that
//! the robot can reach. There the robot can stand and look along the ray. The gap of the greatest
//! utility wins, as among frontiers ([`crate::path::utility`]):
//!
//! ```text
//! gap      free, with an unexplored cell at a side
//! beyond   gap + d, gap + 2 d, … are free, then five are unexplored     (d: along a shadow's edge)
//! stand    the first reached cell of gap − d, gap − 2 d, …, all free
//! cost     |robot − stand| + |stand − gap|
//! gain     unexplored, seen from the stand, in the quarter of all directions towards beyond
//! ```
//!
//! None of the four papers has this; their robots leave what they cannot drive to. The search runs
//! while the robot stands, in instalments of one to three million instructions.
//!
//! Units: map cells.

mod look;

use crate::geometry::Cell;
use crate::grid::Tiling;
use crate::map::Tiles;
use crate::path::blocked_passages::BlockedPassages;
use crate::path::gain::View;
use crate::path::residual_frontiers::ResidualFrontiers;
use crate::path::utility::{GoalOrder, utility};
use crate::roadmap::configuration_space::Footprint;
use crate::roadmap::flooding::Flooding;
use crate::roadmap::reachability::Reachability;
use crate::roadmap::skeleton::Frame;
use look::look_back;

/// Side of a block, cells. A block is searched at once.
const BLOCK: i32 = 8;
/// Blocks along a tile's side.
const ALONG: u16 = 32 / BLOCK as u16;
/// Minimum number of gap cells in a block: narrower gaps are left.
const LEAST_EDGE: u32 = 3;
/// Gaps of a block from which rays start.
const TRIES: u32 = 4;
/// Limit of an instalment after the flood, cells on rays. With more cells a step takes too long
/// (measured: docs/MEASURED.md, "Instalments of a search for viewpoints"). The last block may add
/// [`MOST_OVER`] cells and a gap's: `RAYS · (MOST_ON + MOST_BACK)` = 6,000.
const CELLS_PER_STEP: i32 = 20_000;
/// The same within a fence, which is asked for the unexplored cells at a ray's end.
const FENCED_CELLS_PER_STEP: i32 = 10_000;
/// Cells on rays by which a block may exceed an instalment. Beyond them the next one goes on at the
/// block's next gap.
const MOST_OVER: i32 = 6_000;
/// Cost of finding a block's gaps, in cells on rays: measured on the chip.
const EDGES_CELLS: i32 = 60;
/// Cost of a gap's gain, in cells on rays.
const GAIN_CELLS: i32 = 600;

/// A place to look from, and what for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Viewpoint {
    /// Where the robot stands.
    pub(crate) stand: Cell,
    /// The gap: the last free cell.
    pub(crate) gap: Cell,
    /// An unexplored cell behind the gap.
    pub(crate) beyond: Cell,
}

/// The result of an instalment of a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Found {
    /// The search needs another instalment.
    Pending,
    /// The best viewpoint.
    Viewpoint(Viewpoint),
    /// Nothing more can be seen.
    Nothing,
}

/// The inputs of a search. They are the same for all its instalments, except for what the map
/// learns meanwhile.
#[derive(Debug)]
pub(crate) struct Inputs<'a, const TILES: usize, const SLOTS: usize> {
    /// The map.
    pub(crate) tiles: &'a Tiles<TILES, SLOTS>,
    /// The tiles that are searched, and their place.
    pub(crate) tiling: Tiling<'a>,
    pub(crate) frame: Frame,
    /// The robot's disc, which has room to turn, and the footprint that paths are planned for.
    pub(crate) footprints: [&'a Footprint; 2],
    /// Where the robot stands.
    pub(crate) robot: Cell,
    /// Passages that the robot could not drive through.
    pub(crate) blocked: &'a BlockedPassages,
    /// The order in which viewpoints are taken.
    pub(crate) order: GoalOrder<'a>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Phase {
    #[default]
    Idle,
    Flood,
    /// Searches block number n next, from the gap with the second number on.
    Scan(u16, u8),
}

/// A search in progress. Its scratch memory holds what the robot can reach.
#[derive(Debug)]
pub(crate) struct Search {
    phase: Phase,
    flooding: Flooding,
    /// The robot's disc reaches nothing: it stands in a narrow place.
    tight: bool,
    found: bool,
    score: f32,
    best: Viewpoint,
}

impl Search {
    /// Makes a search that is over.
    pub(crate) const fn new() -> Self {
        Self {
            phase: Phase::Idle,
            flooding: Flooding::FIRST,
            tight: false,
            found: false,
            score: 0.0,
            best: Viewpoint {
                stand: Cell { x: 0, y: 0 },
                gap: Cell { x: 0, y: 0 },
                beyond: Cell { x: 0, y: 0 },
            },
        }
    }

    /// Returns true if the search needs another instalment.
    pub(crate) fn is_running(&self) -> bool {
        self.phase != Phase::Idle
    }

    /// Begins a search. Its first instalment may come later: until then others may use the scratch
    /// memory.
    pub(crate) fn begin(&mut self) {
        (self.phase, self.flooding) = (Phase::Flood, Flooding::FIRST);
        (self.tight, self.found) = (false, false);
    }

    /// Runs an instalment. Gaps that were given up do not count; those that are not worth the trip
    /// are listed. `scratch` needs
    /// [`scratch_words`](crate::roadmap::reachability::scratch_words) words, which must keep their
    /// values from the first instalment to the last.
    pub(crate) fn advance<const TILES: usize, const SLOTS: usize>(
        &mut self,
        inputs: &Inputs<'_, TILES, SLOTS>,
        residual: &mut ResidualFrontiers,
        scratch: &mut [u32],
    ) -> Found {
        let Some(mut reachability) = Reachability::resume(inputs.frame, inputs.tiling, scratch)
        else {
            self.phase = Phase::Idle;
            return Found::Nothing;
        };
        match self.phase {
            Phase::Idle => return Found::Nothing,
            Phase::Flood => self.flood(inputs, &mut reachability),
            Phase::Scan(block, gap) => {
                self.scan(inputs, &reachability, residual, (block, gap));
            }
        }
        match (self.phase, self.found) {
            (Phase::Idle, true) => Found::Viewpoint(self.best),
            (Phase::Idle, false) => Found::Nothing,
            _ => Found::Pending,
        }
    }

    fn flood<const TILES: usize, const SLOTS: usize>(
        &mut self,
        inputs: &Inputs<'_, TILES, SLOTS>,
        reachability: &mut Reachability<'_>,
    ) {
        let [wide, narrow] = inputs.footprints;
        let footprint = if self.tight { narrow } else { wide };
        let start = |reachability: &mut Reachability<'_>| {
            inputs.blocked.close(inputs.robot, reachability);
            reachability.start(inputs.robot)
        };
        self.flooding
            .advance(inputs.tiles, footprint, reachability, start);
        match (self.flooding, self.tight) {
            (Flooding::Over, _) => self.phase = Phase::Scan(0, 0),
            (Flooding::Tight, true) => self.phase = Phase::Idle,
            (Flooding::Tight, false) => (self.tight, self.flooding) = (true, Flooding::FIRST),
            (Flooding::Load(_) | Flooding::Spread, _) => {}
        }
    }

    fn scan<const TILES: usize, const SLOTS: usize>(
        &mut self,
        inputs: &Inputs<'_, TILES, SLOTS>,
        reachability: &Reachability<'_>,
        residual: &mut ResidualFrontiers,
        (first, mut gap): (u16, u8),
    ) {
        let mut left = match inputs.tiles.fence().is_empty() {
            true => CELLS_PER_STEP,
            false => FENCED_CELLS_PER_STEP,
        };
        let mut number = first;
        while left > 0 {
            let place = usize::from(number / (ALONG * ALONG));
            let Some(&key) = inputs.tiling.keys().get(place) else {
                self.phase = Phase::Idle;
                return;
            };
            let corner = inputs.frame.cell(key.least()).offset(
                i32::from(number % ALONG) * BLOCK,
                i32::from(number / ALONG % ALONG) * BLOCK,
            );
            left -= EDGES_CELLS;
            let edges = edges(inputs.tiles, corner);
            gap = self.scan_block(
                inputs,
                reachability,
                residual,
                (&edges, corner),
                (gap, &mut left),
            );
            number += u16::from(gap == 0);
        }
        self.phase = Phase::Scan(number, gap);
    }

    /// Looks back from a block's gaps, from the one with number `first` on, and takes the cells on
    /// rays from `left`. Returns the number of the gap to go on with; 0 if there is none.
    fn scan_block<const TILES: usize, const SLOTS: usize>(
        &mut self,
        inputs: &Inputs<'_, TILES, SLOTS>,
        reachability: &Reachability<'_>,
        residual: &mut ResidualFrontiers,
        (edges, corner): (&[u32], Cell),
        (first, left): (u8, &mut i32),
    ) -> u8 {
        let count: u32 = edges.iter().map(|row| row.count_ones()).sum();
        if count < LEAST_EDGE {
            return 0;
        }
        let apart = count.div_ceil(TRIES) as usize;
        let gaps = (0..).zip(cells(edges, corner).step_by(apart));
        for (number, gap) in gaps.skip(first.into()) {
            if *left < -MOST_OVER {
                return number;
            }
            if residual.is_given_up(gap) || !self.may_win(inputs, gap) {
                continue;
            }
            let mut walked = 0;
            let viewpoint = look_back(inputs.tiles, reachability, gap, &mut walked);
            *left -= walked;
            if let Some(viewpoint) = viewpoint {
                *left -= GAIN_CELLS;
                self.offer(inputs, residual, viewpoint);
            }
        }
        0
    }

    /// Returns true if a viewpoint of a gap may be better than the best so far: its trip is no
    /// shorter than the straight way to the gap.
    fn may_win<const TILES: usize, const SLOTS: usize>(
        &self,
        inputs: &Inputs<'_, TILES, SLOTS>,
        gap: Cell,
    ) -> bool {
        let least_m = inputs.robot.distance_m(gap);
        !self.found || utility(inputs.order.most_value(), least_m) > self.score
    }

    /// Takes a viewpoint if it is the best so far; leaves its gap if that is not worth the trip.
    fn offer<const TILES: usize, const SLOTS: usize>(
        &mut self,
        inputs: &Inputs<'_, TILES, SLOTS>,
        residual: &mut ResidualFrontiers,
        viewpoint: Viewpoint,
    ) {
        let Viewpoint { stand, gap, beyond } = viewpoint;
        let trip_m = inputs.robot.distance_m(stand) + stand.distance_m(gap);
        let view = View::of(
            inputs.tiles,
            stand,
            inputs.order.tuning.gain_m,
            inputs.footprints[0].reach(),
        );
        let gain_m2 = view.gain_towards_m2((beyond.x - stand.x, beyond.y - stand.y));
        if !inputs.order.is_worth(gain_m2, trip_m) {
            residual.list_not_worth_it(gap, 1);
            return;
        }
        let score = utility(inputs.order.value(gain_m2), trip_m);
        if !self.found || score > self.score {
            (self.found, self.score, self.best) = (true, score, viewpoint);
        }
    }
}

/// Returns the free cells of a block that have an unexplored one at a side.
fn edges<const TILES: usize, const SLOTS: usize>(
    tiles: &Tiles<TILES, SLOTS>,
    corner: Cell,
) -> [u32; BLOCK as usize] {
    // From the row below the block to the one above it. The block begins at bit 16 of the words.
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

/// Returns the cells of a block's rows.
fn cells(rows: &[u32], corner: Cell) -> impl Iterator<Item = Cell> + '_ {
    rows.iter().enumerate().flat_map(move |(y, &row)| {
        crate::grid::bits::ones(row).map(move |x| Cell {
            x: corner.x + x as i32,
            y: corner.y + y as i32,
        })
    })
}

#[cfg(test)]
mod tests;

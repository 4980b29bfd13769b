//! The map of one particle: an occupancy grid in tiles that copies share until one of them writes.
//!
//! ```text
//! evidence   0 unseen;   hit: +3, at most 15;   passed: −1, at least 1;   8 before the first
//!            wall from 10 on, free up to 7
//! ```
//!
//! Each cell also keeps the mean place of the hits in it, since a wall crosses a cell of 10 cm
//! anywhere. A cell that is as free as can be is not written again, so its tile stays shared.
//!
//! Invariant: what one copy writes, no other copy sees.
//! Units: metres; cells of 10 cm.

use std::sync::Arc;

use super::scan::Scan;
use crate::replay::relations::Pose;

/// Cells on a tile's side.
const SIDE: i32 = 16;
/// Side of a cell, metres.
pub(super) const CELL_M: f64 = 0.1;
/// Evidence of a cell before its first beam.
const UNDECIDED: u8 = 8;
/// Least evidence of a wall.
const WALL: u8 = 10;
/// Greatest evidence of free space.
const FREE: u8 = 7;
/// Evidence of a beam's end.
const HIT: u8 = 3;
/// Greatest evidence.
const MOST: u8 = 15;
/// Hits that a mean remembers: a wall seen a hundred times can still move.
const REMEMBERED: u8 = 20;
/// Way before a beam's end that it does not free: a wall met at a low angle lies in it, metres.
const GUARD_M: f64 = 0.3;
/// Every so many beams a beam frees the cells it crosses: neighbours cross the same ones.
const FREES_EVERY: usize = 5;

/// Evidence of a cell, and the mean place of its hits in 1/255 of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Cell {
    evidence: u8,
    hits: u8,
    mean: [u8; 2],
}

impl Cell {
    const fn is_wall(self) -> bool {
        self.evidence >= WALL
    }

    const fn is_known(self) -> bool {
        self.is_wall() || (self.evidence > 0 && self.evidence <= FREE)
    }

    /// Evidence to which a beam adds.
    const fn counted(self) -> u8 {
        if self.evidence == 0 {
            UNDECIDED
        } else {
            self.evidence
        }
    }

    fn pass(&mut self) {
        self.evidence = (self.counted() - 1).max(1);
        if self.evidence <= FREE {
            self.hits = 0;
        }
    }

    /// Takes a hit at a place in the cell, 0 to 1.
    fn hit(&mut self, place: [f64; 2]) {
        self.evidence = (self.counted() + HIT).min(MOST);
        let hits = f64::from(self.hits.min(REMEMBERED));
        for (mean, new) in self.mean.iter_mut().zip(place) {
            let sum = f64::from(*mean) / 255.0 * hits + new;
            *mean = (sum / (hits + 1.0) * 255.0).round() as u8;
        }
        self.hits = self.hits.saturating_add(1);
    }
}

type Tile = [Cell; (SIDE * SIDE) as usize];

/// An occupancy grid over a rectangle. What lies outside has no cell.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Grid {
    /// Least tile.
    least: [i32; 2],
    /// Tiles along each axis.
    size: [i32; 2],
    tiles: Vec<Option<Arc<Tile>>>,
}

impl Grid {
    /// Makes an empty grid over a rectangle: least x, least y, greatest x, greatest y, metres.
    pub(super) fn over([x0, y0, x1, y1]: [f64; 4]) -> Self {
        let tile = |m: f64| floor(m / CELL_M).div_euclid(SIDE);
        let least = [tile(x0), tile(y0)];
        let size = [tile(x1) - least[0] + 1, tile(y1) - least[1] + 1].map(|tiles| tiles.max(1));
        Self {
            least,
            size,
            tiles: vec![None; (size[0] * size[1]) as usize],
        }
    }

    /// Enters a scan from a pose of the robot.
    pub(super) fn enter(&mut self, robot: Pose, scan: &Scan) {
        let frame = Frame::of(robot);
        let origin = frame.point(scan.origin);
        for (number, beam) in scan.beams.iter().enumerate() {
            let end = frame.point(beam.end);
            if number % FREES_EVERY == 0 {
                self.pass(origin, end, if beam.hit { GUARD_M } else { 0.0 });
            }
            if beam.hit {
                self.hit(end);
            }
        }
    }

    /// Frees the cells on the way from one point to another but the last `guard_m`.
    fn pass(&mut self, from: [f64; 2], to: [f64; 2], guard_m: f64) {
        let [dx, dy] = [to[0] - from[0], to[1] - from[1]];
        let length_m = (dx * dx + dy * dy).sqrt();
        let steps = ((length_m - guard_m).max(0.0) / CELL_M) as u32;
        let mut last = None;
        for step in 0..steps {
            let along = f64::from(step) * CELL_M / length_m;
            let at = cell_at([from[0] + along * dx, from[1] + along * dy]);
            if last != Some(at) {
                self.free(at);
                last = Some(at);
            }
        }
    }

    fn free(&mut self, at: [i32; 2]) {
        let Some(tile) = self.slot(at) else {
            return;
        };
        let tile = tile.get_or_insert_with(empty);
        if tile[within(at)].evidence != 1 {
            Arc::make_mut(tile)[within(at)].pass();
        }
    }

    fn hit(&mut self, point: [f64; 2]) {
        let at = cell_at(point);
        let place = [0, 1].map(|axis| point[axis] / CELL_M - f64::from(at[axis]));
        if let Some(tile) = self.slot(at) {
            Arc::make_mut(tile.get_or_insert_with(empty))[within(at)].hit(place);
        }
    }

    /// Returns the mean hit nearest to a point, of the walls in the 3 × 3 cells around it, and the
    /// square of its distance; `None` if there is no wall.
    pub(super) fn nearest(&self, point: [f64; 2]) -> Option<([f64; 2], f64)> {
        let [x, y] = cell_at(point);
        // Inside of a tile one look-up serves all nine cells.
        let is_inner = |at: i32| (1..SIDE - 1).contains(&(at & (SIDE - 1)));
        let shared = (is_inner(x) && is_inner(y)).then(|| self.tile([x, y]));
        if shared == Some(None) {
            return None;
        }
        let mut best: Option<([f64; 2], f64)> = None;
        for cy in y - 1..=y + 1 {
            for cx in x - 1..=x + 1 {
                let tile = shared.unwrap_or_else(|| self.tile([cx, cy]));
                let Some(cell) = tile.map(|tile| tile[within([cx, cy])]) else {
                    continue;
                };
                if !cell.is_wall() {
                    continue;
                }
                let [mx, my] = cell.mean.map(|mean| f64::from(mean) / 255.0);
                let hit = [(f64::from(cx) + mx) * CELL_M, (f64::from(cy) + my) * CELL_M];
                let [dx, dy] = [hit[0] - point[0], hit[1] - point[1]];
                let square = dx * dx + dy * dy;
                if best.is_none_or(|(_, least)| square < least) {
                    best = Some((hit, square));
                }
            }
        }
        best
    }

    /// Returns true if a beam has told of the cell at a point.
    pub(super) fn is_seen(&self, point: [f64; 2]) -> bool {
        let at = cell_at(point);
        self.tile(at)
            .is_some_and(|tile| tile[within(at)].evidence > 0)
    }

    /// Returns the number of cells that are free or wall.
    pub(super) fn known(&self) -> usize {
        let tiles = self.tiles.iter().flatten();
        tiles
            .map(|tile| tile.iter().filter(|cell| cell.is_known()).count())
            .sum()
    }

    /// Returns the address of each tile, to count those that grids share.
    pub(super) fn addresses(&self) -> impl Iterator<Item = usize> {
        let tiles = self.tiles.iter().flatten();
        tiles.map(|tile| Arc::as_ptr(tile) as usize)
    }

    /// Bytes of a tile.
    pub(super) const TILE_BYTES: usize = size_of::<Tile>();

    /// Returns the bytes of the list of tiles, which each grid has for itself.
    pub(super) const fn list_bytes(&self) -> usize {
        self.tiles.len() * size_of::<Option<Arc<Tile>>>()
    }

    fn index(&self, [x, y]: [i32; 2]) -> Option<usize> {
        let column = x.div_euclid(SIDE) - self.least[0];
        let row = y.div_euclid(SIDE) - self.least[1];
        let is_in = |at: i32, size: i32| (0..size).contains(&at);
        (is_in(column, self.size[0]) && is_in(row, self.size[1]))
            .then_some((row * self.size[0] + column) as usize)
    }

    fn tile(&self, at: [i32; 2]) -> Option<&Tile> {
        self.tiles.get(self.index(at)?)?.as_deref()
    }

    fn slot(&mut self, at: [i32; 2]) -> Option<&mut Option<Arc<Tile>>> {
        let index = self.index(at)?;
        self.tiles.get_mut(index)
    }
}

/// A pose with the sine and cosine of its heading.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    x_m: f64,
    y_m: f64,
    sin: f64,
    cos: f64,
}

impl Frame {
    pub(super) fn of([x_m, y_m, yaw]: Pose) -> Self {
        Self {
            x_m,
            y_m,
            sin: libm::sin(yaw),
            cos: libm::cos(yaw),
        }
    }

    /// Returns a point of the pose's frame in the map.
    pub(super) fn point(&self, point: [f64; 2]) -> [f64; 2] {
        let [x, y] = self.direction(point);
        [self.x_m + x, self.y_m + y]
    }

    /// Returns a direction of the pose's frame in the map.
    pub(super) fn direction(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.cos * x - self.sin * y, self.sin * x + self.cos * y]
    }
}

fn empty() -> Arc<Tile> {
    Arc::new([Cell::default(); (SIDE * SIDE) as usize])
}

fn cell_at([x, y]: [f64; 2]) -> [i32; 2] {
    [floor(x / CELL_M), floor(y / CELL_M)]
}

/// Returns the greatest whole number that is no greater than `x`.
fn floor(x: f64) -> i32 {
    let whole = x as i32;
    whole - i32::from(x < f64::from(whole))
}

/// Returns the index of a cell in its tile.
const fn within([x, y]: [i32; 2]) -> usize {
    (((y & (SIDE - 1)) * SIDE) | (x & (SIDE - 1))) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::slam::particles::scan::Beam;

    fn scan(ends: &[[f64; 2]], hit: bool) -> Scan {
        let beam = |&end: &[f64; 2]| Beam {
            end,
            hit,
            normal: None,
        };
        Scan {
            origin: [0.0, 0.0],
            beams: ends.iter().map(beam).collect(),
        }
    }

    const BOUNDS: [f64; 4] = [-4.0, -4.0, 4.0, 4.0];

    #[test]
    fn a_beam_frees_its_way_and_marks_its_end() {
        let mut grid = Grid::over(BOUNDS);
        grid.enter([0.0, 0.05, 0.0], &scan(&[[2.03, 0.0]], true));
        assert!(grid.is_seen([1.0, 0.05]) && !grid.is_seen([1.0, 0.15]));
        let (hit, square) = grid.nearest([2.0, 0.0]).expect("a wall");
        assert!((hit[0] - 2.03).abs() < 1e-3 && (hit[1] - 0.05).abs() < 1e-3);
        assert!((square - (0.03_f64.powi(2) + 0.05_f64.powi(2))).abs() < 1e-4);
        assert_eq!(grid.nearest([1.5, 0.05]), None);
        // 17 cells of the way but the guard, and the end.
        assert_eq!(grid.known(), 18);
    }

    #[test]
    fn a_beam_without_a_return_marks_no_wall() {
        let mut grid = Grid::over(BOUNDS);
        grid.enter([0.0, 0.05, 0.0], &scan(&[[2.03, 0.0]], false));
        assert_eq!(grid.nearest([2.0, 0.05]), None);
        assert_eq!(grid.known(), 20);
    }

    #[test]
    fn copies_share_tiles_until_one_writes() {
        let mut one = Grid::over(BOUNDS);
        // The first seven beams decide the cells of the way.
        for _ in 0..10 {
            one.enter([0.0, 0.05, 0.0], &scan(&[[3.0, 0.0]], true));
        }
        let (mut other, before) = (one.clone(), one.clone());
        let shared = |a: &Grid, b: &Grid| {
            a.addresses()
                .filter(|it| b.addresses().any(|b| b == *it))
                .count()
        };
        assert_eq!(shared(&one, &other), 2);
        // Cells that are as free as can be are not written.
        other.enter([0.0, 0.05, 0.0], &scan(&[[1.2, 0.0]], false));
        assert_eq!(shared(&one, &other), 2);
        other.enter([0.0, 0.05, 0.0], &scan(&[[1.2, 0.0]], true));
        assert_eq!(shared(&one, &other), 1);
        assert_eq!(one, before);
        assert_ne!(one, other);
    }

    #[test]
    fn a_scan_that_leaves_the_rectangle_enters_what_lies_in_it() {
        let mut grid = Grid::over(BOUNDS);
        grid.enter([3.0, 0.05, 0.0], &scan(&[[90.0, 0.0], [-90.0, 0.0]], true));
        assert!(grid.is_seen([3.9, 0.05]) && !grid.is_seen([20.0, 0.05]));
        assert_eq!(grid.nearest([93.0, 0.05]), None);
    }

    #[test]
    fn the_mean_of_hits_is_within_a_step_of_the_true_mean() {
        let mut cell = Cell::default();
        for place in [0.2, 0.4, 0.9] {
            cell.hit([place, 0.5]);
        }
        assert!((f64::from(cell.mean[0]) / 255.0 - 0.5).abs() < 0.01);
        for _ in 0..14 {
            cell.pass();
        }
        assert_eq!((cell.evidence, cell.hits), (1, 0));
    }
}

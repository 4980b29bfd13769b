//! A grid of what some scans met: evidence that a cell is occupied, and the mean place of the hits.
//!
//! ```text
//! evidence   hit +3, pass −1, in 1..=15;   0 unknown, at least 10 occupied, at most 7 free
//! ```
//!
//! The mean place of the hits in a cell is what a scan is aligned to: it lies within the scans'
//! own noise of the wall, where the middle of the cell is off by up to half a cell.
//!
//! The grid is a square of `SIDE` cells, a power of two, around the place that it was cleared for.
//! What lies beyond is left out.
//!
//! Units: cells of [`CELL_M`]; metres where a name says so.

use crate::pose::{Pose, sin_cos, sqrt};
use crate::scan::{Beam, Scan};

/// Side of a cell, metres.
pub(crate) const CELL_M: f32 = 0.1;
/// Least evidence of an occupied cell.
const OCCUPIED: u8 = 10;
/// Greatest evidence of a free cell.
const FREE: u8 = 7;
/// Evidence between the two: where a cell begins.
const BEGIN: u8 = 8;
/// Greatest evidence.
const MOST: u8 = 15;
/// A hit's weight.
const HIT: u8 = 3;
/// Hits that a mean remembers.
const REMEMBERED: u8 = 20;
/// A beam frees cells up to so far before its end, metres.
const GUARD_M: f32 = 0.3;
/// Cells to each side in which the hits of a line are looked for.
const AROUND: i32 = 2;
/// Hits lie on a line if their variance across it is a smaller share of that along it.
const LINE: f32 = 0.1;
/// Every so many beams free the cells that they cross.
const FREE_STRIDE: usize = 4;

/// A cell.
#[derive(Clone, Copy, Debug, Default)]
struct Evidence {
    count: u8,
    hits: u8,
    /// Mean place of the hits in the cell, 255ths.
    mean: [u8; 2],
}

/// The grid. `SIDE` is a power of two.
#[derive(Clone, Debug)]
pub struct Grid<const SIDE: usize> {
    cells: [[Evidence; SIDE]; SIDE],
    origin: (i32, i32),
}

/// Returns the cell of a coordinate.
pub(crate) fn cell(at_m: f32) -> i32 {
    libm::floorf(at_m / CELL_M) as i32
}

impl<const SIDE: usize> Grid<SIDE> {
    /// Returns an empty grid around (0, 0).
    #[must_use]
    pub fn new() -> Self {
        const { assert!(SIDE.is_power_of_two(), "a row wraps by a mask") };
        Self {
            cells: [[Evidence {
                count: 0,
                hits: 0,
                mean: [0; 2],
            }; SIDE]; SIDE],
            origin: (0, 0),
        }
    }

    /// Empties the grid, and puts a place into its middle.
    pub(crate) fn clear(&mut self, middle: &Pose) {
        self.cells.as_flattened_mut().fill(Evidence::default());
        let half = SIDE as i32 / 2;
        self.origin = (cell(middle.x_m) - half, cell(middle.y_m) - half);
    }

    fn get(&self, x: i32, y: i32) -> Option<&Evidence> {
        let (column, row) = self.place(x, y)?;
        self.cells.get(row)?.get(column)
    }

    fn get_mut(&mut self, x: i32, y: i32) -> Option<&mut Evidence> {
        let (column, row) = self.place(x, y)?;
        self.cells.get_mut(row)?.get_mut(column)
    }

    fn place(&self, x: i32, y: i32) -> Option<(usize, usize)> {
        let place = |at: i32| usize::try_from(at).ok().filter(|&at| at < SIDE);
        place(x.wrapping_sub(self.origin.0)).zip(place(y.wrapping_sub(self.origin.1)))
    }

    /// Returns true if a cell is occupied.
    pub(crate) fn is_occupied(&self, x: i32, y: i32) -> bool {
        self.get(x, y).is_some_and(|it| it.count >= OCCUPIED)
    }

    fn pass(&mut self, x: i32, y: i32) {
        if let Some(it) = self.get_mut(x, y) {
            let count = if it.count == 0 { BEGIN } else { it.count };
            it.count = (count - 1).max(1);
            if it.count <= FREE {
                it.hits = 0;
            }
        }
    }

    fn hit(&mut self, [x_m, y_m]: [f32; 2]) {
        let (x, y) = (cell(x_m), cell(y_m));
        let parts = [(x_m, x), (y_m, y)].map(|(at_m, cell)| at_m / CELL_M - cell as f32);
        if let Some(it) = self.get_mut(x, y) {
            let count = if it.count == 0 { BEGIN } else { it.count };
            it.count = (count + HIT).min(MOST);
            let hits = f32::from(it.hits.min(REMEMBERED));
            for (mean, part) in it.mean.iter_mut().zip(parts) {
                let sum = f32::from(*mean) / 255.0 * hits + part;
                *mean = libm::roundf(sum / (hits + 1.0) * 255.0) as u8;
            }
            it.hits = it.hits.saturating_add(1);
        }
    }

    /// Enters a scan taken at a pose.
    pub(crate) fn enter<const BEAMS: usize>(&mut self, pose: &Pose, scan: &Scan<BEAMS>) {
        for (k, beam) in scan.beams.iter().enumerate() {
            if k % FREE_STRIDE == 0 {
                self.free_along(pose.point(beam.origin), pose.point(beam.end), beam);
            }
        }
        for beam in scan.hits() {
            self.hit(pose.point(beam.end));
        }
    }

    /// Frees the cells along a beam, up to a guard before its end.
    fn free_along(&mut self, from: [f32; 2], to: [f32; 2], beam: &Beam) {
        let along = [to[0] - from[0], to[1] - from[1]];
        let length_m = sqrt(along[0] * along[0] + along[1] * along[1]);
        let guard_m = if beam.hit { GUARD_M } else { 0.0 };
        let steps = ((length_m - guard_m) / CELL_M).max(0.0) as usize;
        let mut last = None;
        for k in 0..steps {
            let part = k as f32 * CELL_M / length_m;
            let here = (
                cell(from[0] + part * along[0]),
                cell(from[1] + part * along[1]),
            );
            if last != Some(here) {
                self.pass(here.0, here.1);
                last = Some(here);
            }
        }
    }

    /// Returns the mean hit nearest to a point in the 3 × 3 cells around it, and its squared
    /// distance; metres, square metres.
    pub(crate) fn nearest(&self, [x_m, y_m]: [f32; 2]) -> Option<([f32; 2], f32)> {
        let (x, y) = (cell(x_m), cell(y_m));
        let mut best: Option<([f32; 2], f32)> = None;
        for (cx, cy) in (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (x + dx, y + dy))) {
            let Some(it) = self.get(cx, cy).filter(|it| it.count >= OCCUPIED) else {
                continue;
            };
            let [u, v] = it.mean.map(|mean| f32::from(mean) / 255.0);
            let mean = [(cx as f32 + u) * CELL_M, (cy as f32 + v) * CELL_M];
            let (dx, dy) = (mean[0] - x_m, mean[1] - y_m);
            let distance2 = dx * dx + dy * dy;
            if best.is_none_or(|(_, least)| distance2 < least) {
                best = Some((mean, distance2));
            }
        }
        best
    }
}

impl<const SIDE: usize> Grid<SIDE> {
    /// Returns the normal of the line on which the mean hits around a point lie; `None` if they lie
    /// on none.
    pub(crate) fn normal(&self, [x_m, y_m]: [f32; 2]) -> Option<[f32; 2]> {
        let (x, y) = (cell(x_m), cell(y_m));
        let (mut count, mut sum, mut squares) = (0.0, [0.0; 2], [0.0; 3]);
        let cells = (-AROUND..=AROUND).flat_map(|dy| (-AROUND..=AROUND).map(move |dx| (dx, dy)));
        for (dx, dy) in cells {
            let Some(it) = self.get(x + dx, y + dy) else {
                continue;
            };
            if it.count >= OCCUPIED {
                let [u, v] = it.mean.map(|mean| f32::from(mean) / 255.0);
                let (u, v) = (dx as f32 + u, dy as f32 + v);
                count += 1.0;
                sum = [sum[0] + u, sum[1] + v];
                squares = [squares[0] + u * u, squares[1] + u * v, squares[2] + v * v];
            }
        }
        if count < 3.0 {
            return None;
        }
        let (u, v) = (sum[0] / count, sum[1] / count);
        let xx = squares[0] / count - u * u;
        let xy = squares[1] / count - u * v;
        let yy = squares[2] / count - v * v;
        let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
        let spread = sqrt(half * half + xy * xy);
        let (least, most) = (mean - spread, mean + spread);
        // The direction across: that of the least variance.
        let across = if half > 0.0 {
            [-xy, half + spread]
        } else {
            [spread - half, -xy]
        };
        let length = sqrt(across[0] * across[0] + across[1] * across[1]);
        (least < LINE * most && length > 0.0).then(|| across.map(|it| it / length))
    }
}

impl<const SIDE: usize> Default for Grid<SIDE> {
    fn default() -> Self {
        Self::new()
    }
}

/// A pose with its turn, for many points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    pub(crate) x_m: f32,
    pub(crate) y_m: f32,
    sin: f32,
    cos: f32,
}

impl Frame {
    pub(crate) fn of(pose: &Pose) -> Self {
        let (sin, cos) = sin_cos(pose.yaw_rad);
        Self {
            x_m: pose.x_m,
            y_m: pose.y_m,
            sin,
            cos,
        }
    }

    /// Returns a vector of the pose's frame.
    pub(crate) fn turn(&self, [x, y]: [f32; 2]) -> [f32; 2] {
        [self.cos * x - self.sin * y, self.sin * x + self.cos * y]
    }

    /// Returns a point of the pose's frame.
    pub(crate) fn point(&self, point: [f32; 2]) -> [f32; 2] {
        let [x, y] = self.turn(point);
        [self.x_m + x, self.y_m + y]
    }
}

#[cfg(test)]
mod tests {
    use super::Grid;
    use crate::pose::Pose;
    use crate::scan::{Beam, Scan};

    /// A scan of one beam that ends 2 m ahead.
    fn ahead() -> Scan<4> {
        let beam = Beam {
            origin: [0.0; 2],
            end: [2.04, 0.02],
            hit: true,
            normal: None,
        };
        let mut scan = Scan::default();
        scan.beams.push(beam).unwrap();
        scan
    }

    #[test]
    fn a_hit_is_occupied_where_it_lies_and_the_way_there_is_free() {
        let mut grid: Grid<64> = Grid::new();
        let pose = Pose {
            x_m: 100.0,
            y_m: -50.0,
            yaw_rad: 0.0,
        };
        grid.clear(&pose);
        grid.enter(&pose, &ahead());
        assert!(grid.is_occupied(1020, -500) && !grid.is_occupied(1010, -500));
        let (mean, distance2) = grid.nearest([102.1, -50.0]).unwrap();
        assert!(
            (mean[0] - 102.04).abs() < 1e-3 && (mean[1] + 49.98).abs() < 1e-3,
            "{mean:?}"
        );
        assert!((distance2 - 0.004).abs() < 1e-3);
        assert!(grid.nearest([101.5, -50.0]).is_none());
        // Five beams through the cell free it again.
        let mut through = ahead();
        through.beams[0].end = [3.0, 0.03];
        (0..5).for_each(|_| grid.enter(&pose, &through));
        assert!(!grid.is_occupied(1020, -500));
    }

    #[test]
    fn hits_on_a_line_have_its_normal_and_those_of_a_corner_none() {
        let mut grid: Grid<64> = Grid::new();
        grid.clear(&Pose::default());
        let mut line = |from: f32, to: f32, at: &dyn Fn(f32) -> [f32; 2]| {
            let mut k = from;
            while k < to {
                grid.hit(at(k));
                k += 0.05;
            }
        };
        line(-2.0, 2.0, &|k| [k, 1.02 + 0.5 * k]);
        line(-2.9, -2.0, &|k| [k, -2.0]);
        line(-2.9, -2.0, &|k| [-2.0, k]);
        let [x, y] = grid.normal([0.0, 1.0]).unwrap();
        let along = (x * 2.0 + y * 1.0).abs() / 5.0_f32.sqrt();
        assert!(along < 0.1, "the normal stands on the line: {x} {y}");
        let [x, y] = grid.normal([-2.5, -2.0]).unwrap();
        assert!(x.abs() < 0.1 && y.abs() > 0.9, "{x} {y}");
        assert_eq!(grid.normal([-2.0, -2.0]), None, "a corner");
        assert_eq!(grid.normal([2.5, -2.5]), None, "nothing");
    }

    #[test]
    fn what_lies_beyond_the_grid_is_left_out() {
        let mut grid: Grid<16> = Grid::new();
        grid.clear(&Pose::default());
        grid.enter(&Pose::default(), &ahead());
        assert!(!grid.is_occupied(20, 0) && grid.nearest([2.0, 0.0]).is_none());
    }
}

//! What a ray meets first: a wall, its top, or the ground.
//!
//! Walls are columns over the solid cells, `wall_height` above the ground at the cell's centre, and endless outside of the
//! map. They are found by a [`Walk`] through the grid that jumps over the empty disc around it, which the distance
//! field knows. The ground is the plane z = 0, or the bilinear patches of an [`Elevation`], where
//! `z(t) − ground(t)` is a parabola in t.
//!
//! Units: metres; the direction is a unit vector.

use super::distance::DistanceField;
use super::elevation::Elevation;
use super::occupancy::{GridCell, Occupancy};
use super::walk::Walk;

/// A half line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it begins: x, y, z in metres.
    pub origin_m: [f64; 3],
    /// Where it goes: a unit vector.
    pub direction: [f64; 3],
}

/// What was met.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Surface {
    /// The side of a wall.
    Wall,
    /// The top of a wall.
    Top,
    /// The ground.
    Ground,
}

/// Where a ray ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Metres along the ray.
    pub range_m: f64,
    /// What was met.
    pub surface: Surface,
}

/// Code of a solid cell in [`Walls::free_cells`].
const SOLID: u8 = u8::MAX;
/// Free cells around from which on a jump is cheaper than steps.
const JUMP_CELLS: u8 = 3;

/// The walls, prepared for rays: a grid with a solid border of one cell.
#[derive(Clone, Debug)]
pub(super) struct Walls {
    stride: i64,
    rows: i64,
    resolution_m: f64,
    /// Corner of the border, metres.
    origin_m: [f64; 2],
    /// [`SOLID`], or whole cells that are free around any point of the cell.
    free_cells: Vec<u8>,
}

impl Walls {
    pub(super) fn new(grid: &Occupancy, distance: &DistanceField) -> Self {
        let resolution_m = grid.resolution_m();
        let (stride, rows) = (grid.width() as i64 + 2, grid.height() as i64 + 2);
        let mut free_cells = Vec::with_capacity((stride * rows) as usize);
        for j in -1..rows - 1 {
            for i in -1..stride - 1 {
                let cell = GridCell { i, j };
                free_cells.push(if grid.is_solid(cell) {
                    SOLID
                } else {
                    (distance.from_anywhere_m(cell) / resolution_m).min(f64::from(SOLID - 1)) as u8
                });
            }
        }
        Self {
            stride,
            rows,
            resolution_m,
            origin_m: grid.origin_m().map(|m| m - resolution_m),
            free_cells,
        }
    }

    /// The first wall within `limit_m`. `top_m` tells how high the wall on a cell stands.
    pub(super) fn cast(
        &self,
        ray: &Ray,
        limit_m: f64,
        top_m: impl Fn(GridCell) -> f64,
    ) -> Option<Hit> {
        let start = [0, 1].map(|k| (ray.origin_m[k] - self.origin_m[k]) / self.resolution_m);
        let speed = [0, 1].map(|k| ray.direction[k] / self.resolution_m);
        let cells_per_m = (speed[0] * speed[0] + speed[1] * speed[1]).sqrt();
        let m_per_cell = 1.0 / cells_per_m.max(1e-9);
        let mut walk = Walk::new(start, speed);
        while walk.entered_m <= limit_m {
            let free = self.free_cells(walk.cell);
            if free == SOLID {
                let hit = self.column(ray, &walk, &top_m);
                if let Some(hit) = hit {
                    return (hit.range_m <= limit_m).then_some(hit);
                }
                walk.advance();
            } else if free >= JUMP_CELLS {
                walk.jump(walk.entered_m + f64::from(free) * m_per_cell);
            } else {
                walk.advance();
            }
        }
        None
    }

    #[inline(always)]
    fn free_cells(&self, cell: [i64; 2]) -> u8 {
        if (0..self.stride).contains(&cell[0]) && (0..self.rows).contains(&cell[1]) {
            self.free_cells[(cell[1] * self.stride + cell[0]) as usize]
        } else {
            SOLID
        }
    }

    /// Where the ray meets the column over the walk's cell, if it does not pass above.
    fn column(&self, ray: &Ray, walk: &Walk, top_m: impl Fn(GridCell) -> f64) -> Option<Hit> {
        let top_m = top_m(GridCell {
            i: walk.cell[0] - 1,
            j: walk.cell[1] - 1,
        });
        let height_m = |at_m: f64| ray.origin_m[2] + ray.direction[2] * at_m;
        if height_m(walk.entered_m) <= top_m {
            return Some(Hit {
                range_m: walk.entered_m,
                surface: Surface::Wall,
            });
        }
        let fall_m = (top_m - ray.origin_m[2]) / ray.direction[2];
        (ray.direction[2] < 0.0 && fall_m < walk.left_m()).then_some(Hit {
            range_m: fall_m,
            surface: Surface::Top,
        })
    }
}

/// Where a ray meets the plane z = 0.
pub(super) fn plane(ray: &Ray) -> Option<Hit> {
    let range_m = if ray.origin_m[2] <= 0.0 {
        0.0
    } else if ray.direction[2] < 0.0 {
        -ray.origin_m[2] / ray.direction[2]
    } else {
        return None;
    };
    Some(Hit {
        range_m,
        surface: Surface::Ground,
    })
}

/// Where a ray meets the ground of an elevation, within `limit_m`.
pub(super) fn ground(elevation: &Elevation, ray: &Ray, limit_m: f64) -> Option<Hit> {
    let (resolution_m, origin_m) = (elevation.resolution_m(), elevation.origin_m());
    // Patches lie between the samples, which sit at the centres of the pixels.
    let start = [0, 1].map(|k| (ray.origin_m[k] - origin_m[k]) / resolution_m - 0.5);
    let speed = [0, 1].map(|k| ray.direction[k] / resolution_m);
    let last = [elevation.width() as i64, elevation.height() as i64];
    let mut walk = Walk::new(start, speed);
    while walk.entered_m <= limit_m {
        if (0..2).any(|k| walk.cell[k] < -1 || walk.cell[k] >= last[k]) {
            return None;
        }
        let corners = elevation.patch(walk.cell[0], walk.cell[1]);
        let left_m = walk.left_m().min(limit_m);
        let place = [0, 1].map(|k| start[k] - walk.cell[k] as f64);
        if let Some(range_m) = patch(corners, ray, (place, speed), (walk.entered_m, left_m)) {
            return Some(Hit {
                range_m,
                surface: Surface::Ground,
            });
        }
        if left_m >= limit_m {
            return None;
        }
        walk.advance();
    }
    None
}

/// First t in [from, to] at which a ray is on or below a bilinear patch.
///
/// Along the ray, at `place + speed t` in the patch's unit square, the ground is `a + b t + c t²`.
fn patch(
    [low_left, low_right, high_left, high_right]: [f64; 4],
    ray: &Ray,
    (place, speed): ([f64; 2], [f64; 2]),
    (from, to): (f64, f64),
) -> Option<f64> {
    let across = low_right - low_left;
    let up = high_left - low_left;
    let twist = low_left - low_right - high_left + high_right;
    let [x, y] = place;
    let [u, v] = speed;
    // Height of the ray above the ground: a + b t + c t².
    let a = ray.origin_m[2] - (low_left + across * x + up * y + twist * x * y);
    let b = ray.direction[2] - (across * u + up * v + twist * (x * v + y * u));
    let c = -twist * u * v;
    if a.is_nan() {
        return None;
    }
    let above = |t: f64| a + t * (b + t * c);
    if above(from) <= 0.0 {
        return Some(from);
    }
    first_root(a, b, c, from).filter(|t| *t <= to)
}

/// Least root of a + b t + c t² that is greater than `from`.
fn first_root(a: f64, b: f64, c: f64, from: f64) -> Option<f64> {
    if c == 0.0 {
        return (b < 0.0).then(|| -a / b).filter(|t| *t > from);
    }
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        return None;
    }
    // The stable pair of roots: no difference of nearly equal numbers.
    let q = -0.5 * (b + discriminant.sqrt().copysign(b));
    let roots = [q / c, if q == 0.0 { q / c } else { a / q }];
    roots
        .into_iter()
        .filter(|t| *t > from)
        .min_by(f64::total_cmp)
}

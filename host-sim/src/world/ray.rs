//! The first hit of a ray: a wall, its top, or the ground. This file has the walls,
//! [`super::ground_ray`] has the ground.
//!
//! Walls are columns over the solid cells. They stand `wall_height` above the ground at the cell's
//! centre, and they are infinitely high outside of the map. A [`GridTraversal`] finds them; it
//! jumps over the empty disc around it, which the distance field knows.
//!
//! Metres; the direction is a unit vector.

use super::distance::DistanceField;
use super::occupancy::{GridCell, Occupancy};
use super::traversal::GridTraversal;

/// A half line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Its start: x, y, z in metres.
    pub origin_m: [f64; 3],
    /// Its direction: a unit vector.
    pub direction: [f64; 3],
}

#[cfg(test)]
impl Ray {
    /// A ray along a direction of any length.
    pub(super) fn towards(origin_m: [f64; 3], direction: [f64; 3]) -> Self {
        let length = direction.iter().map(|d| d * d).sum::<f64>().sqrt();
        Self {
            origin_m,
            direction: direction.map(|d| d / length),
        }
    }
}

/// The kind of surface that a ray hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Surface {
    /// The side of a wall.
    Wall,
    /// The top of a wall.
    Top,
    /// The ground.
    Ground,
}

/// The end of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Metres along the ray.
    pub range_m: f64,
    /// The surface at its end.
    pub surface: Surface,
}

/// Code of a solid cell in [`Walls::free_cells`].
const SOLID: u8 = u8::MAX;
/// Number of free cells around from which a jump is cheaper than single steps.
const JUMP_CELLS: u8 = 3;

/// The walls in a form for rays: a grid with a solid border of one cell.
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

    /// The first wall within `limit_m`. `top_m` gives the height of the wall's top on a cell.
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
        let mut traversal = GridTraversal::new(start, speed);
        while traversal.entered_m <= limit_m {
            let free = self.free_cells(traversal.cell);
            if free == SOLID {
                let hit = self.column(ray, &traversal, &top_m);
                if let Some(hit) = hit {
                    return (hit.range_m <= limit_m).then_some(hit);
                }
                traversal.advance();
            } else if free >= JUMP_CELLS {
                traversal.jump(traversal.entered_m + f64::from(free) * m_per_cell);
            } else {
                traversal.advance();
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

    /// The hit on the column over the current cell, if the ray does not pass above it.
    fn column(
        &self,
        ray: &Ray,
        traversal: &GridTraversal,
        top_m: impl Fn(GridCell) -> f64,
    ) -> Option<Hit> {
        let top_m = top_m(GridCell {
            i: traversal.cell[0] - 1,
            j: traversal.cell[1] - 1,
        });
        let height_m = |at_m: f64| ray.origin_m[2] + ray.direction[2] * at_m;
        if height_m(traversal.entered_m) <= top_m {
            return Some(Hit {
                range_m: traversal.entered_m,
                surface: Surface::Wall,
            });
        }
        let fall_m = (top_m - ray.origin_m[2]) / ray.direction[2];
        (ray.direction[2] < 0.0 && fall_m < traversal.left_m()).then_some(Hit {
            range_m: fall_m,
            surface: Surface::Top,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::World;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::{Rng, SeedableRng};

    #[test]
    fn rays_hit_sides_tops_ground_and_the_border() {
        // A wall of 0.5 m at x in [1, 1.5), 1.5 m high, in a world of 3 × 0.5 m.
        let world = World::picture("wall", 0.5, &["..#..."]);
        let met = |origin, direction| {
            let hit = world.cast(&Ray::towards(origin, direction), 12.0);
            hit.map(|hit| ((hit.range_m * 1e9).round() / 1e9, hit.surface))
        };
        let (start, high) = ([0.25, 0.25, 0.4], [0.25, 0.25, 2.0]);
        assert_eq!(met(start, [1.0, 0.0, 0.0]), Some((0.75, Surface::Wall)));
        assert_eq!(met(start, [-1.0, 0.0, 0.0]), Some((0.25, Surface::Wall)));
        // Over the wall, and on to the border, which is infinitely high.
        assert_eq!(met(high, [1.0, 0.0, 0.0]), Some((2.75, Surface::Wall)));
        assert_eq!(met(high, [0.0, 0.0, 1.0]), None);
        assert_eq!(met(start, [0.0, 0.0, -1.0]), Some((0.4, Surface::Ground)));
        // From above, down by 0.5 m over 1 m: the top.
        let slant = (1.25_f64).sqrt();
        let top = met(high, [1.0, 0.0, -0.5]).expect("meets the top");
        assert_eq!(top.1, Surface::Top);
        assert!((top.0 - slant).abs() < 1e-9, "{top:?}");
        // From inside of something solid the range is 0.
        assert_eq!(
            met([1.2, 0.2, 0.4], [1.0, 0.0, 0.0]),
            Some((0.0, Surface::Wall))
        );
        assert_eq!(
            met([-5.0, 0.2, 0.4], [1.0, 0.0, 0.0]),
            Some((0.0, Surface::Wall))
        );
    }

    #[test]
    fn a_jump_and_steps_hit_the_wall_at_the_same_bits() {
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        let mut grid = Occupancy::filled(90, 70, 0.05, [-1.3, 2.2], crate::world::Class::Free);
        for _ in 0..12 {
            let (i, j) = (rng.next_u32() % 90, rng.next_u32() % 70);
            let cell = GridCell {
                i: i.into(),
                j: j.into(),
            };
            grid.set(cell, crate::world::Class::Wall);
        }
        let distance = DistanceField::new(&grid);
        let jumping = Walls::new(&grid, &distance);
        let mut stepping = jumping.clone();
        for free in &mut stepping.free_cells {
            *free = if *free == SOLID { SOLID } else { 0 };
        }
        for k in 0..20_000 {
            let bearing = f64::from(k) * 0.001;
            let beam = Ray::towards([0.7, 3.9, 0.4], [bearing.cos(), bearing.sin(), 0.0]);
            let [a, b] = [&jumping, &stepping].map(|walls| walls.cast(&beam, 12.0, |_| 1.5));
            assert_eq!(a, b, "bearing {bearing}");
        }
    }
}

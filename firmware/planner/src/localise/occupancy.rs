//! The map as a field that is 1 at the centre of an obstacle cell and falls to 0 within a cell.
//!
//! ```text
//! m(x, y) = (1 − v) ((1 − u) m₀₀ + u m₁₀) + v ((1 − u) m₀₁ + u m₁₁)      bilinear
//! ∇m = ((1 − v)(m₁₀ − m₀₀) + v (m₁₁ − m₀₁), (1 − u)(m₀₁ − m₀₀) + u (m₁₁ − m₁₀))
//! mᵢⱼ = 1 in an obstacle that stands or a landmark, 0 elsewhere
//! u, v: from the centre of the cell (0, 0)
//! ```
//!
//! Within a cell of a straight wall `1 − m` is the distance to its middle in cells. It is the
//! residual of a beam that ends there \[Kohlbrecher11, eqs. 4–6\].
//!
//! Units: map cells.

use crate::geometry::Cell;
use crate::map::neighbourhood::Neighbourhood;
use crate::math;

/// The field at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Occupancy {
    /// Its value, 0 to 1.
    pub(super) value: f32,
    /// Its gradient.
    pub(super) gradient: (f32, f32),
}

/// Returns the field at a place; `None` without an obstacle or a landmark within a cell.
pub(super) fn occupancy<const TILES: usize, const SLOTS: usize>(
    near: &mut Neighbourhood<'_, TILES, SLOTS>,
    (x, y): (f32, f32),
) -> Option<Occupancy> {
    let corner = Cell {
        x: math::floor(x - 0.5),
        y: math::floor(y - 0.5),
    };
    let square = near.obstacles_and_landmarks_from(corner);
    if square == 0 {
        return None;
    }
    let (u, v) = (x - 0.5 - corner.x as f32, y - 0.5 - corner.y as f32);
    let at = |bit: u32| (square >> bit & 1) as f32;
    let (low, high) = ((at(0), at(1)), (at(2), at(3)));
    let between = |(a, b): (f32, f32), t: f32| a + t * (b - a);
    Some(Occupancy {
        value: between((between(low, u), between(high, u)), v),
        gradient: (
            between((low.1 - low.0, high.1 - high.0), v),
            between((high.0 - low.0, high.1 - low.1), u),
        ),
    })
}

#[cfg(test)]
mod tests {
    use std::boxed::Box;

    use super::occupancy;
    use crate::geometry::Cell;
    use crate::grid::Class;
    use crate::map::Tiles;
    use crate::map::neighbourhood::Neighbourhood;

    fn tiles(obstacles: impl Fn(i32, i32) -> bool) -> Box<Tiles<16, 64>> {
        let mut tiles = Box::new(Tiles::<16, 64>::new());
        tiles.reset();
        for (x, y) in (-40..40).flat_map(|x| (-40..40).map(move |y| (x, y))) {
            let class = if obstacles(x, y) {
                Class::Obstacle
            } else {
                Class::Free
            };
            tiles.set(Cell { x, y }, class).expect("room");
        }
        tiles
    }

    #[test]
    fn beside_a_wall_the_residual_is_the_distance_to_its_middle() {
        let tiles = tiles(|x, _| x == 7);
        let mut near = Neighbourhood::of(&tiles);
        for k in 0..20_u8 {
            let off = f32::from(k) / 10.0 - 0.95;
            let found = occupancy(&mut near, (7.5 + off, -3.2)).expect("near");
            assert!((1.0 - found.value - off.abs()).abs() < 1e-5);
            assert!((found.gradient.0 + off.signum()).abs() < 1e-5);
            assert!(found.gradient.1.abs() < 1e-5);
        }
        assert_eq!(occupancy(&mut near, (8.6, 0.0)), None);
    }

    /// The field is continuous, and its gradient is its slope: any cells, across borders of tiles.
    #[test]
    fn the_gradient_is_the_slope() {
        let tiles = tiles(|x, y| (x * 7 + y * 13 + x * y) % 5 == 0);
        let value =
            |x, y| occupancy(&mut Neighbourhood::of(&tiles), (x, y)).map_or(0.0, |it| it.value);
        for k in 0..3000_u16 {
            let (x, y) = (
                f32::from(k % 61) * 0.617 - 33.3,
                f32::from(k / 61) * 0.713 - 34.1,
            );
            let Some(found) = occupancy(&mut Neighbourhood::of(&tiles), (x, y)) else {
                continue;
            };
            let near = |dx: f32, dy: f32| (value(x + dx, y + dy) - value(x - dx, y - dy)) / 0.02;
            let (slope_x, slope_y) = (near(0.01, 0.0), near(0.0, 0.01));
            let is_inside = |it: f32| ((it - 0.5) - (it - 0.5).floor() - 0.5).abs() < 0.48;
            if is_inside(x) && is_inside(y) {
                assert!((found.gradient.0 - slope_x).abs() < 2e-3, "{x} {y}");
                assert!((found.gradient.1 - slope_y).abs() < 2e-3, "{x} {y}");
            }
        }
    }
}

//! Gain: the unexplored area that the robot may see from a place, within some metres.
//!
//! Rays lead from the place through free and unexplored cells up to the first closed one. A cell k
//! along a ray stands for k · w cells of the square around the place, where w is the spacing of the
//! slopes:
//!
//! ```text
//! x = k, y = k · s   ⇒   dx dy = k dk ds        gain = Σ rays Σ k [unexplored] · k · w
//! ```
//!
//! So no cell counts twice, and no cell needs a mark. What lies behind unexplored cells is taken
//! for visible.
//!
//! A place is *open* if the robot may drive from it in a straight line to an unexplored cell at the
//! end of its reach. How much is unexplored beyond cannot be told. Most gaps that a robot does not
//! fit through are pieces of a wall that were not seen yet, so they make no place open.
//!
//! Units: map cells, square metres.

use crate::geometry::{CELL_M, Cell};
use crate::grid::at;
use crate::map::Tiles;
use crate::path::rays::{RAYS, RAYS_A_SIDE, along, ray};

/// Greatest length of a ray, cells: half a row of the map's reader.
const MOST_REACH: i32 = 31;
/// Side of the square of cells around the place.
const SIDE: usize = 2 * MOST_REACH as usize + 1;
/// The place in its square.
const MIDDLE: Cell = Cell {
    x: MOST_REACH,
    y: MOST_REACH,
};

/// A square of cells, a bit each.
type Square = [u64; SIDE];

/// What is around a place.
pub(crate) struct View {
    unknown: Square,
    closed: Square,
    /// Length of the rays, cells.
    reach: i32,
}

impl View {
    /// Reads the map around a cell, up to `reach_m` metres.
    pub(crate) fn of<const TILES: usize, const SLOTS: usize>(
        tiles: &Tiles<TILES, SLOTS>,
        from: Cell,
        reach_m: f32,
    ) -> Self {
        let mut reader = tiles.reader(from.x - MOST_REACH);
        let (mut unknown, mut closed) = ([0; SIDE], [0; SIDE]);
        for (y, (unknown, closed)) in unknown.iter_mut().zip(&mut closed).enumerate() {
            let row = reader.row(from.y - MOST_REACH + y as i32);
            (*unknown, *closed) = (row.unknown(), row.obstacle());
        }
        Self {
            unknown,
            closed,
            reach: ((reach_m / CELL_M) as i32).min(MOST_REACH),
        }
    }

    /// Returns the unexplored area that may be seen, square metres.
    pub(crate) fn gain_m2(&self) -> f32 {
        self.along_m2((0..RAYS).map(ray))
    }

    /// Returns the unexplored area that may be seen in the quarter of all directions around this
    /// one, square metres.
    pub(crate) fn gain_towards_m2(&self, (dx, dy): (i32, i32)) -> f32 {
        let is_ahead = move |ray: &(i32, i32)| {
            let along = ray.0 * dx + ray.1 * dy;
            let across = ray.0 * dy - ray.1 * dx;
            along > across.abs()
        };
        self.along_m2((0..RAYS).map(ray).filter(is_ahead))
    }

    /// Returns true if the place is open for a robot that keeps its centre so many cells from every
    /// obstacle.
    pub(crate) fn is_open(&self, clearance: i32) -> bool {
        let mut closed = self.closed;
        for _ in 0..clearance {
            widen(&mut closed);
        }
        let is_open = |ray| {
            holds(&self.unknown, along(MIDDLE, ray, self.reach))
                && !(1..=self.reach).any(|k| holds(&closed, along(MIDDLE, ray, k)))
        };
        (0..RAYS).map(ray).any(is_open)
    }

    /// Returns the unexplored area along these rays, square metres.
    fn along_m2(&self, rays: impl Iterator<Item = (i32, i32)>) -> f32 {
        let mut cells = 0;
        for ray in rays {
            let way = (1..=self.reach).map(|k| (k, along(MIDDLE, ray, k)));
            for (k, cell) in way.take_while(|&(_, cell)| !holds(&self.closed, cell)) {
                cells += i32::from(holds(&self.unknown, cell)) * k;
            }
        }
        cells as f32 * (2.0 * CELL_M * CELL_M / RAYS_A_SIDE as f32)
    }
}

/// Returns true if a square holds a cell.
fn holds(square: &Square, cell: Cell) -> bool {
    at(square, cell.y as usize) >> cell.x & 1 == 1
}

/// Sets the eight neighbours of every set cell.
fn widen(square: &mut Square) {
    let mut below = 0;
    let mut here = across(at(square, 0));
    for y in 0..SIDE {
        let above = across(at(square, y + 1));
        if let Some(row) = square.get_mut(y) {
            *row = below | here | above;
        }
        (below, here) = (here, above);
    }
}

/// Sets the neighbours of every set cell in a row.
const fn across(row: u64) -> u64 {
    row | row << 1 | row >> 1
}

#[cfg(test)]
mod tests {
    use std::boxed::Box;

    use super::View;
    use crate::geometry::{CELL_M, Cell};
    use crate::map::{Class, Tiles};

    const ORIGIN: Cell = Cell { x: 0, y: 0 };

    type Map = Box<Tiles<64, 64>>;

    /// A map of 20 × 20 m with these classes; `None` is unexplored.
    fn map(class: impl Fn(i32, i32) -> Option<Class>) -> Map {
        let mut tiles = Map::default();
        tiles.reset();
        for (x, y) in (-100..100).flat_map(|x| (-100..100).map(move |y| (x, y))) {
            if let Some(class) = class(x, y) {
                tiles.set(Cell { x, y }, class).expect("room");
            }
        }
        tiles
    }

    fn view(tiles: &Map) -> View {
        View::of(tiles, ORIGIN, 3.0)
    }

    /// The unexplored area within reach, square metres, if nothing closes it.
    fn unexplored_m2(class: impl Fn(i32, i32) -> Option<Class>) -> f32 {
        let cells = (-30..=30).flat_map(|x| (-30..=30).map(move |y| (x, y)));
        let count = cells.filter(|&(x, y)| class(x, y).is_none()).count();
        count as f32 * CELL_M * CELL_M
    }

    fn is_about(a_m2: f32, b_m2: f32) -> bool {
        (a_m2 - b_m2).abs() < 0.06 * b_m2 + 0.2
    }

    #[test]
    fn in_the_open_the_gain_is_the_unexplored_area_within_reach() {
        let half_free = |x: i32, _: i32| (x <= 0).then_some(Class::Free);
        let patch = |x: i32, y: i32| {
            let is_patch = (5..15).contains(&x) && (-3..10).contains(&y);
            (!is_patch).then_some(Class::Free)
        };
        let all: [&dyn Fn(i32, i32) -> Option<Class>; 3] = [&|_, _| None, &half_free, &patch];
        for class in all {
            let (gain_m2, area_m2) = (view(&map(class)).gain_m2(), unexplored_m2(class));
            assert!(is_about(gain_m2, area_m2), "{gain_m2} of {area_m2}");
        }
    }

    #[test]
    fn behind_an_obstacle_nothing_is_gained() {
        let wall = |x: i32, _: i32| match x {
            10 => Some(Class::Obstacle),
            x if x < 10 => Some(Class::Free),
            _ => None,
        };
        let view = view(&map(wall));
        assert_eq!(view.gain_m2(), 0.0);
        assert!(!view.is_open(0));
    }

    /// What is seen of a wall at x = 10 with a gap of so many cells.
    fn gap(cells: i32) -> View {
        view(&map(|x, y| match x {
            10 => (!(-cells / 2..cells - cells / 2).contains(&y)).then_some(Class::Obstacle),
            x if x < 10 => Some(Class::Free),
            _ => None,
        }))
    }

    #[test]
    fn a_place_is_open_if_the_robot_fits_through_what_is_in_front_of_it() {
        for (cells, clearance) in [(1, 0), (4, 2), (7, 3), (8, 3)] {
            let fits = cells > 2 * clearance;
            assert_eq!(gap(cells).is_open(clearance), fits, "{cells} cells");
            assert!(gap(cells).gain_m2() > 0.0, "{cells} cells");
        }
        assert!(gap(16).gain_m2() > gap(8).gain_m2());
    }

    #[test]
    fn a_place_whose_unexplored_cells_end_within_reach_is_not_open() {
        let pocket = |x: i32, y: i32| {
            let is_pocket = (5..15).contains(&x) && (-3..10).contains(&y);
            (!is_pocket).then_some(Class::Free)
        };
        let view = view(&map(pocket));
        assert!(view.gain_m2() > 0.5 && !view.is_open(0));
    }

    #[test]
    fn a_quarter_of_the_directions_has_a_quarter_of_the_gain() {
        let view = view(&map(|_, _| None));
        let all_m2 = view.gain_m2();
        for towards in [(7, 0), (-7, 0), (0, 9), (5, -5)] {
            let quarter_m2 = view.gain_towards_m2(towards);
            // Towards a corner the quarter of the square is the same area as towards a side.
            assert!(
                is_about(4.0 * quarter_m2, all_m2),
                "{towards:?}: {quarter_m2}"
            );
        }
    }
}

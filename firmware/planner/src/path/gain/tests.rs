//! Gains of places in small maps, and views against a walk cell by cell.

use std::boxed::Box;
use std::vec::Vec;

use super::View;
use crate::geometry::{CELL_M, Cell};
use crate::grid::bits::tests::{Rng, get};
use crate::map::{Class, Tiles};
use crate::path::rays::{RAYS, RAYS_A_SIDE, along, ray};

pub(super) const ORIGIN: Cell = Cell { x: 0, y: 0 };

pub(super) type Map = Box<Tiles<64, 64>>;

/// A map of 20 × 20 m with these classes; `None` is unexplored.
pub(super) fn map(class: impl Fn(i32, i32) -> Option<Class>) -> Map {
    let mut tiles = Map::default();
    tiles.reset();
    for (x, y) in (-100..100).flat_map(|x| (-100..100).map(move |y| (x, y))) {
        if let Some(class) = class(x, y) {
            tiles.set(Cell { x, y }, class).expect("room");
        }
    }
    tiles
}

/// The view of a robot that keeps so many cells from obstacles.
fn seen(tiles: &Map, clearance: i32) -> View {
    View::of(tiles, ORIGIN, 3.0, clearance)
}

fn view(tiles: &Map) -> View {
    seen(tiles, 0)
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

/// What a view says, computed cell by cell: gain in all directions, gain towards one.
fn slowly(tiles: &Map, reach: i32, clearance: i32, towards: (i32, i32)) -> (f32, f32) {
    let is = |cell, class| tiles.class(cell) == class;
    // A view knows no more than its square, and a column beside it.
    let is_in_view = |cell: Cell| (-31..=32).contains(&cell.x) && cell.y.abs() <= 31;
    let is_near = |at: Cell| {
        let side = -clearance..=clearance;
        let mut around = side
            .clone()
            .flat_map(|y| side.clone().map(move |x| at.offset(x, y)));
        around.any(|cell| is_in_view(cell) && is(cell, Class::Obstacle))
    };
    let (mut all, mut ahead) = (0, 0);
    for ray in (0..RAYS).map(ray) {
        let way: Vec<Cell> = (1..=reach).map(|k| along(ORIGIN, ray, k)).collect();
        let end = way.iter().position(|&cell| is(cell, Class::Obstacle));
        let (mut sum, mut depth, mut most) = (0, 0, i32::MAX);
        let mut cut = 0;
        for (&cell, k) in way.iter().take(end.unwrap_or(way.len())).zip(1..) {
            if !is(cell, Class::Unknown) {
                (depth, cut) = (0, 0);
                continue;
            }
            if depth == 0 {
                most = if is_near(cell) {
                    2 * clearance + 1
                } else {
                    i32::MAX
                };
            }
            depth += 1;
            sum += k;
            cut += if depth > most { k } else { 0 };
        }
        if end.is_none() {
            sum -= cut;
        }
        all += sum;
        let (forward, aside) = (
            ray.0 * towards.0 + ray.1 * towards.1,
            ray.0 * towards.1 - ray.1 * towards.0,
        );
        ahead += if forward > aside.abs() { sum } else { 0 };
    }
    let cell_m2 = 2.0 * CELL_M * CELL_M / RAYS_A_SIDE as f32;
    (all as f32 * cell_m2, ahead as f32 * cell_m2)
}

#[test]
fn a_view_is_what_a_walk_cell_by_cell_finds() {
    let mut rng = Rng(7);
    let mut narrow = 0;
    for round in 0..60 {
        // Obstacles in one of 8 to of 4,096 cells; half planes, strips or specks unexplored.
        let closed: [u64; 64] = rng.rows(3 + round % 10);
        let specks: [u64; 64] = rng.rows(1 + round % 4);
        let map = map(|x, y| {
            let has = |rows: &[u64; 64]| get(rows, (x + 32) & 63, (y + 32) & 63);
            let is_unknown = match round % 3 {
                0 => 2 * x + y > 9,
                1 => x & 8 == 0 || y > 5,
                _ => has(&specks),
            };
            let class = if has(&closed) {
                Class::Obstacle
            } else {
                Class::Free
            };
            (!is_unknown || (has(&closed) && x & 1 == 0)).then_some(class)
        });
        for (reach, clearance) in [(30, 3), (30, 0), (31, 4), (12, 1)] {
            let view = View::of(&map, ORIGIN, (reach as f32 + 0.5) * CELL_M, clearance);
            let (towards, whole) = ((7, -3), slowly(&map, reach, clearance, (7, -3)));
            let fast = (view.gain_m2(), view.gain_towards_m2(towards));
            assert_eq!(fast, whole, "round {round}, reach {reach}");
            narrow += u32::from(whole.0 < slowly(&map, reach, 0, towards).0);
        }
    }
    assert!(narrow > 20, "{narrow} narrow");
}

/// Eight free tiles up to x = 0, and none beyond: a pool of 8 has no page for another one.
#[test]
fn what_the_map_has_no_room_for_counts_nothing() {
    fn tiles<const TILES: usize>() -> Box<Tiles<TILES, 64>> {
        let mut tiles = Box::<Tiles<TILES, 64>>::default();
        tiles.reset();
        for (x, y) in (-64..0).flat_map(|x| (-64..64).map(move |y| (x, y))) {
            tiles.set(Cell { x, y }, Class::Free).expect("room");
        }
        // A beam asks for a tile more.
        let more = tiles.set(Cell { x: 3, y: 3 }, Class::Unknown);
        assert_eq!(more.is_err(), TILES == 8);
        tiles
    }
    let gain_m2 = |view: View| view.gain_m2();
    let at = Cell { x: -4, y: 3 };
    let (full, roomy) = (tiles::<8>(), tiles::<9>());
    assert!(gain_m2(View::of(&*roomy, at, 3.0, 3)) > 10.0);
    assert_eq!(gain_m2(View::of(&*full, at, 3.0, 3)), 0.0);
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
    assert_eq!(view(&map(wall)).gain_m2(), 0.0);
}

/// What is seen of a wall at x = 10 with a gap of so many cells.
fn gap(cells: i32, clearance: i32) -> View {
    let map = map(|x, y| match x {
        10 => (!(-cells / 2..cells - cells / 2).contains(&y)).then_some(Class::Obstacle),
        x if x < 10 => Some(Class::Free),
        _ => None,
    });
    seen(&map, clearance)
}

#[test]
fn a_wide_gap_promises_more_than_a_narrow_one() {
    let gains = [1, 8, 16].map(|cells| gap(cells, 3).gain_m2());
    assert!(gains.is_sorted_by(|a, b| 0.0 < *a && a < b), "{gains:?}");
}

#[test]
fn a_gap_that_the_robot_does_not_fit_through_promises_no_more_than_its_own_depth() {
    let (narrow, wide) = (gap(5, 3).gain_m2(), gap(5, 0).gain_m2());
    assert!(narrow > 0.1 && 2.0 * narrow < wide, "{narrow} {wide}");
    // A far side that was seen bounds the area, so all of it counts.
    let pocket = |x: i32, y: i32| match (x, y) {
        (10, -2..=2) => None,
        (10, _) | (20, _) => Some(Class::Obstacle),
        (11..20, _) => None,
        _ => Some(Class::Free),
    };
    let [narrow, wide] = [3, 0].map(|clearance| seen(&map(pocket), clearance).gain_m2());
    assert!(is_about(narrow, wide), "{narrow} {wide}");
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

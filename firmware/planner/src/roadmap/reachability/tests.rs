//! Cells that can be reached, drawn as pictures.

use std::boxed::Box;
use std::collections::BTreeSet;
use std::vec;
use std::vec::Vec;

use super::{Reachability, scratch_words};
use crate::geometry::Cell;
use crate::grid::Tiling;
use crate::map::{Class, Tiles};
use crate::roadmap::configuration_space::Footprint;
use crate::roadmap::skeleton::Frame;

type Map = Tiles<12, 12>;

/// A random map over tiles that touch each other in many ways, with many dead ends.
fn scattered(seed: &mut u32) -> Box<Map> {
    let mut random = || {
        *seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        *seed >> 16
    };
    let mut tiles = Box::new(Map::new());
    tiles.reset();
    let places = [
        (0, 0),
        (1, 0),
        (2, 0),
        (2, 1),
        (0, 1),
        (-1, 2),
        (0, 2),
        (2, -1),
        (3, 2),
    ];
    for (column, row) in places {
        for k in 0..16 * 16 {
            let class = match random() % 8 {
                0..2 => Class::Obstacle,
                2 => Class::Unknown,
                _ => Class::Free,
            };
            let corner = Cell {
                x: column * 32 + k % 16 * 2,
                y: row * 32 + k / 16 * 2,
            };
            for cell in corner.quarters() {
                tiles.set(cell, class).expect("room");
            }
        }
    }
    tiles
}

/// Returns the cells that a queue reaches, each named by its least map cell.
fn reached_by_queue(tiles: &Map, robot: Cell) -> BTreeSet<(i32, i32)> {
    let is_open = |x: i32, y: i32| tiles.class(Cell { x, y }) == Class::Free;
    let near = |at: i32| (at & !1) - 4..=(at & !1) + 4;
    let starts = near(robot.y)
        .step_by(2)
        .flat_map(|y| near(robot.x).step_by(2).map(move |x| (x, y)));
    let mut queue: Vec<(i32, i32)> = starts.filter(|&(x, y)| is_open(x, y)).collect();
    let mut seen: BTreeSet<(i32, i32)> = queue.iter().copied().collect();
    while let Some((x, y)) = queue.pop() {
        for (x, y) in [(x + 2, y), (x - 2, y), (x, y + 2), (x, y - 2)] {
            if is_open(x, y) && seen.insert((x, y)) {
                queue.push((x, y));
            }
        }
    }
    seen
}

#[test]
fn the_flood_reaches_what_a_queue_reaches() {
    let (mut seed, mut reached) = (1, 0);
    for round in 0..200 {
        let tiles = scattered(&mut seed);
        let robot = Cell {
            x: 7 + round % 60,
            y: 9,
        };
        let expected = reached_by_queue(&tiles, robot);
        let (frame, tiling) = (Frame::of(&tiles), Tiling::new(tiles.keys()));
        let mut scratch = vec![0xdead_beef; scratch_words(12)];
        let mut flood = Reachability::resume(frame, tiling, &mut scratch).expect("room");
        flood.clear();
        for place in 0..tiles.keys().len() {
            // The robot is a point.
            flood.load(&tiles, &Footprint::new(0.05), place);
        }
        assert_eq!(flood.start(robot), !expected.is_empty());
        while !flood.spread(1) {}
        let mut is_reached = flood.is_reached();
        for (x, y) in (-40..140)
            .step_by(2)
            .flat_map(|x| (-40..140).step_by(2).map(move |y| (x, y)))
        {
            let found = is_reached(Cell { x, y });
            assert_eq!(
                found,
                expected.contains(&(x, y)),
                "{x} {y} in round {round}"
            );
        }
        reached += expected.len();
    }
    assert!(reached > 20_000, "the maps were too tame: {reached}");
}

#[test]
fn too_little_memory_is_no_flood() {
    let tiles = scattered(&mut 7);
    let tiling = Tiling::new(tiles.keys());
    let words = scratch_words(tiles.keys().len());
    let frame = Frame::of(&tiles);
    let fits = |scratch: &mut [u32]| Reachability::resume(frame, tiling, scratch).is_some();
    assert!(fits(&mut vec![0; words]));
    assert!(!fits(&mut vec![0; words - 1]));
}

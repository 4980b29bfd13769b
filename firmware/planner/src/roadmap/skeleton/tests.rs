//! Scenes: the published skeleton in each space.

use std::string::String;
use std::vec::Vec;

use crate::geometry::Cell;
use crate::map::{Class, Tiles};
use crate::roadmap::configuration_space::Footprint;
use crate::roadmap::skeleton::{Skeleton, Space};

const SPACES: [Space; 2] = [Space::KnownFree, Space::NotObstacle];

/// The scene's coarse cells, row 0 first: `#` obstacle, `.` free, `?` never measured.
fn scene(picture: &str) -> Tiles<9, 24> {
    let mut tiles = Tiles::new();
    tiles.reset();
    for (y, row) in (0..).zip(picture.split_whitespace()) {
        for (x, character) in (0..).zip(row.chars()) {
            let class = match character {
                '#' => Class::Obstacle,
                '.' => Class::Free,
                _ => continue,
            };
            for k in 0..4 {
                let cell = Cell {
                    x: 2 * x + (k & 1),
                    y: 2 * y + (k >> 1),
                };
                tiles.set(cell, class).unwrap();
            }
        }
    }
    tiles
}

fn publish(space: Space, tiles: &Tiles<9, 24>, budget: u32) -> Skeleton<24> {
    let mut skeleton = Skeleton::new();
    skeleton.reset(space);
    // The robot is a point: a cell is passable if it is not an obstacle.
    while !skeleton.advance(tiles, &Footprint::new(0.05), &mut [0; 24 * 8], budget) {}
    skeleton
}

/// The scene with its skeleton, `+`, and its frontier cells, `*`.
fn skeleton(space: Space, picture: &str) -> Vec<String> {
    let skeleton = publish(space, &scene(picture), 10_000);
    let (way, frontier) = (skeleton.skeleton().unwrap(), skeleton.frontier().unwrap());
    let seen = |x: usize, y: usize, character: char| {
        let cell = Cell {
            x: 2 * x as i32,
            y: 2 * y as i32,
        };
        let site = skeleton.frame().site(cell).unwrap();
        match (way.get(site), frontier.get(site)) {
            (true, true) => '*',
            (true, false) => '+',
            (false, is_frontier) => {
                assert!(!is_frontier, "a frontier cell off the skeleton at {site:?}");
                character
            }
        }
    };
    let rows = picture.split_whitespace().enumerate();
    rows.map(|(y, row)| {
        row.chars()
            .enumerate()
            .map(|(x, c)| seen(x, y, c))
            .collect()
    })
    .collect()
}

/// A corridor round a block, measured except for its end. Only the space with the unexplored cells
/// has the loop.
const RING: &str = "
    #############
    #...........#
    #...........#
    #...........#
    #...#####...#
    #...#####...#
    #...#####...#
    #.....???...#
    #.....???...#
    #.....???...#
    #############
";

#[test]
fn a_loop_through_the_unexplored_needs_the_unexplored_in_the_space() {
    let known = "
        #############
        #...........#
        #...++++++..#
        #..+......+.#
        #.+.#####.+.#
        #.+.#####.+.#
        #.+.#####.+.#
        #..+.*???*..#
        #...+*???*..#
        #....*???*..#
        #############";
    let not_obstacle = "
        #############
        #...........#
        #...++++++..#
        #..+......+.#
        #.+.#####.+.#
        #.+.#####.+.#
        #.+.#####.+.#
        #..+.*???*..#
        #...+*+++*..#
        #....*???*..#
        #############";
    for (space, expected) in SPACES.into_iter().zip([known, not_obstacle]) {
        let rows = skeleton(space, RING);
        let expected: Vec<&str> = expected.split_whitespace().collect();
        assert_eq!(rows, expected, "{space:?}\n{}", rows.join("\n"));
    }
}

/// A wide way with a corner that was never measured.
const CORNER: &str = "
    ################
    #..............#
    #..............#
    #..............#
    #..............#
    #..............#
    #...........???#
    #...........???#
    ################
";

#[test]
fn an_unexplored_corner_beside_a_wide_way_is_a_frontier() {
    let counts = SPACES.map(|space| {
        let rows = skeleton(space, CORNER);
        rows.iter()
            .map(|row| row.matches('*').count())
            .sum::<usize>()
    });
    assert_eq!(counts, [5, 5]);
}

/// Returns the frontier cells of a free tile beside which nothing was measured. The map has this
/// many tiles.
fn frontier_of_a_free_tile<const TILES: usize>() -> usize {
    let mut tiles = Tiles::<TILES, 24>::new();
    tiles.reset();
    for k in 0..32 * 32 {
        let cell = Cell {
            x: k % 32,
            y: k / 32,
        };
        tiles.set(cell, Class::Free).unwrap();
    }
    // A beam asks for a tile more.
    let more = tiles.set(Cell { x: 0, y: 40 }, Class::Unknown);
    assert_eq!(more.is_err(), TILES == 1);
    let mut skeleton = Skeleton::<24>::new();
    skeleton.reset(Space::KnownFree);
    while !skeleton.advance(&tiles, &Footprint::new(0.05), &mut [0; 24 * 8], 10_000) {}
    skeleton.frontier().unwrap().count()
}

#[test]
fn what_the_map_has_no_room_for_is_no_frontier() {
    assert!(frontier_of_a_free_tile::<2>() > 0, "a tile is left");
    assert_eq!(frontier_of_a_free_tile::<1>(), 0, "the pool is full");
}

#[test]
fn a_round_in_instalments_is_the_round_in_one() {
    let tiles = scene(RING);
    for space in SPACES {
        let [one, other] = [1_000_000, 41].map(|budget| publish(space, &tiles, budget));
        let words = |skeleton: &Skeleton<24>| {
            let (way, frontier) = (skeleton.skeleton().unwrap(), skeleton.frontier().unwrap());
            (
                skeleton.frame(),
                way.words().to_vec(),
                frontier.words().to_vec(),
            )
        };
        assert_eq!(words(&one), words(&other), "{space:?}");
    }
}

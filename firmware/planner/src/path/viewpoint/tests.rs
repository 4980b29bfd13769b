//! Viewpoints as pictures. A character is 4 × 4 cells of 10 cm, the greatest y first: `#` obstacle,
//! `.` free, `?` unexplored, `R` the robot.

use std::boxed::Box;
use std::vec::Vec;

use crate::config::{Order, Tuning};
use crate::geometry::Cell;
use crate::grid::Tiling;
use crate::map::{Class, Tiles};
use crate::path::blocked_passages::BlockedPassages;
use crate::path::rays::{RAYS, along, ray};
use crate::path::residual_frontiers::ResidualFrontiers;
use crate::path::utility::GoalOrder;
use crate::path::viewpoint::{Found, Inputs, Search, Viewpoint};
use crate::roadmap::configuration_space::Footprint;
use crate::roadmap::reachability::scratch_words;
use crate::roadmap::skeleton::Frame;
use crate::status::ResidualReason;

const SLOTS: usize = 24;
type Map = Tiles<20, SLOTS>;

fn drawn(picture: &[&str]) -> (Box<Map>, Cell) {
    let mut tiles = Box::new(Map::new());
    tiles.reset();
    let mut robot = Cell::default();
    for (row, line) in picture.iter().rev().enumerate() {
        for (column, letter) in line.chars().enumerate() {
            let corner = Cell {
                x: 4 * column as i32,
                y: 4 * row as i32,
            };
            let class = match letter {
                '#' => Class::Obstacle,
                '?' => continue,
                _ => Class::Free,
            };
            for k in 0..16 {
                let cell = Cell {
                    x: corner.x + k % 4,
                    y: corner.y + k / 4,
                };
                tiles.set(cell, class).unwrap();
            }
            if letter == 'R' {
                robot = Cell {
                    x: corner.x + 2,
                    y: corner.y + 2,
                };
            }
        }
    }
    (tiles, robot)
}

/// Runs a search from beginning to end, in scratch memory that holds anything.
fn search(tiles: &Map, robot: Cell, gone: &[Cell]) -> Option<Viewpoint> {
    let mut scratch = std::vec![0xdead_beef; scratch_words(SLOTS)];
    search_in(&mut scratch, tiles, robot, gone)
}

fn search_in(scratch: &mut [u32], tiles: &Map, robot: Cell, gone: &[Cell]) -> Option<Viewpoint> {
    let (frame, tiling) = (Frame::of(tiles), Tiling::new(tiles.keys()));
    let blocked = BlockedPassages::new();
    let inputs = Inputs {
        blocked: &blocked,
        tiles,
        tiling,
        frame,
        footprints: [&Footprint::new(0.3), &Footprint::new(0.22)],
        robot,
        order: GoalOrder::new(Order::ALL, &Tuning::DEFAULT.order),
    };
    let mut residual = ResidualFrontiers::new();
    for &cell in gone {
        residual.give_up(cell, ResidualReason::Unobservable);
    }
    let mut search = Search::new();
    search.begin();
    for _ in 0..100 {
        match search.advance(&inputs, &mut residual, scratch) {
            Found::Pending => assert!(search.is_running()),
            Found::Viewpoint(viewpoint) => return Some(viewpoint),
            Found::Nothing => return None,
        }
    }
    panic!("a search without an end");
}

/// Returns true if a ray leads from the viewpoint's stand through its gap to the unexplored cell
/// beyond.
fn sees(tiles: &Map, viewpoint: Viewpoint) -> bool {
    let class = |cell| tiles.class(cell);
    (0..RAYS).map(ray).any(|ray| {
        let cells: Vec<Cell> = (-60..60).map(|k| along(viewpoint.gap, ray, k)).collect();
        let at = |cell| cells.iter().position(|&other| other == cell);
        match (at(viewpoint.stand), at(viewpoint.gap), at(viewpoint.beyond)) {
            (Some(stand), Some(gap), Some(beyond)) if stand <= gap && gap < beyond => {
                let dark = cells[gap..beyond]
                    .iter()
                    .position(|&c| class(c) == Class::Unknown);
                let dark = dark.map_or(beyond, |dark| gap + dark);
                cells[stand..dark].iter().all(|&c| class(c) == Class::Free)
                    && cells[dark..=beyond]
                        .iter()
                        .all(|&c| class(c) == Class::Unknown)
            }
            _ => false,
        }
    })
}

/// A hall below, and a room above behind a gap of 0.4 m. Of the room only what lies straight ahead
/// of the gap is explored.
const GAP: [&str; 14] = [
    "##########################",
    "#????????.???????????????#",
    "#????????.???????????????#",
    "#????????.???????????????#",
    "#????????.???????????????#",
    "#????????.???????????????#",
    "#########.################",
    "#........................#",
    "#........................#",
    "#........................#",
    "#..R.....................#",
    "#........................#",
    "#........................#",
    "##########################",
];

#[test]
fn a_shadow_behind_a_gap_is_looked_into_through_it() {
    let (tiles, robot) = drawn(&GAP);
    let viewpoint = search(&tiles, robot, &[]).expect("something to see");
    assert!(viewpoint.stand.y < 28, "in the hall: {viewpoint:?}");
    assert!(viewpoint.gap.y >= 32, "in the room: {viewpoint:?}");
    assert_eq!(tiles.class(viewpoint.beyond), Class::Unknown);
    assert!(sees(&tiles, viewpoint), "{viewpoint:?}");
}

/// Gives up one gap after another, until there is none. If a nearer one were left out, it would
/// come later.
#[test]
fn a_gap_given_up_is_not_looked_at_again_and_the_search_ends() {
    let (tiles, robot) = drawn(&GAP);
    let (mut gone, mut trip_m) = (Vec::new(), 0.0);
    while let Some(viewpoint) = search(&tiles, robot, &gone) {
        assert!(
            gone.iter()
                .all(|&cell| cell.distance_m(viewpoint.gap) >= 0.5)
        );
        assert!(sees(&tiles, viewpoint), "{viewpoint:?}");
        let Viewpoint { stand, gap, .. } = viewpoint;
        let before_m = trip_m;
        trip_m = robot.distance_m(stand) + stand.distance_m(gap);
        assert!(trip_m >= before_m, "{viewpoint:?}");
        gone.push(gap);
    }
    assert!((2..40).contains(&gone.len()), "{gone:?}");
}

#[test]
fn of_two_gaps_the_nearer_is_taken() {
    let mut picture = GAP;
    for line in &mut picture[1..6] {
        *line = "#????????.??????????.????#";
    }
    picture[6] = "#########.##########.#####";
    let (tiles, robot) = drawn(&picture);
    let viewpoint = search(&tiles, robot, &[]).expect("something to see");
    assert!(viewpoint.stand.x < 60, "{viewpoint:?}");
    let robot = Cell { x: 90, ..robot };
    let viewpoint = search(&tiles, robot, &[]).expect("something to see");
    assert!(viewpoint.stand.x > 60, "{viewpoint:?}");
}

#[test]
fn where_everything_is_known_there_is_nothing_to_see() {
    let picture = GAP.map(|line| line.replace('?', "."));
    let lines: Vec<&str> = picture.iter().map(|line| line.as_str()).collect();
    let (tiles, robot) = drawn(&lines);
    assert_eq!(search(&tiles, robot, &[]), None);
}

/// Without a gap nothing beyond the wall can be seen.
#[test]
fn through_a_wall_nothing_is_seen() {
    let mut picture = GAP;
    picture[6] = "##########################";
    let (tiles, robot) = drawn(&picture);
    assert_eq!(search(&tiles, robot, &[]), None);
}

/// Cracks one or two cells wide are noise at the foot of a wall.
#[test]
fn a_crack_is_no_gap() {
    let picture = GAP.map(|line| line.replace('?', "."));
    let lines: Vec<&str> = picture.iter().map(|line| line.as_str()).collect();
    let (mut tiles, robot) = drawn(&lines);
    for x in 0..104 {
        tiles.set(Cell { x, y: 30 }, Class::Unknown).unwrap();
    }
    assert_eq!(search(&tiles, robot, &[]), None);
}

/// In a passage of 0.6 m the robot's own footprint has no passable cell. The search uses the
/// narrower one.
#[test]
fn a_robot_in_a_narrow_place_looks_too() {
    let mut picture = GAP;
    for (row, line) in [
        (7, "#......................###"),
        (8, "##########################"),
        (9, "##########################"),
    ] {
        picture[row] = line;
    }
    let (mut tiles, _) = drawn(&picture);
    // A passage of six cells below the room's wall.
    for x in 4..92 {
        for y in 22..28 {
            tiles.set(Cell { x, y }, Class::Free).unwrap();
        }
    }
    let robot = Cell { x: 40, y: 25 };
    let viewpoint = search(&tiles, robot, &[]).expect("something to see");
    assert!(sees(&tiles, viewpoint), "{viewpoint:?}");
}

#[test]
fn without_a_map_or_memory_nothing_is_found() {
    assert_eq!(search(&drawn(&[]).0, Cell::default(), &[]), None);
    let (tiles, robot) = drawn(&GAP);
    assert!(search(&tiles, robot, &[]).is_some());
    assert_eq!(search_in(&mut [0; 10], &tiles, robot, &[]), None);
}

//! What is left when no frontier is within reach: does the robot have a way to where the map has no room?
//!
//! Something seen beyond the map's box, through a window or a gap, is no reason to call an exploration incomplete; a door out of the
//! box is. So the explored passable cells are flooded from the robot, and where the flood comes to the side of a tile behind
//! which nothing can be stored, a way leads out.
//!
//! Done once, at the end of a run.
//!
//! Units: coarse cells of 20 cm, 16 × 16 in a tile.

use crate::geometry::Cell;
use crate::map::tiles::NoRoom;
use crate::map::{Map, Tiles};
use crate::roadmap::configuration_space::Footprint;
use crate::roadmap::reachability::{Flood, each};

/// Which room the map wants for what the robot can get to, if any; `found` hears of every place where it ends, see
/// [`ways_out`]. A map that refused nothing wants none.
pub fn no_room<const TILES: usize, const SLOTS: usize>(
    map: &Map<TILES, SLOTS>,
    disc: &Footprint,
    robot: Cell,
    scratch: &mut [u32],
    mut found: impl FnMut(Cell),
) -> Option<NoRoom> {
    if !map.out_of_box() && !map.pool_full() {
        return None;
    }
    let mut no_room = None;
    ways_out(map.tiles(), disc, robot, scratch, |cell, why| {
        no_room = Some(why);
        found(cell);
    });
    no_room
}

/// Call `found` with the least map cell of every explored coarse cell that the robot can get to and that borders on a
/// tile the map has no room for, and say why it has none; with the robot's own if it stands on such a tile.
///
/// `scratch` is of any content, and must have [`scratch_words`](crate::roadmap::reachability::scratch_words) words; with fewer, nothing is found.
pub fn ways_out<const TILES: usize, const SLOTS: usize>(
    tiles: &Tiles<TILES, SLOTS>,
    disc: &Footprint,
    robot: Cell,
    scratch: &mut [u32],
    mut found: impl FnMut(Cell, NoRoom),
) {
    let Some(extent) = tiles.extent() else {
        return;
    };
    if let Err(why) = tiles.room(robot.x >> 5, robot.y >> 5) {
        // It went out already.
        return found(robot, why);
    }
    let Some(mut flood) = Flood::new(extent, scratch) else {
        return;
    };
    for tile in each(extent) {
        flood.load(tiles, disc, tile);
    }
    flood.start(robot);
    while flood.sweep() {}
    for (tile_x, tile_y) in each(extent) {
        for side in [(-1, 0), (1, 0), (0, -1), (0, 1)] {
            if let Err(why) = tiles.room(tile_x + side.0, tile_y + side.1) {
                flood.along((tile_x, tile_y), side, |cell| found(cell, why));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::boxed::Box;
    use std::vec::Vec;

    use super::ways_out;
    use crate::geometry::Cell;
    use crate::map::tiles::NoRoom;
    use crate::map::{Class, Tiles};
    use crate::roadmap::configuration_space::Footprint;
    use crate::roadmap::reachability::scratch_words;

    const SLOTS: usize = 24;

    /// A map of 4 × 4 tiles' box (cells 0 to 127 each way), drawn a character to 4 × 4 cells, greatest y first; `R` is the robot.
    fn drawn(picture: &[&str]) -> (Box<Tiles<20, SLOTS>>, Cell) {
        let mut tiles = Box::new(Tiles::new());
        tiles.reset(4, 4);
        let mut robot = None;
        for (row, line) in picture.iter().rev().enumerate() {
            for (column, letter) in line.chars().enumerate() {
                let class = match letter {
                    '#' => Class::Obstacle,
                    '?' => continue,
                    _ => Class::Free,
                };
                let corner = (4 * column as i32, 4 * row as i32);
                for k in 0..16 {
                    let cell = Cell {
                        x: corner.0 + k % 4,
                        y: corner.1 + k / 4,
                    };
                    tiles.set(cell, class).unwrap();
                }
                if letter == 'R' {
                    robot = Some(Cell {
                        x: corner.0 + 2,
                        y: corner.1 + 2,
                    });
                }
            }
        }
        (tiles, robot.expect("a robot"))
    }

    fn found(tiles: &Tiles<20, SLOTS>, robot: Cell) -> Vec<(Cell, NoRoom)> {
        let mut list = Vec::new();
        let mut scratch = [0xdead_beef; scratch_words(SLOTS)];
        ways_out(
            tiles,
            &Footprint::new(0.3),
            robot,
            &mut scratch,
            |cell, why| {
                list.push((cell, why));
            },
        );
        list
    }

    /// The plan of a room that takes the whole box; `gap` is the east wall's line across from the robot.
    fn room(east: [&str; 3]) -> Vec<std::string::String> {
        use std::format;
        use std::string::String;
        let wall = String::from("################################");
        let floor = format!("#{}#", ".".repeat(30));
        let mut lines = std::vec![floor; 32];
        lines[0].clone_from(&wall);
        lines[31] = wall;
        for (line, east) in lines[14..].iter_mut().zip(east) {
            *line = format!("#{}{east}", ".".repeat(32 - 1 - east.len()));
        }
        lines[20].replace_range(5..6, "R");
        lines
    }

    fn ways(lines: &[std::string::String]) -> usize {
        let picture: Vec<&str> = lines.iter().map(|line| line.as_str()).collect();
        let (tiles, robot) = drawn(&picture);
        let list = found(&tiles, robot);
        for (cell, why) in &list {
            assert_eq!((cell.x, *why), (126, NoRoom::Box));
        }
        list.len()
    }

    #[test]
    fn a_closed_room_has_no_way_out() {
        assert_eq!(ways(&room(["#", "#", "#"])), 0);
    }

    /// 0.4 m between the posts lets a laser through, and no robot of 0.3 m radius.
    #[test]
    fn a_gap_too_narrow_is_no_way_out() {
        assert_eq!(ways(&room(["#", ".", "#"])), 0);
    }

    #[test]
    fn a_door_is_a_way_out() {
        assert!(ways(&room([".", ".", "."])) > 0);
    }

    #[test]
    fn a_door_behind_a_wall_without_one_is_none() {
        let mut lines = room([".", ".", "."]);
        for line in &mut lines[1..31] {
            line.replace_range(16..17, "#");
        }
        assert_eq!(ways(&lines), 0);
        lines[3].replace_range(16..17, ".");
        lines[4].replace_range(16..17, ".");
        lines[5].replace_range(16..17, ".");
        assert!(ways(&lines) > 0, "round by the door in the north");
    }

    /// A meander from the south west to the north east, through word borders both ways.
    #[test]
    fn the_flood_follows_every_turn() {
        let mut lines: Vec<std::string::String> = room(["#", "#", "#"]);
        for line in &mut lines[1..31] {
            *line = line.replace('R', ".");
        }
        for (k, column) in (5..30).step_by(5).enumerate() {
            let rows = if k % 2 == 0 { 1..26 } else { 6..31 };
            for line in &mut lines[rows] {
                line.replace_range(column..=column, "#");
            }
        }
        lines[15].replace_range(2..3, "R");
        for line in &mut lines[1..4] {
            line.replace_range(31..32, ".");
        }
        assert!(ways(&lines) > 0);
        for line in &mut lines[1..31] {
            line.replace_range(20..21, "#");
        }
        assert_eq!(ways(&lines), 0);
    }

    /// Where the pool is empty, every border on a tile without one is a way out.
    #[test]
    fn a_full_pool_ends_the_map_inside_the_box() {
        let mut tiles: Box<Tiles<2, SLOTS>> = Box::default();
        tiles.reset(4, 4);
        for y in 0..32 {
            for x in 0..64 {
                let wall = y < 2 || (y > 29 && x < 32) || !(2..=61).contains(&x);
                let class = if wall { Class::Obstacle } else { Class::Free };
                tiles.set(Cell { x, y }, class).unwrap();
            }
        }
        let mut list = Vec::new();
        let mut scratch = [0; scratch_words(SLOTS)];
        let robot = Cell { x: 10, y: 10 };
        ways_out(
            &tiles,
            &Footprint::new(0.3),
            robot,
            &mut scratch,
            |cell, why| {
                list.push((cell, why));
            },
        );
        assert!(!list.is_empty());
        assert!(
            list.iter()
                .all(|(cell, why)| cell.y == 30 && cell.x > 32 && *why == NoRoom::Pool),
            "{list:?}"
        );
    }

    /// Nothing is kept of where it stands, so there is nothing to flood.
    #[test]
    fn a_robot_that_left_the_box_is_the_way_out() {
        let picture: Vec<std::string::String> = room([".", ".", "."]);
        let picture: Vec<&str> = picture.iter().map(|line| line.as_str()).collect();
        let (tiles, _) = drawn(&picture);
        let robot = Cell { x: 132, y: 60 };
        assert_eq!(found(&tiles, robot), [(robot, NoRoom::Box)]);
    }

    #[test]
    fn without_memory_or_map_nothing_is_found() {
        let (tiles, robot) = drawn(&["R"]);
        let mut list = Vec::new();
        let push = |cell, why| list.push((cell, why));
        ways_out(&tiles, &Footprint::new(0.3), robot, &mut [0; 1], push);
        assert!(list.is_empty());
    }
}

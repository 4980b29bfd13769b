//! Map exits: places that the robot can reach and beyond which the map has no room.
//!
//! Something seen beyond the map's range, through a window or a gap, does not make an exploration
//! incomplete; a door out of it does. So the explored passable cells are flooded from the
//! robot ([`Reachability`]). Where the flood comes to the side of a tile behind which nothing can
//! be stored, there is an exit.
//!
//! The search runs once, at the end of a run, in instalments while the robot stands.
//!
//! Units: coarse cells of 20 cm, 16 × 16 in a tile.

use crate::geometry::Cell;
use crate::grid::{SIDES, Tiling};
use crate::map::Tiles;
use crate::map::tiles::NoRoom;
use crate::roadmap::configuration_space::Footprint;
use crate::roadmap::flooding::Flooding;
use crate::roadmap::reachability::Reachability;
use crate::roadmap::skeleton::Frame;

/// The inputs of a search. They are the same for all its instalments, except for what the map
/// learns meanwhile.
#[derive(Debug)]
pub(crate) struct Inputs<'a, const TILES: usize, const SLOTS: usize> {
    /// The map.
    pub(crate) tiles: &'a Tiles<TILES, SLOTS>,
    /// The tiles that are searched, and their place.
    pub(crate) tiling: Tiling<'a>,
    pub(crate) frame: Frame,
    /// The disc that paths are planned for.
    pub(crate) footprint: &'a Footprint,
    /// Where the robot stands.
    pub(crate) robot: Cell,
}

/// A search in progress. Its lent memory holds what the robot can reach.
#[derive(Debug)]
pub(crate) struct Search {
    is_running: bool,
    flooding: Flooding,
}

impl Search {
    /// Makes a search that is over.
    pub(crate) const fn new() -> Self {
        Self {
            is_running: false,
            flooding: Flooding::FIRST,
        }
    }

    /// Begins a search. Until its first instalment others may use the lent memory.
    pub(crate) const fn begin(&mut self) {
        (self.is_running, self.flooding) = (true, Flooding::FIRST);
    }

    /// Returns true if the search needs another instalment.
    pub(crate) const fn is_running(&self) -> bool {
        self.is_running
    }

    /// Runs an instalment. Once the last one has run, calls `found` with every exit and the room
    /// that is missing there. An exit is the least map cell of an explored coarse cell that the
    /// robot can reach and that borders on a tile without room. If the robot stands on such a tile,
    /// its own cell is the only exit.
    ///
    /// `scratch` must keep its values from the first instalment to the last. With fewer than
    /// [`scratch_words`](crate::roadmap::reachability::scratch_words) words no exit is found.
    pub(crate) fn advance<const TILES: usize, const SLOTS: usize>(
        &mut self,
        inputs: &Inputs<'_, TILES, SLOTS>,
        scratch: &mut [u32],
        mut found: impl FnMut(Cell, NoRoom),
    ) {
        if !core::mem::take(&mut self.is_running) {
            return;
        }
        let robot = inputs.robot;
        if let Err(room) = inputs.tiles.room(robot.x >> 5, robot.y >> 5) {
            // The robot has left the map.
            return found(robot, room);
        }
        let Some(mut reachability) = Reachability::resume(inputs.frame, inputs.tiling, scratch)
        else {
            return;
        };
        let start = |reachability: &mut Reachability<'_>| reachability.start(robot);
        self.flooding
            .advance(inputs.tiles, inputs.footprint, &mut reachability, start);
        match self.flooding {
            Flooding::Load(_) | Flooding::Spread => self.is_running = true,
            Flooding::Over => inputs.for_each_exit(&reachability, found),
            Flooding::Tight => {}
        }
    }
}

impl<const TILES: usize, const SLOTS: usize> Inputs<'_, TILES, SLOTS> {
    fn for_each_exit(&self, reachability: &Reachability<'_>, mut found: impl FnMut(Cell, NoRoom)) {
        for &key in self.tiling.keys() {
            let (x, y) = self.frame.tile(key);
            for side in SIDES {
                if let Err(room) = self.tiles.room(x + side.0, y + side.1) {
                    reachability.along(key, side, |cell| found(cell, room));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::boxed::Box;
    use std::vec::Vec;

    use super::{Inputs, Search};
    use crate::geometry::Cell;
    use crate::grid::{TileKey, Tiling};
    use crate::map::tiles::{NoRoom, TILE_SIDE};
    use crate::map::{Class, Tiles};
    use crate::roadmap::configuration_space::Footprint;
    use crate::roadmap::reachability::scratch_words;
    use crate::roadmap::skeleton::Frame;

    const SLOTS: usize = 24;

    /// Makes a map that ends at column 127 from a picture. A character is
    /// 4 × 4 cells, the greatest y first; `R` is the robot.
    fn drawn(picture: &[&str]) -> (Box<Tiles<20, SLOTS>>, Cell) {
        let mut tiles = Box::new(Tiles::new());
        tiles.reset();
        // The map begins so far in the west that it ends 128 cells from here in the east.
        let west = Cell {
            x: (3 - TileKey::REACH) * TILE_SIDE,
            y: 0,
        };
        tiles.set(west, Class::Obstacle).unwrap();
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

    /// Searches in memory of so many words.
    fn found_in<const PAGES: usize>(
        words: usize,
        tiles: &Tiles<PAGES, SLOTS>,
        robot: Cell,
    ) -> Vec<(Cell, NoRoom)> {
        let mut list = Vec::new();
        let mut scratch = std::vec![0xdead_beef; words];
        let inputs = Inputs {
            tiles,
            tiling: Tiling::new(tiles.keys()),
            frame: Frame::of(tiles),
            footprint: &Footprint::new(0.3),
            robot,
        };
        let mut search = Search::new();
        search.begin();
        while search.is_running() {
            assert!(list.is_empty(), "exits of a flood that is not over");
            search.advance(&inputs, &mut scratch, |cell, why| list.push((cell, why)));
        }
        list
    }

    fn found<const PAGES: usize>(tiles: &Tiles<PAGES, SLOTS>, robot: Cell) -> Vec<(Cell, NoRoom)> {
        found_in(scratch_words(SLOTS), tiles, robot)
    }

    /// The plan of a room that fills the whole box; `east` is a part of its east wall.
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

    fn exits(lines: &[std::string::String]) -> usize {
        let picture: Vec<&str> = lines.iter().map(|line| line.as_str()).collect();
        let (tiles, robot) = drawn(&picture);
        let list = found(&tiles, robot);
        for (cell, why) in &list {
            assert_eq!((cell.x, *why), (126, NoRoom::Box));
        }
        list.len()
    }

    #[test]
    fn a_closed_room_has_no_exit() {
        assert_eq!(exits(&room(["#", "#", "#"])), 0);
    }

    /// 0.4 m between the posts let a laser through, and no robot of 0.3 m radius.
    #[test]
    fn a_gap_too_narrow_is_no_exit() {
        assert_eq!(exits(&room(["#", ".", "#"])), 0);
    }

    #[test]
    fn a_door_is_an_exit() {
        assert!(exits(&room([".", ".", "."])) > 0);
    }

    #[test]
    fn a_door_behind_a_wall_without_one_is_none() {
        let mut lines = room([".", ".", "."]);
        for line in &mut lines[1..31] {
            line.replace_range(16..17, "#");
        }
        assert_eq!(exits(&lines), 0);
        lines[3].replace_range(16..17, ".");
        lines[4].replace_range(16..17, ".");
        lines[5].replace_range(16..17, ".");
        assert!(exits(&lines) > 0, "round by the door in the north");
    }

    /// A meander from the south-west to the north-east, across word borders both ways.
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
        assert!(exits(&lines) > 0);
        for line in &mut lines[1..31] {
            line.replace_range(20..21, "#");
        }
        assert_eq!(exits(&lines), 0);
    }

    /// Once the pool is used up, every border on a tile without memory is an exit.
    #[test]
    fn a_full_pool_ends_the_map_inside_the_box() {
        let mut tiles: Box<Tiles<2, SLOTS>> = Box::default();
        tiles.reset();
        for y in 0..32 {
            for x in 0..64 {
                let wall = y < 2 || (y > 29 && x < 32) || !(2..=61).contains(&x);
                let class = if wall { Class::Obstacle } else { Class::Free };
                tiles.set(Cell { x, y }, class).unwrap();
            }
        }
        let beyond = Cell { x: 40, y: 40 };
        assert_eq!(tiles.set(beyond, Class::Free), Err(NoRoom::Pool));
        let list = found(&tiles, Cell { x: 10, y: 10 });
        assert!(!list.is_empty());
        assert!(
            list.iter()
                .all(|(cell, why)| cell.y == 30 && cell.x > 32 && *why == NoRoom::Pool),
            "{list:?}"
        );
    }

    /// The map has no cell where the robot stands, so there is nothing to flood.
    #[test]
    fn a_robot_that_left_the_box_is_the_exit() {
        let picture: Vec<std::string::String> = room([".", ".", "."]);
        let picture: Vec<&str> = picture.iter().map(|line| line.as_str()).collect();
        let (tiles, _) = drawn(&picture);
        let robot = Cell { x: 132, y: 60 };
        assert_eq!(found(&tiles, robot), [(robot, NoRoom::Box)]);
    }

    #[test]
    fn without_memory_nothing_is_found() {
        let (tiles, robot) = drawn(&["R"]);
        assert_eq!(found_in(1, &tiles, robot), []);
    }
}

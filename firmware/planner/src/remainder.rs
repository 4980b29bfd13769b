//! What is left when no frontier is within reach: does the robot have a way to where the map has no room?
//!
//! Something seen beyond the map's box, through a window or a gap, is no reason to call an exploration incomplete; a door out of the
//! box is. So the explored passable cells are flooded from the robot, and where the flood comes to the side of a tile behind
//! which nothing can be stored, a way leads out.
//!
//! ```text
//! open    = coarse cells with a passable, free map cell              (at most one word for two tiles and row)
//! reached = the smallest set with: near the robot, or open and beside a reached cell at a side
//! ```
//!
//! Done once, at the end of a run, in lent memory: two million instructions for the loading of a full pool, and some hundred
//! thousand for each time that the ways change from up to down.
//!
//! Units: coarse cells of 20 cm, 16 × 16 in a tile.

use crate::clearance::{Disc, for_each_strip};
use crate::geometry::Cell;
use crate::map::tiles::{Extent, NoRoom};
use crate::map::{Map, Tiles};

/// Coarse cells along a tile's side.
const SIDE: usize = 16;
/// Coarse cells around the robot's own from which the flood starts: it may stand nearer to something than its radius.
const START_REACH: i32 = 2;

/// Words of memory that [`ways_out`] needs for a box of so many tile places: two planes, and two tiles side by side share a word.
#[must_use]
pub const fn scratch_words(slots: usize) -> usize {
    SIDE * slots
}

/// Which room the map wants for what the robot can get to, if any; `found` hears of every place where it ends, see
/// [`ways_out`]. A map that refused nothing wants none.
pub fn no_room<const TILES: usize, const SLOTS: usize>(
    map: &Map<TILES, SLOTS>,
    disc: &Disc,
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
/// `scratch` is of any content, and must have [`scratch_words`] words; with fewer, nothing is found.
pub fn ways_out<const TILES: usize, const SLOTS: usize>(
    tiles: &Tiles<TILES, SLOTS>,
    disc: &Disc,
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
    flood.load(tiles, disc);
    flood.start(robot);
    flood.run();
    for (tile_x, tile_y) in each(extent) {
        for side in [(-1, 0), (1, 0), (0, -1), (0, 1)] {
            if let Err(why) = tiles.room(tile_x + side.0, tile_y + side.1) {
                flood.along((tile_x, tile_y), side, |cell| found(cell, why));
            }
        }
    }
}

/// The tiles of an extent.
fn each(extent: Extent) -> impl Iterator<Item = (i32, i32)> {
    let rows = extent.least.1..=extent.greatest.1;
    rows.flat_map(move |y| (extent.least.0..=extent.greatest.0).map(move |x| (x, y)))
}

/// The flood's planes, row by row, as wide as the extent.
struct Flood<'a> {
    extent: Extent,
    per_row: usize,
    open: &'a mut [u32],
    reached: &'a mut [u32],
}

impl<'a> Flood<'a> {
    /// All clear.
    fn new(extent: Extent, scratch: &'a mut [u32]) -> Option<Self> {
        let per_row = usize::try_from(extent.width()).ok()?.div_ceil(2);
        let words = per_row * SIDE * usize::try_from(extent.height()).ok()?;
        let (open, reached) = scratch.get_mut(..2 * words)?.split_at_mut(words);
        open.fill(0);
        reached.fill(0);
        Some(Self {
            extent,
            per_row,
            open,
            reached,
        })
    }

    /// Coarse column and row of a map cell, as far as there are any.
    fn place(&self, cell: Cell) -> Option<(usize, usize)> {
        let x = usize::try_from((cell.x >> 1) - self.extent.least.0 * SIDE as i32).ok()?;
        let y = usize::try_from((cell.y >> 1) - self.extent.least.1 * SIDE as i32).ok()?;
        (x / 32 < self.per_row).then_some((x, y))
    }

    fn is_reached(&self, cell: Cell) -> bool {
        self.place(cell).is_some_and(|(x, y)| {
            let word = self.reached.get(y * self.per_row + x / 32);
            word.is_some_and(|word| word >> (x % 32) & 1 == 1)
        })
    }

    /// Mark what is open in every stored tile.
    fn load<const TILES: usize, const SLOTS: usize>(
        &mut self,
        tiles: &Tiles<TILES, SLOTS>,
        disc: &Disc,
    ) {
        let stored = each(self.extent).filter(|&(x, y)| tiles.is_touched(x, y));
        for (tile_x, tile_y) in stored {
            let corner = Cell {
                x: tile_x * 32,
                y: tile_y * 32,
            };
            let Some((x, row)) = self.place(corner) else {
                continue;
            };
            for_each_strip(tiles, disc, (corner.x, corner.y), 32, |y, strip| {
                let free = strip.passable & !strip.unknown & !strip.obstacle;
                let row = row + ((y - corner.y) / 2) as usize;
                if let Some(word) = self.open.get_mut(row * self.per_row + x / 32) {
                    *word |= halve(free) << (x % 32);
                }
            });
        }
    }

    /// Reach what is open around the robot.
    fn start(&mut self, robot: Cell) {
        for dy in -START_REACH..=START_REACH {
            for dx in -START_REACH..=START_REACH {
                let near = Cell {
                    x: robot.x + 2 * dx,
                    y: robot.y + 2 * dy,
                };
                let Some((x, y)) = self.place(near) else {
                    continue;
                };
                let index = y * self.per_row + x / 32;
                let open = self.open.get(index).copied().unwrap_or(0);
                if let Some(word) = self.reached.get_mut(index) {
                    *word |= open & 1 << (x % 32);
                }
            }
        }
    }

    /// Up and down the rows until nothing changes; every sweep but the last reaches something new, so it ends.
    fn run(&mut self) {
        let rows = self.open.len() / self.per_row.max(1);
        loop {
            let mut changed = false;
            for row in 0..rows {
                changed |= self.spread(row, row.checked_sub(1));
            }
            for row in (0..rows).rev() {
                changed |= self.spread(row, Some(row + 1));
            }
            if !changed {
                return;
            }
        }
    }

    /// Take over what the row beside has reached, and fill the runs that hold any of it. Answers whether that is new.
    fn spread(&mut self, row: usize, beside: Option<usize>) -> bool {
        let mut changed = false;
        let mut carry = false;
        for word in 0..self.per_row {
            let seeds = beside.and_then(|beside| self.reached.get(beside * self.per_row + word));
            let seeds = seeds.copied().unwrap_or(0);
            changed |= self.fill(row * self.per_row + word, seeds, &mut carry, |bits| bits);
        }
        let mut carry = false;
        for word in (0..self.per_row).rev() {
            changed |= self.fill(row * self.per_row + word, 0, &mut carry, u32::reverse_bits);
        }
        changed
    }

    /// Fill a word's runs from their reached cells and `seeds` on towards the high end, in the order of bits that `turn` gives;
    /// `carry` says whether the run that begins the word was reached in the one before, and then whether the last was.
    fn fill(
        &mut self,
        index: usize,
        seeds: u32,
        carry: &mut bool,
        turn: impl Fn(u32) -> u32,
    ) -> bool {
        let open = turn(self.open.get(index).copied().unwrap_or(0));
        let Some(word) = self.reached.get_mut(index) else {
            return false;
        };
        let before = turn(*word);
        let seeds = open & (before | turn(seeds) | u32::from(*carry));
        // A carry started at a seed clears the run's bits up to its end.
        let (sum, over) = open.overflowing_add(seeds);
        let after = open & !sum | seeds;
        *word = turn(after);
        *carry = over;
        after != before
    }

    /// The reached cells along one side of a tile.
    fn along(&self, tile: (i32, i32), side: (i32, i32), mut found: impl FnMut(Cell)) {
        let last = 2 * (SIDE as i32 - 1);
        for k in 0..SIDE as i32 {
            let at = |side: i32| match side {
                0 => 2 * k,
                1 => last,
                _ => 0,
            };
            let cell = Cell {
                x: tile.0 * 32 + at(side.0),
                y: tile.1 * 32 + at(side.1),
            };
            if self.is_reached(cell) {
                found(cell);
            }
        }
    }
}

/// Bits 2 k and 2 k + 1 joined into bit k.
fn halve(word: u32) -> u32 {
    crate::bits::halve_or(u64::from(word), 0)
}

#[cfg(test)]
mod tests {
    use std::boxed::Box;
    use std::vec::Vec;

    use super::{scratch_words, ways_out};
    use crate::clearance::Disc;
    use crate::geometry::Cell;
    use crate::map::tiles::NoRoom;
    use crate::map::{Class, Tiles};

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
        ways_out(tiles, &Disc::new(0.3), robot, &mut scratch, |cell, why| {
            list.push((cell, why));
        });
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
        ways_out(&tiles, &Disc::new(0.3), robot, &mut scratch, |cell, why| {
            list.push((cell, why));
        });
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
        ways_out(&tiles, &Disc::new(0.3), robot, &mut [0; 1], push);
        assert!(list.is_empty());
    }
}

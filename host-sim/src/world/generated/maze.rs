//! A maze: corridors of one width between thin walls, with loops, doors, slits, small halls and
//! walled-in cells.
//!
//! A depth-first walk over the cells opens a tree of corridors, so every cell is reached and dead
//! ends are many. Then some of the other walls go, which closes loops.

use super::dice::Dice;
use super::sheet::{Door, Sheet};
use super::{DOOR_M, SLIT_M};
use crate::world::occupancy::Class;

/// Width of the corridors, least and most, metres.
const CORRIDOR_M: [f64; 2] = [0.8, 2.0];
/// Thickness of the walls, least and most, metres.
const WALL_M: [f64; 2] = [0.05, 0.2];
/// Most cells across and up if the size is free: a larger maze takes hours of simulated time.
const MOST_CELLS: f64 = 14.0;

/// A wall between two cells.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Side {
    Closed,
    /// Open, on the only way to somewhere.
    Tree,
    /// Open, and closes a loop.
    Loop,
}

/// Corridors and walls, in cells.
struct Maze {
    columns: usize,
    rows: usize,
    corridor_m: f64,
    wall_m: f64,
    /// The wall to the east and to the north of every cell.
    sides: Vec<[Side; 2]>,
}

/// Draws it.
pub(super) fn draw(dice: &mut Dice, size_m: Option<[f64; 2]>) -> Sheet {
    let corridor_m = dice.metres(CORRIDOR_M[0], CORRIDOR_M[1]);
    let wall_m = dice.metres(WALL_M[0], WALL_M[1]);
    let pitch_m = corridor_m + wall_m;
    let most_m = MOST_CELLS * pitch_m;
    let free_m = super::free_size_m(dice).map(|m| m.min((most_m * 20.0).floor() / 20.0));
    let mut sheet = Sheet::maybe_turned(dice, size_m.unwrap_or(free_m));
    let count = |m: f64| (((m - wall_m) / pitch_m + 1e-9).floor() as usize).max(1);
    let [columns, rows] = sheet.size_m().map(count);
    let mut maze = Maze {
        columns,
        rows,
        corridor_m,
        wall_m,
        sides: vec![[Side::Closed; 2]; columns * rows],
    };
    maze.walk(dice);
    let loops = dice.between(0.0, 0.25);
    for side in maze.sides.iter_mut().flatten() {
        if *side == Side::Closed && dice.chance(loops) {
            *side = Side::Loop;
        }
    }
    maze.carve(dice, &mut sheet);
    maze.halls(dice, &mut sheet);
    sheet
}

impl Maze {
    /// Opens a tree of corridors by a depth-first walk.
    fn walk(&mut self, dice: &mut Dice) {
        let mut seen = vec![false; self.sides.len()];
        let first = dice.index(self.sides.len());
        let mut trail = vec![first];
        seen[first] = true;
        while let Some(&here) = trail.last() {
            let mut ways: Vec<usize> = self.beside(here).collect();
            ways.retain(|&cell| !seen[cell]);
            if ways.is_empty() {
                trail.pop();
                continue;
            }
            let next = ways[dice.index(ways.len())];
            let axis = usize::from(here.abs_diff(next) == self.columns);
            self.sides[here.min(next)][axis] = Side::Tree;
            seen[next] = true;
            trail.push(next);
        }
    }

    /// The cells beside a cell.
    fn beside(&self, cell: usize) -> impl Iterator<Item = usize> + use<> {
        let (columns, rows) = (self.columns, self.rows);
        let (i, j) = (cell % columns, cell / columns);
        let ways = [
            (i > 0).then(|| cell - 1),
            (i + 1 < columns).then(|| cell + 1),
            (j > 0).then(|| cell - columns),
            (j + 1 < rows).then(|| cell + columns),
        ];
        ways.into_iter().flatten()
    }

    /// Lower left corner of a cell's floor.
    fn corner(&self, i: usize, j: usize) -> [f64; 2] {
        let pitch_m = self.corridor_m + self.wall_m;
        [i, j].map(|k| self.wall_m + k as f64 * pitch_m)
    }

    /// Clears the cells and opens the walls between them.
    fn carve(&self, dice: &mut Dice, sheet: &mut Sheet) {
        let (c, t) = (self.corridor_m, self.wall_m);
        for (cell, sides) in self.sides.iter().enumerate() {
            let (i, j) = (cell % self.columns, cell / self.columns);
            let [x, y] = self.corner(i, j);
            sheet.rect(Class::Free, [x, y, x + c, y + c]);
            let walls = [
                (
                    i + 1 < self.columns,
                    [x + c, y, x + c + t, y + c],
                    [0.0, 1.0],
                ),
                (j + 1 < self.rows, [x, y + c, x + c, y + c + t], [1.0, 0.0]),
            ];
            for (side, (inner, wall, along)) in sides.iter().zip(walls) {
                if inner && *side != Side::Closed {
                    self.open(dice, sheet, *side, (wall, along));
                }
            }
        }
    }

    /// Opens a wall: as a whole, by a door, or, if it closes a loop, by a slit.
    fn open(
        &self,
        dice: &mut Dice,
        sheet: &mut Sheet,
        side: Side,
        (wall, along): ([f64; 4], [f64; 2]),
    ) {
        let [x0, y0, x1, y1] = wall;
        let middle = [(x0 + x1) / 2.0, (y0 + y1) / 2.0];
        let widest = DOOR_M[1].min(self.corridor_m - 0.1);
        let kind = dice.between(0.0, 1.0);
        if side == Side::Loop && kind < 0.15 && self.corridor_m > SLIT_M {
            let half = [SLIT_M / 2.0, self.wall_m / 2.0 + 1e-6];
            sheet.slab(Class::Free, middle, half, along);
        } else if kind < 0.25 && widest >= DOOR_M[0] {
            let width_m = dice.metres(DOOR_M[0], widest);
            let door = Door {
                middle,
                along,
                width_m,
            };
            sheet.door(door, self.wall_m);
        } else {
            sheet.rect(Class::Free, wall);
        }
    }

    /// Clears small halls, and fills single cells: pillars to go around, and pockets that no scan
    /// has seen.
    fn halls(&self, dice: &mut Dice, sheet: &mut Sheet) {
        let cells = self.columns * self.rows;
        for _ in 0..dice.index(cells / 40 + 2) {
            let [wide, high] = [2, 2].map(|least: usize| least + dice.index(2));
            if self.columns <= wide || self.rows <= high {
                continue;
            }
            let (i, j) = (
                dice.index(self.columns - wide),
                dice.index(self.rows - high),
            );
            let ([x0, y0], [x1, y1]) = (
                self.corner(i, j),
                self.corner(i + wide - 1, j + high - 1)
                    .map(|m| m + self.corridor_m),
            );
            let centre = [(x0 + x1) / 2.0, (y0 + y1) / 2.0];
            let reach_m = (x1 - x0).max(y1 - y0) + DOOR_M[1];
            // A hall would make its own doors wider than their list says.
            if sheet
                .doors()
                .iter()
                .any(|door| door.is_near(centre, reach_m))
            {
                continue;
            }
            sheet.rect(Class::Free, [x0, y0, x1, y1]);
        }
        for _ in 0..dice.index(cells / 60 + 2) {
            let (i, j) = (dice.index(self.columns), dice.index(self.rows));
            let [x, y] = self.corner(i, j);
            let (c, class) = (
                self.corridor_m,
                [Class::Unknown, Class::Wall][dice.index(2)],
            );
            let centre = [x + c / 2.0, y + c / 2.0];
            let clear = sheet.doors().iter().all(|door| !door.is_near(centre, c));
            if clear {
                sheet.rect(class, [x, y, x + c, y + c]);
            }
        }
    }
}

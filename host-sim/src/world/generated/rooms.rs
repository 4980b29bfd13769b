//! A floor of furnished rooms: corridors divide the building, walls divide what is between them,
//! and doors join what touches.
//!
//! All corridors are joined. Every room but a few gets a door, to a corridor if it touches one.
//! More doors close loops. The few without a door are isolated, and nobody may have scanned them.

use super::dice::Dice;
use super::furniture::Room;
use super::sheet::{Door, Sheet};
use super::{DOOR_M, SLIT_M};
use crate::world::occupancy::Class;

/// Width of corridors, least and most, metres.
const CORRIDOR_M: [f64; 2] = [1.0, 2.4];
/// Thickness of the walls, least and most, metres.
const WALL_M: [f64; 2] = [0.05, 0.2];
/// Least side of a room, metres.
const ROOM_M: f64 = 2.2;
/// Wall that stays on each side of a door, metres.
const JAMB_M: f64 = 0.1;

/// From (x0, y0) to (x1, y1).
type Area = [f64; 4];

/// The floor being divided.
#[derive(Default)]
struct Floor {
    corridors: Vec<Area>,
    rooms: Vec<Area>,
    /// Longest side of a room before it is divided, metres.
    longest_m: f64,
}

/// Two areas on both sides of a wall.
#[derive(Clone, Copy, Debug)]
struct Wall {
    /// Indices of the areas: corridors first, then rooms.
    areas: [usize; 2],
    /// The part of the wall between them.
    part: Area,
    /// Axis along which the wall runs.
    axis: usize,
}

/// Draws it.
pub(super) fn draw(dice: &mut Dice, size_m: Option<[f64; 2]>) -> Sheet {
    let free_m = super::free_size_m(dice);
    let mut sheet = Sheet::maybe_turned(dice, size_m.unwrap_or(free_m));
    let [w, h] = sheet.size_m();
    let outer_m = dice.metres(0.1, 0.3);
    let mut floor = Floor {
        longest_m: dice.between(4.0, 8.0),
        ..Floor::default()
    };
    let inside = [outer_m, outer_m, w - outer_m, h - outer_m];
    floor.divide(dice, inside, usize::from(w < h), 0);
    for area in floor.corridors.iter().chain(&floor.rooms) {
        sheet.rect(Class::Free, *area);
    }
    floor.join(dice, &mut sheet);
    let density = dice.between(0.3, 1.0);
    for area in &floor.rooms {
        Room::new(&sheet, *area).furnish(dice, &mut sheet, density);
    }
    floor.corridor_pieces(dice, &mut sheet);
    sheet
}

impl Floor {
    /// Divides an area by a corridor along an axis, and both parts by corridors across it; an area
    /// without room for a corridor becomes rooms.
    fn divide(&mut self, dice: &mut Dice, area: Area, axis: usize, depth: u32) {
        let across = 1 - axis;
        let width_m = dice.metres(CORRIDOR_M[0], CORRIDOR_M[1]);
        let [low, high] = [area[across], area[across + 2]];
        let walls = [0; 2].map(|_| dice.metres(WALL_M[0], WALL_M[1]));
        let least_m = ROOM_M + 0.4;
        let spare_m = high - low - width_m - walls[0] - walls[1] - 2.0 * least_m;
        let wanted = depth == 0 || spare_m > 2.0 && dice.chance(0.75);
        if spare_m <= 0.0 || !wanted || depth > 3 {
            self.divide_rooms(dice, area);
            return;
        }
        let from = low + least_m + walls[0] + dice.metres(0.25 * spare_m, 0.75 * spare_m);
        let [mut corridor, mut first, mut second] = [area; 3];
        (corridor[across], corridor[across + 2]) = (from, from + width_m);
        first[across + 2] = from - walls[0];
        second[across] = from + width_m + walls[1];
        self.corridors.push(corridor);
        self.divide(dice, first, across, depth + 1);
        self.divide(dice, second, across, depth + 1);
    }

    /// Divides an area by walls until its rooms are short enough.
    fn divide_rooms(&mut self, dice: &mut Dice, area: Area) {
        let sides = [area[2] - area[0], area[3] - area[1]];
        let axis = usize::from(sides[1] > sides[0]);
        let wall_m = dice.metres(WALL_M[0], WALL_M[1]);
        let spare_m = sides[axis] - wall_m - 2.0 * ROOM_M;
        if sides[axis] <= self.longest_m || spare_m <= 0.0 {
            self.rooms.push(area);
            return;
        }
        let at = area[axis] + ROOM_M + dice.metres(0.0, spare_m);
        let [mut first, mut second] = [area; 2];
        first[axis + 2] = at;
        second[axis] = at + wall_m;
        self.divide_rooms(dice, first);
        self.divide_rooms(dice, second);
    }

    /// Opens corridors into one another, gives rooms their doors, and adds doors and slits.
    fn join(&self, dice: &mut Dice, sheet: &mut Sheet) {
        let corridors = self.corridors.len();
        let count = corridors + self.rooms.len();
        let mut walls = self.walls();
        dice.shuffle(&mut walls);
        // Corridors with corridors, then rooms with corridors, then rooms with rooms.
        walls.sort_by_key(|wall| wall.areas.iter().filter(|&&area| area >= corridors).count());
        let isolated: Vec<bool> = (0..count)
            .map(|area| area >= corridors && dice.chance(0.05))
            .collect();
        let mut group: Vec<usize> = (0..count).collect();
        for wall in walls {
            let [a, b] = wall.areas;
            if isolated[a] || isolated[b] {
                continue;
            }
            let (one, other) = (group[a], group[b]);
            let between_corridors = a.max(b) < corridors;
            if one != other || between_corridors || dice.chance(0.15) {
                group
                    .iter_mut()
                    .filter(|g| **g == other)
                    .for_each(|g| *g = one);
                if between_corridors && dice.chance(0.7) {
                    sheet.rect(Class::Free, wall.part);
                } else {
                    open(dice, sheet, &wall);
                }
            } else if dice.chance(0.1) {
                slit(dice, sheet, &wall);
            }
        }
        for (area, _) in self
            .rooms
            .iter()
            .zip(&isolated[corridors..])
            .filter(|(_, is)| **is)
        {
            if dice.chance(0.5) {
                sheet.rect(Class::Unknown, *area);
            }
        }
    }

    /// Lists the walls between two areas that have room for a door.
    fn walls(&self) -> Vec<Wall> {
        let areas: Vec<Area> = self.corridors.iter().chain(&self.rooms).copied().collect();
        let mut walls = Vec::new();
        for (a, one) in areas.iter().enumerate() {
            for (b, other) in areas.iter().enumerate() {
                for axis in [0, 1] {
                    let across = 1 - axis;
                    let thick_m = other[across] - one[across + 2];
                    let from = one[axis].max(other[axis]);
                    let to = one[axis + 2].min(other[axis + 2]);
                    let behind = thick_m > 0.0 && thick_m < WALL_M[1] + 0.01;
                    if !behind || to - from < DOOR_M[0] + 2.0 * JAMB_M {
                        continue;
                    }
                    let mut part = [0.0; 4];
                    (part[axis], part[axis + 2]) = (from, to);
                    (part[across], part[across + 2]) = (one[across + 2], other[across]);
                    walls.push(Wall {
                        areas: [a, b],
                        part,
                        axis,
                    });
                }
            }
        }
        walls
    }

    /// Boxes along the walls of corridors, which leave a passage.
    fn corridor_pieces(&self, dice: &mut Dice, sheet: &mut Sheet) {
        for area in &self.corridors {
            let axis = usize::from(area[3] - area[1] > area[2] - area[0]);
            let across = 1 - axis;
            let [long_m, wide_m] = [axis, across].map(|k| area[k + 2] - area[k]);
            for _ in 0..(long_m / 6.0) as usize {
                let passage_m = dice.metres(0.7, 1.0);
                let deep_m = (wide_m - passage_m).min(0.6);
                let piece_m = dice.metres(0.4, 1.5);
                let at = area[axis] + dice.metres(0.0, (long_m - piece_m).max(0.0));
                let mut piece = *area;
                (piece[axis], piece[axis + 2]) = (at, at + piece_m);
                if dice.chance(0.5) {
                    piece[across + 2] = area[across] + deep_m;
                } else {
                    piece[across] = area[across + 2] - deep_m;
                }
                let middle = [(piece[0] + piece[2]) / 2.0, (piece[1] + piece[3]) / 2.0];
                let reach_m = 1.2 + piece_m;
                let clear = sheet
                    .doors()
                    .iter()
                    .all(|door| !door.is_near(middle, reach_m));
                if clear && deep_m > 0.15 && dice.chance(0.6) {
                    sheet.rect(Class::Wall, piece);
                }
            }
        }
    }
}

/// Opens a door in a wall.
fn open(dice: &mut Dice, sheet: &mut Sheet, wall: &Wall) {
    let long_m = wall.part[wall.axis + 2] - wall.part[wall.axis];
    let width_m = dice.metres(DOOR_M[0], DOOR_M[1].min(long_m - 2.0 * JAMB_M));
    let (middle, along, thick_m) = place(dice, wall, width_m);
    let door = Door {
        middle,
        along,
        width_m,
    };
    sheet.door(door, thick_m);
}

/// Cuts a slit into a wall, unless a door is near.
fn slit(dice: &mut Dice, sheet: &mut Sheet, wall: &Wall) {
    let (middle, along, thick_m) = place(dice, wall, SLIT_M);
    if sheet.doors().iter().all(|door| !door.is_near(middle, 1.5)) {
        let half = [SLIT_M / 2.0, thick_m / 2.0 + 1e-6];
        sheet.slab(Class::Free, middle, half, along);
    }
}

/// Draws the place of an opening; returns its middle, the direction of the wall, its thickness.
fn place(dice: &mut Dice, wall: &Wall, width_m: f64) -> ([f64; 2], [f64; 2], f64) {
    let (axis, across) = (wall.axis, 1 - wall.axis);
    let long_m = wall.part[axis + 2] - wall.part[axis];
    let from = dice.metres(JAMB_M, long_m - width_m - JAMB_M);
    let (mut middle, mut along) = ([0.0; 2], [0.0; 2]);
    middle[axis] = wall.part[axis] + from + width_m / 2.0;
    middle[across] = (wall.part[across] + wall.part[across + 2]) / 2.0;
    along[axis] = 1.0;
    (middle, along, wall.part[across + 2] - wall.part[across])
}

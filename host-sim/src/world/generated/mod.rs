//! Generated worlds: mazes, furnished rooms and dungeons, drawn from a seed.
//!
//! `KIND:SEED` names a world, and `KIND:SEED:WIDTHxHEIGHT` one of a given size in metres. All are
//! flat, with cells of 5 cm. The seed decides everything, on every machine: size, angle to the
//! grid, walls, doors, furniture, ragged edges and the start.
//!
//! A drawing counts only if most of the places where the robot fits are connected
//! ([`LEAST_SHARE`]). If they are not, the same stream of choices draws again.

mod dice;
mod dungeon;
mod furniture;
mod maze;
mod name;
mod rooms;
mod sheet;

use super::{Start, World, WorldError};
use crate::metrics::CellSet;
use crate::robot::RADIUS_M;
use crate::world::occupancy::GridCell;
use dice::Dice;
use name::Name;
use sheet::{Door, Drawing};

/// Width of doors, least and most, metres. The robot is 0.50 m wide and keeps 0.05 m on each side.
const DOOR_M: [f64; 2] = [0.65, 1.2];
/// Width of slits, metres: lasers see through, the robot does not fit.
const SLIT_M: f64 = 0.5;
/// Least and greatest size if none is given, metres.
const FREE_SIZE_M: [[f64; 2]; 2] = [[15.0, 12.0], [40.0, 30.0]];
/// Free space around a start, metres: the robot's corner is 0.36 m from its middle.
const ROOM_M: f64 = 0.5;
/// Distance of a start from the middle of a door, metres.
const DOORWAY_M: f64 = 0.8;
/// Least share, of the places where the robot fits, that it reaches from the start.
const LEAST_SHARE: f64 = 0.6;
/// Number of drawings that are tried.
const DRAWINGS: u32 = 50;

/// Kind of a generated world.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Corridors of one width.
    Maze,
    /// Furnished rooms along corridors.
    Rooms,
    /// Caves and rooms joined by winding passages.
    Dungeon,
}

/// All kinds, in the order of the list.
pub const KINDS: [Kind; 3] = [Kind::Maze, Kind::Rooms, Kind::Dungeon];

impl Kind {
    /// The word that begins the name of such a world.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Maze => "maze",
            Self::Rooms => "rooms",
            Self::Dungeon => "dungeon",
        }
    }

    /// A description in one line.
    #[must_use]
    pub const fn description(self) -> &'static str {
        match self {
            Self::Maze => "A maze of corridors of 0.8 to 2 m with loops and dead ends",
            Self::Rooms => "Furnished rooms along corridors, doors of 0.65 to 1.2 m",
            Self::Dungeon => "Caves and rooms joined by winding passages",
        }
    }
}

/// Draws a generated world by name. Returns `None` if the name is not that of a generated world.
pub(super) fn open(text: &str) -> Option<Result<World, WorldError>> {
    let name = match Name::parse(text)? {
        Ok(name) => name,
        Err(error) => return Some(Err(error)),
    };
    let error = || WorldError::Generated {
        name: text.to_owned(),
        reason: "no drawing of this seed has room for the robot; \
                 choose another seed or a larger size"
            .to_owned(),
    };
    Some(draw(&name).map(|(world, _)| world).ok_or_else(error))
}

/// Draws until a drawing has a start; returns the world and its drawing.
fn draw(name: &Name) -> Option<(World, Drawing)> {
    let mut dice = Dice::new(name.seed);
    (0..DRAWINGS).find_map(|_| {
        let sheet = match name.kind {
            Kind::Maze => maze::draw(&mut dice, name.size_m),
            Kind::Rooms => rooms::draw(&mut dice, name.size_m),
            Kind::Dungeon => dungeon::draw(&mut dice, name.size_m),
        };
        let ragged = dice.chance(0.5);
        let share = if ragged { dice.between(0.05, 0.3) } else { 0.0 };
        let drawing = sheet.finish(&mut dice, share);
        let bare = World::flat(&name.to_string(), drawing.plan.clone(), Vec::new());
        let start = start(&mut dice, &bare, &drawing.doors)?;
        Some((bare.with_start(start), drawing))
    })
}

/// Draws a size for a world that is given none, metres.
fn free_size_m(dice: &mut Dice) -> [f64; 2] {
    let [[w0, h0], [w1, h1]] = FREE_SIZE_M;
    [dice.metres(w0, w1), dice.metres(h0, h1)]
}

/// Draws a start in the largest region that the robot's disc reaches; `None` if that is less than
/// [`LEAST_SHARE`] of all places where it fits, or if it can turn nowhere there, away from doors.
fn start(dice: &mut Dice, world: &World, doors: &[Door]) -> Option<Start> {
    let grid = world.occupancy();
    let fits = |cell| world.distance().from_centre_m(cell) >= RADIUS_M - 1e-9;
    let cells = || {
        let rows = 0..grid.height() as i64;
        rows.flat_map(|j| (0..grid.width() as i64).map(move |i| GridCell { i, j }))
    };
    let mut regions: Vec<CellSet> = Vec::new();
    let mut all = 0;
    for cell in cells().filter(|&cell| fits(cell)) {
        all += 1;
        if !regions.iter().any(|region| region.contains(cell)) {
            let [x_m, y_m] = grid.centre(cell);
            let from = Start {
                x_m,
                y_m,
                yaw_rad: 0.0,
            };
            regions.push(CellSet::flood(world, from, fits));
        }
    }
    let largest = regions.iter().max_by_key(|region| region.count())?;
    if (largest.count() as f64) < LEAST_SHARE * f64::from(all) {
        return None;
    }
    let places: Vec<GridCell> = cells()
        .filter(|&cell| largest.contains(cell) && world.distance().from_centre_m(cell) >= ROOM_M)
        .filter(|&cell| {
            doors
                .iter()
                .all(|door| !door.is_near(grid.centre(cell), DOORWAY_M))
        })
        .collect();
    let [x_m, y_m] = grid.centre(*places.get(dice.index(places.len()))?);
    // Thousandths, so that a world file can hold the start exactly.
    let [x_m, y_m, yaw_rad] = [x_m, y_m, dice.between(-3.1, 3.1)].map(short);
    Some(Start { x_m, y_m, yaw_rad })
}

fn short(number: f64) -> f64 {
    (number * 1000.0).round() / 1000.0
}

#[cfg(test)]
mod tests;

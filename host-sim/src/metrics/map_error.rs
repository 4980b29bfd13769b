//! How far the map's walls are from the true ones.
//!
//! ```text
//! T   = argmin Σ min(d(T c), 0.5 m)²        the best rigid alignment of the whole map
//! wall error = d(T c),   ghost: d(T c) > 0.3 m
//! ```
//!
//! c are the centres of the map's obstacle cells, and d is the distance to the nearest true
//! surface. The inside of a rock is no surface, so a wall that the map draws there is a ghost too.
//! A map that is shifted or turned as a whole has no error: nobody can know where the start lies.
//!
//! T is found by a pattern search from the identity, so a map that folds over itself by metres has
//! a large error with every T.
//!
//! Units: metres, radians.

use crate::report::{GridMap, MapCell};
use crate::world::{Class, DistanceField, GridCell, Occupancy, Start, World};

use super::{CellSet, MAP_CELL_M};

/// Distance beyond which an obstacle cell is a ghost, metres.
pub const GHOST_M: f64 = 0.3;
/// Distance that counts most in the alignment, metres: ghosts must not pull.
const MOST_M: f64 = 0.5;
/// Margin around the world, metres.
const MARGIN_M: f64 = 5.0;
/// First and last step of the pattern search, metres; a step of the turn moves a cell 10 m away by
/// as much.
const STEPS_M: (f64, f64) = (0.4, 0.005);
/// Arm of the turn, metres.
const ARM_M: f64 = 10.0;
/// Greatest number of cells that the alignment looks at.
const MOST_CELLS: usize = 1_500;

/// Errors of a map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapError {
    /// Median distance of an obstacle cell to a true surface, metres.
    pub wall_p50_m: f64,
    /// 95th percentile of that distance, metres.
    pub wall_p95_m: f64,
    /// Share of the obstacle cells that are ghosts.
    pub ghost_share: f64,
}

/// The true surfaces.
struct Surfaces {
    grid: Occupancy,
    distance: DistanceField,
}

impl Surfaces {
    fn of(world: &World) -> Self {
        let grid = world.occupancy();
        let resolution_m = grid.resolution_m();
        let margin = (MARGIN_M / resolution_m).ceil() as i64;
        let origin_m = grid.origin_m().map(|at| at - margin as f64 * resolution_m);
        let [width, height] =
            [grid.width(), grid.height()].map(|cells| cells + 2 * margin as usize);
        let mut surfaces = Occupancy::filled(width, height, resolution_m, origin_m, Class::Free);
        for j in -1..=grid.height() as i64 {
            for i in -1..=grid.width() as i64 {
                let solid = |di, dj| {
                    grid.is_solid(GridCell {
                        i: i + di,
                        j: j + dj,
                    })
                };
                let beside = [(1, 0), (-1, 0), (0, 1), (0, -1)];
                if solid(0, 0) && beside.iter().any(|&(di, dj)| !solid(di, dj)) {
                    let cell = GridCell {
                        i: i + margin,
                        j: j + margin,
                    };
                    surfaces.set(cell, Class::Wall);
                }
            }
        }
        Self {
            distance: DistanceField::new(&surfaces),
            grid: surfaces,
        }
    }

    fn distance_m(&self, [x, y]: [f64; 2]) -> f64 {
        let cell = self.grid.cell_at(x, y);
        match cell.index([self.grid.width(), self.grid.height()]) {
            Some(_) => self.distance.from_centre_m(cell),
            None => MARGIN_M,
        }
    }
}

/// A shift and a turn about the middle of the map.
#[derive(Clone, Copy, Debug)]
struct Rigid {
    shift_m: [f64; 2],
    turn_rad: f64,
}

impl Rigid {
    fn apply(self, middle: [f64; 2], [x, y]: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = (libm::sin(self.turn_rad), libm::cos(self.turn_rad));
        let (dx, dy) = (x - middle[0], y - middle[1]);
        [
            middle[0] + self.shift_m[0] + cos * dx - sin * dy,
            middle[1] + self.shift_m[1] + sin * dx + cos * dy,
        ]
    }
}

/// Judges a map; `None` if it has no obstacle.
#[must_use]
pub fn map_error(world: &World, map: &GridMap) -> Option<MapError> {
    let cells = obstacles(map);
    if cells.is_empty() {
        return None;
    }
    let surfaces = Surfaces::of(world);
    let count = cells.len() as f64;
    let middle = [0, 1].map(|k| cells.iter().map(|at| at[k]).sum::<f64>() / count);
    let best = align(&surfaces, &cells, middle);
    let distances = cells.iter();
    let distances = distances.map(|&at| surfaces.distance_m(best.apply(middle, at)));
    let mut distances: Vec<f64> = distances.collect();
    distances.sort_by(f64::total_cmp);
    let ghosts = distances.iter().filter(|&&m| m > GHOST_M).count();
    let rank = |share: f64| distances[((share * count).ceil() as usize).max(1) - 1];
    Some(MapError {
        wall_p50_m: rank(0.5),
        wall_p95_m: rank(0.95),
        ghost_share: ghosts as f64 / count,
    })
}

/// Returns the share of the true walls that the map has; `None` without walls.
///
/// A wall is a solid cell with an edge in common with floor that is connected with the start. The
/// map has it if one of its obstacle cells, aligned as in [`map_error`], is within [`GHOST_M`].
#[must_use]
pub fn walls_share(world: &World, start: Start, map: &GridMap) -> Option<f64> {
    let walls = walls(world, start);
    let cells = obstacles(map);
    if walls.is_empty() || cells.is_empty() {
        return (!walls.is_empty()).then_some(0.0);
    }
    let count = cells.len() as f64;
    let middle = [0, 1].map(|k| cells.iter().map(|at| at[k]).sum::<f64>() / count);
    let best = align(&Surfaces::of(world), &cells, middle);
    let grid = world.occupancy();
    let resolution_m = grid.resolution_m();
    let margin = (GHOST_M / resolution_m).ceil();
    let origin_m = grid.origin_m().map(|at| at - margin * resolution_m);
    let [width, height] = [grid.width(), grid.height()].map(|it| it + 2 * margin as usize);
    let mut held = Occupancy::filled(width, height, resolution_m, origin_m, Class::Free);
    for at in cells {
        let [x, y] = best.apply(middle, at);
        held.set(held.cell_at(x, y), Class::Wall);
    }
    let distance = DistanceField::new(&held);
    let found = walls.iter().filter(|cell| {
        let [x, y] = grid.centre(**cell);
        distance.from_centre_m(held.cell_at(x, y)) <= GHOST_M
    });
    Some(found.count() as f64 / walls.len() as f64)
}

/// Returns the solid cells beside the floor that is connected with the start.
fn walls(world: &World, start: Start) -> Vec<GridCell> {
    let grid = world.occupancy();
    let floor = CellSet::free(world, start);
    let mut walls = Vec::new();
    for j in -1..=grid.height() as i64 {
        for i in -1..=grid.width() as i64 {
            let beside = [(1, 0), (-1, 0), (0, 1), (0, -1)];
            let is_floor = |(di, dj)| {
                floor.contains(GridCell {
                    i: i + di,
                    j: j + dj,
                })
            };
            let cell = GridCell { i, j };
            if grid.is_solid(cell) && beside.into_iter().any(is_floor) {
                walls.push(cell);
            }
        }
    }
    walls
}

/// Returns the centres of the obstacle cells.
fn obstacles(map: &GridMap) -> Vec<[f64; 2]> {
    let (width, height) = (map.width as i32, map.height as i32);
    let cells = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let cells = cells.map(|(x, y)| (x + map.origin_x, y + map.origin_y));
    cells
        .filter(|&(x, y)| map.get(x, y) == MapCell::Obstacle)
        .map(|(x, y)| [x, y].map(|k| (f64::from(k) + 0.5) * MAP_CELL_M))
        .collect()
}

/// Returns the best alignment.
fn align(surfaces: &Surfaces, cells: &[[f64; 2]], middle: [f64; 2]) -> Rigid {
    let some = || cells.iter().step_by(cells.len().div_ceil(MOST_CELLS));
    let cost = |rigid: Rigid| -> f64 {
        let each = some().map(|&at| surfaces.distance_m(rigid.apply(middle, at)).min(MOST_M));
        each.map(|m| m * m).sum()
    };
    let mut best = Rigid {
        shift_m: [0.0; 2],
        turn_rad: 0.0,
    };
    let mut least = cost(best);
    let mut step_m = STEPS_M.0;
    while step_m >= STEPS_M.1 {
        let mut moves = Vec::new();
        for way in [step_m, -step_m] {
            let [x, y] = best.shift_m;
            moves.extend([
                Rigid {
                    shift_m: [x + way, y],
                    ..best
                },
                Rigid {
                    shift_m: [x, y + way],
                    ..best
                },
                Rigid {
                    turn_rad: best.turn_rad + way / ARM_M,
                    ..best
                },
            ]);
        }
        let costs = moves.into_iter().map(|it| (cost(it), it));
        match costs.min_by(|a, b| a.0.total_cmp(&b.0)) {
            Some((cost, it)) if cost < least => (least, best) = (cost, it),
            _ => step_m *= 0.5,
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::{map_error, walls_share};
    use crate::report::{GridMap, MapCell};
    use crate::world::{Start, World};

    /// A room of 8 × 6 m with walls of 0.2 m and a box.
    fn room() -> World {
        let row = |y: usize| -> String {
            let is_wall = |x: usize| {
                let at_edge = !(2..=79).contains(&x) || !(2..60).contains(&y);
                at_edge || ((20..30).contains(&x) && (15..20).contains(&y))
            };
            (0..82)
                .map(|x| if is_wall(x) { '#' } else { '.' })
                .collect()
        };
        let rows: Vec<String> = (0..62).map(row).collect();
        let rows: Vec<&str> = rows.iter().map(String::as_str).collect();
        World::picture("room", 0.1, &rows)
    }

    /// Returns the map of the room's surfaces, turned and shifted.
    fn map(turn: f64, [right, up]: [f64; 2]) -> GridMap {
        let mut map = GridMap::unknown(-40, -40, 200, 200);
        let world = room();
        let grid = world.occupancy();
        for (i, j) in (0_i64..82).flat_map(|i| (0_i64..62).map(move |j| (i, j))) {
            let solid = |di, dj| {
                grid.is_solid(crate::world::GridCell {
                    i: i + di,
                    j: j + dj,
                })
            };
            let inner = solid(1, 0) && solid(-1, 0) && solid(0, 1) && solid(0, -1);
            if solid(0, 0) && !inner {
                let (x, y) = (0.1 * (i as f64 + 0.5), 0.1 * (j as f64 + 0.5));
                let (x, y) = (
                    x * turn.cos() - y * turn.sin() + right,
                    x * turn.sin() + y * turn.cos() + up,
                );
                let cell = [x, y].map(|at| (at * 10.0).floor() as i32);
                map.set(cell[0], cell[1], MapCell::Obstacle);
            }
        }
        map
    }

    #[test]
    fn a_map_that_is_moved_as_a_whole_has_no_error() {
        let exact = map_error(&room(), &map(0.0, [0.0, 0.0])).expect("walls");
        assert!(
            exact.wall_p95_m < 1e-9 && exact.ghost_share == 0.0,
            "{exact:?}"
        );
        let moved = map_error(&room(), &map(0.06, [0.35, -0.25])).expect("walls");
        assert!(moved.wall_p95_m <= 0.12, "{moved:?}");
        assert_eq!(moved.ghost_share, 0.0);
    }

    #[test]
    fn a_map_has_the_share_of_the_walls_that_it_has() {
        let start = Start {
            x_m: 1.0,
            y_m: 1.0,
            ..Start::default()
        };
        let share = |map: &GridMap| walls_share(&room(), start, map).expect("walls");
        assert_eq!(share(&map(0.0, [0.0, 0.0])), 1.0);
        assert!(share(&map(0.06, [0.35, -0.25])) > 0.98);
        assert_eq!(share(&GridMap::unknown(0, 0, 5, 5)), 0.0);
        let mut half = map(0.0, [0.0, 0.0]);
        for (x, y) in (0..82).flat_map(|x| (31..70).map(move |y| (x, y))) {
            half.set(x, y, MapCell::Free);
        }
        // The box is in the half that is gone.
        assert!((0.4..0.6).contains(&share(&half)), "{}", share(&half));
    }

    #[test]
    fn a_wall_in_the_room_or_in_the_rock_is_a_ghost() {
        let mut ghosts = map(0.0, [0.0, 0.0]);
        for y in 30..50 {
            ghosts.set(50, y, MapCell::Obstacle);
        }
        for y in 10..20 {
            ghosts.set(-20, y, MapCell::Obstacle);
        }
        let error = map_error(&room(), &ghosts).expect("walls");
        assert!((0.05..0.12).contains(&error.ghost_share), "{error:?}");
        assert!(error.wall_p50_m < 0.01);
        assert_eq!(map_error(&room(), &GridMap::unknown(0, 0, 5, 5)), None);
    }
}

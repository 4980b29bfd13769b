//! A look into a device that lives in this process, without a request.
//!
//! ```text
//! direct, loopback   the planner's own memory: map, skeleton, path, local goal
//! qemu, serial       nothing: the host has its copy of the map, and what the replies say
//! ```
//!
//! A look costs the device nothing and changes nothing: no frame is sent, no clock goes on, no
//! fault is drawn. So a run that is looked at has the same commands.
//!
//! Units: tiles of 32 × 32 map cells of 10 cm; metres.

use fieldline_planner::planner::host_copy;
use fieldline_planner::{CellKind, FIELD_SIDE, State, Workspace};

use crate::report::grid_map::CELL_M;
use crate::trial::planned_path::PlannedPath;
use crate::trial::snapshot::{Window, WindowCell};

/// Column and row of a tile.
pub type Key = (i16, i16);

/// Most cells of a local goal that are told.
const GOAL_CELLS: usize = 64;

/// What can be read of a device in this process.
pub trait Inside {
    /// Returns the number of the map's changes so far; it wraps.
    fn edits(&self) -> u32;
    /// Returns the tiles in which something was measured.
    fn tiles(&self) -> Vec<Key>;
    /// Returns the cells of a tile, two bits each, least x and y first: 0 unknown, 1 free, 2
    /// obstacle, 3 negative obstacle.
    fn cells(&self, tile: Key) -> Option<[u8; 256]>;
    /// Returns the skeleton of a tile: 16 rows of 16 roadmap cells, least x in the lowest bit.
    fn skeleton(&self, tile: Key) -> [u16; 16];
    /// Returns the path to the goal.
    fn path(&self) -> PlannedPath;
    /// Returns the middles of the window's goal cells, metres: where the field leads now.
    fn local_goal(&self) -> Vec<[f64; 2]>;
    /// Returns the last window's field; `None` before the first window.
    fn field(&self) -> Option<Window>;
}

/// The memory of a planner in this process.
#[derive(Clone, Copy, Debug)]
pub struct Look<'a, const TILES: usize, const SLOTS: usize> {
    /// Map and state of the strategy.
    pub state: &'a State<TILES, SLOTS>,
    /// The last window.
    pub workspace: &'a Workspace,
}

impl<const TILES: usize, const SLOTS: usize> Inside for Look<'_, TILES, SLOTS> {
    fn edits(&self) -> u32 {
        host_copy::map(self.state).tiles().edits()
    }

    fn tiles(&self) -> Vec<Key> {
        let touched = host_copy::map(self.state).tiles().touched();
        touched.map(|(x, y)| (x as i16, y as i16)).collect()
    }

    fn cells(&self, (x, y): Key) -> Option<[u8; 256]> {
        self.state.tile(x, y)
    }

    fn skeleton(&self, (x, y): Key) -> [u16; 16] {
        self.state.tile_skeleton(x, y)
    }

    fn path(&self) -> PlannedPath {
        let short = |at: i32| at.clamp(i16::MIN.into(), i16::MAX.into()) as i16;
        let place = |cell: fieldline_planner::geometry::Cell| (short(cell.x), short(cell.y));
        PlannedPath {
            tractor: self.state.tractor().map(place),
            shield: self.state.shield().map(|ends| ends.map(place)),
            cells: self.state.path().iter().copied().map(place).collect(),
        }
    }

    fn local_goal(&self) -> Vec<[f64; 2]> {
        let Some(first) = self.workspace.field_row(0) else {
            return Vec::new();
        };
        let window = self.workspace.window();
        let side_m = CELL_M * f64::from(first.scale.max(1));
        let [x_m, y_m] = [first.origin.x, first.origin.y].map(|at| f64::from(at) * CELL_M);
        let places = (0..FIELD_SIDE).flat_map(|y| (0..FIELD_SIDE).map(move |x| (x, y)));
        let goals = places.filter(|&(x, y)| window.is_goal(x, y));
        let middle = |at: usize| (at as f64 + 0.5) * side_m;
        let middles = goals.map(|(x, y)| [x_m + middle(x), y_m + middle(y)]);
        middles.take(GOAL_CELLS).collect()
    }

    fn field(&self) -> Option<Window> {
        let rows = (0..FIELD_SIDE as u8).filter_map(|row| self.workspace.field_row(row));
        let rows: Vec<_> = rows.collect();
        let first = rows.first()?;
        let scale = i32::from(first.scale.max(1));
        let kind = |kind| match kind {
            CellKind::Free => WindowCell::Free,
            CellKind::Obstacle => WindowCell::Obstacle,
            CellKind::Goal => WindowCell::Goal,
        };
        Some(Window {
            origin_x: first.origin.x.div_euclid(scale),
            origin_y: first.origin.y.div_euclid(scale),
            cell_m: CELL_M * f64::from(scale),
            q: rows.iter().flat_map(|row| row.q).collect(),
            cells: rows.iter().flat_map(|row| row.kinds.map(kind)).collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use crate::link::Link;
    use crate::link::direct::Direct;
    use crate::link::loopback::loopback;
    use crate::sim::{SimConfig, Simulator};
    use crate::trial::planned_path;
    use crate::trial::snapshot::{self, WindowCell};
    use crate::world::World;
    use fieldline_protocol::message::{Control, Strategy};

    fn seen(link: &mut dyn Link) {
        let world = World::builtin("office").unwrap();
        let mut sim = Simulator::new(&world, SimConfig::default()).unwrap();
        link.hello().unwrap();
        let start = sim.start_message(Strategy::Frontier);
        link.control(&Control::Start(start)).unwrap();
        for _ in 0..40 {
            let command = link.observe(&sim.observe()).unwrap();
            sim.drive(Some(command.velocity));
        }
        let sent = link.end().stats().sent;
        let (tiles, path, goal) = {
            let inside = link.end().inside().expect("a device in this process");
            assert!(inside.edits() > 0);
            let tiles: Vec<_> = (inside.tiles().into_iter())
                .map(|key| (key, inside.cells(key), inside.skeleton(key)))
                .collect();
            (tiles, inside.path(), inside.local_goal())
        };
        assert_eq!(link.end().stats().sent, sent, "a look sends nothing");
        assert!(tiles.len() > 3 && !goal.is_empty());
        for ((x, y), cells, skeleton) in tiles {
            let Some(told) = link.tile(x, y).unwrap() else {
                assert_eq!(cells, None);
                continue;
            };
            assert_eq!(
                cells.as_ref().map(|it| it.as_slice()),
                Some(told.cells.as_slice())
            );
            let rows: Vec<u8> = skeleton.iter().flat_map(|row| row.to_le_bytes()).collect();
            assert_eq!(rows, told.skeleton.as_slice());
        }
        assert_eq!(planned_path::read(link).unwrap(), path);
        let window = snapshot::window(link).unwrap().expect("a window");
        let goals = (window.cells.iter()).filter(|cell| **cell == WindowCell::Goal);
        assert_eq!(goals.count().min(super::GOAL_CELLS), goal.len());
    }

    #[test]
    fn a_look_tells_what_the_requests_tell() {
        seen(&mut Direct::new());
        seen(&mut loopback());
    }
}

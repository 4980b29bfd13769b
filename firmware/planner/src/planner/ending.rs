//! The end of an exploration: the residual frontiers and the reason \[Jorge15, Algorithm 1, line
//! 26\].
//!
//! Units: map cells.

use crate::field::local_grid::LocalGrid;
use crate::geometry::Cell;
use crate::map::Tiles;
use crate::map::tiles::NoRoom;
use crate::path::map_exits::Inputs;
use crate::planner::step::Step;
use crate::status::{Fault, Finish, Status};

/// Below this room for its centre the robot is boxed in, cells: one square metre.
const BOX_CELLS: u32 = 100;

impl<const TILES: usize, const SLOTS: usize> Step<'_, TILES, SLOTS> {
    /// Ends the exploration in this step: lists the residual frontiers and sets the status, or
    /// begins the patrol. `missing` is the room that the map lacks for what the robot can reach.
    pub(super) fn end_now(&mut self, missing: Option<NoRoom>) {
        const DONE: Status = Status::Finished(Finish::Explored);
        if self.state.strategy.is_patrolling() {
            // The residual frontiers were listed before the patrol.
            self.state.status = DONE;
            return;
        }
        let state = &mut *self.state;
        state.strategy.frontier.list_unreachable(&state.skeleton);
        if missing.is_none() && self.looks_again() {
            return;
        }
        let status = self.conclude(missing);
        if status != DONE || !self.state.strategy.begin_patrol() {
            self.state.status = status;
        }
    }

    /// Begins a second look if one may help and something came: takes it for gone. Returns true if
    /// it does. On uneven ground nothing is known to have come.
    fn looks_again(&mut self) -> bool {
        let robot = self.robot().cell();
        let state = &mut *self.state;
        if state.ground.is_uneven() || !state.map.has_arrivals() {
            return false;
        }
        let known_cells = state.map.known_cells();
        let frontier = &mut state.strategy.frontier;
        let begins = frontier.may_look_again(known_cells, self.input.time_ms);
        if begins {
            frontier.look_again();
            state.forget_arrivals(self.config, robot);
            state.forgot_arrivals = true;
        }
        begins
    }

    /// Continues the search for reachable cells beyond which the map has no room; lists them and
    /// ends the exploration. Cells beyond the map that cannot be reached do not count.
    #[inline(never)]
    pub(super) fn search_exits(&mut self) {
        let robot = self.robot().cell();
        let state = &mut *self.state;
        let inputs = Inputs {
            tiles: state.map.tiles(),
            // The skeleton stays the same while the search runs.
            tiling: state.skeleton.tiling(),
            frame: state.skeleton.frame(),
            footprint: &self.footprint,
            robot,
        };
        let scratch = bytemuck::cast_slice_mut(&mut self.workspace.scratch);
        let frontier = &mut state.strategy.frontier;
        let mut missing = None;
        state.exits.advance(&inputs, scratch, |cell, room| {
            missing = Some(room);
            frontier.list_map_exit(cell);
        });
        if !self.state.exits.is_running() {
            self.end_now(missing);
        }
    }

    /// Returns the status that tells why no frontier can be reached.
    fn conclude(&mut self, missing: Option<NoRoom>) -> Status {
        let (robot, tiles) = (self.robot().cell(), self.state.map.tiles());
        let local_grid = &mut self.workspace.local_grid;
        local_grid.update(tiles, &self.footprint, robot, 1);
        local_grid.free_robot(robot);
        match missing {
            Some(NoRoom::Pool | NoRoom::Later) => Status::Fault(Fault::MapFull),
            Some(NoRoom::Box) => Status::Fault(Fault::OutOfBox),
            None if self.state.strategy.frontier.is_stuck() => Status::Fault(Fault::Stuck),
            None if room_cells(tiles, local_grid, robot) < BOX_CELLS => {
                Status::Finished(Finish::BoxedIn)
            }
            None => Status::Finished(Finish::Explored),
        }
    }
}

/// Returns the number of explored window cells that the robot's centre can reach. What is left
/// unexplored at the end is no room.
fn room_cells<const TILES: usize, const SLOTS: usize>(
    tiles: &Tiles<TILES, SLOTS>,
    local_grid: &LocalGrid,
    robot: Cell,
) -> u32 {
    let mut reader = tiles.reader(local_grid.origin.x);
    let ys = local_grid.origin.y..;
    let Some(rows) = local_grid.reachable(robot) else {
        return 0;
    };
    let explored = |(row, y): (&u64, i32)| (row & !reader.row(y).unknown()).count_ones();
    rows.iter().zip(ys).map(explored).sum()
}

//! The end of an exploration: the residual frontiers and the reason \[Jorge15, Algorithm 1, line
//! 26\].
//!
//! Units: map cells.

use crate::config::Config;
use crate::field::local_grid::LocalGrid;
use crate::geometry::Cell;
use crate::map::Tiles;
use crate::map::tiles::NoRoom;
use crate::path::map_exits::missing_room;
use crate::planner::state::State;
use crate::planner::workspace::Workspace;
use crate::roadmap::configuration_space::Footprint;
use crate::status::{Fault, Finish, Status};

/// Below this room for its centre the robot is boxed in, cells: one square metre.
const BOX_CELLS: u32 = 100;

/// Ends the exploration: lists the residual frontiers and sets the status, or begins the patrol.
pub(super) fn finish<const TILES: usize, const SLOTS: usize>(
    config: &Config,
    state: &mut State<TILES, SLOTS>,
    workspace: &mut Workspace,
    footprint: &Footprint,
    (robot, time_ms): (Cell, u32),
) {
    const DONE: Status = Status::Finished(Finish::Explored);
    if state.strategy.is_patrolling() {
        // The residual frontiers were listed before the patrol.
        state.status = DONE;
        return;
    }
    let missing = list_ways_out(state, workspace, footprint, robot);
    state.strategy.frontier.list_unreachable(&state.skeleton);
    if missing.is_none() && looks_again(config, state, (robot, time_ms)) {
        return;
    }
    let status = conclude(state, &mut workspace.local_grid, footprint, robot, missing);
    if status != DONE || !state.strategy.begin_patrol() {
        state.status = status;
    }
}

/// Begins a second look if one may help and something came: takes it for gone. Returns true if it
/// does. On uneven ground nothing is known to have come.
fn looks_again<const TILES: usize, const SLOTS: usize>(
    config: &Config,
    state: &mut State<TILES, SLOTS>,
    (robot, time_ms): (Cell, u32),
) -> bool {
    if state.ground.is_uneven() || !state.map.has_arrivals() {
        return false;
    }
    let known_cells = state.map.known_cells();
    let frontier = &mut state.strategy.frontier;
    let begins = frontier.may_look_again(known_cells, time_ms);
    if begins {
        state.map.forget_arrivals(config, robot);
        let tuning = &config.tuning.localise;
        state.localiser.expect_contradiction(tuning);
        frontier.look_again();
        state.forgot_arrivals = true;
    }
    begins
}

/// Lists the reachable cells beyond which the map has no room. Returns which room is missing. Cells
/// beyond the map that cannot be reached do not count.
fn list_ways_out<const TILES: usize, const SLOTS: usize>(
    state: &mut State<TILES, SLOTS>,
    workspace: &mut Workspace,
    footprint: &Footprint,
    robot: Cell,
) -> Option<NoRoom> {
    let scratch = bytemuck::cast_slice_mut(&mut workspace.scratch);
    missing_room(&state.map, footprint, robot, scratch, |cell| {
        state.strategy.frontier.list_map_exit(cell);
    })
}

/// Returns the status that tells why no frontier can be reached.
fn conclude<const TILES: usize, const SLOTS: usize>(
    state: &State<TILES, SLOTS>,
    local_grid: &mut LocalGrid,
    footprint: &Footprint,
    robot: Cell,
    missing: Option<NoRoom>,
) -> Status {
    local_grid.update(state.map.tiles(), footprint, robot, 1);
    local_grid.free_robot(robot);
    match missing {
        Some(NoRoom::Pool) => Status::Fault(Fault::MapFull),
        Some(NoRoom::Box) => Status::Fault(Fault::OutOfBox),
        None if state.strategy.frontier.is_stuck() => Status::Fault(Fault::Stuck),
        None if room_cells(state.map.tiles(), local_grid, robot) < BOX_CELLS => {
            Status::Finished(Finish::BoxedIn)
        }
        None => Status::Finished(Finish::Explored),
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

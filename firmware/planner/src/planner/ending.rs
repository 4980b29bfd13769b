//! The end of an exploration: what is left over, and why [Jorge15, Algorithm 1, line 26].
//!
//! Units: map cells.

use crate::field::SIDE;
use crate::field::local_grid::{LocalGrid, Rows};
use crate::geometry::Cell;
use crate::grid::bits::{Adjacency, flood};
use crate::map::tiles::NoRoom;
use crate::path::PlanningContext;
use crate::path::map_exits::no_room;
use crate::planner::state::State;
use crate::planner::workspace::Workspace;
use crate::roadmap::configuration_space::Footprint;
use crate::status::{Fault, Finish, Status};

/// A robot whose centre has less room than this, in cells, is boxed in: one square metre.
const BOX_CELLS: u32 = 100;

/// Nothing is left to do: list what is left over, and say why.
pub(super) fn finish<const TILES: usize, const SLOTS: usize>(
    state: &mut State<TILES, SLOTS>,
    workspace: &mut Workspace,
    disc: &Footprint,
    robot: Cell,
) {
    const DONE: Status = Status::Finished(Finish::Explored);
    if state.strategy.is_patrolling() {
        // What was left over was listed before the patrol.
        state.status = DONE;
        return;
    }
    let wanting = list_ways_out(state, workspace, disc, robot);
    list_leftovers(state, disc);
    let status = conclude(state, &mut workspace.view, disc, robot, wanting);
    if status != DONE || !state.strategy.begin_patrol() {
        state.status = status;
    }
}

/// List what the robot can get to and cannot go on from for want of room in the map; which room that is. What lies beyond
/// the map and cannot be reached is no fault.
fn list_ways_out<const TILES: usize, const SLOTS: usize>(
    state: &mut State<TILES, SLOTS>,
    workspace: &mut Workspace,
    disc: &Footprint,
    robot: Cell,
) -> Option<NoRoom> {
    let scratch = bytemuck::cast_slice_mut(&mut workspace.scratch);
    no_room(&state.map, disc, robot, scratch, |cell| {
        state.strategy.frontier.list_way_out(cell);
    })
}

/// List the frontiers that were never within reach.
fn list_leftovers<const TILES: usize, const SLOTS: usize>(
    state: &mut State<TILES, SLOTS>,
    disc: &Footprint,
) {
    let known = PlanningContext {
        topology: &state.topology,
        tiles: state.map.tiles(),
        disc,
        levels: None,
    };
    state.strategy.frontier.list_leftovers(&known);
}

/// Why there is no frontier left within reach.
fn conclude<const TILES: usize, const SLOTS: usize>(
    state: &State<TILES, SLOTS>,
    view: &mut LocalGrid,
    disc: &Footprint,
    robot: Cell,
    wanting: Option<NoRoom>,
) -> Status {
    view.look_around(state.map.tiles(), disc, robot, 1);
    view.free_robot(robot);
    match wanting {
        Some(NoRoom::Pool) => Status::Fault(Fault::MapFull),
        Some(NoRoom::Box) => Status::Fault(Fault::OutOfBox),
        None if state.strategy.frontier.is_stuck() => Status::Fault(Fault::Stuck),
        None if room_cells(view, robot) < BOX_CELLS => Status::Finished(Finish::BoxedIn),
        None => Status::Finished(Finish::Explored),
    }
}

/// Cells of the window that the robot's centre can get to.
fn room_cells(view: &LocalGrid, robot: Cell) -> u32 {
    let mut reached: Rows = [0; SIDE];
    if let Some(place) = view.place(robot) {
        LocalGrid::put(&mut reached, place);
    }
    // With no target it floods everything.
    let _ = flood(&view.passable, &mut reached, &[0; SIDE], Adjacency::Four);
    reached.iter().map(|row| row.count_ones()).sum()
}

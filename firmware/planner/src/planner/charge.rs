//! Charging the window around the robot: with a local goal on the path, or with the strategy's own
//! boundary values \[Jorge15, Algorithm 1, lines 26 and 27\].
//!
//! Units: map cells.

use crate::config::Config;
use crate::field::SIDE;
use crate::field::local_grid::{LocalGrid, Rows, SCALES};
use crate::geometry::Cell;
use crate::input::Input;
use crate::path::blocked_passages::NONE;
use crate::path::nearest::Centres;
use crate::path::open_stretch::OpenStretch;
use crate::planner::state::State;
use crate::planner::workspace::Workspace;
use crate::roadmap::configuration_space::Footprint;

/// The local goal on the path.
struct LocalGoal {
    /// Its cells in the local grid.
    cells: Rows,
    /// The local grid does not lead along the path as far as the goal could lie.
    is_closed: bool,
}

/// Charges the window with the local goal on the path. Returns true if the local grid does not lead
/// along the path as far as the goal could lie; `None` if there is no goal. It is not inlined, so
/// that what follows does not pay for the goal's stack.
#[inline(never)]
pub(super) fn charge_path<const TILES: usize, const SLOTS: usize>(
    config: &Config,
    state: &State<TILES, SLOTS>,
    workspace: &mut Workspace,
    footprint: &Footprint,
    input: &Input<'_>,
) -> Option<bool> {
    let goal = local_goal(config, state, footprint, input, &mut workspace.local_grid)?;
    charge(workspace, &goal.cells);
    Some(goal.is_closed)
}

/// Fills the local grid at the smallest scale that holds a local goal. Returns the goal; `None` if
/// there is no path, or no scale holds a goal.
fn local_goal<const TILES: usize, const SLOTS: usize>(
    config: &Config,
    state: &State<TILES, SLOTS>,
    footprint: &Footprint,
    input: &Input<'_>,
    grid: &mut LocalGrid,
) -> Option<LocalGoal> {
    let (robot, path) = (input.pose.point(), state.strategy.frontier.path());
    if path.is_empty() {
        return None;
    }
    let tiles = state.map.tiles();
    let ahead = path.ahead_of(robot);
    SCALES.iter().find_map(|&scale| {
        let blocked = state.strategy.frontier.blocked();
        blocked.read(grid, (tiles, footprint), robot.cell(), scale);
        let shield = state.strategy.shield();
        let shield = shield.filter(|_| !state.errands.is_going());
        if let Some(shield) = shield {
            shield.cells().for_each(|cell| grid.block(cell));
        }
        grid.free_robot(robot.cell());
        state
            .ground
            .block_rims(config, tiles, footprint, robot, grid);
        // A shield is there to be gone round.
        let stretch = match shield {
            Some(_) => OpenStretch::default(),
            None => OpenStretch::of(grid, robot.cell(), ahead),
        };
        state.block_peers(footprint, input, grid, None);
        // A goal behind the open stretch counts only if no cell is open.
        let open = ahead
            .iter()
            .rev()
            .skip_while(|&&cell| stretch.last.is_some_and(|last| last != cell));
        let cells = open.copied().find_map(|cell| goal_cells(grid, cell))?;
        Some(LocalGoal {
            cells,
            is_closed: stretch.is_closed,
        })
    })
}

/// Returns the passable window cells of a coarse cell; `None` if it has none.
fn goal_cells(grid: &LocalGrid, cell: Cell) -> Option<Rows> {
    let mut rows: Rows = [0; SIDE];
    grid.mark(&mut rows, cell).then_some(rows)
}

/// Charges the window with the strategy's own boundary values. Returns `None` if it has none, or if
/// the robot reaches none of them.
pub(super) fn charge_rails<const TILES: usize, const SLOTS: usize>(
    config: &Config,
    state: &mut State<TILES, SLOTS>,
    workspace: &mut Workspace,
    footprint: &Footprint,
    input: &Input<'_>,
) -> Option<()> {
    if state.errands.is_going() {
        return None;
    }
    state.strategy.tdbvp()?;
    let robot = input.pose.point().cell();
    let local_grid = &mut workspace.local_grid;
    let (blocked, tiles) = (state.strategy.frontier.blocked(), state.map.tiles());
    blocked.read(local_grid, (tiles, footprint), robot, 1);
    local_grid.free_robot(robot);
    state
        .ground
        .block_rims(config, tiles, footprint, input.pose.point(), local_grid);
    state.block_peers(footprint, input, local_grid, None);
    slide(workspace);
    // Rails search for no way.
    let centres = Centres::of(&state.skeleton, tiles, footprint, &NONE)?;
    let window = (&mut workspace.window, &workspace.local_grid);
    state
        .strategy
        .charge(&centres, input.pose.point(), window, config.tuning)
}

/// Sets the window's boundary values. The last field stays where the two windows overlap.
pub(super) fn charge(workspace: &mut Workspace, goal: &Rows) {
    slide(workspace);
    workspace
        .window
        .set_boundary(&workspace.local_grid.passable, goal);
}

/// Moves the window to the local grid's place, together with the field where they overlap.
fn slide(workspace: &mut Workspace) {
    let Workspace {
        window,
        window_at: at,
        local_grid,
        ..
    } = workspace;
    match *at {
        Some((origin, scale)) if scale == local_grid.scale => {
            let steps = |to: i32, from: i32| (to - from) / scale;
            window.shift(
                steps(local_grid.origin.x, origin.x),
                steps(local_grid.origin.y, origin.y),
            );
        }
        // A field at another scale is of no use.
        _ => window.shift(SIDE as i32, 0),
    }
    *at = Some((local_grid.origin, local_grid.scale));
}

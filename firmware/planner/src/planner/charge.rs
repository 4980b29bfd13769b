//! The window around the robot is charged: with a local goal of the path, or with what the strategy has for it
//! [Jorge15, Algorithm 1, lines 27 and 28].
//!
//! Units: map cells.

use crate::field::SIDE;
use crate::field::local_grid::{LocalGrid, Rows, SCALES};
use crate::geometry::{Cell, Point};
use crate::input::Input;
use crate::map::obstacle_points;
use crate::planner::state::{GroundModel, State};
use crate::planner::workspace::Workspace;
use crate::roadmap::configuration_space::Footprint;
use crate::strategy::tdbvp::Surroundings;

/// See the smallest window that holds a local goal; the goal's cells in it.
pub(super) fn local_goal<const TILES: usize, const SLOTS: usize>(
    state: &State<TILES, SLOTS>,
    disc: &Footprint,
    input: &Input<'_>,
    view: &mut LocalGrid,
) -> Option<Rows> {
    let (robot, path) = (input.pose.point(), state.strategy.frontier.path());
    if path.is_empty() {
        return None;
    }
    SCALES.iter().find_map(|&scale| {
        view.look_around(state.map.tiles(), disc, robot.cell(), scale);
        if let Some(shield) = state.strategy.shield() {
            shield.cells().for_each(|cell| view.block(cell));
        }
        view.free_robot(robot.cell());
        keep_off_rims(state, disc, robot, view);
        path.local_goals(robot)
            .find_map(|cell| goal_cells(view, cell))
    })
}

/// What the drive keeps the robot's hull off on uneven ground, obstacles of either sign and ground that was never measured, the window keeps its
/// centre off: between two such cells the field would lead where the drive does not go.
fn keep_off_rims<const TILES: usize, const SLOTS: usize>(
    state: &State<TILES, SLOTS>,
    disc: &Footprint,
    robot: Point,
    view: &mut LocalGrid,
) {
    if let GroundModel::Uneven(_) = state.ground {
        let rims = obstacle_points::border_cells(state.map.tiles(), robot);
        view.keep_off(robot.cell(), rims, disc);
    }
}

/// The passable window cells of a coarse cell, if there are any.
fn goal_cells(view: &LocalGrid, cell: Cell) -> Option<Rows> {
    let mut rows: Rows = [0; SIDE];
    view.mark(&mut rows, cell).then_some(rows)
}

/// Charge the window with what the strategy has for it beside local goals, if that leads anywhere.
pub(super) fn charge_rails<const TILES: usize, const SLOTS: usize>(
    state: &mut State<TILES, SLOTS>,
    workspace: &mut Workspace,
    disc: &Footprint,
    input: &Input<'_>,
) -> Option<()> {
    state.strategy.tdbvp()?;
    let robot = input.pose.point().cell();
    let view = &mut workspace.view;
    view.look_around(state.map.tiles(), disc, robot, 1);
    view.free_robot(robot);
    keep_off_rims(state, disc, input.pose.point(), view);
    slide(workspace);
    let around = Surroundings {
        topology: &state.topology,
        tiles: state.map.tiles(),
        pose: input.pose,
    };
    let window = (&mut workspace.window, &workspace.view);
    state.strategy.charge(&around, window)
}

/// Set the window's boundary, keeping the field of the last window where they overlap.
pub(super) fn charge(workspace: &mut Workspace, goal: &Rows) {
    slide(workspace);
    workspace
        .window
        .set_boundary(&workspace.view.passable, goal);
}

/// Move the window to where the view is, with the field where they overlap.
fn slide(workspace: &mut Workspace) {
    let Workspace {
        window,
        window_at: at,
        view,
        ..
    } = workspace;
    match *at {
        Some((origin, scale)) if scale == view.scale => {
            let steps = |to: i32, from: i32| (to - from) / scale;
            window.shift(
                steps(view.origin.x, origin.x),
                steps(view.origin.y, origin.y),
            );
        }
        // Nothing of a field at another scale is worth keeping.
        _ => window.shift(SIDE as i32, 0),
    }
    *at = Some((view.origin, view.scale));
}

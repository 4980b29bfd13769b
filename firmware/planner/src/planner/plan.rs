//! Planning on a new skeleton: one round of the strategy, and the search for viewpoints once no
//! frontier can be reached \[Jorge15, Algorithm 1, lines 4 and 23\].
//!
//! Units: metres, map cells.

use crate::config::Config;
use crate::geometry::{Point, Pose};
use crate::input::Input;
use crate::path::utility::GoalOrder;
use crate::path::viewpoint::{Found, Inputs};
use crate::path::{PlanningContext, PlanningScratch, RoundOutcome};
use crate::planner::ending::finish;
use crate::planner::state::State;
use crate::planner::workspace::Workspace;
use crate::roadmap::configuration_space::Footprint;
use crate::status::{Fault, Status};

/// Distance ahead of the robot's centre at which unmeasured ground stops it, metres: between its
/// front and where the tilted beams meet level ground.
const FRONT_M: f32 = 0.8;

/// Plans one round on a new skeleton. Returns false if the next step must continue the round.
#[inline(never)]
pub(super) fn replan<const TILES: usize, const SLOTS: usize>(
    config: &Config,
    state: &mut State<TILES, SLOTS>,
    workspace: &mut Workspace,
    footprint: &Footprint,
    input: &Input<'_>,
) -> bool {
    let waits_for_peers = state.cut_peers(footprint, input.time_ms);
    let words: &mut [u32] = bytemuck::cast_slice_mut(&mut workspace.scratch);
    let (residues, queue) = words.split_at_mut(SLOTS * 16);
    let (residues, _) = residues.as_chunks_mut::<2>();
    let scratch = PlanningScratch {
        residues,
        queue,
        local_grid: &mut workspace.local_grid,
    };
    let blocked = state.strategy.frontier.blocked().clone();
    let came_past = |place, within_m| state.drive.came_past(place, within_m);
    let came_through_blocked = blocked.any(came_past);
    let disc = Footprint::new(config.robot_radius_m);
    let context = PlanningContext {
        skeleton: &mut state.skeleton,
        tiles: state.map.tiles(),
        footprint,
        disc: &disc,
        blocked: &blocked,
        pose: input.pose,
        time_ms: input.time_ms,
        limits: &config.loops,
        goal_level: config.goal_level,
        order: GoalOrder::of(config),
        tuning: config.tuning,
        levels: state.ground.level_cost(config, &state.preferences),
        team: state.team.is_member().then_some(&state.team),
        must_wait: waits_for_peers || state.drive.is_retreating(),
        came_through_blocked,
        known_cells: state.map.known_cells(),
        openings_were_tried: state.strategy.frontier.has_further_chance(),
    };
    let outcome = match state.errands.goal() {
        Some(goal) => Some(state.strategy.go_to(goal, context, scratch)),
        None => state.strategy.advance(context, scratch),
    };
    let Some(outcome) = outcome else {
        return false;
    };
    if config.ground.is_some() {
        resolve_unmeasured(config, state, &input.pose);
    }
    match outcome {
        RoundOutcome::Nothing | RoundOutcome::Stuck if state.errands.is_going() => {
            state.give_up_errand();
        }
        RoundOutcome::Nothing if may_search_viewpoints(state) => state.viewpoints.begin(),
        RoundOutcome::Nothing => end(config, state, workspace, footprint, input),
        RoundOutcome::Stuck => state.status = Status::Fault(Fault::Stuck),
        // The next goals are judged on the same skeleton: the next one is a second away, and the
        // robot stands.
        RoundOutcome::Unsure if state.strategy.frontier.judges_on() => return false,
        RoundOutcome::Path | RoundOutcome::Unsure => {}
    }
    true
}

/// Returns true if a look through a gap may show more. On uneven ground it does not: a look through
/// a gap measures no ground.
fn may_search_viewpoints<const TILES: usize, const SLOTS: usize>(
    state: &State<TILES, SLOTS>,
) -> bool {
    state.strategy.frontier.may_look()
        && !state.ground.is_uneven()
        && !state.strategy.is_patrolling()
}

/// Decides about ground that stayed unmeasured although the robot stood beside it.
fn resolve_unmeasured<const TILES: usize, const SLOTS: usize>(
    config: &Config,
    state: &mut State<TILES, SLOTS>,
    pose: &Pose,
) {
    while let Some(cell) = state.strategy.frontier.take_unobservable() {
        state.map.resolve_gaps(config, cell);
    }
    if state.strategy.frontier.take_stalled() {
        let front = Point {
            x_m: FRONT_M,
            y_m: 0.0,
        };
        if state.map.free_gaps(config, pose.to_map(front).cell()) {
            state.strategy.frontier.open_last_passage();
        }
    }
}

/// Continues the search for viewpoints: goes to the one that it found, or finishes.
#[inline(never)]
pub(super) fn search_viewpoints<const TILES: usize, const SLOTS: usize>(
    config: &Config,
    state: &mut State<TILES, SLOTS>,
    workspace: &mut Workspace,
    footprint: &Footprint,
    input: &Input<'_>,
) {
    let robot = input.pose.point().cell();
    let disc = Footprint::new(config.robot_radius_m);
    let (residual, blocked) = state.strategy.frontier.given_up_mut();
    let inputs = Inputs {
        tiles: state.map.tiles(),
        // The skeleton stays the same while the search runs.
        tiling: state.skeleton.tiling(),
        frame: state.skeleton.frame(),
        footprints: [&disc, footprint],
        robot,
        blocked,
        order: GoalOrder::of(config),
    };
    let scratch = bytemuck::cast_slice_mut(&mut workspace.scratch);
    match state.viewpoints.advance(&inputs, residual, scratch) {
        Found::Pending => {}
        Found::Viewpoint(viewpoint) => {
            state.strategy.frontier.look_from(viewpoint);
            // The skeleton is still the one that the last round planned on.
            state.has_new_skeleton = true;
        }
        Found::Nothing => end(config, state, workspace, footprint, input),
    }
}

/// Ends the exploration. If the map lacks room, the next step ends it: to search the map's exits
/// takes as long as to plan.
fn end<const TILES: usize, const SLOTS: usize>(
    config: &Config,
    state: &mut State<TILES, SLOTS>,
    workspace: &mut Workspace,
    footprint: &Footprint,
    input: &Input<'_>,
) {
    state.ends = state.map.out_of_box() || state.map.pool_full();
    if !state.ends {
        end_now(config, state, workspace, footprint, input);
    }
}

/// Ends the exploration in this step.
pub(super) fn end_now<const TILES: usize, const SLOTS: usize>(
    config: &Config,
    state: &mut State<TILES, SLOTS>,
    workspace: &mut Workspace,
    footprint: &Footprint,
    input: &Input<'_>,
) {
    state.ends = false;
    let (robot, time_ms) = (input.pose.point().cell(), input.time_ms);
    finish(config, state, workspace, footprint, (robot, time_ms));
}

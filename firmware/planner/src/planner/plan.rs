//! A new skeleton is planned on: a round of the strategy, and the search for viewpoints when it finds nothing to drive to
//! [Jorge15, Algorithm 1, lines 4 and 24].
//!
//! Units: metres, map cells.

use crate::config::Config;
use crate::config::UnevenGround;
use crate::drive::Place;
use crate::field::height_preference::Preferences;
use crate::geometry::Pose;
use crate::input::Input;
use crate::path::height_levels::LevelCost;
use crate::path::viewpoint::{Found, Grounds};
use crate::path::{PlanningScratch, RoundOutcome};
use crate::planner::ending::finish;
use crate::planner::state::{GroundModel, State};
use crate::planner::steer::ahead;
use crate::planner::workspace::Workspace;
use crate::roadmap::configuration_space::Footprint;
use crate::status::{Fault, Status};
use crate::strategy::ouroboros::Round;

/// Where ground that stops the robot lies on uneven ground, if it was never measured: between its front and where the tilted beams meet
/// level ground, metres.
const FRONT_M: f32 = 0.8;

/// A new skeleton: find the way to go, or find that there is none. Whether that is done, or the next step must go on with it.
pub(super) fn replan<const TILES: usize, const SLOTS: usize>(
    config: &Config,
    state: &mut State<TILES, SLOTS>,
    workspace: &mut Workspace,
    disc: &Footprint,
    input: &Input<'_>,
) -> bool {
    let words: &mut [u32] = bytemuck::cast_slice_mut(&mut workspace.scratch);
    let (residues, ring) = words.split_at_mut(SLOTS * 16);
    let (residues, _) = residues.as_chunks_mut::<2>();
    let lent = PlanningScratch {
        residues,
        ring,
        view: &mut workspace.view,
    };
    let round = Round {
        topology: &mut state.topology,
        tiles: state.map.tiles(),
        disc,
        pose: input.pose,
        time_ms: input.time_ms,
        limits: &config.loops,
        levels: levels(&state.ground, config, &state.preferences),
    };
    let Some(outlook) = state.strategy.advance(round, lent) else {
        return false;
    };
    if let Some(terrain) = &config.ground {
        resolve_gaps(terrain, state, &input.pose);
    }
    let robot = input.pose.point().cell();
    match outlook {
        // On uneven ground what is seen through a gap is not measured by it.
        RoundOutcome::Nothing
            if state.strategy.frontier.may_look()
                && config.ground.is_none()
                && !state.strategy.is_patrolling() =>
        {
            let scratch = bytemuck::cast_slice_mut(&mut workspace.scratch);
            state.viewpoints.begin(state.map.tiles().extent(), scratch);
        }
        RoundOutcome::Nothing => finish(state, workspace, disc, robot),
        RoundOutcome::Stuck => state.status = Status::Fault(Fault::Stuck),
        RoundOutcome::Path | RoundOutcome::Unsure => {}
    }
    true
}

/// Decide what to make of ground that was never measured though the robot stood by it.
fn resolve_gaps<const TILES: usize, const SLOTS: usize>(
    terrain: &UnevenGround,
    state: &mut State<TILES, SLOTS>,
    pose: &Pose,
) {
    while let Some(cell) = state.strategy.frontier.take_unobserved() {
        state.map.resolve_gaps(terrain, cell);
    }
    if state.strategy.frontier.take_stop() {
        let front = Place {
            x_m: FRONT_M,
            ..Place::default()
        };
        if state.map.free_gaps(terrain, ahead(pose, front).cell()) {
            state.strategy.frontier.lift_bar();
        }
    }
}

/// Which goals are preferred for their height.
fn levels<'a, const TILES: usize>(
    around: &'a GroundModel<TILES>,
    config: &'a Config,
    preferences: &Preferences,
) -> Option<LevelCost<'a, TILES>> {
    let terrain = config.ground.as_ref()?;
    match around {
        GroundModel::Uneven(storeys) if terrain.mode.has_heights() => Some(LevelCost {
            storeys,
            terrain,
            storey_m: preferences.storey_m(),
        }),
        _ => None,
    }
}

/// Nothing is left to drive to: search on for what can be seen, and go there or be done.
pub(super) fn look_for_viewpoints<const TILES: usize, const SLOTS: usize>(
    config: &Config,
    state: &mut State<TILES, SLOTS>,
    workspace: &mut Workspace,
    input: &Input<'_>,
) {
    let robot = input.pose.point().cell();
    let [wide, narrow] = [config.robot_radius_m, config.tight_radius_m].map(Footprint::new);
    let grounds = Grounds {
        tiles: state.map.tiles(),
        discs: [&wide, &narrow],
        robot,
    };
    let is_gone = |gap| state.strategy.frontier.is_gone(gap);
    let scratch = bytemuck::cast_slice_mut(&mut workspace.scratch);
    match state.viewpoints.advance(&grounds, is_gone, scratch) {
        Found::Pending => {}
        Found::Viewpoint(viewpoint) => {
            state.strategy.frontier.look_from(viewpoint);
            // The skeleton was not touched meanwhile.
            state.fresh = true;
        }
        Found::Nothing => finish(state, workspace, &narrow, robot),
    }
}

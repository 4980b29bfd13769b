//! One step of the exploration, read as the paper's algorithm box [Jorge15, Algorithm 1].
//!
//! ```text
//! sense:   scans + odometry → map, near field
//! line 3:  update the Voronoi cells         (topology, in instalments)
//! line 4:  move the robot to the Voronoi    (strategy)
//! line 24: propagate from the unexplored    (strategy)
//! line 26: exit when there is none          (status)
//! line 27: define the local goal            (path)
//! line 28: compute the local potential      (view, field)
//! line 29: follow it                        (descent, drive)
//! ```
//!
//! A pure function of configuration, state, workspace and input: no clock, no I/O, no globals, no logging. Same bits in, same
//! bits out, on host and target.

mod charge;
mod ending;
mod plan;
mod prefer;
mod state;
mod steer;
mod workspace;

pub use state::State;
pub use workspace::{CellKind, FieldRow, Workspace};

use crate::config::Config;
use crate::field::{SolverConfig, Stop, solve};
use crate::geometry::Twist;
use crate::input::Input;
use crate::profiling::{Stage, StageTimer};
use crate::roadmap::configuration_space::Footprint;
use crate::robot::LaserMount;
use crate::robot::is_level;
use crate::status::{Fault, Status};
use charge::{charge, charge_rails, local_goal};
use plan::{look_for_viewpoints, replan};
use prefer::{note_flatness, prefer};
use state::GroundModel;
use steer::{look_about, steer};

/// The robot that starts inside something sees it nearer than this everywhere, metres.
const BLOCKED_M: f32 = 0.12;

/// What a step answers.
#[derive(Clone, Copy, Debug, Default)]
pub struct Output {
    /// What to drive.
    pub velocity: Twist,
    /// What the planner is doing.
    pub status: Status,
    /// Heading that the field asks for, radians.
    pub heading_rad: f32,
    /// Multigrid cycles (or sweeps) spent on the window.
    pub cycles: u16,
    /// The solver's budget ran out before its stop rule held.
    pub budget_exhausted: bool,
}

/// One step: what was sensed in, what to drive out. `timer` hears of each stage's end.
pub fn step<const TILES: usize, const SLOTS: usize>(
    config: &Config,
    state: &mut State<TILES, SLOTS>,
    workspace: &mut Workspace,
    input: Input<'_>,
    timer: &mut impl StageTimer,
) -> Output {
    if state.status != Status::Exploring {
        return Output {
            status: state.status,
            ..Output::default()
        };
    }
    sense(config, state, &input);
    timer.mark(Stage::Sense);
    // A search for a manoeuvre has the scratch; until it is over the robot stands and plans nothing else.
    if state.drive.is_searching() {
        let output = steer(config, state, workspace, &input);
        timer.mark(Stage::Drive);
        return output;
    }
    if state.viewpoints.is_running() {
        look_for_viewpoints(config, state, workspace, &input);
        timer.mark(Stage::Plan);
        return Output {
            status: state.status,
            ..Output::default()
        };
    }
    let disc = Footprint::new(if state.strategy.frontier.is_second_chance() {
        config.tight_radius_m
    } else {
        config.robot_radius_m
    });
    // A new skeleton is planned on in the step after it was finished, so that no step does both.
    let planned = state.fresh;
    if planned {
        state.fresh = !replan(config, state, workspace, &disc, &input);
        timer.mark(Stage::Plan);
    } else {
        state.fresh = state
            .topology
            .advance(state.map.tiles(), &disc, config.topology_units);
        timer.mark(Stage::Topology);
    }
    if state.status != Status::Exploring {
        return Output {
            status: state.status,
            ..Output::default()
        };
    }
    if charge_rails(state, workspace, &disc, &input).is_none() {
        let Some(goal) = local_goal(state, &disc, &input, &mut workspace.view) else {
            timer.mark(Stage::Window);
            return Output {
                velocity: look_about(config, state, &input),
                ..Output::default()
            };
        };
        charge(workspace, &goal);
    }
    if let Some(terrain) = &config.ground {
        prefer(terrain, state, workspace, &input);
    }
    timer.mark(Stage::Window);
    // A step that planned a path has spent the time of two cycles on it.
    let most = config.solver.max_cycles;
    let solver = SolverConfig {
        max_cycles: if planned { most.div_ceil(2) } else { most },
        ..config.solver
    };
    let solution = solve(&mut workspace.window, &mut workspace.scratch, &solver);
    if config.ground.is_some() {
        note_flatness(state, workspace, &input);
    }
    timer.mark(Stage::Solve);
    let output = Output {
        cycles: solution.cycles + solution.sweeps,
        budget_exhausted: solution.stop == Stop::Budget,
        ..steer(config, state, workspace, &input)
    };
    timer.mark(Stage::Drive);
    output
}

/// Scans and odometry into the map and the near field.
fn sense<const TILES: usize, const SLOTS: usize>(
    config: &Config,
    state: &mut State<TILES, SLOTS>,
    input: &Input<'_>,
) {
    if !state.started {
        state.started = true;
        state.start = input.pose.point().cell();
        if starts_blocked(config, input) {
            state.status = Status::Fault(Fault::StartBlocked);
        }
    }
    state.map.observe(config, input);
    let level = level_scans(config, input).find(|(_, ranges_mm)| !ranges_mm.is_empty());
    state.strategy.note(&input.pose, input.time_ms, level);
    match &mut state.ground {
        GroundModel::Flat(near) => {
            for (laser, ranges_mm) in level_scans(config, input) {
                near.update(&input.pose, laser, ranges_mm);
            }
        }
        GroundModel::Uneven(storeys) => {
            state.preferences.stand(&input.pose);
            storeys.note(&state.map.heights(), state.map.tiles());
            state.map.compact(storeys);
        }
    }
}

/// The level lasers, each with its scan.
fn level_scans<'a>(
    config: &'a Config,
    input: &Input<'a>,
) -> impl Iterator<Item = (&'a LaserMount, &'a [u16])> {
    let scans = config.lasers.iter().zip(input.scans);
    scans.filter(|(laser, _)| is_level(laser))
}

/// Whether the level laser sees something closer than the robot's own hull in nearly every beam.
#[must_use]
pub fn starts_blocked(config: &Config, input: &Input<'_>) -> bool {
    let level = level_scans(config, input).next();
    level.is_some_and(|(_, ranges_mm)| {
        let blocked = |&&range: &&u16| f32::from(range) * 1e-3 < BLOCKED_M;
        !ranges_mm.is_empty()
            && ranges_mm.iter().filter(blocked).count() * 10 >= ranges_mm.len() * 9
    })
}

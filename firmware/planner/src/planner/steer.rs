//! Following the window's field without touching anything \[Jorge15, Algorithm 1, line 28\].
//!
//! Units: metres, seconds, radians; milliseconds where a name says so.

use crate::config::Config;
use crate::doing::Doing;
use crate::drive::side_slope::Hysteresis;
use crate::drive::{CollisionChecker, Incline, Place, SearchQuery};
use crate::field::local_grid;
use crate::field::{Window, descent};
use crate::geometry::{CELL_M, Cell, MapPose, Point, Pose, Twist};
use crate::input::Input;
use crate::math;
use crate::planner::Output;
use crate::planner::state::State;
use crate::planner::workspace::Workspace;

/// The period of looking around, milliseconds: the time of half a turn.
const LOOK_PERIOD_MS: u32 = 5_000;
/// Periods after which a standing robot is stalled, on uneven ground: by then two passages were
/// blocked.
const STALLED_PERIODS: u32 = 5;

/// Returns the velocity that follows the window's field, or the heading `lead_rad` of a strategy
/// that needs no window.
pub(super) fn steer<const TILES: usize, const SLOTS: usize>(
    config: &Config,
    state: &mut State<TILES, SLOTS>,
    workspace: &mut Workspace,
    input: &Input<'_>,
    lead_rad: Option<f32>,
) -> Output {
    let Workspace {
        window,
        window_at,
        scratch,
        ..
    } = workspace;
    let lead = lead_rad.map(|lead_rad| math::wrap(lead_rad - input.pose.yaw_rad));
    let Some((origin, scale)) = window_at.or(lead.map(|_| (input.pose.point().cell(), 1))) else {
        return Output::waiting();
    };
    let heights = state.map.heights();
    // A robot that is stalled within its roll limit leaves the limit rather than stand there for
    // ever.
    let incline = config
        .ground
        .as_ref()
        .filter(|_| standing_periods(state, input.time_ms) < STALLED_PERIODS)
        .and_then(|ground| Incline::new(&config.robot, ground, &heights, &input.pose));
    let goal = state.strategy.frontier.path().goal();
    let tiles = state.map.tiles();
    let hysteresis = Hysteresis {
        previous: state.slope_direction,
        goal: state.ground.direction_of(tiles, goal, input.pose.z_m),
        blocked: state.blocked_direction,
    };
    let headed = |place: Place| {
        let field = || heading_at(window, (origin, scale), &input.pose, place);
        let wanted = lead.or_else(field)?;
        Some(match &incline {
            Some(incline) => incline.heading(place, wanted, hysteresis),
            None => (wanted, None),
        })
    };
    let heading_at = |place: Place| headed(place).map(|(heading, _)| heading);
    let here = headed(Place::default());
    state.slope_direction = here.and_then(|(_, direction)| direction);
    let here = here.map(|(heading, _)| heading);
    let mut checker = CollisionChecker::empty(&config.robot);
    checker.stand_on(incline.clone());
    obstruct(&mut checker, state, config, input);
    let odom = state.localiser.odom();
    let velocity = if here.is_some() {
        let potential_at = |place: Place| {
            let (x, y) = local_grid::position((origin, scale), input.pose.to_map(place.point()));
            potential_at(window, x, y)
        };
        let potential_at = lead.is_none().then_some(&potential_at as _);
        let mut query = SearchQuery::new(&checker, heading_at, potential_at);
        // A gap that is hardly wider than the hull may let the robot in and not out again.
        query.squeezes = state.strategy.frontier.has_second_chance();
        query.is_careful = !query.squeezes;
        query.is_surrounded = state.ground.is_surrounded(&odom, &config.robot);
        let rested = state.drive.is_resting();
        let velocity = state.drive.follow(
            config,
            &mut query,
            input.velocity,
            bytemuck::cast_slice_mut(scratch),
        );
        // Where the drive finds no way in one direction it takes the other, until its next search.
        state.blocked_direction = match (rested, state.drive.is_resting()) {
            (_, false) => None,
            (false, true) => state.slope_direction,
            (true, true) => state.blocked_direction,
        };
        velocity
    } else if is_at_goal(window, (origin, scale), input.pose.point()) {
        // The field has no gradient in the goal's own cell: look around until the cell is explored.
        state.drive.look_around(config, &checker, input.velocity)
    } else {
        state.strategy.frontier.note_closed();
        Twist::default()
    };
    if state.drive.take_wedged() && !state.ground.open_trap(&odom, &config.robot) {
        // What another robot closes will be open again.
        if checker.has_company() {
            state.team.way.shut();
        } else {
            let frontier = &mut state.strategy.frontier;
            frontier.note_wedged(input.pose.point(), input.time_ms);
        }
    }
    let doing = state.follows();
    let (velocity, doing) = if should_look(state, velocity, input.time_ms) {
        let look = state.drive.look_around(config, &checker, input.velocity);
        (look, Doing::LooksAbout)
    } else {
        (velocity, doing)
    };
    Output {
        velocity,
        doing,
        heading_rad: math::wrap(input.pose.yaw_rad + here.unwrap_or(0.0)),
        ..Output::default()
    }
}

/// Returns the velocity without a local goal: zero, or a turn to look around.
pub(super) fn look_about<const TILES: usize, const SLOTS: usize>(
    config: &Config,
    state: &mut State<TILES, SLOTS>,
    input: &Input<'_>,
) -> Twist {
    if !should_look(state, Twist::default(), input.time_ms) {
        return Twist::default();
    }
    let mut checker = CollisionChecker::empty(&config.robot);
    obstruct(&mut checker, state, config, input);
    state.drive.look_around(config, &checker, input.velocity)
}

/// Begins a retreat from where a passage was blocked, if the robot cannot turn there or blocked
/// another one there before.
#[inline(never)]
pub(super) fn begin_retreat<const TILES: usize, const SLOTS: usize>(
    config: &Config,
    state: &mut State<TILES, SLOTS>,
    input: &Input<'_>,
) {
    let mut checker = CollisionChecker::empty(&config.robot);
    obstruct(&mut checker, state, config, input);
    let frontier = &state.strategy.frontier;
    let must = frontier.failed_before_here() || frontier.goes_back();
    state.drive.begin_retreat(&checker, must);
}

/// Returns the velocity back along the robot's own track, up to a place where it can turn.
#[inline(never)]
pub(super) fn retreat<const TILES: usize, const SLOTS: usize>(
    config: &Config,
    state: &mut State<TILES, SLOTS>,
    input: &Input<'_>,
) -> Twist {
    let mut checker = CollisionChecker::empty(&config.robot);
    let odom = state.localiser.odom();
    state.ground.obstruct_measured(&odom, &mut checker);
    keep_off_peers(&mut checker, state, config, input);
    keep_inside(&mut checker, state, config, input);
    let pose = MapPose(input.pose);
    let velocity = state.drive.retreat(config, &pose, &checker, input.velocity);
    obstruct(&mut checker, state, config, input);
    let leads_on = !state.strategy.frontier.goes_back();
    state.drive.end_retreat(&checker, leads_on);
    velocity
}

/// Adds what the drive must not touch: the obstacles near by, the other robots, and what is
/// forbidden.
#[inline(never)]
pub(super) fn obstruct<const TILES: usize, const SLOTS: usize>(
    checker: &mut CollisionChecker,
    state: &State<TILES, SLOTS>,
    config: &Config,
    input: &Input<'_>,
) {
    let tiles = state.map.tiles();
    let poses = (&input.pose, &state.localiser.odom());
    state.ground.obstruct(config, tiles, poses, checker);
    keep_off_peers(checker, state, config, input);
    keep_inside(checker, state, config, input);
}

/// Adds the forbidden cells at the fence within the way that the robot needs to stop.
#[inline(never)]
fn keep_inside<const TILES: usize, const SLOTS: usize>(
    checker: &mut CollisionChecker,
    state: &State<TILES, SLOTS>,
    config: &Config,
    input: &Input<'_>,
) {
    let fence = state.map.tiles().fence();
    if fence.is_empty() {
        return;
    }
    let (speed, accel) = (config.max_linear_mps, config.linear_accel_mps2);
    let stop_m = speed * (config.period_s + 0.5 * speed / accel);
    let reach_m = config.robot.half_diagonal_m + stop_m;
    checker.fence_off(&input.pose, fence, math::floor(reach_m / CELL_M) + 1);
}

/// Adds the other robots.
fn keep_off_peers<const TILES: usize, const SLOTS: usize>(
    checker: &mut CollisionChecker,
    state: &State<TILES, SLOTS>,
    config: &Config,
    input: &Input<'_>,
) {
    let robot = input.pose.point();
    for (peer, hull) in state.team.peers().near(input.time_ms, robot, config) {
        let may_move = state.team.way.may_move(peer, input.time_ms);
        checker.keep_off_hull(&input.pose, hull.outline(), may_move);
    }
}

/// Returns true if the robot should look around: it waits that what is in the way goes, and a turn
/// may show that it has gone; or it is stalled on uneven ground, and a turn may measure ground that
/// it has not seen. Stalled, it looks around in every second period, and searches for a recovery
/// between.
fn should_look<const TILES: usize, const SLOTS: usize>(
    state: &State<TILES, SLOTS>,
    velocity: Twist,
    time_ms: u32,
) -> bool {
    let periods = standing_periods(state, time_ms);
    let is_stalled = state.ground.is_uneven() && periods >= STALLED_PERIODS && periods % 2 == 1;
    velocity == Twist::default() && (state.strategy.frontier.is_waiting() || is_stalled)
}

/// Returns the whole periods for which the robot has stood at its place.
fn standing_periods<const TILES: usize, const SLOTS: usize>(
    state: &State<TILES, SLOTS>,
    time_ms: u32,
) -> u32 {
    state.strategy.frontier.standing_ms(time_ms) / LOOK_PERIOD_MS
}

fn is_at_goal(window: &Window, (origin, scale): (Cell, i32), robot: Point) -> bool {
    let (x, y) = local_grid::position((origin, scale), robot);
    match (
        usize::try_from(math::floor(x)),
        usize::try_from(math::floor(y)),
    ) {
        (Ok(x), Ok(y)) => window.is_goal(x, y),
        _ => false,
    }
}

/// Returns q of the window cell at a position in cells.
fn potential_at(window: &Window, x: f32, y: f32) -> f32 {
    match (
        usize::try_from(math::floor(x)),
        usize::try_from(math::floor(y)),
    ) {
        (Ok(x), Ok(y)) => window.q(x, y),
        _ => 0.0,
    }
}

/// Returns the field's heading at a place near the robot, radians to the left of the robot's own.
fn heading_at(window: &Window, at: (Cell, i32), pose: &Pose, place: Place) -> Option<f32> {
    let (x, y) = local_grid::position(at, pose.to_map(place.point()));
    descent::heading_at(window, x, y).map(|heading| math::wrap(heading - pose.yaw_rad))
}

#[cfg(test)]
mod tests {
    use std::boxed::Box;
    use std::vec::Vec;

    use super::*;
    use crate::config::UnevenGround;
    use crate::field::{SIDE, solve};

    /// Returns the turn rates of a robot in a flat field, at these times since it last moved.
    fn turn_rates<const N: usize>(ground: Option<UnevenGround>, times_ms: [u32; N]) -> [f32; N] {
        let config = Config {
            ground,
            ..Config::pioneer_3at(heapless::Vec::new())
        };
        let mut state = Box::<State<20, 400>>::default();
        state.reset(&config);
        let mut workspace = Box::<Workspace>::default();
        workspace.window_at = Some((Cell { x: -30, y: -30 }, 1));
        times_ms.map(|time_ms| {
            let input = Input {
                time_ms,
                pose: Pose::default(),
                velocity: Twist::default(),
                scans: [&[], &[]],
            };
            let Twist {
                linear_mps,
                angular_radps,
            } = steer(&config, &mut state, &mut workspace, &input, None).velocity;
            assert_eq!(linear_mps, 0.0);
            angular_radps
        })
    }

    #[test]
    fn a_robot_stalled_for_25_s_looks_around_every_second_period() {
        let times_ms = [
            5_000, 15_000, 24_999, 25_000, 29_999, 30_000, 34_999, 35_000, 40_000, 45_000,
        ];
        let turns = turn_rates(Some(UnevenGround::TABLE_I), times_ms).map(|rate| rate != 0.0);
        let when: Vec<u32> = times_ms
            .into_iter()
            .zip(turns)
            .filter(|&(_, turns)| turns)
            .map(|(at, _)| at)
            .collect();
        assert_eq!(when, [25_000, 29_999, 35_000, 45_000]);
        assert_eq!(turn_rates(None, times_ms), [0.0; 10], "flat ground");
    }

    /// Returns the heading that a robot drives on a slope that rises to the north, degrees. The
    /// field leads east, and the robot has stood for this time.
    fn heading_deg(roll: f32, standing_ms: u32) -> f32 {
        let config = Config {
            ground: Some(UnevenGround {
                roll,
                ..UnevenGround::TABLE_I
            }),
            ..Config::pioneer_3at(heapless::Vec::new())
        };
        let mut state = Box::<State<152, 400>>::default();
        state.reset(&config);
        state
            .map
            .set_ground_heights(Cell::default(), |cell| Some(0.03 * cell.y as f32));
        let mut workspace = Box::<Workspace>::default();
        let half = SIDE as i32 / 2;
        workspace.window_at = Some((Cell { x: -half, y: -half }, 1));
        let inner = u64::MAX << 2 >> 4 << 1;
        let free = core::array::from_fn(|y| if (1..SIDE - 1).contains(&y) { inner } else { 0 });
        workspace
            .window
            .set_boundary(&free, &free.map(|row| row & 1 << (SIDE - 4)));
        solve(
            &mut workspace.window,
            &mut workspace.scratch,
            &config.solver,
        );
        let input = Input {
            time_ms: standing_ms,
            pose: Pose::default(),
            velocity: Twist::default(),
            scans: [&[], &[]],
        };
        steer(&config, &mut state, &mut workspace, &input, None)
            .heading_rad
            .to_degrees()
    }

    #[test]
    fn a_robot_stalled_for_25_s_leaves_its_roll_limit() {
        // tan 15°, on a slope of 16.7°.
        let limit = 0.268;
        assert!(heading_deg(limit, 20_000).abs() > 5.0);
        assert!(heading_deg(limit, 25_000).abs() < 1.0);
        assert!(heading_deg(UnevenGround::TABLE_I.climb, 20_000).abs() < 1.0);
    }
}

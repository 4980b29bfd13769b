//! The window's field is followed by a robot that touches nothing [Jorge15, Algorithm 1, line 29].
//!
//! Units: metres, seconds, radians; milliseconds where a name says so.

use crate::config::Config;
use crate::drive::side_slope::{Hysteresis, SlopeDirection};
use crate::drive::{CollisionChecker, Ground, Incline, Place};
use crate::field::local_grid;
use crate::field::{Window, descent};
use crate::geometry::{Cell, Point, Pose, Twist};
use crate::input::Input;
use crate::map::obstacle_points;
use crate::math;
use crate::planner::Output;
use crate::planner::state::{GroundModel, State};
use crate::planner::workspace::Workspace;

/// A while, milliseconds: half a turn.
const WHILE_MS: u32 = 5_000;
/// A robot that has stood for so many whiles on uneven ground looks around: two ways were barred by then.
const WHILES_AT_A_LOSS: u32 = 5;
/// A goal that is higher or lower by less lies level with the robot, metres: what a block of heights is rounded by, and as much again.
const LEVEL_M: f32 = 0.2;

/// Follow the window's field.
pub(super) fn steer<const TILES: usize, const SLOTS: usize>(
    config: &Config,
    state: &mut State<TILES, SLOTS>,
    workspace: &mut Workspace,
    input: &Input<'_>,
) -> Output {
    let Workspace {
        window,
        window_at,
        scratch,
        ..
    } = workspace;
    let Some((origin, scale)) = *window_at else {
        return Output::default();
    };
    let heights = state.map.heights();
    // A robot that found no way within the limit of its roll for so long leaves it rather than stand there for good.
    let incline = config
        .ground
        .as_ref()
        .filter(|_| whiles_stood(state, input.time_ms) < WHILES_AT_A_LOSS)
        .and_then(|terrain| Incline::new(terrain, &heights, &input.pose));
    let bias = Hysteresis {
        before: state.wedge,
        goal: wedge_of_goal(state, input.pose.z_m),
        shut: state.shut,
    };
    let headed = |place: Place| {
        let wanted = heading_at(window, (origin, scale), &input.pose, place)?;
        Some(match &incline {
            Some(incline) => incline.heading(place, wanted, bias),
            None => (wanted, None),
        })
    };
    let heading_at = |place: Place| headed(place).map(|(heading, _)| heading);
    let here = headed(Place::default());
    state.wedge = here.and_then(|(_, wedge)| wedge);
    let here = here.map(|(heading, _)| heading);
    let surround = surround(state, &input.pose, incline.clone());
    let velocity = if here.is_some() {
        let potential_at = |place: Place| {
            let (x, y) = local_grid::position((origin, scale), ahead(&input.pose, place));
            potential_at(window, x, y)
        };
        let ground = Ground {
            surround: &surround,
            heading_at,
            potential_at: Some(&potential_at),
        };
        let rested = state.drive.is_resting();
        let velocity = state.drive.follow(
            config,
            &ground,
            input.velocity,
            bytemuck::cast_slice_mut(scratch),
        );
        // Where it finds no way in one wedge it goes in the other until it searches again.
        state.shut = match (rested, state.drive.is_resting()) {
            (_, false) => None,
            (false, true) => state.wedge,
            (true, true) => state.shut,
        };
        velocity
    } else if is_at_goal(window, (origin, scale), input.pose.point()) {
        // In the goal's own cell there is no slope: look around until it is explored.
        state.drive.look_around(config, &surround, input.velocity)
    } else {
        state.strategy.frontier.note_flat();
        Twist::default()
    };
    let velocity = if is_at_a_loss(state, velocity, input.time_ms) {
        state.drive.look_around(config, &surround, input.velocity)
    } else {
        velocity
    };
    Output {
        velocity: within_limits(config, velocity),
        heading_rad: math::wrap(input.pose.yaw_rad + here.unwrap_or(0.0)),
        ..Output::default()
    }
}

/// What stands around the robot, or what it keeps off.
fn surround<const TILES: usize, const SLOTS: usize>(
    state: &State<TILES, SLOTS>,
    pose: &Pose,
    incline: Option<Incline>,
) -> CollisionChecker {
    let mut surround = CollisionChecker::empty().on(incline);
    match &state.ground {
        GroundModel::Flat(near) => {
            surround.see(pose, near.points());
            let cells = obstacle_points::obstacle_cells(state.map.tiles(), pose.point());
            surround.remember(pose, cells);
        }
        GroundModel::Uneven(_) => {
            let rims = obstacle_points::inflated_border_cells(state.map.tiles(), pose.point());
            surround.keep_off(pose, rims);
        }
    }
    surround
}

/// Without a local goal: stand, or look around after long.
pub(super) fn look_about<const TILES: usize, const SLOTS: usize>(
    config: &Config,
    state: &mut State<TILES, SLOTS>,
    input: &Input<'_>,
) -> Twist {
    if !is_at_a_loss(state, Twist::default(), input.time_ms) {
        return Twist::default();
    }
    let surround = surround(state, &input.pose, None);
    let wish = state.drive.look_around(config, &surround, input.velocity);
    within_limits(config, wish)
}

/// Whether the robot has stood for long and still does, on uneven ground: what it has not measured it may see when it turns. It does so every
/// second while, and searches for a manoeuvre between.
fn is_at_a_loss<const TILES: usize, const SLOTS: usize>(
    state: &State<TILES, SLOTS>,
    velocity: Twist,
    time_ms: u32,
) -> bool {
    let whiles = whiles_stood(state, time_ms);
    matches!(state.ground, GroundModel::Uneven(_))
        && velocity == Twist::default()
        && whiles >= WHILES_AT_A_LOSS
        && whiles % 2 == 1
}

/// For how many whiles the robot has stood about where it stands.
fn whiles_stood<const TILES: usize, const SLOTS: usize>(
    state: &State<TILES, SLOTS>,
    time_ms: u32,
) -> u32 {
    state.strategy.frontier.standing_ms(time_ms) / WHILE_MS
}

/// Whether the path's goal lies clearly higher or lower than the robot, as far as its height is known.
fn wedge_of_goal<const TILES: usize, const SLOTS: usize>(
    state: &State<TILES, SLOTS>,
    robot_m: f32,
) -> Option<SlopeDirection> {
    let GroundModel::Uneven(storeys) = &state.ground else {
        return None;
    };
    let goal = state.strategy.frontier.path().goal();
    let rise_m = storeys.height_around_m(state.map.tiles(), goal)? - robot_m;
    if rise_m.abs() < LEVEL_M {
        None
    } else if rise_m > 0.0 {
        Some(SlopeDirection::Up)
    } else {
        Some(SlopeDirection::Down)
    }
}

/// No faster than the session allows, whatever a manoeuvre has in mind.
fn within_limits(config: &Config, wish: Twist) -> Twist {
    let (linear, angular) = (config.max_linear_mps, config.max_angular_radps);
    Twist {
        linear_mps: wish.linear_mps.min(linear).max(-linear),
        angular_radps: wish.angular_radps.min(angular).max(-angular),
    }
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

/// q of the window cell at a position in cells.
fn potential_at(window: &Window, x: f32, y: f32) -> f32 {
    match (
        usize::try_from(math::floor(x)),
        usize::try_from(math::floor(y)),
    ) {
        (Ok(x), Ok(y)) => window.q(x, y),
        _ => 0.0,
    }
}

/// A place in the robot's frame as a point of the odometry frame.
pub(super) fn ahead(pose: &Pose, place: Place) -> Point {
    let (sin, cos) = math::sin_cos(pose.yaw_rad);
    Point {
        x_m: pose.x_m + place.x_m * cos - place.y_m * sin,
        y_m: pose.y_m + place.x_m * sin + place.y_m * cos,
    }
}

/// The field's heading at a place near the robot, radians to the left of the robot's own.
fn heading_at(window: &Window, at: (Cell, i32), pose: &Pose, place: Place) -> Option<f32> {
    let (x, y) = local_grid::position(at, ahead(pose, place));
    descent::heading_at(window, x, y).map(|heading| math::wrap(heading - pose.yaw_rad))
}

#[cfg(test)]
mod tests {
    use std::boxed::Box;
    use std::vec::Vec;

    use super::*;
    use crate::config::UnevenGround;
    use crate::field::{SIDE, solve};

    /// Turn rates of a robot that stands where no field leads anywhere, at these times since it last moved.
    fn turn_rates<const N: usize>(terrain: Option<UnevenGround>, times_ms: [u32; N]) -> [f32; N] {
        let config = Config {
            ground: terrain,
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
            } = steer(&config, &mut state, &mut workspace, &input).velocity;
            assert_eq!(linear_mps, 0.0);
            angular_radps
        })
    }

    #[test]
    fn a_robot_that_has_stood_for_25_s_on_uneven_ground_looks_around_every_second_while() {
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

    /// The heading that is driven, degrees, by a robot on a slope that rises to the north while the field leads east, when it has stood so long.
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
        steer(&config, &mut state, &mut workspace, &input)
            .heading_rad
            .to_degrees()
    }

    #[test]
    fn a_robot_that_has_stood_for_25_s_leaves_the_limit_of_its_roll() {
        // tan 15°, on a slope of 16.7°.
        let limit = 0.268;
        assert!(heading_deg(limit, 20_000).abs() > 5.0);
        assert!(heading_deg(limit, 25_000).abs() < 1.0);
        assert!(heading_deg(UnevenGround::TABLE_I.climb, 20_000).abs() < 1.0);
    }
}

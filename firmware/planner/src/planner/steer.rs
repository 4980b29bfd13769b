//! Following the window's field without touching anything \[Jorge15, Algorithm 1, line 28\].
//!
//! Units: metres, seconds, radians; milliseconds where a name says so.

use crate::doing::Doing;
use crate::drive::side_slope::{Hysteresis, SlopeDirection};
use crate::drive::{CollisionChecker, Incline, Place, SearchQuery};
use crate::field::local_grid;
use crate::field::{Window, descent};
use crate::geometry::{CELL_M, Cell, MapPose, Pose, Twist};
use crate::math;
use crate::planner::Output;
use crate::planner::step::Step;
use crate::planner::workspace::Workspace;

/// The period of looking around, milliseconds: the time of half a turn.
const LOOK_PERIOD_MS: u32 = 5_000;
/// Periods after which a standing robot is stalled, on uneven ground: by then two passages were
/// blocked.
const STALLED_PERIODS: u32 = 5;

/// What leads the robot: the window's field, or one heading of the strategy. On a slope that it
/// must not cross the heading is bent.
struct Guide {
    /// The window's least map cell and its scale.
    at: (Cell, i32),
    pose: Pose,
    /// The strategy's heading, radians to the left of the robot's own.
    lead: Option<f32>,
    incline: Option<Incline>,
    hysteresis: Hysteresis,
}

impl Guide {
    /// Returns the position of a place near the robot in the window, in window cells.
    fn position(&self, place: Place) -> (f32, f32) {
        local_grid::position(self.at, self.pose.to_map(place.point()))
    }

    /// Returns the heading at a place, radians to the left of the robot's own, and the direction
    /// that it takes on a slope.
    fn heading(&self, window: &Window, place: Place) -> Option<(f32, Option<SlopeDirection>)> {
        let field = || {
            let (x, y) = self.position(place);
            let heading = descent::heading_at(window, x, y)?;
            Some(math::wrap(heading - self.pose.yaw_rad))
        };
        let wanted = self.lead.or_else(field)?;
        Some(match &self.incline {
            Some(incline) => incline.heading(place, wanted, self.hysteresis),
            None => (wanted, None),
        })
    }
}

impl<const TILES: usize, const SLOTS: usize> Step<'_, TILES, SLOTS> {
    /// Returns the velocity that follows the window's field, or the heading `lead_rad` of a
    /// strategy that needs no window.
    pub(super) fn steer(&mut self, lead_rad: Option<f32>) -> Output {
        let pose = self.input.pose;
        let lead = lead_rad.map(|lead_rad| math::wrap(lead_rad - pose.yaw_rad));
        let beside = lead.map(|_| (pose.point().cell(), 1));
        let Some(at) = self.workspace.window_at.or(beside) else {
            return Output::waiting();
        };
        let guide = Guide {
            at,
            pose,
            lead,
            incline: self.incline(),
            hysteresis: self.hysteresis(),
        };
        let here = guide.heading(&self.workspace.window, Place::default());
        self.state.slope_direction = here.and_then(|(_, direction)| direction);
        let mut checker = CollisionChecker::empty(&self.config.robot);
        checker.stand_on(guide.incline.clone());
        self.obstruct(&mut checker);
        let velocity = if here.is_some() {
            self.follow(&guide, &checker)
        } else if is_at_goal(&self.workspace.window, guide.position(Place::default())) {
            // The field has no gradient in the goal's own cell: look around until the cell is
            // explored.
            self.look_around(&checker)
        } else {
            self.state.strategy.frontier.note_closed();
            Twist::default()
        };
        self.note_wedged(&checker);
        let doing = self.state.follows();
        let (velocity, doing) = if self.should_look(velocity) {
            (self.look_around(&checker), Doing::LooksAbout)
        } else {
            (velocity, doing)
        };
        let turn = here.map_or(0.0, |(heading, _)| heading);
        Output {
            velocity,
            doing,
            heading_rad: math::wrap(pose.yaw_rad + turn),
            ..Output::default()
        }
    }

    /// Returns the slopes that bound the headings. A robot that is stalled within its roll limit
    /// leaves the limit rather than stand there for ever.
    fn incline(&self) -> Option<Incline> {
        let ground = self.config.ground.as_ref()?;
        if self.standing_periods() >= STALLED_PERIODS {
            return None;
        }
        let heights = self.state.map.heights();
        Incline::new(&self.config.robot, ground, &heights, &self.input.pose)
    }

    fn hysteresis(&self) -> Hysteresis {
        let (state, pose) = (&self.state, &self.input.pose);
        let goal = state.strategy.frontier.path().goal();
        Hysteresis {
            previous: state.slope_direction,
            goal: state.ground.direction_of(state.map.tiles(), goal, pose.z_m),
            blocked: state.blocked_direction,
        }
    }

    /// Follows what leads the robot, past the obstacles.
    fn follow(&mut self, guide: &Guide, checker: &CollisionChecker) -> Twist {
        let Workspace {
            window, scratch, ..
        } = &mut *self.workspace;
        let state = &mut *self.state;
        let heading_at = |place| guide.heading(window, place).map(|(heading, _)| heading);
        let potential_at = |place| potential_at(window, guide.position(place));
        let potential_at = guide.lead.is_none().then_some(&potential_at as _);
        let mut query = SearchQuery::new(checker, heading_at, potential_at);
        // A gap that is hardly wider than the hull may let the robot in and not out again.
        query.squeezes = state.strategy.frontier.has_second_chance();
        query.is_careful = !query.squeezes;
        let odom = state.localiser.odom();
        query.is_surrounded = state.ground.is_surrounded(&odom, &self.config.robot);
        let rested = state.drive.is_resting();
        let scratch = bytemuck::cast_slice_mut(scratch);
        let velocity = state
            .drive
            .follow(self.config, &mut query, self.input.velocity, scratch);
        // Where the drive finds no way in one direction it takes the other, until its next search.
        state.blocked_direction = match (rested, state.drive.is_resting()) {
            (_, false) => None,
            (false, true) => state.slope_direction,
            (true, true) => state.blocked_direction,
        };
        velocity
    }

    /// Notes a robot that found no way and cannot turn.
    fn note_wedged(&mut self, checker: &CollisionChecker) {
        let state = &mut *self.state;
        let odom = state.localiser.odom();
        if !state.drive.take_wedged() || state.ground.open_trap(&odom, &self.config.robot) {
            return;
        }
        // What another robot closes will be open again.
        if checker.has_company() {
            state.team.way.shut();
        } else {
            let (robot, time_ms) = (self.input.pose.point(), self.input.time_ms);
            state.strategy.frontier.note_wedged(robot, time_ms);
        }
    }

    fn look_around(&mut self, checker: &CollisionChecker) -> Twist {
        let now = self.input.velocity;
        self.state.drive.look_around(self.config, checker, now)
    }

    /// Returns the velocity without a local goal: zero, or a turn to look about. It is not inlined:
    /// its obstacles would lie on the stack of every step.
    #[inline(never)]
    pub(super) fn look_about(&mut self) -> Twist {
        if !self.should_look(Twist::default()) {
            return Twist::default();
        }
        let mut checker = CollisionChecker::empty(&self.config.robot);
        self.obstruct(&mut checker);
        self.look_around(&checker)
    }

    /// Begins a retreat from where a passage was blocked, if the robot cannot turn there or blocked
    /// another one there before.
    #[inline(never)]
    pub(super) fn begin_retreat(&mut self) {
        let mut checker = CollisionChecker::empty(&self.config.robot);
        self.obstruct(&mut checker);
        let frontier = &self.state.strategy.frontier;
        let must = frontier.failed_before_here() || frontier.goes_back();
        self.state.drive.begin_retreat(&checker, must);
    }

    /// Returns the velocity back along the robot's own track, up to a place where it can turn.
    #[inline(never)]
    pub(super) fn retreat(&mut self) -> Twist {
        let mut checker = CollisionChecker::empty(&self.config.robot);
        let odom = self.state.localiser.odom();
        self.state.ground.obstruct_measured(&odom, &mut checker);
        self.keep_off_peers(&mut checker);
        self.keep_inside(&mut checker);
        let (pose, now) = (MapPose(self.input.pose), self.input.velocity);
        let velocity = self.state.drive.retreat(self.config, &pose, &checker, now);
        self.obstruct(&mut checker);
        let leads_on = !self.state.strategy.frontier.goes_back();
        self.state.drive.end_retreat(&checker, leads_on);
        velocity
    }

    /// Adds what the drive must not touch: the obstacles near by, the other robots, and what is
    /// forbidden.
    #[inline(never)]
    pub(super) fn obstruct(&self, checker: &mut CollisionChecker) {
        let tiles = self.state.map.tiles();
        let poses = (&self.input.pose, &self.state.localiser.odom());
        self.state
            .ground
            .obstruct(self.config, tiles, poses, checker);
        self.keep_off_peers(checker);
        self.keep_inside(checker);
    }

    /// Adds the forbidden cells at the fence within the way that the robot needs to stop.
    #[inline(never)]
    fn keep_inside(&self, checker: &mut CollisionChecker) {
        let fence = self.state.map.tiles().fence();
        if fence.is_empty() {
            return;
        }
        let config = self.config;
        let (speed, accel) = (config.max_linear_mps, config.linear_accel_mps2);
        let stop_m = speed * (config.period_s + 0.5 * speed / accel);
        let reach_m = config.robot.half_diagonal_m + stop_m;
        let reach = math::floor(reach_m / CELL_M) + 1;
        checker.fence_off(&self.input.pose, fence, reach);
    }

    /// Adds the other robots.
    fn keep_off_peers(&self, checker: &mut CollisionChecker) {
        let (robot, time_ms) = (self.robot(), self.input.time_ms);
        let team = &self.state.team;
        for (peer, hull) in team.peers().near(time_ms, robot, self.config) {
            let may_move = team.way.may_move(peer, time_ms);
            checker.keep_off_hull(&self.input.pose, hull.outline(), may_move);
        }
    }

    /// Returns true if the robot should look around: it waits that what is in the way goes, and a
    /// turn may show that it has gone; or it is stalled on uneven ground, and a turn may measure
    /// ground that it has not seen. Stalled, it looks around in every second period, and searches
    /// for a recovery between.
    fn should_look(&self, velocity: Twist) -> bool {
        let periods = self.standing_periods();
        let is_stalled =
            self.state.ground.is_uneven() && periods >= STALLED_PERIODS && periods % 2 == 1;
        velocity == Twist::default() && (self.state.strategy.frontier.is_waiting() || is_stalled)
    }

    /// Returns the whole periods for which the robot has stood at its place.
    fn standing_periods(&self) -> u32 {
        self.state.strategy.frontier.standing_ms(self.input.time_ms) / LOOK_PERIOD_MS
    }
}

/// Returns the window cell at a position in cells.
fn index((x, y): (f32, f32)) -> Option<(usize, usize)> {
    let index = |at| usize::try_from(math::floor(at)).ok();
    index(x).zip(index(y))
}

fn is_at_goal(window: &Window, position: (f32, f32)) -> bool {
    index(position).is_some_and(|(x, y)| window.is_goal(x, y))
}

/// Returns q of the window cell at a position in cells.
fn potential_at(window: &Window, position: (f32, f32)) -> f32 {
    index(position).map_or(0.0, |(x, y)| window.q(x, y))
}

#[cfg(test)]
mod tests {
    use std::boxed::Box;
    use std::vec::Vec;

    use super::*;
    use crate::config::{Config, UnevenGround};
    use crate::field::{SIDE, solve};
    use crate::input::Input;
    use crate::planner::state::State;

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
            } = Step::new(&config, &mut state, &mut workspace, input)
                .steer(None)
                .velocity;
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
        Step::new(&config, &mut state, &mut workspace, input)
            .steer(None)
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

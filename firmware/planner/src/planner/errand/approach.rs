//! The last metre of an errand: straight to the place, also backwards, and a turn on the spot.
//!
//! Units: metres, radians, milliseconds, in the map's frame.

use crate::clock::since;
use crate::drive::track::BACK_MPS;
use crate::drive::{CollisionChecker, Place};
use crate::geometry::{CELL_M, Cell, Point, Twist};
use crate::math;
use crate::planner::Output;
use crate::planner::errand::PROMISED;
use crate::planner::step::Step;
use crate::roadmap::configuration_space::is_passable;

/// A robot this near to the goal is there, metres. It may end 0.2 m off: braking ends within a map
/// cell, and a turn on the spot slips.
const THERE_M: f32 = 0.1;
/// A robot that has been there and is no farther off than this stays, metres.
const STAYS_M: f32 = 0.18;
/// Distance from which the robot drives straight to the goal, metres.
const STRAIGHT_M: f32 = 1.0;
/// A heading this near to the one asked for is that, radians: half of the 10° that are promised.
const TURNED_RAD: f32 = 0.087;
/// Turn rates on the spot, radians per second: the most, the least, and the one for each radian
/// that is left.
const TURN_RADPS: (f32, f32) = (0.6, 0.12);
const TURN_GAIN_HZ: f32 = 1.5;
/// Clearance of the turn, metres: that of a creeping robot.
const TURN_MARGIN_M: f32 = 0.02;
/// Time in which the heading comes no nearer, because there is no room or the robot does not turn,
/// after which the errand ends, milliseconds.
const NO_TURN_MS: u32 = 10_000;

impl<const TILES: usize, const SLOTS: usize> Step<'_, TILES, SLOTS> {
    /// Drives the last metre of an errand: straight to the goal, and then to the heading asked for.
    /// Returns `None` as long as the path leads.
    #[inline(never)]
    pub(in crate::planner) fn approach(&mut self) -> Option<Output> {
        let (config, robot, now) = (self.config, self.robot(), self.input.velocity);
        let going = self.state.errands.going_mut()?;
        let left_m = robot.distance_m(going.to);
        if !going.is_there {
            // The clock of a turn that was begun stands while the robot is away.
            going.turned_ms = match going.has_turned() {
                true => going.turned_ms.wrapping_add(config.period_ms()),
                false => self.input.time_ms,
            };
        }
        let stays_m = if going.settles { PROMISED.0 } else { STAYS_M };
        going.is_there = left_m <= THERE_M || (going.is_there && left_m <= stays_m);
        going.straight_rad = None;
        if going.is_there {
            self.state.strategy.frontier.pause(self.input.time_ms);
            return Some(self.turn());
        }
        let (tiles, footprint) = (self.state.map.tiles(), &self.footprint);
        let passable = |cell| is_passable(tiles, footprint, cell);
        if left_m > STRAIGHT_M || !is_open(robot, going.to, passable) {
            return None;
        }
        let lead_rad = math::atan2(going.to.y_m - robot.y_m, going.to.x_m - robot.x_m);
        going.straight_rad = Some(lead_rad);
        // The zero command is always safe, so the robot brakes by it.
        let speed = now.linear_mps.abs();
        let stop_m = speed * (config.period_s + 0.5 * speed / config.linear_accel_mps2);
        if speed > 0.0 && stop_m + 0.5 * THERE_M >= left_m {
            return Some(Output::going());
        }
        if let Some(velocity) = self.back(lead_rad) {
            return Some(Output {
                velocity,
                ..Output::going()
            });
        }
        Some(self.steer(Some(lead_rad)))
    }

    /// Returns the velocity backwards to a place in this direction, for a robot that cannot turn to
    /// it; `None` if it can, if the place is not behind it, or if something is in the way. Without
    /// this it would drive to and fro: a little room ahead lets it drive on, and a little room
    /// behind back.
    #[inline(never)]
    fn back(&self, lead_rad: f32) -> Option<Twist> {
        let turn = math::wrap(lead_rad - self.input.pose.yaw_rad);
        if turn.abs() <= 0.5 * math::PI {
            return None;
        }
        let mut checker = CollisionChecker::empty(&self.config.robot);
        self.obstruct(&mut checker);
        let turns = [turn, turn - 2.0 * math::PI * turn.signum()];
        let is_free =
            |&turn: &f32| checker.is_arc_clear(Place::default(), 0.0, turn, TURN_MARGIN_M);
        if turns.iter().any(is_free) {
            return None;
        }
        // The tail turns to the place.
        let most = TURN_RADPS.0;
        let angular = (TURN_GAIN_HZ * math::wrap(turn - math::PI)).clamp(-most, most);
        let twists = [
            (BACK_MPS, angular),
            (0.5 * BACK_MPS, angular),
            (BACK_MPS, 0.0),
        ];
        let twists = twists.map(|(speed, angular_radps)| Twist {
            linear_mps: -speed,
            angular_radps,
        });
        let now = self.input.velocity;
        let admits = |it: &Twist| checker.admits(*it, now, self.config, TURN_MARGIN_M);
        twists.into_iter().find(admits)
    }

    /// Turns to the heading that the errand asks for, on the side where there is room, and ends the
    /// errand once the robot stands. It is not inlined: [`Step::back`] needs room for obstacles
    /// too, and the two would lie on the stack together.
    #[inline(never)]
    fn turn(&mut self) -> Output {
        let (pose, now, time_ms) = (self.input.pose, self.input.velocity, self.input.time_ms);
        let Some(going) = self.state.errands.going() else {
            return Output::going();
        };
        let error = going.error_rad(&pose);
        if error.abs() <= TURNED_RAD {
            if now.linear_mps.abs() < 0.05 && now.angular_radps.abs() < 0.1 {
                self.state.end_errand(true);
            }
            return Output::going();
        }
        let mut checker = CollisionChecker::empty(&self.config.robot);
        self.obstruct(&mut checker);
        let (most, least) = TURN_RADPS;
        let rate = (TURN_GAIN_HZ * error.abs()).clamp(least, most);
        let sides = [rate.min(most) * error.signum(), -most * error.signum()];
        // All the way round, or the robot would turn to and fro before what is in the way.
        let turns = [error, error - math::PI * 2.0 * error.signum()];
        let mut sides = sides.into_iter().zip(turns);
        let found = sides.find_map(|(angular_radps, turn_rad)| {
            let twist = Twist {
                linear_mps: 0.0,
                angular_radps,
            };
            let is_free = checker.is_arc_clear(Place::default(), 0.0, turn_rad, TURN_MARGIN_M)
                && checker.admits(twist, now, self.config, TURN_MARGIN_M);
            is_free.then_some((twist, turn_rad))
        });
        let mut is_late = since(time_ms, going.turned_ms) > NO_TURN_MS;
        if let (Some((_, turn_rad)), Some(going)) = (found, self.state.errands.going_mut())
            && let Some(left_rad) = going.left_rad.get_mut(usize::from(turn_rad < 0.0))
            && turn_rad.abs() < *left_rad - TURNED_RAD
        {
            (*left_rad, going.turned_ms, is_late) = (turn_rad.abs(), time_ms, false);
        }
        if is_late {
            self.state.end_errand(false);
        }
        Output {
            velocity: found.map(|(twist, _)| twist).unwrap_or_default(),
            ..Output::going()
        }
    }
}

/// Returns true if all cells on the way between two points, which are near each other, are open.
/// The robot may stand nearer to an obstacle than it plans for: its own cell does not count.
fn is_open(from: Point, to: Point, passable: impl Fn(Cell) -> bool) -> bool {
    let parts = math::floor(2.0 * from.distance_m(to) / CELL_M) + 1;
    (1..=parts).all(|k| {
        let part = k as f32 / parts as f32;
        let at = Point {
            x_m: from.x_m + part * (to.x_m - from.x_m),
            y_m: from.y_m + part * (to.y_m - from.y_m),
        };
        at.cell() == from.cell() || passable(at.cell())
    })
}

//! The builder of a configuration: defaults, one method per parameter, and all range checks.
//!
//! Units: as the names say.

use heapless::Vec;

use crate::config::fence::check_fence;
use crate::config::{
    Area, Budget, Config, ConfigError, GoalLevel, LoopLimits, Order, Parameter, SolverConfig,
    SpaceField, Strategy, TeamPlace, Tuning, UnevenGround,
};
use crate::fence::Fence;
use crate::geometry::{CELL_M, Pose};
use crate::input::NO_RETURN_MM;
use crate::math::PI;
use crate::robot::{LaserMount, MAX_BEAMS, RobotShape};

/// The least value of a quantity that must be positive. It is below the wire's resolution of 2⁻¹².
const POSITIVE: f32 = 1e-4;
/// Greatest coordinate and greatest yaw of a place in the team, metres and radians: tiles on the
/// wire reach as far, and a hundred turns are surely no angle.
const TEAM_M: f32 = 400.0;
const TEAM_RAD: f32 = 628.0;
/// The greatest value of a quantity that has no limit of its own.
pub(super) const ANY: f32 = 1e6;
/// Planning radii, metres: half a map cell, and the most that the configuration space can grow
/// obstacles by.
const RADII_M: (f32, f32) = (0.5 * CELL_M, Config::MAX_RADIUS_M);
/// Time in which the robot must come to rest from its greatest speed, seconds: the drive looks four
/// seconds ahead, one period and the braking after it.
const REST_S: f32 = 3.0;
/// Distance of an area's corner from the origin along an axis, map cells.
const CORNER_CELLS: f32 = 32_000.0;
/// Distance of a laser from the robot's centre, metres.
const MOUNT_M: f32 = 2.0;
/// One turn, rounded up, radians.
const TURN_RAD: f32 = 2.0 * PI + 1e-4;
/// Pitches of a tilted laser, radians: down, by less than a right angle.
const PITCHES_RAD: (f32, f32) = (0.0, 0.5 * PI - 3e-4);
/// Steepest slope, a tangent: 45°.
const STEEPEST: f32 = 1.0002;
/// Greatest worth, square metres for each metre.
const MOST_WORTH: f32 = 7.0;
/// Strongest preference: beyond it the relaxation diverges \[Maffei20, III-C\].
const STRONGEST: f32 = 2.0;

/// Builds a [`Config`]; made by [`Config::builder`].
///
/// ```
/// use fieldline_planner::{Config, ConfigBuilder, LaserMount, RobotShape};
///
/// let slow: ConfigBuilder = Config::builder(RobotShape::round(0.5, 0.3))
///     .laser(LaserMount::level(0.10, 0.40))
///     .max_speed(0.3, 1.0);
/// assert_eq!(slow.build()?.max_speed().linear_mps, 0.3);
/// # Ok::<(), fieldline_planner::ConfigError>(())
/// ```
#[derive(Clone, Debug)]
pub struct ConfigBuilder {
    config: Config,
    /// Lasers that were given, including those that did not fit.
    lasers: u8,
}

impl ConfigBuilder {
    /// Returns the defaults for a robot.
    pub(super) const fn new(robot: RobotShape) -> Self {
        Self {
            config: Config::new(robot, Vec::new()),
            lasers: 0,
        }
    }

    /// Adds a laser: one or two. The first one is level; on uneven ground the second one looks
    /// down.
    #[must_use]
    pub fn laser(mut self, laser: LaserMount) -> Self {
        // A third one does not fit; `build` refuses it by the count.
        let _ = self.config.lasers.push(laser);
        self.lasers = self.lasers.saturating_add(1);
        self
    }

    /// Sets the strategy. Default: [`Strategy::Frontier`].
    #[must_use]
    pub const fn strategy(mut self, strategy: Strategy) -> Self {
        self.config.strategy = strategy;
        self
    }

    /// Sets the limits of the loops to close, for [`Strategy::Ouroboros`].
    #[must_use]
    pub const fn loops(mut self, loops: LoopLimits) -> Self {
        self.config.loops = loops;
        self
    }

    /// Makes the planner measure heights and avoid slopes, edges and holes. Needs two lasers.
    /// Default: flat ground.
    #[must_use]
    pub const fn uneven_ground(mut self, ground: UnevenGround) -> Self {
        self.config.ground = Some(ground);
        self
    }

    /// Corrects the odometry by the level scan, or takes it for the pose. Default: true, because
    /// every odometry drifts.
    #[must_use]
    pub const fn localise(mut self, localise: bool) -> Self {
        self.config.localise = localise;
        self
    }

    /// Makes the planner only localise and map: it plans nothing and commands no velocity. Default:
    /// it explores.
    #[must_use]
    pub const fn survey(mut self, survey: bool) -> Self {
        self.config.survey = survey;
        self
    }

    /// Sets the radius of the disc that paths are planned for, metres: 0.05 to 0.6. Default:
    /// [`RobotShape::planning_radius_m`].
    #[must_use]
    pub const fn radius_m(mut self, radius_m: f32) -> Self {
        self.config.robot_radius_m = radius_m;
        self
    }

    /// Sets the greatest speeds, metres and radians per second. Default: 0.7 m/s and 2.44 rad/s.
    #[must_use]
    pub const fn max_speed(mut self, linear_mps: f32, angular_radps: f32) -> Self {
        self.config.max_linear_mps = linear_mps;
        self.config.max_angular_radps = angular_radps;
        self
    }

    /// Sets the accelerations, metres and radians per second squared. They must stop the robot from
    /// its greatest speed within 3 s. Default: 0.3 m/s² and 1.75 rad/s².
    #[must_use]
    pub const fn acceleration(mut self, linear_mps2: f32, angular_radps2: f32) -> Self {
        self.config.linear_accel_mps2 = linear_mps2;
        self.config.angular_accel_radps2 = angular_radps2;
        self
    }

    /// Sets the time from one step to the next, seconds: 0.1 to 0.4. Default: 0.2.
    #[must_use]
    pub const fn period_s(mut self, period_s: f32) -> Self {
        self.config.period_s = period_s;
        self
    }

    /// Sets the window's solver. Default: 3 multigrid cycles per step.
    #[must_use]
    pub const fn solver(mut self, solver: SolverConfig) -> Self {
        self.config.solver = solver;
        self
    }

    /// Sets the order in which frontiers are taken, for every strategy. Default: by gain for
    /// [`Strategy::Frontier`], the nearest first for the others.
    #[must_use]
    pub const fn order(mut self, order: Order) -> Self {
        self.config.order = Some(order);
        self
    }

    /// Sets a user's own order of goals, for every strategy: a level counts as so much more way.
    /// Default: all goals have the same level.
    #[must_use]
    pub const fn goal_level(mut self, level: GoalLevel) -> Self {
        self.config.goal_level = Some(level);
        self
    }

    /// Sets the tuned constants. Default: [`Tuning::DEFAULT`].
    #[must_use]
    pub const fn tuning(mut self, tuning: &'static Tuning) -> Self {
        self.config.tuning = tuning;
        self
    }

    /// Makes the robot one of a team: it says and hears packets ([`crate::State::say`]). Default: a
    /// robot alone.
    #[must_use]
    pub const fn team(mut self, place: TeamPlace) -> Self {
        self.config.team = Some(place);
        self
    }

    /// Sets where the robot may be, in the map's frame. Its hull leaves no bounds and enters no
    /// no-go polygon, and what lies there counts as explored. Default: it may be everywhere.
    #[must_use]
    pub fn fence(mut self, fence: Fence) -> Self {
        self.config.fence = fence;
        self
    }

    /// Sets what the robot may drive before it must be home. Default: anything.
    #[must_use]
    pub const fn budget(mut self, budget: Budget) -> Self {
        self.config.budget = budget;
        self
    }

    /// Checks every parameter and returns the configuration.
    ///
    /// On uneven ground the greatest speed becomes at most one map cell per period, so that two
    /// sweeps of the tilted laser leave no gap.
    ///
    /// # Errors
    /// [`ConfigError`] with the first parameter that is out of its range.
    pub fn build(mut self) -> Result<Config, ConfigError> {
        let config = &self.config;
        check(Parameter::Lasers, f32::from(self.lasers), (1.0, 2.0))?;
        for (number, laser) in config.lasers.iter().enumerate() {
            check_laser(laser, number == 0)?;
        }
        check_motion(config)?;
        check_shape(&config.robot)?;
        check(Parameter::Radius, config.robot_radius_m, RADII_M)?;
        check(Parameter::Period, config.period_s, Config::PERIODS_S)?;
        check_loops(&config.loops)?;
        check_fence(&config.fence)?;
        if let Some(team) = &config.team {
            check_place(team)?;
        }
        check(Parameter::Worth, config.order().worth(), (0.0, MOST_WORTH))?;
        if let Strategy::Sbpf(field) | Strategy::Esbpf(field) = &config.strategy {
            check_field(field)?;
        }
        check(Parameter::Solver, config.solver.tolerance, (POSITIVE, 1.0))?;
        let cycles = f32::from(config.solver.max_cycles);
        check(Parameter::Solver, cycles, (1.0, ANY))?;
        if let Some(ground) = &config.ground {
            check_ground(ground)?;
            check(Parameter::Lasers, f32::from(self.lasers), (2.0, 2.0))?;
            let cell_mps = CELL_M / config.period_s;
            self.config.max_linear_mps = config.max_linear_mps.min(cell_mps);
        }
        Ok(self.config)
    }
}

/// Returns an error if a value is outside its range or not a number.
pub(super) fn check(
    parameter: Parameter,
    value: f32,
    (least, most): (f32, f32),
) -> Result<(), ConfigError> {
    if value >= least && value <= most {
        return Ok(());
    }
    Err(ConfigError {
        parameter,
        value,
        least,
        most,
    })
}

fn check_motion(config: &Config) -> Result<(), ConfigError> {
    let (linear, angular) = (config.max_linear_mps, config.max_angular_radps);
    check(Parameter::MaxLinear, linear, (POSITIVE, ANY))?;
    check(Parameter::MaxAngular, angular, (POSITIVE, ANY))?;
    let accel = config.linear_accel_mps2;
    check(Parameter::LinearAccel, accel * REST_S, (linear, ANY))
        .map_err(|error| per_rest(error, accel))?;
    let accel = config.angular_accel_radps2;
    check(Parameter::AngularAccel, accel * REST_S, (angular, ANY))
        .map_err(|error| per_rest(error, accel))
}

/// Returns the error of an acceleration whose effect over [`REST_S`] was checked.
fn per_rest(error: ConfigError, value: f32) -> ConfigError {
    ConfigError {
        value,
        least: error.least / REST_S,
        ..error
    }
}

fn check_shape(robot: &RobotShape) -> Result<(), ConfigError> {
    check(Parameter::HalfLength, robot.half_length_m, (POSITIVE, 2.0))?;
    check(Parameter::HalfWidth, robot.half_width_m, (POSITIVE, 2.0))?;
    check(Parameter::Height, robot.height_m, (0.0, 2.0))
}

fn check_laser(laser: &LaserMount, is_first: bool) -> Result<(), ConfigError> {
    let beams = f32::from(laser.beams);
    check(Parameter::Beams, beams, (1.0, f32::from(MAX_BEAMS)))?;
    let range = f32::from(laser.range_limit_mm);
    check(
        Parameter::RangeLimit,
        range,
        (1.0, f32::from(NO_RETURN_MM - 1)),
    )?;
    let first = laser.first_bearing_rad;
    check(Parameter::FirstBearing, first, (-TURN_RAD, TURN_RAD))?;
    let step = laser.bearing_step_rad;
    check(Parameter::BearingStep, step, (1e-6, TURN_RAD))?;
    check(Parameter::Sweep, step * (beams - 1.0), (0.0, TURN_RAD))?;
    if !is_first {
        check(Parameter::Pitch, laser.pitch_rad, PITCHES_RAD)?;
    } else if !laser.is_level() {
        let level = LaserMount::LEVEL_RAD;
        check(Parameter::Pitch, f32::NAN, (-level, level)).map_err(|error| ConfigError {
            value: laser.pitch_rad,
            ..error
        })?;
    }
    check(Parameter::Mount, laser.x_m, (-MOUNT_M, MOUNT_M))?;
    check(Parameter::Mount, laser.y_m, (-MOUNT_M, MOUNT_M))?;
    check(Parameter::LaserHeight, laser.z_m, (POSITIVE, MOUNT_M))?;
    let most_ms = match laser.is_level() {
        true => f32::from(LaserMount::MAX_TURN_MS),
        false => 0.0,
    };
    check(
        Parameter::TurnTime,
        f32::from(laser.turn_time_ms),
        (0.0, most_ms),
    )
}

fn check_place(place: &TeamPlace) -> Result<(), ConfigError> {
    let Pose {
        x_m, y_m, yaw_rad, ..
    } = place.map_from_odom;
    for (value, range) in [
        (x_m, (-TEAM_M, TEAM_M)),
        (y_m, (-TEAM_M, TEAM_M)),
        (yaw_rad, (-TEAM_RAD, TEAM_RAD)),
        (place.sd_m, (0.0, TEAM_M)),
        (place.sd_rad, (0.0, TEAM_RAD)),
    ] {
        check(Parameter::TeamPlace, value, range)?;
    }
    Ok(())
}

fn check_loops(loops: &LoopLimits) -> Result<(), ConfigError> {
    let values = [
        loops.least_m,
        loops.most_m,
        loops.most_per_frontier,
        loops.detour,
        loops.slack_m,
    ];
    let mut values = values.into_iter();
    values.try_for_each(|value| check(Parameter::LoopLimits, value, (0.0, ANY)))
}

fn check_field(field: &SpaceField) -> Result<(), ConfigError> {
    let Area { least, across, up } = field.area;
    for side in [across, up] {
        let most = f32::from(Area::MOST_CELLS);
        check(Parameter::Area, f32::from(side), (1.0, most))?;
    }
    for corner in [least.x, least.y] {
        check(
            Parameter::Area,
            corner as f32,
            (-CORNER_CELLS, CORNER_CELLS),
        )?;
    }
    check(
        Parameter::Coverage,
        f32::from(field.until_permille),
        (1.0, 1_000.0),
    )
}

fn check_ground(ground: &UnevenGround) -> Result<(), ConfigError> {
    let (least, most) = (ground.least_preference, ground.most_preference);
    check(Parameter::LeastPreference, least, (-STRONGEST, 0.0))?;
    check(Parameter::MostPreference, most, (0.0, STRONGEST))?;
    let ranges = [
        (ground.height_scale, (0.0, ANY)),
        (ground.global_scale, (0.0, ANY)),
        (ground.obstacle_m, (POSITIVE, ANY)),
        (ground.near_m, (POSITIVE, ANY)),
        (ground.hole_m, (-ANY, -POSITIVE)),
        (ground.step_m, (POSITIVE, ANY)),
        (ground.climb, (POSITIVE, STEEPEST)),
        (ground.roll, (POSITIVE, STEEPEST)),
    ];
    let mut ranges = ranges.into_iter();
    ranges.try_for_each(|(value, range)| check(Parameter::UnevenGround, value, range))
}

#[cfg(test)]
mod tests;

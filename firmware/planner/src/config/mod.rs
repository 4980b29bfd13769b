//! The parameters of a session, with meaning, range and default.
//!
//! A [`Config`] is built by [`Config::builder`], which checks every range.
//!
//! Units: as the names say.

mod builder;
mod error;
mod ground;
mod loops;
mod solver;
mod tuning;

pub use builder::ConfigBuilder;
pub use error::{BoxTooLarge, ConfigError, Parameter};
pub use ground::{KERNEL_CELLS, PreferenceMode, UnevenGround};
pub use loops::LoopLimits;
pub use solver::{Method, SolverConfig};
pub use tuning::{OuroborosTuning, Tuned, Tuning, TuningError};

use heapless::Vec;

use crate::robot::{LaserMount, RobotShape};

/// The exploration strategy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Strategy {
    /// Go to the nearest frontier along the skeleton.
    #[default]
    Frontier,
    /// Close loops on the way [Jorge15].
    Ouroboros,
    /// Follow rails by the time of their last visit, and patrol on them [Maffei14].
    Tdbvp {
        /// Duration of the patrol after the exploration, seconds.
        patrol_s: u16,
    },
}

/// The parameters of a session.
///
/// ```
/// use fieldline_planner::{Config, LaserMount, RobotShape, Strategy};
///
/// let config = Config::builder(RobotShape::PIONEER_3AT)
///     .laser(LaserMount::level(0.10, 0.40))
///     .strategy(Strategy::Ouroboros)
///     .period_s(0.2)
///     .build()?;
/// # Ok::<(), fieldline_planner::ConfigError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Config {
    /// The strategy. Default: the frontier.
    pub strategy: Strategy,
    /// Limits of the loops to close, for [`Strategy::Ouroboros`].
    pub loops: LoopLimits,
    /// The robot's hull. Default: a Pioneer 3-AT.
    pub robot: RobotShape,
    /// The laser scanners; the first one is level.
    pub lasers: Vec<LaserMount, 2>,
    /// The map's box in tiles of 3.2 m, across and up.
    pub box_tiles: (u8, u8),
    /// Radius of the disc that paths are planned for, metres.
    pub robot_radius_m: f32,
    /// Greatest speed, metres per second. Default: 0.7 (Pioneer 3-AT).
    pub max_linear_mps: f32,
    /// Greatest turn rate, radians per second. Default: 2.44 (140°/s).
    pub max_angular_radps: f32,
    /// Acceleration and braking, metres per second squared. Default: 0.3 (Pioneer 3-AT).
    pub linear_accel_mps2: f32,
    /// Angular acceleration, radians per second squared. Default: 1.75 (100°/s²).
    pub angular_accel_radps2: f32,
    /// Time from one step to the next, seconds. Default: 0.2.
    pub period_s: f32,
    /// The window's solver.
    pub solver: SolverConfig,
    /// Thinning budget of a step, words. Default: 6,000.
    pub topology_units: u32,
    /// The tuned constants. Default: [`Tuning::DEFAULT`].
    pub tuning: &'static Tuning,
    /// Parameters of uneven ground; `None` on flat ground, where lasers only see obstacles.
    pub ground: Option<UnevenGround>,
}

impl Config {
    /// The greatest planning radius, metres: the configuration space grows obstacles by 6 cells at
    /// most.
    pub const MAX_RADIUS_M: f32 = 0.6;
    /// Accepted periods of a step, seconds. A shorter one leaves too little time for a step; a
    /// longer one leaves too little time for a retry before a command is stale.
    pub const PERIODS_S: (f32, f32) = (0.1, 0.4);

    /// Returns a builder with the defaults for a robot.
    #[must_use]
    pub const fn builder(robot: RobotShape) -> ConfigBuilder {
        ConfigBuilder::new(robot)
    }

    /// Returns the defaults for a robot with these lasers, in the largest square box of the default
    /// image.
    const fn new(robot: RobotShape, lasers: Vec<LaserMount, 2>) -> Self {
        Self {
            strategy: Strategy::Frontier,
            loops: LoopLimits::DEFAULT,
            robot,
            lasers,
            box_tiles: (20, 20),
            robot_radius_m: robot.planning_radius_m(),
            max_linear_mps: 0.7,
            max_angular_radps: 2.44,
            linear_accel_mps2: 0.3,
            angular_accel_radps2: 1.75,
            period_s: 0.2,
            solver: SolverConfig {
                max_cycles: 3,
                ..SolverConfig::DEFAULT
            },
            topology_units: 6_000,
            tuning: &Tuning::DEFAULT,
            ground: None,
        }
    }

    /// Returns the defaults for a Pioneer 3-AT with the given lasers, unchecked.
    #[must_use]
    pub const fn pioneer_3at(lasers: Vec<LaserMount, 2>) -> Self {
        Self::new(RobotShape::PIONEER_3AT, lasers)
    }

    /// Returns the radius at the second chance, metres. The 3-AT's is 0.22 of 0.30: half its width
    /// less the error of a map cell. Another robot's is in proportion.
    #[must_use]
    pub const fn tight_radius_m(&self) -> f32 {
        self.robot_radius_m * (0.22 / 0.30)
    }
}

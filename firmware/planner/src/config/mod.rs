//! The parameters of a session, with meaning, range and default.
//!
//! A [`Config`] is built by [`Config::builder`], which checks every range.
//!
//! Units: as the names say.

mod budget;
mod builder;
mod error;
mod fence;
mod goal;
mod ground;
mod loops;
mod order;
mod solver;
mod space;
mod team;
mod tuning;

pub use budget::Budget;
pub use builder::ConfigBuilder;
pub use error::{ConfigError, Parameter};
pub use goal::{Goal, GoalLevel};
pub use ground::{KERNEL_CELLS, PreferenceMode, UnevenGround};
pub use loops::LoopLimits;
pub use order::Order;
pub use solver::{Method, SolverConfig};
pub use space::{Area, SpaceField};
pub use team::{Member, TeamPlace};
pub use tuning::{
    FieldTuning, GroundTuning, LocaliseTuning, MapTuning, OrderTuning, OuroborosTuning, SbpfTuning,
    TdbvpTuning, Tuned, Tuning, TuningError,
};

use heapless::Vec;

use crate::fence::Fence;
use crate::geometry::Twist;
use crate::robot::{LaserMount, RobotShape};

/// The exploration strategy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Strategy {
    /// Go to one frontier after the other along the skeleton.
    #[default]
    Frontier,
    /// Close loops on the way \[Jorge15\].
    Ouroboros,
    /// Follow rails by the time of their last visit, and patrol on them \[Maffei14\].
    Tdbvp {
        /// Duration of the patrol after the exploration, seconds.
        patrol_s: u16,
        /// Time without a new place after which the robot follows a path to what is left to
        /// explore, seconds; `None` for never, as in \[Maffei14\]. The simulator's default is 15.
        impatience_s: Option<u16>,
    },
    /// Follow the forces of a space-based potential field over an area of known size
    /// \[Kenealy15, 3.1\].
    Sbpf(SpaceField),
    /// The same, enhanced: gates attract, and walls lead the robot along them \[Kenealy15, 3.2 and
    /// 3.3\].
    Esbpf(SpaceField),
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
    pub(crate) strategy: Strategy,
    /// Limits of the loops to close, for [`Strategy::Ouroboros`].
    pub(crate) loops: LoopLimits,
    /// The order in which frontiers are taken; `None` for the strategy's own.
    pub(crate) order: Option<Order>,
    /// The user's own order of goals.
    pub(crate) goal_level: Option<GoalLevel>,
    /// The robot's hull. Default: a Pioneer 3-AT.
    pub(crate) robot: RobotShape,
    /// The laser scanners; the first one is level.
    pub(crate) lasers: Vec<LaserMount, 2>,
    /// Radius of the robot's disc, metres.
    pub(crate) robot_radius_m: f32,
    /// Greatest speed, metres per second. Default: 0.7 (Pioneer 3-AT).
    pub(crate) max_linear_mps: f32,
    /// Greatest turn rate, radians per second. Default: 2.44 (140°/s).
    pub(crate) max_angular_radps: f32,
    /// Acceleration and braking, metres per second squared. Default: 0.3 (Pioneer 3-AT).
    pub(crate) linear_accel_mps2: f32,
    /// Angular acceleration, radians per second squared. Default: 1.75 (100°/s²).
    pub(crate) angular_accel_radps2: f32,
    /// Time from one step to the next, seconds. Default: 0.2.
    pub(crate) period_s: f32,
    /// The window's solver.
    pub(crate) solver: SolverConfig,
    /// The tuned constants. Default: [`Tuning::DEFAULT`].
    pub(crate) tuning: &'static Tuning,
    /// Parameters of uneven ground; `None` on flat ground, where lasers only see obstacles.
    pub(crate) ground: Option<UnevenGround>,
    /// The robot's place in a team; `None` for a robot alone.
    pub(crate) team: Option<TeamPlace>,
    /// Where the robot may be. Default: everywhere.
    pub(crate) fence: Fence,
    /// What the robot may drive before it must be home. Default: anything.
    pub(crate) budget: Budget,
    /// The planner corrects odometry by the level scan. Default: true.
    pub(crate) localise: bool,
    /// The planner only localises and maps. Default: false.
    pub(crate) survey: bool,
}

/// A robot that slides, is pushed or rolls down is at most so much faster than it drives.
const SLIDE: f32 = 2.0;

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

    /// Returns the defaults for a robot with these lasers.
    const fn new(robot: RobotShape, lasers: Vec<LaserMount, 2>) -> Self {
        Self {
            strategy: Strategy::Frontier,
            loops: LoopLimits::DEFAULT,
            order: None,
            goal_level: None,
            robot,
            lasers,
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
            tuning: &Tuning::DEFAULT,
            ground: None,
            team: None,
            fence: Fence::new(),
            budget: Budget {
                range_m: None,
                time_s: None,
            },
            localise: true,
            survey: false,
        }
    }

    /// Returns the defaults for a Pioneer 3-AT with the given lasers and exact odometry, unchecked.
    #[cfg(test)]
    pub(crate) const fn pioneer_3at(lasers: Vec<LaserMount, 2>) -> Self {
        let mut config = Self::new(RobotShape::PIONEER_3AT, lasers);
        config.localise = false;
        config
    }

    /// Returns the strategy.
    #[must_use]
    pub const fn strategy(&self) -> Strategy {
        self.strategy
    }

    /// Returns the order in which frontiers are taken.
    #[must_use]
    pub const fn order(&self) -> Order {
        match (self.order, self.strategy) {
            (Some(order), _) => order,
            (None, Strategy::Frontier) => Order::GAIN,
            (None, Strategy::Ouroboros | Strategy::Tdbvp { .. }) => Order::NEAREST,
            (None, Strategy::Sbpf(_) | Strategy::Esbpf(_)) => Order::ALL,
        }
    }

    /// Returns the robot's hull.
    #[must_use]
    pub const fn robot(&self) -> &RobotShape {
        &self.robot
    }

    /// Returns the lasers: one or two, the first one level.
    #[must_use]
    pub fn lasers(&self) -> &[LaserMount] {
        &self.lasers
    }

    /// Returns the radius of the robot's disc, metres. Paths are planned for a smaller one
    /// ([`passage_radius_m`](Self::passage_radius_m)).
    #[must_use]
    pub const fn radius_m(&self) -> f32 {
        self.robot_radius_m
    }

    /// Returns the greatest speeds. On uneven ground the linear one is at most a map cell a period.
    #[must_use]
    pub const fn max_speed(&self) -> Twist {
        Twist {
            linear_mps: self.max_linear_mps,
            angular_radps: self.max_angular_radps,
        }
    }

    /// Returns the greatest speeds of a robot that slides.
    pub(crate) const fn sliding_speed(&self) -> Twist {
        Twist {
            linear_mps: SLIDE * self.max_linear_mps,
            angular_radps: SLIDE * self.max_angular_radps,
        }
    }

    /// Returns the accelerations, metres and radians per second squared.
    #[must_use]
    pub const fn acceleration(&self) -> (f32, f32) {
        (self.linear_accel_mps2, self.angular_accel_radps2)
    }

    /// Returns the time from one step to the next, seconds.
    #[must_use]
    pub const fn period_s(&self) -> f32 {
        self.period_s
    }

    /// Returns the time from one step to the next, whole milliseconds.
    pub(crate) const fn period_ms(&self) -> u32 {
        (self.period_s * 1000.0 + 0.5) as u32
    }

    /// Returns the parameters of uneven ground; `None` on flat ground.
    #[must_use]
    pub const fn ground(&self) -> Option<&UnevenGround> {
        self.ground.as_ref()
    }

    /// Returns the robot's place in a team; `None` for a robot alone.
    #[must_use]
    pub const fn team(&self) -> Option<&TeamPlace> {
        self.team.as_ref()
    }

    /// Returns where the robot may be.
    #[must_use]
    pub const fn fence(&self) -> &Fence {
        &self.fence
    }

    /// Returns true if the planner corrects odometry by the level scan.
    #[must_use]
    pub const fn localises(&self) -> bool {
        self.localise
    }

    /// Returns the tuned constants.
    #[must_use]
    pub const fn tuning(&self) -> &'static Tuning {
        self.tuning
    }

    /// Returns the radius of the disc that paths are planned for, metres. The 3-AT's is 0.22 of
    /// 0.30: half its width less the error of a map cell. Another robot's is in proportion. A gap
    /// that the robot just fits through may look narrower at 10 cm a cell, so a wider disc would
    /// close it. The drive keeps the hull clear.
    #[must_use]
    pub const fn passage_radius_m(&self) -> f32 {
        self.robot_radius_m * (0.22 / 0.30)
    }
}

//! The planner's parameters, with meaning, range and default.

mod ground;
mod loops;
mod solver;

pub use ground::{KERNEL_CELLS, PreferenceMode, UnevenGround};
pub use loops::LoopLimits;
pub use solver::{Method, SolverConfig};

use heapless::Vec;

use crate::robot::{LaserMount, RobotShape};

/// What plans.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Strategy {
    /// Go to the nearest unexplored centre cell; see [`crate::strategy::frontier`].
    #[default]
    Frontier,
    /// Close loops on the way; see [`crate::strategy::ouroboros`].
    Ouroboros,
    /// Follow rails by the time of their visit, and patrol on them; see [`crate::strategy::tdbvp`].
    Tdbvp {
        /// How long to patrol when all is explored, seconds.
        patrol_s: u16,
    },
}

/// Everything that stays the same during a session.
#[derive(Clone, Debug)]
pub struct Config {
    /// What plans. Default: the frontier.
    pub strategy: Strategy,
    /// Which loops are worth closing, where the strategy closes loops.
    pub loops: LoopLimits,
    /// The robot's hull. Default: a Pioneer 3-AT.
    pub robot: RobotShape,
    /// The laser scanners; the first one is level.
    pub lasers: Vec<LaserMount, 2>,
    /// The map's box in tiles of 3.2 m, across and up.
    pub box_tiles: (u8, u8),
    /// Radius that the robot needs, metres. Default: 0.30.
    pub robot_radius_m: f32,
    /// Radius in the second chance, metres: half the robot's width less what a cell may be in
    /// error. Default: 0.22.
    pub tight_radius_m: f32,
    /// Greatest speed, metres a second. Default: 0.7 (Pioneer 3-AT).
    pub max_linear_mps: f32,
    /// Greatest turn rate, radians a second. Default: 2.44 (140°/s).
    pub max_angular_radps: f32,
    /// Acceleration and braking of the robot, metres a second squared. Default: 0.3 (Pioneer 3-AT).
    pub linear_accel_mps2: f32,
    /// Angular acceleration, radians a second squared. Default: 1.75 (100°/s²).
    pub angular_accel_radps2: f32,
    /// Time from one step to the next, seconds. Default: 0.2.
    pub period_s: f32,
    /// The window's solver.
    pub solver: SolverConfig,
    /// Topological work in a step, thinning words. Default: 6,000.
    pub topology_units: u32,
    /// How to go about uneven ground; on flat ground, where lasers see only what stands, `None`.
    /// Default: `None`.
    pub ground: Option<UnevenGround>,
}

impl Config {
    /// A Pioneer 3-AT with the given lasers, in the largest square box of the default image.
    #[must_use]
    pub fn pioneer_3at(lasers: Vec<LaserMount, 2>) -> Self {
        Self {
            strategy: Strategy::Frontier,
            loops: LoopLimits::default(),
            robot: RobotShape::PIONEER_3AT,
            lasers,
            box_tiles: (20, 20),
            robot_radius_m: 0.30,
            tight_radius_m: 0.22,
            max_linear_mps: 0.7,
            max_angular_radps: 2.44,
            linear_accel_mps2: 0.3,
            angular_accel_radps2: 1.75,
            period_s: 0.2,
            solver: SolverConfig {
                max_cycles: 3,
                ..SolverConfig::default()
            },
            topology_units: 6_000,
            ground: None,
        }
    }
}

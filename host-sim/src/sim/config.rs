//! Parameters of a simulated run.

use crate::fence::Fence;
use crate::robot::{
    Disturbances, DriveLimits, Footprint, Lidar, Limits, Miswiring, OdometryModel, RADIUS_M,
    Traction, usual_lidars,
};
use crate::world::Start;

/// Parameters of a simulated run.
#[derive(Clone, Debug, PartialEq)]
pub struct SimConfig {
    /// Seed of all noise. Default: 0.
    pub seed: u64,
    /// Index of the world's start. Default: 0.
    pub start: usize,
    /// A start pose to use instead of the world's. Default: none.
    pub place: Option<Start>,
    /// Model of the odometry. Default: the truth.
    pub odometry: OdometryModel,
    /// The lidars, one or two, the first one level. Default: [`usual_lidars`].
    pub lidars: Vec<Lidar>,
    /// Faults of wheels and lasers. Default: none.
    pub disturbances: Disturbances,
    /// Wiring mistakes. Default: none.
    pub miswiring: Miswiring,
    /// Number of people who walk about. Default: 0.
    pub people: usize,
    /// The robot's hull. Default: a Pioneer 3-AT.
    pub footprint: Footprint,
    /// Radius around the robot's centre that the planner keeps clear, metres. Default: 0.30.
    pub radius_m: f64,
    /// Limits of the drive. Default: [`DriveLimits::default`].
    pub limits: DriveLimits,
    /// Ground that the robot may use; time beyond is counted. Default: [`Limits::WORKING`].
    pub working: Limits,
    /// Ground that the robot just survives. Default: [`Limits::FAILING`].
    pub failing: Limits,
    /// How slopes slow and shift the robot. Default: [`Traction::default`].
    pub traction: Traction,
    /// Time between observations, milliseconds. Default: 200.
    pub period_ms: u32,
    /// Longest substep, milliseconds. Default: 10.
    pub substep_ms: u32,
    /// Age at which a command no longer counts, milliseconds. Default: 500.
    pub stale_ms: u32,
    /// Where the robot may be: whether it stays there is measured. Default: everywhere.
    pub fence: Fence,
}

impl Default for SimConfig {
    fn default() -> Self {
        Self {
            seed: 0,
            start: 0,
            place: None,
            odometry: OdometryModel::Truth,
            lidars: usual_lidars(),
            disturbances: Disturbances::default(),
            miswiring: Miswiring::default(),
            people: 0,
            footprint: Footprint::PIONEER_3AT,
            radius_m: RADIUS_M,
            limits: DriveLimits::default(),
            working: Limits::WORKING,
            failing: Limits::FAILING,
            traction: Traction::default(),
            period_ms: 200,
            substep_ms: 10,
            stale_ms: 500,
            fence: Fence::default(),
        }
    }
}

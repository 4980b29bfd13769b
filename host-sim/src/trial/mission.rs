//! The settings of a run in the simulator, and what device and simulator are told of them.
//!
//! | file | content |
//! | --- | --- |
//! | `strategies` | strategies on the device by name |
//! | `odometry` | errors of the odometry by name |
//! | `explore` | the run, from a world and a link to a report |

mod explore;
mod odometry;
mod strategies;

use fieldline_protocol::message::{LoopLimits, Order, Preference, Strategy, UnevenGround};

use super::itinerary::Orders;
use super::space::SpaceMission;
use crate::baseline::bvp_papers::Relaxation;
use crate::fence::Fence;
use crate::known_map::KnownMap;
use crate::robot::presets::DEFAULT;
use crate::robot::{
    Disturbances, DriveLimits, Footprint, Lidar, Limits, Miswiring, OdometryModel, OdometryNoise,
    RADIUS_M, RobotSpec, usual_lidars,
};
use crate::sim::SimConfig;
use crate::slam::SlamPlace;
use crate::slam::particles::ParticleSpec;
use crate::world::{Start, World};
pub(super) use explore::setup;
pub use explore::{MissionError, check, explore, explore_corrected, explore_kept};
pub use odometry::OdometryProfile;
use strategies::ESBPF_IMPATIENCE_S;
pub use strategies::{BVP_PAPERS, IMPATIENCE_S, STRATEGIES, on_device};

/// Settings of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Mission {
    /// Name of the strategy, for the report.
    pub strategy: String,
    /// Parameters of uneven ground; `None` if the planner takes all ground for flat.
    pub uneven_ground: Option<UnevenGround>,
    /// Name of the link, for the report.
    pub link: String,
    /// Faults put on the link, for the report.
    pub fault: Option<String>,
    /// Seed of all noise.
    pub seed: u64,
    /// Index of the start in the world.
    pub start: usize,
    /// A start pose to use instead of the world's.
    pub place: Option<Start>,
    /// The errors of the odometry.
    pub odometry: OdometryProfile,
    /// True if the device corrects odometry by the level scan. Baselines do not.
    pub localise: bool,
    /// Standard deviation of roll and pitch, radians. If `None`, 0 with true odometry and that of
    /// [`OdometryNoise`] with noisy odometry.
    pub imu_rad: Option<f64>,
    /// Standard deviation of ranges, metres; that of each lidar if `None`.
    pub laser_m: Option<f64>,
    /// Faults of wheels and lasers.
    pub disturbances: Disturbances,
    /// Wiring mistakes of the robot.
    pub miswiring: Miswiring,
    /// Number of people who walk about.
    pub people: usize,
    /// Name of the robot, for the report.
    pub robot: String,
    /// Limits of the robot's drive.
    pub drive: DriveLimits,
    /// The robot's lidars, one or two, the first one level.
    pub lidars: Vec<Lidar>,
    /// Errors of odometry that is [`OdometryProfile::Noisy`].
    pub wheels: OdometryNoise,
    /// The robot's hull.
    pub hull: Footprint,
    /// Radius around the robot's centre that the planner keeps clear, metres.
    pub radius_m: f64,
    /// Order in which frontiers are taken; the strategy's own if `None`.
    pub order: Option<Order>,
    /// Limits of loops; for strategy ouroboros.
    pub loops: LoopLimits,
    /// Limits within which the ground counts as reachable and traversable.
    pub working: Limits,
    /// Limits beyond which the robot is lost.
    pub failing: Limits,
    /// Simulated time limit, milliseconds.
    pub time_limit_ms: u32,
    /// Duration of the patrol after everything is explored, seconds; for strategy tdbvp.
    pub patrol_s: u16,
    /// Time without a new place after which the robot follows a path to what is left to explore,
    /// seconds; `None` for never; for strategy tdbvp.
    pub impatience_s: Option<u16>,
    /// Area and end of the exploration; for strategies sbpf and esbpf.
    pub space: SpaceMission,
    /// How the stored potential is relaxed; for the report of [`BVP_PAPERS`].
    pub relaxation: Relaxation,
    /// Time from one observation to the next, milliseconds.
    pub period_ms: u32,
    /// Bounds and no-go polygons; for strategies on the device.
    pub fence: Fence,
    /// What the device knows before its first step; for strategies on the device, on flat ground.
    pub known: Option<KnownMap>,
    /// What the robot does after its exploration; for strategies on the device.
    pub orders: Orders,
    /// Compare every heading with that of the converged window.
    pub check_field: bool,
    /// Number of pictures during the run.
    pub snapshots: usize,
    /// A device that was reset gets its map back, and the run goes on.
    pub resumes: bool,
    /// Where loops are closed.
    pub slam: SlamPlace,
    /// A particle filter beside the run, on flat ground.
    pub particles: Option<ParticleSpec>,
}

impl Default for Mission {
    fn default() -> Self {
        Self {
            strategy: "frontier".into(),
            uneven_ground: None,
            link: "direct".into(),
            fault: None,
            seed: 0,
            start: 0,
            place: None,
            odometry: OdometryProfile::Truth,
            localise: false,
            imu_rad: None,
            laser_m: None,
            disturbances: Disturbances::default(),
            miswiring: Miswiring::default(),
            people: 0,
            robot: DEFAULT.into(),
            drive: DriveLimits::default(),
            lidars: usual_lidars(),
            wheels: OdometryNoise::default(),
            hull: Footprint::PIONEER_3AT,
            radius_m: RADIUS_M,
            order: None,
            loops: LoopLimits::default(),
            working: Limits::WORKING,
            failing: Limits::FAILING,
            time_limit_ms: 3_600_000,
            patrol_s: 0,
            impatience_s: IMPATIENCE_S,
            space: SpaceMission::default(),
            relaxation: Relaxation::DEFAULT,
            period_ms: SimConfig::default().period_ms,
            fence: Fence::default(),
            known: None,
            orders: Orders::default(),
            check_field: false,
            snapshots: 0,
            resumes: false,
            slam: SlamPlace::Off,
            particles: None,
        }
    }
}

impl Mission {
    /// Returns the mission of another robot.
    #[must_use]
    pub fn with_robot(self, robot: &RobotSpec) -> Self {
        Self {
            robot: robot.name.clone(),
            drive: robot.drive,
            lidars: robot.lidars.clone(),
            wheels: robot.odometry,
            hull: robot.hull,
            radius_m: robot.radius_m,
            ..self
        }
    }

    /// Returns the errors of the odometry; `None` for the truth.
    fn odometry_noise(&self) -> Option<OdometryNoise> {
        match self.odometry {
            OdometryProfile::Noisy => Some(self.wheels),
            other => other.noise(),
        }
    }

    /// Returns what a pose graph expects of the wheels.
    #[must_use]
    pub fn motion(&self) -> fieldline_slam::Motion {
        let usual = OdometryNoise::default();
        let noise = self.odometry_noise().unwrap_or(usual);
        let factor = noise.turn_by_turn / usual.turn_by_turn;
        fieldline_slam::Motion::WHEELS.times(factor.max(1.0) as f32)
    }

    /// Returns the strategy that the device is told.
    pub(super) fn strategy(&self) -> Strategy {
        match on_device(&self.strategy).unwrap_or_default() {
            Strategy::Tdbvp { .. } => Strategy::Tdbvp {
                patrol_s: self.patrol_s,
                impatience_s: self.impatience_s,
            },
            other => other,
        }
    }

    /// Returns the order of frontiers that the device is told.
    pub(super) fn order(&self) -> Order {
        self.order.unwrap_or_else(|| self.strategy().order())
    }

    /// Returns the strategy that the device is told in a world.
    pub(super) fn strategy_in(&self, world: &World) -> Strategy {
        match self.strategy() {
            Strategy::Sbpf(_) => Strategy::Sbpf(self.space.message(world, None)),
            Strategy::Esbpf(_) => Strategy::Esbpf(self.space.message(world, ESBPF_IMPATIENCE_S)),
            other => other,
        }
    }

    /// Returns the preferences of the field; `None` on flat ground.
    pub(super) fn preference(&self) -> Option<Preference> {
        self.uneven_ground.map(|ground| ground.preference)
    }

    /// Returns true if the device corrects odometry.
    pub(super) fn localises(&self) -> bool {
        self.localise && on_device(&self.strategy).is_some()
    }

    /// Returns true if goals have height levels; `None` on flat ground, and for a baseline.
    pub(super) fn levels(&self) -> Option<bool> {
        let ground = self.uneven_ground?;
        on_device(&self.strategy).map(|_| ground.levels)
    }

    /// Returns the simulator's configuration.
    #[must_use]
    pub fn sim_config(&self) -> SimConfig {
        let mut lidars = self.lidars.clone();
        for lidar in &mut lidars {
            lidar.noise.sigma_m = self.laser_m.unwrap_or(lidar.noise.sigma_m);
        }
        SimConfig {
            seed: self.seed,
            start: self.start,
            place: self.place,
            period_ms: self.period_ms,
            odometry: match (self.odometry_noise(), self.imu_rad) {
                (Some(usual), imu_rad) => OdometryModel::Noisy(OdometryNoise {
                    attitude_rad: imu_rad.unwrap_or(usual.attitude_rad),
                    ..usual
                }),
                (None, Some(imu_rad)) => OdometryModel::Tilting(imu_rad),
                (None, None) => OdometryModel::Truth,
            },
            lidars,
            limits: self.drive,
            disturbances: self.disturbances,
            miswiring: self.miswiring,
            people: self.people,
            footprint: self.hull,
            radius_m: self.radius_m,
            working: self.working,
            failing: self.failing,
            fence: self.fence.clone(),
            ..SimConfig::default()
        }
    }
}

//! One run in the simulator, from a world and a link to a report.
//!
//! ```text
//! hello → map box → Simulator, Account → run → Report
//! ```

use thiserror::Error;

use fieldline_protocol::message::{
    self as wire, LoopLimits, Order, Preference, SpaceField, Strategy, UnevenGround,
};
use fixed::types::I16F16;

use super::account::Account;
use super::itinerary::Orders;
use super::space::SpaceMission;
use super::{Cast, Corrector, Ending, Record, Setup, Watch, run, summary};
use crate::baseline::bvp_papers::Relaxation;
use crate::fence::Fence;
use crate::link::{Link, LinkError};
use crate::report::Report;
use crate::report::tum::Stamped;
use crate::robot::presets::DEFAULT;
use crate::robot::{
    Disturbances, DriveLimits, Footprint, Lidar, Limits, Miswiring, OdometryModel, OdometryNoise,
    RADIUS_M, RobotSpec, usual_lidars,
};
use crate::sim::{SimConfig, Simulator};
use crate::slam::particles::{Beside, ParticleSpec};
use crate::slam::{LoopCloser, SlamPlace};
use crate::state::{Keeping, Recorder, StateKeeper};
use crate::world::{Start, World, WorldError};

/// The usual impatience of strategy tdbvp, seconds (measured: docs/MEASURED.md, "Impatience of
/// tdbvp").
pub const IMPATIENCE_S: Option<u16> = Some(15);

/// The baseline that stores its potential from step to step.
pub const BVP_PAPERS: &str = "bvp-papers";

/// The usual impatience of strategy esbpf, seconds. Strategy sbpf has none.
const ESBPF_IMPATIENCE_S: Option<u16> = Some(5);

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
            orders: Orders::default(),
            check_field: false,
            snapshots: 0,
            resumes: false,
            slam: SlamPlace::Off,
            particles: None,
        }
    }
}

/// Errors of the odometry, by name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OdometryProfile {
    /// The true pose.
    #[default]
    Truth,
    /// [`OdometryNoise::default`].
    Noisy,
    /// [`OdometryNoise::papers`].
    Papers,
    /// [`OdometryNoise::mobilesim`].
    MobileSim,
}

impl OdometryProfile {
    /// Returns the name on the command line and in the report.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Truth => "truth",
            Self::Noisy => "noisy",
            Self::Papers => "papers",
            Self::MobileSim => "mobilesim",
        }
    }

    /// Returns the noise; `None` for the truth.
    #[must_use]
    pub fn noise(self) -> Option<OdometryNoise> {
        match self {
            Self::Truth => None,
            Self::Noisy => Some(OdometryNoise::default()),
            Self::Papers => Some(OdometryNoise::papers()),
            Self::MobileSim => Some(OdometryNoise::mobilesim()),
        }
    }
}

/// Reason why a run could not begin.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum MissionError {
    /// The world or the start in it is bad.
    #[error(transparent)]
    World(#[from] WorldError),
    /// The device did not answer the hello.
    #[error(transparent)]
    Link(#[from] LinkError),
}

/// Strategies on the device, by name.
pub const STRATEGIES: [(&str, Strategy); 5] = [
    ("frontier", Strategy::Frontier),
    ("ouroboros", Strategy::Ouroboros),
    (
        "tdbvp",
        Strategy::Tdbvp {
            patrol_s: 0,
            impatience_s: IMPATIENCE_S,
        },
    ),
    ("sbpf", Strategy::Sbpf(NO_FIELD)),
    ("esbpf", Strategy::Esbpf(NO_FIELD)),
];

/// A field without an area, for the list of strategies. A mission has the area of its world.
const NO_FIELD: SpaceField = SpaceField {
    origin: (I16F16::ZERO, I16F16::ZERO),
    size: (I16F16::ZERO, I16F16::ZERO),
    until_permille: 0,
    impatience_s: None,
};

/// Returns the strategy on the device of this name; a baseline has none.
#[must_use]
pub fn on_device(name: &str) -> Option<Strategy> {
    let mut known = STRATEGIES.iter();
    known
        .find(|(known, _)| *known == name)
        .map(|(_, strategy)| *strategy)
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

/// Checks that the robot can and may stand at the mission's start. Costs little, so it comes first.
///
/// # Errors
/// As [`WorldError::Start`].
pub fn check(mission: &Mission, world: &World) -> Result<(), WorldError> {
    let simulator = Simulator::new(world, mission.sim_config())?;
    let pose = simulator.pose();
    let may_stand = mission.fence.check_start(&mission.hull, pose);
    may_stand.map_err(|reason| WorldError::Start {
        file: world.name().into(),
        index: mission.start,
        reason,
    })
}

/// Returns the settings of a run.
pub(super) fn setup(mission: &Mission, simulator: &Simulator<'_>) -> Setup {
    Setup {
        start: wire::Start {
            uneven_ground: mission.uneven_ground,
            order: mission.order(),
            loops: mission.loops,
            localise: mission.localises(),
            fence: mission.fence.message(),
            budget: mission.orders.budget,
            ..simulator.start_message(mission.strategy_in(simulator.world()))
        },
        time_limit_ms: mission.time_limit_ms,
        check_field: mission.check_field,
        snapshots: mission.snapshots,
        resumes: mission.resumes,
        orders: mission.orders.clone(),
        corrects: false,
    }
}

/// Explores `world` over `link`.
///
/// # Errors
/// As [`MissionError`], before the robot moves. Later failures are in the report.
pub fn explore(
    mission: &Mission,
    world: &World,
    link: &mut dyn Link,
    watch: &mut dyn Watch,
) -> Result<(Report, Record), MissionError> {
    explored(mission, world, link, watch, (None, None))
}

/// As [`explore`], and keeps the state of the run, or goes on from one.
///
/// # Errors
/// As [`explore`]; [`LinkError::Io`] if the state is that of another run. Nothing is kept then.
pub fn explore_kept(
    mission: &Mission,
    world: &World,
    link: &mut dyn Link,
    watch: &mut dyn Watch,
    keeping: &mut Keeping,
) -> Result<(Report, Record), MissionError> {
    explored(mission, world, link, watch, (None, Some(keeping)))
}

/// As [`explore`], with a corrector of the map.
///
/// # Errors
/// As [`explore`].
pub fn explore_corrected(
    mission: &Mission,
    world: &World,
    link: &mut dyn Link,
    watch: &mut dyn Watch,
    corrector: &mut dyn Corrector,
) -> Result<(Report, Record), MissionError> {
    explored(mission, world, link, watch, (Some(corrector), None))
}

fn explored(
    mission: &Mission,
    world: &World,
    link: &mut dyn Link,
    watch: &mut dyn Watch,
    (corrector, keeping): (Option<&mut dyn Corrector>, Option<&mut Keeping>),
) -> Result<(Report, Record), MissionError> {
    let mut simulator = Simulator::new(world, mission.sim_config())?;
    link.hello()?;
    let usual = setup(mission, &simulator);
    let mut closer = match mission.slam {
        SlamPlace::Host => LoopCloser::new(&usual.start, mission.motion()),
        SlamPlace::Off => None,
    };
    let corrector = match (corrector, &mut closer) {
        (Some(corrector), _) => Some(corrector),
        (None, closer) => closer.as_mut().map(|closer| closer as &mut dyn Corrector),
    };
    let setup = Setup {
        corrects: corrector.is_some(),
        ..usual
    };
    let mut account = Account::new(&setup, &simulator);
    account.particles = beside(mission, &setup, &simulator);
    let mut nothing = ();
    let mut cast = Cast {
        link,
        body: &mut simulator,
        survey: &mut account,
        watch,
        corrector: corrector.unwrap_or(&mut nothing),
        keeper: &mut (),
    };
    let mut record = match keeping {
        Some(keeping) => run_kept(&setup, &mut cast, keeping)?,
        None => run(&setup, &mut cast),
    };
    record.ground = account.ground.take();
    let mut report = summary::report(mission, &simulator, &account, &record);
    if let Some(closer) = closer {
        record.corrected = corrected_path(&closer, &record);
        report.slam = Some(closer.report());
    }
    Ok((report, record))
}

/// As [`run`], and keeps the run.
fn run_kept(
    setup: &Setup,
    cast: &mut Cast<'_>,
    keeping: &mut Keeping,
) -> Result<Record, MissionError> {
    let resumed = keeping.resumed.as_ref().map(|state| state.steps as usize);
    let (mut keeper, journal) = StateKeeper::new(keeping, setup.start.clone());
    let mut link = Recorder::new(&mut *cast.link, journal);
    let mut record = run(
        setup,
        &mut Cast {
            link: &mut link,
            body: &mut *cast.body,
            survey: &mut *cast.survey,
            watch: &mut *cast.watch,
            corrector: &mut *cast.corrector,
            keeper: &mut keeper,
        },
    );
    let is_short = resumed.is_some_and(|steps| record.steps.len() < steps);
    if is_short && record.ending == Ending::Interrupted {
        return Err(MissionError::Link(LinkError::Io(
            "interrupted before the run was where its state is; nothing has changed".into(),
        )));
    }
    if keeper.strays || is_short {
        return Err(MissionError::Link(LinkError::Io(
            "the state was kept in another world, or by another build of this program; resume it \
             with those, or leave --resume out to make the run again"
                .into(),
        )));
    }
    record.replayed = resumed.unwrap_or(0);
    Ok(record)
}

/// Returns the particle filter beside a run; `None` if there is to be none, or the robot has no
/// laser.
fn beside(mission: &Mission, setup: &Setup, simulator: &Simulator<'_>) -> Option<Beside> {
    let (spec, laser) = (mission.particles?, setup.start.lasers.first()?);
    let [x0, y0] = simulator.world().occupancy().origin_m();
    let [width, height] = simulator.world().size_m();
    let world = (*simulator.pose(), [x0, y0, x0 + width, y0 + height]);
    let noise = mission.odometry_noise();
    Some(Beside::new(spec, laser, world, noise, mission.seed))
}

/// Returns the path of the last corrected poses, with the times of the steps.
fn corrected_path(closer: &LoopCloser, record: &Record) -> Vec<Stamped> {
    let steps = record.steps.iter().zip(closer.poses());
    let stamped = steps.map(|(step, [x_m, y_m, yaw_rad])| Stamped {
        x_m,
        y_m,
        yaw_rad,
        ..step.estimate
    });
    stamped.collect()
}

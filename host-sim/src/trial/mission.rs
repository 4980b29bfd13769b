//! One run in the simulator, from a world and a link to a report.
//!
//! ```text
//! hello → box → Simulator, Mirror, Coverage → run → Report
//! ```

use core::fmt;

use fieldline_planner::geometry::Cell;
use fieldline_protocol::message::{
    self as wire, Finish, Observation, Status, Strategy, Twist, UnevenGround,
};

use super::mirror::Mirror;
use super::relief::Relief;
use super::snapshot::Window;
use super::uneven::TABLE_I;
use super::{Body, Cast, Ending, Record, Setup, Survey, Watch, record, run, shape};
use crate::link::{Link, LinkError};
use crate::metrics::patrol::{Patrol, without_spurs};
use crate::metrics::{CellSet, Coverage, Footing, GroundTruth, Loops};
use crate::report::tum::Stamped;
use crate::report::{self, Report, SCHEMA_VERSION};
use crate::robot::{LaserNoise, Limits, OdometryModel, OdometryNoise, RADIUS_M, laser};
use crate::sim::{Loss, SimConfig, Simulator};
use crate::world::{Start, World, WorldError};

/// What a run is asked to be.
#[derive(Clone, Debug, PartialEq)]
pub struct Mission {
    /// Name of the strategy, for the report.
    pub strategy: String,
    /// Parameters of uneven ground; if `None`, [`super::uneven::TABLE_I`] for [`TERRAIN`], and for others the ground counts as flat.
    pub terrain: Option<UnevenGround>,
    /// Name of the link, for the report.
    pub link: String,
    /// The faults put on the link, for the report.
    pub fault: Option<String>,
    /// Decides all noise.
    pub seed: u64,
    /// Which of the world's starts.
    pub start: usize,
    /// Whether odometry errs.
    pub noisy_odometry: bool,
    /// Standard deviation of roll and pitch, radians; if `None` none with true odometry, that of [`OdometryNoise`] with noisy.
    pub imu_rad: Option<f64>,
    /// Standard deviation of ranges, metres; that of [`LaserNoise`] if `None`.
    pub laser_m: Option<f64>,
    /// The ground that counts as reachable and traversable.
    pub working: Limits,
    /// The ground that the robot does not survive.
    pub failing: Limits,
    /// Simulated time limit, milliseconds.
    pub time_limit_ms: u32,
    /// How long to patrol once all is explored, seconds; for strategy tdbvp.
    pub patrol_s: u16,
    /// The map's box in tiles; chosen for the world if `None`.
    pub box_tiles: Option<(u8, u8)>,
    /// Time from one observation to the next, milliseconds.
    pub period_ms: u32,
    /// Compare every heading with that of the converged window.
    pub check_field: bool,
    /// How many moments of the run to keep for pictures.
    pub snapshots: usize,
}

impl Default for Mission {
    fn default() -> Self {
        Self {
            strategy: "frontier".into(),
            terrain: None,
            link: "direct".into(),
            fault: None,
            seed: 0,
            start: 0,
            noisy_odometry: false,
            imu_rad: None,
            laser_m: None,
            working: Limits::WORKING,
            failing: Limits::FAILING,
            time_limit_ms: 3_600_000,
            patrol_s: 0,
            box_tiles: None,
            period_ms: SimConfig::default().period_ms,
            check_field: false,
            snapshots: 0,
        }
    }
}

/// Why a run could not begin.
#[derive(Clone, Debug, PartialEq)]
pub enum MissionError {
    /// The world, or the start in it.
    World(WorldError),
    /// The device did not greet.
    Link(LinkError),
    /// The box has more tiles than the device has slots.
    Box {
        /// Tiles across.
        across: u8,
        /// Tiles up.
        up: u8,
        /// The device's slots.
        slots: u16,
    },
}

impl fmt::Display for MissionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::World(error) => error.fmt(f),
            Self::Link(error) => error.fmt(f),
            Self::Box { across, up, slots } => write!(
                f,
                "a map of {across} x {up} tiles of {} m does not fit the device's {slots}; choose a smaller --map-shape",
                shape::TILE_M
            ),
        }
    }
}

impl core::error::Error for MissionError {}

impl From<WorldError> for MissionError {
    fn from(error: WorldError) -> Self {
        Self::World(error)
    }
}

impl From<LinkError> for MissionError {
    fn from(error: LinkError) -> Self {
        Self::Link(error)
    }
}

/// Frontiers on uneven ground: its name.
pub const TERRAIN: &str = "terrain";

/// The strategies on the device, by name.
pub const STRATEGIES: [(&str, Strategy); 4] = [
    ("frontier", Strategy::Frontier),
    ("ouroboros", Strategy::Ouroboros),
    ("tdbvp", Strategy::Tdbvp { patrol_s: 0 }),
    (TERRAIN, Strategy::Frontier),
];

/// The strategy on the device of this name; a baseline has none.
#[must_use]
pub fn on_device(name: &str) -> Option<Strategy> {
    let mut known = STRATEGIES.iter();
    known
        .find(|(known, _)| *known == name)
        .map(|(_, strategy)| *strategy)
}

impl Mission {
    /// What plans on the device.
    fn strategy(&self) -> Strategy {
        match on_device(&self.strategy).unwrap_or_default() {
            Strategy::Tdbvp { .. } => Strategy::Tdbvp {
                patrol_s: self.patrol_s,
            },
            other => other,
        }
    }

    /// How the device goes about uneven ground, if it is told to.
    fn terrain(&self) -> Option<UnevenGround> {
        let usual = (self.strategy == TERRAIN).then_some(TABLE_I);
        self.terrain.or(usual)
    }
}

/// Whether the robot can stand where the mission starts, before anything else is spent on it.
///
/// # Errors
/// As [`WorldError::Start`].
pub fn check(mission: &Mission, world: &World) -> Result<(), WorldError> {
    Simulator::new(world, sim_config(mission)).map(|_| ())
}

/// Explore `world` over `link`.
///
/// # Errors
/// As [`MissionError`], before the robot moves; whatever happens later is in the report.
pub fn explore(
    mission: &Mission,
    world: &World,
    link: &mut dyn Link,
    watch: &mut dyn Watch,
) -> Result<(Report, Record), MissionError> {
    let mut simulator = Simulator::new(world, sim_config(mission))?;
    let slots = link.hello()?.tile_slots;
    let (across, up) = mission
        .box_tiles
        .unwrap_or_else(|| shape::for_world(world.size_m(), slots));
    if u32::from(across) * u32::from(up) > u32::from(slots) {
        return Err(MissionError::Box { across, up, slots });
    }
    let setup = Setup {
        start: wire::Start {
            uneven_ground: mission.terrain(),
            ..simulator.start_message(mission.strategy(), (across, up))
        },
        time_limit_ms: mission.time_limit_ms,
        check_field: mission.check_field,
        snapshots: mission.snapshots,
    };
    let start = world.starts().get(mission.start).copied();
    let start = start.unwrap_or_default();
    let mut account = Account::new(&setup, world, start, &mission.working);
    let mut record = run(
        &setup,
        &mut Cast {
            link,
            body: &mut simulator,
            survey: &mut account,
            watch,
        },
    );
    record.ground = account.ground.take();
    let report = assemble(mission, &simulator, &account, &record);
    Ok((report, record))
}

fn sim_config(mission: &Mission) -> SimConfig {
    let lasers = LaserNoise::default();
    SimConfig {
        seed: mission.seed,
        start: mission.start,
        period_ms: mission.period_ms,
        odometry: match (mission.noisy_odometry, mission.imu_rad) {
            (true, imu_rad) => {
                let usual = OdometryNoise::default();
                OdometryModel::Noisy(OdometryNoise {
                    attitude_rad: imu_rad.unwrap_or(usual.attitude_rad),
                    ..usual
                })
            }
            (false, Some(imu_rad)) => OdometryModel::Tilting(imu_rad),
            (false, None) => OdometryModel::Truth,
        },
        laser_noise: LaserNoise {
            sigma_m: mission.laser_m.unwrap_or(lasers.sigma_m),
            ..lasers
        },
        working: mission.working,
        failing: mission.failing,
        ..SimConfig::default()
    }
}

/// Coverage by the mirror of the device's map.
#[derive(Debug)]
struct Account {
    mirror: Mirror,
    coverage: Coverage,
    /// What the ground is to the robot where it is uneven.
    ground: Option<GroundTruth>,
}

impl Account {
    fn new(setup: &Setup, world: &World, start: Start, working: &Limits) -> Self {
        let range_m = f64::from(laser::level().range_limit_mm) / 1000.0;
        let uneven = world.elevation();
        let footing = uneven.map(|_| Footing::new(world, start, RADIUS_M, working));
        Self {
            mirror: Mirror::new(&setup.start),
            coverage: match &footing {
                Some(footing) => Coverage::on(footing),
                None => Coverage::new(world, start, RADIUS_M, range_m),
            },
            ground: footing.map(|footing| GroundTruth::new(world, &footing, working)),
        }
    }
}

impl Survey for Account {
    fn note(&mut self, observation: &Observation, status: Status) -> f64 {
        self.mirror.observe(observation, status);
        let time_s = f64::from(observation.time_ms) / 1000.0;
        let mirror = &self.mirror;
        self.coverage
            .update(time_s, |cell: Cell| mirror.is_known(cell))
    }

    fn relief(&self, window: &Window) -> Option<Relief> {
        self.mirror.relief(window)
    }
}

impl Body for Simulator<'_> {
    fn period_ms(&self) -> u32 {
        self.config().period_ms
    }

    fn observe(&mut self) -> Observation {
        Simulator::observe(self)
    }

    fn drive(&mut self, velocity: Option<Twist>) {
        Simulator::drive(self, velocity);
    }

    fn truth(&self) -> Stamped {
        record::stamped(self.time_ms(), &self.above_start(self.pose()).to_wire())
    }

    fn loss(&self) -> Option<Loss> {
        Simulator::loss(self)
    }
}

fn assemble(
    mission: &Mission,
    simulator: &Simulator<'_>,
    account: &Account,
    record: &Record,
) -> Report {
    let progress = record.progress();
    Report {
        schema_version: SCHEMA_VERSION,
        world: simulator.world().name().into(),
        strategy: mission.strategy.clone(),
        link: mission.link.clone(),
        seed: mission.seed,
        odometry: if mission.noisy_odometry {
            "noisy".into()
        } else {
            "truth".into()
        },
        start: mission.start,
        fault: mission.fault.clone(),
        noise: noise(simulator.config()),
        notes: simulator.world().notes().to_vec(),
        outcome: record.outcome(),
        sim_time_s: f64::from(progress.time_ms) / 1000.0,
        path_length_m: simulator.path_length_m(),
        climb_m: record.climb_m,
        steps: record.steps.len() as u64,
        coverage: coverage(account, simulator),
        loops: loops(simulator, record),
        closures: (mission.strategy() == Strategy::Ouroboros).then(|| record.closures()),
        patrol: patrol(mission, record),
        safety: safety(simulator),
        terrain: terrain(simulator, record),
        localization: record.localization(),
        planner: record.planner(),
        field: record.field(),
        link_stats: record.link_stats,
        digest: record.digest.to_string(),
        debug: report::Debug {
            map_matches_mirror: (!record.tiles.is_empty())
                .then(|| account.mirror.equals(&record.tiles)),
            checked_windows: record.heading_errors_deg.len() as u64,
        },
    }
}

fn coverage(account: &Account, simulator: &Simulator<'_>) -> report::Coverage {
    let coverage = &account.coverage;
    report::Coverage {
        fraction: coverage.fraction(),
        known_m2: round(coverage.known_m2()),
        reachable_m2: round(coverage.reachable_m2()),
        t90_s: coverage.t90_s(),
        t99_s: coverage.t99_s(),
        overlap: Some(simulator.overlap()),
    }
}

fn loops(simulator: &Simulator<'_>, record: &Record) -> report::Loops {
    let world = simulator.world();
    let start = world.starts().get(simulator.config().start).copied();
    let reach = CellSet::reach(world, start.unwrap_or_default(), RADIUS_M);
    let truth = record.steps.iter().map(|step| step.truth);
    let path: Vec<[f64; 2]> = truth.map(|truth| [truth.x_m, truth.y_m]).collect();
    let loops = Loops::judge(world, &reach, &path);
    report::Loops {
        loops_closed: loops.closed,
        loops: loops.of,
    }
}

/// Ages of the rails since all was explored; `None` where the run ended otherwise than by the end of its patrol.
fn patrol(mission: &Mission, record: &Record) -> Option<report::Patrol> {
    let explored = record.ending == Ending::Finished(Finish::Explored);
    if mission.patrol_s == 0 || !explored {
        return None;
    }
    let path = record.steps.iter().map(|step| {
        let truth = step.truth;
        [f64::from(truth.time_ms) / 1000.0, truth.x_m, truth.y_m]
    });
    let path: Vec<[f64; 3]> = path.collect();
    let rails: Vec<[f64; 2]> = record.map.rails().collect();
    let rails = without_spurs(&rails);
    let ages = Patrol::judge(&rails, &path, f64::from(mission.patrol_s))?;
    Some(report::Patrol {
        oldest_rail_s: ages.oldest_rail_s,
        mean_age_s: ages.mean_age_s,
    })
}

fn safety(simulator: &Simulator<'_>) -> report::Safety {
    let safety = simulator.safety();
    report::Safety {
        collisions: safety.collisions,
        falls: safety.falls,
        tips: safety.tips,
        min_clearance_m: Some(safety.min_clearance_m).filter(|m| m.is_finite()),
    }
}

fn noise(config: &SimConfig) -> report::Noise {
    let imu_rad = match config.odometry {
        OdometryModel::Truth => 0.0,
        OdometryModel::Tilting(sigma_rad) => sigma_rad,
        OdometryModel::Noisy(noise) => noise.attitude_rad,
    };
    report::Noise {
        laser_m: config.laser_noise.sigma_m,
        // To a millionth, so that 1° reads as 1.
        imu_deg: (imu_rad.to_degrees() * 1e6).round() / 1e6,
    }
}

fn terrain(simulator: &Simulator<'_>, record: &Record) -> Option<report::Terrain> {
    let (ground, config) = (record.ground.as_ref()?, simulator.config());
    // A map in a frame that drifts cannot be compared cell by cell.
    let still = !matches!(config.odometry, OdometryModel::Noisy(_));
    let comparable = still && !record.tiles.is_empty();
    let classes = comparable.then(|| {
        let table = ground.compare(|cell| record.map.get(cell.x, cell.y));
        report::terrain::Classes::from(&table)
    });
    let terrain = report::Terrain {
        start_z_m: simulator.start_z_m(),
        working: (&config.working).into(),
        failing: (&config.failing).into(),
        classes,
        ..report::Terrain::default()
    };
    Some(terrain.with_ride(&simulator.ride()))
}

/// Areas are whole cells of 0.01 m²; the product's last bits are noise.
fn round(area_m2: f64) -> f64 {
    (area_m2 * 100.0).round() / 100.0
}

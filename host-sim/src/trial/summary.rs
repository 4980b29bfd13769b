//! The report of a run, put together from its mission, simulator, account and record.

use fieldline_protocol::message::{Finish, Order, Strategy};

use super::account::Account;
use super::mission::{BVP_PAPERS, Mission, on_device};
use super::{Ending, Record, wording};
use crate::fence::Polygon;
use crate::metrics::patrol::{Patrol, without_spurs};
use crate::metrics::{CellSet, Loops, map_error, walls_share};
use crate::report::mission_log::{self, Entry};
use crate::report::true_ground::{ClassScores, TrueGround, degrees};
use crate::report::{self, Report, SCHEMA_VERSION};
use crate::robot::OdometryModel;
use crate::robot::presets::DEFAULT;
use crate::sim::{SimConfig, Simulator};
use crate::slam::particles::ParticleReport;
use crate::world::{Start, World};

/// Returns the report.
pub(super) fn report(
    mission: &Mission,
    simulator: &Simulator<'_>,
    account: &Account,
    record: &Record,
) -> Report {
    let world = simulator.world();
    Report {
        schema_version: SCHEMA_VERSION,
        world: world.name().into(),
        strategy: mission.strategy.clone(),
        ground: ground(mission).into(),
        preference: preference(mission),
        levels: mission.levels(),
        tdbvp_impatience: impatience(mission),
        order: order(mission).map(|it| wording::order(it).into()),
        worth: order(mission).map(|it| it.worth().to_num()),
        space_field: space_field(mission, world),
        known: None,
        fence: fence(mission, simulator),
        trips: record.trips.clone(),
        live_requests: record.live_requests.clone(),
        relaxation: relaxation(mission),
        link: mission.link.clone(),
        made_by: None,
        seed: mission.seed,
        odometry: mission.odometry.name().into(),
        start: mission.start,
        injected_faults: mission.fault.clone(),
        robot_name: Some(mission.robot.clone()).filter(|name| name != DEFAULT),
        disturbances: disturbances(mission),
        miswiring: miswiring(mission),
        people: Some(mission.people).filter(|count| *count > 0),
        noise: noise(simulator.config()),
        world_notes: world.notes().to_vec(),
        outcome: record.outcome(),
        mission: mission_log(mission, record),
        sim_time_s: f64::from(record.progress().time_ms) / 1000.0,
        path_length_m: simulator.path_length_m(),
        path_overlap: Some(simulator.overlap()),
        height_change_m: record.height_change_m,
        steps: record.steps.len() as u64,
        coverage: coverage(account),
        loops: loops(simulator, record),
        loop_closing: closes_loops(mission).then(|| record.loop_closing()),
        patrol: patrol(mission, record),
        safety: safety(simulator),
        true_ground: true_ground(simulator, record),
        localization: record.localization(),
        map: map_errors(world, simulator.start(), account, record),
        planner: record.planner(),
        field: record.field(),
        link_stats: record.link_stats,
        input_faults: record.input_faults(),
        digest: record.digest.to_string(),
        debug: debug(mission, account, record),
        network: None,
        slam: None,
        particles: particles(account),
    }
}

/// Returns the last changes of what the robot did. A planner on the host tells none.
fn mission_log(mission: &Mission, record: &Record) -> Vec<Entry> {
    if on_device(&mission.strategy).is_none() {
        return Vec::new();
    }
    let steps = record.steps.iter();
    mission_log::last(mission_log::entries(
        steps.map(|step| (&step.estimate, &step.command)),
    ))
}

fn ground(mission: &Mission) -> &'static str {
    mission.uneven_ground.map_or("flat", |_| "uneven")
}

/// Returns the order of frontiers. A planner on the host has its own.
fn order(mission: &Mission) -> Option<Order> {
    on_device(&mission.strategy).map(|_| mission.order())
}

fn preference(mission: &Mission) -> Option<String> {
    let preference = mission.preference();
    preference.map(|it| wording::preference(it).into())
}

fn closes_loops(mission: &Mission) -> bool {
    mission.strategy() == Strategy::Ouroboros
}

fn debug(mission: &Mission, account: &Account, record: &Record) -> report::Debug {
    // The host's copy of the map has no door, which lets odometry begin anew.
    let is_mirrored = !record.tiles.is_empty() && mission.disturbances.restart_ms.is_none();
    report::Debug {
        map_matches_mirror: is_mirrored.then(|| account.mirror.equals(&record.tiles)),
    }
}

fn particles(account: &Account) -> Option<ParticleReport> {
    let particles = account.particles.as_ref();
    particles.map(|it| it.report(account.coverage.fraction()))
}

/// Returns the wiring mistakes, as on the command line; `None` without any.
fn miswiring(mission: &Mission) -> Option<String> {
    Some(mission.miswiring.to_string()).filter(|text| !text.is_empty())
}

/// Returns the disturbances, as on the command line; `None` without any.
fn disturbances(mission: &Mission) -> Option<String> {
    Some(mission.disturbances.to_string()).filter(|text| !text.is_empty())
}

/// Returns the errors of the map's walls. In an uneven world an obstacle may be a slope.
fn map_errors(
    world: &World,
    start: Start,
    account: &Account,
    record: &Record,
) -> Option<report::MapErrors> {
    if world.elevation().is_some() {
        return None;
    }
    if record.map.known() == 0 {
        return None;
    }
    let error = map_error(world, &record.map);
    Some(report::MapErrors {
        wall_error_m: error.map(|error| report::WallError {
            p50: error.wall_p50_m,
            p95: error.wall_p95_m,
        }),
        ghost_share: error.map_or(0.0, |error| error.ghost_share),
        walls_share: walls_share(world, start, &record.map),
        area_percent: account.area_percent(record.map.known()),
    })
}

/// Returns the impatience of strategy tdbvp, as on the command line.
fn impatience(mission: &Mission) -> Option<String> {
    match mission.strategy() {
        Strategy::Tdbvp { impatience_s, .. } => {
            Some(impatience_s.map_or("never".into(), |seconds| seconds.to_string()))
        }
        _ => None,
    }
}

/// Returns the fence and how far the robot went beyond it; `None` without one.
fn fence(mission: &Mission, simulator: &Simulator<'_>) -> Option<report::Fence> {
    let corners = |polygons: &[Polygon]| {
        let corners = polygons.iter().map(|polygon| polygon.corners().to_vec());
        corners.collect()
    };
    (!mission.fence.is_empty()).then(|| report::Fence {
        bounds_m: corners(&mission.fence.bounds),
        no_go_m: corners(&mission.fence.no_go),
        deepest_m: simulator.safety().deepest_forbidden_m,
    })
}

fn space_field(mission: &Mission, world: &World) -> Option<report::SpaceField> {
    let (Strategy::Sbpf(field) | Strategy::Esbpf(field)) = mission.strategy_in(world) else {
        return None;
    };
    let sides = [field.origin.0, field.origin.1, field.size.0, field.size.1];
    let impatience = field.impatience_s;
    Some(report::SpaceField {
        area_m: sides.map(|metres| (metres.to_num::<f64>() * 100.0).round() / 100.0),
        until: f64::from(field.until_permille) / 1000.0,
        impatience: impatience.map_or("never".into(), |seconds| seconds.to_string()),
    })
}

/// Returns how the stored potential is relaxed; `None` for other strategies.
fn relaxation(mission: &Mission) -> Option<report::Relaxation> {
    (mission.strategy == BVP_PAPERS).then(|| report::Relaxation {
        sweeps: mission.relaxation.sweeps,
        precision: mission.relaxation.precision.name().into(),
    })
}

fn coverage(account: &Account) -> report::Coverage {
    let coverage = &account.coverage;
    report::Coverage {
        fraction: coverage.fraction(),
        known_m2: whole_cells_m2(coverage.known_m2()),
        explorable_m2: whole_cells_m2(coverage.reachable_m2()),
        t90_s: coverage.t90_s(),
        t95_s: coverage.t95_s(),
        t99_s: coverage.t99_s(),
    }
}

fn loops(simulator: &Simulator<'_>, record: &Record) -> report::Loops {
    let world = simulator.world();
    let reach = CellSet::reach(world, simulator.start(), simulator.config().radius_m);
    let truth = record.steps.iter().map(|step| step.truth);
    let path: Vec<[f64; 2]> = truth.map(|truth| [truth.x_m, truth.y_m]).collect();
    let loops = Loops::judge(world, &reach, &path);
    report::Loops {
        islands: loops.of,
        circled: loops.closed,
    }
}

/// Returns ages of the rails on patrol; `None` unless the run ended with its patrol.
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
        max_rail_age_s: ages.oldest_rail_s,
        mean_rail_age_s: ages.mean_age_s,
    })
}

fn safety(simulator: &Simulator<'_>) -> report::Safety {
    let safety = simulator.safety();
    let has_people = simulator.config().people > 0;
    report::Safety {
        collisions: safety.collisions,
        falls: safety.falls,
        tips: safety.tips,
        min_clearance_m: Some(safety.min_clearance_m).filter(|m| m.is_finite()),
        robot_contacts: None,
        person_contacts: has_people.then_some(safety.person_contacts),
        min_person_gap_m: has_people.then_some(safety.min_person_gap_m),
    }
}

fn noise(config: &SimConfig) -> report::Noise {
    let imu_rad = match config.odometry {
        OdometryModel::Truth => 0.0,
        OdometryModel::Tilting(sigma_rad) => sigma_rad,
        OdometryModel::Noisy(noise) => noise.attitude_rad,
    };
    report::Noise {
        laser_m: config.lidars.first().map_or(0.0, |it| it.noise.sigma_m),
        imu_deg: degrees(imu_rad),
    }
}

fn true_ground(simulator: &Simulator<'_>, record: &Record) -> Option<TrueGround> {
    let (ground, config) = (record.ground.as_ref()?, simulator.config());
    // A map in a frame that drifts cannot be compared cell by cell.
    let still = !matches!(config.odometry, OdometryModel::Noisy(_));
    let comparable = still && !record.tiles.is_empty();
    let score = || ClassScores::from(&ground.compare(|cell| record.map.get(cell.x, cell.y)));
    let out = TrueGround {
        start_z_m: simulator.start_z_m(),
        working: (&config.working).into(),
        failing: (&config.failing).into(),
        map_score: comparable.then(score),
        ..TrueGround::default()
    };
    Some(out.with_ride(&simulator.ride()))
}

/// Rounds to whole cells of 0.01 m²; the last bits are rounding errors.
pub(super) fn whole_cells_m2(area_m2: f64) -> f64 {
    (area_m2 * 100.0).round() / 100.0
}

//! One run in the simulator, from a world and a link to a report.
//!
//! ```text
//! hello → map box → Simulator, Account → run → Report
//! ```

use fieldline_protocol::message as wire;
use thiserror::Error;

use super::Mission;
use crate::known_map::{KnownMap, Loaded};
use crate::link::{Link, LinkError};
use crate::report::tum::Stamped;
use crate::report::{Known, Report};
use crate::sim::Simulator;
use crate::slam::particles::Beside;
use crate::slam::{LoopCloser, SlamPlace};
use crate::state::{Keeping, Recorder, StateKeeper};
use crate::trial::account::Account;
use crate::trial::{Cast, Corrector, Ending, Record, Setup, Watch, run, summary};
use crate::world::{World, WorldError};

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
    })?;
    known(mission, &simulator).map(|_| ())
}

/// Returns what the device knows before its first step; `None` if that is nothing.
fn known(mission: &Mission, simulator: &Simulator<'_>) -> Result<Option<Loaded>, WorldError> {
    let loaded = |map: &KnownMap| map.load_for(&simulator.start().pose(), &mission.hull);
    mission.known.as_ref().map(loaded).transpose()
}

/// Returns the settings of a run.
pub(in crate::trial) fn setup(mission: &Mission, simulator: &Simulator<'_>) -> Setup {
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
        known: None,
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
    let identity = link.hello()?;
    let loaded = known(mission, &simulator)?;
    if let Some((map, loaded)) = mission.known.as_ref().zip(loaded.as_ref()) {
        map.check_room(loaded, identity.tile_pool)?;
    }
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
        known: loaded.as_ref().map(|it| it.correction.clone()),
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
    report.known = known_part(mission, loaded.as_ref());
    if let Some(closer) = closer {
        record.corrected = corrected_path(&closer, &record);
        report.slam = Some(closer.report());
    }
    Ok((report, record))
}

/// Returns what the device knew before its first step, for the report.
fn known_part(mission: &Mission, loaded: Option<&Loaded>) -> Option<Known> {
    let (map, loaded) = mission.known.as_ref().zip(loaded)?;
    Some(Known {
        file: map.file.clone(),
        tiles: loaded.correction.tiles.len(),
        known_m2: loaded.known_m2,
    })
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

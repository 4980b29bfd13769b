//! `host-sim explore`: explores worlds; writes folders and reports.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Result, bail};

use fieldline_protocol::message::{Budget, UnevenGround};
use host_sim::baseline::bvp_papers::Relaxation;
use host_sim::fence::{Fence, Polygon};
use host_sim::link::spec::LinkSpec;
use host_sim::live::Live;
use host_sim::report::{MadeBy, Report, folder};
use host_sim::robot::Limits;
use host_sim::slam::SlamPlace;
use host_sim::state::{self, State};
use host_sim::trial::Record;
use host_sim::trial::itinerary::Orders;
use host_sim::trial::mission::{self, IMPATIENCE_S, Mission, on_device};
use host_sim::trial::space::SpaceMission;
use host_sim::trial::surprises::surprises;
use host_sim::trial::uneven;
use host_sim::world::World;

use super::args::{ExploreArgs, GroundArg, LogArg, OdometryArg, SwitchArg, ThenArg};
use super::pictures::Album;
use super::prepared::Prepared;
use super::progress::{Interrupt, Onlooker};
use super::resume;
use super::strategies::{self, FRONTIER, TERRAIN};
use super::{live, made_by, note, say};

/// A run to make.
pub(super) struct Run {
    world: World,
    mission: Mission,
    pub(super) folder: PathBuf,
    pub(super) made_by: MadeBy,
    /// The state from which it goes on.
    pub(super) resumed: Option<State>,
}

/// Explores every world; returns true if every run ended explored.
pub(super) fn run(args: &ExploreArgs) -> Result<bool> {
    let prepared = Prepared::new(&without_alias(args)?)?;
    let runs = runs(&prepared)?;
    for run in &runs {
        folder::prepare(&run.folder)?;
        resume::clear(run)?;
    }
    let interrupt = Interrupt::listen()?;
    let pace = pace(&prepared.args);
    let live = prepared.args.live.map(|live| live::open(live, pace));
    let live = live.transpose()?;
    let mut all_explored = true;
    for run in &runs {
        all_explored &= explore(&prepared, run, &interrupt, live.as_ref())?;
        if interrupt.pressed() {
            break;
        }
    }
    if let Some(live) = &live {
        live::stay(live, &interrupt);
    }
    Ok(all_explored)
}

/// Returns the simulated seconds that one second may have at most.
fn pace(args: &ExploreArgs) -> Option<f64> {
    let team = args.team.as_ref().map(|team| team.pace);
    team.or(args.pace.realtime.then_some(1.0))
}

/// Replaces `--strategy terrain` by its meaning, and says so on standard error.
fn without_alias(args: &ExploreArgs) -> Result<ExploreArgs> {
    let mut args = args.clone();
    if args.strategy == TERRAIN {
        let meaning = format!("--strategy {TERRAIN} means --strategy {FRONTIER} --ground uneven");
        if args.ground == Some(GroundArg::Flat) {
            bail!("{meaning}; leave --ground flat out");
        }
        note(&format!("host-sim: {meaning}"));
        args.strategy = FRONTIER.into();
        args.ground = Some(GroundArg::Uneven);
    }
    Ok(args)
}

/// Opens every world and checks every folder, before the first run.
fn runs(prepared: &Prepared) -> Result<Vec<Run>> {
    let (args, mission) = (&prepared.args, &prepared.mission);
    let open = |text: &String| {
        let (name, start) = with_start(text);
        let world = World::open(name)?;
        let mission = Mission {
            start: start.unwrap_or(mission.start),
            ..mission.clone()
        };
        mission::check(&mission, &world)?;
        let mut own = vec![
            ("worlds", name.to_owned()),
            ("start", mission.start.to_string()),
        ];
        let text = prepared.mission_text.as_ref();
        own.extend(text.map(|text| ("mission-text", text.clone())));
        let made_by = made_by::of_run(&mission.robot, &own);
        Ok((world, mission, made_by))
    };
    let worlds: Vec<(World, Mission, MadeBy)> =
        args.worlds.iter().map(open).collect::<Result<_>>()?;
    let names = unique(worlds.iter().map(|(world, mission, _)| {
        let start = match mission.start {
            0 => String::new(),
            start => format!("@{start}"),
        };
        let ground = mission.uneven_ground.map_or("", |_| "-uneven");
        // The colons of a generated world's name: some file systems do not allow them.
        let world = world.name().replace(':', "-");
        let (strategy, seed) = (&args.strategy, args.common.seed);
        format!("{world}{start}-{strategy}{ground}-{seed}")
    }));
    let single = worlds.len() == 1;
    let from = resume::folder(args)?;
    worlds
        .into_iter()
        .zip(names)
        .map(|((world, mission, made_by), name)| {
            let resumed = from
                .map(|from| resume::state(from, args, &made_by))
                .transpose()?;
            let folder = match args.folder.out.as_deref().or(from) {
                Some(out) if single => out.to_owned(),
                Some(out) => out.join(name),
                None => Path::new("out").join(name),
            };
            let goes_on = from.is_some_and(|from| from == folder);
            if !goes_on {
                args.folder.check(&folder, &made_by)?;
            }
            Ok(Run {
                world,
                mission,
                folder,
                made_by,
                resumed,
            })
        })
        .collect()
}

/// Splits `WORLD@N` into a world and one of its starts, unless a file has that name.
pub(super) fn with_start(name: &str) -> (&str, Option<usize>) {
    let parts = name.rsplit_once('@').filter(|_| !Path::new(name).exists());
    match parts.and_then(|(world, start)| Some((world, start.parse().ok()?))) {
        Some((world, start)) => (world, Some(start)),
        None => (name, None),
    }
}

/// Makes names unique: the second of a name gets `-2`.
fn unique(names: impl Iterator<Item = String>) -> Vec<String> {
    let mut count: BTreeMap<String, u32> = BTreeMap::new();
    names
        .map(|name| {
            let times = count.entry(name.clone()).or_default();
            *times += 1;
            match *times {
                1 => name,
                times => format!("{name}-{times}"),
            }
        })
        .collect()
}

/// Makes one run, from hello to folder; returns true if it ended explored.
fn explore(
    prepared: &Prepared,
    run: &Run,
    interrupt: &Interrupt,
    live: Option<&Live>,
) -> Result<bool> {
    let args = &prepared.args;
    let name = run.world.name();
    for text in run.world.notes() {
        note(&format!("host-sim: {name}: {text}"));
    }
    for text in surprises(&run.mission, &run.world) {
        note(&format!("host-sim: {name}: {text}"));
    }
    let mut onlooker = Onlooker::new(name, pace(args), interrupt.clone());
    onlooker.log(args.log == Some(LogArg::Mission));
    onlooker.show(live.map(|live| live::observer(live, &run.mission, &run.world, interrupt)));
    if let Some(state) = &run.resumed {
        onlooker.begin_after(state.time_ms);
        note(&format!(
            "host-sim: {name}: goes on {}",
            resume::place(state)
        ));
    }
    let mut keeping = resume::keeping(args, run);
    let result = prepared.play_kept(&run.mission, &run.world, &mut onlooker, keeping.as_mut());
    onlooker.finish();
    live::end(onlooker.live(), &result);
    let (mut report, record) = result?;
    if let Some(error) = keeping.and_then(|it| it.failure) {
        let file = run.folder.join(state::NAME);
        note(&format!(
            "host-sim: {name}: {} could not be written: {error}; the run cannot be resumed from \
             its end",
            file.display()
        ));
    }
    report.made_by = Some(run.made_by.clone());
    let album = Album::new(&run.world, &report, &record);
    folder::write(&run.folder, &report, &record, &album.end())?;
    folder::write_snapshots(&run.folder, album.during())?;
    folder::write_corrections(&run.folder, album.corrections())?;
    print(args, &report, &record, &run.folder)?;
    Ok(report.explored())
}

/// Returns the parameters of uneven ground; `None` on flat ground.
fn uneven_ground(args: &ExploreArgs) -> Result<Option<UnevenGround>> {
    let implied =
        args.preference.is_some() || args.levels.is_some() || args.ground_parameters.is_some();
    let flat = match args.ground {
        Some(ground) => ground == GroundArg::Flat,
        None => !implied,
    };
    if flat && implied {
        bail!(
            "--ground flat has no preferences, levels and parameters; say --ground uneven, \
             or leave --preference, --levels and --ground-parameters out"
        );
    }
    if flat {
        return Ok(None);
    }
    if !strategies::knows_uneven_ground(&args.strategy) {
        bail!(
            "--strategy {} takes all ground for flat; \
             leave --ground, --preference, --levels and --ground-parameters out",
            args.strategy
        );
    }
    if args.levels.is_some() && on_device(&args.strategy).is_none() {
        bail!(
            "--strategy {} has no height levels; leave --levels out",
            args.strategy
        );
    }
    let parameters = args.ground_parameters.unwrap_or(uneven::TABLE_I);
    let preference = args.preference.map_or(parameters.preference, Into::into);
    Ok(Some(UnevenGround {
        preference,
        levels: args.levels.map_or_else(
            || uneven::has_levels(preference),
            |switch| switch == SwitchArg::On,
        ),
        ..parameters
    }))
}

/// Returns the odometry of a run whose user names none: it drifts where the device corrects it, and
/// is true where nothing does, or nothing aligns the maps of several robots.
fn default_odometry(args: &ExploreArgs, is_flat: bool) -> OdometryArg {
    if is_flat && on_device(&args.strategy).is_some() && args.team.is_none() {
        OdometryArg::Noisy
    } else {
        OdometryArg::Truth
    }
}

/// Refuses options that need a device, or level ground, where there is none.
fn check_device(args: &ExploreArgs, is_uneven: bool) -> Result<()> {
    if args.slam != SlamPlace::Off && on_device(&args.strategy).is_none() {
        bail!(
            "--slam corrects the map of a device; take a strategy on the device, or say --slam off"
        );
    }
    if args.localise == Some(SwitchArg::On) && on_device(&args.strategy).is_none() {
        bail!(
            "--localise corrects the pose on the device, and --strategy {} runs on the host; \
             take a strategy on the device, or leave --localise out",
            args.strategy
        );
    }
    if args.particles.is_some() && is_uneven {
        bail!("--particles takes level scans; leave it out, or say --ground flat");
    }
    if args.miswire.is_some() && on_device(&args.strategy).is_none() {
        bail!(
            "--miswire is noticed by a device, and --strategy {} runs on the host; take a strategy \
             on the device, or leave --miswire out",
            args.strategy
        );
    }
    Ok(())
}

/// Returns the settings of a run.
pub(super) fn mission(args: &ExploreArgs, link: &LinkSpec) -> Result<Mission> {
    let working = args.working_limits.unwrap_or(Limits::WORKING);
    let failing = args.failing_limits.unwrap_or(Limits::FAILING);
    if !working.is_within(&failing) {
        bail!(
            "--working-limits {working} exceed --failing-limits {failing}; \
             lower the first or raise the second"
        );
    }
    let uneven_ground = uneven_ground(args)?;
    if uneven_ground.is_some() {
        args.robot.check_uneven()?;
    }
    let odometry = args
        .odometry
        .unwrap_or_else(|| default_odometry(args, uneven_ground.is_none()));
    check_device(args, uneven_ground.is_some())?;
    let is_localised = match args.localise {
        Some(switch) => switch == SwitchArg::On,
        None => odometry != OdometryArg::Truth,
    };
    let disturbances = args.disturb.unwrap_or_default();
    if disturbances.needs_wheels() && odometry == OdometryArg::Truth {
        bail!(
            "--disturb {disturbances} needs odometry that counts wheels; say --odometry noisy, \
             or leave slip, spin and push out"
        );
    }
    Ok(args.robot.applied(Mission {
        disturbances,
        miswiring: args.miswire.unwrap_or_default(),
        people: args.people,
        order: args.robot.order(&args.strategy)?,
        strategy: args.strategy.clone(),
        uneven_ground,
        link: link.to_string(),
        fault: args.fault.as_ref().map(|fault| fault.text.clone()),
        seed: args.common.seed,
        start: args.start,
        odometry: odometry.into(),
        localise: is_localised,
        imu_rad: args.imu_noise.map(f64::to_radians),
        laser_m: args.laser_noise,
        working,
        failing,
        time_limit_ms: args.pace.time_limit,
        patrol_s: args.patrol_for,
        space: space(args),
        fence: fence(args)?,
        orders: orders(args)?,
        relaxation: relaxation(args),
        impatience_s: args.tdbvp_impatience.map_or(IMPATIENCE_S, |it| it.0),
        check_field: args.check_field,
        snapshots: args.snapshots,
        resumes: args.resume.is_some(),
        slam: args.slam,
        particles: args.particles,
        ..Mission::default()
    }))
}

/// Returns the area and the end of a space-based potential field.
fn space(args: &ExploreArgs) -> SpaceMission {
    SpaceMission {
        area_m: args.area,
        until_permille: args.space.until.unwrap_or(1_000),
        impatience_s: args.space.sbpf_impatience.map(|it| it.0),
    }
}

/// Returns the bounds and the no-go polygons. An area that was asked for is bounds as well: a robot
/// that is told what to explore has nothing to do elsewhere.
fn fence(args: &ExploreArgs) -> Result<Fence> {
    let mut bounds = args.bounds.clone();
    if bounds.is_empty() {
        bounds.extend(args.area.map(Polygon::rectangle));
    }
    let no_go = args.no_go.clone();
    let fence = Fence { bounds, no_go };
    if fence.is_empty() {
        return Ok(fence);
    }
    if on_device(&args.strategy).is_none() {
        bail!(
            "--strategy {} knows no bounds; leave --bounds and --no-go out, or take a strategy on \
             the device",
            args.strategy
        );
    }
    match fence.check() {
        Ok(()) => Ok(fence),
        Err(reason) => bail!("--bounds and --no-go: {reason}"),
    }
}

/// Returns what the robot does after its exploration.
fn orders(args: &ExploreArgs) -> Result<Orders> {
    let orders = Orders {
        goals_m: args.goto.clone(),
        home: args.then == Some(ThenArg::Home),
        budget: Budget {
            range_m: args.range_m,
            time_s: args.time_s,
        },
        home_at_ms: args.home_at,
        pauses: args.pause.clone(),
    };
    if orders != Orders::default() && on_device(&args.strategy).is_none() {
        bail!(
            "--strategy {} takes no orders; leave --goto, --then, --range-m, --time-s, --home-at \
             and --pause out, or take a strategy on the device",
            args.strategy
        );
    }
    Ok(orders)
}

/// Returns how the stored potential of a baseline is relaxed.
fn relaxation(args: &ExploreArgs) -> Relaxation {
    let usual = Relaxation::DEFAULT;
    Relaxation {
        sweeps: args.bvp_sweeps.unwrap_or(usual.sweeps),
        precision: args.bvp_precision.map_or(usual.precision, Into::into),
    }
}

/// Prints the report on standard output, and advice on standard error.
fn print(args: &ExploreArgs, report: &Report, record: &Record, folder: &Path) -> Result<()> {
    if args.common.json {
        say(&report.to_json_line())?;
    } else {
        say(&report.to_text())?;
    }
    if let Some(advice) = strategies::advice(&args.strategy, &record.ending) {
        note(&format!("host-sim: {}: {advice}", report.world));
    }
    if let Some(error) = &record.read_out_error {
        note(&format!(
            "host-sim: {}: the map could not be read from the device: {error}",
            report.world
        ));
    }
    note(&format!("{}: files in {}", report.world, folder.display()));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::{unique, with_start};

    #[test]
    fn the_name_of_a_world_may_end_with_a_start() {
        assert_eq!(with_start("slope@3"), ("slope", Some(3)));
        assert_eq!(with_start("a@b/c.yaml@12"), ("a@b/c.yaml", Some(12)));
        assert_eq!(with_start("a@b/c.yaml"), ("a@b/c.yaml", None));
        assert_eq!(with_start("office"), ("office", None));
    }

    #[test]
    fn the_same_world_twice_gets_two_folders() {
        let names = ["a", "b", "a", "a"].map(String::from);
        assert_eq!(unique(names.into_iter()), ["a", "b", "a-2", "a-3"]);
    }
}

//! `host-sim explore`: worlds in, folders and reports out.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, bail};

use fieldline_protocol::message::UnevenGround;
use host_sim::link::spec::{LinkSpec, Options};
use host_sim::report::{Report, folder};
use host_sim::robot::Limits;
use host_sim::trial::Record;
use host_sim::trial::mission::{self, Mission, MissionError};
use host_sim::trial::uneven;
use host_sim::world::World;

use super::args::{ExploreArgs, OdometryArg};
use super::pictures::Album;
use super::progress::{Interrupt, Onlooker};
use super::{baselines, note, say};

/// One run to do.
struct Errand {
    world: World,
    mission: Mission,
    folder: PathBuf,
}

/// Explores every world; whether all of them ended explored.
pub(super) fn run(args: &ExploreArgs) -> Result<bool> {
    let link = baselines::place(&args.strategy, args.link.as_ref())?;
    baselines::check(&args.strategy, args.check_field, args.fault.is_some())?;
    baselines::check_patrol(&args.strategy, args.patrol_for)?;
    let errands = errands(args, &mission(args, &link)?)?;
    let interrupt = Interrupt::listen()?;
    let mut all_explored = true;
    for errand in &errands {
        all_explored &= explore(args, &link, errand, &interrupt)?;
        if interrupt.pressed() {
            break;
        }
    }
    Ok(all_explored)
}

/// Every world is opened and every folder proved before the first run.
fn errands(args: &ExploreArgs, mission: &Mission) -> Result<Vec<Errand>> {
    let open = |name: &String| {
        let (name, start) = with_start(name);
        let world = World::open(name)?;
        let mission = Mission {
            start: start.unwrap_or(mission.start),
            ..mission.clone()
        };
        mission::check(&mission, &world)?;
        Ok((world, mission))
    };
    let worlds: Vec<(World, Mission)> = args.worlds.iter().map(open).collect::<Result<_>>()?;
    let names = unique(worlds.iter().map(|(world, mission)| {
        let start = match mission.start {
            0 => String::new(),
            start => format!("@{start}"),
        };
        format!("{}{start}-{}-{}", world.name(), args.strategy, args.seed)
    }));
    let single = worlds.len() == 1;
    worlds
        .into_iter()
        .zip(names)
        .map(|((world, mission), name)| {
            let folder = match &args.out {
                Some(out) if single => out.clone(),
                Some(out) => out.join(name),
                None => Path::new("out").join(name),
            };
            folder::prepare(&folder)?;
            Ok(Errand {
                world,
                mission,
                folder,
            })
        })
        .collect()
}

/// `WORLD@N` is a world and one of its starts, unless a file has that name.
fn with_start(name: &str) -> (&str, Option<usize>) {
    let parts = name.rsplit_once('@').filter(|_| !Path::new(name).exists());
    match parts.and_then(|(world, start)| Some((world, start.parse().ok()?))) {
        Some((world, start)) => (world, Some(start)),
        None => (name, None),
    }
}

/// The same name a second time gets `-2`.
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

/// One run, from hello to folder.
fn explore(
    args: &ExploreArgs,
    link: &LinkSpec,
    errand: &Errand,
    interrupt: &Interrupt,
) -> Result<bool> {
    let options = Options {
        faults: args
            .fault
            .as_ref()
            .map_or_else(Default::default, |f| f.faults),
        seed: args.seed,
        real_time: args.realtime,
    };
    let name = errand.world.name();
    for text in errand.world.notes() {
        note(&format!("host-sim: {name}: {text}"));
    }
    let mut planner = baselines::open(&args.strategy, link, &options)
        .with_context(|| format!("--link {link}"))?;
    let mut onlooker = Onlooker::new(name, args.realtime, interrupt.clone());
    let run = mission::explore(
        &errand.mission,
        &errand.world,
        planner.as_mut(),
        &mut onlooker,
    );
    onlooker.finish();
    let (report, record) = match run {
        Err(MissionError::Link(error)) => bail!("--link {link}: {error}"),
        run => run?,
    };
    let album = Album::new(&errand.world, &report, &record);
    folder::write(&errand.folder, &report, &record, &album.end())?;
    folder::write_snapshots(&errand.folder, album.on_the_way())?;
    tell(args, &report, &record, &errand.folder)?;
    Ok(report.explored())
}

/// The parameters of uneven ground, if any are asked for: with them every strategy on the device heeds it, and baseline bvp.
fn terrain(args: &ExploreArgs) -> Result<Option<UnevenGround>> {
    if args.preference.is_none() && args.terrain.is_none() {
        return Ok(None);
    }
    if !baselines::heeds_ground(&args.strategy) {
        bail!(
            "--strategy {} takes all ground for flat; leave --preference and --terrain out",
            args.strategy
        );
    }
    let terrain = args.terrain.unwrap_or(uneven::TABLE_I);
    Ok(Some(UnevenGround {
        preference: args.preference.map_or(terrain.preference, Into::into),
        ..terrain
    }))
}

fn mission(args: &ExploreArgs, link: &LinkSpec) -> Result<Mission> {
    let working = args.limits.unwrap_or(Limits::WORKING);
    let failing = args.failing.unwrap_or(Limits::FAILING);
    if !working.is_within(&failing) {
        bail!(
            "--limits {working} allows what --failing {failing} does not survive; lower the one or raise the other"
        );
    }
    Ok(Mission {
        strategy: args.strategy.clone(),
        terrain: terrain(args)?,
        link: link.to_string(),
        fault: args.fault.as_ref().map(|fault| fault.words.clone()),
        seed: args.seed,
        start: args.start,
        noisy_odometry: args.odometry == OdometryArg::Noisy,
        imu_rad: args.imu_noise.map(f64::to_radians),
        laser_m: args.laser_noise,
        working,
        failing,
        time_limit_ms: args.time_limit,
        patrol_s: args.patrol_for,
        box_tiles: args.map_shape,
        check_field: args.check_field,
        snapshots: args.snapshots,
        ..Mission::default()
    })
}

/// The report on standard output, and what people want to know.
fn tell(args: &ExploreArgs, report: &Report, record: &Record, folder: &Path) -> Result<()> {
    if args.json {
        say(&report.to_json_line())?;
    } else {
        say(&report.to_text())?;
    }
    if let Some(advice) = record.ending.advice() {
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
    fn a_start_may_follow_the_world() {
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

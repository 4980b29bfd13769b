//! `host-sim explore`: worlds in, folders and reports out.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, bail};

use host_sim::link::spec::{LinkSpec, Options};
use host_sim::picture::{Scene, run_png};
use host_sim::report::{Report, folder};
use host_sim::trial::Record;
use host_sim::trial::mission::{self, Mission, MissionError};
use host_sim::world::World;

use super::args::{ExploreArgs, OdometryArg};
use super::progress::{Interrupt, Onlooker};
use super::{baselines, note, say};

/// One run to do.
struct Errand {
    world: World,
    folder: PathBuf,
}

/// Explores every world; whether all of them ended explored.
pub(super) fn run(args: &ExploreArgs) -> Result<bool> {
    let link = baselines::place(&args.strategy, args.link.as_ref())?;
    baselines::check(&args.strategy, args.check_field, args.fault.is_some())?;
    let mission = mission(args, &link);
    let errands = errands(args, &mission)?;
    let interrupt = Interrupt::listen()?;
    let mut all_explored = true;
    for errand in &errands {
        all_explored &= explore(args, &link, &mission, errand, &interrupt)?;
        if interrupt.pressed() {
            break;
        }
    }
    Ok(all_explored)
}

/// Every world is opened and every folder proved before the first run.
fn errands(args: &ExploreArgs, mission: &Mission) -> Result<Vec<Errand>> {
    let open = |name: &String| {
        let world = World::open(name)?;
        mission::check(mission, &world)?;
        Ok(world)
    };
    let worlds: Vec<World> = args.worlds.iter().map(open).collect::<Result<_>>()?;
    let names = unique(worlds.iter().map(|world| {
        let (strategy, seed) = (&args.strategy, args.seed);
        format!("{}-{strategy}-{seed}", world.name())
    }));
    let single = worlds.len() == 1;
    worlds
        .into_iter()
        .zip(names)
        .map(|(world, name)| {
            let folder = match &args.out {
                Some(out) if single => out.clone(),
                Some(out) => out.join(name),
                None => Path::new("out").join(name),
            };
            folder::prepare(&folder)?;
            Ok(Errand { world, folder })
        })
        .collect()
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
    mission: &Mission,
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
    let mut planner = baselines::open(&args.strategy, link, &options)
        .with_context(|| format!("--link {link}"))?;
    let mut onlooker = Onlooker::new(name, args.realtime, interrupt.clone());
    let run = mission::explore(mission, &errand.world, planner.as_mut(), &mut onlooker);
    onlooker.finish();
    let (report, record) = match run {
        Err(MissionError::Link(error)) => bail!("--link {link}: {error}"),
        run => run?,
    };
    folder::write(&errand.folder, &report, &record, &picture(&report, &record))?;
    tell(args, &report, &record, &errand.folder)?;
    Ok(report.explored())
}

fn mission(args: &ExploreArgs, link: &LinkSpec) -> Mission {
    Mission {
        strategy: args.strategy.clone(),
        link: link.to_string(),
        fault: args.fault.as_ref().map(|fault| fault.words.clone()),
        seed: args.seed,
        start: args.start,
        noisy_odometry: args.odometry == OdometryArg::Noisy,
        time_limit_ms: args.time_limit,
        box_tiles: args.map_shape,
        check_field: args.check_field,
        ..Mission::default()
    }
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

fn picture(report: &Report, record: &Record) -> Vec<u8> {
    let path: Vec<_> = record.steps.iter().map(|step| step.truth).collect();
    let left = report.outcome.residual_frontiers.iter();
    let residue: Vec<_> = left.map(|f| (f.x_m, f.y_m)).collect();
    run_png(&Scene {
        title: &report.headline(),
        subtitle: &report.in_short(),
        map: &record.map,
        path: &path,
        window: record.window.as_ref(),
        residue: &residue,
    })
}

#[cfg(test)]
mod tests {
    use super::unique;

    #[test]
    fn the_same_world_twice_gets_two_folders() {
        let names = ["a", "b", "a", "a"].map(String::from);
        assert_eq!(unique(names.into_iter()), ["a", "b", "a-2", "a-3"]);
    }
}

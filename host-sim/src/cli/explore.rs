//! `host-sim explore`: explores worlds; writes folders and reports.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use anyhow::{Result, bail};

use host_sim::live::Live;
use host_sim::picture::film::Film;
use host_sim::report::{MadeBy, Report, folder};
use host_sim::state::{self, State};
use host_sim::trial::Record;
use host_sim::trial::mission::{self, Mission};
use host_sim::trial::surprises::surprises;
use host_sim::world::World;

use super::args::{ExploreArgs, GroundArg, LogArg};
use super::pictures::Album;
use super::prepared::{Beside, Prepared};
use super::profile::Profiler;
use super::progress::{Interrupt, Onlooker};
use super::recording::Recorder;
use super::resume;
use super::strategies::{self, FRONTIER, TERRAIN};
use super::{film, live, made_by, note, say};

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
    let film = film::film(&prepared.args)?;
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
        all_explored &= explore(&prepared, run, &interrupt, (live.as_ref(), film.as_ref()))?;
        if interrupt.pressed() {
            break;
        }
    }
    live::stay(live.as_slice(), &interrupt);
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
    (live, film): (Option<&Live>, Option<&Film>),
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
    let shown = live.map(|live| live::observer(live, &run.mission, name.into(), interrupt));
    onlooker.show(shown.into_iter().collect());
    if let Some(state) = &run.resumed {
        onlooker.begin_after(state.time_ms);
        note(&format!(
            "host-sim: {name}: goes on {}",
            resume::place(state)
        ));
    }
    let recorder = recorder(args, run)?.map(Rc::new);
    onlooker.record(recorder.iter().cloned().collect());
    let profiler = profiler(prepared, run)?;
    let mut keeping = resume::keeping(args, run);
    let beside = Beside {
        keeping: keeping.as_mut(),
        recorder: recorder.as_deref(),
        profile: profiler.as_ref().map(Profiler::raw),
    };
    let result = prepared.play_kept(&run.mission, &run.world, &mut onlooker, beside);
    onlooker.finish();
    if let Some(profiler) = profiler {
        profiler.end(name);
    }
    if let Some(recorder) = recorder {
        recorder.end(result.as_ref().ok().map(|(report, _)| report));
    }
    for page in onlooker.pages() {
        let report = result.as_ref().map(|(report, _)| report);
        live::end(page, report.map_err(|error| format!("{error:#}")));
    }
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
    match film {
        Some(film) => film::make(film, args, &album)?,
        None => {
            folder::write_snapshots(&run.folder, album.during())?;
            folder::write_corrections(&run.folder, album.corrections())?;
        }
    }
    print(args, &report, &record, &run.folder)?;
    Ok(report.explored())
}

/// Begins the recording of a run; `None` without `--record`.
fn recorder(args: &ExploreArgs, run: &Run) -> Result<Option<Recorder>> {
    let Some(file) = &args.record else {
        return Ok(None);
    };
    let why = "a run that goes on has no recorded beginning";
    alone("--record", file, args, run, why)?;
    Recorder::open(file, &run.made_by, args.folder.force).map(Some)
}

/// Begins the profile of a run; `None` without `--profile`.
fn profiler(prepared: &Prepared, run: &Run) -> Result<Option<Profiler>> {
    let args = &prepared.args;
    let Some(file) = &args.profile else {
        return Ok(None);
    };
    alone(
        "--profile",
        file,
        args,
        run,
        "a run that goes on has no profile of its beginning",
    )?;
    Profiler::open(file, &prepared.link, args.folder.force).map(Some)
}

/// Refuses a file for several runs, or for one that goes on, which has not all of it: `why`.
fn alone(option: &str, file: &Path, args: &ExploreArgs, run: &Run, why: &str) -> Result<()> {
    let file = file.display();
    if args.worlds.len() > 1 {
        bail!("{option} {file}: a file holds one run; name one world");
    }
    if run.resumed.is_some() {
        bail!("{option} {file}: {why}; leave {option} or --resume out");
    }
    Ok(())
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

//! `host-sim campaign`: the product of worlds, strategies, starts and seeds, in a folder that
//! survives a kill; and the merge of its shards.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::thread;

use anyhow::{Context as _, Error, Result, bail};
use clap::{Args, Parser as _, Subcommand};

use host_sim::campaign::plan::{Plan, SLAM_OFF, Trial};
use host_sim::campaign::shards::{self, Shard};
use host_sim::campaign::source::Source;
use host_sim::campaign::spec::{self, Spec};
use host_sim::campaign::store::{self, Finished, Store};
use host_sim::campaign::trials::{self, Crew, Explore};
use host_sim::campaign::{columns, markdown, numbers, results};
use host_sim::report::Report;
use host_sim::trial::{Record, Watch};
use host_sim::world::World;

use super::args::{Cli, Command, ExploreArgs};
use super::explore::with_start;
use super::prepared::Prepared;
use super::progress::{Interrupt, Trials};
use super::{note, say};

#[derive(Clone, Debug, Args)]
#[command(args_conflicts_with_subcommands = true)]
pub(super) struct CampaignArgs {
    #[command(subcommand)]
    command: Option<CampaignCommand>,
    /// Campaign file, TOML; docs/CAMPAIGNS.md describes it
    #[arg(
        value_name = "FILE",
        conflicts_with = "worlds",
        required_unless_present = "worlds"
    )]
    file: Option<PathBuf>,
    /// Instead of a file: worlds, with commas
    #[arg(long, value_name = "W,W", value_delimiter = ',')]
    worlds: Vec<String>,
    /// Strategies, with commas
    #[arg(long, value_name = "S,S", value_delimiter = ',', requires = "worlds")]
    strategies: Vec<String>,
    /// Starts, as in 0..3 or 0,2 [default: 0]
    #[arg(long, value_name = "N..M", requires = "worlds", value_parser = numbers::parse)]
    starts: Option<Numbers>,
    /// Seeds, as in 0..10 or 0,2 [default: 0]
    #[arg(long, value_name = "N..M", requires = "worlds", value_parser = numbers::parse)]
    seeds: Option<Numbers>,
    /// Odometry, with commas if several [default: that of explore]
    #[arg(long, value_name = "O,O", value_delimiter = ',', requires = "worlds")]
    odometry: Vec<String>,
    /// Where loops are closed, with commas if several [default: off]
    #[arg(long, value_name = "P,P", value_delimiter = ',', requires = "worlds")]
    slam: Vec<String>,
    /// Strategy with which the others are compared
    #[arg(long, value_name = "S", requires = "worlds")]
    baseline: Option<String>,
    /// Columns of the table, paths into the report, with commas
    #[arg(long, value_name = "C,C", value_delimiter = ',', requires = "worlds")]
    columns: Vec<String>,
    /// Name of the campaign [default: WORLD-STRATEGY-... of the command]
    #[arg(long, requires = "worlds")]
    name: Option<String>,
    /// Folder of the campaign [default: out/campaign-NAME]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Number of trials at a time [default: one a core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
    /// Run only part I of N, from 0, as in 0/4
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
    /// Run the trials that failed again
    #[arg(long)]
    retry: bool,
    /// Print the commands of the trials, and run none
    #[arg(long)]
    list: bool,
    /// Options of explore for every trial
    #[arg(last = true, value_name = "EXPLORE OPTIONS", requires = "worlds")]
    options: Vec<String>,
}

/// A list of numbers; the alias keeps clap from taking the option for one that repeats.
type Numbers = Vec<u64>;

#[derive(Clone, Debug, Subcommand)]
enum CampaignCommand {
    /// Join the folders of all shards to one campaign
    Merge(MergeArgs),
}

#[derive(Clone, Debug, Args)]
struct MergeArgs {
    /// Folders of the shards
    #[arg(required = true, value_name = "DIR")]
    folders: Vec<PathBuf>,
    /// Folder of the whole campaign
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

/// Runs a campaign or merges its shards; returns true if every trial has a report.
pub(super) fn run(args: &CampaignArgs) -> Result<bool> {
    if let Some(CampaignCommand::Merge(args)) = &args.command {
        let (plan, finished) = shards::merge(&args.folders, &args.out)?;
        return conclude(&args.out, &plan, &finished);
    }
    let Spec {
        plan,
        shard,
        source,
    } = spec(args)?;
    let shard = args.shard.or(shard);
    let explorer = Explorer::open(&plan, &source)?;
    explorer.check(&plan, &source)?;
    plan.check_odometry()
        .map_err(|error| source.placed(error))?;
    let all = Shard::trials(shard, &plan);
    if args.list {
        all.iter()
            .try_for_each(|trial| say(&store::command(trial)))?;
        return Ok(true);
    }
    let folder = args
        .out
        .clone()
        .unwrap_or_else(|| default_folder(&plan, shard));
    let mut store = Store::open(&folder, &plan, shard, args.retry)?;
    for text in &store.notes {
        note(&format!("host-sim: {text}"));
    }
    let is_whole = explore(args, &explorer, all, &mut store)?;
    if is_whole {
        store.rewrite()?;
    }
    if shard.is_some() {
        let place = folder.display();
        note(&format!(
            "files in {place}; join the shards by campaign merge"
        ));
        return Ok(is_whole && store.finished.iter().all(|it| it.failure.is_none()));
    }
    Ok(conclude(&folder, &plan, &store.finished)? && is_whole)
}

/// Runs those of the trials that are not in the folder yet; returns true if none is left.
fn explore(
    args: &CampaignArgs,
    explorer: &Explorer,
    all: Vec<Trial>,
    store: &mut Store,
) -> Result<bool> {
    let (count, before) = (all.len(), store.finished.len());
    let open = store.open_trials(all);
    if before > 0 {
        let left = open.len();
        note(&format!(
            "host-sim: {before} of {count} trials are there; {left} to go"
        ));
    }
    let cores = thread::available_parallelism().map_or(1, usize::from);
    let interrupt = Interrupt::listen()?;
    let crew = Crew {
        explorer,
        jobs: args.jobs.map_or(cores, usize::from),
        interrupted: &|| interrupt.pressed(),
    };
    let mut line = Trials::new(before, count);
    let result = trials::run(&crew, &open, &mut |finished: Finished| {
        line.finished(&format!(
            "{} · {} · start {} · seed {}",
            finished.world, finished.strategy, finished.start, finished.seed
        ));
        if let Some(failure) = &finished.failure {
            line.note(&format!("host-sim: {}: {failure}", finished.command));
        }
        store.append(finished)
    });
    line.end();
    result?;
    let done = store.finished.len();
    if done < count {
        note(&format!(
            "host-sim: {done} of {count} trials are done; the same command goes on"
        ));
    }
    Ok(done == count)
}

/// Writes tables and plots, and prints the table; returns true if no trial failed.
fn conclude(folder: &Path, plan: &Plan, finished: &[Finished]) -> Result<bool> {
    let written = results::write(folder, plan, finished)?;
    for text in &written.notes {
        note(&format!("host-sim: {text}"));
    }
    say(&markdown::text(&written.table, plan))?;
    note(&format!("files in {}", folder.display()));
    Ok(written.table.failures.is_empty())
}

/// Returns the campaign of the file, or of the options.
fn spec(args: &CampaignArgs) -> Result<Spec> {
    if let Some(file) = &args.file {
        return Ok(spec::read(file)?);
    }
    let or = |list: &[String], usual: Vec<String>| match list {
        [] => usual,
        list => list.to_vec(),
    };
    let strategies = or(&args.strategies, vec![super::strategies::FRONTIER.into()]);
    let stem = |world: &String| {
        let stem = Path::new(world)
            .file_stem()
            .map(|it| it.to_string_lossy().into_owned());
        stem.unwrap_or_default().replace(':', "-")
    };
    let usual_name = || {
        let words = args
            .worlds
            .iter()
            .map(stem)
            .chain(strategies.iter().cloned());
        words.collect::<Vec<_>>().join("-")
    };
    let plan = Plan {
        name: args.name.clone().unwrap_or_else(usual_name),
        worlds: args.worlds.clone(),
        starts: args.starts.clone().unwrap_or_else(|| vec![0]),
        seeds: args.seeds.clone().unwrap_or_else(|| vec![0]),
        odometry: args.odometry.clone(),
        slam: or(&args.slam, vec![SLAM_OFF.into()]),
        baseline: args.baseline.clone(),
        columns: or(&args.columns, columns::default()),
        options: spec::options(&args.options)?,
        variants: Vec::new(),
        strategies,
    };
    spec::check_name(&plan.name).map_err(|error| Error::msg(error).context("--name"))?;
    for column in &plan.columns {
        columns::check(column).map_err(|error| Error::msg(error).context("--columns"))?;
    }
    plan.check()?;
    Ok(Spec {
        plan,
        shard: None,
        source: Source::default(),
    })
}

fn default_folder(plan: &Plan, shard: Option<Shard>) -> PathBuf {
    let shard = shard.map_or_else(String::new, |it| {
        format!("-shard-{}-of-{}", it.index, it.of)
    });
    Path::new("out").join(format!("campaign-{}{shard}", plan.name))
}

/// Makes the runs of trials, in worlds that are opened once.
struct Explorer {
    worlds: BTreeMap<String, World>,
}

impl Explorer {
    /// Opens the worlds.
    fn open(plan: &Plan, source: &Source) -> Result<Self> {
        let mut worlds = BTreeMap::new();
        for name in &plan.worlds {
            if let (world, Some(start)) = with_start(name) {
                let reason = format!("world {name} names a start; say {world} and starts {start}");
                return Err(source.error("worlds", name, reason).into());
            }
            let world = World::open(name);
            let world = world.map_err(|error| source.error("worlds", name, error.to_string()))?;
            for text in world.notes() {
                note(&format!("host-sim: {name}: {text}"));
            }
            worlds.insert(name.clone(), world);
        }
        Ok(Self { worlds })
    }

    /// Checks the arguments of every kind of trial, before the first one runs. The seed cannot be
    /// wrong.
    fn check(&self, plan: &Plan, source: &Source) -> Result<()> {
        let one_seed = Plan {
            seeds: plan.seeds.iter().copied().take(1).collect(),
            ..plan.clone()
        };
        for trial in one_seed.trials() {
            let placed = |error: &Error| format!("{error:#} ({})", trial.in_short());
            let prepared = parsed(&trial.arguments()).and_then(|args| Prepared::new(&args));
            let prepared = prepared
                .map_err(|error| source.argument_error(&trial.arm.entry, &placed(&error)))?;
            let world = self.world(&trial.world)?;
            let checked = prepared.check_start(world);
            checked.map_err(|error| source.error("starts", "", placed(&error)))?;
        }
        Ok(())
    }

    fn world(&self, name: &str) -> Result<&World> {
        let world = self.worlds.get(name);
        world.with_context(|| format!("world {name} is not open"))
    }
}

impl Explore for Explorer {
    fn explore(
        &self,
        arguments: &[String],
        watch: &mut dyn Watch,
    ) -> Result<(Report, Record), String> {
        let mut run = || {
            let prepared = Prepared::new(&parsed(arguments)?)?;
            let name = arguments.first().map_or("", String::as_str);
            prepared.play(self.world(name)?, watch)
        };
        run().map_err(|error: Error| format!("{error:#}"))
    }
}

/// Parses arguments as the command line of `explore`.
fn parsed(arguments: &[String]) -> Result<ExploreArgs> {
    let words = ["host-sim", "explore"].map(String::from);
    let cli = Cli::try_parse_from(words.iter().chain(arguments));
    match cli.map_err(|error| Error::msg(fault(&error)))?.command {
        Some(Command::Explore(args)) if args.strategy == super::strategies::TERRAIN => {
            bail!(
                "--strategy terrain is an alias; say frontier, and the option ground = \"uneven\""
            )
        }
        Some(Command::Explore(args)) => Ok(*args),
        _ => bail!("these are no arguments of explore"),
    }
}

/// Returns what is wrong, and clap's tip if it has one.
fn fault(error: &clap::Error) -> String {
    let text = error.render().to_string();
    let parts = text.split("\n\n").take(2);
    let parts = parts
        .enumerate()
        .filter(|(index, part)| *index == 0 || part.contains("tip:"));
    let words: Vec<&str> = parts
        .flat_map(|(_, part)| part.split_whitespace())
        .collect();
    words.join(" ").trim_start_matches("error: ").to_owned()
}

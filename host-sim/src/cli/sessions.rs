//! `host-sim sessions` and `host-sim replay-session`: whole sessions of hostile hosts, judged.

use core::ops::Range;
use core::time::Duration;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Error, Result};
use clap::Args;

use host_sim::session::campaign::Campaign;
use host_sim::session::generate::{self, Generator, LONGEST, Replayed};
use host_sim::session::judge::{Limits, stages};
use host_sim::session::play::{Played, play};
use host_sim::session::script::{FORMAT, Head, Script};
use host_sim::session::target::TargetSpec;

use super::{note, say};

#[derive(Clone, Debug, Args)]
pub(super) struct SessionsArgs {
    /// absurd, tame or plausible; several with commas [default: all]
    #[arg(long, value_name = "G", value_delimiter = ',')]
    generator: Vec<Generator>,
    /// Seeds from A up to and without B
    #[arg(long, value_name = "A..B", default_value = "0..100", value_parser = seeds)]
    seeds: Range<u64>,
    /// Play the session of an input of the fuzz target `hosts` instead
    #[arg(long, value_name = "FILE", conflicts_with_all = ["generator", "seeds", "seconds"])]
    bytes: Option<PathBuf>,
    /// Seconds after which no session begins
    #[arg(long, value_name = "S")]
    seconds: Option<u64>,
    /// device (in this process, maps of several sizes), direct, loopback, qemu or
    /// serial:DEVICE[@BAUD]
    #[arg(long, default_value = "device")]
    link: TargetSpec,
    /// Compare every command with a device in this process, of the default size; for links
    #[arg(long)]
    twin: bool,
    /// Number of sessions at a time
    #[arg(long, value_name = "N", default_value_t = 1)]
    threads: usize,
    /// Most requests of a session
    #[arg(long, value_name = "N", default_value_t = LONGEST)]
    longest: usize,
    /// Folder for a file of each kind of finding, shrunken
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Most trials for shrinking a finding
    #[arg(long, value_name = "N", default_value_t = 300)]
    trials: usize,
    #[command(flatten)]
    limits: LimitArgs,
}

#[derive(Clone, Copy, Debug, Args)]
struct LimitArgs {
    /// Most instructions of a step
    #[arg(long, value_name = "N", default_value_t = Limits::default().instructions)]
    most_instructions: u32,
    /// Deepest stack, bytes
    #[arg(long, value_name = "N", default_value_t = Limits::default().stack_bytes)]
    most_stack: u32,
    /// Longest time that an answer may take, milliseconds; it depends on the machine [default: any]
    #[arg(long, value_name = "MS")]
    most_ms: Option<u64>,
}

impl LimitArgs {
    fn limits(self) -> Limits {
        Limits {
            instructions: self.most_instructions,
            stack_bytes: self.most_stack,
            answer: self.most_ms.map(Duration::from_millis),
            ..Limits::default()
        }
    }
}

#[derive(Clone, Debug, Args)]
pub(super) struct ReplaySessionArgs {
    /// File of a session, JSON lines
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// device (in this process, of the file's capacity), direct, loopback, qemu or
    /// serial:DEVICE[@BAUD]
    #[arg(long, default_value = "device")]
    link: TargetSpec,
    #[command(flatten)]
    limits: LimitArgs,
}

/// Runs sessions; returns true if nothing was found.
pub(super) fn run(args: &SessionsArgs) -> Result<bool> {
    let campaign = Campaign {
        generators: match &args.generator[..] {
            [] => Generator::ALL.to_vec(),
            some => some.to_vec(),
        },
        seeds: args.seeds.clone(),
        target: args.link.clone(),
        limits: args.limits.limits(),
        twin: args.twin,
        longest: args.longest,
        time: args.seconds.map(Duration::from_secs),
        threads: args.threads,
        findings: args.out.clone(),
        trials: args.trials,
    };
    if let Some(file) = &args.bytes {
        return play_bytes(&campaign, file);
    }
    let totals = campaign.run(&note);
    let totals = totals.with_context(|| format!("--link {}", args.link))?;
    say(&totals.to_string())?;
    Ok(totals.findings.is_empty())
}

/// Plays the session of a fuzzer's input; returns true if nothing was found.
fn play_bytes(campaign: &Campaign, file: &Path) -> Result<bool> {
    let name = || file.display().to_string();
    let bytes = std::fs::read(file).with_context(name)?;
    let (generator, capacity, mut host) = generate::of_bytes(&bytes);
    let played = campaign.trial(capacity).play(&mut *host)?;
    say(&text(&played))?;
    let Some(folder) = &campaign.findings else {
        return Ok(played.findings.is_empty());
    };
    for finding in &played.findings {
        let head = Head {
            fieldline_session: FORMAT,
            generator: format!("{}-bytes", generator.name()),
            capacity,
            ..Head::default()
        };
        let path = campaign.write(folder, head, (&finding.kind, &played));
        say(&path.map_err(Error::msg)?.display().to_string())?;
    }
    Ok(played.findings.is_empty())
}

/// Replays a session; returns true if nothing was found.
pub(super) fn replay(args: &ReplaySessionArgs) -> Result<bool> {
    let script = Script::load(&args.file)?;
    let context = || format!("--link {}", args.link);
    let target = args.link.open(script.head.capacity);
    let mut target = target.with_context(context)?;
    let mut host = Replayed::new(&script.asks);
    let played = play(&mut host, &mut *target, args.limits.limits());
    say(&text(&played))?;
    Ok(played.findings.is_empty())
}

fn text(played: &Played) -> String {
    let mut lines = vec![format!(
        "{} requests, {} steps, {} refused, ended {:?}",
        played.asks.len(),
        played.steps,
        played.refused,
        played.status
    )];
    if let Some((cost, request)) = &played.dearest {
        let parts = stages(&cost.stages).map(|(name, count)| format!("{name} {count}"));
        lines.push(format!(
            "dearest step: request {request}, {} instructions: {}",
            cost.instructions,
            parts.join(", ")
        ));
        lines.push(format!("deepest stack: {} bytes", played.stack_bytes));
    }
    lines.extend(played.findings.iter().map(|it| format!("finding: {it}")));
    if played.findings.is_empty() {
        lines.push("no findings".into());
    }
    lines.join("\n")
}

fn seeds(text: &str) -> Result<Range<u64>, String> {
    let ends = text.split_once("..");
    let ends = ends.and_then(|(from, to)| Some(from.parse().ok()?..to.parse().ok()?));
    let ends = ends.filter(|range: &Range<u64>| !range.is_empty());
    ends.ok_or_else(|| "give two whole numbers, the less one first, as in 0..1000".into())
}

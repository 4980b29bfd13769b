//! Compares the planner with its baselines: worlds × strategies × seeds, as a Markdown table of the
//! medians over the seeds.
//!
//! ```text
//! cargo run --release -p host-sim --example baselines -- --seeds 5 WORLD.yaml… office cave
//! ```
//!
//! Lasers are noisy and odometry is true, as by default in `host-sim explore`. T90 and T99 are the
//! simulated seconds until 90 % and 99 % of the reachable area is known; they are infinite in a run
//! that does not get there. A second table has the cost of *bvp*.

use clap::Parser;

use host_sim::baseline::bvp::Work;
use host_sim::baseline::greedy::Tuning;
use host_sim::baseline::{Bvp, GreedyFrontier, Session};
use host_sim::link::Link;
use host_sim::link::direct::Direct;
use host_sim::report::Report;
use host_sim::trial::mission::{self, Mission};
use host_sim::world::{World, builtins};

/// Instructions of a cell update on a Cortex-M4F, by rough estimate.
const INSTRUCTIONS_PER_UPDATE: f64 = 20.0;

/// Compare the planner with its baselines.
#[derive(Debug, Parser)]
struct Args {
    /// World files or names of built-in worlds [default: all built-in worlds]
    worlds: Vec<String>,
    /// Number of seeds of each strategy in each world
    #[arg(long, default_value_t = 5)]
    seeds: u64,
    /// Strategies to compare
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "frontier,bvp,greedy-frontier"
    )]
    strategies: Vec<String>,
    /// Simulated seconds after which a run ends
    #[arg(long, default_value_t = 3600)]
    time_limit: u32,
    /// Cost of a metre of path for greedy-frontier
    #[arg(long, default_value_t = Tuning::default().potential_scale)]
    potential_scale: f32,
}

/// The report of a run, and its cost for bvp.
struct Run {
    report: Report,
    work: Option<Work>,
    wall_s: f64,
}

fn run(args: &Args, world: &World, strategy: &str, seed: u64) -> anyhow::Result<Run> {
    let mission = Mission {
        strategy: strategy.into(),
        seed,
        time_limit_ms: args.time_limit.saturating_mul(1000),
        ..Mission::default()
    };
    let began = std::time::Instant::now();
    let explore = |link: &mut dyn Link| mission::explore(&mission, world, link, &mut ());
    let (report, work) = match strategy {
        "frontier" => (explore(&mut Direct::new())?.0, None),
        "bvp" => {
            let mut session = Session::new(Bvp::new());
            let report = explore(&mut session)?.0;
            (report, Some(session.strategy.work()))
        }
        "greedy-frontier" => {
            let tuning = Tuning {
                potential_scale: args.potential_scale,
                ..Tuning::default()
            };
            (
                explore(&mut Session::new(GreedyFrontier::new(tuning)))?.0,
                None,
            )
        }
        _ => anyhow::bail!("unknown strategy '{strategy}'; use frontier, bvp, greedy-frontier"),
    };
    Ok(Run {
        report,
        work,
        wall_s: began.elapsed().as_secs_f64(),
    })
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Formats a row of the table.
fn row(world: &str, strategy: &str, runs: &[Run]) -> String {
    let reports = || runs.iter().map(|run| &run.report);
    let finished = reports().filter(|report| report.explored()).count();
    let reasons: std::collections::BTreeSet<_> = reports()
        .filter(|report| !report.explored())
        .map(|report| report.outcome.reason.clone())
        .collect();
    let reasons: Vec<_> = reasons.into_iter().collect();
    let seconds = |of: fn(&Report) -> Option<f64>| {
        let median = median(reports().map(|report| of(report).unwrap_or(f64::INFINITY)));
        if median.is_finite() {
            format!("{median:.1}")
        } else {
            "–".into()
        }
    };
    format!(
        "| {world} | {strategy} | {finished}/{} {} | {:.4} | {} | {} | {:.1} | {:.1} | {} \
         | {:.1} |",
        runs.len(),
        reasons.join(" "),
        median(reports().map(|report| report.coverage.fraction)),
        seconds(|report| report.coverage.t90_s),
        seconds(|report| report.coverage.t99_s),
        median(reports().map(|report| report.sim_time_s)),
        median(reports().map(|report| report.path_length_m)),
        reports()
            .map(|report| report.safety.collisions)
            .sum::<u32>(),
        median(runs.iter().map(|run| run.wall_s)),
    )
}

/// Formats the cost of bvp, and what it needs on a chip.
fn cost(world: &str, runs: &[Run]) -> Option<String> {
    let works: Vec<Work> = runs.iter().filter_map(|run| run.work).collect();
    let of = |part: fn(&Work) -> u64| works.iter().map(part).sum::<u64>() as f64;
    let most = |part: fn(&Work) -> u64| works.iter().map(part).max();
    let (steps, updates) = (of(|work| work.steps), of(|work| work.updates));
    Some(format!(
        "| {world} | {:.0} | {} | {} | {:.1} | {:.0} | {:.1} |",
        of(|work| work.cells) / steps,
        most(|work| work.most_cells)?,
        4 * most(|work| work.box_cells)? / 1024,
        of(|work| work.cycles) / steps,
        updates / steps,
        updates / steps * INSTRUCTIONS_PER_UPDATE / 1e6,
    ))
}

fn main() -> anyhow::Result<()> {
    let mut args = Args::parse();
    if args.worlds.is_empty() {
        args.worlds = builtins().iter().map(|world| world.name.into()).collect();
    }
    println!(
        "| world | strategy | explored | coverage | T90 s | T99 s | end s | path m | collisions \
         | wall s |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    let mut costs = Vec::new();
    for name in &args.worlds {
        let world = World::open(name)?;
        for strategy in &args.strategies {
            let runs: Vec<Run> = (0..args.seeds)
                .map(|seed| run(&args, &world, strategy, seed))
                .collect::<anyhow::Result<_>>()?;
            println!("{}", row(world.name(), strategy, &runs));
            costs.extend(cost(world.name(), &runs));
        }
    }
    println!(
        "\n| world | free cells, mean | most | box as f32, KiB | cycles a step \
         | cell updates a step | M instructions a step |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- |");
    costs.iter().for_each(|line| println!("{line}"));
    Ok(())
}

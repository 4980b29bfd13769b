//! Speed of whole explorations: simulated seconds per second of processor time, for planner,
//! simulator and metrics together, over the direct link.
//!
//! `cargo bench -p host-sim --bench explore [WORLD..]` explores `office`, or the named worlds, and
//! prints the best of a few runs of each: other work on the machine can only slow a run down. A run
//! is one thread, so a second of processor time is a second of one core. `--once` runs each world
//! once; `tests/profile` counts the instructions of that.

use host_sim::link::direct::Direct;
use host_sim::report::Report;
use host_sim::trial::mission::{Mission, explore};
use host_sim::world::World;

/// Runs of each world; the fastest counts.
const RUNS: usize = 5;

/// Processor time of this process, seconds.
#[cfg(unix)]
fn processor_s() -> f64 {
    use rustix::time::{ClockId, clock_gettime};
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

/// Elapsed time, in place of processor time.
#[cfg(not(unix))]
fn processor_s() -> f64 {
    use std::sync::LazyLock;
    use std::time::Instant;
    static BEGAN: LazyLock<Instant> = LazyLock::new(Instant::now);
    BEGAN.elapsed().as_secs_f64()
}

/// One whole run and its processor time, seconds.
fn run(name: &str) -> anyhow::Result<(Report, f64)> {
    let began_s = processor_s();
    let world = World::open(name)?;
    let (report, _) = explore(&Mission::default(), &world, &mut Direct::new(), &mut ())?;
    Ok((report, processor_s() - began_s))
}

/// The fastest of some runs; all must have the same digest.
fn fastest(name: &str, runs: usize) -> anyhow::Result<(Report, f64)> {
    let (report, mut least_s) = run(name)?;
    for _ in 1..runs {
        let (again, took_s) = run(name)?;
        anyhow::ensure!(
            again.digest == report.digest,
            "{name}: the same seed gave another run; look for a source of randomness"
        );
        least_s = least_s.min(took_s);
    }
    Ok((report, least_s))
}

fn main() -> anyhow::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let runs = if arguments.iter().any(|argument| argument == "--once") {
        1
    } else {
        RUNS
    };
    let named = arguments
        .iter()
        .map(String::as_str)
        .filter(|argument| !argument.starts_with("--"));
    let mut worlds: Vec<&str> = named.collect();
    if worlds.is_empty() {
        worlds.push("office");
    }
    println!(
        "{:<18} {:>8} {:>12} {:>12} {:>12}",
        "world", "steps", "simulated s", "processor s", "x real time"
    );
    for world in worlds {
        let (report, took_s) = fastest(world, runs)?;
        println!(
            "{world:<18} {:>8} {:>12.1} {took_s:>12.2} {:>12.0}",
            report.steps,
            report.sim_time_s,
            report.sim_time_s / took_s
        );
    }
    Ok(())
}

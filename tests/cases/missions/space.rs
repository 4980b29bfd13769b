//! Space-based potential fields \[Kenealy15\]: the paper's table, the constants that it does not
//! give, and the other strategies beside it.
//!
//! `golden/space-full.txt` has ten runs of each of the paper's worlds with one robot and with two,
//! and the constants at other values. `golden/space-worlds-full.txt` has `esbpf` beside every other
//! strategy, one run of each.

use fieldline_planner::Tuning;
use fieldline_tests::runs::in_parallel;
use fieldline_tests::table::{Table, number};
use fieldline_tests::{golden, runs, worlds};
use host_sim::link::Link;
use host_sim::link::direct::Direct;
use host_sim::report::{Report, TeamReport};
use host_sim::trial::mission::{Mission, explore};
use host_sim::trial::space::SpaceMission;
use host_sim::trial::team::{self, TeamMission};
use host_sim::world::World;

/// A world of the paper, the coverage that it asks for, and its P = 1/T with one robot and with
/// two of SBPF and of ESBPF.
struct Paper {
    world: &'static str,
    until_permille: u16,
    sbpf: [Option<f64>; 2],
    esbpf: [f64; 2],
}

const PAPER: [Paper; 3] = [
    Paper {
        world: "two-rooms",
        until_permille: 900,
        sbpf: [Some(0.0), Some(0.007)],
        esbpf: [0.0036, 0.0078],
    },
    Paper {
        world: "c-room",
        until_permille: 950,
        sbpf: [Some(0.0), Some(0.005)],
        esbpf: [0.004, 0.005],
    },
    Paper {
        world: "partition",
        until_permille: 900,
        sbpf: [None; 2],
        esbpf: [0.012, 0.035],
    },
];

/// Forces only, as in the paper.
const NEVER: Option<Option<u16>> = Some(None);

/// A run of one of the paper's worlds.
#[derive(Clone, Copy)]
struct Job<'a> {
    world: &'a World,
    until_permille: u16,
    strategy: &'static str,
    impatience_s: Option<Option<u16>>,
    tuning: &'static Tuning,
    seed: u64,
}

fn mission(job: &Job<'_>) -> Mission {
    Mission {
        strategy: job.strategy.into(),
        seed: job.seed,
        space: SpaceMission {
            until_permille: job.until_permille,
            impatience_s: job.impatience_s,
            ..SpaceMission::default()
        },
        ..Mission::default()
    }
}

fn go(job: &Job<'_>) -> Report {
    let run = explore(
        &mission(job),
        job.world,
        &mut Direct::tuned(job.tuning),
        &mut (),
    );
    run.expect("the world has a start").0
}

/// Sends out two robots side by side that hear each other.
fn go_in_pair(job: &Job<'_>) -> TeamReport {
    let link = |_| -> Box<dyn Link> { Box::new(Direct::tuned(job.tuning)) };
    let mut links: Vec<Box<dyn Link>> = (0..2).map(link).collect();
    let pair = TeamMission::of(mission(job), 2);
    match team::explore(&pair, job.world, &mut links, &mut ()) {
        Ok((report, _)) => report,
        Err(error) => panic!("{}: {error}", job.world.name()),
    }
}

/// Returns the time until the map of one of the robots shows the target coverage.
fn pair_covered_s(report: &TeamReport) -> Option<f64> {
    let times = report
        .robots
        .iter()
        .filter_map(|robot| covered_s(&robot.report));
    times.min_by(f64::total_cmp)
}

/// Returns the time to the target coverage; `None` if it was never reached.
fn covered_s(report: &Report) -> Option<f64> {
    (report.outcome.reason == "covered").then_some(report.sim_time_s)
}

/// Returns the mean of 1/T; a run that never reached its target counts 0.
fn performance(times_s: &[Option<f64>]) -> f64 {
    let parts = times_s.iter().map(|time_s| time_s.map_or(0.0, f64::recip));
    parts.sum::<f64>() / times_s.len() as f64
}

/// Returns how many runs reached their target, and their mean time.
fn reached(times_s: &[Option<f64>]) -> (usize, Option<f64>) {
    let times: Vec<f64> = times_s.iter().copied().flatten().collect();
    let sum: f64 = times.iter().sum();
    (
        times.len(),
        (!times.is_empty()).then(|| sum / times.len() as f64),
    )
}

#[test]
fn the_enhanced_field_leads_where_the_plain_one_fails() {
    let worlds = PAPER[..2]
        .iter()
        .map(|paper| (paper, worlds::builtin(paper.world)));
    for (paper, world) in worlds {
        let run = |strategy| {
            go(&Job {
                world: &world,
                until_permille: paper.until_permille,
                strategy,
                impatience_s: None,
                tuning: &Tuning::DEFAULT,
                seed: 0,
            })
        };
        let (plain, enhanced) = (run("sbpf"), run("esbpf"));
        let failed = ["trapped", "nothing-attracts"];
        assert!(
            failed.contains(&plain.outcome.reason.as_str()),
            "{:?}",
            plain.outcome
        );
        assert!(plain.coverage.fraction < 0.9, "{}", paper.world);
        assert_eq!(enhanced.outcome.reason, "covered", "{}", paper.world);
        assert!(
            performance(&[covered_s(&enhanced)]) >= paper.esbpf[0],
            "{}",
            paper.world
        );
    }
}

#[test]
fn a_patient_field_explores_everything() {
    let world = worlds::builtin("office");
    let report = runs::Run::first(&world, "esbpf").go();
    assert_eq!(runs::faults(&report, 0.98), Vec::<String>::new());
}

mod full {
    use core::ops::Range;

    use super::*;

    /// Seeds with which the constants were chosen, and others, with which the result is stated.
    const CHOSEN_ON: Range<u64> = 0..10;
    const HELD_OUT: Range<u64> = 10..20;

    /// Times of runs to their target, and how often they touched something.
    type Outcomes = (Vec<Option<f64>>, u32);

    /// Weights of a peer's track, which only two robots show.
    const PEERS: [&str; 6] = [
        "sbpf.peer=0",
        "sbpf.peer=0.1",
        "sbpf.peer=0.3",
        "sbpf.peer=1",
        "sbpf.peer=3",
        "sbpf.peer=10",
    ];

    /// Constants that the paper does not give, and its own, at other values.
    const VARIANTS: [&str; 16] = [
        "",
        "sbpf.cell=4",
        "sbpf.cell=6",
        "sbpf.cell=8",
        "sbpf.repulsion=0.1",
        "sbpf.repulsion=0.15",
        "sbpf.repulsion=0.25",
        "sbpf.repulsion=0.4",
        "sbpf.range_m=2",
        "sbpf.range_m=4",
        "sbpf.range_m=12",
        "sbpf.twist_rad=0",
        "sbpf.twist_rad=0.26",
        "sbpf.twist_rad=0.79",
        "sbpf.trapped_ms=30000",
        "sbpf.trapped_ms=120000",
    ];

    #[test]
    #[ignore = "takes minutes: 700 short runs; tests/run --full runs it"]
    fn the_papers_table() {
        let text = format!(
            "P = 1/T, seeds 10..20. T in seconds; the paper's unit is its time step, so the\n\
             difference compares unlike units.\n\
             Two robots start side by side; T is the first robot's. No run touches anything.\n\
             A run that never reaches its target counts P = 0.\n\n{}\n\
             Constants, forces only: runs of ten that reach the target, and their mean time, s.\n\
             Seeds 0..10: the defaults were chosen with these runs.\n\n{}\n\
             The same for two robots.\n\n{}",
            performances(),
            constants(&VARIANTS, alone),
            constants(&PEERS, in_pairs)
        );
        golden::compare("space-full.txt", &text);
    }

    fn performances() -> Table {
        let columns = [
            "world",
            "strategy",
            "robots",
            "until",
            "reached",
            "T s",
            "P",
            "paper",
            "difference",
        ];
        let mut table = Table::new(2, &columns);
        for (paper, robots) in PAPER.iter().flat_map(|paper| [(paper, 1), (paper, 2)]) {
            let world = worlds::builtin(paper.world);
            for (name, strategy, impatience_s, theirs) in [
                ("sbpf", "sbpf", NEVER, paper.sbpf[robots - 1]),
                (
                    "esbpf, forces only",
                    "esbpf",
                    NEVER,
                    Some(paper.esbpf[robots - 1]),
                ),
                ("esbpf", "esbpf", None, Some(paper.esbpf[robots - 1])),
            ] {
                let how = (strategy, impatience_s);
                let jobs = ten(&world, paper, how, &Tuning::DEFAULT, HELD_OUT);
                let (times_s, touches) = if robots == 1 {
                    alone(&jobs)
                } else {
                    in_pairs(&jobs)
                };
                let (count, time_s) = reached(&times_s);
                let ours = performance(&times_s);
                assert!(
                    robots == 2 || strategy == "sbpf" || ours >= paper.esbpf[0],
                    "{name} in {}",
                    paper.world
                );
                assert!(
                    theirs != Some(0.0) || count == 0,
                    "{name} in {}",
                    paper.world
                );
                assert_eq!(touches, 0, "{name} in {}", paper.world);
                table.row(vec![
                    paper.world.into(),
                    name.into(),
                    robots.to_string(),
                    format!("{:.2}", f64::from(paper.until_permille) / 1000.0),
                    format!("{count}/10"),
                    number(time_s, 1),
                    format!("{ours:.4}"),
                    number(theirs, 4),
                    number(theirs.map(|theirs| ours - theirs), 4),
                ]);
            }
        }
        table
    }

    fn constants(variants: &[&str], go: fn(&[Job<'_>]) -> Outcomes) -> Table {
        let columns = [
            "constant",
            "two-rooms",
            "s",
            "c-room",
            "s",
            "partition",
            "s",
        ];
        let mut table = Table::new(1, &columns);
        let worlds = PAPER.each_ref().map(|paper| worlds::builtin(paper.world));
        for &variant in variants {
            let mut tuning = Tuning::DEFAULT;
            if let Some((name, value)) = variant.split_once('=') {
                let value = value.parse().expect("a number");
                tuning.set(name, value).expect("a constant in its range");
            }
            let tuning: &'static Tuning = Box::leak(Box::new(tuning));
            let name = if variant.is_empty() {
                "defaults"
            } else {
                variant
            };
            let mut row = vec![name.into()];
            for (paper, world) in PAPER.iter().zip(&worlds) {
                let jobs = ten(world, paper, ("esbpf", NEVER), tuning, CHOSEN_ON);
                let (count, time_s) = reached(&go(&jobs).0);
                row.extend([format!("{count}/10"), number(time_s, 1)]);
            }
            table.row(row);
        }
        table
    }

    /// Makes runs of one robot; returns their times and how often they touched something.
    fn alone(jobs: &[Job<'_>]) -> Outcomes {
        let reports = in_parallel(jobs, go);
        let touches = reports.iter().map(|report| report.safety.collisions);
        (reports.iter().map(covered_s).collect(), touches.sum())
    }

    /// Makes runs of two robots; as [`alone`], touches of one another included.
    fn in_pairs(jobs: &[Job<'_>]) -> Outcomes {
        let reports = in_parallel(jobs, go_in_pair);
        let touches = reports.iter().map(|report| {
            let safety = &report.whole.safety;
            safety.collisions + safety.robot_contacts.unwrap_or(0)
        });
        (reports.iter().map(pair_covered_s).collect(), touches.sum())
    }

    /// Returns ten jobs.
    fn ten<'a>(
        world: &'a World,
        paper: &Paper,
        (strategy, impatience_s): (&'static str, Option<Option<u16>>),
        tuning: &'static Tuning,
        seeds: Range<u64>,
    ) -> Vec<Job<'a>> {
        let job = |seed: u64| Job {
            world,
            until_permille: paper.until_permille,
            strategy,
            impatience_s,
            tuning,
            seed,
        };
        seeds.map(job).collect()
    }

    /// Strategies of the second table.
    const STRATEGIES: [&str; 6] = [
        "esbpf",
        "frontier",
        "ouroboros",
        "tdbvp",
        "bvp",
        "greedy-frontier",
    ];
    #[test]
    #[ignore = "takes minutes: 60 runs; tests/run --full runs it"]
    fn every_strategy_in_flat_worlds() {
        let columns = [
            "world", "strategy", "ended", "known %", "T90 s", "T99 s", "end s", "path m",
        ];
        let mut table = Table::new(2, &columns);
        for name in worlds::EXPLORABLE.iter().chain(&worlds::SPACE) {
            let world = worlds::builtin(name);
            let runs = STRATEGIES.map(|strategy| runs::Run::first(&world, strategy));
            let reports = runs::sweep(&runs);
            for (run, report) in runs.iter().zip(&reports) {
                let coverage = &report.coverage;
                table.row(vec![
                    (*name).into(),
                    run.strategy.into(),
                    report.outcome.reason.clone(),
                    format!("{:.2}", 100.0 * coverage.fraction),
                    number(coverage.t90_s, 1),
                    number(coverage.t99_s, 1),
                    format!("{:.1}", report.sim_time_s),
                    format!("{:.1}", report.path_length_m),
                ]);
            }
        }
        golden::compare("space-worlds-full.txt", &table.to_string());
    }
}

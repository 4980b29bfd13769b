//! Ablation of the rules that close loops: each is left out in turn.

use std::sync::PoisonError;

use fieldline_protocol::message::{Command, Observation, Start, Strategy};
use fieldline_tests::golden;
use fieldline_tests::runs::{self, in_parallel};
use fieldline_tests::table::number;
use fieldline_tests::worlds;
use host_sim::link::correction::MapCorrection;
use host_sim::link::direct::Direct;
use host_sim::report::Report;
use host_sim::sim::Simulator;
use host_sim::slam::{LoopCloser, PoseGraph, Rules, SlamReport};
use host_sim::trial::mission::{Mission, OdometryProfile, explore_corrected};
use host_sim::trial::{Corrector, MapCopy};
use host_sim::world::World;

const WORLDS: [&str; 4] = [
    "ouroboros-a",
    "ouroboros-b",
    "ouroboros-d",
    "tdbvp-adjacent",
];
const SEEDS: u64 = 10;
/// Simulated time of a run, milliseconds.
const LIMIT_MS: u32 = 1_800_000;
/// Steps after a loop of the strategy in which loops are closed: 20 s, some 10 m of way.
const TOLD_STEPS: usize = 100;

/// What is left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Without {
    Nothing,
    RobustWeights,
    Agreement,
    LocatedStarts,
    HalfTheKeyframes,
    ClosuresUntilTold,
}

impl Without {
    const ALL: [(Self, &str); 6] = [
        (Self::Nothing, "(nothing)"),
        (Self::RobustWeights, "robust weights"),
        (Self::Agreement, "a second closure that agrees"),
        (Self::LocatedStarts, "the chip's pose as a start"),
        (Self::HalfTheKeyframes, "every second keyframe"),
        (
            Self::ClosuresUntilTold,
            "closures, except after the strategy's loops",
        ),
    ];

    fn graph(self, mission: &Mission, start: &Start) -> PoseGraph {
        let config = PoseGraph::config(LoopCloser::lasers(start), mission.motion());
        let mut config = config.expect("the robot has a laser");
        match self {
            Self::Nothing | Self::ClosuresUntilTold => {}
            Self::RobustWeights => config.rules.scaling = Rules::NEVER,
            Self::Agreement => config.rules.agreement = false,
            Self::LocatedStarts => config.rules.located = false,
            Self::HalfTheKeyframes => {
                config.key_m *= 2.0;
                config.key_rad *= 2.0;
            }
        }
        PoseGraph::with(config)
    }
}

/// Closes loops only in the steps after the strategy said that it had closed one.
struct WhenTold {
    closer: LoopCloser,
    loops: u16,
    left: usize,
}

impl Corrector for WhenTold {
    fn correct(
        &mut self,
        observation: &Observation,
        command: &Command,
        copy: &dyn MapCopy,
    ) -> Option<MapCorrection> {
        if command.loops.closed != self.loops {
            (self.loops, self.left) = (command.loops.closed, TOLD_STEPS);
        }
        self.closer.set_closing(self.left > 0);
        self.left = self.left.saturating_sub(1);
        self.closer.correct(observation, command, copy)
    }
}

/// Makes a run.
fn run(world: &World, seed: u64, without: Without) -> Report {
    let mission = Mission {
        strategy: "ouroboros".into(),
        seed,
        start: seed as usize % world.starts().len(),
        odometry: OdometryProfile::Papers,
        localise: true,
        time_limit_ms: LIMIT_MS,
        ..Mission::default()
    };
    let simulator = Simulator::new(world, mission.sim_config()).expect("the start is free");
    let start = simulator.start_message(Strategy::default());
    let graph = without.graph(&mission, &start);
    let closer = LoopCloser::with(&start, graph);
    let mut told = WhenTold {
        closer,
        loops: 0,
        left: 0,
    };
    let corrector: &mut dyn Corrector = match without {
        Without::ClosuresUntilTold => &mut told,
        _ => &mut told.closer,
    };
    let outcome = explore_corrected(&mission, world, &mut Direct::new(), &mut (), corrector);
    let (mut report, _) = outcome.expect("the run begins");
    report.slam = Some(told.closer.report());
    report
}

/// Returns a row of the table. `all` are the same runs with all rules.
fn row(name: &str, reports: &[&Report], all: &[&Report]) -> String {
    let mean =
        |of: &dyn Fn(&Report) -> Option<f64>, digits| number(runs::mean(reports, of), digits);
    let count =
        |of: fn(&SlamReport) -> usize| mean(&|report| Some(of(report.slam.as_ref()?) as f64), 1);
    let error_m = |report: &Report| report.localization.mean_error_m;
    let of_worlds = reports.chunks(SEEDS as usize).map(|world| {
        let error = runs::mean(world, error_m);
        format!(" {} |", number(error, 3))
    });
    let explored = reports.iter().filter(|report| report.explored()).count();
    let touches: u32 = reports.iter().map(|it| it.safety.collisions).sum();
    let worst = reports.iter().filter_map(|report| error_m(report));
    let pairs = reports.iter().zip(all);
    let worse = pairs.filter(|(report, all)| error_m(report) > error_m(all));
    format!(
        "| {name} | {explored} | {touches} |{} {} | {} | {} | {} | {} | {} | {} |\n",
        of_worlds.collect::<String>(),
        mean(&error_m, 3),
        worse.count(),
        number(worst.reduce(f64::max), 2),
        mean(&|report| report.localization.end_error_m, 3),
        count(|slam| slam.closed),
        count(|slam| slam.refused),
        count(|slam| slam.corrections),
    )
}

#[test]
#[ignore = "takes half an hour: 240 runs"]
fn closing() {
    let _guard = super::LOCK.lock().unwrap_or_else(PoisonError::into_inner);
    let worlds = worlds::builtins(&WORLDS);
    let each = Without::ALL.into_iter().flat_map(|(without, _)| {
        let seeds = worlds
            .iter()
            .flat_map(|world| (0..SEEDS).map(move |seed| (world, seed)));
        seeds.map(move |(world, seed)| (world, seed, without))
    });
    let each: Vec<(&World, u64, Without)> = each.collect();
    let reports = in_parallel(&each, |&(world, seed, without)| run(world, seed, without));
    let reports: Vec<&Report> = reports.iter().collect();
    let mut text = format!(
        "| left out | explored | touches | {} | error, m | worse | worst | at the end | closed \
         | refused | corrections |\n|{}\n",
        WORLDS.join(" | "),
        " --- |".repeat(10 + WORLDS.len()),
    );
    let parts = reports.chunks(WORLDS.len() * SEEDS as usize);
    for ((_, name), part) in Without::ALL.iter().zip(parts.clone()) {
        text += &row(name, part, parts.clone().next().unwrap_or_default());
    }
    golden::compare_with_docs("ablation-closing", &text);
}

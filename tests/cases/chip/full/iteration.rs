//! Cost of a step against the known area: constant for the planner, growing for a BVP exploration
//! over the full grid \[Jorge15, Fig. 6\].
//!
//! The planner's cost is counted in instructions on the emulated chip: skeleton, plan, window,
//! field. The full grid does not fit the chip. Its work is counted on the host in cells times
//! cycles. Each cell and cycle is charged with the instructions that a cell of the window takes on
//! the chip, because both solvers are of the same kind:
//!
//! ```text
//! k       = median of solve / (cycles · 61²)      over the planner's steps
//! cost    = k · cells · cycles                    of a step over the full grid, its field alone
//! ```
//!
//! The case compares with `golden/iteration.txt`. `BLESS=1` rewrites it and the plot,
//! `docs/iteration.svg`.

use std::path::Path;

use fieldline_protocol::message::{Command, Observation};
use fieldline_tests::emulator::{chip, image};
use fieldline_tests::loops::OUROBOROS;
use fieldline_tests::plot::{Series, svg};
use fieldline_tests::table::Table;
use fieldline_tests::watched::Watched;
use fieldline_tests::{golden, worlds};
use host_sim::baseline::{Bvp, Session};
use host_sim::link::Link;
use host_sim::trial::mission::{Mission, explore};
use host_sim::trial::{Flow, Progress, Step, Watch};
use host_sim::world::World;

/// The environments of \[Jorge15\].
const WORLDS: [&str; 4] = ["ouroboros-a", "ouroboros-b", "ouroboros-c", "ouroboros-d"];
/// Width of a bin of known area, square metres.
const BIN_M2: f64 = 40.0;
/// Cells of the planner's window.
const WINDOW_CELLS: f64 = 61.0 * 61.0;
/// Share by which figures may differ: compilers arrange the code differently.
const DRIFT: f64 = 0.05;

/// Shares known after each step.
struct Gauge(Vec<f64>);

impl Watch for Gauge {
    fn step(&mut self, progress: &Progress) -> Flow {
        self.0.push(progress.coverage);
        Flow::Continue
    }
}

/// Explores over the full grid; returns the known area after each step, and its cells times cycles.
fn metered(world: &World) -> Vec<Point> {
    let session = Session::new(Bvp::new());
    let mut before = session.strategy.work();
    let mut works = Vec::new();
    let look = |session: &mut Session<Bvp>, _: &Observation, _: &Command| {
        let after = session.strategy.work();
        let cells = (after.cells - before.cells) as f64;
        works.push(cells * (after.cycles - before.cycles) as f64);
        before = after;
        Ok(())
    };
    let mut link = Watched::new(session, look);
    let run = explored(world, "bvp", &mut link);
    run.iter()
        .map(|(known_m2, _)| *known_m2)
        .zip(works)
        .collect()
}

/// Known area, m², and cost of a step.
type Point = (f64, f64);

/// Explores; returns the steps with the known area after each, m².
fn explored(world: &World, strategy: &str, link: &mut dyn Link) -> Vec<(f64, Step)> {
    let mission = Mission {
        strategy: strategy.into(),
        ..Mission::default()
    };
    let mut gauge = Gauge(Vec::new());
    let run = explore(&mission, world, link, &mut gauge).expect("the start is free");
    let (report, record) = run;
    assert!(report.explored(), "{}: {:?}", world.name(), report.outcome);
    let known = gauge
        .0
        .iter()
        .map(|share| share * report.coverage.explorable_m2);
    known.zip(record.steps).collect()
}

/// Returns the instructions of a step's planning, millions.
fn planning(step: &Step) -> f64 {
    let stages = step.command.cost.stages;
    f64::from(stages.topology + stages.plan + stages.window + stages.solve) / 1e6
}

/// Returns the instructions of a cell in a cycle.
fn per_cell(steps: &[(f64, Step)]) -> f64 {
    let costs = steps.iter().map(|(_, step)| step.command.cost);
    let solved = costs.filter(|cost| cost.cycles > 0);
    let mut shares: Vec<f64> = solved
        .map(|cost| f64::from(cost.stages.solve) / f64::from(cost.cycles) / WINDOW_CELLS)
        .collect();
    shares.sort_by(f64::total_cmp);
    shares[shares.len() / 2]
}

/// Returns area, steps, mean and most of each bin; bins with fewer than 20 steps are left out.
fn bins(points: &[Point]) -> Vec<[f64; 4]> {
    let bin = |known_m2: f64| (known_m2 / BIN_M2) as usize;
    let last = points.iter().map(|point| bin(point.0)).max().unwrap_or(0);
    let costs = |k: usize| {
        let inside = points.iter().filter(move |point| bin(point.0) == k);
        inside.map(|point| point.1)
    };
    (0..=last)
        .filter(|&k| costs(k).count() >= 20)
        .map(|k| {
            let count = costs(k).count() as f64;
            let mean = costs(k).sum::<f64>() / count;
            let most = costs(k).fold(0.0, f64::max);
            [(k as f64 + 0.5) * BIN_M2, count, mean, most]
        })
        .collect()
}

#[test]
#[ignore = "needs the image and QEMU, and takes long; tests/run --full runs it"]
fn a_step_costs_the_same_however_much_is_known() {
    let image = image();
    let (mut ours, mut steps, mut grid): (Vec<Point>, _, Vec<Point>) = Default::default();
    let mut works: Vec<Point> = Vec::new();
    for world in WORLDS.map(worlds::builtin) {
        let run = explored(&world, OUROBOROS, &mut chip(&image));
        ours.extend(
            run.iter()
                .map(|(known_m2, step)| (*known_m2, planning(step))),
        );
        Vec::extend(&mut steps, run);
        works.extend(metered(&world));
    }
    let k = per_cell(&steps);
    grid.extend(
        works
            .iter()
            .map(|(known_m2, work)| (*known_m2, k * work / 1e6)),
    );
    let (ours, grid) = (bins(&ours), bins(&grid));
    golden::compare_about("iteration.txt", &text(k, &ours, &grid), DRIFT);
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/iteration.svg");
    golden::bless(&path, &plot(&ours, &grid));
    assert_flat(&ours);
    assert_growing(&grid);
}

/// Asserts that the means of all bins lie within a factor of 1.5.
fn assert_flat(bins: &[[f64; 4]]) {
    let means = || bins.iter().map(|bin| bin[2]);
    let (least, most) = (
        means().fold(f64::MAX, f64::min),
        means().fold(0.0, f64::max),
    );
    assert!(most < 1.5 * least, "from {least} to {most} M");
}

/// Asserts that the last third of the bins costs more than twice the first third.
fn assert_growing(bins: &[[f64; 4]]) {
    let third = bins.len().div_ceil(3);
    let mean = |bins: &[[f64; 4]]| bins.iter().map(|bin| bin[2]).sum::<f64>() / bins.len() as f64;
    let (first, last) = (mean(&bins[..third]), mean(&bins[bins.len() - third..]));
    assert!(last > 2.0 * first, "from {first} to {last} M");
}

fn text(k: f64, ours: &[[f64; 4]], grid: &[[f64; 4]]) -> String {
    let columns = ["known m2", "steps", "mean M", "most M"];
    let table = |bins: &[[f64; 4]]| {
        let mut table = Table::new(0, &columns);
        for [known_m2, count, mean, most] in bins {
            table.row(vec![
                format!("{known_m2:.0}"),
                format!("{count:.0}"),
                format!("{mean:.3}"),
                format!("{most:.3}"),
            ]);
        }
        table
    };
    format!(
        "Millions of instructions of a step. ouroboros, on the chip: \
         skeleton, plan, window, field.\n\n\
         {}\nbvp, full grid: field alone, at {k:.1} instructions a cell and cycle.\n\n{}",
        table(ours),
        table(grid)
    )
}

fn plot(ours: &[[f64; 4]], grid: &[[f64; 4]]) -> String {
    let line = |bins: &[[f64; 4]], of: usize| bins.iter().map(|bin| [bin[0], bin[of]]).collect();
    let series = |name, colour, dashed, points| Series {
        name,
        colour,
        dashed,
        points,
    };
    let (blue, red) = ("#1f6fb2", "#c01f2e");
    svg(
        "What a step costs against what is known, worlds ouroboros-a to -d",
        ["known area, m²", "million instructions"],
        &[
            series(
                "bvp over the full grid, field alone: mean",
                red,
                false,
                line(grid, 2),
            ),
            series("the most of any step", red, true, line(grid, 3)),
            series(
                "ouroboros on the chip, all of planning: mean",
                blue,
                false,
                line(ours, 2),
            ),
            series("the most of any step", blue, true, line(ours, 3)),
        ],
    )
}

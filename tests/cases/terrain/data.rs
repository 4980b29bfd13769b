//! Uneven worlds drawn by others, which `FIELDLINE_DATA` names: `golden/terrain-data.txt`.

use fieldline_tests::history::History;
use fieldline_tests::runs::in_parallel;
use fieldline_tests::table::Table;
use fieldline_tests::uneven::{self, Summary, UnevenRun};
use fieldline_tests::{golden, truth, worlds};
use host_sim::report::MapCell;
use host_sim::world::World;

use crate::shared::{assert_explored, watch};

/// Seeds of every world.
const SEEDS: u64 = 10;
/// A world of open ground, whose slopes are all gentle, with no barrier except the wall around it.
const OPEN_GROUND: &str = "mvsim_mesh1";
/// Most per cent of its cells that are ever taken for a barrier.
const MOST_BARRIERS: f64 = 0.5;

/// Returns per cent of the cells with ground that the map ever held as a barrier: of all such
/// cells, and of those with ground on all sides. The world ends in a wall, which beams and heights
/// put into the cells beside it as well.
fn barriers(history: &History, world: &World) -> [f64; 2] {
    let is_ground = |x: i32, y: i32| {
        let [x_m, y_m] = [x, y].map(|k| (f64::from(k) + 0.5) * 0.1);
        !world.is_solid(x_m, y_m) && world.ground_m(x_m, y_m).is_some()
    };
    let around = || (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy)));
    let is_clear = |[x, y]: [i32; 2]| around().all(|(dx, dy)| is_ground(x + dx, y + dy));
    let all = [MapCell::Free, MapCell::Obstacle, MapCell::NegativeObstacle];
    let count = |classes: &[MapCell], holds: &dyn Fn([i32; 2]) -> bool| {
        history.ever(classes).filter(|&cell| holds(cell)).count() as f64
    };
    let share = |holds: &dyn Fn([i32; 2]) -> bool| {
        100.0 * count(&all[1..], holds) / count(&all, holds).max(1.0)
    };
    [share(&|[x, y]| is_ground(x, y)), share(&is_clear)]
}

#[test]
#[ignore = "needs worlds drawn by others (FIELDLINE_DATA) and takes hours"]
fn uneven_worlds_drawn_by_others() {
    let worlds = worlds::uneven_drawn_by_others();
    let to_run: Vec<UnevenRun<'_>> = worlds
        .iter()
        .flat_map(|world| (0..SEEDS).map(|seed| UnevenRun::of(world, 0, seed)))
        .collect();
    let watched = in_parallel(&to_run, |run| {
        let (summary, _, history) = watch(run);
        (summary, barriers(&history, run.world))
    });
    let mut ever = Table::new(
        1,
        &[
            "world",
            "seed",
            "cells ever a barrier %",
            "clear of walls and holes %",
            "beyond the limits s",
        ],
    );
    for (summary, [all, clear]) in &watched {
        let report = &summary.report;
        ever.row(vec![
            report.world.clone(),
            report.seed.to_string(),
            format!("{all:.3}"),
            format!("{clear:.3}"),
            format!(
                "{:.1}",
                report.true_ground.unwrap_or_default().over_limits_s
            ),
        ]);
    }
    let (runs, shares): (Vec<Summary>, Vec<[f64; 2]>) = watched.into_iter().unzip();
    let text = format!(
        "Means.\n\n{}\nEvery run.\n\n{}\n{ever}\n{}",
        uneven::means(&runs),
        uneven::table(&runs),
        truth::text(&runs)
    );
    golden::compare_runs("terrain-data", &text, &uneven::digests(&runs));
    assert_explored(&runs);
    for (summary, [all, _]) in runs.iter().zip(&shares) {
        let (world, seed) = (&summary.report.world, summary.report.seed);
        assert!(
            world != OPEN_GROUND || *all < MOST_BARRIERS,
            "{world} seed {seed}: {all} % were ever a barrier"
        );
    }
}

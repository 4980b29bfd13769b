//! Whole explorations of uneven ground: what must hold of every run, and golden tables of how each went.
//!
//! | golden file | what | when |
//! | --- | --- | --- |
//! | `terrain.txt` | every built-in uneven world once; the slope without preferences beside | always |
//! | `truth.txt` | the maps of these runs against the true ground, class by class | always |
//! | `terrain-full.txt` | ten seeds of every world; of the holes ten seeds of ten starts | `tests/run --full` |
//! | `terrain-slope.txt` | scenario 1 with preferences and without, ten starts and three seeds, compared by signed ranks | `--full` |
//! | `truth-noise.txt` | the maps under worse and worse noise | `--full` |
//! | `terrain-data.txt` | uneven worlds drawn by others, where there are any | `--full` |
//!
//! The read-me shows a part of `terrain.txt`. A changed row is a changed behaviour.

use core::fmt::Write as _;

use fieldline_protocol::message::Preference;
use fieldline_tests::history::{History, Watcher};
use fieldline_tests::runs::{self, explored, in_parallel};
use fieldline_tests::table::{Table, number};
use fieldline_tests::uneven::{self, Told, Tour, word};
use fieldline_tests::watched::Watched;
use fieldline_tests::wilcoxon::signed_rank;
use fieldline_tests::{full, golden, worlds};
use host_sim::link::direct::Direct;
use host_sim::report::MapCell;
use host_sim::world::World;

/// Share of what can be reached that must be known at the end.
const LEAST_COVERAGE: f64 = 0.97;
/// Seeds of every world in the full table.
const SEEDS: usize = 10;
/// A world drawn by others without a barrier but the wall around it, and per cent of its cells that may ever be taken for one.
const OPEN_GROUND: &str = "mvsim_mesh1";
const MOST_BARRIERS: f64 = 0.5;
/// Seeds of every start in the comparison of preferences.
const SLOPE_SEEDS: u64 = 3;
/// A run with preferences crosses the big slope no more often: there, and back to what was left.
const MOST_CROSSINGS: u32 = 2;
/// Of a difference between runs with and without, the probability that chance alone makes it as large must be less.
const SIGNIFICANT: f64 = 0.05;

/// Up to this standard deviation of roll and pitch every world must be explored and its map be right, degrees.
const MOST_NOISE_DEG: f64 = 1.0;

fn builtins() -> Vec<World> {
    worlds::UNEVEN.map(worlds::builtin).into()
}

fn explore(tours: &[Tour<'_>]) -> Vec<Told> {
    in_parallel(tours, Tour::go)
}

fn assert_explored(runs: &[Told]) {
    let mut list = String::new();
    for Told { report, .. } in runs {
        for fault in runs::faults(report, LEAST_COVERAGE) {
            let (world, start, seed) = (&report.world, report.start, report.seed);
            let _ = writeln!(list, "{world} start {start} seed {seed}: {fault}");
        }
    }
    assert!(list.is_empty(), "\n{list}");
}

/// Maps against the true ground.
fn truths(runs: &[Told]) -> String {
    format!(
        "Shares of cells, P: of those that the map says; R: of those that are.\n\n{}\nCells of all worlds.\n\n{}",
        uneven::truths(runs),
        uneven::confusion(runs)
    )
}

/// Least shares over all worlds.
fn assert_classified(runs: &[Told]) {
    let all = runs
        .iter()
        .map(|run| run.truth)
        .reduce(|a, b| a + b)
        .expect("there were runs");
    for (score, name, precision, recall) in [
        (all.traversable, "free", 0.97, 0.95),
        (all.obstacle, "obstacle", 0.97, 0.90),
        (all.negative, "negative", 0.80, 0.95),
    ] {
        assert!(score.precision >= Some(precision), "{name}: {score:?}");
        assert!(score.recall >= Some(recall), "{name}: {score:?}");
    }
}

#[test]
fn uneven_worlds_are_explored_and_nothing_is_touched() {
    let worlds = builtins();
    let mut tours: Vec<Tour<'_>> = worlds.iter().map(|world| Tour::of(world, 0, 0)).collect();
    let plain = Tour {
        preference: Preference::Off,
        ..tours[0]
    };
    tours.insert(1, plain);
    let mut runs = explore(&tours);
    golden::compare("terrain.txt", &uneven::table(&runs).to_string());
    assert_explored(&runs);
    runs.remove(1);
    golden::compare("truth.txt", &truths(&runs));
    golden::compare_with_readme("uneven", &uneven::markdown(&runs));
    assert_classified(&runs);
}

#[test]
fn every_world_with_ten_seeds_and_the_holes_from_every_start() {
    if !full() {
        return println!("skipped: FIELDLINE_FULL=1 or tests/run --full asks for it");
    }
    let worlds = builtins();
    let mut tours = Vec::new();
    for world in &worlds {
        let starts = world.starts().len();
        for seed in 0..SEEDS {
            if world.name() == "holes" {
                tours.extend((0..starts).map(|start| Tour::of(world, start, seed as u64)));
            } else {
                // One after the other, so that every start has its turn.
                tours.push(Tour::of(world, seed % starts, seed as u64));
            }
        }
    }
    let runs = explore(&tours);
    let text = format!(
        "Means.\n\n{}\nEvery run.\n\n{}",
        uneven::means(&runs),
        uneven::table(&runs)
    );
    golden::compare("terrain-full.txt", &text);
    assert_explored(&runs);
}

/// Pairs of runs that differ in their preferences only.
struct Pairs<'a> {
    with: &'a [Told],
    without: &'a [Told],
}

impl Pairs<'_> {
    fn differences(&self, of: Quantity) -> Vec<f64> {
        let pairs = self.with.iter().zip(self.without);
        pairs
            .map(|(with, without)| of(without) - of(with))
            .collect()
    }

    /// What preferences are for: no run with them crosses the slope more than there and back, and they cross it less than
    /// runs without.
    fn assert_crossed_less(&self) {
        let too_often = self
            .with
            .iter()
            .filter(|run| run.crossings > MOST_CROSSINGS);
        let too_often: Vec<_> = too_often
            .map(|run| (run.report.start, run.report.seed, run.crossings))
            .collect();
        assert!(
            too_often.is_empty(),
            "start, seed, crossings: {too_often:?}"
        );
        let crossings: Quantity = |run| f64::from(run.crossings);
        let [with, without] = [self.with, self.without].map(|runs| mean(runs, crossings));
        let p = signed_rank(&self.differences(crossings)).p_greater;
        assert!(
            with < without && p < SIGNIFICANT,
            "{with} {without}, p = {p}"
        );
    }

    /// One line for each quantity.
    fn table(&self) -> Table {
        let columns = [
            "quantity",
            "mean with",
            "mean without",
            "pairs that differ",
            "W+",
            "p: less with",
            "p: more with",
        ];
        let mut table = Table::new(1, &columns);
        for (name, of) in QUANTITIES {
            let test = signed_rank(&self.differences(of));
            table.row(vec![
                name.into(),
                number(Some(mean(self.with, of)), 2),
                number(Some(mean(self.without, of)), 2),
                test.pairs.to_string(),
                format!("{:.1}", test.positive),
                format!("{:.4}", test.p_greater),
                format!("{:.4}", test.p_less),
            ]);
        }
        table
    }
}

/// A number of a run.
type Quantity = fn(&Told) -> f64;

fn mean(runs: &[Told], of: Quantity) -> f64 {
    runs.iter().map(of).sum::<f64>() / runs.len() as f64
}

/// What is compared.
const QUANTITIES: [(&str, Quantity); 4] = [
    ("crossings", |run| f64::from(run.crossings)),
    ("climb m", |run| run.report.climb_m),
    ("path m", |run| run.report.path_length_m),
    ("time s", |run| run.report.sim_time_s),
];

#[test]
fn preferences_on_the_big_slope() {
    if !full() {
        return println!("skipped: FIELDLINE_FULL=1 or tests/run --full asks for it");
    }
    let world = worlds::builtin("slope");
    let mut tours = Vec::new();
    for preference in [Preference::Both, Preference::Off] {
        for start in 0..world.starts().len() {
            tours.extend((0..SLOPE_SEEDS).map(|seed| Tour {
                preference,
                ..Tour::of(&world, start, seed)
            }));
        }
    }
    let runs = explore(&tours);
    let (with, without) = runs.split_at(runs.len() / 2);
    let pairs = Pairs { with, without };
    let mut counts = Table::new(1, &["crossings", "0", "1", "2", "3", "4", "5 and more"]);
    for half in [with, without] {
        let mut row = vec![word(half[0].preference).to_owned()];
        let of = |k: u32| half.iter().filter(|run| run.crossings.min(5) == k).count();
        row.extend((0..=5).map(|k| of(k).to_string()));
        counts.row(row);
    }
    let text = format!(
        "Means.\n\n{}\nRuns by their crossings.\n\n{counts}\nSigned ranks of the pairs' differences, without less with.\n\n{}\nEvery run.\n\n{}",
        uneven::means(&runs),
        pairs.table(),
        uneven::table(&runs)
    );
    golden::compare("terrain-slope.txt", &text);
    // How often a run without preferences comes to its end is a result, in the table.
    assert_explored(with);
    pairs.assert_crossed_less();
}

#[test]
fn maps_under_worse_and_worse_noise() {
    if !full() {
        return println!("skipped: FIELDLINE_FULL=1 or tests/run --full asks for it");
    }
    let worlds = builtins();
    let mut text = String::new();
    let mut maps = Vec::new();
    for noise in [
        [0.01, 1.0],
        [0.03, 0.0],
        [0.03, 1.0],
        [0.03, 1.5],
        [0.03, 2.0],
    ] {
        let tours: Vec<Tour<'_>> = worlds
            .iter()
            .map(|world| Tour {
                noise: Some(noise),
                ..Tour::of(world, 0, 0)
            })
            .collect();
        let runs = explore(&tours);
        let [laser_m, degrees] = noise;
        let _ = write!(
            text,
            "Ranges {:.0} cm, attitude {degrees} degrees.\n\n{}\n{}\n",
            100.0 * laser_m,
            uneven::table(&runs),
            truths(&runs)
        );
        // Where it breaks beyond is a result, in the table.
        if degrees <= MOST_NOISE_DEG {
            maps.push(runs);
        }
    }
    golden::compare("truth-noise.txt", &format!("{}\n", text.trim_end()));
    for runs in &maps {
        assert_explored(runs);
        assert_classified(runs);
    }
}

/// Of the cells with ground that the map ever held, those that ever were an obstacle or negative, in percent: all, and those with nothing
/// but ground around them. The world ends in a wall, which beams and heights put into the cells beside it as well.
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
fn uneven_worlds_drawn_by_others() {
    if !full() {
        return println!("skipped: FIELDLINE_FULL=1 or tests/run --full asks for it");
    }
    let Some(worlds) = worlds::uneven_drawn_by_others() else {
        return;
    };
    let seeds = 0..SEEDS as u64;
    let tours: Vec<Tour<'_>> = worlds
        .iter()
        .flat_map(|world| seeds.clone().map(|seed| Tour::of(world, 0, seed)))
        .collect();
    let watched = in_parallel(&tours, |tour| {
        let mut watcher = Watcher::new();
        let mut link = Watched::new(Direct::new(), |link, observation, _| {
            watcher.look(link, observation)
        });
        let (report, record) = explored(&tour.mission(), tour.world, &mut link);
        let shares = barriers(&watcher.history, tour.world);
        (tour.told(report, &record), shares)
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
    for (told, [all, clear]) in &watched {
        let report = &told.report;
        ever.row(vec![
            report.world.clone(),
            report.seed.to_string(),
            format!("{all:.3}"),
            format!("{clear:.3}"),
            format!("{:.1}", report.terrain.unwrap_or_default().over_limits_s),
        ]);
    }
    let (runs, shares): (Vec<Told>, Vec<[f64; 2]>) = watched.into_iter().unzip();
    let text = format!(
        "Means.\n\n{}\nEvery run.\n\n{}\n{ever}\n{}",
        uneven::means(&runs),
        uneven::table(&runs),
        truths(&runs)
    );
    golden::compare("terrain-data.txt", &text);
    assert_explored(&runs);
    // Open ground, whose slopes are all gentle.
    for (told, [all, _]) in runs.iter().zip(&shares) {
        let (world, seed) = (&told.report.world, told.report.seed);
        assert!(
            world != OPEN_GROUND || *all < MOST_BARRIERS,
            "{world} seed {seed}: {all} % were ever a barrier"
        );
    }
}

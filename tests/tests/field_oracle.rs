//! The solver against the f64 truth, over seeded windows: how many cycles until the robot's heading is right, until
//! the whole field is, and until the solver says so; cold, and warm on a walk. Gauss–Seidel beside it.
//!
//! *Right* is within 5° of the truth, now and at every later look. A *field* is right when 99 % of its cells are and none
//! of them is a local minimum. The tables are in `golden/field.txt`; `BLESS=1` rewrites it.

#[allow(dead_code, reason = "each test file uses a part of it")]
mod field_common;

use core::fmt::Write;

use field_common::golden::compare_with_golden;
use field_common::oracle::Truth;
use field_common::scenes::{
    CHANGES, Change, KINDS, Kind, Pull, Scene, WALK_STEPS, Walk, before_and_after, scene,
};
use field_common::{Random, cells, degrees_between};
use fieldline_planner::field::descent;
use fieldline_planner::field::{
    GOAL, Method, SCRATCH_FLOATS, SIDE, Solution, SolverConfig, Stop, Window, solve,
};

/// Windows of each kind, with and without preferences.
const WINDOWS: u64 = 30;

/// Error that still counts as right, degrees.
const TOLERANCE_DEG: f64 = 5.0;

/// Cycles after which the multigrid has failed.
const CYCLE_LIMIT: u32 = 40;

/// Sweeps after which Gauss–Seidel has failed.
const SWEEP_LIMIT: u32 = 2000;

/// Looks at a field while it is being solved.
struct Judge {
    truth: Truth,
    robot: (usize, usize),
}

impl Judge {
    fn new(window: &Window, robot: (usize, usize)) -> Self {
        Self {
            truth: Truth::of(window),
            robot,
        }
    }

    fn heading_is_right(&self, window: &Window) -> bool {
        let (x, y) = self.robot;
        let truth = self.truth.heading(x, y);
        descent::heading(window, x, y)
            .is_some_and(|heading| degrees_between(f64::from(heading), truth) < TOLERANCE_DEG)
    }

    fn field_is_right(&self, window: &Window) -> bool {
        let (mut count, mut right) = (0, 0);
        for (x, y) in cells().filter(|&(x, y)| window.is_reached(x, y)) {
            if descent::ascend(window, x, y).is_none() {
                return false;
            }
            let q = |x: usize, y: usize| f64::from(window.q(x, y));
            let (gx, gy) = (
                q(x + 1, y) - q(x.wrapping_sub(1), y),
                q(x, y + 1) - q(x, y.wrapping_sub(1)),
            );
            let (tx, ty) = self.truth.gradient(x, y);
            let within = TOLERANCE_DEG.to_radians().cos() * gx.hypot(gy) * tx.hypot(ty);
            count += 1;
            right += u32::from(gx * tx + gy * ty >= within);
        }
        100 * right >= 99 * count
    }
}

/// When something became right for good.
#[derive(Clone, Copy, Default)]
struct Since(Option<u32>);

impl Since {
    fn look(&mut self, right: bool, now: u32) {
        self.0 = if right { self.0.or(Some(now)) } else { None };
    }
}

/// How one solve went, in cycles or sweeps.
#[derive(Default)]
struct Trial {
    heading: Since,
    field: Since,
    stop: Option<u32>,
    stopped_wrong: bool,
}

fn work(window: &mut Window, scratch: &mut Scratch, method: Method, cycles: u16) -> Solution {
    let config = SolverConfig {
        max_cycles: cycles,
        method,
        ..SolverConfig::default()
    };
    solve(window, scratch, &config)
}

type Scratch = [f32; SCRATCH_FLOATS];

fn multigrid(window: &mut Window, judge: &Judge, scratch: &mut Scratch) -> Trial {
    let mut trial = Trial::default();
    for cycle in 1..=CYCLE_LIMIT {
        let solution = work(window, scratch, Method::Multigrid, 1);
        let right = judge.field_is_right(window);
        trial.heading.look(judge.heading_is_right(window), cycle);
        trial.field.look(right, cycle);
        if solution.stop == Stop::Converged && trial.stop.is_none() {
            trial.stop = Some(cycle);
            trial.stopped_wrong = !right;
        }
    }
    trial
}

fn gauss_seidel(window: &mut Window, judge: &Judge, scratch: &mut Scratch) -> Trial {
    let mut trial = Trial::default();
    let mut sweeps = 0;
    while sweeps < SWEEP_LIMIT && trial.stop.is_none() {
        let solution = work(window, scratch, Method::GaussSeidel, 1);
        sweeps += u32::from(solution.sweeps);
        let stopped = solution.stop == Stop::Converged;
        trial.heading.look(judge.heading_is_right(window), sweeps);
        if stopped || sweeps % 20 == 0 {
            let right = judge.field_is_right(window);
            trial.field.look(right, sweeps);
            trial.stop = stopped.then_some(sweeps);
            trial.stopped_wrong = stopped && !right;
        }
    }
    trial
}

/// Median, 95th percentile and greatest; `-` where one of that rank never came.
struct Ranks([Option<u32>; 3]);

impl Ranks {
    fn of(values: impl Iterator<Item = Option<u32>>) -> Self {
        let mut values: Vec<u32> = values.map(|value| value.unwrap_or(u32::MAX)).collect();
        values.sort_unstable();
        let rank = |part: usize| values[((values.len() * part).div_ceil(100)).saturating_sub(1)];
        Self([50, 95, 100].map(|part| Some(rank(part)).filter(|&value| value < u32::MAX)))
    }

    fn at_most(&self, limits: [u32; 3]) -> bool {
        self.0
            .iter()
            .zip(limits)
            .all(|(value, limit)| value.is_some_and(|value| value <= limit))
    }
}

impl core::fmt::Display for Ranks {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        for value in self.0 {
            match value {
                Some(value) => write!(f, "{value:>5}")?,
                None => write!(f, "{:>5}", "-")?,
            }
        }
        Ok(())
    }
}

/// Both methods' trials over the same windows.
#[derive(Default)]
struct Row {
    multigrid: Vec<Trial>,
    gauss_seidel: Vec<Trial>,
}

impl Row {
    fn ranks(trials: &[Trial]) -> [Ranks; 3] {
        [
            Ranks::of(trials.iter().map(|trial| trial.heading.0)),
            Ranks::of(trials.iter().map(|trial| trial.field.0)),
            Ranks::of(trials.iter().map(|trial| trial.stop)),
        ]
    }

    fn failures(trials: &[Trial]) -> usize {
        let failed = |trial: &&Trial| trial.heading.0.is_none() || trial.field.0.is_none();
        trials.iter().filter(failed).count()
    }

    fn write(&self, out: &mut String, label: &str) {
        write!(out, "{label:<20}{:>4}", self.multigrid.len()).unwrap();
        for trials in [&self.multigrid, &self.gauss_seidel] {
            let [heading, field, stop] = Self::ranks(trials);
            let wrong = trials.iter().filter(|trial| trial.stopped_wrong).count();
            let failed = Self::failures(trials);
            write!(out, " |{heading} |{field} |{stop} |{wrong:>3}{failed:>3}").unwrap();
        }
        out.push('\n');
    }
}

const HEADER: &str = "                         | multigrid, cycles                                         | Gauss-Seidel, sweeps
                         | heading right  | field right    | stop rule      | no no | heading right  | field right    | stop rule      | no no
kind      pull         n |  p50  p95  max |  p50  p95  max |  p50  p95  max |  a  b |  p50  p95  max |  p50  p95  max |  p50  p95  max |  a  b
";

/// Every kind with and without preferences, each on its turn to `run`, on as many threads as there are processors.
fn table(run: impl Fn(Kind, Pull) -> Row + Sync) -> Vec<(Kind, Pull, Row)> {
    let pulls = [Pull::None, Pull::Heights];
    let all: Vec<_> = pulls
        .iter()
        .flat_map(|&pull| KINDS.map(|kind| (kind, pull)))
        .collect();
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let (run, all) = (&run, &all);
    std::thread::scope(|scope| {
        let lane = |lane: usize| {
            scope.spawn(move || {
                let mine = all.iter().skip(lane).step_by(threads);
                mine.map(|&(kind, pull)| (kind, pull, run(kind, pull)))
                    .collect::<Vec<_>>()
            })
        };
        let lanes: Vec<_> = (0..threads).map(lane).collect();
        let mut lanes: Vec<_> = lanes
            .into_iter()
            .map(|lane| lane.join().unwrap().into_iter())
            .collect();
        (0..all.len())
            .filter_map(|i| lanes[i % threads].next())
            .collect()
    })
}

fn write_table(rows: Vec<(Kind, Pull, Row)>) -> (String, [Row; 2]) {
    let mut out = HEADER.to_string();
    let mut sums = [Row::default(), Row::default()];
    for (kind, pull, row) in rows {
        row.write(&mut out, &format!("{:<10}{pull:?}", format!("{kind:?}")));
        let sum = &mut sums[pull as usize];
        sum.multigrid.extend(row.multigrid);
        sum.gauss_seidel.extend(row.gauss_seidel);
    }
    for (pull, sum) in [Pull::None, Pull::Heights].iter().zip(&sums) {
        sum.write(&mut out, &format!("all       {pull:?}"));
    }
    (out, sums)
}

fn cold(kind: Kind, pull: Pull) -> Row {
    let mut scratch = [0.0; SCRATCH_FLOATS];
    let mut row = Row::default();
    for seed in 0..WINDOWS {
        let Scene { robot, mut window } = scene(kind, pull, seed);
        let judge = Judge::new(&window, robot);
        row.gauss_seidel
            .push(gauss_seidel(&mut window.clone(), &judge, &mut scratch));
        row.multigrid
            .push(multigrid(&mut window, &judge, &mut scratch));
    }
    row
}

/// Each step starts from what the step before left after its stop rule or a dozen cycles. Gauss–Seidel on every fourth.
fn warm(kind: Kind, pull: Pull) -> Row {
    let mut scratch = [0.0; SCRATCH_FLOATS];
    let mut row = Row::default();
    let walk = Walk::new(kind, 0);
    let mut window = Window::new();
    for step in 0..=WALK_STEPS {
        walk.step(&mut window, step, pull);
        if step > 0 {
            let judge = Judge::new(&window, (SIDE / 2, SIDE / 2));
            if step % 4 == 0 {
                let trial = gauss_seidel(&mut window.clone(), &judge, &mut scratch);
                row.gauss_seidel.push(trial);
            }
            row.multigrid
                .push(multigrid(&mut window.clone(), &judge, &mut scratch));
        }
        work(&mut window, &mut scratch, Method::Auto, 12);
    }
    row
}

/// Headings on the walks when every step gets only two cycles: how many are right, of how many.
fn hasty(pull: Pull) -> (usize, usize) {
    let mut scratch = [0.0; SCRATCH_FLOATS];
    let mut right = 0;
    for kind in KINDS {
        let walk = Walk::new(kind, 0);
        let mut window = Window::new();
        walk.step(&mut window, 0, pull);
        work(&mut window, &mut scratch, Method::Auto, 12);
        for step in 1..=WALK_STEPS {
            walk.step(&mut window, step, pull);
            work(&mut window, &mut scratch, Method::Auto, 2);
            right +=
                usize::from(Judge::new(&window, (SIDE / 2, SIDE / 2)).heading_is_right(&window));
        }
    }
    (right, KINDS.len() * WALK_STEPS)
}

/// A solved field whose boundary changes under it; the robot is where it can still reach a goal.
fn disturbed(change: Change) -> Vec<Trial> {
    let mut scratch = [0.0; SCRATCH_FLOATS];
    let mut trials = Vec::new();
    for (kind, seed) in KINDS
        .into_iter()
        .flat_map(|kind| (0..20).map(move |seed| (kind, seed)))
    {
        let pull = if seed % 2 == 0 {
            Pull::None
        } else {
            Pull::Heights
        };
        let mut scene = scene(kind, pull, seed);
        let [before, after] = before_and_after(&scene, change, &mut Random::new(seed));
        scene.window.set_boundary(&before.0, &before.1);
        work(&mut scene.window, &mut scratch, Method::Auto, 12);
        scene.window.set_boundary(&after.0, &after.1);
        if scene.window.is_reached(scene.robot.0, scene.robot.1) {
            let judge = Judge::new(&scene.window, scene.robot);
            trials.push(multigrid(&mut scene.window, &judge, &mut scratch));
        }
    }
    trials
}

/// The boundary may change in any way without the warm start becoming worse than a cold one.
#[test]
fn a_changed_boundary_costs_no_more_than_a_cold_start() {
    let mut out = String::from(
        "\
Cycles of the multigrid after the boundary of a solved field changed; columns as in field.txt.

                     n | heading right  | field right    | stop rule      |  a  b
",
    );
    let mut all = Vec::new();
    for change in CHANGES {
        let trials = disturbed(change);
        let [heading, field, stop] = Row::ranks(&trials);
        let wrong = trials.iter().filter(|trial| trial.stopped_wrong).count();
        let (name, count, failed) = (format!("{change:?}"), trials.len(), Row::failures(&trials));
        writeln!(
            out,
            "{name:<18}{count:>4} |{heading} |{field} |{stop} |{wrong:>3}{failed:>3}"
        )
        .unwrap();
        all.push((heading, failed));
    }
    compare_with_golden("field_changes.txt", &out);
    for (heading, failed) in all {
        assert!(heading.at_most([3, 7, CYCLE_LIMIT]), "heading: {heading}");
        assert_eq!(failed, 0);
    }
}

#[test]
fn headings_and_fields_come_right_in_few_cycles() {
    let (cold_table, cold_sums) = write_table(table(cold));
    let (warm_table, warm_sums) = write_table(table(warm));
    let [(none, steps), (heights, _)] = [hasty(Pull::None), hasty(Pull::Heights)];
    compare_with_golden("field.txt", &format!("\
Cycles of the multigrid and sweeps of Gauss-Seidel until right within 5 degrees for good: the robot's heading; the
whole field (99 % of cells, no local minimum); and until the stop rule. a: stopped before the field was right;
b: never right ({CYCLE_LIMIT} cycles, {SWEEP_LIMIT} sweeps); -: too many for that rank.

Cold
{cold_table}
Warm, after a move of one cell (Gauss-Seidel: every fourth)
{warm_table}
Two cycles a step on the same walks: {none} of {steps} headings right without preferences, {heights} with.
"));

    for sum in &cold_sums {
        let [heading, field, _] = Row::ranks(&sum.multigrid);
        assert!(
            heading.at_most([3, 6, CYCLE_LIMIT]),
            "cold heading: {heading}"
        );
        assert!(
            field.at_most([8, CYCLE_LIMIT, CYCLE_LIMIT]),
            "cold field: {field}"
        );
        assert_eq!(Row::failures(&sum.multigrid), 0);
        assert!(sum.multigrid.len() >= 150);
    }
    for sum in &warm_sums {
        let [heading, ..] = Row::ranks(&sum.multigrid);
        assert!(
            heading.at_most([3, 3, CYCLE_LIMIT]),
            "warm heading: {heading}"
        );
        assert_eq!(Row::failures(&sum.multigrid), 0);
    }
}

#[test]
fn steepest_ascent_from_every_cell_ends_on_a_goal() {
    let mut scratch = [0.0; SCRATCH_FLOATS];
    for kind in KINDS {
        let mut window = scene(kind, Pull::Heights, 1).window;
        assert_eq!(
            work(&mut window, &mut scratch, Method::Auto, 60).stop,
            Stop::Converged
        );
        for start in cells().filter(|&(x, y)| window.is_reached(x, y)) {
            let mut at = start;
            while let Some(next) = descent::ascend(&window, at.0, at.1) {
                let goal = window.is_goal(next.0, next.1);
                assert!(goal || window.q(next.0, next.1) > window.q(at.0, at.1));
                at = next;
            }
            assert!(
                window.is_goal(at.0, at.1),
                "{kind:?}: from {start:?} the way ends at {at:?}"
            );
        }
    }
}

/// What the papers do: Gauss–Seidel on p itself, obstacles 1 and goals 0, in f32.
fn solve_p(window: &Window) -> Vec<f32> {
    const WIDTH: usize = SIDE + 2;
    let mut p = vec![1.0_f32; WIDTH * WIDTH];
    for (x, y) in cells().filter(|&(x, y)| window.is_goal(x, y)) {
        p[(y + 1) * WIDTH + x + 1] = 0.0;
    }
    for _ in 0..20_000 {
        let mut changed = false;
        for (x, y) in cells().filter(|&(x, y)| window.is_reached(x, y)) {
            let i = (y + 1) * WIDTH + x + 1;
            let (n, s, w, e) = (p[i + WIDTH], p[i - WIDTH], p[i - 1], p[i + 1]);
            let half = window.preference(x, y).get().to_num::<f32>() / 2.0;
            let next = ((n + s) + (w + e) - half * ((n - s).abs() + (w - e).abs())) / 4.0;
            changed |= next != p[i];
            p[i] = next;
        }
        if !changed {
            break;
        }
    }
    p
}

/// The same windows through p in f32 (converged to the last bit) and through q in f32: in p the field around the robot
/// has drowned in the rounding of numbers near 1.
#[test]
fn p_in_f32_fails_where_q_holds() {
    const WIDTH: usize = SIDE + 2;
    let mut scratch = [0.0; SCRATCH_FLOATS];
    let (mut lost_headings, mut lost_fields) = (0, 0);
    for (kind, seed) in [Kind::Rooms, Kind::Door]
        .into_iter()
        .flat_map(|k| (0..6).map(move |s| (k, s)))
    {
        let Scene { robot, mut window } = scene(kind, Pull::Heights, seed);
        let judge = Judge::new(&window, robot);
        work(&mut window, &mut scratch, Method::Auto, 60);
        assert!(
            judge.heading_is_right(&window) && judge.field_is_right(&window),
            "{kind:?} {seed}"
        );

        let p = solve_p(&window);
        let mut in_p = window.clone();
        in_p.clear();
        let gradient = |x: usize, y: usize| {
            let i = (y + 1) * WIDTH + x + 1;
            (
                f64::from(p[i - 1]) - f64::from(p[i + 1]),
                f64::from(p[i - WIDTH]) - f64::from(p[i + WIDTH]),
            )
        };
        let is_wrong = |x: usize, y: usize| {
            let (gx, gy) = gradient(x, y);
            let flat = gx == 0.0 && gy == 0.0;
            flat || degrees_between(gy.atan2(gx), judge.truth.heading(x, y)) > TOLERANCE_DEG
        };
        let reached: Vec<_> = cells().filter(|&(x, y)| window.is_reached(x, y)).collect();
        lost_headings += u32::from(is_wrong(robot.0, robot.1));
        let wrong = reached.iter().filter(|&&(x, y)| is_wrong(x, y)).count();
        lost_fields += u32::from(100 * wrong > reached.len());
    }
    println!("p in f32: {lost_headings} headings and {lost_fields} fields of 12 lost");
    assert!(
        lost_headings >= 3,
        "p in f32 lost only {lost_headings} of 12 headings"
    );
    assert!(
        lost_fields >= 6,
        "p in f32 lost only {lost_fields} of 12 fields"
    );
}

#[test]
fn values_converge_to_the_truth_and_the_goal_value_cancels() {
    let mut scratch = [0.0; SCRATCH_FLOATS];
    for (kind, pull) in KINDS
        .into_iter()
        .flat_map(|k| [(k, Pull::None), (k, Pull::Heights)])
    {
        let mut window = scene(kind, pull, 2).window;
        let truth = Truth::of(&window);
        let config = SolverConfig {
            max_cycles: 100,
            tolerance: 1e-4,
            method: Method::Multigrid,
        };
        solve(&mut window, &mut scratch, &config);
        for (x, y) in cells().filter(|&(x, y)| window.is_reached(x, y)) {
            let q = f64::from(window.q(x, y)) / f64::from(GOAL);
            let error = (q / truth.q(x, y) - 1.0).abs();
            assert!(
                error < 2e-3,
                "{kind:?} {pull:?} ({x}, {y}): q {q:e}, error {error:e}"
            );
        }
    }
}

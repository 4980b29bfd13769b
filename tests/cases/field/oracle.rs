//! The solver against the true field, over seeded windows: cycles until the robot's heading is
//! right, until the whole field is right, and until the stop rule; from a cold start, on a walk,
//! and after a change of the boundary. Gauss–Seidel for comparison.
//!
//! The tables are `golden/field.txt` and `golden/field_changes.txt`.

use core::fmt::Write as _;

use fieldline_planner::field::{Method, SCRATCH_FLOATS, SIDE, Window};
use fieldline_tests::field::floor::{KINDS, Kind};
use fieldline_tests::field::scenes::{CHANGES, Change, Pull, Scene, before_and_after, scene};
use fieldline_tests::field::walk::{WALK_STEPS, Walk};
use fieldline_tests::golden;
use fieldline_tests::random::Random;
use fieldline_tests::runs::in_parallel;

use crate::judge::{CYCLE_LIMIT, Judge, Row, SWEEP_LIMIT, Trial, gauss_seidel, multigrid, work};

/// Windows of each kind, with and without preferences.
const WINDOWS: u64 = 30;

/// Heading of the tables.
const HEADER: &str = concat!(
    "                         | multigrid, cycles                                         ",
    "| Gauss-Seidel, sweeps\n",
    "                         | heading right  | field right    | stop rule      | no no ",
    "| heading right  | field right    | stop rule      | no no\n",
    "kind      pull         n |  p50  p95  max |  p50  p95  max |  p50  p95  max |  a  b ",
    "|  p50  p95  max |  p50  p95  max |  p50  p95  max |  a  b\n",
);

/// Applies `run` to every kind of floor, without preferences and with them.
fn table(run: impl Fn(Kind, Pull) -> Row + Sync) -> Vec<(Kind, Pull, Row)> {
    let pulls = [Pull::None, Pull::Heights];
    let all: Vec<_> = pulls
        .iter()
        .flat_map(|&pull| KINDS.map(|kind| (kind, pull)))
        .collect();
    in_parallel(&all, |&(kind, pull)| (kind, pull, run(kind, pull)))
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

/// Each step starts from the field of the step before, after its stop rule or 12 cycles.
/// Gauss–Seidel solves every fourth step.
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

/// Counts right headings, and all, on walks whose steps get only two cycles each.
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

/// Changes the boundary of solved fields and solves again, if the robot can still reach a goal.
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
        let [before, after] = before_and_after(&scene, change, &mut Random::mixed(seed));
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
    golden::compare("field_changes.txt", &out);
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
    golden::compare(
        "field.txt",
        &format!(
            "\
Cycles of the multigrid and sweeps of Gauss-Seidel until right within 5 degrees for good: \
the robot's heading; the
whole field (99 % of cells, no local minimum); and until the stop rule. \
a: stopped before the field was right;
b: never right ({CYCLE_LIMIT} cycles, {SWEEP_LIMIT} sweeps); -: too many for that rank.

Cold
{cold_table}
Warm, after a move of one cell (Gauss-Seidel: every fourth)
{warm_table}
Two cycles a step on the same walks: {none} of {steps} headings right without preferences, \
{heights} with.
"
        ),
    );

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

//! Precision of the solved field: descent ends on a goal, q holds in f32 where p fails, and values
//! converge to the truth.

use fieldline_planner::field::{
    GOAL, Method, SCRATCH_FLOATS, SIDE, SolverConfig, Stop, Window, solve,
};
use fieldline_tests::field::floor::{KINDS, Kind};
use fieldline_tests::field::scenes::{Pull, Scene, scene};
use fieldline_tests::field::truth::Truth;
use fieldline_tests::field::{ascend, cells, degrees_between};

use crate::judge::{Judge, TOLERANCE_DEG, work};

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
            while let Some(next) = ascend(&window, at.0, at.1) {
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

/// Solves as the papers do: Gauss–Seidel on p itself in f32, obstacles 1 and goals 0.
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

/// Far from the goal p is near 1, and its rounding in f32, converged to the last bit, hides the
/// field. The planner's q = 1 − p is near 0 there and keeps its relative precision.
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

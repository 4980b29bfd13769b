//! The window and the solver's budget: cells without a goal, shifts, instalments, fallbacks, noise,
//! and the bits of the result.

use fieldline_planner::field::preference::p_diff;
use fieldline_planner::field::{
    GOAL, Method, Preference, SCRATCH_FLOATS, SIDE, SolverConfig, Stop, Window, descent, solve,
};
use fieldline_tests::field::floor::{KINDS, Kind};
use fieldline_tests::field::scenes::{Pull, scene};
use fieldline_tests::field::truth::Truth;
use fieldline_tests::field::{Rows, ascend, cells, degrees_between};
use fieldline_tests::golden;
use fieldline_tests::random::Random;

use crate::shared::{converge, window};

/// A row of set cells.
const EVERYWHERE: u64 = (1 << SIDE) - 1;

#[test]
fn cells_that_no_goal_reaches_are_flat() {
    let mut closed = window(&[
        "###########",
        "#....#....#",
        "#.G..#....#",
        "#....#....#",
        "###########",
    ]);
    let mut scratch = [0.0; SCRATCH_FLOATS];
    let reached = cells().filter(|&(x, y)| closed.is_reached(x, y)).count();
    assert_eq!(
        reached, 11,
        "without the 12 cells on the other side of the wall"
    );
    assert_eq!(
        solve(&mut closed, &mut scratch, &SolverConfig::default()).stop,
        Stop::Converged
    );
    assert!(descent::heading(&closed, 1, 1).is_some());
    for (x, y) in [(7, 2), (5, 2), (2, 2), (40, 40), (SIDE, 0)] {
        assert_eq!(descent::heading(&closed, x, y), None, "({x}, {y})");
        assert_eq!(ascend(&closed, x, y), None, "({x}, {y})");
    }
    assert_eq!(p_diff(&closed, 7, 2), 0.0);

    // There is no field if the goals touch no free cell, or if there is no goal.
    let goal_only = window(&["#####", "##G##", "#####", "....."]);
    let no_goal = window(&["....."]);
    for mut flat in [goal_only, no_goal, Window::new()] {
        let solution = solve(&mut flat, &mut scratch, &SolverConfig::default());
        assert_eq!((solution.stop, solution.cycles), (Stop::Flat, 0));
    }
}

#[test]
fn a_budget_spent_in_parts_makes_the_same_bits() {
    let mut scratch = [0.0; SCRATCH_FLOATS];
    let budget = |max_cycles| SolverConfig {
        max_cycles,
        tolerance: 0.0,
        method: Method::Multigrid,
    };
    let mut whole = scene(Kind::Rooms, Pull::Heights, 8).window;
    let mut parts = whole.clone();
    let solution = solve(&mut whole, &mut scratch, &budget(7));
    assert_eq!((solution.stop, solution.cycles), (Stop::Budget, 7));
    for part in [3, 1, 3] {
        scratch.fill(f32::NAN);
        solve(&mut parts, &mut scratch, &budget(part));
    }
    assert!(cells().all(|(x, y)| whole.q(x, y).to_bits() == parts.q(x, y).to_bits()));
}

#[test]
fn a_shift_moves_values_and_clears_the_cells_that_enter() {
    let mut before = scene(Kind::Scatter, Pull::Heights, 9).window;
    converge(&mut before);
    for (dx, dy) in [
        (1, 0),
        (-1, 0),
        (0, 1),
        (0, -1),
        (3, -5),
        (-7, 2),
        (60, 60),
        (-61, 0),
        (0, 200),
    ] {
        let mut after = before.clone();
        after.shift(dx, dy);
        for (x, y) in cells() {
            let from = (x as i32 + dx, y as i32 + dy);
            let inside = (0..SIDE as i32).contains(&from.0) && (0..SIDE as i32).contains(&from.1);
            let (from_x, from_y) = (from.0 as usize, from.1 as usize);
            let expected = if inside {
                before.q(from_x, from_y)
            } else {
                0.0
            };
            assert_eq!(after.q(x, y), expected, "({dx}, {dy}) at ({x}, {y})");
            let expected = if inside {
                before.preference(from_x, from_y)
            } else {
                Preference::NONE
            };
            assert_eq!(
                after.preference(x, y),
                expected,
                "({dx}, {dy}) at ({x}, {y})"
            );
            assert_eq!(
                after.is_goal(x, y),
                inside && before.is_goal(from_x, from_y)
            );
        }
    }
}

#[test]
fn strong_attraction_falls_back_to_gauss_seidel() {
    let mut scratch = [0.0; SCRATCH_FLOATS];
    let mut window = scene(Kind::Door, Pull::None, 10).window;
    let config = SolverConfig {
        max_cycles: 400,
        ..SolverConfig::default()
    };
    window.set_preferences(|_, _| Preference::nearest(0.3));
    let truth = Truth::of(&window);
    let solution = solve(&mut window, &mut scratch, &config);
    assert_eq!(
        (solution.method, solution.stop),
        (Method::GaussSeidel, Stop::Converged)
    );
    let right = |&(x, y): &(usize, usize)| {
        let heading = descent::heading(&window, x, y).unwrap_or(f32::NAN);
        degrees_between(f64::from(heading), truth.heading(x, y)) < 5.0
    };
    let reached: Vec<_> = cells().filter(|&(x, y)| window.is_reached(x, y)).collect();
    assert!(100 * reached.iter().filter(|&cell| right(cell)).count() >= 99 * reached.len());
}

/// Boundaries and preferences are noise, goals come by the thousand, the window jumps.
#[test]
fn noise_brings_no_panic_and_no_number_out_of_range() {
    let mut scratch = [f32::NAN; SCRATCH_FLOATS];
    let mut window = Window::new();
    let mut random = Random::mixed(11);
    for round in 0..300 {
        let density = random.within(0, 4);
        let bits =
            |random: &mut Random| (0..density).fold(EVERYWHERE, |bits, _| bits & random.word());
        let free: Rows = core::array::from_fn(|_| !bits(&mut random));
        let goals = random.within(1, 8);
        let goal: Rows =
            core::array::from_fn(|_| (0..goals).fold(u64::MAX, |bits, _| bits & random.word()));
        if round % 3 == 0 {
            window.shift(random.within(-8, 9), random.within(-70, 71));
        }
        window.set_boundary(&free, &goal);
        if round % 2 == 0 {
            window.set_preferences(|_, _| Preference::nearest((4.0 * random.unit() - 2.0) as f32));
        }
        let method = [Method::Auto, Method::Multigrid, Method::GaussSeidel][round % 3];
        solve(
            &mut window,
            &mut scratch,
            &SolverConfig {
                max_cycles: 3,
                tolerance: 0.05,
                method,
            },
        );
        for (x, y) in cells() {
            let q = window.q(x, y);
            let least = if window.is_goal(x, y) { GOAL } else { 0.0 };
            let most = if window.is_goal(x, y) || window.is_reached(x, y) {
                GOAL
            } else {
                0.0
            };
            assert!(least <= q && q <= most, "round {round} ({x}, {y}): {q:e}");
        }
    }
}

/// The golden file has hashes of the fields' bits. It differs on a host whose floats round
/// differently, and after a change of the solver's arithmetic.
#[test]
fn fields_have_the_same_bits_everywhere() {
    let mut scratch = [0.0; SCRATCH_FLOATS];
    let mut lines = String::new();
    for (kind, pull) in KINDS
        .into_iter()
        .flat_map(|k| [(k, Pull::None), (k, Pull::Heights)])
    {
        let mut window = scene(kind, pull, 12).window;
        let solution = solve(&mut window, &mut scratch, &SolverConfig::default());
        let bits = cells().map(|(x, y)| window.q(x, y).to_bits());
        // FNV-1a, word by word.
        let hash = bits.fold(0x811C_9DC5_u32, |hash, bits| {
            (hash ^ bits).wrapping_mul(0x0100_0193)
        });
        let (kind, pull) = (format!("{kind:?}"), format!("{pull:?}"));
        lines += &format!(
            "{kind:<10}{pull:<8}{:>3} cycles  {hash:08x}\n",
            solution.cycles
        );
    }
    golden::compare("field_bits.txt", &lines);
}

//! Laws that every field obeys: closed forms, the maximum principle, symmetry, monotone relaxation, reachability,
//! translation; and that no boundary, however odd, brings a panic or a number out of range.

#[allow(dead_code, reason = "each test file uses a part of it")]
mod field_common;

use field_common::golden::compare_with_golden;
use field_common::oracle::Truth;
use field_common::scenes::{KINDS, Kind, Pull, scene};
use field_common::{Random, Rows, cells, degrees_between};
use fieldline_planner::field::preference::p_diff;
use fieldline_planner::field::{
    GOAL, Method, Preference, SCRATCH_FLOATS, SIDE, SolverConfig, Stop, Window, descent, solve,
};

const EVERYWHERE: u64 = (1 << SIDE) - 1;

/// Solve far beyond the stop rule, to what f32 can hold.
fn converge(window: &mut Window) {
    let mut scratch = [0.0; SCRATCH_FLOATS];
    let config = SolverConfig {
        max_cycles: 100,
        tolerance: 3e-6,
        method: Method::Multigrid,
    };
    solve(window, &mut scratch, &config);
}

fn sweeps(window: &mut Window, fives: u16) {
    let mut scratch = [0.0; SCRATCH_FLOATS];
    let config = SolverConfig {
        max_cycles: fives,
        method: Method::GaussSeidel,
        ..SolverConfig::default()
    };
    solve(window, &mut scratch, &config);
}

/// A window from a picture, first line the greatest y: `#` obstacle, `.` free, `G` goal.
fn window(picture: &[&str]) -> Window {
    let (mut free, mut goal): (Rows, Rows) = ([0; SIDE], [0; SIDE]);
    for (y, line) in picture.iter().rev().enumerate() {
        for (x, cell) in line.chars().enumerate() {
            match cell {
                '.' => free[y] |= 1 << x,
                'G' => goal[y] |= 1 << x,
                _ => {}
            }
        }
    }
    let mut window = Window::new();
    window.set_boundary(&free, &goal);
    window
}

/// In a corridor one cell wide, `4 q = q(x+1) + q(x−1)`: q = sinh((n + 1 − x) κ) / sinh((n + 1) κ) with cosh κ = 2.
#[test]
fn a_narrow_corridor_is_a_hyperbolic_sine() {
    let mut narrow = window(&["G................................."]);
    converge(&mut narrow);
    let truth = Truth::of(&narrow);
    let (length, kappa) = (34.0, 2.0_f64.acosh());
    for x in 1..34 {
        let exact = ((length - x as f64) * kappa).sinh() / (length * kappa).sinh();
        let q = f64::from(narrow.q(x, 0)) / f64::from(GOAL);
        assert!(
            (truth.q(x, 0) / exact - 1.0).abs() < 1e-11,
            "the oracle at {x}"
        );
        assert!(
            (q / exact - 1.0).abs() < 1e-4,
            "the solver at {x}: {q:e} for {exact:e}"
        );
    }
}

/// In a room with goals all along its lower side, q is a sum of sines across times hyperbolic sines of κ y along, with
/// cosh κ = 2 − cos(k π / (w + 1)) for the k-th.
#[test]
fn a_room_with_one_open_side_is_a_fourier_sum() {
    let (width, height) = (40_usize, 25_usize);
    let (mut free, mut goal): (Rows, Rows) = ([0; SIDE], [0; SIDE]);
    goal[0] = (1 << width) - 1;
    free[1..=height].fill((1 << width) - 1);
    let mut room = Window::new();
    room.set_boundary(&free, &goal);
    converge(&mut room);
    let truth = Truth::of(&room);
    let angle = |k: usize, x: usize| (k * x) as f64 * core::f64::consts::PI / (width + 1) as f64;
    for (x, y) in cells().filter(|&(x, y)| x < width && (1..=height).contains(&y)) {
        let term = |k: usize| {
            let weight: f64 = (1..=width).map(|x| angle(k, x).sin()).sum();
            let kappa = (2.0 - angle(k, 1).cos()).acosh();
            let along =
                ((height + 1 - y) as f64 * kappa).sinh() / ((height + 1) as f64 * kappa).sinh();
            2.0 / (width + 1) as f64 * weight * angle(k, x + 1).sin() * along
        };
        let exact: f64 = (1..=width).map(term).sum();
        let q = f64::from(room.q(x, y)) / f64::from(GOAL);
        assert!(
            (truth.q(x, y) / exact - 1.0).abs() < 1e-9,
            "the oracle at ({x}, {y})"
        );
        assert!(
            (q / exact - 1.0).abs() < 1e-4,
            "the solver at ({x}, {y}): {q:e} for {exact:e}"
        );
    }
}

#[test]
fn no_cell_is_above_or_below_all_its_neighbours() {
    for (kind, pull) in KINDS
        .into_iter()
        .flat_map(|k| [(k, Pull::None), (k, Pull::Heights)])
    {
        let mut window = scene(kind, pull, 3).window;
        converge(&mut window);
        for (x, y) in cells() {
            let q = window.q(x, y);
            if window.is_goal(x, y) {
                assert_eq!(q, GOAL);
            } else if window.is_reached(x, y) {
                let around = [
                    (x.wrapping_sub(1), y),
                    (x + 1, y),
                    (x, y.wrapping_sub(1)),
                    (x, y + 1),
                ]
                .map(|(x, y)| window.q(x, y));
                assert!(0.0 < q && q <= GOAL, "{kind:?} ({x}, {y}): {q:e}");
                assert!(
                    around.iter().any(|&n| n > q) || q == GOAL,
                    "{kind:?}: a peak at ({x}, {y})"
                );
                assert!(
                    around.iter().any(|&n| n < q) || q == GOAL,
                    "{kind:?}: a pit at ({x}, {y})"
                );
            } else {
                assert_eq!(q, 0.0);
            }
        }
    }
}

#[test]
fn mirrored_and_turned_windows_have_mirrored_and_turned_fields() {
    type Map = fn(usize, usize) -> (usize, usize);
    let maps: [Map; 3] = [
        |x, y| (SIDE - 1 - x, y),
        |x, y| (x, SIDE - 1 - y),
        |x, y| (y, x),
    ];
    for (kind, map) in KINDS.into_iter().flat_map(|k| maps.map(|m| (k, m))) {
        let mut original = scene(kind, Pull::Heights, 4).window;
        let (mut free, mut goal): (Rows, Rows) = ([0; SIDE], [0; SIDE]);
        for (x, y) in cells() {
            let (to_x, to_y) = map(x, y);
            free[to_y] |= u64::from(original.is_reached(x, y)) << to_x;
            goal[to_y] |= u64::from(original.is_goal(x, y)) << to_x;
        }
        let mut image = Window::new();
        image.set_boundary(&free, &goal);
        image.set_preferences(|x, y| original.preference(map(x, y).0, map(x, y).1));
        converge(&mut original);
        converge(&mut image);
        for (x, y) in cells() {
            let (q, other) = (original.q(x, y), image.q(map(x, y).0, map(x, y).1));
            assert!(
                (q - other).abs() <= 1e-3 * q,
                "{kind:?} ({x}, {y}): {q:e} and {other:e}"
            );
        }
    }
}

/// From zero each sweep raises every cell or leaves it, and no cell with a value is ever a local minimum of p.
#[test]
fn gauss_seidel_from_zero_rises_without_a_local_minimum() {
    for (kind, seed) in KINDS.into_iter().flat_map(|k| [(k, 5), (k, 6)]) {
        let mut window = scene(kind, Pull::None, seed).window;
        let mut random = Random::new(seed);
        window.set_preferences(|_, _| Preference::nearest((3.9 * random.unit() - 1.95) as f32));
        let mut before: Vec<f32> = vec![0.0; SIDE * SIDE];
        for _ in 0..40 {
            sweeps(&mut window, 1);
            let now: Vec<f32> = cells().map(|(x, y)| window.q(x, y)).collect();
            for ((x, y), (&now, &before)) in cells().zip(now.iter().zip(&before)) {
                // Rounding may take back the last bit of what has settled.
                assert!(
                    now >= before * (1.0 - 1e-6),
                    "{kind:?} ({x}, {y}) fell from {before:e} to {now:e}"
                );
                let settled = now == before;
                let stuck = window.is_reached(x, y)
                    && now > 0.0
                    && descent::ascend(&window, x, y).is_none();
                assert!(
                    !stuck || settled,
                    "{kind:?}: ({x}, {y}) is stuck at {now:e}"
                );
            }
            before = now;
        }
    }
}

#[test]
fn p_diff_is_right_to_a_ten_thousandth_down_to_1e_minus_30() {
    let mut least = f64::INFINITY;
    let mut check = |mut window: Window, robots: &[(usize, usize)]| {
        converge(&mut window);
        let truth = Truth::of(&window);
        for &(x, y) in robots {
            let exact = truth.p_diff(window.reached(), x, y);
            let measured = f64::from(p_diff(&window, x, y));
            assert!(
                (measured / exact - 1.0).abs() < 1e-4,
                "({x}, {y}): {measured:e} for {exact:e}"
            );
            least = least.min(exact);
        }
    };
    for (kind, pull) in KINDS
        .into_iter()
        .flat_map(|k| [(k, Pull::None), (k, Pull::Heights)])
    {
        for seed in 7..10 {
            let scene = scene(kind, pull, seed);
            check(scene.window, &[scene.robot]);
        }
    }
    // Along a corridor bent into a serpent, five cells wide.
    let mut serpent: Vec<String> = vec![".".repeat(SIDE); SIDE];
    for wall in 1..5 {
        serpent[6 * wall - 1] = "#".repeat(SIDE);
        let door = if wall % 2 == 0 { 0..5 } else { 56..61 };
        serpent[6 * wall - 1].replace_range(door.clone(), ".....");
    }
    serpent.truncate(29);
    serpent[2].replace_range(0..1, "G");
    let serpent: Vec<&str> = serpent.iter().map(String::as_str).collect();
    check(
        window(&serpent),
        &[(10, 26), (50, 26), (30, 20), (50, 14), (30, 8)],
    );
    println!("least p_diff: {least:e}");
    assert!(least < 1e-30);
}

#[test]
fn what_no_goal_reaches_is_flat_and_counted() {
    let mut closed = window(&[
        "###########",
        "#....#....#",
        "#.G..#....#",
        "#....#....#",
        "###########",
    ]);
    let mut scratch = [0.0; SCRATCH_FLOATS];
    assert_eq!(closed.unreached_cells(), 12);
    assert_eq!(
        solve(&mut closed, &mut scratch, &SolverConfig::default()).stop,
        Stop::Converged
    );
    assert!(descent::heading(&closed, 1, 1).is_some());
    for (x, y) in [(7, 2), (5, 2), (2, 2), (40, 40), (SIDE, 0)] {
        assert_eq!(descent::heading(&closed, x, y), None, "({x}, {y})");
        assert_eq!(descent::ascend(&closed, x, y), None, "({x}, {y})");
    }
    assert_eq!(p_diff(&closed, 7, 2), 0.0);

    // Goals that touch nothing free are no field, and neither is a floor without a goal.
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
fn shifting_moves_values_and_preferences_and_blanks_what_came_in() {
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
fn a_heading_between_cells_lies_between_theirs() {
    let mut open = window(&["..................G"; 12]);
    converge(&mut open);
    // On a cell's centre it is the cell's own; a step across a border changes it by little.
    for (x, y) in cells().filter(|&(x, y)| (2..14).contains(&x) && (2..10).contains(&y)) {
        let at = |x: f32, y: f32| f64::from(descent::heading_at(&open, x, y).expect("a heading"));
        let centre = f64::from(descent::heading(&open, x, y).expect("a heading"));
        let (x, y) = (x as f32, y as f32);
        assert!(degrees_between(centre, at(x + 0.5, y + 0.5)) < 1e-3);
        assert!(degrees_between(at(x - 0.001, y + 0.3), at(x + 0.001, y + 0.3)) < 1.0);
        assert!(degrees_between(at(x + 0.3, y - 0.001), at(x + 0.3, y + 0.001)) < 1.0);
    }
    for (x, y) in [
        (-0.5, 3.0),
        (18.5, 3.0),
        (70.0, 3.0),
        (3.0, 1e9),
        (f32::NAN, 3.0),
    ] {
        assert_eq!(descent::heading_at(&open, x, y), None, "({x}, {y})");
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

/// Boundaries and preferences of pure noise, goals by the thousand, jumps between them: still a field in range.
#[test]
fn noise_brings_no_panic_and_no_number_out_of_range() {
    let mut scratch = [f32::NAN; SCRATCH_FLOATS];
    let mut window = Window::new();
    let mut random = Random::new(11);
    for round in 0..300 {
        let density = random.between(0, 4);
        let bits =
            |random: &mut Random| (0..density).fold(EVERYWHERE, |bits, _| bits & random.bits());
        let free: Rows = core::array::from_fn(|_| !bits(&mut random));
        let goals = random.between(1, 8);
        let goal: Rows =
            core::array::from_fn(|_| (0..goals).fold(u64::MAX, |bits, _| bits & random.bits()));
        if round % 3 == 0 {
            window.shift(random.between(-8, 9), random.between(-70, 71));
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

/// The fields themselves, as hashes of their bits: a host whose floats round otherwise, or a change that was meant to
/// change nothing, shows here.
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
    compare_with_golden("field_bits.txt", &lines);
}

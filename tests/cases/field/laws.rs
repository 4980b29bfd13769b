//! Laws of every field: closed forms, the maximum principle, symmetry, monotone relaxation, the
//! gradient's range of magnitudes.

use fieldline_planner::field::preference::p_diff;
use fieldline_planner::field::{GOAL, Preference, SIDE, Window, descent};
use fieldline_tests::field::floor::KINDS;
use fieldline_tests::field::scenes::{Pull, scene};
use fieldline_tests::field::truth::Truth;
use fieldline_tests::field::{Rows, ascend, cells, degrees_between};
use fieldline_tests::random::Random;

use crate::shared::{converge, sweeps, window};

/// In a corridor one cell wide, `4 q = q(x+1) + q(x−1)`, so that
/// q = sinh((n + 1 − x) κ) / sinh((n + 1) κ) with cosh κ = 2.
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

/// In a room with goals all along its lower side, q is a sum of terms: a sine across the room times
/// a hyperbolic sine of κ y along it, with cosh κ = 2 − cos(k π / (w + 1)) for term k.
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

/// From zero each sweep raises every cell or leaves it. No cell with a value is ever a local
/// minimum of p.
#[test]
fn gauss_seidel_from_zero_rises_without_a_local_minimum() {
    for (kind, seed) in KINDS.into_iter().flat_map(|k| [(k, 5), (k, 6)]) {
        let mut window = scene(kind, Pull::None, seed).window;
        let mut random = Random::mixed(seed);
        window.set_preferences(|_, _| Preference::nearest((3.9 * random.unit() - 1.95) as f32));
        let mut before: Vec<f32> = vec![0.0; SIDE * SIDE];
        for _ in 0..40 {
            sweeps(&mut window, 1);
            let now: Vec<f32> = cells().map(|(x, y)| window.q(x, y)).collect();
            for ((x, y), (&now, &before)) in cells().zip(now.iter().zip(&before)) {
                // Rounding may lower a settled value by its last bit.
                assert!(
                    now >= before * (1.0 - 1e-6),
                    "{kind:?} ({x}, {y}) fell from {before:e} to {now:e}"
                );
                let settled = now == before;
                let stuck = window.is_reached(x, y) && now > 0.0 && ascend(&window, x, y).is_none();
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
            let exact = truth.p_diff(x, y);
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
    // A corridor in the form of a serpent, five cells wide.
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
fn a_heading_between_cells_lies_between_theirs() {
    let mut open = window(&["..................G"; 12]);
    converge(&mut open);
    // At a cell's centre it is the cell's own heading. A step across a border changes it little.
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

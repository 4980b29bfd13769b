//! Answers for drawn windows, compared with the direct f64 solution.

use super::sheet::{Sheet, SheetCell, preferences};
use super::{Solver, run};
use crate::trial::oracle;
use crate::trial::snapshot::WindowCell;

const BOTH: [Solver; 2] = [Solver::Multigrid, Solver::GaussSeidel];

/// Rooms of 61 × 61 cells with doors, a goal in one corner and the robot in another.
fn rooms() -> String {
    let mut lines = vec![vec!['.'; 61]; 61];
    for (y, line) in lines.iter_mut().enumerate() {
        for (x, cell) in line.iter_mut().enumerate() {
            let wall = (x == 20 && !(8..14).contains(&y) && !(40..46).contains(&y))
                || (y == 30 && !(50..57).contains(&x));
            if wall || x == 0 || y == 0 || x == 60 || y == 60 {
                *cell = '#';
            }
        }
    }
    lines[3][2] = 'G';
    lines[57][3] = 'R';
    let lines: Vec<String> = lines
        .into_iter()
        .map(|line| line.into_iter().collect())
        .collect();
    lines.join("\n")
}

fn oracle_of(sheet: &Sheet) -> Vec<f64> {
    let cell = |i: usize| {
        let row = sheet.rows.get(i / 61);
        match row.and_then(|row| row.get(i % 61)) {
            Some(SheetCell::Goal) => WindowCell::Goal,
            Some(SheetCell::Free) => WindowCell::Free,
            _ => WindowCell::Obstacle,
        }
    };
    oracle::solve(&(0..61 * 61).map(cell).collect::<Vec<_>>())
}

#[test]
fn both_solvers_agree_with_the_direct_solution() {
    let sheet = Sheet::parse(&rooms()).unwrap();
    let exact = oracle_of(&sheet);
    let (x, y) = sheet.robot.unwrap();
    let heading = oracle::heading_at(&exact, x as f64 + 0.5, y as f64 + 0.5).unwrap();
    for solver in BOTH {
        let solved = run(&sheet, None, solver);
        assert_eq!(solved.answer.stop, "converged", "{solver:?}");
        let told = f64::from(solved.answer.heading_rad.unwrap());
        assert!((told - heading).abs() < 1e-4, "{solver:?} {told} {heading}");
        for (i, exact) in exact.iter().enumerate() {
            let q = solved.q[i / 61][i % 61];
            assert!(
                (q - exact).abs() <= 1e-3 * exact,
                "{solver:?} {i}: {q} {exact}"
            );
        }
    }
}

/// In a corridor q falls by the factor 2 − √3 per cell.
#[test]
fn a_corridor_has_the_solution_by_hand() {
    let sheet = Sheet::parse("R......G").unwrap();
    for solver in BOTH {
        let solved = run(&sheet, None, solver);
        assert_eq!(solved.answer.heading_rad, Some(0.0));
        assert!(!solved.answer.flat);
        let ratio = solved.q[0][3] / solved.q[0][4];
        assert!((ratio - (2.0 - 3.0_f64.sqrt())).abs() < 1e-3, "{ratio}");
        let lines = solved.csv();
        assert!(lines.ends_with(",1.00000000e0\n"), "{lines}");
        assert_eq!(lines.lines().count(), 1);
        assert_eq!(lines.split(',').count(), 8);
    }
}

#[test]
fn the_first_line_is_up() {
    let sheet = Sheet::parse(".G.\n...\n...\n...\n.R.").unwrap();
    let answer = run(&sheet, None, Solver::Multigrid).answer;
    assert!((answer.heading_rad.unwrap() - core::f32::consts::FRAC_PI_2).abs() < 1e-4);
}

#[test]
fn a_walled_in_robot_and_a_window_without_goals_are_flat() {
    for (drawn, stop) in [("G.#R.", "converged"), ("..R..", "flat")] {
        let answer = run(&Sheet::parse(drawn).unwrap(), None, Solver::Multigrid).answer;
        assert_eq!((answer.flat, answer.stop), (true, stop), "{drawn}");
        assert_eq!(answer.heading_rad, None);
    }
    let answer = run(&Sheet::parse("G..").unwrap(), None, Solver::Multigrid).answer;
    assert_eq!(
        (answer.flat, answer.heading_rad, answer.p_diff),
        (false, None, None)
    );
}

/// Attraction raises q everywhere and repulsion lowers it \[Maffei20, III\].
#[test]
fn preferences_attract_and_repel() {
    let sheet = Sheet::parse("..........\n.R.......G\n..........").unwrap();
    let q_at_robot = |epsilon: f32| {
        let row = vec![epsilon.to_string(); 10].join(",");
        let rows = preferences(&vec![row; 3].join("\n"), &sheet).unwrap();
        BOTH.map(|solver| run(&sheet, Some(&rows), solver).q[1][1])
    };
    for solver in 0..2 {
        let q = [-0.5, 0.0, 0.5].map(|epsilon| q_at_robot(epsilon)[solver]);
        assert!(q[0] < 0.9 * q[1] && q[1] < 0.9 * q[2], "{q:?}");
    }
}

#[test]
fn the_json_line_has_the_documented_keys_in_order() {
    let answer = run(&Sheet::parse("..R..").unwrap(), None, Solver::GaussSeidel).answer;
    assert_eq!(
        answer.to_json_line(),
        "{\"solver\":\"gauss-seidel\",\"method\":\"multigrid\",\"width\":5,\"height\":1,\
         \"cycles\":null,\"sweeps\":null,\"stop\":\"flat\",\"residual\":0.0,\
         \"heading_rad\":null,\"p_diff\":0.0,\"flat\":true}"
    );
}

/// A random window: walls with gaps, scattered obstacles and a few goals, from a xorshift
/// generator.
fn random_window(seed: u64) -> Sheet {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut next = move |below: u64| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        ((state >> 11) % below) as usize
    };
    let mut rows = vec![vec![SheetCell::Free; 61]; 61];
    for _ in 0..next(5) {
        let (at, gap, across) = (next(61), next(55), next(2) == 0);
        for k in (0..61).filter(|k| !(gap..gap + 6).contains(k)) {
            let (x, y) = if across { (k, at) } else { (at, k) };
            rows[y][x] = SheetCell::Obstacle;
        }
    }
    for _ in 0..next(400) {
        rows[next(61)][next(61)] = SheetCell::Obstacle;
    }
    for _ in 0..=next(3) {
        rows[next(61)][next(61)] = SheetCell::Goal;
    }
    rows[30][30] = SheetCell::Free;
    Sheet {
        rows,
        robot: Some((30, 30)),
    }
}

#[test]
fn random_windows_agree_with_the_direct_solution() {
    for seed in 0..40 {
        let sheet = random_window(seed);
        let exact = oracle_of(&sheet);
        for solver in BOTH {
            let solved = run(&sheet, None, solver);
            let answer = &solved.answer;
            assert_ne!(answer.stop, "budget", "seed {seed}: {answer:?}");
            let reached = exact[30 * 61 + 30] > 0.0;
            assert_eq!(answer.flat, !reached, "seed {seed}");
            for (i, &exact) in exact.iter().enumerate().filter(|(_, q)| **q > 1e-60) {
                let q = solved.q[i / 61][i % 61];
                assert!(
                    (q - exact).abs() <= 2e-3 * exact,
                    "{seed} {solver:?} {i}: {q} {exact}"
                );
            }
        }
    }
}

#[test]
fn both_solvers_agree_under_preferences() {
    for seed in 0..20 {
        let sheet = random_window(seed);
        let slope =
            |y: usize, x: usize| (((x * 7 + y * 11 + seed as usize) % 21) as f32 - 14.0) / 28.0;
        let rows: Vec<Vec<f32>> = (0..61)
            .map(|y| (0..61).map(|x| slope(y, x)).collect())
            .collect();
        let [fast, slow] = BOTH.map(|solver| run(&sheet, Some(&rows), solver));
        assert_ne!(fast.answer.stop, "budget", "seed {seed}");
        let pairs = fast.q.iter().flatten().zip(slow.q.iter().flatten());
        for (i, (fast, slow)) in pairs.enumerate().filter(|(_, (_, slow))| **slow > 1e-60) {
            assert!(
                (fast - slow).abs() <= 2e-3 * slow,
                "{seed} {i}: {fast} {slow}"
            );
        }
    }
}

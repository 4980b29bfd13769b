//! Tests of the solver: against a dense solution in double precision, and on closed loops.

use std::vec::Vec;

use super::{Vectors, down, pull, solve, up};
use crate::Rules;
use crate::graph::{Closure, Graph};
use crate::matrix::{Cholesky, diagonal, dot};
use crate::pose::Pose;

type Small = Graph<64, 8, 1>;

fn pose(x_m: f32, y_m: f32, yaw_rad: f32) -> Pose {
    Pose { x_m, y_m, yaw_rad }
}

fn factor() -> Cholesky {
    Cholesky::of(&[[400.0, 20.0, 0.0], [20.0, 900.0, 30.0], [0.0, 30.0, 2500.0]]).unwrap()
}

/// Keyframes once round a square of 4 m, a metre apart, whose odometry turns a little too much.
fn square(drift_rad: f32) -> Small {
    let mut graph = Small::new(Rules::ALL.scaling);
    graph.add(&Pose::default(), Cholesky::UNIT, &[]).unwrap();
    for k in 1..=16 {
        let turn = if k % 4 == 0 {
            0.5 * core::f32::consts::PI
        } else {
            0.0
        };
        let motion = pose(1.0, 0.0, turn + drift_rad);
        graph.add(&motion, factor(), &[]).unwrap();
    }
    graph
}

fn closure(from: u16, to: u16, measured: Pose) -> Closure {
    Closure {
        from,
        to,
        measured,
        information: diagonal([400.0, 400.0, 2000.0]),
    }
}

#[test]
fn what_goes_up_is_the_transpose_of_what_goes_down() {
    let graph = square(0.03);
    let numbers = |seed: u32| -> [[f32; 3]; 64] {
        core::array::from_fn(|k| {
            core::array::from_fn(|i| {
                if (1..17).contains(&k) {
                    let at = seed
                        .wrapping_mul(2_654_435_761)
                        .wrapping_add((7 * k + i) as u32);
                    (at.wrapping_mul(2_246_822_519) >> 20) as f32 / 2048.0 - 1.0
                } else {
                    0.0
                }
            })
        })
    };
    for seed in 1..9 {
        let (step, forces) = (numbers(seed), numbers(seed + 100));
        let (mut moves, mut gradient) = ([[0.0; 3]; 64], [[0.0; 3]; 64]);
        down(&graph, &step, &mut moves);
        up(&graph, &forces, &mut gradient);
        let sum = |a: &[[f32; 3]], b: &[[f32; 3]]| -> f32 {
            a.iter().zip(b).map(|(a, b)| dot(a, b)).sum()
        };
        let (one, other) = (sum(&moves, &forces), sum(&step, &gradient));
        assert!(
            (one - other).abs() < 1e-3 * (1.0 + one.abs()),
            "{one} {other}"
        );
    }
}

#[test]
fn a_step_down_the_chain_is_the_derivative_of_its_poses() {
    let mut graph = square(0.03);
    let mut step = [[0.0; 3]; 64];
    step[3] = [0.2, -0.3, 0.4];
    step[9] = [-0.1, 0.5, -0.6];
    let mut moves = [[0.0; 3]; 64];
    down(&graph, &step, &mut moves);
    let before: Vec<Pose> = graph.keys.iter().map(|key| key.pose).collect();
    let part = 1e-2;
    for (key, step) in graph.keys.iter_mut().zip(&step) {
        key.residual = key.factor.backward(step).map(|it| part * it);
    }
    graph.place();
    for ((key, before), moves) in graph.keys.iter().zip(&before).zip(&moves) {
        let changed = key.pose.minus(before);
        for (changed, moved) in changed.iter().zip(moves) {
            assert!(
                (changed - part * moved).abs() < 2e-5,
                "{changed} {}",
                part * moved
            );
        }
    }
}

#[test]
fn a_closed_square_is_square_again() {
    let mut graph = square(0.01);
    let open = graph.pose(16).unwrap();
    assert!(open.length_m() > 0.3, "the square is open: {open:?}");
    graph
        .closures
        .push(closure(0, 16, Pose::default()))
        .unwrap();
    solve(&mut graph, &mut Vectors::new(), 8);
    let closed = graph.pose(16).unwrap();
    assert!(closed.length_m() < 0.05, "{closed:?}");
    let corner = graph.pose(8).unwrap();
    assert!(
        (corner.x_m - 4.0).abs() < 0.15 && (corner.y_m - 4.0).abs() < 0.15,
        "{corner:?}"
    );
}

/// At the solution no small change of any motion lowers the cost.
#[test]
fn the_gradient_vanishes_at_the_solution() {
    let mut graph = square(0.02);
    for (from, to, measured) in [
        (0, 16, pose(0.05, -0.02, 0.01)),
        (1, 15, pose(-1.9, 0.1, -0.1)),
        (4, 12, pose(-4.0, 4.1, 3.1)),
    ] {
        graph.closures.push(closure(from, to, measured)).unwrap();
    }
    let first = graph.cost();
    let mut vectors = Vectors::new();
    solve(&mut graph, &mut vectors, 20);
    let solved = graph.cost();
    assert!(solved < first, "{solved} {first}");
    let mut forces = [[0.0; 3]; 64];
    pull(&graph, &mut forces, |closure| closure.residual);
    let mut gradient = [[0.0; 3]; 64];
    up(&graph, &forces, &mut gradient);
    for (key, gradient) in graph.keys.iter().zip(&gradient).skip(1) {
        let white = key.factor.whitened(&key.residual);
        for (white, gradient) in white.iter().zip(gradient) {
            assert!(
                (white + gradient).abs() < 0.05 * (1.0 + gradient.abs()),
                "{white} {gradient}"
            );
        }
    }
}

/// A closure that is wrong by 3 m beside a right one: the right one holds.
#[test]
fn a_wrong_closure_loses_its_weight() {
    let mut graph = square(0.0);
    graph
        .closures
        .push(closure(0, 16, Pose::default()))
        .unwrap();
    graph
        .closures
        .push(closure(2, 14, pose(3.0, 3.0, 1.0)))
        .unwrap();
    let before: Vec<Pose> = graph.keys.iter().map(|key| key.pose).collect();
    solve(&mut graph, &mut Vectors::new(), 8);
    for (key, before) in graph.keys.iter().zip(&before) {
        let moved = before.between(&key.pose).length_m();
        assert!(moved < 0.3, "a pose moved by {moved} m");
    }
}

#[test]
fn a_graph_without_closures_stays_where_it_is() {
    let mut graph = square(0.03);
    let before = graph.pose(16);
    solve(&mut graph, &mut Vectors::new(), 3);
    assert_eq!(graph.pose(16), before);
}

#[test]
fn without_robust_weights_a_wrong_closure_counts_as_any_other() {
    let wrong = closure(2, 14, pose(3.0, 3.0, 1.0));
    let weight = |scaling| Small::new(scaling).weight(&wrong, &[3.0, 3.0, 1.0]);
    assert!(weight(Rules::ALL.scaling) < 1e-3);
    assert_eq!(weight(Rules::NEVER), 1.0);
}

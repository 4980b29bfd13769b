//! The solver: Gauss–Newton on the residuals of the chain, by conjugate gradients.
//!
//! ```text
//! unknown     v = Lᵀ y per motion of the chain (Ω = L Lᵀ), so that the chain's cost is |v|²
//! one round   (I + Σ closures Bᵀ Ω B) δv = −(v + Σ Bᵀ Ω r)        B = ∂r/∂v
//! B δv        down the chain: how each pose moves, then the two ends of a closure
//! Bᵀ f        up the chain: the forces on the poses behind a motion, and their lever
//! ```
//!
//! In these coordinates the chain is the unit matrix, which is what a chain as preconditioner makes
//! of it in the usual ones: there is nothing to factor, and k closures take about 3 k iterations of
//! O(keyframes) each. The moves of poses are sums along the chain and no differences of large
//! numbers, so single precision is enough.
//!
//! A round that would raise the cost is halved, and given up after some halvings: the cost never
//! rises.
//!
//! Units: metres, radians.

use crate::graph::{Closure, Graph};
use crate::matrix::{Matrix, Vector, dot, times, transposed_times};
use crate::pose::{Pose, sin_cos, sqrt};

/// Most iterations of a round.
const ITERATIONS: usize = 300;
/// A residual that ends a round, as a share of the first one, squared.
const SMALL: f32 = 1e-9;
/// Most halvings of a round.
const HALVINGS: usize = 4;
/// A round that moves every pose less ends the solution, metres.
const STILL_M: f32 = 1e-3;

/// Vectors of the conjugate gradients, by keyframe.
#[derive(Clone, Debug)]
pub struct Vectors<const KEYS: usize> {
    solution: [Vector; KEYS],
    residual: [Vector; KEYS],
    direction: [Vector; KEYS],
    image: [Vector; KEYS],
    /// How the poses move.
    moves: [Vector; KEYS],
    /// Forces on the poses.
    forces: [Vector; KEYS],
}

/// A closure at the present poses.
struct Linear {
    from: usize,
    to: usize,
    /// ∂r by the older and by the newer pose.
    jacobians: [Matrix; 2],
    /// The weighted information.
    information: Matrix,
    residual: Vector,
}

impl<const KEYS: usize> Vectors<KEYS> {
    /// Returns vectors of zeros.
    #[must_use]
    pub const fn new() -> Self {
        const ZEROS: Vector = [0.0; 3];
        Self {
            solution: [ZEROS; KEYS],
            residual: [ZEROS; KEYS],
            direction: [ZEROS; KEYS],
            image: [ZEROS; KEYS],
            moves: [ZEROS; KEYS],
            forces: [ZEROS; KEYS],
        }
    }
}

impl<const KEYS: usize> Default for Vectors<KEYS> {
    fn default() -> Self {
        Self::new()
    }
}

/// Solves the graph in at most `rounds` rounds. Its cost does not rise.
pub(crate) fn solve<const KEYS: usize, const LOOPS: usize, const BEAMS: usize>(
    graph: &mut Graph<KEYS, LOOPS, BEAMS>,
    vectors: &mut Vectors<KEYS>,
    rounds: usize,
) {
    for _ in 0..rounds {
        find_step(graph, vectors);
        if take_step(graph, vectors) < STILL_M {
            break;
        }
    }
}

/// Finds the step of a round, whitened: `vectors.solution`.
fn find_step<const KEYS: usize, const LOOPS: usize, const BEAMS: usize>(
    graph: &Graph<KEYS, LOOPS, BEAMS>,
    vectors: &mut Vectors<KEYS>,
) {
    let Vectors {
        solution,
        residual,
        direction,
        image,
        moves,
        forces,
    } = vectors;
    solution.fill([0.0; 3]);
    // The negative gradient: the chain's own part, and what the closures pull.
    pull(graph, forces, |closure| closure.residual);
    up(graph, forces, residual);
    for (residual, key) in residual.iter_mut().zip(&graph.keys) {
        let white = key.factor.whitened(&key.residual);
        *residual = add(residual, &white, 1.0).map(|it| -it);
    }
    pin(residual);
    *direction = *residual;
    let mut size = product(residual, residual);
    let enough = size * SMALL;
    for _ in 0..ITERATIONS {
        down(graph, direction, moves);
        pull(graph, forces, |closure| closure.change(moves));
        up(graph, forces, image);
        add_to(image, direction, 1.0);
        pin(image);
        let step = size / product(direction, image);
        if !step.is_finite() {
            break;
        }
        add_to(solution, direction, step);
        add_to(residual, image, -step);
        let next = product(residual, residual);
        if next <= enough {
            break;
        }
        for (direction, residual) in direction.iter_mut().zip(residual.iter()) {
            *direction = add(residual, direction, next / size);
        }
        size = next;
    }
}

/// Takes the step, or a part of it that does not raise the cost. Returns the greatest move of a
/// pose, metres.
fn take_step<const KEYS: usize, const LOOPS: usize, const BEAMS: usize>(
    graph: &mut Graph<KEYS, LOOPS, BEAMS>,
    vectors: &mut Vectors<KEYS>,
) -> f32 {
    let Vectors {
        solution, moves, ..
    } = vectors;
    let before = graph.cost();
    for (place, key) in moves.iter_mut().zip(&graph.keys) {
        *place = key.pose.array();
    }
    let mut part = 1.0;
    let mut taken = 0.0;
    for _ in 0..=HALVINGS {
        for (key, step) in graph.keys.iter_mut().zip(solution.iter()) {
            let step = key.factor.backward(step);
            key.residual = add(&key.residual, &step, part - taken);
        }
        graph.place();
        taken = part;
        // A cost that is no number has risen.
        if graph.cost() <= before {
            let moved = moves.iter().zip(&graph.keys).map(|([x, y, _], key)| {
                let (dx, dy) = (key.pose.x_m - x, key.pose.y_m - y);
                sqrt(dx * dx + dy * dy)
            });
            return moved.fold(0.0, f32::max);
        }
        part *= 0.5;
    }
    for (key, step) in graph.keys.iter_mut().zip(solution.iter()) {
        let step = key.factor.backward(step);
        key.residual = add(&key.residual, &step, -taken);
    }
    graph.place();
    0.0
}

/// Returns how the poses move if the chain's motions change by a whitened step. The first one
/// stays.
fn down<const KEYS: usize, const LOOPS: usize, const BEAMS: usize>(
    graph: &Graph<KEYS, LOOPS, BEAMS>,
    step: &[Vector; KEYS],
    moves: &mut [Vector; KEYS],
) {
    let mut last: Option<(Pose, Vector)> = None;
    for ((key, step), out) in graph.keys.iter().zip(step).zip(moves) {
        *out = [0.0; 3];
        if let Some((before, [mx, my, turn])) = last {
            let [x, y, yaw] = key.factor.backward(step);
            let (sin, cos) = sin_cos(before.yaw_rad);
            let (dx, dy) = (key.pose.x_m - before.x_m, key.pose.y_m - before.y_m);
            *out = [
                mx - turn * dy + cos * x - sin * y,
                my + turn * dx + sin * x + cos * y,
                turn + yaw,
            ];
        }
        last = Some((key.pose, *out));
    }
}

/// Returns the whitened gradient of the chain's motions by the forces on the poses: the transpose
/// of [`down`].
fn up<const KEYS: usize, const LOOPS: usize, const BEAMS: usize>(
    graph: &Graph<KEYS, LOOPS, BEAMS>,
    forces: &[Vector; KEYS],
    gradient: &mut [Vector; KEYS],
) {
    gradient.fill([0.0; 3]);
    let mut carried = [0.0; 3];
    let befores = graph.keys.iter().rev().skip(1);
    let behind = graph.keys.iter().zip(forces).zip(gradient).rev();
    for (((key, force), out), before) in behind.zip(befores) {
        carried = add(&carried, force, 1.0);
        let [x, y, turn] = carried;
        let (sin, cos) = sin_cos(before.pose.yaw_rad);
        *out = key
            .factor
            .forward(&[cos * x + sin * y, cos * y - sin * x, turn]);
        let (dx, dy) = (
            key.pose.x_m - before.pose.x_m,
            key.pose.y_m - before.pose.y_m,
        );
        carried = [x, y, turn + y * dx - x * dy];
    }
}

/// Fills the forces of all closures whose residuals `of` gives.
fn pull<const KEYS: usize, const LOOPS: usize, const BEAMS: usize>(
    graph: &Graph<KEYS, LOOPS, BEAMS>,
    forces: &mut [Vector; KEYS],
    of: impl Fn(&Linear) -> Vector,
) {
    forces.fill([0.0; 3]);
    let closures = graph.closures.iter();
    for linear in closures.filter_map(|closure| Linear::of(graph, closure)) {
        let weighted = times(&linear.information, &of(&linear));
        for (jacobian, key) in linear.jacobians.iter().zip([linear.from, linear.to]) {
            if let Some(force) = forces.get_mut(key) {
                *force = add(force, &transposed_times(jacobian, &weighted), 1.0);
            }
        }
    }
}

impl Linear {
    fn of<const KEYS: usize, const LOOPS: usize, const BEAMS: usize>(
        graph: &Graph<KEYS, LOOPS, BEAMS>,
        closure: &Closure,
    ) -> Option<Self> {
        let [from, to] = graph.ends(closure)?;
        let residual = closure.residual(&from, &to);
        let weight = graph.weight(closure, &residual);
        let (s, c) = sin_cos(from.yaw_rad);
        let (dx, dy) = (to.x_m - from.x_m, to.y_m - from.y_m);
        Some(Self {
            from: closure.from.into(),
            to: closure.to.into(),
            jacobians: [
                [
                    [-c, -s, c * dy - s * dx],
                    [s, -c, -c * dx - s * dy],
                    [0.0, 0.0, -1.0],
                ],
                [[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]],
            ],
            information: closure.information.map(|row| row.map(|it| weight * it)),
            residual,
        })
    }

    /// Returns how the residual changes if poses move.
    fn change(&self, moves: &[Vector]) -> Vector {
        let of = |key: usize| moves.get(key).copied().unwrap_or_default();
        let [from, to] = &self.jacobians;
        add(&times(from, &of(self.from)), &times(to, &of(self.to)), 1.0)
    }
}

/// The first keyframe has no motion, and does not move.
fn pin<const KEYS: usize>(vectors: &mut [Vector; KEYS]) {
    if let Some(first) = vectors.first_mut() {
        *first = [0.0; 3];
    }
}

/// Returns a + s b.
fn add(a: &Vector, b: &Vector, s: f32) -> Vector {
    let ([a, b, c], [x, y, z]) = (a, b);
    [a + s * x, b + s * y, c + s * z]
}

fn add_to<const KEYS: usize>(a: &mut [Vector; KEYS], b: &[Vector; KEYS], s: f32) {
    for (a, b) in a.iter_mut().zip(b) {
        *a = add(a, b, s);
    }
}

fn product<const KEYS: usize>(a: &[Vector; KEYS], b: &[Vector; KEYS]) -> f32 {
    a.iter().zip(b).map(|(a, b)| dot(a, b)).sum()
}

#[cfg(test)]
mod tests;

//! The converged window: q of the harmonic field, solved directly in f64.
//!
//! In every free cell q is the mean of its four neighbours, with 0 on obstacles and 1 on goals;
//! cells outside the window are obstacles. That is a linear system whose matrix has −1/4 beside a
//! diagonal of 1. It is eliminated in band form by the method of Grassmann, Taksar and Heyman: a
//! diagonal is the sum of the other entries of its row, never a difference. Only positive numbers
//! are added, so even a q of 1e-200 keeps its relative precision.
//!
//! The heading is that of ∇q by central differences, interpolated bilinearly between cell centres
//! as in the planner. Cost: n·w² for n free cells in a window of width w, about 14 million
//! multiplications.

use fieldline_protocol::message::{Command, FIELD_SIDE, Pose};

use super::snapshot::{Window, WindowCell};

const SIDE: usize = FIELD_SIDE;
/// Entries of a row on each side of its diagonal: the farthest neighbour is one window row away.
const BAND: usize = SIDE;

/// Returns the angle between the command's heading and that of the converged window at the robot's
/// pose, degrees; `None` if the robot is outside the window or the field is flat there.
#[must_use]
pub fn heading_error_deg(window: &Window, pose: &Pose, command: &Command) -> Option<f64> {
    let q = solve(&window.cells);
    let (x_m, y_m): (f64, f64) = (pose.x.to_num(), pose.y.to_num());
    let heading = heading_at(
        &q,
        x_m / window.cell_m - f64::from(window.origin_x),
        y_m / window.cell_m - f64::from(window.origin_y),
    )?;
    let told: f64 = command.heading.to_num();
    let error = told - heading;
    Some(error.sin().atan2(error.cos()).abs().to_degrees())
}

/// Returns q of every cell, row by row from the least y. It is 0 in cells without a way to a goal.
/// `cells` are the window's, `FIELD_SIDE` square.
#[must_use]
pub fn solve(cells: &[WindowCell]) -> Vec<f64> {
    let unknowns = connected(cells);
    let mut order = vec![None; SIDE * SIDE];
    for (i, &cell) in unknowns.iter().enumerate() {
        order[cell] = Some(i);
    }
    let mut system = System::new(unknowns.len());
    for (i, &cell) in unknowns.iter().enumerate() {
        for near in neighbours(cell) {
            match near.and_then(|near| Some((*cells.get(near)?, order[near]))) {
                Some((_, Some(j))) => system.couple(i, j),
                Some((WindowCell::Goal, None)) => system.lead_to_goal(i),
                _ => system.lead_to_obstacle(i),
            }
        }
    }
    let mut q: Vec<f64> = cells
        .iter()
        .map(|&cell| f64::from(u8::from(cell == WindowCell::Goal)))
        .collect();
    for (&cell, value) in unknowns.iter().zip(system.solve()) {
        q[cell] = value;
    }
    q
}

/// Returns the heading of ∇q at a point of the window, in cells; `None` if the field is flat in the
/// point's own cell.
#[must_use]
pub fn heading_at(q: &[f64], x: f64, y: f64) -> Option<f64> {
    let inside = |v: f64| (0.0..SIDE as f64).contains(&v);
    if !inside(x) || !inside(y) {
        return None;
    }
    if gradient(q, x as isize, y as isize) == (0.0, 0.0) {
        return None;
    }
    let (west, south) = ((x - 0.5).floor(), (y - 0.5).floor());
    let (along, up) = (x - 0.5 - west, y - 0.5 - south);
    let corners = [
        (0.0, 0.0, (1.0 - along) * (1.0 - up)),
        (1.0, 0.0, along * (1.0 - up)),
        (0.0, 1.0, (1.0 - along) * up),
        (1.0, 1.0, along * up),
    ];
    let gradients = corners.map(|(dx, dy, weight)| {
        let (gx, gy) = gradient(q, (west + dx) as isize, (south + dy) as isize);
        (weight * gx, weight * gy)
    });
    let (gx, gy) = gradients
        .iter()
        .fold((0.0, 0.0), |sum, g| (sum.0 + g.0, sum.1 + g.1));
    (gx != 0.0 || gy != 0.0).then(|| gy.atan2(gx))
}

/// Returns twice ∇q in a free cell with a way to a goal; 0 in others.
fn gradient(q: &[f64], x: isize, y: isize) -> (f64, f64) {
    let at = |x: isize, y: isize| {
        let (x, y) = (usize::try_from(x).ok()?, usize::try_from(y).ok()?);
        if x < SIDE { q.get(y * SIDE + x) } else { None }
    };
    let value = |x, y| at(x, y).copied().unwrap_or(0.0);
    let here = value(x, y);
    if here <= 0.0 || here >= 1.0 {
        return (0.0, 0.0);
    }
    (
        value(x + 1, y) - value(x - 1, y),
        value(x, y + 1) - value(x, y - 1),
    )
}

/// Returns the four neighbours of a cell; `None` outside the window.
fn neighbours(cell: usize) -> [Option<usize>; 4] {
    let (x, y) = (cell % SIDE, cell / SIDE);
    [
        (x > 0).then(|| cell - 1),
        (x + 1 < SIDE).then_some(cell + 1),
        (y > 0).then(|| cell - SIDE),
        (y + 1 < SIDE).then_some(cell + SIDE),
    ]
}

/// Returns the free cells with a way to a goal, ascending.
fn connected(cells: &[WindowCell]) -> Vec<usize> {
    let is = |cell: usize, kind| cells.get(cell) == Some(&kind);
    let mut seen = vec![false; SIDE * SIDE];
    let mut pending: Vec<usize> = (0..SIDE * SIDE)
        .filter(|&cell| is(cell, WindowCell::Goal))
        .collect();
    while let Some(cell) = pending.pop() {
        for near in neighbours(cell).into_iter().flatten() {
            if is(near, WindowCell::Free) && !seen[near] {
                seen[near] = true;
                pending.push(near);
            }
        }
    }
    (0..SIDE * SIDE).filter(|&cell| seen[cell]).collect()
}

/// Weights of each unknown to other unknowns, to obstacles and to goals, all positive.
struct System {
    /// `band[i][BAND + j − i]`: the weight from i to j.
    band: Vec<[f64; 2 * BAND + 1]>,
    obstacle: Vec<f64>,
    goal: Vec<f64>,
}

impl System {
    fn new(unknowns: usize) -> Self {
        Self {
            band: vec![[0.0; 2 * BAND + 1]; unknowns],
            obstacle: vec![0.0; unknowns],
            goal: vec![0.0; unknowns],
        }
    }

    fn couple(&mut self, i: usize, j: usize) {
        self.band[i][BAND + j - i] += 1.0;
    }

    fn lead_to_goal(&mut self, i: usize) {
        self.goal[i] += 1.0;
    }

    fn lead_to_obstacle(&mut self, i: usize) {
        self.obstacle[i] += 1.0;
    }

    /// Eliminates downwards, then substitutes upwards.
    fn solve(mut self) -> Vec<f64> {
        for k in 0..self.band.len() {
            let pivot = self.normalise(k);
            for i in k + 1..self.band.len().min(k + BAND + 1) {
                self.eliminate(k, i, &pivot);
            }
        }
        let mut q = vec![0.0; self.band.len()];
        for k in (0..q.len()).rev() {
            let later = &self.band[k][BAND + 1..];
            let sum: f64 = later.iter().zip(&q[k + 1..]).map(|(w, q)| w * q).sum();
            q[k] = self.goal[k] + sum;
        }
        q
    }

    /// Divides row k by its diagonal: the sum of its weights without those to earlier unknowns,
    /// which are eliminated already. Returns its weights to later unknowns.
    fn normalise(&mut self, k: usize) -> [f64; BAND] {
        let later: f64 = self.band[k][BAND + 1..].iter().sum();
        let diagonal = later + self.obstacle[k] + self.goal[k];
        let mut pivot = [0.0; BAND];
        for (slot, weight) in pivot.iter_mut().zip(&mut self.band[k][BAND + 1..]) {
            *weight /= diagonal;
            *slot = *weight;
        }
        self.obstacle[k] /= diagonal;
        self.goal[k] /= diagonal;
        pivot
    }

    /// Replaces row i's weight to k by row k's weights.
    fn eliminate(&mut self, k: usize, i: usize, pivot: &[f64; BAND]) {
        let to_k = BAND + k - i;
        let weight = self.band[i][to_k];
        if weight == 0.0 {
            return;
        }
        for (slot, via) in self.band[i][to_k + 1..].iter_mut().zip(pivot) {
            *slot += weight * via;
        }
        // A walk back to i does not change the ratios of the row's weights.
        self.band[i][BAND] = 0.0;
        self.obstacle[i] += weight * self.obstacle[k];
        self.goal[i] += weight * self.goal[k];
    }
}

#[cfg(test)]
mod tests {
    use super::{SIDE, WindowCell, heading_at, solve};

    fn window(of: impl Fn(usize, usize) -> WindowCell) -> Vec<WindowCell> {
        (0..SIDE * SIDE).map(|i| of(i % SIDE, i / SIDE)).collect()
    }

    /// Relaxes plainly until nothing changes: the reference for the direct solution.
    fn relaxed(cells: &[WindowCell]) -> Vec<f64> {
        let mut q: Vec<f64> = cells
            .iter()
            .map(|&c| f64::from(u8::from(c == WindowCell::Goal)))
            .collect();
        loop {
            let mut change = 0.0_f64;
            for i in 0..q.len() {
                if cells[i] != WindowCell::Free {
                    continue;
                }
                let near = super::neighbours(i);
                let next = near.iter().flatten().map(|&n| q[n]).sum::<f64>() / 4.0;
                change = change.max((next - q[i]).abs() / next.max(1e-300));
                q[i] = next;
            }
            if change < 1e-14 {
                return q;
            }
        }
    }

    #[test]
    fn direct_and_relaxed_agree_on_rooms_with_doors() {
        let cells = window(|x, y| match (x, y) {
            (5, 50) | (6, 50) => WindowCell::Goal,
            (20, y) if !(30..36).contains(&y) => WindowCell::Obstacle,
            (x, 40) if x < 20 && !(8..12).contains(&x) => WindowCell::Obstacle,
            (x, y) if (x * 7 + y * 13) % 29 == 0 => WindowCell::Obstacle,
            _ => WindowCell::Free,
        });
        let (direct, relaxed) = (solve(&cells), relaxed(&cells));
        for (i, (a, b)) in direct.iter().zip(&relaxed).enumerate() {
            assert!((a - b).abs() <= 1e-9 * b.abs(), "cell {i}: {a} {b}");
        }
    }

    /// In a corridor one cell wide every inner cell obeys q = (q⁻ + q⁺)/4. So q falls by 2 − √3, a
    /// root of r² − 4r + 1, from cell to cell, to 1e-33 at the far end.
    #[test]
    fn the_far_end_of_a_corridor_keeps_its_digits() {
        let cells = window(|x, y| match (x, y) {
            (0, 30) => WindowCell::Goal,
            (_, 30) => WindowCell::Free,
            _ => WindowCell::Obstacle,
        });
        let q = solve(&cells);
        let ratio = 2.0 - 3.0_f64.sqrt();
        for x in 1..40 {
            let (here, before) = (q[30 * SIDE + x], q[30 * SIDE + x - 1]);
            assert!(
                (here / before - ratio).abs() < 1e-12,
                "{x}: {}",
                here / before
            );
        }
        assert!(q[30 * SIDE + SIDE - 1] > 0.0 && q[30 * SIDE + SIDE - 1] < 1e-33);
    }

    #[test]
    fn headings_point_at_the_goal_and_flat_has_none() {
        let goal_at = |gx: usize, gy: usize| {
            window(move |x, y| {
                if (x, y) == (gx, gy) {
                    WindowCell::Goal
                } else {
                    WindowCell::Free
                }
            })
        };
        let heading = |gx, gy, x, y| heading_at(&solve(&goal_at(gx, gy)), x, y);
        let east = heading(50, 30, 30.5, 30.5).unwrap();
        assert!(east.abs() < 1e-12, "{east}");
        let north_west = heading(10, 50, 30.5, 30.5).unwrap();
        assert!((north_west - 0.75 * core::f64::consts::PI).abs() < 1e-12);
        assert_eq!(
            heading_at(&solve(&window(|_, _| WindowCell::Free)), 30.5, 30.5),
            None
        );
        assert_eq!(heading(50, 30, -1.0, 30.0), None);
    }
}

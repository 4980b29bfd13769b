//! The force on the robot \[Kenealy15, eqs. 2–6 and 11\].
//!
//! ```text
//! F_rep(q) = Σ (1/ρ − 1/ρ₀) R(α) (q − q_i)/ρ³   over obstacles with ρ ≤ ρ₀      (eqs. 2, 3, 11)
//! F_att(q) = Σ w (q_i − q) ρ²                   over the cells that attract     (eqs. 5, 6)
//! F = F_att/|F_att| + K F_rep;                  ρ = |q − q_i|
//! w = claimed if a peer that drives is nearer to the cell, 1 else
//! ```
//!
//! The drive follows the direction of F. Cells that a peer visited repel as obstacles do, but with
//! a weight of their own, and α = 0. So do covered cells, with the weight `sbpf.covered`.
//!
//! Departs from \[Kenealy15, eq. 3\]: that weight is 0. The paper sums over every cell with a
//! level, so it repels from covered cells too; 1 is its form.
//!
//! Departs from \[Kenealy15, eq. 5\] in a team: without *w* the farthest cells attract all robots
//! alike, and two that start side by side stay so (measured: docs/MEASURED.md, "Claimed cells in a
//! team").
//!
//! Departs from \[Kenealy15, eqs. 2 and 5\]: the attraction has magnitude 1. The paper weighs
//! `F_rep` with `1/(2 c k_rep)` and `F_att` with `k_att/c`, where c is the coverage. In the
//! direction of their sum c cancels, and only `1/(2 k_rep k_att)` is left. No value of it serves:
//! `F_att` falls by a factor of thousands from the first cells to the last (measured:
//! docs/MEASURED.md, "Weights of attraction and repulsion").
//!
//! Units: metres.

use heapless::Vec;

use crate::config::SbpfTuning;
use crate::grid::bits::ones64;
use crate::math;
use crate::strategy::sbpf::edges::attractive;
use crate::strategy::sbpf::levels::{Levels, Place};
use crate::team::peers::MOST_PEERS;

/// A vector in the map's frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Vector {
    pub(super) x: f32,
    pub(super) y: f32,
}

impl Vector {
    /// Adds a multiple of another vector.
    fn add(&mut self, other: Self, weight: f32) {
        self.x += other.x * weight;
        self.y += other.y * weight;
    }

    fn square(self) -> f32 {
        self.x * self.x + self.y * self.y
    }

    /// Returns the vector turned to the left.
    fn turned(self, angle_rad: f32) -> Self {
        let (sin, cos) = math::sin_cos(angle_rad);
        Self {
            x: self.x * cos - self.y * sin,
            y: self.x * sin + self.y * cos,
        }
    }
}

/// The claims of the other robots on the cells that attract.
#[derive(Debug)]
pub(super) struct Claims {
    /// Where those are that may drive.
    pub(super) rivals: Vec<Place, MOST_PEERS>,
    /// Weight of a cell to which one of them is nearer.
    pub(super) weight: f32,
}

/// Returns the heading of the force at a place, radians; `None` if nothing attracts.
pub(super) fn heading_rad(
    levels: &Levels,
    at: Place,
    claims: &Claims,
    enhanced: bool,
    tuning: &SbpfTuning,
) -> Option<f32> {
    let attraction = attraction(levels, at, claims, enhanced)?;
    let twist_rad = if enhanced { tuning.twist_rad } else { 0.0 };
    let mut force = repulsion(levels, at, twist_rad, tuning);
    let length = math::sqrt(attraction.square());
    force.add(attraction, 1.0 / (tuning.repulsion * length).max(1e-9));
    Some(math::atan2(force.y, force.x))
}

/// Returns `F_att`; `None` if nothing attracts.
pub(super) fn attraction(
    levels: &Levels,
    at: Place,
    claims: &Claims,
    has_gates: bool,
) -> Option<Vector> {
    let mut force = None;
    for y in levels.rows() {
        for x in ones64(attractive(levels, y, has_gates)) {
            let away = from_cell(levels, at, x, y);
            let force = force.get_or_insert_with(Vector::default);
            let distance2 = away.square();
            let is_nearer = |&rival: &Place| from_cell(levels, rival, x, y).square() < distance2;
            let is_claimed = claims.rivals.iter().any(is_nearer);
            let weight = if is_claimed { claims.weight } else { 1.0 };
            force.add(away, -weight * distance2);
        }
    }
    force
}

/// Returns `F_rep`, with the shares of the peers and of covered cells. At most all cells of the
/// area are summed: 64 × 64.
pub(super) fn repulsion(levels: &Levels, at: Place, twist_rad: f32, tuning: &SbpfTuning) -> Vector {
    let [mut walls, mut peers, mut covered] = [Vector::default(); 3];
    for y in levels.rows() {
        let stones = levels.obstacle(y);
        let tracks = levels.visited(y);
        let rest = if tuning.covered > 0.0 {
            levels.covered(y)
        } else {
            0
        };
        for x in ones64(stones | tracks | rest) {
            let away = from_cell(levels, at, x, y);
            if let Some(part) = repulsion_of(away, levels.cell_m(), tuning.range_m) {
                let sum = if stones >> x & 1 == 1 {
                    &mut walls
                } else if tracks >> x & 1 == 1 {
                    &mut peers
                } else {
                    &mut covered
                };
                sum.add(away, part);
            }
        }
    }
    let mut force = walls.turned(twist_rad);
    force.add(peers, tuning.peer);
    force.add(covered, tuning.covered);
    force
}

/// Returns the repulsion of a cell per metre of `away`, the vector from its centre. `None` beyond
/// its range. A robot beside a wall may be in the wall's cell: half a cell is the least distance.
fn repulsion_of(away: Vector, cell_m: f32, range_m: f32) -> Option<f32> {
    let distance2 = away.square();
    (distance2 <= range_m * range_m).then(|| {
        let distance_m = math::sqrt(distance2).max(0.5 * cell_m);
        (1.0 / distance_m - 1.0 / range_m) / (distance_m * distance_m * distance_m)
    })
}

/// Returns the vector from a cell's centre to a place, metres.
fn from_cell(levels: &Levels, at: Place, x: u32, y: i32) -> Vector {
    let cell_m = levels.cell_m();
    Vector {
        x: (at.x - x as f32 - 0.5) * cell_m,
        y: (at.y - y as f32 - 0.5) * cell_m,
    }
}

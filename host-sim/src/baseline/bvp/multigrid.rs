//! The solver of the full-grid field: cycles over coarser and coarser graphs. Each step starts from
//! the solution of the step before.
//!
//! One cycle works down from the finest level. It sums the equations of every group, solves for the
//! factors of the groups on the next level (twice on the coarse levels: a W cycle), scales the
//! groups, and sweeps once. The coarsest level is solved directly. With preferences the flows of
//! the finest level are tilted anew before each cycle. With a preference beyond ±1 a cycle is
//! [`STRONG_SWEEPS`] sweeps of the finest level.
//!
//! Work is counted in *cell updates*: one per node for a sweep, for summing, for scaling, and for
//! tilting.

use super::graph::{FEW, Level, Node};

/// Sweeps after the scaling of a level; they smooth the jumps at the edges of the groups.
const SWEEPS: usize = 1;
/// Beyond this preference, coarse levels do not help: the factors overshoot while the flows
/// reverse.
const STRONG: f32 = 1.0;
/// Sweeps of a cycle with such preferences.
const STRONG_SWEEPS: usize = 16;

/// The solver; its first level is the finest.
#[derive(Clone, Debug, Default)]
pub(super) struct Multigrid {
    levels: Vec<Level>,
    nodes: Vec<Node>,
    goal: f64,
    /// ε of every node; empty without preferences.
    preferences: Vec<f32>,
    is_strong: bool,
    backwards: bool,
    /// Cell updates so far.
    pub(super) updates: u64,
}

impl Multigrid {
    /// Makes the levels for nodes and their places; the value of every node is that of a goal.
    pub(super) fn new(nodes: Vec<Node>, places: Vec<(u32, u32)>, goal: f64) -> Self {
        let mut levels = vec![Level::finest(&nodes, goal)];
        let mut places = places;
        // The nodes are connected, so they are one group when all places are one.
        while let Some(last) = levels.last_mut()
            && last.len() > FEW
            && places.iter().any(|&place| place != (0, 0))
        {
            let (coarse, coarse_places) = last.coarsen(&places);
            levels.push(coarse);
            places = coarse_places;
        }
        Self {
            levels,
            nodes,
            goal,
            ..Self::default()
        }
    }

    /// Returns q of every node.
    pub(super) fn values(&self) -> &[f64] {
        self.levels.first().map_or(&[], |level| &level.value)
    }

    /// Sets q of a node, to start from.
    pub(super) fn set(&mut self, node: usize, value: f64) {
        if let Some(level) = self.levels.first_mut() {
            level.value[node] = value;
        }
    }

    /// Sets ε of every node for the next cycles.
    pub(super) fn prefer(&mut self, preferences: Vec<f32>) {
        self.is_strong = preferences.iter().any(|epsilon| epsilon.abs() > STRONG);
        self.preferences = preferences;
    }

    /// Runs one cycle.
    pub(super) fn cycle(&mut self) {
        self.backwards = !self.backwards;
        let mut updates = 0;
        if !self.preferences.is_empty()
            && let Some(finest) = self.levels.first_mut()
        {
            finest.tilt(&self.nodes, &self.preferences, self.goal);
            updates += finest.len() as u64;
            if self.is_strong {
                (0..STRONG_SWEEPS).for_each(|k| finest.sweep(k % 2 == 0));
                self.updates += updates + (STRONG_SWEEPS * finest.len()) as u64;
                return;
            }
        }
        descend(&mut self.levels, 1, self.backwards, &mut updates);
        self.updates += updates;
    }
}

/// Runs a cycle on the first of these levels, `times` times.
fn descend(levels: &mut [Level], times: usize, backwards: bool, updates: &mut u64) {
    let Some((level, coarser)) = levels.split_first_mut() else {
        return;
    };
    let count = level.len() as u64;
    if coarser.is_empty() {
        level.eliminate();
        *updates += count;
        return;
    }
    for _ in 0..times {
        level.restrict(&mut coarser[0]);
        descend(coarser, 2, backwards, updates);
        level.prolong(&coarser[0]);
        for _ in 0..SWEEPS {
            level.sweep(backwards);
        }
        *updates += count * (2 + SWEEPS as u64);
    }
}

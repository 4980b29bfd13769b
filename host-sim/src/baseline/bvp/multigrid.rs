//! The solver of the full-grid field: cycles over ever coarser graphs, warm from the step before.
//!
//! One cycle works down from the finest level: it sums the equations of every group, solves for the groups' factors by the
//! same means (twice on the coarse levels, a W cycle), scales, and sweeps once. The coarsest level is solved directly. With preferences the flows
//! of the finest level are tilted anew before each cycle; under preferences beyond ±1 a cycle is 16 sweeps and nothing else.
//! Work is counted in *cell updates*: one for a node swept, one for a node summed or scaled, and one for a node whose flows are tilted.

use super::graph::{FEW, Level, Node};

/// Sweeps after the factors of a level, so that steps at the groups' edges are smoothed.
const SWEEPS: usize = 1;
/// Beyond this preference coarse levels do not help any more: factors overshoot while the flows turn round.
const FIRM: f32 = 1.0;
/// Sweeps that take the place of a cycle then.
const STRONG_SWEEPS: usize = 16;

/// The levels, the finest first.
#[derive(Clone, Debug, Default)]
pub(super) struct Multigrid {
    levels: Vec<Level>,
    nodes: Vec<Node>,
    goal: f64,
    /// ε of every node, where there are preferences.
    preferences: Vec<f32>,
    is_strong: bool,
    backwards: bool,
    /// Cell updates so far.
    pub(super) updates: u64,
}

impl Multigrid {
    /// For these nodes at these places; every value is that of a goal.
    pub(super) fn new(nodes: Vec<Node>, places: Vec<(u32, u32)>, goal: f64) -> Self {
        let mut levels = vec![Level::finest(&nodes, goal)];
        let mut places = places;
        // The reached cells are connected, so they end as one group when all places have become one.
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

    /// q of the nodes.
    pub(super) fn values(&self) -> &[f64] {
        self.levels.first().map_or(&[], |level| &level.value)
    }

    /// Start from these.
    pub(super) fn set(&mut self, node: usize, value: f64) {
        if let Some(level) = self.levels.first_mut() {
            level.value[node] = value;
        }
    }

    /// From now on with these preferences, ε of every node.
    pub(super) fn prefer(&mut self, preferences: Vec<f32>) {
        self.is_strong = preferences.iter().any(|epsilon| epsilon.abs() > FIRM);
        self.preferences = preferences;
    }

    /// One cycle.
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

//! Balance equations on a graph, and its coarser graphs, for the full-grid field.
//!
//! Every level has unknowns x > 0 with
//!
//! ```text
//! x_i (w_i + Σ_k f_ki) = Σ_j f_ij x_j + b_i
//! ```
//!
//! `f_ij` ≥ 0 is the flow from j into i, `w_i` ≥ 0 the loss to cells with a given value, and `b_i`
//! ≥ 0 the source from goals. On the finest level x is q: every f is 1, w is the number of
//! neighbours that are goals or obstacles (the f and w of a node sum to 4), and b is the value of
//! the goals among them. A coarser level scales groups of x by common factors y. Its coefficients
//!
//! ```text
//! F_IJ = Σ f_ij x_j        W_J = Σ w_j x_j        B_I = Σ b_i
//! ```
//!
//! are sums of positive numbers only, so they keep their precision over any range of x. A group is
//! a connected part of a block of 2 × 2 places: it never joins the two sides of a wall.
//!
//! Preferences \[Maffei20, eq. 2\] tilt the flows of the finest level. Of two opposite neighbours
//! the greater x flows in by 1 + ε/2 and the smaller by 1 − ε/2, with x as it is at the time. The
//! loss `w_j = 4 − Σ_k f_kj` may then be slightly negative. So a factor is limited to twice what
//! the neighbours and goals of its group ask for.

use core::cmp::Ordering;

/// Index of no node or no edge.
const NONE: u32 = u32::MAX;

/// Greatest number of nodes that is solved directly.
pub(super) const FEW: usize = 40;

/// A level. Node i has the edges `starts[i]..starts[i + 1]`.
#[derive(Clone, Debug, Default)]
pub(super) struct Level {
    starts: Vec<u32>,
    /// The node that each edge comes from.
    from: Vec<u32>,
    /// f of each edge.
    flow: Vec<f64>,
    loss: Vec<f64>,
    source: Vec<f64>,
    /// `w_i` + `Σ_k` `f_ki`.
    outflow: Vec<f64>,
    /// x.
    pub(super) value: Vec<f64>,
    /// True if preferences tilt the flows.
    tilted: bool,
    /// The coarser node of each node, and the coarser edge of each edge ([`NONE`] within a group).
    group: Vec<u32>,
    group_edge: Vec<u32>,
}

/// A cell of the finest level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Node {
    /// The free neighbours, by number: east, north, west, south.
    pub(super) beside: [Option<u32>; 4],
    /// Neighbours that are goals: bit k for the place of `beside[k]`.
    pub(super) goals: u8,
}

impl Node {
    fn is_goal(&self, k: usize) -> bool {
        self.goals >> k & 1 == 1
    }
}

impl Level {
    /// Makes the finest level, with goals of the value `goal`.
    pub(super) fn finest(nodes: &[Node], goal: f64) -> Self {
        let mut level = Self::with_capacity(nodes.len());
        for node in nodes {
            for near in node.beside.into_iter().flatten() {
                level.from.push(near);
            }
            level.starts.push(level.from.len() as u32);
            let free = node.beside.into_iter().flatten().count();
            level.loss.push((4 - free) as f64);
            level.source.push(f64::from(node.goals.count_ones()) * goal);
        }
        level.flow = vec![1.0; level.from.len()];
        level.outflow = vec![4.0; nodes.len()];
        level.value = vec![goal; nodes.len()];
        level
    }

    /// Tilts the flows of the finest level by the preferences of the nodes, for the present x.
    pub(super) fn tilt(&mut self, nodes: &[Node], preferences: &[f32], goal: f64) {
        self.tilted = true;
        self.loss.fill(4.0);
        for (i, (node, epsilon)) in nodes.iter().zip(preferences).enumerate() {
            let value = |k: usize| match node.beside[k] {
                Some(near) => self.value[near as usize],
                None if node.is_goal(k) => goal,
                None => 0.0,
            };
            let half = 0.5 * f64::from(*epsilon);
            let by = |a: usize, b: usize| match value(a).total_cmp(&value(b)) {
                Ordering::Greater => half,
                Ordering::Less => -half,
                Ordering::Equal => 0.0,
            };
            let (along, up) = (by(0, 2), by(1, 3));
            let weights = [1.0 + along, 1.0 + up, 1.0 - along, 1.0 - up];
            let (mut edge, mut source) = (self.starts[i] as usize, 0.0);
            for (k, weight) in weights.into_iter().enumerate() {
                if let Some(near) = node.beside[k] {
                    self.flow[edge] = weight;
                    self.loss[near as usize] -= weight;
                    edge += 1;
                } else if node.is_goal(k) {
                    source += weight * goal;
                }
            }
            self.source[i] = source;
        }
    }

    fn with_capacity(nodes: usize) -> Self {
        let mut level = Self {
            starts: Vec::with_capacity(nodes + 1),
            ..Self::default()
        };
        level.starts.push(0);
        level
    }

    /// Returns the number of nodes.
    pub(super) fn len(&self) -> usize {
        self.starts.len() - 1
    }

    fn edges(&self, node: usize) -> core::ops::Range<usize> {
        self.starts[node] as usize..self.starts[node + 1] as usize
    }

    /// Runs one Gauss–Seidel sweep, in either order.
    pub(super) fn sweep(&mut self, backwards: bool) {
        let count = self.len();
        for k in 0..count {
            let node = if backwards { count - 1 - k } else { k };
            let edges = self.edges(node);
            let inflow = self.from[edges.clone()].iter().zip(&self.flow[edges]);
            let sum: f64 = inflow
                .map(|(&near, flow)| flow * self.value[near as usize])
                .sum();
            if self.outflow[node] > 0.0 {
                self.value[node] = (sum + self.source[node]) / self.outflow[node];
            }
        }
    }

    /// Makes the next coarser level from the places of this level's nodes; returns it and the
    /// places of its nodes. Its coefficients are not set yet.
    pub(super) fn coarsen(&mut self, places: &[(u32, u32)]) -> (Self, Vec<(u32, u32)>) {
        let block = |node: usize| (places[node].0 / 2, places[node].1 / 2);
        let count = self.groups(&block);
        let mut blocks = vec![(0, 0); count];
        for (node, &group) in self.group.iter().enumerate() {
            blocks[group as usize] = block(node);
        }
        (self.join(count), blocks)
    }

    /// Numbers the connected parts of every block; returns their number.
    fn groups(&mut self, block: &impl Fn(usize) -> (u32, u32)) -> usize {
        self.group = vec![NONE; self.len()];
        let (mut count, mut pending) = (0, Vec::new());
        for first in 0..self.len() {
            if self.group[first] != NONE {
                continue;
            }
            self.group[first] = count;
            pending.push(first);
            while let Some(node) = pending.pop() {
                for edge in self.edges(node) {
                    let near = self.from[edge] as usize;
                    if self.group[near] == NONE && block(near) == block(first) {
                        self.group[near] = count;
                        pending.push(near);
                    }
                }
            }
            count += 1;
        }
        count as usize
    }

    /// Makes the graph of the groups.
    fn join(&mut self, count: usize) -> Self {
        let mut coarse = Self::with_capacity(count);
        let members = members(&self.group, count);
        // The last edge to each group; it belongs to the present group if it is not before its
        // first edge.
        let mut last_edge = vec![NONE; count];
        self.group_edge = vec![NONE; self.from.len()];
        for (group, nodes) in members.iter().enumerate() {
            let first = coarse.from.len() as u32;
            for &node in nodes {
                for edge in self.edges(node as usize) {
                    let other = self.group[self.from[edge] as usize];
                    if other as usize == group {
                        continue;
                    }
                    let known = last_edge[other as usize];
                    if known == NONE || known < first {
                        last_edge[other as usize] = coarse.from.len() as u32;
                        coarse.from.push(other);
                    }
                    self.group_edge[edge] = last_edge[other as usize];
                }
            }
            coarse.starts.push(coarse.from.len() as u32);
        }
        coarse.flow = vec![0.0; coarse.from.len()];
        for numbers in [
            &mut coarse.loss,
            &mut coarse.source,
            &mut coarse.outflow,
            &mut coarse.value,
        ] {
            *numbers = vec![0.0; count];
        }
        coarse
    }

    /// Sets the coefficients of the coarser level for the present x, and its factors to 1.
    pub(super) fn restrict(&self, coarse: &mut Self) {
        coarse.flow.fill(0.0);
        coarse.loss.fill(0.0);
        coarse.source.fill(0.0);
        coarse.value.fill(1.0);
        for (node, &group) in self.group.iter().enumerate() {
            let group = group as usize;
            coarse.loss[group] += self.loss[node] * self.value[node];
            coarse.source[group] += self.source[node];
            for edge in self.edges(node) {
                let into = self.group_edge[edge];
                if into != NONE {
                    coarse.flow[into as usize] +=
                        self.flow[edge] * self.value[self.from[edge] as usize];
                }
            }
        }
        coarse.outflow.copy_from_slice(&coarse.loss);
        for (&from, flow) in coarse.from.iter().zip(&coarse.flow) {
            coarse.outflow[from as usize] += flow;
        }
        coarse.tilted = self.tilted;
        if self.tilted {
            coarse.limit_factors();
        }
    }

    /// Limits every factor to 2 for factors of 1 at the neighbours.
    fn limit_factors(&mut self) {
        for node in 0..self.len() {
            let edges = self.edges(node);
            let inflow = self.flow[edges].iter().sum::<f64>() + self.source[node];
            let missing = 0.5 * inflow - self.outflow[node];
            if missing > 0.0 {
                self.outflow[node] += missing;
                self.loss[node] += missing;
            }
        }
    }

    /// Scales every x by the factor of its group.
    pub(super) fn prolong(&mut self, coarse: &Self) {
        for (value, &group) in self.value.iter_mut().zip(&self.group) {
            *value *= coarse.value[group as usize];
        }
    }

    /// Solves directly by the elimination of Grassmann, Taksar and Heyman: the rest of a column is
    /// summed anew and never subtracted, so nothing cancels. Cost: n³/3 operations.
    pub(super) fn eliminate(&mut self) {
        let count = self.len();
        let mut flow = vec![vec![0.0; count]; count];
        for (node, row) in flow.iter_mut().enumerate() {
            for edge in self.edges(node) {
                row[self.from[edge] as usize] = self.flow[edge];
            }
        }
        let (mut loss, mut source) = (self.loss.clone(), self.source.clone());
        let mut outflow = vec![0.0; count];
        for last in (0..count).rev() {
            outflow[last] = loss[last] + (0..last).map(|i| flow[i][last]).sum::<f64>();
            if outflow[last] <= 0.0 {
                continue;
            }
            let via = flow[last].clone();
            for i in 0..last {
                let share = flow[i][last] / outflow[last];
                if share > 0.0 {
                    source[i] += share * source[last];
                    for (j, inflow) in via[..last].iter().enumerate().filter(|(j, _)| *j != i) {
                        flow[i][j] += share * inflow;
                    }
                }
                loss[i] += loss[last] / outflow[last] * via[i];
            }
        }
        for i in (0..count).filter(|&i| outflow[i] > 0.0).collect::<Vec<_>>() {
            let sum: f64 = (0..i).map(|j| flow[i][j] * self.value[j]).sum();
            self.value[i] = (sum + source[i]) / outflow[i];
        }
    }
}

/// Returns the nodes of each group, in ascending order.
fn members(group: &[u32], count: usize) -> Vec<Vec<u32>> {
    let mut members = vec![Vec::new(); count];
    for (node, &group) in (0..).zip(group) {
        members[group as usize].push(node);
    }
    members
}

#[cfg(test)]
mod tests;

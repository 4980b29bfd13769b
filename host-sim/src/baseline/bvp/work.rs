//! Cost of a run of the full-grid baseline, in counts that do not depend on the machine.

/// Counts of a run so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Steps.
    pub steps: u64,
    /// Free cells of the field, summed over the steps.
    pub cells: u64,
    /// Greatest number of free cells in a step.
    pub most_cells: u64,
    /// Greatest number of cells of the chart in a step.
    pub box_cells: u64,
    /// Cell updates of the solver.
    pub updates: u64,
    /// Solver cycles.
    pub cycles: u64,
}

impl Work {
    /// Adds a step with a field of `cells` free cells in a chart of `box_cells`, after `cycles`
    /// cycles. `updates` is the sum of the run.
    pub(super) fn add(&mut self, cells: usize, box_cells: usize, cycles: u16, updates: u64) {
        self.steps += 1;
        self.cells += cells as u64;
        self.most_cells = self.most_cells.max(cells as u64);
        self.box_cells = self.box_cells.max(box_cells as u64);
        self.updates = updates;
        self.cycles += u64::from(cycles);
    }
}

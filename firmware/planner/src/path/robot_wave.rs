//! A wave from the robot over the centre cells: the steps to every frontier cell, and the way back
//! from it.
//!
//! The wave enters the centre cells near the robot one after another, each after as many steps as
//! the robot needs to it. So the path to a goal begins where robot and path together have the
//! fewest steps.
//!
//! Units: coarse steps of 20 cm; sites of the skeleton's plane.

use crate::geometry::Cell;
use crate::grid::{Plane, Site};
use crate::path::Path;
use crate::path::search::PathSearch;
use crate::roadmap::Wavefront;

impl<const TILES: usize, const SLOTS: usize> PathSearch<'_, TILES, SLOTS> {
    /// Spreads a wave from the robot as far as the centre cells go. Calls `visit` with each cell of
    /// `marks` and the steps to it, the nearest first.
    pub(crate) fn spread_from(
        &mut self,
        robot: Cell,
        marks: Plane<'_>,
        mut visit: impl FnMut(Site, u32),
    ) {
        let Self {
            centres,
            space,
            local_grid,
        } = self;
        let mut wave = Wavefront::new();
        wave.start(space);
        let mut level = 0;
        let enter = |site, steps| {
            while level < steps && !wave.is_over() {
                wave.for_each_new(space, marks, |site| visit(site, level));
                wave.run_levels(space, 1);
                level += 1;
            }
            level = level.max(steps);
            wave.seed(space, site);
        };
        if !centres.entries(robot, local_grid, enter)
            && let Some((site, line)) = centres.nearest_in_line(robot, |_| true)
        {
            level = line.count() as u32;
            wave.seed(space, site);
        }
        while !wave.is_over() {
            wave.for_each_new(space, marks, |site| visit(site, level));
            wave.run_levels(space, 1);
            level += 1;
        }
    }

    /// Spreads a wave that enters these cells, each after its steps. Calls `visit` as
    /// [`Self::spread_from`].
    pub(crate) fn spread_entering(
        &mut self,
        entries: &[(Site, u32)],
        marks: Plane<'_>,
        mut visit: impl FnMut(Site, u32),
    ) {
        let space = &mut self.space;
        let mut wave = Wavefront::new();
        wave.start(space);
        let mut level = 0;
        loop {
            for (site, _) in entries.iter().filter(|(_, steps)| *steps == level) {
                wave.seed(space, *site);
            }
            if wave.is_over() {
                // The wave is at the next entry at once.
                let later = entries.iter().map(|(_, steps)| *steps);
                let Some(next) = later.filter(|steps| *steps > level).min() else {
                    return;
                };
                level = next;
                continue;
            }
            wave.for_each_new(space, marks, |site| visit(site, level));
            wave.run_levels(space, 1);
            level += 1;
        }
    }

    /// Returns the path from the robot to a cell that its wave reached, `steps` away.
    pub(crate) fn path_from_robot(&self, goal: Site, steps: u32) -> Path {
        let frame = self.centres.frame;
        let sites = || core::iter::once(goal).chain(self.space.residues.descent(goal));
        let cells = sites().map(|site| frame.cell(site));
        Path::back(cells, sites().count(), steps)
    }

    /// Returns the first cell within `radius_m` of the robot on the way back from a cell that its
    /// wave reached; the last one if none is.
    pub(crate) fn first_cell_near(&self, robot: Cell, goal: Site, radius_m: f32) -> Cell {
        let frame = self.centres.frame;
        let mut cell = frame.cell(goal);
        for site in self.space.residues.descent(goal) {
            if cell.distance2(robot) <= radius_m * radius_m {
                break;
            }
            cell = frame.cell(site);
        }
        cell
    }
}

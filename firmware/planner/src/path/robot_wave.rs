//! A wave from the robot over the centre cells: the steps to the frontier cells, and the way back
//! from each.
//!
//! The wave enters the centre cells near the robot one after another, each after as many steps as
//! the robot needs to it. So the path to a goal begins where robot and path together have the
//! fewest steps. The nearest centre cells may belong to a piece of the skeleton that leads nowhere.
//! So further waves enter the pieces that the ones before did not reach. Whoever has met enough
//! cells breaks the wave off.
//!
//! Units: coarse steps of 20 cm; sites of the skeleton's plane.

use core::ops::ControlFlow;

use heapless::Vec;

use crate::field::local_grid::SCALES;
use crate::geometry::Cell;
use crate::grid::{Plane, Site};
use crate::path::Path;
use crate::path::search::PathSearch;
use crate::path::ways_back::WaysBack;
use crate::roadmap::Wavefront;

/// Maximum number of pieces of the skeleton that the wave enters. In the local grid, 6 m wide, few
/// lie side by side.
const MOST_PIECES: usize = 4;
/// Maximum number of centre cells at which the wave enters a piece.
const MOST_ENTRIES: usize = 64;

impl<const TILES: usize, const SLOTS: usize> PathSearch<'_, TILES, SLOTS> {
    /// Spreads a wave from the robot as far as the centre cells go, or to where `visit` breaks it
    /// off. Calls `visit` with each cell of `marks` and the steps to it, the nearest first on each
    /// piece of the skeleton.
    pub(crate) fn spread_from(
        &mut self,
        robot: Cell,
        marks: Plane<'_>,
        mut visit: impl FnMut(Site, u32) -> ControlFlow<()>,
    ) {
        let mut wave = Wavefront::new();
        wave.start(&mut self.space);
        let mut entered = false;
        for piece in 0..MOST_PIECES {
            // Cells of the larger scales may join what a wall divides.
            let scales = if piece == 0 {
                &SCALES[..]
            } else {
                &SCALES[..1]
            };
            match self.enter_piece(&mut wave, (robot, scales), marks, &mut visit) {
                Some(ControlFlow::Continue(())) => entered = true,
                Some(ControlFlow::Break(())) => return,
                None => break,
            }
        }
        if !entered && let Some((site, line)) = self.centres.nearest_in_line(robot) {
            let entry = (site, line.count() as u32);
            let _ = self.run(&mut wave, &[entry], marks, &mut visit);
        }
    }

    /// Spreads the wave over the nearest piece of the skeleton that it has not reached. Returns
    /// `None` if there is none near the robot.
    #[inline(never)]
    fn enter_piece(
        &mut self,
        wave: &mut Wavefront,
        (robot, scales): (Cell, &[i32]),
        marks: Plane<'_>,
        visit: &mut impl FnMut(Site, u32) -> ControlFlow<()>,
    ) -> Option<ControlFlow<()>> {
        let mut entries = Vec::<(Site, u32), MOST_ENTRIES>::new();
        let Self {
            centres,
            space,
            local_grid,
        } = self;
        let are_new = |index| space.residues.unreached(index);
        let any = centres.entries(robot, (local_grid, scales), are_new, |site, steps| {
            // What does not fit is farther off than others.
            let _ = entries.push((site, steps));
        });
        any.then(|| self.run(wave, &entries, marks, visit))
    }

    /// Spreads a wave that enters these cells, each after its steps. Calls `visit` as
    /// [`Self::spread_from`].
    pub(crate) fn spread_entering(
        &mut self,
        entries: &[(Site, u32)],
        marks: Plane<'_>,
        mut visit: impl FnMut(Site, u32) -> ControlFlow<()>,
    ) {
        let mut wave = Wavefront::new();
        wave.start(&mut self.space);
        let _ = self.run(&mut wave, entries, marks, &mut visit);
    }

    /// Runs the wave through these entries to its end, or until `visit` breaks it off.
    fn run(
        &mut self,
        wave: &mut Wavefront,
        entries: &[(Site, u32)],
        marks: Plane<'_>,
        visit: &mut impl FnMut(Site, u32) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let space = &mut self.space;
        let mut level = 0;
        loop {
            for (site, _) in entries.iter().filter(|(_, steps)| *steps == level) {
                wave.seed(space, *site);
            }
            if wave.is_over() {
                // The wave is at the next entry at once.
                let later = entries.iter().map(|(_, steps)| *steps);
                let Some(next) = later.filter(|steps| *steps > level).min() else {
                    return ControlFlow::Continue(());
                };
                level = next;
                continue;
            }
            let mut flow = ControlFlow::Continue(());
            wave.for_each_new(space, marks, |site| {
                if flow.is_continue() {
                    flow = visit(site, level);
                }
            });
            flow?;
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
    /// wave reached, `steps` away; the last one if none is. `ways` is of this wave and radius.
    pub(crate) fn first_cell_near(
        &self,
        (robot, radius_m): (Cell, f32),
        (goal, steps): (Site, u32),
        ways: &mut WaysBack,
    ) -> Cell {
        let frame = self.centres.frame;
        let is_near = |site| frame.cell(site).distance2(robot) <= radius_m * radius_m;
        let goal = (goal, steps);
        frame.cell(ways.first_near(&self.space.residues, goal, is_near))
    }
}

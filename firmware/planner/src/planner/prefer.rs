//! Uneven ground in the window: the preference of each cell before the field is solved, and the
//! field's flatness after it \[Maffei20, eqs. 3 to 5\].
//!
//! Units: metres; preferences are pure numbers.

use crate::config::UnevenGround;
use crate::drive::side_slope::Slope;
use crate::field::local_grid::{LocalGrid, Rows};
use crate::field::preference::p_diff;
use crate::field::{Preference, SIDE, Window, descent};
use crate::ground::Heights;
use crate::planner::step::Step;
use crate::planner::workspace::Workspace;

impl<const TILES: usize, const SLOTS: usize> Step<'_, TILES, SLOTS> {
    /// Adds the preference of \[Maffei20, eqs. 3 to 5\] to the strategy's own in every cell of the
    /// window. Flat ground has none.
    #[inline(never)]
    pub(super) fn prefer(&mut self) {
        let Some(ground) = &self.config.ground else {
            return;
        };
        let heights = self.state.map.heights();
        let preferences = &self.state.preferences;
        let global = preferences.global(ground);
        let has_sides = self.state.strategy.tdbvp().is_some();
        let Workspace {
            window, local_grid, ..
        } = &mut *self.workspace;
        let crossed = crossed(ground, &heights, window, local_grid);
        let any_crossed = crossed.iter().any(|&row| row != 0);
        // Of a cell that was never measured.
        let plain = preferences.of_cell(ground, global, None);
        let unmeasured = Preference::nearest(plain);
        window.change_preferences(|x, y, old| {
            if any_crossed && LocalGrid::has(&crossed, (x, y)) {
                return Preference::nearest(ground.least_preference);
            }
            let height_m = heights.height_m(local_grid.cell(x, y));
            if height_m.is_none() && !has_sides {
                return unmeasured;
            }
            let difference_m = height_m.map(|height_m| height_m - self.input.pose.z_m);
            let epsilon = preferences.of_cell(ground, global, difference_m);
            let side = if has_sides { old.get().to_num() } else { 0.0 };
            Preference::nearest(epsilon + side)
        });
    }

    /// Notes how flat the solved field is around the robot: the next preferences depend on it.
    #[inline(never)]
    pub(super) fn note_flatness(&mut self) {
        let Workspace {
            window, local_grid, ..
        } = &*self.workspace;
        let place = local_grid.place(self.input.pose.point().cell());
        if self.state.ground.is_uneven()
            && let Some((x, y)) = place.filter(|&(x, y)| window.is_reached(x, y))
        {
            self.state.preferences.note(p_diff(window, x, y));
        }
    }
}

/// Returns the cells in which the last field leads across a slope that the robot must not cross.
/// They repel with the least preference: otherwise the height preference would draw the robot along
/// its own height, across the slope. Not in \[Maffei20\].
fn crossed(
    ground: &UnevenGround,
    heights: &Heights<'_>,
    window: &Window,
    local_grid: &LocalGrid,
) -> Rows {
    let mut rows = [0; SIDE];
    let Some(most) = ground
        .side_slope_limit()
        .filter(|_| ground.mode.has_heights())
    else {
        return rows;
    };
    for (y, row) in rows.iter_mut().enumerate() {
        for x in 0..SIDE {
            let is_crossed = Slope::at(heights, local_grid.cell(x, y))
                .zip(descent::gradient(window, x, y))
                .is_some_and(|(slope, way)| slope.is_crossed(way, most));
            *row |= u64::from(is_crossed) << x;
        }
    }
    rows
}

//! Classification of heights and marks into the map's classes, one row of the window at a time.
//!
//! | class | condition for a cell |
//! | --- | --- |
//! | obstacle | something stands there; or it is measured and too high over a cell near it |
//! | negative obstacle | it has a drop; an inferred one only if the map has no free ground there |
//! | free | it is measured and neither of these |
//! | free | the map knows nothing; measured cells on both sides bridge it |
//! | free | the map knows nothing; it has a usable height of low confidence |
//! | unchanged | none of these: the map keeps its class |
//!
//! A cell is too high by an edge or by a slope, see [`mod@super::steepness`]. An obstacle of the
//! map becomes free only if at least six of the eight cells around it are measured too.
//!
//! Departs from \[Maffei20, III-B\]: only the upper side of an edge is an obstacle, and the lower
//! side stays free. The paper's mean over a kernel of 2 m blurs edges, and makes every edge an
//! obstacle that is one metre deep.
//!
//! Units: bit k of a word is column `origin.x + k`; heights in steps of [`fixed::types::I7F9`].

use fixed::types::I7F9;

use crate::config::{GroundTuning, UnevenGround};
use crate::geometry::{CELL_M, Cell};
use crate::grid::bits::ones64;
use crate::grid::{Row, at};
use crate::ground::elevation::{GroundState, Heights};
use crate::ground::heights::WindowRows;
use crate::ground::{low_confidence, steepness};

/// Distances to the two ends of a bridge, cells: the ends are at most four cells apart.
const BRIDGES: [(i32, i32); 6] = [(1, 1), (1, 2), (2, 1), (2, 2), (1, 3), (3, 1)];

/// Limits for ground that spans a gap. They depend on the attitude of the measurements beside it.
struct GapLimits {
    /// Greatest grade across the gap, as a share of the climb.
    climb_share: f32,
    /// Lengths over which the grades beside the gap are measured, cells, in order of preference.
    grade_cells: &'static [i32],
    /// True if a height that was measured once, and may be a false return, counts against the gap.
    trusts_single: bool,
}

impl GapLimits {
    /// For an exact attitude: a long base has the least noise.
    const EXACT: Self = Self {
        climb_share: 1.0,
        grade_cells: &[8, 7, 6, 5, 4, 3],
        trusts_single: false,
    };
    /// For an attitude with errors: distant cells were measured in another attitude, and a rim
    /// casts a shadow as steep as the tilted beams.
    const fn noisy(tuning: &GroundTuning) -> Self {
        Self {
            climb_share: tuning.noisy_climb_share,
            grade_cells: &[3, 4, 2],
            trusts_single: true,
        }
    }
}

/// Greatest rises from a cell near by to a cell that is free, in steps of a height.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RiseLimits<'a> {
    /// An edge from the next cell.
    pub(super) one: i32,
    /// An edge from two cells away.
    pub(super) two: i32,
    /// A slope over four cells.
    pub(super) four: i32,
    /// Least rise over each half of those four cells.
    pub(super) half: i32,
    /// Between the ends of a bridge.
    bridge: i32,
    /// Steepest slope, a tangent.
    pub(super) climb: f32,
    /// Highest edge, metres.
    step_m: f32,
    pub(super) tuning: &'a GroundTuning,
}

impl<'a> RiseLimits<'a> {
    /// The limits of a robot on uneven ground.
    pub(crate) fn new(ground: &UnevenGround, tuning: &'a GroundTuning) -> Self {
        let steps = |metres: f32| i32::from(I7F9::saturating_from_num(metres).to_bits());
        let rise = |cells: f32| ground.climb * cells * CELL_M;
        let edge = |cells: f32| {
            steps(tuning.edge_climb_share * rise(cells) + ground.step_m + tuning.mean_noise_m)
        };
        Self {
            one: edge(1.0),
            two: edge(2.0),
            four: steps(rise(4.0) + tuning.mean_noise_m),
            half: steps(tuning.half_share * rise(4.0)),
            bridge: steps(tuning.bridge_share * rise(4.0)),
            climb: ground.climb,
            step_m: ground.step_m,
            tuning,
        }
    }

    /// Returns true if a bridge between these heights is not too steep. Both must be measured.
    #[inline(always)]
    fn bridge_spans(&self, a: Option<i32>, b: Option<i32>) -> bool {
        a.zip(b).is_some_and(|(a, b)| (a - b).abs() <= self.bridge)
    }
}

/// The classes of a row, one bit a cell. A cell without a bit keeps its class in the map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Classes {
    /// Obstacles.
    pub(crate) obstacle: u64,
    /// Negative obstacles.
    pub(crate) negative: u64,
    /// Traversable cells.
    pub(crate) free: u64,
}

/// Classifies row `y` of the window, whose rows are `rows`; `known` is the row in the map.
pub(crate) fn row(
    (heights, rows): (&Heights<'_>, &WindowRows),
    limits: &RiseLimits<'_>,
    y: i32,
    known: Row,
) -> Classes {
    let mut classes = Classes::default();
    let (origin, tuning) = (heights.origin(), limits.tuning);
    let bridged = bridged((heights, rows), limits, y, known.unknown());
    let marked = at(rows, (y - origin.y) as usize).marked;
    for k in ones64(marked | bridged) {
        let cell = origin.offset(k as i32, y - origin.y);
        let bit = 1_u64 << k;
        let near = |dx: i32, dy: i32| height_steps(heights, cell.offset(dx, dy));
        if heights.is_obstacle(cell, tuning) {
            classes.obstacle |= bit;
        } else if let Some(height) = near(0, 0) {
            if let Some(steepness) = steepness::steepness(limits, height, near) {
                if steepness::is_confirmed(heights, cell, steepness) {
                    classes.obstacle |= bit;
                }
            } else if known.obstacle() & bit == 0 || is_well_measured(tuning, near) {
                classes.free |= bit;
            }
        } else if heights.is_drop(cell) {
            // Ground in the map was measured before the window came back here.
            if !heights.is_inferred_drop(cell) || known.free() & bit == 0 {
                classes.negative |= bit;
            }
        } else if known.unknown() & bit != 0
            && (bridged & bit != 0 || low_confidence::is_usable(heights, limits, cell))
        {
            classes.free |= bit;
        }
    }
    classes
}

/// Returns the mean height of a cell, in steps; `None` if it was never measured.
#[inline(always)]
fn height_steps(heights: &Heights<'_>, cell: Cell) -> Option<i32> {
    heights
        .fixed(cell)
        .map(|height| i32::from(height.to_bits()))
}

/// Returns true if enough cells around a measured cell are measured too.
fn is_well_measured(tuning: &GroundTuning, near: impl Fn(i32, i32) -> Option<i32>) -> bool {
    let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy)));
    let measured = around.filter(|&(dx, dy)| near(dx, dy).is_some()).count() as u32;
    // The cell itself is one of them.
    measured > tuning.min_measured_around
}

/// Returns true if measured ground on both sides spans a cell that was never measured.
///
/// Ground must span the cell in at least `min_directions` of the four directions, and no
/// direction may refuse it. `slack_m` is the difference of two heights that errors of the attitude
/// alone explain, metres.
pub(crate) fn spans_gap(
    heights: &Heights<'_>,
    rises: &RiseLimits<'_>,
    cell: Cell,
    slack_m: f32,
) -> bool {
    let gap = Gap {
        heights,
        rises,
        cell,
        slack_m,
        limits: if slack_m > 0.0 {
            GapLimits::noisy(rises.tuning)
        } else {
            GapLimits::EXACT
        },
    };
    let mut directions = 0;
    for direction in DIRECTIONS {
        match gap.is_spanned_along(direction) {
            Some(true) => directions += 1,
            Some(false) => return false,
            None => {}
        }
    }
    directions >= rises.tuning.min_directions
}

/// A cell of a gap, and the ground around it.
struct Gap<'a> {
    heights: &'a Heights<'a>,
    rises: &'a RiseLimits<'a>,
    cell: Cell,
    slack_m: f32,
    limits: GapLimits,
}

impl Gap<'_> {
    /// Returns true if ground spans the gap along a direction, false if it refuses the gap, and
    /// `None` if it tells nothing.
    ///
    /// The ends are the nearest cells on both sides that are known; an inferred drop is not. Both
    /// must be measured. The grade between them must not exceed the climb, and their difference
    /// must be at most a step, or blend in with the grades beside the gap.
    fn is_spanned_along(&self, direction: Direction) -> Option<bool> {
        let ((ahead, high), (behind, low)) = self.end(direction, 1).zip(self.end(direction, -1))?;
        let (GroundState::Measured(high), GroundState::Measured(low)) = (high, low) else {
            return Some(false);
        };
        let (rise_m, gap_m) = (high - low, (ahead + behind) as f32 * direction.step_m());
        let max_rise_m = self.limits.climb_share * self.rises.climb * gap_m + self.slack_m;
        let is_low = rise_m.abs() <= self.rises.step_m + self.slack_m;
        let blends = || self.blends(direction, (ahead, behind), rise_m / gap_m);
        if rise_m.abs() <= max_rise_m && (is_low || blends()) {
            return Some(true);
        }
        let count = |cells: i32| self.heights.count(direction.cell(self.cell, cells));
        let is_refused = self.limits.trusts_single || (count(ahead) > 1 && count(-behind) > 1);
        is_refused.then_some(false)
    }

    /// Returns the nearest known cell to one side: its distance in cells, and its state.
    fn end(&self, direction: Direction, sign: i32) -> Option<(i32, GroundState)> {
        (1..=self.rises.tuning.max_gap_cells).find_map(|cells| {
            let cell = direction.cell(self.cell, sign * cells);
            let state = self.heights.ground_state(cell, self.rises.tuning)?;
            (state != GroundState::Uncertain).then_some((cells, state))
        })
    }

    /// Returns true if the grade across the gap lies between those beside it, give or take
    /// `max_blend`.
    fn blends(&self, direction: Direction, (ahead, behind): (i32, i32), grade: f32) -> bool {
        let beside = self.grade_beside(direction, ahead, 1);
        let Some((a, b)) = beside.zip(self.grade_beside(direction, -behind, -1)) else {
            return false;
        };
        let longest = self.limits.grade_cells.iter().copied().max().unwrap_or(1) as f32;
        let max_blend = self.rises.tuning.max_blend + self.slack_m / (longest * direction.step_m());
        (a.min(b) - max_blend..=a.max(b) + max_blend).contains(&grade)
    }

    /// Returns the grade of the ground beside the gap, a tangent: from the cell `from` outwards, to
    /// the first of [`GapLimits::grade_cells`] that is measured. It is positive if the ground rises
    /// along the direction.
    fn grade_beside(&self, direction: Direction, from: i32, sign: i32) -> Option<f32> {
        let height_m = |cells: i32| self.heights.height_m(direction.cell(self.cell, cells));
        let near_m = height_m(from)?;
        self.limits.grade_cells.iter().find_map(|&cells| {
            let far_m = height_m(from + sign * cells)?;
            Some((far_m - near_m) / ((sign * cells) as f32 * direction.step_m()))
        })
    }
}

/// One of the directions across a gap: the columns and rows of a step, and its length in cells.
#[derive(Clone, Copy)]
struct Direction(i32, i32, f32);

/// Both axes and both diagonals; 1.41 is √2.
const DIRECTIONS: [Direction; 4] = [
    Direction(1, 0, 1.0),
    Direction(1, 1, 1.41),
    Direction(0, 1, 1.0),
    Direction(-1, 1, 1.41),
];

impl Direction {
    /// Returns the cell so many steps from another.
    const fn cell(self, from: Cell, steps: i32) -> Cell {
        from.offset(steps * self.0, steps * self.1)
    }

    /// Returns the length of a step, metres.
    const fn step_m(self) -> f32 {
        self.2 * CELL_M
    }
}

/// Returns the unmeasured ones of `cells` in row `y` for which [`is_bridged`] holds. Words of
/// measured cells tell where both ends of a bridge are measured, so only those are compared.
fn bridged(
    (heights, rows): (&Heights<'_>, &WindowRows),
    limits: &RiseLimits<'_>,
    y: i32,
    cells: u64,
) -> u64 {
    let origin = heights.origin();
    // There are none outside of the window.
    let measured = |dy: i32| at(rows, (y + dy - origin.y) as usize).measured;
    let here = measured(0);
    let mut left = cells & !here;
    for (ahead, behind) in BRIDGES {
        let across = (here >> ahead & here << behind, (1, 0));
        let along = (measured(ahead) & measured(-behind), (0, 1));
        for (both, (dx, dy)) in [across, along] {
            for k in ones64(left & both) {
                let cell = Cell {
                    x: origin.x + k as i32,
                    y,
                };
                let height =
                    |steps: i32| height_steps(heights, cell.offset(steps * dx, steps * dy));
                if limits.bridge_spans(height(ahead), height(-behind)) {
                    left &= !(1 << k);
                }
            }
        }
    }
    cells & !here & !left
}

/// Returns true if measured cells on both sides along an axis, at most four cells apart, bridge a
/// cell: their heights differ by less than a climbable slope.
pub(super) fn is_bridged(heights: &Heights<'_>, limits: &RiseLimits<'_>, cell: Cell) -> bool {
    let near = |dx: i32, dy: i32| height_steps(heights, cell.offset(dx, dy));
    BRIDGES.into_iter().any(|(ahead, behind)| {
        limits.bridge_spans(near(ahead, 0), near(-behind, 0))
            || limits.bridge_spans(near(0, ahead), near(0, -behind))
    })
}

#[cfg(test)]
mod tests;

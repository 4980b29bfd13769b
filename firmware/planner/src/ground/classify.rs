//! Heights and marks into classes, a row of the window at a time.
//!
//! | class | of a cell |
//! | --- | --- |
//! | obstacle | something stands there; or it is measured, and too high over a cell beside it |
//! | negative obstacle | never measured, and its ground is gone, or presumed to be where the map knows of none |
//! | free | measured and neither; or between measured cells on both sides that lead over it; or glimpsed, and near |
//! | as before | anything else: what the map says stays, until something better is known |
//!
//! Too high is an edge or a slope as [`super::falls`] tells them. The lower side stays free [*departs* from
//! Maffei20, III-B: a mean over a kernel of 2 m blurs edges, and calls the upper side of every edge an obstacle a metre deep].
//! An obstacle of the map is only freed where most cells around are measured too.
//!
//! Units: bits, bit k is column `origin.x + k`; heights in steps of [`fixed::types::I7F9`].

use fixed::types::I7F9;

use crate::config::UnevenGround;
use crate::geometry::{CELL_M, Cell};
use crate::grid::Row;
use crate::ground::elevation::{Ground, Heights, WINDOW_SIDE};
use crate::ground::{low_confidence, steepness};

/// What a mean may be off beside its neighbour, metres.
const NOISE_M: f32 = 0.015;
/// How far the cells are that a bridge rests on, to either side.
const BRIDGES: [(i32, i32); 6] = [(1, 1), (1, 2), (2, 1), (2, 2), (1, 3), (3, 1)];
/// How far to either side ground is looked for over a brow, cells.
const REACH: i32 = 10;
/// In how many of four directions it must be found: over the corner of a hole it is in one.
const MIN_DIRECTIONS: i32 = 3;
/// What leads over a gap higher than an edge that may be driven over blends in: its grade lies between those on both sides, to within this. A kerb
/// in a gap lies between level ground and level ground.
const BLEND: f32 = 0.1;
/// Measured cells among the eight around that it takes to free an obstacle of the map.
const MIN_MEASURED_AROUND: u32 = 6;

/// How ground leads over a gap, by how sure the attitude is in which its sides were measured.
struct GapLimits {
    /// It is no steeper than this part of the climb.
    gentle: f32,
    /// How far from the gap the grades on both sides are measured, cells, the best first.
    grades: &'static [i32],
    /// Whether the first height of a cell, which may be a false return, may forbid it.
    heeds_single: bool,
}

impl GapLimits {
    /// Of heights that are right: over a long way their noise tells least.
    const EXACT: Self = Self {
        gentle: 1.0,
        grades: &[8, 7, 6, 5, 4, 3],
        heeds_single: false,
    };
    /// Of an attitude that errs: what is far was measured in another one, and a rim casts a shadow as steep as the tilted beams.
    const NOISY: Self = Self {
        gentle: 0.75,
        grades: &[3, 4, 2],
        heeds_single: true,
    };
    /// The farthest of the latter, cells.
    const FARTHEST: f32 = 4.0;
}

/// How much higher a cell may lie than one near it, in steps of a height.
#[derive(Clone, Copy, Debug)]
pub struct RiseLimits {
    pub(super) one: i32,
    pub(super) two: i32,
    pub(super) two_corner: i32,
    /// Over four cells, and over half of them.
    pub(super) four: i32,
    pub(super) half: i32,
    /// From one end of a bridge to the other.
    bridge: i32,
    climb: f32,
}

impl RiseLimits {
    /// What a robot's limits allow.
    #[must_use]
    pub fn new(ground: &UnevenGround) -> Self {
        let steps = |metres: f32| i32::from(I7F9::saturating_from_num(metres).to_bits());
        let rise = |cells: f32| ground.climb * cells * CELL_M;
        let edge = ground.step_m + NOISE_M;
        Self {
            one: steps(0.25 * rise(1.0) + edge),
            two: steps(0.5 * rise(2.0) + edge),
            two_corner: steps(0.5 * rise(2.83) + edge),
            four: steps(rise(4.0) + NOISE_M),
            half: steps(0.3 * rise(4.0)),
            bridge: steps(0.7 * rise(4.0)),
            climb: ground.climb,
        }
    }
}

/// The classes of a row, a bit a cell; what is in none of them stays as it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Classes {
    /// Obstacles.
    pub obstacle: u64,
    /// Negative obstacles.
    pub negative: u64,
    /// Traversable.
    pub free: u64,
}

/// Classify row `y` of the window, which the map holds as `known`.
#[must_use]
pub fn row(heights: &Heights<'_>, limits: &RiseLimits, y: i32, known: Row) -> Classes {
    let mut classes = Classes::default();
    let origin = heights.origin();
    for k in 0..WINDOW_SIDE {
        let cell = Cell { x: origin.x + k, y };
        let bit = 1_u64 << k;
        let bits = |dx: i32, dy: i32| at(heights, cell, dx, dy);
        if heights.is_obstacle(cell) {
            classes.obstacle |= bit;
        } else if let Some(height) = bits(0, 0) {
            if let Some(fall) = steepness::steepness(limits, height, bits) {
                if steepness::is_confirmed(heights, cell, fall) {
                    classes.obstacle |= bit;
                }
            } else if known.obstacle() & bit == 0 || is_well_measured(bits) {
                classes.free |= bit;
            }
        } else if heights.is_drop(cell) {
            // What is but presumed to be gone is, unless ground was measured there before the window came by again.
            if !heights.is_inferred_drop(cell) || known.free() & bit == 0 {
                classes.negative |= bit;
            }
        } else if known.unknown() & bit != 0
            && (bridges(limits, bits) || low_confidence::is_usable(heights, limits.climb, cell))
        {
            classes.free |= bit;
        }
    }
    classes
}

#[inline(always)]
fn at(heights: &Heights<'_>, cell: Cell, dx: i32, dy: i32) -> Option<i32> {
    let near = Cell {
        x: cell.x + dx,
        y: cell.y + dy,
    };
    heights
        .fixed(near)
        .map(|height| i32::from(height.to_bits()))
}

/// Whether most cells around are measured.
fn is_well_measured(bits: impl Fn(i32, i32) -> Option<i32>) -> bool {
    let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy)));
    let known = around.filter(|&(dx, dy)| bits(dx, dy).is_some()).count() as u32;
    // The cell itself is one of them.
    known > MIN_MEASURED_AROUND
}

/// Whether the nearest measured cells on both sides of a cell that was never measured lead over it, no more steeply than may be climbed, in
/// three of the four directions at least and in all in which there are two, and nothing between them is gone; what is but held to be gone
/// tells nothing. Two heights may differ by `slack_m` for errors of the attitude alone.
#[must_use]
pub fn spans_gap(heights: &Heights<'_>, ground: &UnevenGround, cell: Cell, slack_m: f32) -> bool {
    let limits = if slack_m > 0.0 {
        GapLimits::NOISY
    } else {
        GapLimits::EXACT
    };
    let lookup = |cell: Cell| {
        heights
            .ground(cell)
            .filter(|ground| *ground != Ground::Uncertain)
    };
    let mut directions = 0;
    for (dx, dy, cells) in [(1, 0, 1.0), (1, 1, 1.41), (0, 1, 1.0), (-1, 1, 1.41)] {
        let on = |cells: i32| Cell {
            x: cell.x + cells * dx,
            y: cell.y + cells * dy,
        };
        let reach = |way: i32| (1..=REACH).find_map(|far| Some((far, lookup(on(way * far))?)));
        let (Some((there, high)), Some((here, low))) = (reach(1), reach(-1)) else {
            continue;
        };
        let (Ground::Measured(high), Ground::Measured(low)) = (high, low) else {
            return false;
        };
        let step_m = cells * CELL_M;
        let (rise_m, way_m) = (high - low, (there + here) as f32 * step_m);
        let most_m = limits.gentle * ground.climb * way_m + slack_m;
        let blend = BLEND + slack_m / (GapLimits::FARTHEST * step_m);
        let blends = || {
            let grade = rise_m / way_m;
            let beyond = grade_on(heights, &on, (there, 1), limits.grades, step_m);
            let before = grade_on(heights, &on, (-here, -1), limits.grades, step_m);
            beyond
                .zip(before)
                .is_some_and(|(a, b)| (a.min(b) - blend..=a.max(b) + blend).contains(&grade))
        };
        if rise_m.abs() <= most_m && (rise_m.abs() <= ground.step_m + slack_m || blends()) {
            directions += 1;
        } else if limits.heeds_single
            || (heights.count(on(there)) > 1 && heights.count(on(-here)) > 1)
        {
            return false;
        }
    }
    directions >= MIN_DIRECTIONS
}

/// The grade of the ground beside a gap, from its cell at `from` outwards to the first measured one of those so many cells away; positive where
/// it rises along the direction.
fn grade_on(
    heights: &Heights<'_>,
    on: &impl Fn(i32) -> Cell,
    (from, way): (i32, i32),
    grades: &[i32],
    step_m: f32,
) -> Option<f32> {
    let near_m = heights.height_m(on(from))?;
    grades.iter().find_map(|&cells| {
        let far_m = heights.height_m(on(from + way * cells))?;
        Some((far_m - near_m) / ((way * cells) as f32 * step_m))
    })
}

/// Whether a cell of the window is led over by measured cells on both sides, at most four apart.
#[must_use]
pub fn is_bridged(heights: &Heights<'_>, limits: &RiseLimits, cell: Cell) -> bool {
    bridges(limits, |dx, dy| at(heights, cell, dx, dy))
}

/// Whether measured cells on both sides, at most four apart, lead over a cell.
fn bridges(limits: &RiseLimits, bits: impl Fn(i32, i32) -> Option<i32>) -> bool {
    let leads = |a: Option<i32>, b: Option<i32>| {
        a.zip(b)
            .is_some_and(|(a, b)| (a - b).abs() <= limits.bridge)
    };
    BRIDGES.into_iter().any(|(there, here)| {
        leads(bits(there, 0), bits(-here, 0)) || leads(bits(0, there), bits(0, -here))
    })
}

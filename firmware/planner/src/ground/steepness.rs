//! Steepness: decides if a measured cell lies too high over the cells near it.
//!
//! ```text
//! edge   h − h(1) > climb / 4 + step + noise    along an axis
//!        h − h(2) > climb / 2 + step + noise    along an axis
//!        h − h(4) > 4 climb + noise             along an axis, if each half rises by > half
//! slope  |a + b| > 4 climb + noise,  |a| > half,  |b| > half
//!        a = (h(2, 0) − h, h(0, 2) − h),  b = (h − h(−2, 0), h − h(0, −2))
//! ```
//!
//! Here h(n) is the height n cells away, `climb` the rise of the steepest slope over one cell, and
//! `half` a share of its rise over four cells; [`RiseLimits`] holds all limits.
//!
//! A slope uses an axis only if both of its half-segments rise in the same direction; the slope is
//! then the gradient's magnitude, whatever its direction. An edge lies in one half only, so it is
//! no slope. No error of a cell enters both axes, so a diagonal is as accurate as an axis. The last
//! rule for edges finds the upper end of an edge that the beams smeared over several cells.
//!
//! A cell that holds an edge has a height between its two sides, so the whole edge shows over two
//! cells only. An allowance of `climb` there lets the robot creep against edges (measured:
//! docs/MEASURED.md, "Edges over two cells").
//!
//! Departs from \[Maffei20, III-B\]: the paper compares a cell only with the mean of the kernel.
//!
//! Units: map cells, heights in steps of [`fixed::types::I7F9`].

use crate::geometry::Cell;
use crate::ground::classify::RiseLimits;
use crate::ground::elevation::Heights;

/// Offsets of the cells next to a cell.
const ONE: [(i32, i32); 4] = [(1, 0), (0, 1), (-1, 0), (0, -1)];
/// Offsets of the cells two away along an axis.
const TWO: [(i32, i32); 4] = [(2, 0), (0, 2), (-2, 0), (0, -2)];

/// The way in which a cell lies too high.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Steepness {
    /// Over a cell within two cells, or over the lower end of a smeared edge.
    Edge,
    /// On a slope steeper than the climb.
    Slope,
}

/// Returns the way in which a cell of this height lies too high, if it does. `near` returns the
/// height at an offset, `None` where none was measured.
#[inline(always)]
pub(super) fn steepness(
    limits: &RiseLimits<'_>,
    height: i32,
    near: impl Fn(i32, i32) -> Option<i32>,
) -> Option<Steepness> {
    let fall = |(dx, dy): (i32, i32)| near(dx, dy).map(|low| height - low);
    let is_edge = |fall: Option<i32>, limit: i32| fall.is_some_and(|fall| fall > limit);
    let two = TWO.map(fall);
    let is_smeared = |near: Option<i32>, (dx, dy): (i32, i32)| {
        let far = || fall((2 * dx, 2 * dy));
        near.filter(|&near| near > limits.half)
            .and_then(|near| Some((near, far()?)))
            .is_some_and(|(near, far)| far > limits.four && far - near > limits.half)
    };
    if ONE
        .into_iter()
        .any(|offset| is_edge(fall(offset), limits.one))
        || two.into_iter().any(|fall| is_edge(fall, limits.two))
        || two
            .into_iter()
            .zip(TWO)
            .any(|(fall, offset)| is_smeared(fall, offset))
    {
        Some(Steepness::Edge)
    } else {
        is_too_steep(limits, two).then_some(Steepness::Slope)
    }
}

/// Returns true if the ground is steeper than the climb. The arguments are the falls from the cell
/// to the cells [`TWO`] away.
#[inline(always)]
fn is_too_steep(limits: &RiseLimits<'_>, [east, north, west, south]: [Option<i32>; 4]) -> bool {
    // The fall from the cell and the fall to it, capped so that no square overflows.
    let halves = |one: Option<i32>, other: Option<i32>| {
        let (one, other) = one.zip(other).unwrap_or_default();
        let (down, up) = (one.max(other), -one.min(other));
        if down < 0 || up < 0 {
            return (0, 0);
        }
        (down.min(limits.four + 1), up.min(limits.four + 1))
    };
    let ((down_x, up_x), (down_y, up_y)) = (halves(east, west), halves(north, south));
    let is_longer = |x: i32, y: i32, limit: i32| x * x + y * y > limit * limit;
    is_longer(down_x + up_x, down_y + up_y, limits.four)
        && is_longer(down_x, down_y, limits.half)
        && is_longer(up_x, up_y, limits.half)
}

/// Returns true if the cell, and for a slope the cells [`TWO`] away, were measured more than once.
/// One height may be a false return, or come from a wrong attitude.
#[inline(never)]
pub(super) fn is_confirmed(heights: &Heights<'_>, cell: Cell, steepness: Steepness) -> bool {
    let is_single = |(dx, dy): (i32, i32)| heights.count(cell.offset(dx, dy)) == 1;
    heights.count(cell) > 1 && (steepness == Steepness::Edge || !TWO.into_iter().any(is_single))
}

#[cfg(test)]
mod tests {
    use crate::config::{GroundTuning, UnevenGround};
    use crate::geometry::{Cell, Point};
    use crate::grid::Row;
    use crate::ground::attitude_filter::tests::normal;
    use crate::ground::classify::{Classes, RiseLimits, row};
    use crate::ground::elevation::tests::OwnedWindow;

    /// Rows and columns that have ground on all sides.
    const INNER: core::ops::Range<i32> = -20..20;

    /// Returns the classes of a window of ground by row, from −32 on. The map knows nothing.
    fn classes(mut height_m: impl FnMut(Point, u32) -> f32) -> [Classes; 64] {
        classes_where(|at, time| Some(height_m(at, time)))
    }

    /// Returns the classes of ground that is measured only where and when it has a height.
    fn classes_where(mut height_m: impl FnMut(Point, u32) -> Option<f32>) -> [Classes; 64] {
        let mut owned = OwnedWindow::new(Cell::default());
        let mut window = owned.write();
        for y in -32..32 {
            for x in -32..32 {
                let cell = Cell { x, y };
                // One height may be a false return.
                for time in 0..4 {
                    if let Some(height_m) = height_m(cell.centre(), time) {
                        window.measure(cell, height_m);
                    }
                }
            }
        }
        let limits = RiseLimits::new(&UnevenGround::TABLE_I, &GroundTuning::DEFAULT);
        let (heights, known) = (window.read(), Row::default());
        let rows = heights.all_rows();
        core::array::from_fn(|k| row((&heights, &rows), &limits, k as i32 - 32, known))
    }

    /// Returns the number of obstacles among the inner cells.
    fn obstacles(classes: &[Classes; 64]) -> u32 {
        let inner = INNER.map(|x| 1_u64 << (x + 32)).sum::<u64>();
        let rows = INNER.filter_map(|y| classes.get((y + 32) as usize));
        rows.map(|row| (row.obstacle & inner).count_ones()).sum()
    }

    /// The number of inner cells.
    const ALL: u32 = 1600;

    /// Returns the number of obstacles on a plane that rises towards a bearing, degrees.
    fn on_a_plane(degrees: f32, bearing: f32) -> u32 {
        let (grade, (sin, cos)) = (degrees.to_radians().tan(), bearing.to_radians().sin_cos());
        obstacles(&classes(|at, _| grade * (at.x_m * cos + at.y_m * sin)))
    }

    #[test]
    fn the_steepest_slope_is_the_same_in_every_direction() {
        // tan 21.9° is the climb plus the noise over 0.4 m. Heights have steps of 2 mm.
        for bearing in (0..360).step_by(5) {
            assert_eq!(on_a_plane(21.2, bearing as f32), 0, "{bearing}");
            assert_eq!(on_a_plane(22.5, bearing as f32), ALL, "{bearing}");
        }
    }

    #[test]
    fn a_slope_needs_cells_that_were_measured_more_than_once() {
        // Along a diagonal, where neither axis alone is too steep.
        let grade = 25.0_f32.to_radians().tan() * core::f32::consts::FRAC_1_SQRT_2;
        let ground = |x: i32| {
            move |at: Point, time: u32| {
                // One column is measured only once.
                let is_kept = time == 0 || at.cell().x != x;
                is_kept.then_some(grade * (at.x_m + at.y_m))
            }
        };
        let everywhere = obstacles(&classes_where(ground(1000)));
        assert_eq!(everywhere, ALL);
        // The column itself, and the columns two away on both sides.
        assert_eq!(obstacles(&classes_where(ground(0))), ALL - 3 * 40);
    }

    #[test]
    fn noise_makes_few_obstacles_of_a_slope_in_every_direction() {
        let mut seed = 7;
        let mut share = |degrees: f32, bearing: f32| {
            let grade = degrees.to_radians().tan();
            let (sin, cos) = bearing.to_radians().sin_cos();
            // The mean of four of these errs by 5 mm.
            let ground =
                classes(|at, _| grade * (at.x_m * cos + at.y_m * sin) + 0.01 * normal(&mut seed));
            obstacles(&ground) as f32 / ALL as f32
        };
        // No error of a cell enters both axes, so a diagonal is as accurate as an axis.
        for (degrees, most) in [(17.5, 0.0), (20.0, 0.08)] {
            let shares = [0.0, 22.5, 45.0].map(|bearing| share(degrees, bearing));
            assert!(shares.iter().all(|&share| share <= most), "{shares:?}");
        }
        let steep = [0.0, 22.5, 45.0].map(|bearing| share(24.0, bearing));
        assert!(steep.iter().all(|&share| share > 0.9), "{steep:?}");
    }

    #[test]
    fn a_low_edge_is_free_and_a_high_edge_is_an_obstacle_on_its_upper_side() {
        for bearing in [0.0_f32, 30.0, 45.0, 90.0, 200.0] {
            let (sin, cos) = bearing.to_radians().sin_cos();
            let terrace = |height_m: f32| {
                let along = move |at: Point| at.x_m * cos + at.y_m * sin;
                obstacles(&classes(
                    |at, _| if along(at) > 0.02 { height_m } else { 0.0 },
                ))
            };
            assert_eq!(terrace(0.07), 0, "{bearing}");
            assert!((40..200).contains(&terrace(0.15)), "{bearing}");
        }
        // The corner of a terrace falls along both axes.
        let corner = |at: Point, _| f32::from(u8::from(at.x_m > 0.0 && at.y_m > 0.0)) * 0.07;
        assert_eq!(obstacles(&classes(corner)), 0);
    }

    #[test]
    fn an_edge_within_a_cell_is_an_obstacle_and_a_low_one_on_a_slope_is_not() {
        let within = |height_m: f32, grade: f32| {
            obstacles(&classes(|at, _| {
                let edge_m = match at.cell().x {
                    ..0 => 0.0,
                    0 => 0.5 * height_m,
                    _ => height_m,
                };
                edge_m + grade * at.x_m
            }))
        };
        assert_eq!(within(0.12, 0.0), 40, "the first cell of its upper side");
        assert_eq!(within(0.07, 0.0), 0);
        assert_eq!(within(0.05, 0.2), 0, "a slope goes on above it");
    }

    #[test]
    fn one_axis_decides_where_the_other_is_not_measured() {
        // Two rows of ground, and nothing beside them.
        let mut owned = OwnedWindow::new(Cell::default());
        let mut window = owned.write();
        for (x, y) in (-32..32).flat_map(|x| [(x, 0), (x, 1)]) {
            let grade = if y == 0 { 0.36 } else { 0.45 };
            let height_m = 0.1 * grade * x as f32;
            window.measure(Cell { x, y }, height_m);
            window.measure(Cell { x, y }, height_m);
        }
        let ground = UnevenGround {
            step_m: 9.0,
            ..UnevenGround::TABLE_I
        };
        let limits = RiseLimits::new(&ground, &GroundTuning::DEFAULT);
        let (heights, known) = (window.read(), Row::default());
        let rows = heights.all_rows();
        let of = |y: i32| row((&heights, &rows), &limits, y, known);
        assert_eq!(of(0).obstacle, 0);
        // The third cell from the left is the first with two measured cells on both sides.
        assert_eq!(of(1).obstacle, u64::MAX << 2);
    }
}

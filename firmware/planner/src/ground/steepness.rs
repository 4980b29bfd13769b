//! Falls: by how much the ground of a cell lies over that of those near it, and whether that is too much.
//!
//! ```text
//! edge   h − h(d) > climb · d + STEP              for a cell d = 1 or 2 away
//!        h − h(4) > 4 climb + NOISE               along an axis, if both halves of the way take part by more than HALF
//! slope  |a + b| > 4 climb + NOISE                a = (h(2, 0) − h, h(0, 2) − h),  b = (h − h(−2, 0), h − h(0, −2))
//!        |a|, |b| > HALF
//! ```
//!
//! Of an axis along which the ground does not rise in both halves alike nothing counts in a slope: so it is the length of the gradient, whatever
//! its direction, and an edge alone, which lies in one half, is none. No cell's error counts in both axes, so a diagonal is measured as well
//! as an axis. The second rule for edges tells no slope that the last does not, but tells it from its upper end: an edge that beams smear
//! over some cells is one of its upper side. Not in [Maffei20], which knows no slope but against the kernel's mean. Units: map cells,
//! heights in steps of [`fixed::types::I7F9`].

use crate::geometry::Cell;
use crate::ground::classify::RiseLimits;
use crate::ground::elevation::Heights;

/// Beside a cell, to all sides.
const ONE: [(i32, i32); 4] = [(1, 0), (0, 1), (-1, 0), (0, -1)];
/// Two away.
const TWO: [(i32, i32); 4] = [(2, 0), (0, 2), (-2, 0), (0, -2)];
/// Two away along both axes.
const CORNERS: [(i32, i32); 4] = [(2, 2), (-2, 2), (-2, -2), (2, -2)];

/// How a cell lies too high.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Steepness {
    /// Over a cell beside it.
    Edge,
    /// On a slope too steep to be climbed.
    Slope,
}

/// How a cell of this height lies too high over those near it, if it does; `near` tells the heights of the measured ones.
#[inline(always)]
pub fn steepness(
    limits: &RiseLimits,
    height: i32,
    near: impl Fn(i32, i32) -> Option<i32>,
) -> Option<Steepness> {
    let fall = |(dx, dy): (i32, i32)| near(dx, dy).map(|low| height - low);
    let is_edge = |fall: Option<i32>, most: i32| fall.is_some_and(|fall| fall > most);
    let two = TWO.map(fall);
    let is_smeared = |near: Option<i32>, (dx, dy): (i32, i32)| {
        let far = || fall((2 * dx, 2 * dy));
        near.filter(|&near| near > limits.half)
            .and_then(|near| Some((near, far()?)))
            .is_some_and(|(near, far)| far > limits.four && far - near > limits.half)
    };
    if ONE
        .into_iter()
        .any(|beside| is_edge(fall(beside), limits.one))
        || two.into_iter().any(|fall| is_edge(fall, limits.two))
        || CORNERS
            .into_iter()
            .any(|corner| is_edge(fall(corner), limits.two_corner))
        || two
            .into_iter()
            .zip(TWO)
            .any(|(near, way)| is_smeared(near, way))
    {
        Some(Steepness::Edge)
    } else {
        is_too_steep(limits, two).then_some(Steepness::Slope)
    }
}

/// Whether the ground falls more steeply than may be climbed, where it falls by so much to the cells [`TWO`] away.
#[inline(always)]
fn is_too_steep(limits: &RiseLimits, [east, north, west, south]: [Option<i32>; 4]) -> bool {
    // By how much it falls from the cell, and to it. What is more than enough needs no square.
    let halves = |there: Option<i32>, here: Option<i32>| {
        let (there, here) = there.zip(here).unwrap_or_default();
        let (down, up) = (there.max(here), -there.min(here));
        if down < 0 || up < 0 {
            return (0, 0);
        }
        (down.min(limits.four + 1), up.min(limits.four + 1))
    };
    let ((down_x, up_x), (down_y, up_y)) = (halves(east, west), halves(north, south));
    let is_longer = |x: i32, y: i32, than: i32| x * x + y * y > than * than;
    is_longer(down_x + up_x, down_y + up_y, limits.four)
        && is_longer(down_x, down_y, limits.half)
        && is_longer(up_x, up_y, limits.half)
}

/// Whether what a fall was told from was measured more than once: once may be a false return, and of an attitude that was off.
#[inline(never)]
#[must_use]
pub fn is_confirmed(heights: &Heights<'_>, cell: Cell, steepness: Steepness) -> bool {
    let count = |(dx, dy): (i32, i32)| {
        heights.count(Cell {
            x: cell.x + dx,
            y: cell.y + dy,
        })
    };
    let is_measured_once = |away: (i32, i32)| count(away) == 1;
    count((0, 0)) > 1 && (steepness == Steepness::Edge || !TWO.into_iter().any(is_measured_once))
}

#[cfg(test)]
mod tests {
    use crate::config::UnevenGround;
    use crate::geometry::{Cell, Point};
    use crate::grid::Row;
    use crate::ground::attitude_filter::tests::normal;
    use crate::ground::classify::{Classes, RiseLimits, row};
    use crate::ground::elevation::{Elevation, WINDOW_CELLS};

    /// Rows and columns that have ground to all sides.
    const INNER: core::ops::Range<i32> = -20..20;

    /// The classes of a window of ground, by its row from −32 on, where nothing was known.
    fn classes(mut height_m: impl FnMut(Point, u32) -> f32) -> [Classes; 64] {
        classes_where(|at, time| Some(height_m(at, time)))
    }

    /// The same of ground that is measured only where and when it has a height.
    fn classes_where(mut height_m: impl FnMut(Point, u32) -> Option<f32>) -> [Classes; 64] {
        let (mut heights, mut marks) = ([0; 2 * WINDOW_CELLS], [0; WINDOW_CELLS]);
        let mut origin = Cell::default();
        let mut window = Elevation::new(&mut heights, &mut marks, &mut origin);
        window.follow(Cell::default());
        for y in -32..32 {
            for x in -32..32 {
                let cell = Cell { x, y };
                // Once may be a false return.
                for time in 0..4 {
                    if let Some(height_m) = height_m(cell.centre(), time) {
                        window.measure(cell, height_m);
                    }
                }
            }
        }
        let limits = RiseLimits::new(&UnevenGround::TABLE_I);
        core::array::from_fn(|k| row(&window.read(), &limits, k as i32 - 32, Row::default()))
    }

    /// Obstacles among the cells that have ground to all sides.
    fn obstacles(classes: &[Classes; 64]) -> u32 {
        let inner = INNER.map(|x| 1_u64 << (x + 32)).sum::<u64>();
        let rows = INNER.filter_map(|y| classes.get((y + 32) as usize));
        rows.map(|row| (row.obstacle & inner).count_ones()).sum()
    }

    /// All of them.
    const ALL: u32 = 1600;

    /// Obstacles on a plane of so many degrees that rises towards a bearing.
    fn on_a_plane(degrees: f32, bearing: f32) -> u32 {
        let (grade, (sin, cos)) = (degrees.to_radians().tan(), bearing.to_radians().sin_cos());
        obstacles(&classes(|at, _| grade * (at.x_m * cos + at.y_m * sin)))
    }

    #[test]
    fn whether_a_slope_is_too_steep_does_not_depend_on_its_direction() {
        // tan 21.9° is the climb and what two means may be off by, over 0.4 m. Heights are in steps of 2 mm.
        for bearing in (0..360).step_by(5) {
            assert_eq!(on_a_plane(21.2, bearing as f32), 0, "{bearing}");
            assert_eq!(on_a_plane(22.5, bearing as f32), ALL, "{bearing}");
        }
    }

    #[test]
    fn a_slope_is_told_from_what_was_measured_more_than_once() {
        // Along a diagonal, where neither axis alone is too steep.
        let grade = 25.0_f32.to_radians().tan() * core::f32::consts::FRAC_1_SQRT_2;
        let ground = |x: i32| {
            move |at: Point, time: u32| {
                // Of one column only the first is kept.
                let is_kept = time == 0 || at.cell().x != x;
                is_kept.then_some(grade * (at.x_m + at.y_m))
            }
        };
        let everywhere = obstacles(&classes_where(ground(1000)));
        assert_eq!(everywhere, ALL);
        // The column itself, and those two away to both sides.
        assert_eq!(obstacles(&classes_where(ground(0))), ALL - 3 * 40);
    }

    #[test]
    fn noise_takes_few_cells_of_a_slope_for_obstacles_in_every_direction() {
        let mut seed = 7;
        let mut share = |degrees: f32, bearing: f32| {
            let grade = degrees.to_radians().tan();
            let (sin, cos) = bearing.to_radians().sin_cos();
            // Means of four of these are off by 5 mm.
            let ground =
                classes(|at, _| grade * (at.x_m * cos + at.y_m * sin) + 0.01 * normal(&mut seed));
            obstacles(&ground) as f32 / ALL as f32
        };
        // No cell's error counts in both axes, so a diagonal is measured as well as an axis.
        for (degrees, most) in [(17.5, 0.0), (20.0, 0.08)] {
            let shares = [0.0, 22.5, 45.0].map(|bearing| share(degrees, bearing));
            assert!(shares.iter().all(|&share| share <= most), "{shares:?}");
        }
        let steep = [0.0, 22.5, 45.0].map(|bearing| share(24.0, bearing));
        assert!(steep.iter().all(|&share| share > 0.9), "{steep:?}");
    }

    #[test]
    fn an_edge_that_may_be_driven_over_is_no_slope_and_a_higher_one_is_an_obstacle_at_its_brow() {
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
    fn of_ground_that_is_not_measured_along_one_axis_the_other_decides() {
        // Two rows of ground and nothing beside.
        let (mut heights, mut marks) = ([0; 2 * WINDOW_CELLS], [0; WINDOW_CELLS]);
        let mut origin = Cell::default();
        let mut window = Elevation::new(&mut heights, &mut marks, &mut origin);
        window.follow(Cell::default());
        for (x, y) in (-32..32).flat_map(|x| [(x, 0), (x, 1)]) {
            let grade = if y == 0 { 0.36 } else { 0.45 };
            let height_m = 0.1 * grade * x as f32;
            window.measure(Cell { x, y }, height_m);
            window.measure(Cell { x, y }, height_m);
        }
        let limits = RiseLimits::new(&UnevenGround {
            step_m: 9.0,
            ..UnevenGround::TABLE_I
        });
        let of = |y: i32| row(&window.read(), &limits, y, Row::default());
        assert_eq!(of(0).obstacle, 0);
        // Four cells to the lower side are measured of the fifth cell from the left on, and two to both sides of the third.
        assert_eq!(of(1).obstacle, u64::MAX << 2);
    }
}

//! Path following by pure pursuit: the robot heads for a point ahead on its path.
//!
//! The target is the farthest point of the path within 1 m to which the straight line is passable
//! and keeps enough room: 0.4 m from obstacles, or as much as the path up to there. So the robot
//! passes a door in the middle, where the path does, as a local planner on an inflated costmap
//! would.
//!
//! Units: metres, radians.

use fieldline_planner::geometry::{CELL_M, Point};
use fieldline_planner::math;

use super::inflation::Inflation;
use crate::baseline::chart::Chart;

/// Greatest distance of the target along the path, metres.
pub const LOOK_AHEAD_M: f32 = 1.0;
/// Squared distance to an obstacle that is always enough, cells: 0.4 m.
const ROOMY: u8 = 16;
/// Distance at which the robot has arrived, metres: the default goal tolerance of Nav2.
pub const ARRIVED_M: f32 = 0.25;

fn distance_m(a: Point, b: Point) -> f32 {
    (a.x_m - b.x_m).hypot(a.y_m - b.y_m)
}

/// Returns true if a robot at `at` is at the end of the path, or if the path is empty.
#[must_use]
pub fn has_arrived(path: &[Point], at: Point) -> bool {
    path.last()
        .is_none_or(|&end| distance_m(end, at) < ARRIVED_M)
}

/// Returns the heading from `at` along the path, radians; `None` at its end.
#[must_use]
pub fn heading(chart: &Chart, inflation: &Inflation, path: &[Point], at: Point) -> Option<f32> {
    if has_arrived(path, at) {
        return None;
    }
    let from = |point: Point| distance_m(point, at);
    let nearest = path
        .iter()
        .enumerate()
        .min_by(|a, b| from(*a.1).total_cmp(&from(*b.1)))?
        .0;
    let ahead = path.get(nearest + 1..).unwrap_or_default();
    let mut target = *ahead.first().or(path.last())?;
    let room = |point: Point| {
        let index = inflation.area().index(point.cell());
        index.map_or(0, |index| inflation.square(index).min(ROOMY))
    };
    let (mut last, mut length_m) = (*path.get(nearest)?, 0.0);
    let mut least = room(last).min(room(at));
    for &point in ahead {
        length_m += distance_m(last, point);
        last = point;
        if length_m > LOOK_AHEAD_M {
            break;
        }
        least = least.min(room(point));
        let open = |point: Point| {
            let index = chart.area().index(point.cell());
            index.is_some_and(|index| chart.is_passable(index)) && room(point) >= least
        };
        if along(at, point).all(open) {
            target = point;
        }
    }
    let (dx, dy) = (target.x_m - at.x_m, target.y_m - at.y_m);
    (dx != 0.0 || dy != 0.0).then(|| math::atan2(dy, dx))
}

/// Returns the length of the path from its point nearest to `at`, metres.
#[must_use]
pub fn remaining_m(path: &[Point], at: Point) -> f32 {
    let from = |point: Point| distance_m(point, at);
    let nearest = path
        .iter()
        .enumerate()
        .min_by(|a, b| from(*a.1).total_cmp(&from(*b.1)));
    let rest = nearest.and_then(|(k, _)| path.get(k..)).unwrap_or_default();
    rest.windows(2)
        .map(|pair| distance_m(pair[0], pair[1]))
        .sum()
}

/// Returns points of a straight line, at most half a cell apart, without the first one.
fn along(from: Point, to: Point) -> impl Iterator<Item = Point> {
    let parts = (distance_m(from, to) / (0.5 * CELL_M)).ceil().max(1.0);
    (1..=parts as u32).map(move |k| {
        let share = k as f32 / parts;
        Point {
            x_m: from.x_m + share * (to.x_m - from.x_m),
            y_m: from.y_m + share * (to.y_m - from.y_m),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::{has_arrived, heading, remaining_m};
    use crate::baseline::chart::sketch::chart;
    use crate::baseline::greedy::inflation::Inflation;
    use crate::baseline::greedy::paths::Paths;
    use fieldline_planner::geometry::{Cell, Point};

    #[test]
    fn in_the_open_it_looks_a_metre_ahead() {
        let rows = ["R".to_owned() + &".".repeat(30)];
        let rows: Vec<&str> = rows.iter().map(String::as_str).collect();
        let (chart, robot) = chart(&rows);
        // The path turns up after 1.1 m; the heading is straight until then.
        let path: Vec<Point> = (0..=11)
            .map(|x| Cell { x, y: 0 }.centre())
            .chain((1..9).map(|y| Cell { x: 11, y }.centre()))
            .collect();
        assert!(
            heading(&chart, &Inflation::new(&chart), &path, robot)
                .unwrap()
                .abs()
                < 1e-6
        );
        assert!(!has_arrived(&path, robot));
        let end = *path.last().unwrap();
        assert!(
            has_arrived(&path, end)
                && heading(&chart, &Inflation::new(&chart), &path, end).is_none()
        );
    }

    #[test]
    fn it_does_not_look_round_a_corner() {
        let rows = [
            "########..", //
            "########..",
            "########..",
            "########..",
            ".........G",
            "R.........",
        ];
        let (chart, robot) = chart(&rows);
        let paths = Paths::from(&chart, &Inflation::new(&chart), robot.cell());
        let goal = chart.area().index(Cell { x: 8, y: 5 }).unwrap();
        let path = paths.path(&chart, goal);
        let angle = heading(&chart, &Inflation::new(&chart), &path, robot).unwrap();
        assert!((0.0..0.2).contains(&angle), "{angle}");
    }

    #[test]
    fn the_remaining_length_is_that_of_the_rest() {
        let path: Vec<Point> = (0..=20).map(|x| Cell { x, y: 0 }.centre()).collect();
        let at = |x_m| remaining_m(&path, Point { x_m, y_m: 0.3 });
        assert!((at(0.05) - 2.0).abs() < 1e-5);
        assert!((at(1.56) - 0.5).abs() < 1e-5);
        assert_eq!(remaining_m(&[], Point::default()), 0.0);
    }

    #[test]
    fn without_a_path_there_is_no_heading() {
        let (chart, robot) = chart(&["R.."]);
        assert_eq!(heading(&chart, &Inflation::new(&chart), &[], robot), None);
    }
}

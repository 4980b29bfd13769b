//! Following a way by looking ahead on it (pure pursuit): the heading towards the farthest point of the way within 1 m to
//! which the straight line is passable, and nowhere nearer to an obstacle than the way itself or 0.4 m. So doors are passed the
//! way the route passes them, in the middle, where a local planner on an inflated costmap would pass them, too.
//!
//! Units: metres, radians.

use fieldline_planner::geometry::{CELL_M, Point};
use fieldline_planner::math;

use super::inflation::Inflation;
use crate::baseline::chart::Chart;

/// How far along the way to look, metres.
pub const LOOK_AHEAD_M: f32 = 1.0;
/// Squared distance to an obstacle, in cells, that is room enough: 0.4 m.
const ROOMY: u8 = 16;
/// This near to the goal the robot has arrived, metres: the default goal tolerance of ROS 2's navigation.
pub const ARRIVED_M: f32 = 0.25;

fn distance_m(a: Point, b: Point) -> f32 {
    (a.x_m - b.x_m).hypot(a.y_m - b.y_m)
}

/// Whether a robot at `at` is at the end of the way; also where there is no way.
#[must_use]
pub fn has_arrived(way: &[Point], at: Point) -> bool {
    way.last()
        .is_none_or(|&end| distance_m(end, at) < ARRIVED_M)
}

/// The heading from `at` along the way, radians; `None` at its end.
#[must_use]
pub fn heading(chart: &Chart, inflation: &Inflation, way: &[Point], at: Point) -> Option<f32> {
    if has_arrived(way, at) {
        return None;
    }
    let from = |point: Point| distance_m(point, at);
    let nearest = way
        .iter()
        .enumerate()
        .min_by(|a, b| from(*a.1).total_cmp(&from(*b.1)))?
        .0;
    let ahead = way.get(nearest + 1..).unwrap_or_default();
    let mut target = *ahead.first().or(way.last())?;
    let room = |point: Point| {
        let index = inflation.frame().index(point.cell());
        index.map_or(0, |index| inflation.square(index).min(ROOMY))
    };
    let (mut last, mut length_m) = (*way.get(nearest)?, 0.0);
    let mut least = room(last).min(room(at));
    for &point in ahead {
        length_m += distance_m(last, point);
        last = point;
        if length_m > LOOK_AHEAD_M {
            break;
        }
        least = least.min(room(point));
        let open = |point: Point| {
            let index = chart.frame().index(point.cell());
            index.is_some_and(|index| chart.is_passable(index)) && room(point) >= least
        };
        if along(at, point).all(open) {
            target = point;
        }
    }
    let (dx, dy) = (target.x_m - at.x_m, target.y_m - at.y_m);
    (dx != 0.0 || dy != 0.0).then(|| math::atan2(dy, dx))
}

/// Length of the way from its point nearest to `at` to its end, metres.
#[must_use]
pub fn remaining_m(way: &[Point], at: Point) -> f32 {
    let from = |point: Point| distance_m(point, at);
    let nearest = way
        .iter()
        .enumerate()
        .min_by(|a, b| from(*a.1).total_cmp(&from(*b.1)));
    let rest = nearest.and_then(|(k, _)| way.get(k..)).unwrap_or_default();
    rest.windows(2)
        .map(|pair| distance_m(pair[0], pair[1]))
        .sum()
}

/// Points of a straight line at most half a cell apart, without its beginning.
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
    use crate::baseline::greedy::route::Routes;
    use fieldline_planner::geometry::{Cell, Point};

    #[test]
    fn in_the_open_it_looks_a_metre_ahead() {
        let rows = ["R".to_owned() + &".".repeat(30)];
        let rows: Vec<&str> = rows.iter().map(String::as_str).collect();
        let (chart, robot) = chart(&rows);
        // A way that turns up after a metre is followed straight until then.
        let way: Vec<Point> = (0..=11)
            .map(|x| Cell { x, y: 0 }.centre())
            .chain((1..9).map(|y| Cell { x: 11, y }.centre()))
            .collect();
        assert!(
            heading(&chart, &Inflation::new(&chart), &way, robot)
                .unwrap()
                .abs()
                < 1e-6
        );
        assert!(!has_arrived(&way, robot));
        let end = *way.last().unwrap();
        assert!(
            has_arrived(&way, end) && heading(&chart, &Inflation::new(&chart), &way, end).is_none()
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
        let routes = Routes::from(&chart, &Inflation::new(&chart), robot.cell());
        let goal = chart.frame().index(Cell { x: 8, y: 5 }).unwrap();
        let way = routes.way(&chart, goal);
        let angle = heading(&chart, &Inflation::new(&chart), &way, robot).unwrap();
        assert!((0.0..0.2).contains(&angle), "{angle}");
    }

    #[test]
    fn what_remains_is_the_length_of_the_rest() {
        let way: Vec<Point> = (0..=20).map(|x| Cell { x, y: 0 }.centre()).collect();
        let at = |x_m| remaining_m(&way, Point { x_m, y_m: 0.3 });
        assert!((at(0.05) - 2.0).abs() < 1e-5);
        assert!((at(1.56) - 0.5).abs() < 1e-5);
        assert_eq!(remaining_m(&[], Point::default()), 0.0);
    }

    #[test]
    fn without_a_way_there_is_no_heading() {
        let (chart, robot) = chart(&["R.."]);
        assert_eq!(heading(&chart, &Inflation::new(&chart), &[], robot), None);
    }
}

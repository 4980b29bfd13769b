//! Following a way by looking ahead on it (pure pursuit): the heading towards the farthest point of the way within 1 m that
//! can be driven to in a straight line.
//!
//! Units: metres, radians.

use fieldline_planner::geometry::{CELL_M, Point};
use fieldline_planner::math;

use crate::baseline::chart::Chart;

/// How far along the way to look, metres.
pub const LOOK_AHEAD_M: f32 = 1.0;
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
pub fn heading(chart: &Chart, way: &[Point], at: Point) -> Option<f32> {
    if has_arrived(way, at) {
        return None;
    }
    let from = |&(_, &point): &(usize, &Point)| distance_m(point, at);
    let (nearest, _) = way
        .iter()
        .enumerate()
        .min_by(|a, b| from(a).total_cmp(&from(b)))?;
    let ahead = way.get(nearest + 1..).unwrap_or_default();
    let mut target = *ahead.first().or(way.last())?;
    let mut length_m = 0.0;
    let mut last = *way.get(nearest)?;
    for &point in ahead {
        length_m += distance_m(last, point);
        last = point;
        if length_m > LOOK_AHEAD_M {
            break;
        }
        if sees(chart, at, point) {
            target = point;
        }
    }
    let (dx, dy) = (target.x_m - at.x_m, target.y_m - at.y_m);
    (dx != 0.0 || dy != 0.0).then(|| math::atan2(dy, dx))
}

/// Whether the straight line between two points runs over passable cells only, looked at every half cell.
fn sees(chart: &Chart, from: Point, to: Point) -> bool {
    let parts = (distance_m(from, to) / (0.5 * CELL_M)).ceil().max(1.0);
    (1..=parts as u32).all(|k| {
        let share = k as f32 / parts;
        let point = Point {
            x_m: from.x_m + share * (to.x_m - from.x_m),
            y_m: from.y_m + share * (to.y_m - from.y_m),
        };
        let index = chart.frame().index(point.cell());
        index.is_some_and(|index| chart.is_passable(index))
    })
}

#[cfg(test)]
mod tests {
    use super::{has_arrived, heading};
    use crate::baseline::chart::sketch::chart;
    use crate::baseline::greedy::route::Routes;
    use fieldline_planner::geometry::{Cell, Point};

    #[test]
    fn in_the_open_it_looks_a_metre_ahead() {
        let rows = ["R".to_owned() + &".".repeat(30)];
        let rows: Vec<&str> = rows.iter().map(String::as_str).collect();
        let (chart, robot) = chart(&rows);
        // A way that turns up after a metre is followed straight until then.
        let way: Vec<Point> = (0..=9)
            .map(|x| Cell { x, y: 0 }.centre())
            .chain((1..9).map(|y| Cell { x: 9, y }.centre()))
            .collect();
        assert!(heading(&chart, &way, robot).unwrap().abs() < 1e-6);
        assert!(!has_arrived(&way, robot));
        let end = *way.last().unwrap();
        assert!(has_arrived(&way, end) && heading(&chart, &way, end).is_none());
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
        let routes = Routes::from(&chart, robot.cell());
        let goal = chart.frame().index(Cell { x: 8, y: 5 }).unwrap();
        let way = routes.way(&chart, goal);
        let angle = heading(&chart, &way, robot).unwrap();
        assert!((0.0..0.2).contains(&angle), "{angle}");
    }

    #[test]
    fn without_a_way_there_is_no_heading() {
        let (chart, robot) = chart(&["R.."]);
        assert_eq!(heading(&chart, &[], robot), None);
    }
}

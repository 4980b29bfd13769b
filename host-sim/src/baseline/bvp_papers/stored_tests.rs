//! The stored field on charts drawn by hand: its bounds, its memory, its order of sweeps.

use super::{GOAL, OBSTACLE, Stored};
use crate::baseline::bvp_papers::Precision;
use crate::baseline::chart::{Chart, sketch::chart};
use crate::baseline::slope::Role;
use fieldline_planner::geometry::{Cell, Point};

const ROOMS: [&str; 8] = [
    "##################", //
    "#.......#........#",
    "#.......#........#",
    "#................?",
    "#.......#........#",
    "#..R....#........#",
    "#.......#........#",
    "##################",
];

fn charged(chart: &Chart, robot: Point) -> Stored {
    let mut stored = Stored::default();
    stored.charge(chart, robot.cell(), |_| true);
    stored
}

fn free_cells(stored: &Stored) -> Vec<Cell> {
    let free = (0..stored.area.len()).filter(|&index| stored.roles[index] == Role::Free);
    free.map(|index| stored.area.cell(index)).collect()
}

/// The definition: every free cell in turn, from its four neighbours.
#[test]
fn a_sweep_is_gauss_seidel_in_the_order_of_the_cells() {
    let (chart, robot) = chart(&ROOMS);
    let mut stored = charged(&chart, robot);
    let (mut p, width) = (stored.p.clone(), stored.area.width);
    for _ in 0..7 {
        for index in (0..p.len()).filter(|&index| stored.roles[index] == Role::Free) {
            let others = p[index + 1] + p[index - width] + p[index + width];
            p[index] = 0.25 * (others + p[index - 1]);
        }
    }
    stored.sweep(7, Precision::F64);
    assert_eq!(stored.p, p);
    assert_eq!(stored.cells(), free_cells(&stored).len());
}

#[test]
fn no_sweep_leaves_the_range_of_the_boundary_or_makes_a_maximum() {
    let (chart, robot) = chart(&ROOMS);
    for precision in [Precision::F32, Precision::F64] {
        let mut stored = charged(&chart, robot);
        for _ in 0..300 {
            stored.sweep(1, precision);
            let values = stored.p.iter();
            assert!(values.clone().all(|p| (GOAL..=OBSTACLE).contains(p)));
        }
        for cell in free_cells(&stored) {
            let beside = [(1, 0), (0, 1), (-1, 0), (0, -1)].map(|(dx, dy)| {
                stored.p(Cell {
                    x: cell.x + dx,
                    y: cell.y + dy,
                })
            });
            let greatest = beside.into_iter().fold(GOAL, f64::max);
            let least = beside.into_iter().fold(OBSTACLE, f64::min);
            let p = stored.p(cell);
            assert!(
                least - 1e-6 <= p && p <= greatest + 1e-6,
                "{cell:?}: {p} and {beside:?}"
            );
        }
    }
}

/// By hand: cells a and b between obstacles, with a goal beside b.
#[test]
fn a_sweep_uses_what_it_has_just_written() {
    let (chart, robot) = chart(&["####", "#R.?", "####"]);
    let mut stored = charged(&chart, robot);
    stored.sweep(1, Precision::F64);
    let (a, b) = (Cell { x: 1, y: 1 }, Cell { x: 2, y: 1 });
    // a: three obstacles and b = 0. b: two obstacles, the goal, and the new a.
    assert_eq!((stored.p(a), stored.p(b)), (0.75, (2.0 + 0.75) / 4.0));
}

#[test]
fn a_warm_start_keeps_what_the_map_does_not_change() {
    let (before, robot) = chart(&ROOMS);
    let mut stored = charged(&before, robot);
    stored.sweep(500, Precision::F64);
    let old = stored.clone();
    // Three cells change: a wall is measured, a wall goes, and an unexplored cell is free.
    let mut rows = ROOMS;
    rows[3] = "#.................";
    rows[4] = "#................#";
    rows[2] = "#.......#...#....#";
    let (after, _) = chart(&rows);
    stored.charge(&after, robot.cell(), |_| true);
    let (wall, gone, freed) = (
        Cell { x: 12, y: 5 },
        Cell { x: 8, y: 3 },
        Cell { x: 17, y: 4 },
    );
    assert_eq!(
        (stored.role(wall), stored.p(wall)),
        (Role::Obstacle, OBSTACLE)
    );
    assert_eq!((stored.role(gone), stored.p(gone)), (Role::Free, OBSTACLE));
    assert_eq!((stored.role(freed), stored.p(freed)), (Role::Free, GOAL));
    let same = free_cells(&old).into_iter().filter(|cell| *cell != wall);
    assert!(same.clone().count() > 80);
    for cell in same {
        assert_eq!(stored.p(cell), old.p(cell), "{cell:?}");
    }
}

#[test]
fn a_chart_that_grows_moves_the_values_with_their_cells() {
    let (small, robot) = chart(&ROOMS);
    let mut stored = charged(&small, robot);
    stored.sweep(50, Precision::F64);
    let old = stored.clone();
    let mut rows = ROOMS.map(String::from);
    rows[3].push_str(&".".repeat(40));
    let rows: Vec<&str> = rows.iter().map(String::as_str).collect();
    let (large, _) = chart(&rows);
    assert_ne!(small.area(), large.area());
    stored.charge(&large, robot.cell(), |_| true);
    for cell in free_cells(&old) {
        assert_eq!(stored.p(cell), old.p(cell), "{cell:?}");
    }
}

#[test]
fn a_goal_behind_a_wall_is_out_of_reach() {
    let (open, robot) = chart(&ROOMS);
    assert!(charged(&open, robot).has_goals());
    let mut rows = ROOMS;
    rows[3] = "#.......#........?";
    let (closed, robot) = chart(&rows);
    let stored = charged(&closed, robot);
    assert!(!stored.has_goals());
    let beyond = Cell { x: 12, y: 3 };
    assert_eq!(
        stored.role(beyond),
        Role::Free,
        "it is relaxed all the same"
    );
}

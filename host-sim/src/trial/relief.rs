//! Heights and preferences of the last window's cells, for pictures.
//!
//! Neither is on the wire. The heights are those of the host's copy of the map, which equal the
//! device's. The preferences follow from them by the planner's own code \[Maffei20, eqs. 3 to 5\].
//! They differ from the device's in three ways: `p_diff` is that of the window shown, the device
//! used the field before it; heights count for every `p_diff`, the device has a hysteresis between
//! 1e-10 and 1e-4; the effect of the roll limit is left out.
//!
//! Metres above the start; ε from −2 to 2.

use fieldline_planner::config::KERNEL_CELLS;
use fieldline_planner::config::UnevenGround;
use fieldline_planner::field::preference::Preferences;
use fieldline_planner::geometry::{Cell, Pose};
use fieldline_planner::ground::Heights;
use fieldline_protocol::message::FIELD_SIDE;

use super::snapshot::{Window, WindowCell};
use crate::report::grid_map::CELL_M;

/// Heights and preferences in the order of the window's cells.
#[derive(Clone, Debug, PartialEq)]
pub struct Relief {
    /// Heights of the cells; `None` if not measured or too far away.
    pub heights_m: Vec<Option<f32>>,
    /// Preferences ε of the cells.
    pub preferences: Vec<f32>,
}

impl Relief {
    /// Computes heights and preferences of a window, for a robot at `pose`.
    #[must_use]
    pub fn of(heights: &Heights<'_>, ground: &UnevenGround, pose: &Pose, window: &Window) -> Self {
        let mut preferences = Preferences::new();
        if let Some(flatness) = p_diff(window, pose) {
            preferences.note(flatness);
        }
        let global = preferences.global(ground);
        let indices = 0..FIELD_SIDE * FIELD_SIDE;
        let heights_m: Vec<Option<f32>> = indices
            .map(|index| heights.height_m(middle(window, index)))
            .collect();
        let epsilon = |height_m: &Option<f32>| {
            let difference_m = height_m.map(|height_m| height_m - pose.z_m);
            preferences.of_cell(ground, global, difference_m)
        };
        Self {
            preferences: heights_m.iter().map(epsilon).collect(),
            heights_m,
        }
    }
}

/// Returns the number of map cells along a window cell.
fn scale(window: &Window) -> i32 {
    (window.cell_m / CELL_M).round().max(1.0) as i32
}

/// Returns the map cell in the middle of a window cell.
fn middle(window: &Window, index: usize) -> Cell {
    let scale = scale(window);
    let (x, y) = ((index % FIELD_SIDE) as i32, (index / FIELD_SIDE) as i32);
    Cell {
        x: (window.origin_x + x) * scale + scale / 2,
        y: (window.origin_y + y) * scale + scale / 2,
    }
}

/// Returns the mean of `|q − q_robot|` over the kernel's free cells with a way to a goal; `None` if
/// the robot has none.
fn p_diff(window: &Window, pose: &Pose) -> Option<f32> {
    let (robot, scale) = (pose.point().cell(), scale(window));
    let x = usize::try_from(robot.x.div_euclid(scale) - window.origin_x).ok()?;
    let y = usize::try_from(robot.y.div_euclid(scale) - window.origin_y).ok()?;
    let q = |x: usize, y: usize| {
        let index = y * FIELD_SIDE + x;
        let free = x < FIELD_SIDE && window.cells.get(index) == Some(&WindowCell::Free);
        window.q.get(index).copied().filter(|q| free && *q > 0.0)
    };
    let (here, half) = (q(x, y)?, KERNEL_CELLS / 2);
    let rows = y.saturating_sub(half)..y + half;
    let cells = rows.flat_map(|v| (x.saturating_sub(half)..x + half).map(move |u| (u, v)));
    let others = cells.filter(|place| *place != (x, y));
    let differences: Vec<f32> = others
        .filter_map(|(u, v)| Some((q(u, v)? - here).abs()))
        .collect();
    let count = differences.len() as f32;
    Some(differences.iter().sum::<f32>() / count.max(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use fieldline_planner::GroundTuning;
    use fieldline_planner::ground::elevation::{Elevation, WINDOW_CELLS};

    /// Makes a window at cell (10, −30). Its last column is a goal; q halves with every column to
    /// the left.
    fn window() -> Window {
        let column = |index: usize| index % FIELD_SIDE;
        let cells = (0..FIELD_SIDE * FIELD_SIDE).map(|index| match column(index) {
            60 => WindowCell::Goal,
            0 => WindowCell::Obstacle,
            _ => WindowCell::Free,
        });
        let q = |index: usize| 0.5_f32.powi(60 - column(index) as i32);
        Window {
            origin_x: 10,
            origin_y: -30,
            cell_m: 0.1,
            q: (0..FIELD_SIDE * FIELD_SIDE).map(q).collect(),
            cells: cells.collect(),
        }
    }

    fn pose(x_m: f32) -> Pose {
        Pose {
            x_m,
            y_m: 0.05,
            z_m: 0.5,
            ..Pose::default()
        }
    }

    #[test]
    fn preferences_are_the_formulas() {
        let (mut bytes, mut marks) = (vec![0; 2 * WINDOW_CELLS], vec![0; WINDOW_CELLS]);
        let mut origin = Cell { x: 8, y: -32 };
        let mut elevation =
            Elevation::new(&mut bytes, &mut marks, &mut origin, &GroundTuning::DEFAULT);
        for (x, height_m) in [(20, 0.5), (21, 0.4), (22, 2.0)] {
            elevation.mark_wheel_contact(Cell { x, y: 3 }, height_m);
        }
        // The robot stands in column 40 of the window.
        let (window, ground) = (window(), UnevenGround::TABLE_I);
        let relief = Relief::of(&elevation.read(), &ground, &pose(5.05), &window);
        let row = 33 * FIELD_SIDE;
        assert_eq!(relief.heights_m[row + 9], None);
        assert!((relief.heights_m[row + 11].unwrap() - 0.4).abs() < 0.002);
        // Columns 30 to 49 of 20 rows, without the robot's cell.
        let q = |column: i32| 0.5_f64.powi(60 - column);
        let sum: f64 = (30..50)
            .map(|column| 20.0 * (q(column) - q(40)).abs())
            .sum();
        let global = -0.005 * (sum / 399.0).ln();
        for (column, exact) in [
            (9, global),
            (10, global),
            (11, global - 0.2),
            (12, global - 0.5),
        ] {
            let ours = f64::from(relief.preferences[row + column]);
            // A height is stored in steps of 2 mm and has the weight 2.
            assert!((ours - exact).abs() < 0.005, "{column}: {ours} {exact}");
        }
    }

    #[test]
    fn without_a_way_to_a_goal_there_is_no_global_preference() {
        let (bytes, marks) = (vec![0; 2 * WINDOW_CELLS], vec![0; WINDOW_CELLS]);
        let heights = Heights::new(&bytes, &marks, Cell { x: 8, y: -32 });
        for x_m in [1.05, -3.0, 20.0] {
            let relief = Relief::of(&heights, &UnevenGround::TABLE_I, &pose(x_m), &window());
            assert!(relief.preferences.iter().all(|epsilon| *epsilon == 0.0));
        }
    }
}

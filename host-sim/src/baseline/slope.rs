//! What is read from a potential over the cells of a chart: a heading between cell centres, and
//! the window around the robot that pictures and `--check-field` know.
//!
//! Units: radians counter-clockwise from x; map cells.

use fieldline_planner::geometry::{CELL_M, Cell, Point};
use fieldline_planner::math;
use fieldline_protocol::message::{FIELD_SIDE, FieldRow};

/// Role of a cell in a boundary-value problem.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Role {
    /// Relaxed.
    Free,
    /// Holds the potential of obstacles.
    #[default]
    Obstacle,
    /// Holds the potential of goals.
    Goal,
}

impl Role {
    /// Returns the two bits of the role in a [`FieldRow`].
    const fn code(self) -> u8 {
        match self {
            Self::Free => 0,
            Self::Obstacle => 1,
            Self::Goal => 2,
        }
    }
}

/// Returns the heading at a point, from the downhill direction at the centres of the four cells
/// around it. `downhill` is `None` in cells that are not free. Returns `None` if the point's own
/// cell is not free, and where the sum has no direction.
pub(super) fn heading(point: Point, downhill: impl Fn(Cell) -> Option<(f64, f64)>) -> Option<f32> {
    downhill(point.cell())?;
    let (x, y) = (point.x_m / CELL_M - 0.5, point.y_m / CELL_M - 0.5);
    let (west, south) = (math::floor(x), math::floor(y));
    let (along, up) = (f64::from(x - west as f32), f64::from(y - south as f32));
    let mut sum = (0.0, 0.0);
    for (dx, dy, weight) in [
        (0, 0, (1.0 - along) * (1.0 - up)),
        (1, 0, along * (1.0 - up)),
        (0, 1, (1.0 - along) * up),
        (1, 1, along * up),
    ] {
        let cell = Cell {
            x: west + dx,
            y: south + dy,
        };
        if let Some((gx, gy)) = downhill(cell) {
            sum = (sum.0 + weight * gx, sum.1 + weight * gy);
        }
    }
    // f32 cannot hold the magnitude of the gradient, and the heading does not need it.
    let size = sum.0.abs().max(sum.1.abs());
    (size > 0.0).then(|| math::atan2((sum.1 / size) as f32, (sum.0 / size) as f32))
}

/// Returns a row of the window around the robot; `of` gives role and q = 1 − p of a cell. Returns
/// `None` for a row that the window does not have.
pub(super) fn field_row(
    robot: Cell,
    row: u8,
    of: impl Fn(Cell) -> (Role, f32),
) -> Option<FieldRow> {
    if usize::from(row) >= FIELD_SIDE {
        return None;
    }
    let half = FIELD_SIDE as i32 / 2;
    let y = robot.y - half + i32::from(row);
    let cells = (0..FIELD_SIDE as i32).map(|x| Cell {
        x: robot.x - half + x,
        y,
    });
    let mut packed = [0u8; FIELD_SIDE.div_ceil(4)];
    for (x, cell) in cells.clone().enumerate() {
        packed[x / 4] |= of(cell).0.code() << (2 * (x % 4));
    }
    Some(FieldRow {
        row,
        origin_x: (robot.x - half) as i16,
        origin_y: (robot.y - half) as i16,
        scale: 1,
        q: cells.map(|cell| of(cell).1).collect(),
        cells: packed.into_iter().collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::{Role, field_row, heading};
    use fieldline_planner::geometry::{Cell, Point};
    use fieldline_protocol::message::FIELD_SIDE;

    #[test]
    fn a_heading_lies_between_those_of_the_cells_around() {
        // East in column 0, north in column 1; nothing beyond.
        let downhill = |cell: Cell| match cell.x {
            0 => Some((1.0, 0.0)),
            1 => Some((0.0, 1.0)),
            _ => None,
        };
        let at = |x_m: f32| heading(Point { x_m, y_m: 0.05 }, downhill);
        assert_eq!(at(0.05), Some(0.0));
        let between = at(0.1).expect("a direction");
        assert!((between.to_degrees() - 45.0).abs() < 0.01, "{between}");
        assert_eq!(at(-0.05), None, "its own cell is not free");
        assert_eq!(heading(Point::default(), |_| Some((0.0, 0.0))), None);
    }

    #[test]
    fn a_row_has_two_bits_for_each_cell() {
        let robot = Cell { x: 5, y: 7 };
        let of = |cell: Cell| match cell.x - robot.x {
            -1 => (Role::Obstacle, 0.0),
            1 => (Role::Goal, 1.0),
            _ => (Role::Free, 0.5),
        };
        let middle = FIELD_SIDE / 2;
        let row = field_row(robot, middle as u8, of).expect("a row of the window");
        let bits = |x: usize| row.cells[x / 4] >> (2 * (x % 4)) & 3;
        assert_eq!([middle - 1, middle, middle + 1].map(bits), [1, 0, 2]);
        assert_eq!((row.q[middle - 1], row.q[middle + 1]), (0.0, 1.0));
        assert_eq!(field_row(robot, FIELD_SIDE as u8, of), None);
    }
}

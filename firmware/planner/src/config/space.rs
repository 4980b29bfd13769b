//! The area and the end of an exploration by a space-based potential field \[Kenealy15\].
//!
//! Units: map cells; metres where a name says so.

use crate::geometry::{CELL_M, Cell};
use crate::math;

/// A rectangle of map cells that a robot explores, for [`Strategy::Sbpf`](crate::Strategy::Sbpf)
/// and [`Strategy::Esbpf`](crate::Strategy::Esbpf).
///
/// ```
/// use fieldline_planner::{Area, Cell};
///
/// // 10 × 8 m, with the start at its middle.
/// let area = Area::of_metres((-5.0, -4.0), (10.0, 8.0));
/// assert_eq!((area.least, area.across, area.up), (Cell { x: -50, y: -40 }, 100, 80));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Area {
    /// The cell with the least x and y.
    pub least: Cell,
    /// Map cells along x.
    pub across: u16,
    /// Map cells along y.
    pub up: u16,
}

impl Area {
    /// The most map cells along a side: 128 m.
    pub const MOST_CELLS: u16 = 1_280;

    /// Returns the area with this least corner and size, metres, rounded to map cells. A size
    /// beyond its range stays beyond the range.
    #[must_use]
    pub fn of_metres((x_m, y_m): (f32, f32), (width_m, height_m): (f32, f32)) -> Self {
        let cells = |metres: f32| math::floor(metres / CELL_M + 0.5);
        let side = |metres: f32| cells(metres).clamp(0, u16::MAX.into()) as u16;
        Self {
            least: Cell {
                x: cells(x_m),
                y: cells(y_m),
            },
            across: side(width_m),
            up: side(height_m),
        }
    }
}

/// The parameters of a space-based potential field.
///
/// ```
/// use fieldline_planner::{Area, Config, LaserMount, RobotShape, SpaceField, Strategy};
///
/// let field = SpaceField {
///     until_permille: 900,
///     ..SpaceField::over(Area::of_metres((-5.0, -4.0), (10.0, 8.0)))
/// };
/// let config = Config::builder(RobotShape::PIONEER_3AT)
///     .laser(LaserMount::level(0.10, 0.40))
///     .strategy(Strategy::Esbpf(field))
///     .build()?;
/// # Ok::<(), fieldline_planner::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SpaceField {
    /// The area. Its size is known before the exploration.
    pub area: Area,
    /// Number of covered cells that ends the exploration, thousandths of the area: 1 to 1000.
    pub until_permille: u16,
    /// Time without a newly covered cell after which the robot follows a path to the nearest
    /// frontier, seconds; `None` for never, as in \[Kenealy15\].
    pub impatience_s: Option<u16>,
}

impl SpaceField {
    /// Returns the parameters of the paper for an area: forces only, until all is covered.
    #[must_use]
    pub const fn over(area: Area) -> Self {
        Self {
            area,
            until_permille: 1_000,
            impatience_s: None,
        }
    }
}

//! The planner's path, and tractor point and shield while it closes a loop.
//!
//! The path comes over the link in pages of [`PATH_PAGE`] cells. A place is a roadmap cell of
//! 20 cm, given by the map cell of 10 cm in its corner with least x and y.

use fieldline_protocol::message::PATH_PAGE;

use crate::link::{Link, LinkError};
use crate::report::grid_map::CELL_M;

/// A roadmap cell.
pub type Place = (i16, i16);

/// The path to the goal.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PlannedPath {
    /// The tractor point: a place behind the robot, to be reached by the way ahead.
    pub tractor: Option<Place>,
    /// The ends of the shield, a wall behind the robot; `None` unless a loop is being closed.
    pub shield: Option<[Place; 2]>,
    /// The cells of the path, the robot's end first.
    pub cells: Vec<Place>,
}

/// Reads the present path.
///
/// # Errors
/// As [`LinkError`].
pub fn read(link: &mut dyn Link) -> Result<PlannedPath, LinkError> {
    let first = link.path(0)?;
    let mut planned_path = PlannedPath {
        tractor: first.tractor,
        shield: first.shield,
        cells: first.cells.to_vec(),
    };
    let pages = (1..).map(|page| page * PATH_PAGE);
    for from in pages.map_while(|from| u8::try_from(from).ok()) {
        if from >= first.length {
            break;
        }
        planned_path.cells.extend(link.path(from)?.cells);
    }
    Ok(planned_path)
}

/// Returns the middle of a roadmap cell, metres.
#[must_use]
pub fn middle_m((x, y): Place) -> [f64; 2] {
    [x, y].map(|at| f64::from(i32::from(at) + 1) * CELL_M)
}

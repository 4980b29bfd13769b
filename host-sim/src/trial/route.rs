//! Where the planner was going: its road, and tractor point and shield while it closes a loop.
//!
//! The road comes over the link in pages of [`PATH_PAGE`] cells. Units: map cells, the least ones of the planner's own of 20 cm.

use fieldline_protocol::message::PATH_PAGE;

use crate::link::{Link, LinkError};
use crate::report::grid_map::CELL_M;

/// A cell of the planner's.
pub type Place = (i16, i16);

/// Where the planner was going.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Route {
    /// The place behind the robot that is to be reached by the way ahead.
    pub tractor: Option<Place>,
    /// The ends of the wall behind the robot; there is one while a loop is being closed.
    pub shield: Option<[Place; 2]>,
    /// The road, the robot's end first.
    pub road: Vec<Place>,
}

/// The route of now.
///
/// # Errors
/// As [`LinkError`].
pub fn read(link: &mut dyn Link) -> Result<Route, LinkError> {
    let first = link.path(0)?;
    let mut route = Route {
        tractor: first.tractor,
        shield: first.shield,
        road: first.cells.to_vec(),
    };
    let pages = (1..).map(|page| page * PATH_PAGE);
    for from in pages.map_while(|from| u8::try_from(from).ok()) {
        if from >= first.length {
            break;
        }
        route.road.extend(link.path(from)?.cells);
    }
    Ok(route)
}

/// The middle of a planner's cell, metres.
#[must_use]
pub fn middle_m((x, y): Place) -> [f64; 2] {
    [x, y].map(|at| f64::from(i32::from(at) + 1) * CELL_M)
}

//! Why a team's run cannot begin.

use thiserror::Error;

use super::TimetableError;
use crate::radio::MOST_ROBOTS;
use crate::sim::FleetError;
use crate::trial::mission::MissionError;
use crate::world::WorldError;

/// Reason why a team's run could not begin.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum TeamError {
    /// There are too few robots or too many.
    #[error("a team of {0} robots is not possible; give 1 to {MOST_ROBOTS}")]
    Robots(usize),
    /// Not all robots find a place to start.
    #[error(
        "only {fitting} of {robots} robots find room {}{}; take fewer robots, or another \
         --start{}{}",
        if *apart { "apart" } else { "side by side" },
        if *is_fenced { " where --bounds and --no-go let them stand" } else { "" },
        if *apart { "" } else { ", or say --apart" },
        if *is_fenced { ", or wider bounds" } else { "" }
    )]
    Room {
        /// Robots that do.
        fitting: usize,
        /// Robots of the team.
        robots: usize,
        /// True if they were to start far apart.
        apart: bool,
        /// True if the robots may not be everywhere.
        is_fenced: bool,
    },
    /// The timetable is impossible.
    #[error(transparent)]
    Timetable(TimetableError),
    /// The radio names a robot that the team does not have.
    #[error("a partition of the radio names robot {0}, which the team does not have")]
    Stranger(usize),
    /// Robots do not fit at their starts.
    #[error(transparent)]
    Fleet(FleetError),
    /// A robot cannot begin.
    #[error("robot {robot}: {error}")]
    Robot {
        /// Its number.
        robot: usize,
        /// The reason.
        error: MissionError,
    },
}

impl From<WorldError> for TeamError {
    fn from(error: WorldError) -> Self {
        Self::Robot {
            robot: 0,
            error: error.into(),
        }
    }
}

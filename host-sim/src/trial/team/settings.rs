//! The settings of a team's run.

use super::{StartError, Timetable};
use crate::radio::RadioSpec;
use crate::trial::mission::Mission;
use crate::world::Start;

/// Settings of a team's run.
#[derive(Clone, Debug, PartialEq)]
pub struct TeamMission {
    /// What all robots have in common. The first robot stands at its start and has its seed.
    pub mission: Mission,
    /// Number of robots, 1 to [`MOST_ROBOTS`](crate::radio::MOST_ROBOTS).
    pub robots: usize,
    /// Names of the links, robot by robot, for the report.
    pub links: Vec<String>,
    /// True if the robots start far apart, false if side by side.
    pub apart: bool,
    /// Starts of all robots to use instead of those.
    pub places: Option<Vec<Start>>,
    /// Errors of the starts that all robots but the first are told.
    pub start_error: StartError,
    /// The radio between them. If it is off, the planners know of no team.
    pub radio: RadioSpec,
    /// Who leaves and who joins again.
    pub timetable: Timetable,
}

impl TeamMission {
    /// A team of robots by direct links, side by side, with a perfect radio.
    #[must_use]
    pub fn of(mission: Mission, robots: usize) -> Self {
        Self {
            links: vec![mission.link.clone(); robots],
            mission,
            robots,
            apart: false,
            places: None,
            start_error: StartError::default(),
            radio: RadioSpec::default(),
            timetable: Timetable::default(),
        }
    }

    /// The mission of one robot.
    pub(super) fn mission_of(&self, robot: usize, place: Start) -> Mission {
        Mission {
            link: self.links.get(robot).cloned().unwrap_or_default(),
            seed: seed_of(self.mission.seed, robot),
            place: Some(place),
            ..self.mission.clone()
        }
    }
}

/// The seed of a robot's noise: the run's for the first, and far from it for the others.
fn seed_of(seed: u64, robot: usize) -> u64 {
    seed.wrapping_add((robot as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15))
}

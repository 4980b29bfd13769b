//! Who leaves the team and who joins it again, and when: `2@90`, robot 2 at 90 s.

use core::str::FromStr;
use thiserror::Error;

use crate::spec::SpecError;

/// A robot leaves or joins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Appointment {
    /// When, milliseconds.
    pub time_ms: u32,
    /// The robot's number, from 0.
    pub robot: usize,
}

impl FromStr for Appointment {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, SpecError> {
        let parse = || {
            let (robot, seconds) = text.split_once('@')?;
            let seconds: f64 = seconds.trim().parse().ok()?;
            let is_time = (1e-3..=4e6).contains(&seconds);
            Some(Self {
                time_ms: is_time.then_some(seconds * 1000.0)? as u32,
                robot: robot.trim().parse().ok()?,
            })
        };
        parse().ok_or_else(|| {
            SpecError::new(format!(
                "'{text}' is not ROBOT@SECONDS; write for instance 2@90 for robot 2 after 90 s"
            ))
        })
    }
}

/// Leaves and joins of a run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Timetable {
    /// Who leaves.
    pub leave: Vec<Appointment>,
    /// Who joins again.
    pub join: Vec<Appointment>,
}

/// Why a timetable is impossible.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum TimetableError {
    /// It names a robot that the team does not have.
    #[error(
        "there is no robot {robot}; the {robots} robots have the numbers 0 to {}",
        robots.saturating_sub(1)
    )]
    NoRobot {
        /// The number.
        robot: usize,
        /// Number of robots.
        robots: usize,
    },
    /// A robot joins that has not left, or leaves that has not joined again.
    #[error("robot {robot} must leave before it joins, and join before it leaves again")]
    Order {
        /// The robot.
        robot: usize,
    },
}

impl Timetable {
    /// Checks that each robot of a team leaves and joins in turn.
    ///
    /// # Errors
    /// [`TimetableError`].
    pub fn check(&self, robots: usize) -> Result<(), TimetableError> {
        for robot in self.leave.iter().chain(&self.join).map(|it| it.robot) {
            if robot >= robots {
                return Err(TimetableError::NoRobot { robot, robots });
            }
            let times = |list: &[Appointment]| {
                let mine = list.iter().filter(|it| it.robot == robot);
                let mut times: Vec<u32> = mine.map(|it| it.time_ms).collect();
                times.sort_unstable();
                times
            };
            let (leave, join) = (times(&self.leave), times(&self.join));
            let mut turns = leave.iter().zip(&join);
            let mut again = join.iter().zip(leave.iter().skip(1));
            let in_turn = turns.all(|(leave, join)| leave < join)
                && again.all(|(join, leave)| join < leave)
                && (join.len()..=join.len() + 1).contains(&leave.len());
            if !in_turn {
                return Err(TimetableError::Order { robot });
            }
        }
        Ok(())
    }

    /// Returns true if a robot leaves after one time and until another.
    pub(super) fn leaves(&self, robot: usize, span_ms: [u32; 2]) -> bool {
        is_in(&self.leave, robot, span_ms)
    }

    /// Returns true if a robot joins after one time and until another.
    pub(super) fn joins(&self, robot: usize, span_ms: [u32; 2]) -> bool {
        is_in(&self.join, robot, span_ms)
    }
}

fn is_in(list: &[Appointment], robot: usize, [after_ms, until_ms]: [u32; 2]) -> bool {
    let mut mine = list.iter().filter(|it| it.robot == robot);
    mine.any(|it| after_ms < it.time_ms && it.time_ms <= until_ms)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(text: &str) -> Appointment {
        text.parse().expect("an appointment")
    }

    #[test]
    fn an_appointment_is_read_and_a_bad_one_is_shown() {
        let expected = Appointment {
            time_ms: 90_500,
            robot: 2,
        };
        assert_eq!(at("2@90.5"), expected);
        for text in ["2", "@90", "2@", "two@90", "2@-1", "2@0", "2@nan", "-1@3"] {
            let error = text.parse::<Appointment>().unwrap_err().to_string();
            assert!(error.contains(text) && error.contains("2@90"), "{error}");
        }
    }

    #[test]
    fn robots_leave_and_join_in_turn() {
        let check = |leave: &[&str], join: &[&str]| {
            let table = Timetable {
                leave: leave.iter().map(|text| at(text)).collect(),
                join: join.iter().map(|text| at(text)).collect(),
            };
            table.check(3)
        };
        assert_eq!(check(&["2@90", "1@10"], &["2@150"]), Ok(()));
        assert_eq!(check(&["2@90", "2@200"], &["2@150"]), Ok(()));
        let order = Err(TimetableError::Order { robot: 2 });
        assert_eq!(check(&[], &["2@150"]), order);
        assert_eq!(check(&["2@160"], &["2@150"]), order);
        assert_eq!(check(&["2@90", "2@140"], &["2@150"]), order);
        let stranger = TimetableError::NoRobot {
            robot: 3,
            robots: 3,
        };
        assert!(stranger.to_string().contains("0 to 2"));
        assert_eq!(check(&["3@90"], &[]), Err(stranger));
    }
}

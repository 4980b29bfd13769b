//! Ends of a run, and their words in the report.

use fieldline_protocol::message::{Errand, Fault, Finish};

use super::wiring_advice::wiring_advice;
use super::wording;
use crate::link::LinkError;
use crate::sim::Loss;

/// End of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Ending {
    /// The planner finished.
    Finished(Finish),
    /// The planner cannot go on.
    Fault(Fault),
    /// The robot's budget was spent, or it was time to drive home, and it is home.
    AtHome,
    /// The robot could not get where it was ordered to go after its exploration.
    Unreachable(Errand),
    /// The link failed; the robot's own watchdog stopped it.
    Link(LinkError),
    /// The robot fell or tipped over.
    Lost(Loss),
    /// The simulated time limit was reached.
    TimeLimit,
    /// The planner said that it explored, and the robot did not move or turn for a minute.
    Frozen,
    /// As frozen, and the planner still waited for a scan.
    NoScan,
    /// The user stopped it.
    Interrupted,
    /// The robot left its team.
    Left,
}

impl Ending {
    /// Returns `finished`, `fault`, `lost`, `time-limit`, `frozen`, `interrupted` or `left`.
    #[must_use]
    pub fn status(&self) -> &'static str {
        match self {
            Self::Finished(_) | Self::AtHome => "finished",
            Self::Fault(_) | Self::Unreachable(_) | Self::Link(_) => "fault",
            Self::Lost(_) => "lost",
            Self::TimeLimit => "time-limit",
            Self::Frozen | Self::NoScan => "frozen",
            Self::Interrupted => "interrupted",
            Self::Left => "left",
        }
    }

    /// Returns the kind of finish or fault: one word from a closed list.
    #[must_use]
    pub fn reason(&self) -> &'static str {
        match self {
            Self::Finished(why) => wording::finish(*why),
            Self::Fault(why) => wording::fault(*why),
            Self::AtHome => "at-home",
            Self::Unreachable(Errand::Home) => "cannot-get-home",
            Self::Unreachable(Errand::Goal) => "cannot-get-to-goal",
            Self::Link(LinkError::Silent) => "link-silent",
            Self::Link(LinkError::Reset) => "device-reset",
            Self::Link(LinkError::Crashed(_)) => "device-crashed",
            Self::Link(LinkError::Incompatible(_)) => "device-incompatible",
            Self::Link(LinkError::Refused(_)) => "request-refused",
            Self::Link(LinkError::Io(_)) => "link-io",
            Self::Lost(Loss::Fell) => "fell",
            Self::Lost(Loss::Tipped) => "tipped",
            Self::TimeLimit => "simulated-time",
            Self::Frozen => "no-motion",
            Self::NoScan => "no-scan",
            Self::Interrupted => "user",
            Self::Left => "timetable",
        }
    }

    /// Returns the names of what the device lost: `map`, `pose` and `strategy` after a reboot.
    #[must_use]
    pub const fn lost(&self) -> &'static [&'static str] {
        match self {
            Self::Link(why) => why.lost(),
            _ => &[],
        }
    }

    /// Returns a sentence with the cause and the remedy; `None` if everything is explored.
    #[must_use]
    pub fn advice(&self) -> Option<String> {
        let text = match self {
            Self::Finished(Finish::Explored | Finish::Covered) => return None,
            Self::Finished(Finish::BoxedIn) => "the robot has no free way out of its place; \
                 choose another start with --start or robots:"
                .into(),
            Self::Finished(Finish::NothingAttracts) => {
                "no cell that borders on what is covered is left to attract \
                 the robot; --strategy esbpf follows paths to the rest"
                    .into()
            }
            Self::Finished(Finish::Stopped) => "the device was told to stop".into(),
            Self::Fault(why) => fault_advice(*why).into(),
            Self::AtHome => "the budget was spent, or it was time to be home, before everything \
                 was explored; allow more with --range-m, --time-s and --home-at"
                .into(),
            Self::Unreachable(to) => format!(
                "the robot found no way {}; trips of report.json says where it stands",
                match to {
                    Errand::Home => "home",
                    Errand::Goal => "to a goal of --goto",
                }
            ),
            Self::Link(why) if why.lost().is_empty() => why.to_string(),
            Self::Link(why) => format!(
                "{why}; the run's folder keeps the trajectory, the commands and the pictures"
            ),
            Self::Lost(why) => {
                let what = match why {
                    Loss::Fell => "a wheel lost the ground",
                    Loss::Tipped => "the ground was too steep to stand on",
                };
                format!("{what}; see run.png, and the failing limits in report.json")
            }
            Self::TimeLimit => "the simulated time ran out; allow more with --time-limit".into(),
            Self::Frozen => "the robot did not move or turn for a minute while exploring; \
                 see run.png"
                .into(),
            Self::NoScan => "the lidar never spoke: no scan with a range came for a minute; check \
                 that it has power, turns and is read, and its least_range, mask and hull"
                .into(),
            Self::Interrupted => "stopped by the user".into(),
            Self::Left => "the robot left its team and did not join again".into(),
        };
        Some(text)
    }
}

fn fault_advice(fault: Fault) -> &'static str {
    match fault {
        Fault::StartBlocked => {
            "the start pose lies in an obstacle; \
             change robots: of the world, or choose another --start"
        }
        Fault::MapFull => "the device's map is full; use a larger image or a smaller world",
        Fault::OutOfBox => "the world is larger than the map, which ends 403 m from its start",
        Fault::BadObservation => "an observation did not match the lasers of the start message",
        Fault::StartForbidden => {
            "the start pose lies out of the bounds or in a no-go polygon; \
             change --bounds and --no-go, or choose another --start"
        }
        Fault::Trapped => {
            "the forces of the field lead nowhere; --sbpf-impatience 5 lets the robot follow a path"
        }
        Fault::Stuck => "the robot did not move although it was commanded to; see run.png",
        Fault::PoseLost => "the scan contradicts the map, and no place near by agrees; see run.png",
        Fault::Miswired(mistake) => wiring_advice(mistake),
    }
}

#[cfg(test)]
mod tests {
    use super::Ending;
    use crate::link::LinkError;
    use crate::sim::Loss;
    use fieldline_protocol::message::{Fault, Finish};

    #[test]
    fn words_of_the_report() {
        let words = |ending: Ending| (ending.status(), ending.reason());
        assert_eq!(
            words(Ending::Finished(Finish::Explored)),
            ("finished", "explored")
        );
        assert_eq!(
            words(Ending::Fault(Fault::StartBlocked)),
            ("fault", "start-blocked")
        );
        assert_eq!(
            words(Ending::Link(LinkError::Silent)),
            ("fault", "link-silent")
        );
        assert_eq!(words(Ending::Lost(Loss::Fell)), ("lost", "fell"));
        assert_eq!(words(Ending::Lost(Loss::Tipped)), ("lost", "tipped"));
        assert_eq!(words(Ending::TimeLimit), ("time-limit", "simulated-time"));
        assert_eq!(words(Ending::Frozen), ("frozen", "no-motion"));
        assert_eq!(words(Ending::NoScan), ("frozen", "no-scan"));
    }

    #[test]
    fn a_crash_says_what_is_lost_and_what_is_kept() {
        let crash = Ending::Link(LinkError::Crashed("stack overflow".into()));
        assert_eq!(crash.lost(), ["map", "pose", "strategy"]);
        let words = "the device's program crashed: stack overflow; its map, its pose and the state \
                     of its strategy are lost, so an exploration begins anew; the run's folder \
                     keeps the trajectory, the commands and the pictures";
        assert_eq!(crash.advice().as_deref(), Some(words));
        let reset = Ending::Link(LinkError::Reset);
        assert_eq!(reset.lost(), crash.lost());
        assert!(reset.advice().is_some_and(|it| it.contains("are lost")));
        let silent = Ending::Link(LinkError::Silent);
        assert!(silent.lost().is_empty());
        assert!(silent.advice().is_some_and(|it| !it.contains("lost")));
    }

    #[test]
    fn only_explored_needs_no_advice() {
        assert_eq!(Ending::Finished(Finish::Explored).advice(), None);
        let advice = Ending::Finished(Finish::BoxedIn).advice().unwrap();
        assert!(advice.contains("--start"));
    }
}

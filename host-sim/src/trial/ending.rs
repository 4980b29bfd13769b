//! How a run ends, and the words for it.

use fieldline_protocol::message::{Fault, Finish};

use super::wording;
use crate::link::LinkError;
use crate::sim::Loss;

/// How a run ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Ending {
    /// The planner says that it is done.
    Finished(Finish),
    /// The planner says that it cannot go on.
    Fault(Fault),
    /// The link failed; the robot stopped by its own watchdog.
    Link(LinkError),
    /// The robot fell or tipped over.
    Lost(Loss),
    /// The simulated time ran out.
    TimeLimit,
    /// The robot neither moved nor turned for too long while it said that it explored.
    Frozen,
    /// The user stopped it.
    Interrupted,
}

impl Ending {
    /// `finished`, `fault`, `lost`, `time-limit`, `frozen` or `interrupted`.
    #[must_use]
    pub fn status(&self) -> &'static str {
        match self {
            Self::Finished(_) => "finished",
            Self::Fault(_) | Self::Link(_) => "fault",
            Self::Lost(_) => "lost",
            Self::TimeLimit => "time-limit",
            Self::Frozen => "frozen",
            Self::Interrupted => "interrupted",
        }
    }

    /// Which finish or fault; one word, from a closed list.
    #[must_use]
    pub fn reason(&self) -> &'static str {
        match self {
            Self::Finished(why) => wording::finish(*why),
            Self::Fault(why) => wording::fault(*why),
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
            Self::Interrupted => "user",
        }
    }

    /// One sentence for a person: what happened and what to do about it; `None` where all is well.
    #[must_use]
    pub fn advice(&self) -> Option<String> {
        let text = match self {
            Self::Finished(Finish::Explored) => return None,
            Self::Finished(Finish::BoxedIn) => {
                "the robot has no free way out of where it stands; start it elsewhere with --start or robots:".into()
            }
            Self::Finished(Finish::Stopped) => "the device was told to stop".into(),
            Self::Fault(why) => fault_advice(*why).into(),
            Self::Link(why) => why.to_string(),
            Self::Lost(Loss::Fell) => {
                "a wheel lost the ground; look at run.png, and at the failing limits in report.json".into()
            }
            Self::Lost(Loss::Tipped) => {
                "the ground was too steep to stand on; look at run.png, and at the failing limits in report.json".into()
            }
            Self::TimeLimit => "the simulated time ran out; allow more with --time-limit".into(),
            Self::Frozen => "the robot neither moved nor turned for a minute while exploring; look at run.png".into(),
            Self::Interrupted => "stopped by the user".into(),
        };
        Some(text)
    }
}

fn fault_advice(fault: Fault) -> &'static str {
    match fault {
        Fault::StartBlocked => {
            "the start pose lies in an obstacle; move it in the world's robots: or choose another with --start"
        }
        Fault::MapFull => "the device's map is full; a larger image or a smaller world is needed",
        Fault::OutOfBox => {
            "the world does not fit the map's box; choose its shape with --map-shape"
        }
        Fault::BadObservation => "the device refused an observation that does not match its lasers",
        Fault::Stuck => "the robot did not move although commanded; look at run.png",
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
    }

    #[test]
    fn only_explored_needs_no_advice() {
        assert_eq!(Ending::Finished(Finish::Explored).advice(), None);
        let advice = Ending::Finished(Finish::BoxedIn).advice().unwrap();
        assert!(advice.contains("--start"));
    }
}

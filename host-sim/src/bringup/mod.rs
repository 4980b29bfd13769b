//! Bring-up: six steps from a link that answers to a robot that stops.
//!
//! | step | what is done | passes if |
//! | --- | --- | --- |
//! | 1 link | hello, start, pause | the device answers with this protocol and takes the robot |
//! | 2 scan | the robot stands | beams come, enough return, none are millimetres |
//! | 3 stand | the robot stands | odometry stands, the clock goes on by the period |
//! | 4 turn | a quarter turn left, and back | command, odometry and scan agree |
//! | 5 drive | half a metre ahead | command, odometry and scan agree |
//! | 6 stop | back, then stop | it stands as soon as its braking allows |
//!
//! The session is paused, so the device checks each observation and moves nothing: the steps
//! command the robot themselves. The first step that fails ends the bring-up, because the later
//! ones would drive a robot that is known to be wrong. The robot is the simulated one, whatever the
//! link; a host with a robot of its own makes the same steps.
//!
//! Units: metres, radians, seconds; milliseconds where a name says so.

mod judge;
mod measure;
mod steps;

use std::time::Instant;

use fieldline_planner::{Config, Tuning};
use fieldline_protocol::message::{Control, Fault, Observation, Start, Status, Twist};
use fixed::types::I4F12;
use serde::Serialize;

use crate::link::{Link, LinkError};
use crate::robot::wrap;
use crate::trial::Body;

/// A step and what came of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Step {
    /// 1 to 6.
    pub number: u8,
    /// One word.
    pub name: &'static str,
    /// What to do.
    pub to_do: &'static str,
    /// What was seen.
    pub seen: String,
    /// True if it is as it should be.
    pub passed: bool,
    /// What to look at, if it is not.
    pub remedy: Option<String>,
}

/// What a step saw, and the remedy if that is wrong.
pub(crate) type Finding = (String, Option<String>);

/// Link, robot, and what was told so far.
pub(crate) struct Bench<'a> {
    link: &'a mut dyn Link,
    body: &'a mut dyn Body,
    start: &'a Start,
    config: Config,
    /// The longest answer so far, milliseconds.
    slowest_ms: f64,
}

/// Why a step could not be made.
pub(crate) enum Stopped {
    /// The link failed.
    Link(LinkError),
    /// The device does not take the observations.
    Refuses,
}

impl From<LinkError> for Stopped {
    fn from(error: LinkError) -> Self {
        Self::Link(error)
    }
}

/// Makes the steps until one fails, and tells each; returns true if all passed.
pub fn run(
    link: &mut dyn Link,
    body: &mut dyn Body,
    start: &Start,
    mut tell: impl FnMut(&Step),
) -> bool {
    let (step, config) = steps::link(link, start);
    tell(&step);
    let Some(config) = config.filter(|_| step.passed) else {
        return false;
    };
    let mut bench = Bench {
        link,
        body,
        start,
        config,
        slowest_ms: 0.0,
    };
    for (number, (name, to_do, make)) in (2..).zip(steps::STEPS) {
        let (seen, remedy) = match make(&mut bench) {
            Ok(finding) => finding,
            Err(stopped) => stopped.finding(),
        };
        let step = Step {
            number,
            name,
            to_do,
            passed: remedy.is_none(),
            seen,
            remedy,
        };
        tell(&step);
        if !step.passed {
            bench.body.drive(Some(Twist::default()));
            return false;
        }
    }
    // A device that is told to stop forgets the session; a link that broke now has passed before.
    let _ = bench.link.control(&Control::Stop);
    true
}

impl Stopped {
    fn finding(&self) -> Finding {
        match self {
            Self::Link(error) => ("the link failed".into(), Some(error.to_string())),
            Self::Refuses => (
                "the device refuses the observation".into(),
                Some(
                    "scans, beams and lasers of the robot file and of the observations must match, \
                     and no number may be NaN or beyond 10 km"
                        .into(),
                ),
            ),
        }
    }
}

impl Bench<'_> {
    /// Observes, and shows the device what was observed.
    fn observe(&mut self) -> Result<Observation, Stopped> {
        let observation = self.body.observe();
        let asked = Instant::now();
        let command = self.link.observe(&observation)?;
        let answer_ms = asked.elapsed().as_secs_f64() * 1e3;
        self.slowest_ms = self.slowest_ms.max(answer_ms);
        if command.status == Status::Fault(Fault::BadObservation) {
            return Err(Stopped::Refuses);
        }
        Ok(observation)
    }

    /// Commands a velocity for some seconds, and then to stand until it does. Returns what was
    /// observed, before the first period and after each.
    fn drive(&mut self, command: Velocity, seconds: f64) -> Result<Vec<Observation>, Stopped> {
        let period_s = f64::from(self.body.period_ms()) * 1e-3;
        let periods = (seconds / period_s).round().max(1.0) as usize;
        let rest = (REST_S / period_s).ceil() as usize;
        let twist = Twist {
            linear: I4F12::saturating_from_num(command.0 * seconds / (periods as f64 * period_s)),
            angular: I4F12::saturating_from_num(command.1 * seconds / (periods as f64 * period_s)),
        };
        let mut seen = vec![self.observe()?];
        for period in 0..periods + rest {
            let told = if period < periods {
                twist
            } else {
                Twist::default()
            };
            self.body.drive(Some(told));
            seen.push(self.observe()?);
        }
        Ok(seen)
    }
}

/// Metres and radians a second.
type Velocity = (f64, f64);

/// Time after which a robot stands, seconds: the planner asks for no less braking.
const REST_S: f64 = 3.0;

/// Returns how far odometry turned in all, radians.
fn turned_rad(seen: &[Observation]) -> f64 {
    let yaw = |observation: &Observation| observation.pose.yaw.to_num::<f64>();
    let pairs = seen.windows(2);
    pairs
        .filter_map(|pair| Some(wrap(yaw(pair.get(1)?) - yaw(pair.first()?))))
        .sum()
}

/// Returns the shift between two observations by odometry, ahead and to the left.
fn shift_m(from: &Observation, to: &Observation) -> [f64; 2] {
    let yaw_rad: f64 = from.pose.yaw.to_num();
    let [dx, dy]: [f64; 2] = [
        to.pose.x.to_num::<f64>() - from.pose.x.to_num::<f64>(),
        to.pose.y.to_num::<f64>() - from.pose.y.to_num::<f64>(),
    ];
    let (sin, cos) = (libm::sin(yaw_rad), libm::cos(yaw_rad));
    [dx * cos + dy * sin, dy * cos - dx * sin]
}

/// Returns the planner's configuration of a start message; `None` if it refuses a parameter.
fn config(start: &Start) -> Option<Config> {
    fieldline_device::convert::config(start, &Tuning::DEFAULT).ok()
}

#[cfg(test)]
mod tests;

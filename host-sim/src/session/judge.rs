//! The judge: what no session may cause, whatever it asks.
//!
//! Every answer is judged: velocities within the limits of the session, zero unless the robot
//! explores, numbers that are finite, and where the device reports its cost, a bounded step and a
//! bounded stack.

use core::f32::consts::PI;
use core::fmt;
use core::time::Duration;

use fieldline_planner::Location;
use fieldline_protocol::message::{Body, Command, Cost, FieldRow, Packet, Stages, Start, Twist};
use fixed::types::I16F16;

use super::ask::{Answer, Ask};

/// Limits of what a session may cause.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Most instructions of a step.
    pub instructions: u32,
    /// Deepest stack, bytes.
    pub stack_bytes: u32,
    /// Longest time that an answer may take; `None` for any. It depends on the machine, so it is
    /// for a search for slow steps where the device counts no instructions.
    pub answer: Option<Duration>,
    /// Greatest amount by which an angle may exceed half a turn, radians: rounding of the wire.
    pub angle_slack_rad: f32,
    /// Greatest amount by which a value of the field may leave 0 to 1.
    pub field_slack: f32,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            instructions: 8_000_000,
            stack_bytes: 15_400,
            answer: None,
            angle_slack_rad: 1e-3,
            field_slack: 1e-3,
        }
    }
}

/// Kind of a finding. Findings of one kind are taken for one fault.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Kind {
    /// The device in this process panicked, at this place.
    Panic(String),
    /// The device's program crashed, with these words.
    Crash(String),
    /// The link failed otherwise, with these words.
    Link(String),
    /// A velocity exceeded the session's limits.
    TooFast,
    /// A velocity was not zero although the robot did not explore.
    MovesUnasked,
    /// A velocity was not zero in a survey.
    MovesInSurvey,
    /// A number of the answer is not finite or out of its range; this one.
    BadNumber(&'static str),
    /// A step took too many instructions, most of them in this stage.
    Slow(&'static str),
    /// An answer took too long.
    SlowAnswer,
    /// The stack was too deep.
    DeepStack,
    /// The commands differ from those of a device in this process.
    Differs,
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Panic(place) => write!(f, "panic at {place}"),
            Self::Crash(what) => write!(f, "crash: {what}"),
            Self::Link(what) => write!(f, "link: {what}"),
            Self::TooFast => f.write_str("velocity above the session's limits"),
            Self::MovesUnasked => f.write_str("moves while not exploring"),
            Self::MovesInSurvey => f.write_str("moves in a survey"),
            Self::BadNumber(which) => write!(f, "bad number: {which}"),
            Self::Slow(stage) => write!(f, "slow step, mostly in stage {stage}"),
            Self::SlowAnswer => f.write_str("slow answer"),
            Self::DeepStack => f.write_str("deep stack"),
            Self::Differs => f.write_str("commands differ from this process's"),
        }
    }
}

/// What a session caused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// Kind.
    pub kind: Kind,
    /// Index of the request, from 0.
    pub request: usize,
    /// Figures.
    pub detail: String,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "request {}: {}", self.request, self.kind)?;
        if self.detail.is_empty() {
            return Ok(());
        }
        write!(f, " ({})", self.detail)
    }
}

/// Returns the instructions of each stage with its name.
#[must_use]
pub const fn stages(of: &Stages) -> [(&'static str, u32); 7] {
    [
        ("session", of.session),
        ("sense", of.sense),
        ("topology", of.topology),
        ("plan", of.plan),
        ("window", of.window),
        ("solve", of.solve),
        ("drive", of.drive),
    ]
}

/// The judge of one session.
#[derive(Clone, Debug)]
pub struct Judge {
    limits: Limits,
    /// The session that runs, with its limits of speed.
    session: Option<Start>,
}

/// A kind with its figures.
pub(super) type Verdict = (Kind, String);

impl Judge {
    /// A judge before the first request.
    #[must_use]
    pub const fn new(limits: Limits) -> Self {
        Self {
            limits,
            session: None,
        }
    }

    /// Judges an answer.
    pub fn hear(
        &mut self,
        ask: &Ask,
        answer: &Answer,
        location: Option<&Location>,
    ) -> Vec<Verdict> {
        let mut verdicts = Vec::new();
        match (ask, answer) {
            (Ask::Start(start), Answer::Status(_)) => self.session = Some((**start).clone()),
            (Ask::Reset, Answer::Status(_)) => self.session = None,
            (_, Answer::Command(command)) => self.command(command, &mut verdicts),
            (_, Answer::FieldRow(row)) => self.field(row, &mut verdicts),
            (_, Answer::Said(packet)) => self.said(packet, &mut verdicts),
            _ => {}
        }
        if let Some(location) = location {
            inner(location, &mut verdicts);
        }
        verdicts
    }

    fn command(&self, command: &Command, verdicts: &mut Vec<Verdict>) {
        let Twist { linear, angular } = command.velocity;
        let figures = || format!("{linear} m/s, {angular} rad/s, {:?}", command.status);
        if let Some(start) = &self.session {
            let too_fast = linear.unsigned_abs() > start.max_linear.unsigned_abs()
                || angular.unsigned_abs() > start.max_angular.unsigned_abs();
            if too_fast {
                verdicts.push((Kind::TooFast, figures()));
            }
            if start.survey && command.velocity != Twist::default() {
                verdicts.push((Kind::MovesInSurvey, figures()));
            }
        }
        if !command.status.drives() && command.velocity != Twist::default() {
            verdicts.push((Kind::MovesUnasked, figures()));
        }
        self.numbers(command, verdicts);
        self.cost(&command.cost, verdicts);
    }

    /// A number that is not finite arrives as 0 or as the end of its range.
    fn numbers(&self, command: &Command, verdicts: &mut Vec<Verdict>) {
        let is_end = |number: I16F16| number == I16F16::MAX || number == I16F16::MIN;
        let turns = |angle: I16F16| self.turns(angle.to_num());
        if command.status.drives() && turns(command.heading) {
            verdicts.push((Kind::BadNumber("heading"), command.heading.to_string()));
        }
        let Some(at) = &command.location else { return };
        if is_end(at.x) || is_end(at.y) {
            verdicts.push((Kind::BadNumber("location"), format!("{}, {}", at.x, at.y)));
        }
        if turns(at.yaw) {
            verdicts.push((Kind::BadNumber("yaw"), at.yaw.to_string()));
        }
    }

    /// Returns true if an angle is more than half a turn.
    fn turns(&self, angle_rad: f32) -> bool {
        angle_rad.abs() > PI + self.limits.angle_slack_rad
    }

    fn said(&self, packet: &Packet, verdicts: &mut Vec<Verdict>) {
        if let Body::Beacon(beacon) = &packet.body
            && self.turns(beacon.yaw.to_num())
        {
            verdicts.push((Kind::BadNumber("beacon's yaw"), beacon.yaw.to_string()));
        }
    }

    fn cost(&self, cost: &Cost, verdicts: &mut Vec<Verdict>) {
        if cost.instructions > self.limits.instructions {
            let stages = stages(&cost.stages);
            let most = stages.iter().max_by_key(|(_, count)| *count);
            let kind = Kind::Slow(most.map_or("", |(name, _)| *name));
            let parts: Vec<String> = stages
                .iter()
                .map(|(name, count)| format!("{name} {count}"))
                .collect();
            let figures = format!("{} instructions: {}", cost.instructions, parts.join(", "));
            verdicts.push((kind, figures));
        }
        if cost.stack_bytes > self.limits.stack_bytes {
            verdicts.push((Kind::DeepStack, format!("{} bytes", cost.stack_bytes)));
        }
    }

    fn field(&self, row: &FieldRow, verdicts: &mut Vec<Verdict>) {
        let slack = self.limits.field_slack;
        let bad = |q: &&f32| !(-slack..=1.0 + slack).contains(*q);
        if let Some(q) = row.q.iter().find(bad) {
            verdicts.push((Kind::BadNumber("field"), format!("{q} in row {}", row.row)));
        }
    }
}

/// Judges the planner's own numbers, which the wire would turn into finite ones.
fn inner(location: &Location, verdicts: &mut Vec<Verdict>) {
    let pose = &location.pose.0;
    let numbers = [pose.x_m, pose.y_m, pose.yaw_rad];
    let all = numbers.iter().chain(&location.covariance);
    if all.clone().any(|number| !number.is_finite()) {
        verdicts.push((Kind::BadNumber("planner's pose"), format!("{location:?}")));
    }
}

#[cfg(test)]
mod tests {
    use fieldline_protocol::message::{Command, Fault, FieldRow, Start, Status, Twist};
    use fixed::types::{I4F12, I16F16};

    use super::{Judge, Kind, Limits};
    use crate::session::ask::{Answer, Ask};

    fn kinds(start: Start, command: Command) -> Vec<Kind> {
        let mut judge = Judge::new(Limits::default());
        let begun = Answer::Status(Status::Exploring);
        assert!(
            judge
                .hear(&Ask::Start(Box::new(start)), &begun, None)
                .is_empty()
        );
        let answer = Answer::Command(Box::new(command));
        let verdicts = judge.hear(&Ask::Say, &answer, None);
        verdicts.into_iter().map(|(kind, _)| kind).collect()
    }

    #[test]
    fn every_rule_has_a_command_that_breaks_it() {
        let start = Start {
            max_linear: I4F12::ONE,
            max_angular: I4F12::ONE,
            ..Start::default()
        };
        let slow = |linear: &str, status| Command {
            velocity: Twist {
                linear: linear.parse().unwrap(),
                ..Twist::default()
            },
            status,
            ..Command::default()
        };
        let stuck = Status::Fault(Fault::Stuck);
        let fine = slow("-1", Status::Exploring);
        assert_eq!(kinds(start.clone(), fine), []);
        let fast = slow("1.001", Status::Exploring);
        assert_eq!(kinds(start.clone(), fast), [Kind::TooFast]);
        assert_eq!(
            kinds(start.clone(), slow("0.1", stuck)),
            [Kind::MovesUnasked]
        );
        let survey = Start {
            survey: true,
            ..start.clone()
        };
        assert_eq!(kinds(survey, fine), [Kind::MovesInSurvey]);
        let mut costly = slow("0", stuck);
        costly.cost.instructions = 8_000_001;
        costly.cost.stages.window = 7_000_000;
        costly.cost.stack_bytes = 15_401;
        let expected = [Kind::Slow("window"), Kind::DeepStack];
        assert_eq!(kinds(start.clone(), costly), expected);
        let mut wild = slow("0", Status::Exploring);
        wild.heading = I16F16::lit("3.15");
        assert_eq!(kinds(start, wild), [Kind::BadNumber("heading")]);
    }

    #[test]
    fn a_field_is_from_0_to_1() {
        let mut judge = Judge::new(Limits::default());
        for (q, count) in [(0.5, 0), (f32::NAN, 1), (-0.1, 1), (2.0, 1)] {
            let row = FieldRow {
                row: 0,
                origin_x: 0,
                origin_y: 0,
                scale: 1,
                q: [q].into_iter().collect(),
                cells: [0].into_iter().collect(),
            };
            let answer = Answer::FieldRow(Box::new(row));
            assert_eq!(judge.hear(&Ask::Say, &answer, None).len(), count, "{q}");
        }
    }
}

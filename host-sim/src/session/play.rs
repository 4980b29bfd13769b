//! A conversation of a host and a device, judged, and perhaps compared with a second device.
//!
//! Invariant: [`Played::asks`] are the requests in their order, the one that ended the conversation
//! included; played again on a device that has just booted, they give the same answers.

use core::time::Duration;
use std::time::Instant;

use fieldline_protocol::message::{Cost, Status};

use super::ask::{Answer, Ask};
use super::generate::{Host, Replayed};
use super::judge::{Finding, Judge, Kind, Limits};
use super::target::{Capacity, Target, TargetSpec};
use crate::link::LinkError;
use crate::link::digest::Digest;
use crate::panics::caught;

/// What a session did.
#[derive(Clone, Debug, Default)]
pub struct Played {
    /// Its requests.
    pub asks: Vec<Ask>,
    /// The first finding of each kind.
    pub findings: Vec<Finding>,
    /// Number of observations that made a step.
    pub steps: u64,
    /// Number of refused requests.
    pub refused: u64,
    /// Cost of the dearest step, and the index of its request.
    pub dearest: Option<(Cost, usize)>,
    /// The most instructions of each stage.
    pub stages: [u32; 7],
    /// Instructions of every step, if the device counts them.
    pub instructions: Vec<u32>,
    /// Deepest stack, bytes.
    pub stack_bytes: u32,
    /// Longest time that an answer took, and the index of its request.
    pub slowest: (Duration, usize),
    /// The last status.
    pub status: Option<Status>,
    /// Digest of the commands: equal digests mean equal commands, bit for bit.
    pub digest: Digest,
}

impl Played {
    fn find(&mut self, kind: Kind, detail: String) {
        if self.findings.iter().all(|finding| finding.kind != kind) {
            let request = self.asks.len().saturating_sub(1);
            self.findings.push(Finding {
                kind,
                request,
                detail,
            });
        }
    }

    /// Returns true if the device answered up to the end.
    fn is_whole(&self) -> bool {
        let ends = |kind: &Kind| matches!(kind, Kind::Panic(_) | Kind::Crash(_) | Kind::Link(_));
        !self.findings.iter().any(|finding| ends(&finding.kind))
    }

    /// Returns true if a finding of this kind was made.
    #[must_use]
    pub fn has(&self, kind: &Kind) -> bool {
        self.findings.iter().any(|finding| finding.kind == *kind)
    }

    fn note(&mut self, answer: &Answer, took: Duration) {
        let request = self.asks.len().saturating_sub(1);
        if took > self.slowest.0 {
            self.slowest = (took, request);
        }
        match answer {
            Answer::Refused(_) => self.refused += 1,
            Answer::Status(status) => self.status = Some(*status),
            Answer::Command(command) => {
                self.steps += 1;
                self.digest.add(command);
                self.status = Some(command.status);
                self.note_cost(&command.cost, request);
            }
            _ => {}
        }
    }

    fn note_cost(&mut self, cost: &Cost, request: usize) {
        if cost.instructions == 0 {
            return;
        }
        self.instructions.push(cost.instructions);
        self.stack_bytes = self.stack_bytes.max(cost.stack_bytes);
        let counts = super::judge::stages(&cost.stages);
        for (most, (_, count)) in self.stages.iter_mut().zip(counts) {
            *most = count.max(*most);
        }
        let most = self.dearest.map_or(0, |(cost, _)| cost.instructions);
        if cost.instructions > most {
            self.dearest = Some((*cost, request));
        }
    }
}

/// How sessions are played.
#[derive(Clone, Debug)]
pub struct Trial {
    /// The devices.
    pub target: TargetSpec,
    /// Size of their maps.
    pub capacity: Capacity,
    /// Limits of the judge.
    pub limits: Limits,
    /// True if a device in this process, of the default size, must give the same commands.
    pub twin: bool,
}

impl Trial {
    /// Plays a session on a device that has just booted.
    ///
    /// # Errors
    /// If no device can be opened.
    pub fn play(&self, host: &mut dyn Host) -> Result<Played, LinkError> {
        let mut target = self.target.open(self.capacity)?;
        let mut played = play(host, &mut *target, self.limits);
        if self.twin && played.is_whole() {
            let mut twin = TargetSpec::Device.open(Capacity::default())?;
            let again = play(&mut Replayed::new(&played.asks), &mut *twin, self.limits);
            if again.digest != played.digest {
                played.find(
                    Kind::Differs,
                    format!("{} and {}", played.digest, again.digest),
                );
            }
        }
        Ok(played)
    }
}

/// Plays a session; a panic of the device is a finding. `target` is of no use after a panic.
pub fn play(host: &mut dyn Host, target: &mut dyn Target, limits: Limits) -> Played {
    let mut played = Played::default();
    if let Err((place, text)) = caught(|| converse(host, target, limits, &mut played)) {
        played.find(Kind::Panic(place), text);
    }
    played
}

/// Plays a session and does not catch panics, for a fuzzer that does.
pub fn converse(host: &mut dyn Host, target: &mut dyn Target, limits: Limits, played: &mut Played) {
    let mut judge = Judge::new(limits);
    let mut answer = None;
    while let Some(ask) = host.next(answer.as_ref()) {
        played.asks.push(ask.clone());
        let began = Instant::now();
        match ask.of(target.link()) {
            Ok(heard) => {
                let took = began.elapsed();
                played.note(&heard, took);
                if limits.answer.is_some_and(|longest| took > longest) {
                    let milliseconds = took.as_secs_f64() * 1e3;
                    played.find(Kind::SlowAnswer, format!("{milliseconds:.1} ms"));
                }
                let location = target.location();
                for (kind, detail) in judge.hear(&ask, &heard, location.as_ref()) {
                    played.find(kind, detail);
                }
                answer = Some(heard);
            }
            Err(error) => return played.find(fault(&error), String::new()),
        }
    }
    // A device that still answers is greeted again by every host.
    if let Err(error) = target.link().hello() {
        played.find(fault(&error), "the hello at the end".into());
    }
}

fn fault(error: &LinkError) -> Kind {
    match error {
        LinkError::Crashed(what) => Kind::Crash(what.clone()),
        other => Kind::Link(other.to_string()),
    }
}

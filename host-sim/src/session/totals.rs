//! Totals of many sessions: findings by kind, costs, and how the sessions ended.

use core::fmt;
use core::time::Duration;
use std::collections::BTreeMap;

use super::judge::{Kind, stages};
use super::play::Played;

/// A session by its generator and seed, and the index of one of its requests.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// Generator.
    pub generator: &'static str,
    /// Seed.
    pub seed: u64,
    /// Index of the request.
    pub request: usize,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            generator,
            seed,
            request,
        } = self;
        write!(f, "{generator} {seed}, request {request}")
    }
}

/// Instructions above which steps are counted, beside the limit.
const THRESHOLDS: [u32; 5] = [6_000_000, 7_000_000, 8_000_000, 20_000_000, 100_000_000];

/// Sessions of one kind of finding.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Count {
    /// Number of sessions.
    pub sessions: u64,
    /// The first.
    pub first: Place,
    /// Figures of the first.
    pub detail: String,
}

/// Totals.
#[derive(Clone, Debug, Default)]
pub struct Totals {
    /// Number of sessions.
    pub sessions: u64,
    /// Number of requests.
    pub requests: u64,
    /// Number of answered observations.
    pub steps: u64,
    /// Number of refused requests.
    pub refused: u64,
    /// Sessions of each kind of finding.
    pub findings: BTreeMap<Kind, Count>,
    /// The most instructions of a step, and where.
    pub instructions: (u32, Place),
    /// The instructions of each stage in the dearest step.
    pub dearest: String,
    /// The most instructions of each stage, and the session.
    pub stages: [(u32, Place); 7],
    /// Number of steps above each threshold.
    pub above: [u64; THRESHOLDS.len()],
    /// Deepest stack, bytes, and the session.
    pub stack_bytes: (u32, Place),
    /// Longest time that an answer took, and where.
    pub slowest: (Duration, Place),
    /// Number of sessions by their last status.
    pub ends: BTreeMap<String, u64>,
    /// Number of sessions by the binary logarithm of their requests.
    pub lengths: BTreeMap<u32, u64>,
}

impl Totals {
    /// Adds a session.
    pub fn add(&mut self, generator: &'static str, seed: u64, played: &Played) {
        let at = |request| Place {
            generator,
            seed,
            request,
        };
        self.sessions += 1;
        self.requests += played.asks.len() as u64;
        self.steps += played.steps;
        self.refused += played.refused;
        *self
            .lengths
            .entry(played.asks.len().max(1).ilog2())
            .or_default() += 1;
        for finding in &played.findings {
            let first = || Count {
                sessions: 0,
                first: at(finding.request),
                detail: finding.detail.clone(),
            };
            let count = self.findings.entry(finding.kind.clone());
            count.or_insert_with(first).sessions += 1;
        }
        self.add_costs(played, at);
        if played.slowest.0 > self.slowest.0 {
            self.slowest = (played.slowest.0, at(played.slowest.1));
        }
        let end = played.status.map_or_else(
            || "not started".into(),
            |status| format!("{status:?}").to_lowercase(),
        );
        *self.ends.entry(end).or_default() += 1;
    }

    fn add_costs(&mut self, played: &Played, at: impl Fn(usize) -> Place) {
        for (above, threshold) in self.above.iter_mut().zip(THRESHOLDS) {
            let dear = |count: &&u32| **count > threshold;
            *above += played.instructions.iter().filter(dear).count() as u64;
        }
        for (most, count) in self.stages.iter_mut().zip(played.stages) {
            if count > most.0 {
                *most = (count, at(0));
            }
        }
        if let Some((cost, request)) = &played.dearest
            && cost.instructions > self.instructions.0
        {
            self.instructions = (cost.instructions, at(*request));
            let parts = stages(&cost.stages).map(|(name, count)| format!("{name} {count}"));
            self.dearest = parts.join(", ");
        }
        if played.stack_bytes > self.stack_bytes.0 {
            self.stack_bytes = (played.stack_bytes, at(0));
        }
    }

    /// Adds other totals.
    pub fn merge(&mut self, other: Self) {
        self.sessions += other.sessions;
        self.requests += other.requests;
        self.steps += other.steps;
        self.refused += other.refused;
        for (kind, count) in other.findings {
            let known = self.findings.entry(kind);
            known
                .and_modify(|known| known.sessions += count.sessions)
                .or_insert(count);
        }
        if other.instructions.0 > self.instructions.0 {
            (self.instructions, self.dearest) = (other.instructions, other.dearest);
        }
        for (most, other) in self.stages.iter_mut().zip(other.stages) {
            if other.0 > most.0 {
                *most = other;
            }
        }
        for (above, other) in self.above.iter_mut().zip(other.above) {
            *above += other;
        }
        if other.stack_bytes.0 > self.stack_bytes.0 {
            self.stack_bytes = other.stack_bytes;
        }
        if other.slowest.0 > self.slowest.0 {
            self.slowest = other.slowest;
        }
        for (end, count) in other.ends {
            *self.ends.entry(end).or_default() += count;
        }
        for (length, count) in other.lengths {
            *self.lengths.entry(length).or_default() += count;
        }
    }
}

impl fmt::Display for Totals {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{} sessions, {} requests, {} steps, {} refused",
            self.sessions, self.requests, self.steps, self.refused
        )?;
        let lengths = self.lengths.iter();
        let lengths: Vec<String> = lengths
            .map(|(log, count)| format!("{}+: {count}", 1_u64 << log))
            .collect();
        writeln!(f, "requests of a session: {}", lengths.join(", "))?;
        let ends = self.ends.iter();
        let ends: Vec<String> = ends.map(|(end, count)| format!("{end} {count}")).collect();
        writeln!(f, "ends: {}", ends.join(", "))?;
        let (took, place) = &self.slowest;
        writeln!(
            f,
            "slowest answer: {:.1} ms ({place})",
            took.as_secs_f64() * 1e3
        )?;
        self.costs(f)?;
        for (kind, count) in &self.findings {
            let Count {
                sessions,
                first,
                detail,
            } = count;
            writeln!(f, "finding: {kind}: {sessions} sessions, first {first}")?;
            if !detail.is_empty() {
                writeln!(f, "    {detail}")?;
            }
        }
        Ok(())
    }
}

impl Totals {
    fn costs(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (most, place) = &self.instructions;
        if *most == 0 {
            return Ok(());
        }
        writeln!(
            f,
            "dearest step: {most} instructions ({place}): {}",
            self.dearest
        )?;
        for ((name, _), (most, place)) in stages(&Default::default()).iter().zip(&self.stages) {
            writeln!(f, "    {name}: {most} ({} {})", place.generator, place.seed)?;
        }
        let above = self.above.iter().zip(THRESHOLDS);
        let above: Vec<String> = above
            .map(|(count, threshold)| format!("{count} above {} million", threshold / 1_000_000))
            .collect();
        writeln!(f, "steps: {}", above.join(", "))?;
        let (bytes, place) = &self.stack_bytes;
        writeln!(
            f,
            "deepest stack: {bytes} bytes ({} {})",
            place.generator, place.seed
        )
    }
}

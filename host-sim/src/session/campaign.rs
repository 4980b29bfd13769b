//! Many sessions from a range of seeds, on several threads; each new finding becomes a file.
//!
//! The campaigns of [`crate::campaign`], which compare strategies, are another thing.

use core::ops::Range;
use core::sync::atomic::{AtomicU64, Ordering};
use core::time::Duration;
use std::path::{Path, PathBuf};

use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Instant;

use super::choices::{Choices as _, Seeded};
use super::generate::{Generator, LONGEST};
use super::judge::{Kind, Limits};
use super::play::{Played, Trial};
use super::script::{FORMAT, Head, Script};
use super::shrink::shrink;
use super::target::{Capacity, TargetSpec};
use super::totals::Totals;
use crate::link::LinkError;

/// What to run.
#[derive(Clone, Debug)]
pub struct Campaign {
    /// Generators. A seed makes one session of each.
    pub generators: Vec<Generator>,
    /// Seeds.
    pub seeds: Range<u64>,
    /// The devices under test.
    pub target: TargetSpec,
    /// Limits of the judge.
    pub limits: Limits,
    /// True if a device in this process must give the same commands.
    pub twin: bool,
    /// Most requests of a session.
    pub longest: usize,
    /// Time after which no session begins.
    pub time: Option<Duration>,
    /// Number of threads.
    pub threads: usize,
    /// Folder for the shrunken findings; none are written if `None`.
    pub findings: Option<PathBuf>,
    /// Most trials for shrinking one finding.
    pub trials: usize,
}

impl Default for Campaign {
    fn default() -> Self {
        Self {
            generators: Generator::ALL.to_vec(),
            seeds: 0..100,
            target: TargetSpec::Device,
            limits: Limits::default(),
            twin: false,
            longest: LONGEST,
            time: None,
            threads: 1,
            findings: None,
            trials: 300,
        }
    }
}

/// Returns the capacity of a session's device.
#[must_use]
pub fn capacity(seed: u64) -> Capacity {
    let index = Seeded::new(!seed).below(Capacity::ALL.len() as u64);
    Capacity::ALL[index as usize]
}

/// What the threads share.
struct Shared<'a> {
    campaign: &'a Campaign,
    began: Instant,
    next: AtomicU64,
    totals: Mutex<Totals>,
    tell: &'a (dyn Fn(&str) + Sync),
}

impl Campaign {
    /// Runs the sessions; `tell` gets a line for each new kind of finding.
    ///
    /// # Errors
    /// [`LinkError`] if no device can be opened. A device that fails later is a finding.
    pub fn run(&self, tell: &(dyn Fn(&str) + Sync)) -> Result<Totals, LinkError> {
        let shared = Shared {
            campaign: self,
            began: Instant::now(),
            next: AtomicU64::new(self.seeds.start),
            totals: Mutex::new(Totals::default()),
            tell,
        };
        let results: Vec<Result<(), LinkError>> = thread::scope(|scope| {
            let threads: Vec<_> = (0..self.threads.max(1))
                .map(|_| scope.spawn(|| shared.work()))
                .collect();
            let failed = || Err(LinkError::Io("a thread of the campaign ended".into()));
            threads
                .into_iter()
                .map(|thread| thread.join().unwrap_or_else(|_| failed()))
                .collect()
        });
        results.into_iter().collect::<Result<Vec<()>, _>>()?;
        let totals = shared.totals.into_inner();
        Ok(totals.unwrap_or_else(PoisonError::into_inner))
    }

    /// Plays the session of a generator and a seed.
    ///
    /// # Errors
    /// [`LinkError`] if no device can be opened.
    pub fn session(&self, generator: Generator, seed: u64) -> Result<Played, LinkError> {
        let mut host = generator.host(Seeded::new(seed), self.longest);
        self.trial(capacity(seed)).play(&mut *host)
    }

    /// How the sessions of a device of this size are played.
    #[must_use]
    pub fn trial(&self, capacity: Capacity) -> Trial {
        Trial {
            target: self.target.clone(),
            capacity,
            limits: self.limits,
            twin: self.twin,
        }
    }

    /// Shrinks a finding and writes its file; returns the path.
    ///
    /// # Errors
    /// Why it cannot be shrunken or written.
    pub fn write(
        &self,
        folder: &Path,
        head: Head,
        (kind, played): (&Kind, &Played),
    ) -> Result<PathBuf, String> {
        let trial = self.trial(head.capacity);
        let shrunken = shrink(&trial, kind, &played.asks, self.trials);
        let asks = shrunken.map_err(|error| error.to_string())?;
        let path = folder.join(file_name(kind, &head));
        let script = Script {
            head: Head {
                causes: kind.to_string(),
                ..head
            },
            asks,
        };
        script.save(&path).map_err(|error| error.to_string())?;
        Ok(path)
    }
}

/// Returns a file name with the kind's words.
fn file_name(kind: &Kind, head: &Head) -> String {
    let text = kind.to_string();
    let words: Vec<&str> = text
        .split(|letter: char| !letter.is_ascii_alphanumeric())
        .filter(|word| !word.is_empty())
        .collect();
    let words: String = words.join("-").chars().take(60).collect();
    let (
        words,
        Head {
            generator, seed, ..
        },
    ) = (words.to_lowercase(), head);
    format!("{words}-{generator}-{seed}.jsonl")
}

impl Shared<'_> {
    fn is_over(&self) -> bool {
        let time = self.campaign.time;
        time.is_some_and(|time| self.began.elapsed() >= time)
    }

    fn work(&self) -> Result<(), LinkError> {
        while !self.is_over() {
            let seed = self.next.fetch_add(1, Ordering::Relaxed);
            if seed >= self.campaign.seeds.end {
                break;
            }
            for &generator in &self.campaign.generators {
                let played = self.campaign.session(generator, seed)?;
                self.add(generator, seed, &played);
            }
        }
        Ok(())
    }

    fn add(&self, generator: Generator, seed: u64, played: &Played) {
        let new: Vec<_> = {
            let mut totals = self.totals.lock().unwrap_or_else(PoisonError::into_inner);
            let known = |kind: &Kind| totals.findings.contains_key(kind);
            let new = played.findings.iter().filter(|it| !known(&it.kind));
            let new = new.cloned().collect();
            totals.add(generator.name(), seed, played);
            new
        };
        for finding in new {
            (self.tell)(&format!("{} {seed}, {finding}", generator.name()));
            let Some(folder) = &self.campaign.findings else {
                continue;
            };
            let head = Head {
                fieldline_session: FORMAT,
                generator: generator.name().into(),
                seed,
                capacity: capacity(seed),
                causes: String::new(),
            };
            match self.campaign.write(folder, head, (&finding.kind, played)) {
                Ok(path) => (self.tell)(&format!("    {}", path.display())),
                Err(error) => (self.tell)(&format!("    not written: {error}")),
            }
        }
    }
}

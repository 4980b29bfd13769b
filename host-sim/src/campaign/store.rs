//! The folder of a campaign.
//!
//! | file | content |
//! | --- | --- |
//! | `campaign.toml` | the campaign, written before the first trial |
//! | `trials.jsonl` | one line a finished trial, in the order in which they finished |
//!
//! Invariant: a line is written whole and flushed before the next one begins. So a kill leaves at
//! most one torn line, the last. It is cut off, and its trial runs again. Once all trials are
//! there, the file is replaced by one in the order of the trials.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::Write as _;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use super::plan::{Plan, Trial};
use super::shards::Shard;
use super::{CampaignError, PLAN_FILE, TRIALS_FILE, spec};

/// A finished trial, as its line.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Finished {
    /// Number of the trial in its campaign.
    pub index: usize,
    /// World, as the campaign names it.
    pub world: String,
    /// Odometry of the row; `null` for the default of `explore`.
    pub odometry: Option<String>,
    /// Strategy or variant, with its slam if the campaign has several.
    pub strategy: String,
    /// Index of the start pose.
    pub start: u64,
    /// Seed.
    pub seed: u64,
    /// The command that makes the same run.
    pub command: String,
    /// Why there is no report; `null` if there is one.
    pub failure: Option<String>,
    /// What the campaign measures itself; `null` after a failure.
    pub trial: Option<Measured>,
    /// Seconds and share known, evenly in simulated time; the last is the end.
    pub coverage: Vec<[f64; 2]>,
    /// The report of the run, as `explore --json` prints it; `null` after a failure.
    pub report: Option<Box<RawValue>>,
}

/// What a campaign measures beside the report.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// Everything is explored, or the target coverage reached.
    pub explored: bool,
    /// Share of the steps with a pose less than 1 m off; `null` without a step.
    pub below_1m: Option<f64>,
    /// Time on this machine, seconds. It differs from run to run.
    pub wall_s: f64,
}

impl Finished {
    /// Makes the line of a trial that failed.
    #[must_use]
    pub fn failed(trial: &Trial, failure: String) -> Self {
        Self {
            index: trial.index,
            world: trial.world.clone(),
            odometry: trial.odometry.clone(),
            strategy: trial.arm.label.clone(),
            start: trial.start,
            seed: trial.seed,
            command: command(trial),
            failure: Some(failure),
            trial: None,
            coverage: Vec::new(),
            report: None,
        }
    }

    /// Returns true if this line is that of `trial`.
    fn is_of(&self, trial: &Trial) -> bool {
        self.world == trial.world
            && self.odometry == trial.odometry
            && self.strategy == trial.arm.label
            && (self.start, self.seed) == (trial.start, trial.seed)
            && self.command == command(trial)
    }
}

/// Returns the command of a trial.
#[must_use]
pub fn command(trial: &Trial) -> String {
    let quoted = |word: String| match word.contains(char::is_whitespace) {
        true => format!("'{word}'"),
        false => word,
    };
    let words: Vec<String> = trial.arguments().into_iter().map(quoted).collect();
    format!("host-sim explore {}", words.join(" "))
}

/// The open folder of a campaign or of one of its shards.
#[derive(Debug)]
pub struct Store {
    folder: PathBuf,
    file: File,
    /// The trials that finished before and in this run.
    pub finished: Vec<Finished>,
    /// What was found, for the user.
    pub notes: Vec<String>,
}

impl Store {
    /// Opens the folder: makes it, or takes up what finished before. With `retry` the trials that
    /// failed are dropped, so they run again.
    ///
    /// # Errors
    /// The folder has another campaign or shard, another process writes to it, a line before the
    /// last is bad, or the system refuses.
    pub fn open(
        folder: &Path,
        plan: &Plan,
        shard: Option<Shard>,
        retry: bool,
    ) -> Result<Self, CampaignError> {
        fs::create_dir_all(folder)
            .map_err(|error| CampaignError::io("make this folder", folder, &error))?;
        let plan_file = folder.join(PLAN_FILE);
        let path = folder.join(TRIALS_FILE);
        if plan_file.exists() {
            check_same(&plan_file, plan, shard)?;
        } else if path.exists() {
            return Err(CampaignError::new(format!(
                "there is no {PLAN_FILE} beside it, so its campaign is not known; choose another \
                 --out"
            ))
            .in_file(&path));
        }
        put(&plan_file, &plan_text(plan, shard))?;
        let file = OpenOptions::new().create(true).append(true).open(&path);
        let file = file.map_err(|error| CampaignError::io("open it", &path, &error))?;
        lock(&file, folder)?;
        let mut store = Self {
            folder: folder.to_owned(),
            file,
            finished: Vec::new(),
            notes: Vec::new(),
        };
        let (finished, torn) = read_trials(&path, &plan.trials())?;
        if let Some(torn) = torn {
            let cut = store.file.set_len(torn.offset);
            cut.map_err(|error| CampaignError::io("cut the torn line off", &path, &error))?;
            store.notes.push(format!(
                "{}:{}: the last line is torn, its trial runs again",
                path.display(),
                torn.line
            ));
        }
        store.finished = finished;
        if retry {
            store.finished.retain(|line| line.failure.is_none());
            store.rewrite()?;
        }
        Ok(store)
    }

    /// Returns the numbers of trials that are not finished, of those given.
    #[must_use]
    pub fn open_trials(&self, trials: Vec<Trial>) -> Vec<Trial> {
        let done: std::collections::BTreeSet<usize> =
            self.finished.iter().map(|line| line.index).collect();
        let is_open = |trial: &Trial| !done.contains(&trial.index);
        trials.into_iter().filter(is_open).collect()
    }

    /// Appends the line of a trial, and flushes it.
    ///
    /// # Errors
    /// The system refuses, as when the disk is full.
    pub fn append(&mut self, finished: Finished) -> Result<(), CampaignError> {
        let path = self.folder.join(TRIALS_FILE);
        let line = line(&finished, &path)?;
        let written = self
            .file
            .write_all(line.as_bytes())
            .and_then(|()| self.file.sync_data());
        written.map_err(|error| CampaignError::io("write to it", &path, &error))?;
        self.finished.push(finished);
        Ok(())
    }

    /// Puts the lines into the order of the trials, in memory and in the file.
    ///
    /// # Errors
    /// The system refuses.
    pub fn rewrite(&mut self) -> Result<(), CampaignError> {
        self.finished.sort_by_key(|line| line.index);
        self.file = write_trials(&self.folder, &self.finished)?;
        lock(&self.file, &self.folder)
    }
}

/// A last line that was not written whole.
struct Torn {
    line: usize,
    offset: u64,
}

/// Writes all lines, in place of the file that is there; returns the new file, open for more.
///
/// # Errors
/// The system refuses.
pub fn write_trials(folder: &Path, finished: &[Finished]) -> Result<File, CampaignError> {
    let path = folder.join(TRIALS_FILE);
    let lines: Result<String, _> = finished.iter().map(|it| line(it, &path)).collect();
    put(&path, &lines?)?;
    let file = OpenOptions::new().append(true).open(&path);
    file.map_err(|error| CampaignError::io("open it", &path, &error))
}

/// Returns the text of a folder's `campaign.toml`.
#[must_use]
pub fn plan_text(plan: &Plan, shard: Option<Shard>) -> String {
    let shard = shard.map_or_else(String::new, |shard| format!("shard = \"{shard}\"\n"));
    format!(
        "# Written by host-sim campaign: do not edit while {TRIALS_FILE} is beside it.\n{shard}{}",
        plan.to_toml()
    )
}

/// Reads the plan of a folder.
///
/// # Errors
/// As [`spec::read`].
pub fn read_plan(folder: &Path) -> Result<(Plan, Option<Shard>), CampaignError> {
    let spec = spec::read(&folder.join(PLAN_FILE))?;
    Ok((spec.plan, spec.shard))
}

/// Reads the finished trials of a folder whose process has ended. A torn last line counts as not
/// finished.
///
/// # Errors
/// A bad line, with its number.
pub fn read_finished(folder: &Path, plan: &Plan) -> Result<Vec<Finished>, CampaignError> {
    let path = folder.join(TRIALS_FILE);
    read_trials(&path, &plan.trials()).map(|(finished, _)| finished)
}

fn read_trials(
    path: &Path,
    trials: &[Trial],
) -> Result<(Vec<Finished>, Option<Torn>), CampaignError> {
    let bytes = fs::read(path).map_err(|error| CampaignError::io("read it", path, &error))?;
    let mut finished: Vec<Finished> = Vec::new();
    let mut offset = 0;
    let mut known = vec![false; trials.len()];
    for (number, line) in (1..).zip(bytes.split_inclusive(|byte| *byte == b'\n')) {
        let bad = |reason: String| CampaignError::new(reason).in_file(path).at_line(number);
        let is_last = offset + line.len() == bytes.len();
        let it = match parsed(line) {
            Ok(it) => it,
            Err(_) if is_last => {
                let offset = offset as u64;
                let line = number;
                return Ok((finished, Some(Torn { line, offset })));
            }
            Err(reason) => {
                return Err(bad(format!(
                    "the line is no result of a trial ({reason}); remove it, and its trial runs \
                     again"
                )));
            }
        };
        if !trials.get(it.index).is_some_and(|trial| it.is_of(trial)) {
            return Err(bad(format!(
                "trial {} is of another campaign; choose another --out",
                it.index
            )));
        }
        if core::mem::replace(&mut known[it.index], true) {
            let reason = format!("trial {} is there twice; remove one line", it.index);
            return Err(bad(reason));
        }
        finished.push(it);
        offset += line.len();
    }
    Ok((finished, None))
}

/// Parses a line with its end.
fn parsed(line: &[u8]) -> Result<Finished, String> {
    if !line.ends_with(b"\n") {
        return Err("it has no end".into());
    }
    serde_json::from_slice(line).map_err(|error| error.to_string())
}

/// Refuses a folder with another campaign or another shard.
fn check_same(file: &Path, plan: &Plan, shard: Option<Shard>) -> Result<(), CampaignError> {
    let there = spec::read(file)?;
    let refuse = |what: String| {
        let reason = format!("{what}; choose another --out, or remove the folder");
        Err(CampaignError::new(reason).in_file(file))
    };
    if let Some(what) = difference(&there.plan, plan) {
        return refuse(format!("this folder has another campaign: {what}"));
    }
    let name = |shard: Option<Shard>| shard.map_or("the whole".into(), |it| format!("shard {it}"));
    if there.shard != shard {
        return refuse(format!(
            "this folder has {} of the campaign, not {}",
            name(there.shard),
            name(shard)
        ));
    }
    Ok(())
}

/// Returns the first difference between the trials of two campaigns, in words; `None` if they have
/// the same.
#[must_use]
pub fn difference(there: &Plan, here: &Plan) -> Option<String> {
    let lines = |plan: &Plan| plan.trials_only().to_toml();
    let (there, here) = (lines(there), lines(here));
    let pairs = there.lines().zip(here.lines());
    match pairs.into_iter().find(|(a, b)| a != b) {
        Some((a, b)) => Some(format!("it has `{a}`, and this one `{b}`")),
        None if there == here => None,
        None => Some("one has more options or variants than the other".into()),
    }
}

fn line(finished: &Finished, path: &Path) -> Result<String, CampaignError> {
    let text = serde_json::to_string(finished);
    let text = text.map_err(|error| {
        CampaignError::new(format!("a result has no text: {error}")).in_file(path)
    })?;
    Ok(text + "\n")
}

/// Writes a file beside its place and moves it there, so that it is never half written.
pub(super) fn put(path: &Path, text: &str) -> Result<(), CampaignError> {
    let beside = path.with_extension("new");
    let written = fs::write(&beside, text).and_then(|()| fs::rename(&beside, path));
    written.map_err(|error| CampaignError::io("write it", path, &error))
}

fn lock(file: &File, folder: &Path) -> Result<(), CampaignError> {
    match file.try_lock() {
        Ok(()) => Ok(()),
        Err(TryLockError::WouldBlock) => Err(CampaignError::new(format!(
            "another process writes to {}; wait for its end, or choose another --out",
            folder.display()
        ))),
        // Some network file systems have no locks.
        Err(TryLockError::Error(_)) => Ok(()),
    }
}

#[cfg(test)]
pub(super) mod tests;

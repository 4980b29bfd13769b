//! `--record FILE.mcap`, and `replay FILE.mcap`.

use core::cell::RefCell;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use anyhow::{Context as _, Result, bail};

use host_sim::link::Link;
use host_sim::link::spec::{LinkSpec, Options};
use host_sim::recording::{self, Recording, Replayed, Tap};
use host_sim::report::MadeBy;
use host_sim::trial::Watch;
use host_sim::trial::sight::Sight;
use serde::Serialize;

use super::{note, note_build, say};

pub(super) use host_sim::recording::is_recording;

/// A file in which a run is recorded.
pub(super) struct Recorder {
    file: PathBuf,
    recording: Rc<RefCell<Recording>>,
}

impl Recorder {
    /// Begins the file. One that is there is replaced only if `may_replace`.
    pub(super) fn open(file: &Path, made_by: &MadeBy, may_replace: bool) -> Result<Self> {
        if file.exists() && !may_replace {
            bail!(
                "--record {}: the file is there; say --force to replace it, or name another one",
                file.display()
            );
        }
        let recording = Recording::create(file, made_by)
            .with_context(|| format!("--record {}: it cannot be written", file.display()))?;
        Ok(Self {
            file: file.into(),
            recording: Rc::new(RefCell::new(recording)),
        })
    }

    /// Records what is seen of a step.
    pub(super) fn see(&self, sight: &Sight<'_>) {
        self.recording.borrow_mut().see(sight);
    }

    /// Records what goes over a link.
    pub(super) fn tap(&self, link: Box<dyn Link>) -> Box<dyn Link> {
        Box::new(Tap::new(link, Rc::clone(&self.recording)))
    }

    /// Ends the file with the report, and says if it is not whole.
    pub(super) fn end(&self, report: Option<&impl Serialize>) {
        if let Some(why) = self.recording.borrow_mut().end(report) {
            note(&format!("host-sim: {}: {why}", self.file.display()));
        }
    }
}

/// Makes the requests of a recording again; returns true if the device did what it did before.
pub(super) fn replay(
    file: &Path,
    link: &LinkSpec,
    options: &Options,
    as_json: bool,
    watch: &mut dyn Watch,
) -> Result<bool> {
    let name = file.display();
    let exchanges = recording::read(file).with_context(|| name.to_string())?;
    if exchanges.is_cut {
        let last = exchanges.list.last().map_or(0, |it| it.time_ms);
        note(&format!(
            "host-sim: {name}: the file was cut; it is replayed up to {} s",
            f64::from(last) / 1000.0
        ));
    }
    note_build(link);
    let mut device = link
        .open(options)
        .with_context(|| format!("--link {link}"))?;
    let replayed = recording::replay(&exchanges, device.as_mut(), watch);
    let replayed = replayed.with_context(|| format!("--link {link}"))?;
    if replayed.is_same() && replayed.requests < exchanges.requests() {
        bail!("interrupted after {} requests", replayed.requests);
    }
    if as_json {
        say(&serde_json::to_string(&replayed)?)?;
    } else {
        say(&format!("{name}: {}", words(&replayed)))?;
    }
    Ok(replayed.is_same())
}

fn words(replayed: &Replayed) -> String {
    let Replayed {
        requests,
        commands,
        recorded,
        now,
        differs_at_ms,
    } = replayed;
    match differs_at_ms {
        None => format!("{requests} requests, {commands} commands, digest {now} as recorded"),
        Some(at_ms) => format!(
            "the answer at {} s is another one, after {requests} requests: digest {now}, recorded \
             {recorded}; replay it with the version and the --tune that recorded it",
            f64::from(*at_ms) / 1000.0
        ),
    }
}

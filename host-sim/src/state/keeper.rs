//! Keeps the state of a run while it goes on, and checks that a run which goes on is the same one.
//!
//! Units: metres, radians, simulated milliseconds.

use core::cell::RefCell;
use core::fmt;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use fieldline_planner::geometry::Pose;
use fieldline_protocol::message::{Start, Status};

use super::file::{NAME, State};
use super::journal::Journal;
use crate::link::LinkError;
use crate::report::MadeBy;
use crate::trial::mirror::Mirror;
use crate::trial::{Ending, Keeper, Moment, Record};

/// Simulated time from one file to the next, milliseconds.
pub const SAVE_EVERY_MS: u32 = 10_000;

/// Poses that differ by less are the same, metres and radians: the wire's digits are finer.
const POSE_DIGITS: f32 = 1e-3;

/// Where states go.
pub trait Store {
    /// Takes a state in the place of the one before.
    ///
    /// # Errors
    /// The system's error. The state before is whole then.
    fn put(&mut self, bytes: &[u8], moment: Moment) -> io::Result<()>;

    /// Removes the state, because the run has ended.
    ///
    /// # Errors
    /// The system's error.
    fn remove(&mut self) -> io::Result<()>;
}

/// A folder: its file [`NAME`] is written beside, and renamed.
#[derive(Clone, Debug)]
pub struct Folder(PathBuf);

impl Folder {
    /// Makes the store of a folder that is there.
    #[must_use]
    pub fn new(folder: &Path) -> Self {
        Self(folder.to_owned())
    }
}

impl Store for Folder {
    fn put(&mut self, bytes: &[u8], _: Moment) -> io::Result<()> {
        let beside = self.0.join(format!(".{NAME}.part"));
        let written =
            fs::write(&beside, bytes).and_then(|()| fs::rename(&beside, self.0.join(NAME)));
        if written.is_err() {
            let _ = fs::remove_file(&beside);
        }
        written
    }

    fn remove(&mut self) -> io::Result<()> {
        match fs::remove_file(self.0.join(NAME)) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
            _ => Ok(()),
        }
    }
}

/// A run that is kept.
pub struct Keeping {
    /// What makes the run.
    pub made_by: MadeBy,
    /// Where its states go.
    pub store: Box<dyn Store>,
    /// The state from which it goes on.
    pub resumed: Option<State>,
    /// The first error of the store. The run goes on, and what was kept before stays.
    pub failure: Option<io::Error>,
}

impl fmt::Debug for Keeping {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let from = self.resumed.as_ref().map(|state| state.time_ms);
        f.debug_struct("Keeping").field("from_ms", &from).finish()
    }
}

impl Keeping {
    /// Makes the keeping of a run from its beginning, or from a state.
    #[must_use]
    pub fn new(made_by: MadeBy, store: Box<dyn Store>, resumed: Option<State>) -> Self {
        Self {
            made_by,
            store,
            resumed,
            failure: None,
        }
    }
}

/// The keeper of a run.
pub(crate) struct StateKeeper<'k> {
    keeping: &'k mut Keeping,
    start: Start,
    journal: Rc<RefCell<Journal>>,
    /// Time of the last state.
    saved_ms: u32,
    /// Number of answers after the last whole step.
    whole: usize,
    whole_steps: usize,
    /// The run that goes on is another one.
    pub(crate) strays: bool,
}

impl<'k> StateKeeper<'k> {
    /// Makes the keeper of a run, and its journal.
    pub(crate) fn new(keeping: &'k mut Keeping, start: Start) -> (Self, Rc<RefCell<Journal>>) {
        let resumed = keeping.resumed.as_mut();
        let answers = resumed.map_or_else(Vec::new, |state| core::mem::take(&mut state.answers));
        let journal = Rc::new(RefCell::new(Journal::after(answers)));
        let keeper = Self {
            keeping,
            start,
            journal: Rc::clone(&journal),
            saved_ms: 0,
            whole: 0,
            whole_steps: 0,
            strays: false,
        };
        (keeper, journal)
    }

    /// Checks that the run has come where the state was. `None` if it is not there yet.
    fn check(&mut self, record: &Record, mirror: &Mirror) -> Option<Result<(), LinkError>> {
        let state = self.keeping.resumed.as_ref()?;
        let steps = record.steps.len();
        if steps < state.steps as usize {
            return Some(Ok(()));
        }
        if steps > state.steps as usize {
            return None;
        }
        let pose = flat(&mirror.pose());
        let off = pose.iter().zip(state.pose).map(|(a, b)| (a - b).abs());
        // A device that was given its map in this very step has its pose by the wire's digits.
        let is_same = state.truth == truth(record)
            && off.fold(0.0, f32::max) < POSE_DIGITS
            && state.tiles.iter().copied().eq(mirror.tiles());
        self.strays |= !is_same;
        self.saved_ms = state.time_ms;
        Some(if is_same {
            Ok(())
        } else {
            Err(LinkError::Io("the state is that of another run".into()))
        })
    }

    /// Notes how many answers belong to the steps of the record. What came after the last command
    /// before the link broke is asked again.
    fn note_whole(&mut self, at: Moment, steps: usize) {
        let journal = self.journal.borrow();
        if at != Moment::Broken {
            (self.whole, self.whole_steps) = (journal.len(), steps);
        } else if steps > self.whole_steps {
            self.whole = journal.to_last_command();
        }
    }

    /// Uses the store, and keeps its first error.
    fn note(&mut self, act: impl FnOnce(&mut dyn Store) -> io::Result<()>) {
        if let Err(error) = act(self.keeping.store.as_mut()) {
            self.keeping.failure.get_or_insert(error);
        }
    }

    fn state(&self, record: &Record, mirror: &Mirror) -> State {
        let progress = record.progress();
        State {
            made_by: self.keeping.made_by.clone(),
            start: self.start.clone(),
            time_ms: progress.time_ms,
            steps: record.steps.len() as u32,
            coverage: record.coverage,
            status: record
                .steps
                .last()
                .map_or(Status::Idle, |it| it.command.status),
            truth: truth(record),
            odometry: flat(&mirror.odometry()),
            pose: flat(&mirror.pose()),
            home: mirror.home().as_ref().map(flat),
            epoch: mirror.epoch(),
            tiles: mirror.tiles().collect(),
            answers: self.journal.borrow().first(self.whole),
        }
    }
}

impl Keeper for StateKeeper<'_> {
    fn keep(&mut self, at: Moment, record: &Record, mirror: &Mirror) -> Result<(), LinkError> {
        self.note_whole(at, record.steps.len());
        if let Some(answer) = self.check(record, mirror) {
            return answer;
        }
        let can_go_on = matches!(
            record.ending,
            Ending::Interrupted | Ending::TimeLimit | Ending::Link(_)
        );
        if at != Moment::Step && !can_go_on {
            self.note(|store| store.remove());
            return Ok(());
        }
        let now_ms = record.progress().time_ms;
        let is_due = now_ms.saturating_sub(self.saved_ms) >= SAVE_EVERY_MS;
        if record.steps.is_empty() || !(is_due || at != Moment::Step) {
            return Ok(());
        }
        self.saved_ms = now_ms;
        let bytes = self.state(record, mirror).to_bytes();
        self.note(|store| store.put(&bytes, at));
        Ok(())
    }
}

fn flat(pose: &Pose) -> [f32; 3] {
    [pose.x_m, pose.y_m, pose.yaw_rad]
}

/// Returns the true pose after the last step.
fn truth(record: &Record) -> [f64; 3] {
    let last = record.steps.last().map(|step| step.truth);
    let last = last.unwrap_or_default();
    [last.x_m, last.y_m, last.yaw_rad]
}

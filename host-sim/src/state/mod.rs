//! The state of a run as a file, and how a run goes on from it.
//!
//! ```text
//!            every 10 s and at the end
//! run ─────────────────────────────────► session.state
//!
//! session.state ─► the host's answers again, step by step ─► the run where it was
//!               └► map, pose, surroundings, home, orders ─► the device, as after a reset
//! ```
//!
//! A run is a function of its options and of the planner's answers: the simulator draws all of its
//! numbers from seeds, and time is simulated. So the state has the answers so far, and the run is
//! made again from them: the true pose, the time, every stream of random numbers, people, coverage,
//! trajectory and the host's copy of the map are the same as before, bit for bit. That needs no
//! planner, so it takes a small part of the time.
//!
//! The device gets its map, its trail, its pose, the obstacle points near the robot and the track
//! along which it came by the messages with which a device that was reset gets them, and is told
//! where home is, what is left of its budget and which drive is in hand. What it does not get is
//! what such a device has lost: evidence, goals that were given up, the state of loops and patrols.
//! So it drives on as a device that was reset does, and not as one that was not.
//!
//! Invariants: a file that has its name is whole. It is written beside, and renamed. A run that has
//! ended, and so cannot go on, keeps none.

mod file;
mod journal;
mod keeper;

pub use file::{NAME, State, StateError, VERSION};
pub use journal::Answer;
pub(crate) use journal::Recorder;
pub(crate) use keeper::StateKeeper;
pub use keeper::{Folder, Keeping, SAVE_EVERY_MS, Store};

use crate::report::MadeBy;

/// Options that may differ where a run goes on: another link or device, another limit of time.
const MAY_DIFFER: [&str; 6] = [
    "resume",
    "link",
    "fault",
    "time-limit",
    "mission",
    "check-field",
];

/// Checks that a run may go on from a state: the same program and the same options.
///
/// # Errors
/// A sentence with the reason and the remedy.
pub fn may_resume(state: &State, made_by: &MadeBy) -> Result<(), String> {
    if state.made_by.version != made_by.version {
        return Err(format!(
            "the state was kept by host-sim {}, and this is {}; resume it with that version",
            state.made_by.version, made_by.version
        ));
    }
    match made_by.difference(&state.made_by, &MAY_DIFFER) {
        None => Ok(()),
        Some([held, asked]) => Err(format!(
            "the state is that of `{held}`, and this is `{asked}`; give the same options, as in \
             its command line: host-sim {}",
            state.made_by.command_line.join(" ")
        )),
    }
}

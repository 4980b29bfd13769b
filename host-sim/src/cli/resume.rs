//! `--resume DIR`: the state from which a run goes on.

use std::path::Path;

use anyhow::{Result, anyhow, bail};

use host_sim::report::MadeBy;
use host_sim::state::{Folder, Keeping, NAME, State, Store as _, may_resume};
use host_sim::trial::mission::on_device;

use super::args::ExploreArgs;
use super::explore::Run;
use super::film;

/// Returns the folder in which a run goes on; `None` if none is asked for.
pub(super) fn folder(args: &ExploreArgs) -> Result<Option<&Path>> {
    let Some(Some(folder)) = &args.resume else {
        return Ok(None);
    };
    if args.worlds.len() != 1 {
        bail!("--resume DIR goes on with one run; name only its world");
    }
    if !is_kept(args) {
        bail!(
            "--resume DIR goes on with a strategy on the device, and without --team or --live; no \
             other run is kept"
        );
    }
    if film::frames(args) > 0 {
        bail!(
            "--snapshots and --film read the device's map, and what is before the state is not \
             read again; leave them out with --resume DIR"
        );
    }
    Ok(Some(folder))
}

/// Reads the state of a folder for a run made so.
pub(super) fn state(folder: &Path, args: &ExploreArgs, made_by: &MadeBy) -> Result<State> {
    let state = State::read(folder).map_err(|error| anyhow!("--resume: {error}"))?;
    let file = folder.join(NAME);
    may_resume(&state, made_by)
        .map_err(|reason| anyhow!("--resume {}: {reason}", file.display()))?;
    if args.pace.time_limit <= state.time_ms {
        bail!(
            "--time-limit {} is over: {} is at {} s; allow more",
            f64::from(args.pace.time_limit) / 1000.0,
            file.display(),
            f64::from(state.time_ms) / 1000.0
        );
    }
    Ok(state)
}

/// Returns where a run goes on, in words.
pub(super) fn place(state: &State) -> String {
    format!(
        "after {:.1} s and {} steps, {:.1} % known",
        f64::from(state.time_ms) / 1000.0,
        state.steps,
        100.0 * state.coverage
    )
}

/// Removes the state of another run from the folder of a new one.
pub(super) fn clear(run: &Run) -> Result<()> {
    if run.resumed.is_none() {
        let removed = Folder::new(&run.folder).remove();
        removed.map_err(|error| {
            anyhow!(
                "cannot remove {}: {error}; choose a writable folder with --out",
                run.folder.join(NAME).display()
            )
        })?;
    }
    Ok(())
}

/// Returns the keeping of a run; `None` if it is not kept: a baseline, a member of a team, or one
/// that whoever looks at its page may steer.
pub(super) fn keeping(args: &ExploreArgs, run: &Run) -> Option<Keeping> {
    let store = Box::new(Folder::new(&run.folder));
    is_kept(args).then(|| Keeping::new(run.made_by.clone(), store, run.resumed.clone()))
}

fn is_kept(args: &ExploreArgs) -> bool {
    on_device(&args.strategy).is_some() && args.team.is_none() && args.live.is_none()
}

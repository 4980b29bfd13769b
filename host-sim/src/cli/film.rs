//! `explore --film FILE`: the pictures of a run, one after another.

use anyhow::{Context as _, Result, anyhow, bail};

use host_sim::picture::film::Film;

use super::args::ExploreArgs;
use super::pictures::Album;

/// Most pictures of a film besides the last one; there are at least half as many.
const FRAMES: usize = 200;

/// Returns the number of pictures to take during the run.
pub(super) fn frames(args: &ExploreArgs) -> usize {
    if args.film.is_some() {
        FRAMES
    } else {
        args.snapshots
    }
}

/// Checks that the film can be made, before the run; `None` without `--film`.
pub(super) fn film(args: &ExploreArgs) -> Result<Option<Film>> {
    let Some(file) = &args.film else {
        return Ok(None);
    };
    let name = file.display();
    if args.worlds.len() > 1 {
        bail!("--film {name}: a film shows one run; name one world");
    }
    if file.exists() && !args.folder.force {
        bail!("--film {name}: the file is there; say --force to replace it, or name another one");
    }
    if file
        .parent()
        .is_some_and(|it| !it.as_os_str().is_empty() && !it.is_dir())
    {
        bail!("--film {name}: its folder is not there");
    }
    let film = Film::new(file).with_context(|| format!("--film {name}"))?;
    Ok(Some(film))
}

/// Makes the film of a run.
pub(super) fn make(film: &Film, args: &ExploreArgs, album: &Album<'_>) -> Result<()> {
    let file = args.film.iter().map(|file| file.display());
    let name: String = file.map(|file| format!("--film {file}")).collect();
    let last = album.last();
    let last = last.ok_or_else(|| anyhow!("{name}: a page does not fit into memory"))?;
    film.make(album.film(), last).context(name)
}

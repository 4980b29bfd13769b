//! Which worlds there are to explore.

use std::path::{Path, PathBuf};

use host_sim::world::World;

/// Built-in worlds of which everything that can be seen can be explored.
pub const EXPLORABLE: [&str; 7] = [
    "office",
    "cave",
    "loop",
    "cluttered",
    "hall",
    "empty-hall",
    "narrow-doors",
];

/// Built-in worlds that are there to get wrong.
pub const SPECIAL: [&str; 2] = ["unreachable-room", "boxed-in"];

/// Built-in worlds of uneven ground.
pub const UNEVEN: [&str; 9] = [
    "slope", "holes", "building", "cliff", "spiral", "kerbs", "waves", "pass", "causeway",
];

/// Built-in worlds drawn to the sizes of the published ones, with loops and without, 15 starts each.
pub const PUBLISHED: [&str; 7] = [
    "ouroboros-a",
    "ouroboros-b",
    "ouroboros-c",
    "ouroboros-d",
    "tdbvp-adjacent",
    "tdbvp-nested",
    "tdbvp-floor",
];

/// A built-in world.
///
/// # Panics
/// If there is none of that name.
#[must_use]
pub fn builtin(name: &str) -> World {
    World::builtin(name).unwrap_or_else(|| panic!("no built-in world is called {name}"))
}

/// The worlds with level floors among those drawn by others, by name; `None`, with a word on standard output, where
/// there are none.
///
/// They lie in folder `worlds` of `FIELDLINE_DATA`, or else of `../shared/data` beside the source tree, and are no part
/// of the project.
///
/// # Panics
/// If one of them cannot be loaded.
#[must_use]
pub fn drawn_by_others() -> Option<Vec<World>> {
    let worlds = all_drawn_by_others()?.into_iter();
    Some(worlds.filter(|world| world.elevation().is_none()).collect())
}

/// Those with uneven ground; else as [`drawn_by_others`].
///
/// # Panics
/// As [`drawn_by_others`].
#[must_use]
pub fn uneven_drawn_by_others() -> Option<Vec<World>> {
    let worlds = all_drawn_by_others()?.into_iter();
    Some(worlds.filter(|world| world.elevation().is_some()).collect())
}

fn all_drawn_by_others() -> Option<Vec<World>> {
    let folder = data_folder().join("worlds");
    let Ok(entries) = folder.read_dir() else {
        println!(
            "skipped: there are no worlds in {}; FIELDLINE_DATA may name the folder above",
            folder.display()
        );
        return None;
    };
    let mut files: Vec<PathBuf> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|end| end == "yaml"))
        .collect();
    files.sort();
    let worlds = files.iter().map(|file| match World::load(file) {
        Ok(world) => world,
        Err(error) => panic!("{error}"),
    });
    Some(worlds.collect())
}

fn data_folder() -> PathBuf {
    match std::env::var_os("FIELDLINE_DATA") {
        Some(folder) => folder.into(),
        None => Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data"),
    }
}

#[cfg(test)]
mod tests {
    use super::{EXPLORABLE, PUBLISHED, SPECIAL, UNEVEN};

    #[test]
    fn every_built_in_world_is_of_one_kind() {
        let mut known: Vec<_> = EXPLORABLE
            .iter()
            .chain(&SPECIAL)
            .chain(&UNEVEN)
            .chain(&PUBLISHED)
            .copied()
            .collect();
        let mut there: Vec<_> = host_sim::world::builtins()
            .iter()
            .map(|world| world.name)
            .collect();
        known.sort_unstable();
        there.sort_unstable();
        assert_eq!(known, there);
    }
}

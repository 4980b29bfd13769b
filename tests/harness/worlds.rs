//! The built-in worlds by kind, and worlds drawn by others.
//!
//! The others are no part of the project. `FIELDLINE_DATA` names a folder; its subfolder `worlds`
//! holds world files (`.yaml`).

use std::path::PathBuf;

use host_sim::world::World;

/// Built-in flat worlds where everything that can be seen can be explored.
pub const EXPLORABLE: [&str; 7] = [
    "office",
    "cave",
    "loop",
    "cluttered",
    "hall",
    "empty-hall",
    "narrow-doors",
];

/// Built-in flat worlds with something that cannot be reached.
pub const SPECIAL: [&str; 2] = ["unreachable-room", "boxed-in"];

/// Built-in worlds of uneven ground.
pub const UNEVEN: [&str; 9] = [
    "slope", "holes", "building", "cliff", "spiral", "kerbs", "waves", "pass", "causeway",
];

/// Built-in worlds of the sizes that the papers give, with loops and without; 15 starts each.
pub const PUBLISHED: [&str; 7] = [
    "ouroboros-a",
    "ouroboros-b",
    "ouroboros-c",
    "ouroboros-d",
    "tdbvp-adjacent",
    "tdbvp-nested",
    "tdbvp-floor",
];

/// Built-in worlds of the space-based potential field \[Kenealy15\].
pub const SPACE: [&str; 3] = ["two-rooms", "c-room", "partition"];

/// Returns a built-in world.
///
/// # Panics
/// If no built-in world has that name.
#[must_use]
pub fn builtin(name: &str) -> World {
    World::builtin(name).unwrap_or_else(|| panic!("no built-in world is called {name}"))
}

/// Returns built-in worlds.
///
/// # Panics
/// As [`builtin`].
#[must_use]
pub fn builtins(names: &[&str]) -> Vec<World> {
    names.iter().map(|name| builtin(name)).collect()
}

/// Returns the flat worlds drawn by others, sorted by file name.
///
/// # Panics
/// If `FIELDLINE_DATA` names no folder with worlds, or a world cannot be loaded.
#[must_use]
pub fn drawn_by_others() -> Vec<World> {
    let worlds = all_drawn_by_others().into_iter();
    worlds.filter(|world| world.elevation().is_none()).collect()
}

/// Returns the worlds with uneven ground drawn by others, sorted by file name.
///
/// # Panics
/// As [`drawn_by_others`].
#[must_use]
pub fn uneven_drawn_by_others() -> Vec<World> {
    let worlds = all_drawn_by_others().into_iter();
    worlds.filter(|world| world.elevation().is_some()).collect()
}

fn all_drawn_by_others() -> Vec<World> {
    let Some(data) = std::env::var_os("FIELDLINE_DATA").map(PathBuf::from) else {
        panic!("FIELDLINE_DATA must name the folder that holds a folder worlds");
    };
    let folder = data.join("worlds");
    let entries = match folder.read_dir() {
        Ok(entries) => entries,
        Err(error) => panic!("FIELDLINE_DATA: {}: {error}", folder.display()),
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
    worlds.collect()
}

#[cfg(test)]
mod tests {
    use super::{EXPLORABLE, PUBLISHED, SPACE, SPECIAL, UNEVEN};

    #[test]
    fn every_built_in_world_is_of_one_kind() {
        let mut known: Vec<_> = EXPLORABLE
            .iter()
            .chain(&SPECIAL)
            .chain(&UNEVEN)
            .chain(&PUBLISHED)
            .chain(&SPACE)
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

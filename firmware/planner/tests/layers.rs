//! The layers of the planner: a room imports only itself and rooms above it in [`ROOMS`].
//!
//! The test reads the sources as text and looks at every `crate::` path. `super::` must not lead
//! out of a room, so that no import hides from it.

use std::fs;
use std::path::{Path, PathBuf};

/// The rooms, the lowest layer first. A room is a folder of `src`, a file of it, or both.
const ROOMS: [&str; 21] = [
    "clock",
    "math",
    "geometry",
    "input",
    "robot",
    "fence",
    "config",
    "status",
    "doing",
    "profiling",
    "grid",
    "ground",
    "map",
    "localise",
    "team",
    "roadmap",
    "field",
    "path",
    "strategy",
    "drive",
    "planner",
];

/// A source file of a room.
struct Source {
    /// Path below `src`.
    path: PathBuf,
    /// Its code, without comments.
    code: String,
}

impl Source {
    fn room(&self) -> String {
        let first = self.path.iter().next().expect("a file has a name");
        first.to_string_lossy().trim_end_matches(".rs").to_owned()
    }

    /// Modules from the crate's root down to this file's: `super` may climb fewer.
    fn depth(&self) -> usize {
        let folders = self.path.iter().count() - 1;
        let is_folder = self.path.file_name().is_some_and(|name| name == "mod.rs");
        folders + usize::from(!is_folder)
    }

    /// The longest chain of `super::`.
    fn longest_climb(&self) -> usize {
        let chains = (1..).take_while(|&length| self.code.contains(&"super::".repeat(length)));
        chains.count()
    }

    /// The rooms that the code names in `crate::` paths.
    fn imports(&self) -> Vec<String> {
        let mut rooms = Vec::new();
        for after in self.code.split("crate::").skip(1) {
            let group = after.strip_prefix('{');
            let names = match group {
                Some(group) => group.split('}').next().unwrap_or_default(),
                None => after,
            };
            let name = |text: &str| -> String {
                let text = text.trim_start();
                text.chars()
                    .take_while(|c| c.is_alphanumeric() || *c == '_')
                    .collect()
            };
            match group {
                Some(_) => rooms.extend(names.split(',').map(name)),
                None => rooms.push(name(names)),
            }
        }
        rooms.retain(|room| !room.is_empty());
        rooms
    }
}

/// All source files below `src`, without `lib.rs` and files of tests.
fn sources() -> Vec<Source> {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut found = Vec::new();
    let mut folders = vec![src.clone()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).expect("the folder can be read") {
            let path = entry.expect("the entry can be read").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|kind| kind == "rs") {
                let text = fs::read_to_string(&path).expect("the file can be read");
                let path = path.strip_prefix(&src).expect("below src").to_owned();
                found.push(Source {
                    path,
                    code: without_comments(&text),
                });
            }
        }
    }
    found.retain(|source| source.path != Path::new("lib.rs") && !is_test(&source.path));
    found
}

/// The code without comments and without the tests at its end, which may look at every room.
fn without_comments(text: &str) -> String {
    let lines = text
        .lines()
        .map(|line| line.split("//").next().unwrap_or(""));
    let code = lines.collect::<Vec<_>>().join("\n");
    let own = code.split("#[cfg(test)]\nmod tests {").next();
    own.unwrap_or_default().to_owned()
}

/// True for a file that holds tests only.
fn is_test(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name == "tests.rs")
}

fn layer(room: &str) -> Option<usize> {
    ROOMS.iter().position(|&name| name == room)
}

#[test]
fn every_room_imports_only_from_above() {
    let sources = sources();
    assert!(sources.len() > 100, "the scan finds the sources");
    let mut wrong = Vec::new();
    for source in &sources {
        let own = layer(&source.room()).unwrap_or_else(|| panic!("no layer for {:?}", source.path));
        for room in source.imports() {
            match layer(&room) {
                Some(layer) if layer <= own => {}
                Some(_) => wrong.push(format!("{} imports {room}", source.path.display())),
                None => wrong.push(format!("{} names no room: {room}", source.path.display())),
            }
        }
    }
    assert!(
        wrong.is_empty(),
        "against the layers:\n{}",
        wrong.join("\n")
    );
}

#[test]
fn super_never_leads_out_of_a_room() {
    for source in &sources() {
        let climbs = source.longest_climb();
        assert!(
            climbs < source.depth(),
            "{} climbs out of its room",
            source.path.display()
        );
    }
}

#[test]
fn the_scan_sees_what_it_should() {
    let source = |code: &str| Source {
        path: PathBuf::from("field/window.rs"),
        code: without_comments(code),
    };
    let one = source("use crate::planner::State; // crate::drive\nlet x = crate::math::PI;");
    assert_eq!(one.imports(), ["planner", "math"]);
    let many = source("use crate::{map::Tiles, drive};");
    assert_eq!(many.imports(), ["map", "drive"]);
    assert_eq!(one.room(), "field");
    assert_eq!((one.depth(), one.longest_climb()), (2, 0));
    assert_eq!(source("super::super::x()").longest_climb(), 2);
}

//! Errors of a world, each in one line that names the file, the fault and the remedy.

use thiserror::Error;

use super::{KINDS, builtin};
use crate::near;

/// Why a world cannot be opened.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum WorldError {
    /// The world file is missing or unreadable; also an unknown built-in name.
    #[error("{}", unreadable(file, reason))]
    Unreadable {
        /// File or name as given.
        file: String,
        /// The system's message.
        reason: String,
    },
    /// The name of a generated world has a bad seed or size.
    #[error("{name}: {reason}")]
    Generated {
        /// The name as given.
        name: String,
        /// The fault and the remedy.
        reason: String,
    },
    /// Not YAML, or not one document of it.
    #[error("{file}: {reason}; correct the YAML there")]
    Syntax {
        /// The world file.
        file: String,
        /// Line, column and the parser's message.
        reason: String,
    },
    /// A key that is unknown or missing, or whose value is impossible.
    #[error("{file}: {}{reason}", if key.is_empty() { String::new() } else { format!("{key}: ") })]
    Value {
        /// The world file.
        file: String,
        /// The key, with the tables it lies in; empty for the whole document.
        key: String,
        /// The fault and the remedy.
        reason: String,
    },
    /// An image that is missing, damaged or of the wrong kind.
    #[error("{file}: image {image}: {reason}")]
    Image {
        /// The world file.
        file: String,
        /// The path of the image, relative to the world file.
        image: String,
        /// The fault and the remedy.
        reason: String,
    },
    /// A start pose in which the robot does not fit.
    #[error("{file}: robots[{index}]: {reason}")]
    Start {
        /// The world file or built-in name.
        file: String,
        /// The index in `robots`, from 0.
        index: usize,
        /// The fault and the remedy.
        reason: String,
    },
    /// People who cannot walk there.
    #[error("{world}: {reason}")]
    People {
        /// The world's name.
        world: String,
        /// The fault and the remedy.
        reason: String,
    },
}

fn unreadable(file: &str, reason: &str) -> String {
    if file.is_empty() {
        return format!("the world has no name; give {}", accepted());
    }
    let near = near::hint(file, builtin::names().into_iter().chain(kinds()));
    format!(
        "{file}: cannot read this world ({reason}); give {}{near}",
        accepted()
    )
}

/// Words that begin the name of a generated world.
fn kinds() -> impl Iterator<Item = &'static str> {
    KINDS.into_iter().map(|kind| kind.word())
}

/// Lists what names a world.
fn accepted() -> String {
    let generated = KINDS.map(|kind| format!("{}:SEED", kind.word()));
    format!(
        "a world file or a built-in world: {}; or a generated one: {}",
        builtin::names().join(", "),
        generated.join(", ")
    )
}

//! Errors of a world, each in one line that names the file, the fault and the remedy.

use core::fmt;

use super::{KINDS, builtin};
use crate::near;

/// Why a world cannot be opened.
#[derive(Clone, Debug, PartialEq)]
pub enum WorldError {
    /// The world file is missing or unreadable; also an unknown built-in name.
    Unreadable {
        /// File or name as given.
        file: String,
        /// The system's message.
        reason: String,
    },
    /// The name of a generated world has a bad seed or size.
    Generated {
        /// The name as given.
        name: String,
        /// The fault and the remedy.
        reason: String,
    },
    /// Not YAML, or not one document of it.
    Syntax {
        /// The world file.
        file: String,
        /// Line, column and the parser's message.
        reason: String,
    },
    /// A key that is unknown or missing, or whose value is impossible.
    Value {
        /// The world file.
        file: String,
        /// The key, with the tables it lies in; empty for the whole document.
        key: String,
        /// The fault and the remedy.
        reason: String,
    },
    /// An image that is missing, damaged or of the wrong kind.
    Image {
        /// The world file.
        file: String,
        /// The path of the image, relative to the world file.
        image: String,
        /// The fault and the remedy.
        reason: String,
    },
    /// A start pose in which the robot does not fit.
    Start {
        /// The world file or built-in name.
        file: String,
        /// The index in `robots`, from 0.
        index: usize,
        /// The fault and the remedy.
        reason: String,
    },
    /// People who cannot walk there.
    People {
        /// The world's name.
        world: String,
        /// The fault and the remedy.
        reason: String,
    },
}

impl fmt::Display for WorldError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreadable { file, .. } if file.is_empty() => {
                write!(f, "the world has no name; give {}", accepted())
            }
            Self::Unreadable { file, reason } => write!(
                f,
                "{file}: cannot read this world ({reason}); give {}{}",
                accepted(),
                near::hint(file, builtin::names().into_iter().chain(kinds()))
            ),
            Self::Generated { name, reason } => write!(f, "{name}: {reason}"),
            Self::Syntax { file, reason } => {
                write!(f, "{file}: {reason}; correct the YAML there")
            }
            Self::Value { file, key, reason } if key.is_empty() => write!(f, "{file}: {reason}"),
            Self::Value { file, key, reason } => write!(f, "{file}: {key}: {reason}"),
            Self::Image {
                file,
                image,
                reason,
            } => write!(f, "{file}: image {image}: {reason}"),
            Self::Start {
                file,
                index,
                reason,
            } => write!(f, "{file}: robots[{index}]: {reason}"),
            Self::People { world, reason } => write!(f, "{world}: {reason}"),
        }
    }
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

impl core::error::Error for WorldError {}

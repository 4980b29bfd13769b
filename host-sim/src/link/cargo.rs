//! Runs cargo on the source tree: for the image of the chip, and for the emulator's plugin.

use std::path::{Path, PathBuf};
use std::process::Command;

/// Reason why cargo built nothing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum NotBuilt {
    /// There is no source tree at this place.
    NoSources(PathBuf),
    /// Cargo could not be run.
    NoCargo(String),
    /// Cargo failed, and said this.
    Failed(String),
}

/// Builds a package, whose folder is `folder` in the source tree. Returns cargo's messages, one
/// JSON object a line.
pub(super) fn build(folder: &str, package: &str, arguments: &[&str]) -> Result<String, NotBuilt> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    if !root.join(folder).join("Cargo.toml").is_file() {
        return Err(NotBuilt::NoSources(root));
    }
    let output = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
        .current_dir(&root)
        .args(["build", "--package", package])
        .args(["--message-format", "json-render-diagnostics"])
        .args(arguments)
        .output()
        .map_err(|error| NotBuilt::NoCargo(error.to_string()))?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        return Err(NotBuilt::Failed(said.into_owned()));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// Returns the first line of an error in cargo's log.
pub(super) fn first_error(log: &str) -> &str {
    let mut lines = log.lines();
    let found = lines.find(|line| line.starts_with("error"));
    found.unwrap_or("no error line")
}

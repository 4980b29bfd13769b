//! `host-sim robots`: lists the presets, or prints one as a robot file.

use anyhow::{Result, bail};
use serde::Serialize;

use host_sim::robot::presets::{self, PRESETS};

use super::say;

/// A preset; the fields are in the order of the JSON line.
#[derive(Serialize)]
struct Listing {
    name: &'static str,
    description: &'static str,
}

/// Lists the presets, or prints the one of this name.
pub(super) fn run(name: Option<&str>, json: bool) -> Result<()> {
    if let Some(name) = name {
        return print(name);
    }
    let names = PRESETS.iter().map(|preset| preset.name.len());
    let widest = names.max().unwrap_or(0);
    for preset in &PRESETS {
        let (name, description) = (preset.name, preset.description);
        if json {
            say(&serde_json::to_string(&Listing { name, description })?)?;
        } else {
            say(&format!("{name:widest$}  {description}"))?;
        }
    }
    Ok(())
}

fn print(name: &str) -> Result<()> {
    match presets::find(name) {
        Some(preset) => say(preset.yaml),
        None => bail!(
            "no robot is called {name}; known are {}",
            presets::names().join(", ")
        ),
    }
}

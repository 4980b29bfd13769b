//! `host-sim tuning`: lists the planner's tuned constants with meaning, unit, range and default.

use anyhow::Result;
use fieldline_planner::{Tuned, Tuning};
use serde::Serialize;

use super::say;

/// A constant; the fields are in the order of the JSON line.
#[derive(Serialize)]
struct Listing {
    name: String,
    meaning: &'static str,
    unit: &'static str,
    least: f32,
    most: f32,
    default: f32,
}

impl From<Tuned> for Listing {
    fn from(tuned: Tuned) -> Self {
        Self {
            name: format!("{}.{}", tuned.room, tuned.name),
            meaning: tuned.meaning,
            unit: tuned.unit,
            least: tuned.least,
            most: tuned.most,
            default: tuned.default,
        }
    }
}

/// Lists the constants, room by room.
pub(super) fn run(json: bool) -> Result<()> {
    let mut listings: Vec<Listing> = Vec::new();
    Tuning::DEFAULT.parameters(|tuned| listings.push(tuned.into()));
    let widest = listings.iter().map(|listing| listing.name.len()).max();
    let widest = widest.unwrap_or(0);
    for listing in &listings {
        if json {
            say(&serde_json::to_string(listing)?)?;
            continue;
        }
        let Listing {
            name,
            meaning,
            unit,
            least,
            most,
            default,
        } = listing;
        say(&format!(
            "{name:widest$}  {default} {unit} ({least} to {most}): {meaning}"
        ))?;
    }
    Ok(())
}

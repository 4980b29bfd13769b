//! `host-sim worlds`: lists the built-in worlds with size and starts, and the kinds of generated
//! ones. A line of JSON is a world, so `--json` leaves the kinds out.

use anyhow::Result;
use serde::Serialize;

use host_sim::world::{KINDS, World, builtins};

use super::say;

/// A built-in world; the fields are in the order of the JSON line.
#[derive(Serialize)]
struct Listing {
    name: &'static str,
    description: &'static str,
    size_m: [f64; 2],
    /// x m, y m, yaw rad.
    starts: Vec<[f64; 3]>,
}

/// Lists the worlds.
pub(super) fn run(json: bool) -> Result<()> {
    let listings: Vec<Listing> = builtins()
        .iter()
        .filter_map(|builtin| {
            let world = World::builtin(builtin.name)?;
            let starts = world.starts().iter();
            Some(Listing {
                name: builtin.name,
                description: &builtin.description,
                size_m: world.size_m().map(|m| (m * 100.0).round() / 100.0),
                starts: starts.map(|s| [s.x_m, s.y_m, s.yaw_rad]).collect(),
            })
        })
        .collect();
    let widest = listings.iter().map(|listing| listing.name.len()).max();
    let widest = widest.unwrap_or(0);
    for listing in &listings {
        if json {
            say(&serde_json::to_string(listing)?)?;
        } else {
            say(&text(listing, widest))?;
        }
    }
    for kind in KINDS.iter().filter(|_| !json) {
        let name = format!("{}:SEED", kind.word());
        say(&format!("{name:widest$}  {}", kind.description()))?;
    }
    Ok(())
}

fn text(listing: &Listing, width: usize) -> String {
    let starts: Vec<String> = listing
        .starts
        .iter()
        .map(|[x, y, yaw]| format!("({x}, {y}, {yaw})"))
        .collect();
    let [across, up] = listing.size_m;
    format!(
        "{:width$}  {}\n{:width$}  {across} x {up} m; starts (x m, y m, yaw rad): {}",
        listing.name,
        listing.description,
        "",
        starts.join(" ")
    )
}

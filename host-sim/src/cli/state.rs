//! `host-sim state`: prints what a state of a run holds.

use std::path::Path;

use anyhow::{Result, anyhow};
use serde_json::json;

use host_sim::state::State;
use host_sim::trial::wording;

use super::say;

/// Prints the state of a file or of a run's folder.
pub(super) fn run(path: &Path, as_json: bool) -> Result<()> {
    let state = State::read(path).map_err(|error| anyhow!("{error}"))?;
    say(&if as_json { line(&state) } else { text(&state) })
}

fn place([x, y, yaw]: [f64; 3]) -> String {
    format!("({x:.2}, {y:.2}) m, {:.1} degrees", yaw.to_degrees())
}

fn text(state: &State) -> String {
    let home = state
        .home
        .map_or("not there yet".into(), |it| place(it.map(f64::from)));
    format!(
        "run       host-sim {} ({})\n\
         at        {:.1} s, {} steps, {:.1} % known, {}\n\
         robot     {} in the map, {} by odometry, {} in truth\n\
         home      {home}\n\
         map       {} tiles of 3.2 m, {} corrections\n\
         answers   {}",
        state.made_by.command_line.join(" "),
        state.made_by.version,
        f64::from(state.time_ms) / 1000.0,
        state.steps,
        100.0 * state.coverage,
        wording::status(state.status),
        place(state.pose.map(f64::from)),
        place(state.odometry.map(f64::from)),
        place(state.truth),
        state.tiles.len(),
        state.epoch,
        state.answers.len(),
    )
}

fn line(state: &State) -> String {
    json!({
        "command_line": state.made_by.command_line,
        "version": state.made_by.version,
        "time_s": f64::from(state.time_ms) / 1000.0,
        "steps": state.steps,
        "coverage": state.coverage,
        "status": wording::status(state.status),
        "pose": state.pose,
        "odometry": state.odometry,
        "truth": state.truth,
        "home": state.home,
        "tiles": state.tiles.len(),
        "epoch": state.epoch,
        "answers": state.answers.len(),
    })
    .to_string()
}

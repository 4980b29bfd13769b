//! `--live`: opens the live page, and keeps it after the last run.

use core::net::SocketAddr;
use core::time::Duration;

use anyhow::{Context as _, Result};

use host_sim::live::{About, Counts, Limits, Live, Observer};
use host_sim::report::Report;
use host_sim::trial::Record;
use host_sim::trial::mission::Mission;
use host_sim::world::World;

use super::note;
use super::progress::Interrupt;

/// How long the page stays after the runs while nobody is connected: time to open it, and to load
/// it anew.
const LINGER: Duration = Duration::from_secs(60);

/// Where the page is; `None` for the usual address.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct LiveArg(pub(super) Option<SocketAddr>);

/// Opens the page and prints its address.
pub(super) fn open(LiveArg(address): LiveArg, pace: Option<f64>) -> Result<Live> {
    let (pace, limits) = (pace.unwrap_or(0.0), Limits::default());
    let live = match address {
        Some(address) => Live::open(address, pace, limits)
            .with_context(|| format!("--live {address}: no page can be served there")),
        None => Live::usual(pace, limits).context("--live: no page can be served on loopback"),
    }?;
    note(&format!("host-sim: live page at {}", live.url()));
    if live.address() != host_sim::live::ADDRESS && address.is_none() {
        let usual = host_sim::live::ADDRESS.port();
        note(&format!(
            "host-sim: port {usual} is in use, so the page has another one"
        ));
    }
    Ok(live)
}

/// Returns what shows a run.
pub(super) fn observer(
    live: &Live,
    mission: &Mission,
    world: &World,
    interrupt: &Interrupt,
) -> Observer {
    let about = About {
        world: world.name().into(),
        strategy: mission.strategy.clone(),
        link: mission.link.clone(),
        seed: mission.seed,
    };
    let interrupt = interrupt.clone();
    live.observer(about, move || interrupt.pressed())
}

/// Shows the end of a run.
pub(super) fn end(observer: Option<&mut Observer>, result: &Result<(Report, Record)>) {
    let Some(observer) = observer else {
        return;
    };
    match result {
        Ok((report, _)) => observer.end(report),
        Err(error) => observer.fail(&format!("{error:#}")),
    }
}

/// Keeps the page while someone looks at it, and says what was refused.
pub(super) fn stay(live: &Live, interrupt: &Interrupt) {
    if !interrupt.pressed() {
        note(&format!(
            "host-sim: the page stays at {} while it is open, and {} s; Ctrl-C ends it",
            live.url(),
            LINGER.as_secs()
        ));
    }
    live.stay(LINGER, || interrupt.pressed());
    if let Some(text) = refused(&live.counts()) {
        note(&format!("host-sim: live page: {text}"));
    }
}

/// Returns what was refused, in words; `None` if nothing was.
fn refused(counts: &Counts) -> Option<String> {
    let parts = [
        (counts.too_many, "connections beyond the limit"),
        (counts.turned_away, "visitors turned away"),
        (counts.slow_heads, "requests too slow or too long"),
        (counts.broken, "viewers that broke the protocol"),
        (counts.dropped, "viewers that took nothing"),
        (counts.refused, "messages refused"),
    ];
    let parts = parts.iter().filter(|(number, _)| *number > 0);
    let words: Vec<String> = parts
        .map(|(number, what)| format!("{number} {what}"))
        .collect();
    (!words.is_empty()).then(|| words.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_was_refused_is_said() {
        assert_eq!(refused(&Counts::default()), None);
        let counts = Counts {
            came: 3,
            turned_away: 2,
            dropped: 1,
            ..Counts::default()
        };
        let text = "2 visitors turned away, 1 viewers that took nothing";
        assert_eq!(refused(&counts).as_deref(), Some(text));
    }
}

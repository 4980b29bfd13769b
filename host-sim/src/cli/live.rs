//! `--live`: opens the live page, and keeps it after the last run.

use core::net::SocketAddr;
use core::time::Duration;

use anyhow::{Context as _, Result};

use host_sim::live::{About, Counts, Limits, Live, Observer};
use host_sim::report::Report;
use host_sim::trial::mission::Mission;

use super::note;
use super::progress::Interrupt;

/// How long the page stays after the runs while nobody is connected: time to open it, and to load
/// it anew.
const LINGER: Duration = Duration::from_secs(60);

/// Where the page is; `None` for the usual address.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct LiveArg(pub(super) Option<SocketAddr>);

/// Opens the page and prints its address.
pub(super) fn open(place: LiveArg, pace: Option<f64>) -> Result<Live> {
    open_at(place, pace, 0, "live page")
}

/// Opens a page of each robot of a team, at ports one after another, and prints their addresses.
pub(super) fn open_team(place: LiveArg, pace: Option<f64>, robots: usize) -> Result<Vec<Live>> {
    let page = |robot| open_at(place, pace, robot, &format!("live page of robot {robot}"));
    (0..robots).map(page).collect()
}

/// Opens a page, so many ports behind the place that was asked for.
fn open_at(LiveArg(asked): LiveArg, pace: Option<f64>, behind: usize, name: &str) -> Result<Live> {
    let (pace, limits) = (pace.unwrap_or(0.0), Limits::default());
    let mut address = asked.unwrap_or(host_sim::live::ADDRESS);
    // Port 0 is any free one.
    if address.port() != 0 {
        let port = u16::try_from(usize::from(address.port()) + behind);
        let port = port.ok().with_context(|| {
            format!("--live {address}: there is no port for robot {behind}; give a lower one")
        })?;
        address.set_port(port);
    }
    let live = match asked {
        Some(_) => Live::open(address, pace, limits)
            .with_context(|| format!("--live {address}: no page can be served there")),
        None => Live::open_near(address, pace, limits)
            .context("--live: no page can be served on loopback"),
    }?;
    note(&format!("host-sim: {name} at {}", live.url()));
    if asked.is_none() && live.address() != address {
        let usual = address.port();
        note(&format!(
            "host-sim: port {usual} is in use, so the page has another one"
        ));
    }
    Ok(live)
}

/// Returns what shows a run of this name.
pub(super) fn observer(
    live: &Live,
    mission: &Mission,
    name: String,
    interrupt: &Interrupt,
) -> Observer {
    let about = About {
        world: name,
        strategy: mission.strategy.clone(),
        link: mission.link.clone(),
        seed: mission.seed,
    };
    let interrupt = interrupt.clone();
    live.observer(about, move || interrupt.pressed())
}

/// Shows the end of a run: its report, or why there is none.
pub(super) fn end(observer: &mut Observer, result: Result<&Report, String>) {
    match result {
        Ok(report) => observer.end(report),
        Err(why) => observer.fail(&why),
    }
}

/// Keeps the pages while someone looks at one, and says what was refused.
pub(super) fn stay(pages: &[Live], interrupt: &Interrupt) {
    if pages.is_empty() {
        return;
    }
    if !interrupt.pressed() {
        let urls: Vec<String> = pages.iter().map(Live::url).collect();
        let (subject, it) = match urls.len() {
            1 => ("the page stays", "it is"),
            _ => ("the pages stay", "one is"),
        };
        note(&format!(
            "host-sim: {subject} at {} while {it} open, and {} s; Ctrl-C ends it",
            urls.join(", "),
            LINGER.as_secs()
        ));
    }
    Live::stay(pages, LINGER, || interrupt.pressed());
    for text in pages.iter().filter_map(|page| refused(&page.counts())) {
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

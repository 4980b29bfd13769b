//! Who watches a replay: the interrupt key, a live page, and a recording.

use anyhow::Result;
use serde::Serialize;

use host_sim::live::{About, Live, Observer};
use host_sim::trial::sight::Sight;
use host_sim::trial::{Flow, Progress, Watch};

use super::live::{self, LiveArg};
use super::progress::Interrupt;
use super::recording::Recorder;

/// Watches a session that is made again.
pub(super) struct Along {
    interrupt: Interrupt,
    live: Option<Live>,
    page: Option<Observer>,
    recorder: Option<Recorder>,
}

impl Along {
    /// Opens the page, if one is asked for.
    pub(super) fn begin(about: About, place: Option<LiveArg>) -> Result<Self> {
        let interrupt = Interrupt::listen()?;
        let live = place.map(|place| live::open(place, None)).transpose()?;
        let pressed = interrupt.clone();
        let page = live.as_ref();
        let page = page.map(|live| live.observer(about, move || pressed.pressed()));
        Ok(Self {
            interrupt,
            live,
            page,
            recorder: None,
        })
    }

    /// Records what is seen.
    pub(super) fn record(&mut self, recorder: Option<Recorder>) {
        self.recorder = recorder;
    }

    /// Returns what records.
    pub(super) const fn recorder(&self) -> Option<&Recorder> {
        self.recorder.as_ref()
    }

    /// Ends the recording with this report, and tells the page the end; then keeps the page while
    /// someone looks at it.
    pub(super) fn end<R: Serialize>(mut self, report: Result<&R, String>, text: &str) {
        if let Some(recorder) = &self.recorder {
            recorder.end(report.as_ref().ok().copied());
        }
        match (&mut self.page, report) {
            (Some(page), Ok(_)) => page.end_again(text),
            (Some(page), Err(why)) => page.fail(&why),
            (None, _) => {}
        }
        live::stay(self.live.as_slice(), &self.interrupt);
    }
}

impl Watch for Along {
    fn step(&mut self, _: &Progress) -> Flow {
        if self.interrupt.pressed() {
            Flow::Interrupt
        } else {
            Flow::Continue
        }
    }

    fn see(&mut self, sight: &mut Sight<'_>) {
        if let Some(recorder) = &self.recorder {
            recorder.see(sight);
        }
        if let Some(page) = &mut self.page {
            page.see(sight);
        }
    }
}

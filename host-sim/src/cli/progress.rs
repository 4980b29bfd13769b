//! The progress line during a run or a campaign, the pacer, and the interrupt key.

use core::sync::atomic::{AtomicBool, Ordering};
use core::time::Duration;
use std::rc::Rc;
use std::sync::Arc;
use std::time::Instant;

use anyhow::{Context as _, Result};
use indicatif::{ProgressBar, ProgressStyle};

use host_sim::live::Observer;
use host_sim::report::mission_log::MissionLog;
use host_sim::trial::sight::Sight;
use host_sim::trial::{Flow, Progress, Watch, wording};

use super::note;
use super::recording::Recorder;

/// Ticks of the bar: tenths of a percent.
const TICKS: u64 = 1_000;

/// The interrupt key: the first press ends the run, the second ends the program.
#[derive(Clone, Debug)]
pub(super) struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Takes the key over.
    pub(super) fn listen() -> Result<Self> {
        let pressed = Arc::new(AtomicBool::new(false));
        for signal in [signal_hook::consts::SIGINT, signal_hook::consts::SIGTERM] {
            // The order matters: the shutdown must see only earlier presses.
            let second = Arc::clone(&pressed);
            signal_hook::flag::register_conditional_shutdown(signal, 130, second)
                .context("cannot listen to the interrupt key")?;
            signal_hook::flag::register(signal, Arc::clone(&pressed))
                .context("cannot listen to the interrupt key")?;
        }
        Ok(Self(pressed))
    }

    /// Returns true if it was pressed.
    pub(super) fn pressed(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Watches one run.
pub(super) struct Onlooker {
    bar: ProgressBar,
    interrupt: Interrupt,
    /// The log that is printed.
    log: Option<MissionLog>,
    /// Real time of the start, and the simulated seconds that one second may have at most.
    began: Option<(Instant, f64)>,
    /// Simulated time up to which the run is made again, milliseconds.
    after_ms: u32,
    /// The live pages, robot by robot, which keep the pace then.
    pages: Vec<Observer>,
    /// Where the run is recorded, robot by robot.
    recorders: Vec<Rc<Recorder>>,
}

impl Onlooker {
    /// Makes the watcher of a run; `name` is in its line. The run is no faster than `pace`, in
    /// simulated seconds a second.
    pub(super) fn new(name: &str, pace: Option<f64>, interrupt: Interrupt) -> Self {
        // Draws nothing if standard error is no terminal.
        let bar = ProgressBar::new(TICKS);
        let style = ProgressStyle::with_template("{prefix:.bold} {bar:24.cyan/black.dim} {msg}");
        if let Ok(style) = style {
            bar.set_style(style.progress_chars("━━─"));
        }
        bar.set_prefix(name.to_owned());
        bar.set_message("waiting for the device");
        Self {
            bar,
            interrupt,
            log: None,
            began: pace.map(|pace| (Instant::now(), pace)),
            after_ms: 0,
            pages: Vec::new(),
            recorders: Vec::new(),
        }
    }

    /// Prints what the robot does and why, as it comes.
    pub(super) fn log(&mut self, is_on: bool) {
        self.log = is_on.then(MissionLog::new);
    }

    /// Counts the pace from this simulated time on, milliseconds: what is before is made again.
    pub(super) const fn begin_after(&mut self, time_ms: u32) {
        self.after_ms = time_ms;
    }

    /// Lets the live page of each robot see the run, and keep its pace.
    pub(super) fn show(&mut self, pages: Vec<Observer>) {
        self.pages = pages;
        self.began = self.began.filter(|_| self.pages.is_empty());
    }

    /// Records what is seen of each robot.
    pub(super) fn record(&mut self, recorders: Vec<Rc<Recorder>>) {
        self.recorders = recorders;
    }

    /// Returns the live pages.
    pub(super) fn pages(&mut self) -> &mut [Observer] {
        &mut self.pages
    }

    /// Removes the line.
    pub(super) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

impl Watch for Onlooker {
    fn step(&mut self, progress: &Progress) -> Flow {
        self.bar
            .set_position((progress.coverage * TICKS as f64) as u64);
        self.bar.set_message(message(progress));
        let log = self.log.as_mut();
        if let Some(entry) = log.and_then(|it| it.note(&progress.estimate, &progress.command)) {
            self.bar.suspend(|| note(&entry.to_string()));
        }
        if let Some((began, pace)) = &mut self.began {
            let ahead_ms = progress.time_ms.saturating_sub(self.after_ms);
            if ahead_ms == 0 {
                *began = Instant::now();
            }
            let due = Duration::from_millis(ahead_ms.into()).div_f64(*pace);
            std::thread::sleep(due.saturating_sub(began.elapsed()));
        }
        if self.interrupt.pressed() {
            Flow::Interrupt
        } else {
            Flow::Continue
        }
    }

    fn see(&mut self, sight: &mut Sight<'_>) {
        self.see_robot(0, sight);
    }

    fn see_robot(&mut self, robot: usize, sight: &mut Sight<'_>) {
        if let Some(recorder) = self.recorders.get(robot) {
            recorder.see(sight);
        }
        if let Some(page) = self.pages.get_mut(robot) {
            page.see(sight);
        }
    }
}

/// The progress of a campaign: a bar on a terminal, a line now and then elsewhere.
pub(super) struct Trials {
    bar: ProgressBar,
    began: Instant,
    /// Trials that were there before.
    before: usize,
    done: usize,
    count: usize,
    said: Instant,
}

/// Least time between two lines where there is no terminal.
const SAY_EVERY: Duration = Duration::from_secs(30);

impl Trials {
    /// Makes the progress of `count` trials, of which `before` are done.
    pub(super) fn new(before: usize, count: usize) -> Self {
        let bar = ProgressBar::new(count as u64);
        let style = ProgressStyle::with_template("{pos} of {len} {bar:24.cyan/black.dim} {msg}");
        if let Ok(style) = style {
            bar.set_style(style.progress_chars("━━─"));
        }
        bar.set_position(before as u64);
        Self {
            bar,
            began: Instant::now(),
            before,
            done: before,
            count,
            said: Instant::now(),
        }
    }

    /// Shows that a trial finished.
    pub(super) fn finished(&mut self, name: &str) {
        self.done += 1;
        let (made, left) = (self.done - self.before, self.count - self.done);
        let left = self.began.elapsed().mul_f64(left as f64 / made as f64);
        let left = time_left(left);
        self.bar.set_position(self.done as u64);
        self.bar.set_message(format!("{left} left, last {name}"));
        if self.bar.is_hidden() && self.said.elapsed() >= SAY_EVERY {
            self.said = Instant::now();
            note(&format!(
                "{} of {} trials, {left} left, last {name}",
                self.done, self.count
            ));
        }
    }

    /// Prints a line above the bar.
    pub(super) fn note(&self, line: &str) {
        self.bar.suspend(|| note(line));
    }

    /// Removes the bar.
    pub(super) fn end(&self) {
        self.bar.finish_and_clear();
    }
}

/// Returns a time as hours, minutes and seconds.
fn time_left(time: Duration) -> String {
    let seconds = time.as_secs();
    match (seconds / 3_600, seconds / 60 % 60, seconds % 60) {
        (0, minutes, seconds) => format!("{minutes}:{seconds:02} min"),
        (hours, minutes, _) => format!("{hours}:{minutes:02} h"),
    }
}

fn message(progress: &Progress) -> String {
    format!(
        "{:5.1} % known  {:6.1} s  {:6.1} m  {}",
        progress.coverage * 100.0,
        f64::from(progress.time_ms) / 1000.0,
        progress.path_m,
        doing(progress)
    )
}

/// Returns the status, and loops if there are any.
fn doing(progress: &Progress) -> String {
    let mut words = wording::status(progress.command.status);
    let loops = progress.command.loops;
    if loops.closing {
        words += ", closing a loop";
    }
    for (count, what) in [(loops.closed, "closed"), (loops.given_up, "given up")] {
        if count > 0 {
            words += &format!(", {count} {what}");
        }
    }
    words
}

#[cfg(test)]
mod tests {
    use super::{message, time_left};
    use core::time::Duration;
    use fieldline_protocol::message::{Command, Loops, Status};
    use host_sim::report::tum::Stamped;
    use host_sim::trial::Progress;

    #[test]
    fn the_line_has_coverage_time_distance_and_status() {
        let progress = Progress {
            time_ms: 83_400,
            coverage: 0.4567,
            path_m: 31.26,
            estimate: Stamped::default(),
            command: Command {
                status: Status::Exploring,
                ..Command::default()
            },
        };
        assert_eq!(
            message(&progress),
            " 45.7 % known    83.4 s    31.3 m  exploring"
        );
        let loops = Loops {
            closing: true,
            closed: 0,
            given_up: 2,
        };
        let command = Command {
            loops,
            ..progress.command
        };
        let progress = Progress {
            command,
            ..progress
        };
        assert!(message(&progress).ends_with("m  exploring, closing a loop, 2 given up"));
    }

    #[test]
    fn the_time_left_is_in_minutes_or_hours() {
        assert_eq!(time_left(Duration::from_secs(65)), "1:05 min");
        assert_eq!(time_left(Duration::from_secs(7_500)), "2:05 h");
    }
}

//! The observer of a run: tells each step to the log, keeps the pace, passes requests on.
//!
//! After every third step the map is compared with what was told, tile by tile, if it changed, and
//! the scan goes into the history. The path is told when it changes, and so is what the robot does.
//! The newest scan lies beside the history.
//!
//! A robot that stands because a viewer said so is no faster than real time: the run's time limit
//! would else be over before anyone could say more.

use core::fmt;
use core::time::Duration;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;

use fieldline_protocol::message::NO_RETURN_MM;
use serde_json::json;

use super::Shared;
use super::frame::{self, Kind};
use crate::link::inside::{Inside, Key};
use crate::report::Report;
use crate::report::mission_log::MissionLog;
use crate::trial::planned_path::PlannedPath;
use crate::trial::sight::{Sight, request_words};
use crate::trial::{Flow, Progress, Watch, wording};

/// Steps from one look at the map to the next, and from one scan of the history to the next.
const LOOK_STEPS: usize = 3;
/// Longest wait without a look at the interrupt key.
const BLINK: Duration = Duration::from_millis(50);

/// What a run is, for the page's title.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct About {
    /// Name of the world.
    pub world: String,
    /// Name of the strategy.
    pub strategy: String,
    /// The link.
    pub link: String,
    /// Seed of the run.
    pub seed: u64,
}

/// Watches a run for the live page.
pub struct Observer {
    shared: Arc<Shared>,
    about: About,
    interrupted: Box<dyn Fn() -> bool + Send>,
    /// The pace while nobody is connected.
    pace: f64,
    /// When the last step was let go.
    let_go: Instant,
    steps: usize,
    told: Told,
}

/// What the page knows.
#[derive(Debug, Default)]
struct Told {
    edits: Option<u32>,
    tiles: BTreeMap<Key, [u8; 256]>,
    skeletons: BTreeMap<Key, [u16; 16]>,
    path: PlannedPath,
    goals: Vec<[f64; 2]>,
    status: String,
    mission: MissionLog,
}

impl fmt::Debug for Observer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut out = f.debug_struct("Observer");
        out.field("about", &self.about).finish_non_exhaustive()
    }
}

impl Watch for Observer {
    fn step(&mut self, _: &Progress) -> Flow {
        Flow::Continue
    }

    fn see(&mut self, sight: &mut Sight<'_>) {
        self.tell(sight);
        self.wait(sight);
    }
}

impl Observer {
    pub(super) fn new(
        shared: Arc<Shared>,
        about: About,
        pace: f64,
        interrupted: impl Fn() -> bool + Send + 'static,
    ) -> Self {
        shared.log().begin();
        shared.desk.set_runs(true);
        Self {
            shared,
            about,
            interrupted: Box::new(interrupted),
            pace,
            let_go: Instant::now(),
            steps: 0,
            told: Told::default(),
        }
    }

    /// Tells the end of the run.
    pub fn end(&mut self, report: &Report) {
        let outcome = &report.outcome;
        self.finish(&json!({
            "status": outcome.status,
            "reason": outcome.reason,
            "headline": report.headline(),
            "short": report.in_short(),
            "text": report.to_text(),
            "digest": report.digest,
            "known": report.coverage.fraction,
            "requests": report.live_requests.len(),
            "left": outcome.residual_frontiers,
        }));
    }

    /// Tells the end of a session that was made again.
    pub fn end_again(&mut self, text: &str) {
        let headline = text.lines().next().unwrap_or_default();
        self.finish(&json!({
            "status": "finished", "reason": "replayed", "headline": headline, "short": "",
            "text": text, "digest": "", "known": 1.0, "requests": 0, "left": [],
        }));
    }

    /// Tells that the run failed before it had a report.
    pub fn fail(&mut self, why: &str) {
        self.finish(&json!({
            "status": "fault", "reason": "no-run", "headline": why, "short": "", "text": why,
            "digest": "", "known": 0.0, "requests": 0, "left": [],
        }));
    }

    fn finish(&mut self, end: &serde_json::Value) {
        self.shared.desk.set_runs(false);
        let mut out = Vec::new();
        frame::json(&mut out, Kind::End, end);
        self.shared.log().push(&out);
    }

    fn tell(&mut self, sight: &Sight<'_>) {
        let Some(step) = sight.step() else {
            return;
        };
        let mut out = Vec::with_capacity(512);
        if self.steps == 0 {
            self.tell_run(&mut out, sight);
        }
        let status = wording::status(step.command.status);
        if status != self.told.status {
            frame::record(&mut out, Kind::Status, status.as_bytes());
            self.told.status = status;
        }
        if let Some(entry) = self.told.mission.note(&step.estimate, &step.command) {
            frame::json(&mut out, Kind::Doing, &entry);
        }
        let inside = sight.inside();
        let is_last = sight.ending.is_some();
        if self.steps.is_multiple_of(LOOK_STEPS) || is_last {
            if let Some(inside) = &inside {
                self.told.tell_skeleton(&mut out, inside.as_ref());
            }
            let edits = sight.map_edits();
            if edits.is_some() && edits != self.told.edits {
                self.told.edits = edits;
                self.told.tell_tiles(&mut out, sight.map_tiles());
            }
        }
        if let Some(inside) = &inside {
            self.told.tell_path(&mut out, inside.as_ref());
        }
        let record = sight.record();
        let localises = sight.setup.start.localise;
        frame::step(&mut out, step, localises, record.coverage, record.path_m);
        let mut scan = Vec::new();
        if let Some(level) = sight.observation.scans.first() {
            frame::scan(&mut scan, &level.ranges_mm);
        }
        if self.steps.is_multiple_of(LOOK_STEPS) || is_last {
            out.extend_from_slice(&scan);
        }
        self.steps += 1;
        let mut log = self.shared.log();
        log.push(&out);
        log.set_newest(&scan);
    }

    fn tell_run(&self, out: &mut Vec<u8>, sight: &Sight<'_>) {
        let start = &sight.setup.start;
        let laser = start.lasers.first().copied().unwrap_or_default();
        let polygons = start.fence.polygons.iter();
        let mut corners = start.fence.corners.iter();
        let fence: Vec<_> = polygons
            .map(|polygon| {
                let own = corners.by_ref().take(polygon.corners.into());
                let own = own.map(|(x, y)| [x.to_num::<f64>(), y.to_num()]);
                json!({ "bounds": polygon.bounds, "corners": own.collect::<Vec<_>>() })
            })
            .collect();
        let run = json!({
            "world": self.about.world,
            "strategy": self.about.strategy,
            "link": self.about.link,
            "seed": self.about.seed,
            "period_ms": start.period_ms,
            "limit_ms": sight.setup.time_limit_ms,
            "hull_m": [f64::from(start.hull.length_mm) / 1e3, f64::from(start.hull.width_mm) / 1e3],
            "laser": {
                "x": laser.x.to_num::<f64>(),
                "y": laser.y.to_num::<f64>(),
                "first": laser.first_bearing.to_num::<f64>(),
                "step": laser.bearing_step.to_num::<f64>(),
                "limit_mm": laser.range_limit_mm,
                "no_return_mm": NO_RETURN_MM,
            },
            "uneven": start.uneven_ground.is_some(),
            "inside": sight.inside().is_some(),
            "again": sight.again,
            "fence": fence,
        });
        frame::json(out, Kind::Run, &run);
    }

    /// Passes requests on, and waits as long as the pace and the held clock want.
    fn wait(&mut self, sight: &mut Sight<'_>) {
        let shared = Arc::clone(&self.shared);
        loop {
            self.pass_on(sight);
            let goes_on = sight.ending.is_some() || shared.viewers() == 0 || (self.interrupted)();
            if goes_on || !shared.desk.holds() {
                break;
            }
            shared.desk.wait(BLINK);
        }
        let period_s = f64::from(sight.setup.start.period_ms) / 1000.0;
        while sight.ending.is_none() && !(self.interrupted)() {
            let factor = match shared.viewers() {
                0 => self.pace,
                _ if sight.waits() => match shared.desk.pace().factor {
                    factor if factor > 0.0 => factor.min(1.0),
                    _ => 1.0,
                },
                _ => shared.desk.pace().factor,
            };
            if factor <= 0.0 {
                break;
            }
            let due = self.let_go + Duration::from_secs_f64(period_s / factor);
            let left = due.saturating_duration_since(Instant::now());
            if left.is_zero() {
                break;
            }
            shared.desk.wait(left.min(BLINK));
            self.pass_on(sight);
        }
        self.let_go = Instant::now();
    }

    fn pass_on(&mut self, sight: &mut Sight<'_>) {
        while let Some(request) = self.shared.desk.next() {
            let answer = sight.request(&request.control);
            let time_ms = sight.step().map_or(0, |step| step.truth.time_ms);
            let note = json!({
                "time_ms": time_ms,
                "viewer": request.viewer,
                "request": request_words(&request.control),
                "done": answer.is_ok(),
                "answer": match &answer {
                    Ok(status) => wording::status(*status),
                    Err(error) => error.to_string(),
                },
            });
            let mut out = Vec::new();
            frame::json(&mut out, Kind::Note, &note);
            self.shared.log().push(&out);
        }
    }
}

impl Told {
    fn tell_skeleton(&mut self, out: &mut Vec<u8>, inside: &dyn Inside) {
        for key in inside.tiles() {
            let rows = inside.skeleton(key);
            let before = self.skeletons.entry(key).or_default();
            if *before != rows {
                frame::skeleton(out, key, &rows);
                *before = rows;
            }
        }
    }

    /// Tells what changed. A tile that is there no more is unknown.
    fn tell_tiles(&mut self, out: &mut Vec<u8>, now: BTreeMap<Key, [u8; 256]>) {
        let mut before = core::mem::take(&mut self.tiles);
        for (key, cells) in now {
            frame::rows(out, key, &before.remove(&key).unwrap_or([0; 256]), &cells);
            self.tiles.insert(key, cells);
        }
        for (key, cells) in before {
            frame::rows(out, key, &cells, &[0; 256]);
        }
    }

    fn tell_path(&mut self, out: &mut Vec<u8>, inside: &dyn Inside) {
        let (path, goals) = (inside.path(), inside.local_goal());
        if path != self.path || goals != self.goals {
            frame::path(out, &path, &goals);
            (self.path, self.goals) = (path, goals);
        }
    }
}

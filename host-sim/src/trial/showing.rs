//! Shows a watcher a session that is made again: that of a log, or of a recording.
//!
//! Nobody knows the true pose then, and nothing is measured by it. In the record odometry's pose
//! stands in its place, and the share of the session that is over in place of the coverage;
//! [`Sight::again`] tells so.

use core::time::Duration;

use fieldline_protocol::message::{Command, Observation, Start};

use super::itinerary::Orders;
use super::mirror::Mirror;
use super::record::stamped;
use super::sight::Sight;
use super::{Ending, Flow, Record, Setup, Step, Watch};
use crate::link::Link;

/// A session that is shown.
#[derive(Debug)]
pub struct Showing {
    setup: Setup,
    record: Record,
    mirror: Option<Mirror>,
    /// Observations of the session.
    steps: usize,
}

impl Showing {
    /// Begins to show a session of so many observations. With `copies` the host keeps a copy of the
    /// map, for a device that lives elsewhere.
    #[must_use]
    pub fn new(start: &Start, steps: usize, copies: bool) -> Self {
        Self {
            setup: Setup {
                start: start.clone(),
                time_limit_ms: u32::MAX,
                check_field: false,
                snapshots: 0,
                resumes: false,
                orders: Orders::default(),
                corrects: false,
                known: None,
            },
            record: Record::default(),
            mirror: copies.then(|| Mirror::new(start)),
            steps,
        }
    }

    /// Shows a step. Returns the watcher's answer.
    pub fn step(
        &mut self,
        (observation, command): (&Observation, &Command),
        took: Duration,
        link: &mut dyn Link,
        watch: &mut dyn Watch,
    ) -> Flow {
        if let Some(mirror) = &mut self.mirror {
            mirror.observe(observation, command.status);
        }
        let odometry = stamped(observation.time_ms, &observation.pose);
        let round_trip_us = took.as_secs_f64() * 1e6;
        let step = Step::new(observation, odometry, *command, round_trip_us);
        let number = self.record.steps.len() + 1;
        self.record.push(step, number as f64 / self.steps as f64);
        let answer = watch.step(&self.record.progress());
        let is_last = number >= self.steps || answer == Flow::Interrupt;
        watch.see(&mut Sight {
            setup: &self.setup,
            observation,
            mirror: self.mirror.as_ref(),
            ending: is_last.then_some(&Ending::TimeLimit),
            again: true,
            record: &mut self.record,
            itinerary: None,
            link,
        });
        answer
    }
}

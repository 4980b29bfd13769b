//! `explore --record FILE.mcap`: a run in one file that everyone's tools read, and that a device
//! does again.
//!
//! ```text
//! run ─► Watch::see(Sight) ─► topics.rs ─► messages of ROS 2 (ros.rs) ─┐
//! run ─► Tap ─► link                                                   ├─► chunks ─► FILE.mcap
//!         └──► requests and answers (exchange.rs) ─────────────────────┘
//! ```
//!
//! | topic | message | when |
//! | --- | --- | --- |
//! | `/scan`, `/scan_2` | `sensor_msgs/LaserScan` | each step |
//! | `/odom`, `/tf`, `/cmd_vel`, `/coverage` | `nav_msgs/Odometry` and others | each step |
//! | `/pose`, `/true_pose` | `geometry_msgs/PoseStamped` | each step |
//! | `/tf_static` | where the lasers are | first |
//! | `/map` | `nav_msgs/OccupancyGrid` | if it changed, each 5 s, and last |
//! | `/field` | `nav_msgs/OccupancyGrid`, 100 at the goal | each second |
//! | `/plan` | `nav_msgs/Path` | each second, if it changed |
//! | `/status` | `std_msgs/String` | if it changed |
//! | `/rosout` | `rcl_interfaces/Log` | the mission's log |
//! | `/fieldline/request`, `/fieldline/reply` | the session (`exchange.rs`) | each |
//! | `/fieldline/step` | the answer to an observation as JSON, for people | each |
//!
//! Invariants: a look changes nothing, so a recorded run has the digest of the same run without.
//! Each [`CHUNK_MS`] of simulated time a chunk is written whole, so a file that is cut has all
//! before it. If the file cannot be written any more the run goes on, and says so.
//!
//! Units: simulated time as nanoseconds since 1970; metres, radians.

mod definitions;
mod exchange;
mod ros;
mod tap;
mod topics;

use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

use fieldline_protocol::SCHEMA;
use fieldline_protocol::message::{Reply, Request};
use mcap::records::{MessageHeader, Metadata};
use mcap::{Attachment, Compression, WriteOptions, Writer};
use serde::Serialize;

pub use exchange::{Exchange, Exchanges, ReadError, Replayed, Told, is_recording, read, replay};
pub use tap::Tap;

use crate::report::MadeBy;
use crate::trial::sight::Sight;
use ros::Message;
use topics::Topics;

/// Simulated time of a chunk, milliseconds.
pub const CHUNK_MS: u32 = 10_000;
/// Level of the compression, of twelve: twice the file of level 9 is not worth half its time.
const LEVEL: u32 = 1;
/// Topics of the session.
const REQUESTS: &str = "/fieldline/request";
const REPLIES: &str = "/fieldline/reply";
/// Topic of the answers to observations, for people.
const STEPS: &str = "/fieldline/step";
/// Name of the metadata that tells what made the run.
const MADE_BY: &str = "fieldline";
/// Key in it of the schema of the requests.
const SCHEMA_KEY: &str = "schema";

/// A recording of a run.
#[expect(missing_debug_implementations, reason = "the writer has none")]
pub struct Recording {
    /// `None` once it failed.
    writer: Option<Writer<BufWriter<File>>>,
    failure: Option<String>,
    channels: BTreeMap<&'static str, u16>,
    sequence: u32,
    time_ms: u32,
    /// Time of the last whole chunk.
    whole_ms: u32,
    topics: Topics,
}

impl Recording {
    /// Begins a file, and replaces one that is there.
    ///
    /// # Errors
    /// If the system cannot make it.
    pub fn create(path: &Path, made_by: &MadeBy) -> std::io::Result<Self> {
        let file = BufWriter::new(File::create(path)?);
        let options = WriteOptions::new()
            .profile("ros2")
            .library(format!("fieldline host-sim {}", made_by.version))
            .compression(Some(Compression::Lz4))
            .compression_level(LEVEL)
            .chunk_size(None)
            // A chunk goes to the file whole, so that a cut loses no earlier one.
            .disable_seeking(true);
        let mut writer = Writer::with_options(file, options).map_err(std::io::Error::other)?;
        let mut told: BTreeMap<String, String> = made_by.options.clone();
        told.insert("version".into(), made_by.version.clone());
        told.insert(SCHEMA_KEY.into(), format!("{SCHEMA:#010x}"));
        told.insert("command_line".into(), made_by.command_line.join(" "));
        told.insert("robot".into(), made_by.robot.clone());
        let metadata = Metadata {
            name: MADE_BY.into(),
            metadata: told,
        };
        let begun = writer.write_metadata(&metadata);
        begun.map_err(std::io::Error::other)?;
        Ok(Self {
            writer: Some(writer),
            failure: None,
            channels: BTreeMap::new(),
            sequence: 0,
            time_ms: 0,
            whole_ms: 0,
            topics: Topics::default(),
        })
    }

    /// Records what is seen of a step.
    pub fn see(&mut self, sight: &Sight<'_>) {
        let mut topics = core::mem::take(&mut self.topics);
        topics.tell(sight, self);
        self.topics = topics;
        if self.time_ms.wrapping_sub(self.whole_ms) >= CHUNK_MS {
            self.whole_ms = self.time_ms;
            self.write(|writer| writer.flush());
        }
    }

    /// Records the report, and ends the file. Returns why it is not whole, if it is not.
    pub fn end(&mut self, report: Option<&impl Serialize>) -> Option<String> {
        if let Some(report) = report {
            let data = serde_json::to_vec_pretty(report).unwrap_or_default();
            let log_time = self.nanoseconds();
            self.write(|writer| {
                writer.attach(&Attachment {
                    log_time,
                    create_time: log_time,
                    name: "report.json".into(),
                    media_type: "application/json".into(),
                    data: data.into(),
                })
            });
        }
        self.write(|writer| writer.finish().map(|_| ()));
        self.writer = None;
        self.failure.take()
    }

    /// Sets the simulated time of what comes.
    const fn set_time(&mut self, time_ms: u32) {
        self.time_ms = time_ms;
    }

    fn nanoseconds(&self) -> u64 {
        u64::from(self.time_ms) * 1_000_000
    }

    /// Records a request and its answer.
    fn exchange(&mut self, request: &Request, told: &Told) {
        if let Request::Observation(observation) = request {
            self.set_time(observation.time_ms);
        }
        // Everything that is asked and told can be written.
        let (asked, answer) = (postcard::to_allocvec(request), postcard::to_allocvec(told));
        self.plain(REQUESTS, "postcard", &asked.unwrap_or_default());
        self.plain(REPLIES, "postcard", &answer.unwrap_or_default());
        if let Told::Reply(reply) = told
            && let Reply::Command(command) = reply.as_ref()
        {
            let step = serde_json::to_vec(command);
            self.plain(STEPS, "json", &step.unwrap_or_default());
        }
    }

    /// Records a message of ROS 2.
    fn tell<M: Message>(&mut self, topic: &'static str, message: &M) {
        let Some(data) = ros::bytes(message) else {
            return;
        };
        self.message(topic, &data, |writer| {
            let schema = definitions::schema(M::NAME).unwrap_or_default();
            let schema = writer.add_schema(M::NAME, "ros2msg", schema.as_bytes())?;
            writer.add_channel(schema, topic, "cdr", &BTreeMap::new())
        });
    }

    /// Records a message without a schema.
    fn plain(&mut self, topic: &'static str, encoding: &str, data: &[u8]) {
        self.message(topic, data, |writer| {
            writer.add_channel(0, topic, encoding, &BTreeMap::new())
        });
    }

    fn message(
        &mut self,
        topic: &'static str,
        data: &[u8],
        add: impl FnOnce(&mut Writer<BufWriter<File>>) -> mcap::McapResult<u16>,
    ) {
        let time = self.nanoseconds();
        self.sequence = self.sequence.wrapping_add(1);
        let (sequence, known) = (self.sequence, self.channels.get(topic).copied());
        let channel = self.write(|writer| {
            let channel_id = known.map_or_else(|| add(writer), Ok)?;
            let header = MessageHeader {
                channel_id,
                sequence,
                log_time: time,
                publish_time: time,
            };
            writer.write_to_known_channel(&header, data)?;
            Ok(channel_id)
        });
        if let Some(channel) = channel {
            self.channels.insert(topic, channel);
        }
    }

    /// Does something with the file. What fails ends the recording, and not the run.
    fn write<T>(
        &mut self,
        deed: impl FnOnce(&mut Writer<BufWriter<File>>) -> mcap::McapResult<T>,
    ) -> Option<T> {
        let done = deed(self.writer.as_mut()?);
        match done {
            Ok(done) => Some(done),
            Err(error) => {
                let at_s = f64::from(self.time_ms) / 1000.0;
                self.failure = Some(format!("{error}; the recording ends at {at_s} s"));
                self.writer = None;
                None
            }
        }
    }
}

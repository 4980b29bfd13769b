//! The requests and answers of a recording, as its file has them, and the device made to do them
//! again.
//!
//! ```text
//! /fieldline/request   a request as postcard
//! /fieldline/reply     its answer as postcard: the reply, or why there is none (Told)
//! ```
//!
//! Each request is followed by its answer. A file that was cut has them up to the cut. Postcard
//! keeps every bit. The decimals of JSON would not: of the 65,536 fractions of a quantity with 16
//! bits, `fixed` prints eight so that they are read one bit off.

use core::time::Duration;
use std::path::Path;
use std::time::Instant;

use fieldline_protocol::SCHEMA;
use fieldline_protocol::message::{Control, Reply, Request};
use mcap::read::{LinearReader, Options};
use mcap::records::Record;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::{MADE_BY, REPLIES, REQUESTS, SCHEMA_KEY};
use crate::link::digest::Digest;
use crate::link::{Link, LinkError};
use crate::trial::showing::Showing;
use crate::trial::{Flow, Watch};

/// The first bytes of a recording.
const MAGIC: &[u8] = b"\x89MCAP0\r\n";

/// An answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Told {
    /// The device's.
    Reply(Box<Reply>),
    /// The device refused, for this reason.
    Refused(String),
    /// The link failed, for this reason.
    Failed(String),
}

/// A request and its answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Exchange {
    /// Simulated milliseconds.
    pub time_ms: u32,
    /// The request.
    pub request: Request,
    /// The answer.
    pub told: Told,
}

/// The requests and answers of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Exchanges {
    /// In their order.
    pub list: Vec<Exchange>,
    /// The file ends before its end: it was cut, or its run was killed.
    pub is_cut: bool,
}

impl Exchange {
    /// Returns true if it is a deed of the device. A reboot, or a broken line, is none.
    const fn is_carried(&self) -> bool {
        !matches!(self.told, Told::Failed(_))
    }
}

impl Exchanges {
    /// Returns the number of requests that the recorded link carried.
    #[must_use]
    pub fn requests(&self) -> usize {
        let carried = self.list.iter().filter(|it| it.is_carried());
        carried.count()
    }

    /// Returns the number of observations.
    #[must_use]
    pub fn steps(&self) -> usize {
        let requests = self.list.iter().map(|it| &it.request);
        let observations = requests.filter(|it| matches!(it, Request::Observation(_)));
        observations.count()
    }
}

/// Why a file is no recording.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum ReadError {
    /// It cannot be read.
    #[error("{0}")]
    File(String),
    /// It has no session.
    #[error(
        "there is no request of a session in it; name a file that `host-sim explore --record` wrote"
    )]
    NoSession,
    /// Its requests are those of another version.
    #[error(
        "its requests have the schema {0}, and those of this program {SCHEMA:#010x}; replay it \
         with the version that recorded it"
    )]
    Schema(String),
    /// A message is none that this program knows.
    #[error("message {at} of {topic}: {what}; the file is damaged")]
    Message {
        /// Its topic.
        topic: String,
        /// Its number on the topic, from 0.
        at: usize,
        /// What is wrong.
        what: String,
    },
}

/// Returns true if a file begins as an MCAP file does.
#[must_use]
pub fn is_recording(path: &Path) -> bool {
    use std::io::Read as _;
    let mut head = [0; MAGIC.len()];
    let file = std::fs::File::open(path);
    file.is_ok_and(|mut file| file.read_exact(&mut head).is_ok()) && head == MAGIC
}

/// Reads the requests and answers of a file, up to its end or to where it was cut.
///
/// # Errors
/// [`ReadError`].
pub fn read(path: &Path) -> Result<Exchanges, ReadError> {
    let bytes = std::fs::read(path).map_err(|error| ReadError::File(error.to_string()))?;
    check_schema(&bytes)?;
    let messages = mcap::MessageStream::new_with_options(&bytes, Options::IgnoreEndMagic.into())
        .map_err(|error| ReadError::File(error.to_string()))?;
    let mut exchanges = Exchanges {
        is_cut: !bytes.ends_with(MAGIC),
        ..Exchanges::default()
    };
    let mut open: Option<(u32, Request)> = None;
    for message in messages {
        // What is behind the cut cannot be read.
        let Ok(message) = message else {
            exchanges.is_cut = true;
            break;
        };
        let at = exchanges.list.len();
        let topic = &message.channel.topic;
        let wrong = |what: String| ReadError::Message {
            topic: topic.clone(),
            at,
            what,
        };
        if topic == REQUESTS {
            let request = postcard::from_bytes(&message.data);
            let request = request.map_err(|it| wrong(it.to_string()))?;
            let time_ms = u32::try_from(message.log_time / 1_000_000).unwrap_or(u32::MAX);
            open = Some((time_ms, request));
        } else if topic == REPLIES
            && let Some((time_ms, request)) = open.take()
        {
            let told = postcard::from_bytes(&message.data);
            let told = told.map_err(|it| wrong(it.to_string()))?;
            exchanges.list.push(Exchange {
                time_ms,
                request,
                told,
            });
        }
    }
    if exchanges.list.is_empty() {
        return Err(ReadError::NoSession);
    }
    Ok(exchanges)
}

/// Refuses requests of another version.
fn check_schema(bytes: &[u8]) -> Result<(), ReadError> {
    let records = LinearReader::new_with_options(bytes, Options::IgnoreEndMagic.into())
        .map_err(|error| ReadError::File(error.to_string()))?;
    let made_by = records
        .map_while(Result::ok)
        .find_map(|record| match record {
            Record::Metadata(found) if found.name == MADE_BY => Some(found.metadata),
            _ => None,
        });
    let schema = made_by.and_then(|mut told| told.remove(SCHEMA_KEY));
    let schema = schema.ok_or(ReadError::NoSession)?;
    if schema == format!("{SCHEMA:#010x}") {
        return Ok(());
    }
    Err(ReadError::Schema(schema))
}

/// What a device did with the requests of a recording.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Replayed {
    /// Number of requests.
    pub requests: usize,
    /// Number of commands.
    pub commands: usize,
    /// Digest of the recorded commands.
    #[serde(serialize_with = "as_text")]
    pub recorded: Digest,
    /// Digest of the commands now.
    #[serde(serialize_with = "as_text")]
    pub now: Digest,
    /// Simulated milliseconds of the first answer that differs.
    pub differs_at_ms: Option<u32>,
}

fn as_text<S: serde::Serializer>(digest: &Digest, to: S) -> Result<S::Ok, S::Error> {
    to.collect_str(digest)
}

impl Replayed {
    /// Returns true if two replies are the same. Of commands the digest counts: costs and counters
    /// of a link are not the device's deed.
    fn agrees(&mut self, before: &Reply, now: &Reply) -> bool {
        let (Reply::Command(before), Reply::Command(now)) = (before, now) else {
            return before == now;
        };
        self.commands += 1;
        self.recorded.add(before);
        self.now.add(now);
        self.recorded == self.now
    }

    /// Returns true if the device did what it did before.
    #[must_use]
    pub fn is_same(&self) -> bool {
        self.differs_at_ms.is_none() && self.recorded == self.now
    }
}

/// Makes the requests of a recording again, and shows the steps. It ends with the first answer that
/// differs, or when the watcher says so.
///
/// # Errors
/// As [`LinkError`], where the recorded link did not fail.
pub fn replay(
    exchanges: &Exchanges,
    link: &mut dyn Link,
    watch: &mut dyn Watch,
) -> Result<Replayed, LinkError> {
    let mut replayed = Replayed::default();
    let mut showing = None;
    link.hello()?;
    for exchange in &exchanges.list {
        if !exchange.is_carried() {
            continue;
        }
        replayed.requests += 1;
        let (asked, answer) = (Instant::now(), link.ask(&exchange.request));
        if let Ok(reply) = &answer {
            let step = (&exchange.request, reply);
            let flow = show(
                &mut showing,
                exchanges,
                step,
                asked.elapsed(),
                (link, watch),
            );
            if flow == Flow::Interrupt {
                break;
            }
        }
        let same = match (&exchange.told, answer) {
            (Told::Reply(before), Ok(now)) => replayed.agrees(before, &now),
            (Told::Refused(_), Err(LinkError::Refused(_))) => true,
            (_, Ok(_) | Err(LinkError::Refused(_))) => false,
            (_, Err(error)) => return Err(error),
        };
        if !same {
            replayed.differs_at_ms = Some(exchange.time_ms);
            break;
        }
    }
    Ok(replayed)
}

/// Shows a step; a session begins with its start.
fn show(
    showing: &mut Option<Showing>,
    exchanges: &Exchanges,
    step: (&Request, &Reply),
    took: Duration,
    (link, watch): (&mut dyn Link, &mut dyn Watch),
) -> Flow {
    match (step, showing.as_mut()) {
        ((Request::Control(Control::Start(start)), _), _) => {
            *showing = Some(Showing::new(start, exchanges.steps(), false));
        }
        ((Request::Observation(observation), Reply::Command(command)), Some(showing)) => {
            return showing.step((observation, command), took, link, watch);
        }
        _ => {}
    }
    Flow::Continue
}

#[cfg(test)]
mod tests {
    use fieldline_protocol::message::{Command, Observation, Pose, Reply, Request, Status};
    use fixed::types::I16F16;

    use super::{Exchange, ReadError, Told, read};
    use crate::recording::Recording;
    use crate::report::MadeBy;

    /// Records these exchanges; returns what is read of the file.
    fn through_a_file(exchanges: &[Exchange]) -> Vec<Exchange> {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("run.mcap");
        let mut recording = Recording::create(&path, &MadeBy::default()).expect("a file");
        for it in exchanges {
            recording.exchange(&it.request, &it.told);
        }
        assert_eq!(recording.end(None::<&()>), None);
        let read = read(&path).expect("a recording");
        assert!(!read.is_cut);
        read.list
    }

    #[test]
    fn every_bit_of_a_request_and_of_its_answer_is_kept() {
        // Among these is 5.0999908, which `fixed` prints as 5.1.
        let fractions = (0..65_536).step_by(7).chain([6_553]);
        let mut exchanges: Vec<Exchange> = fractions
            .map(|fraction| {
                let number = I16F16::from_bits(5 << 16 | fraction);
                let pose = Pose {
                    x: number,
                    ..Pose::default()
                };
                let command = Command {
                    heading: number,
                    ..Command::default()
                };
                Exchange {
                    time_ms: 0,
                    request: Request::Observation(Observation {
                        pose,
                        ..Observation::default()
                    }),
                    told: Told::Reply(Box::new(Reply::Command(command))),
                }
            })
            .collect();
        for told in [
            Told::Reply(Box::new(Reply::Control(Status::Exploring))),
            Told::Refused("no session".into()),
            Told::Failed("silence".into()),
        ] {
            exchanges.push(Exchange {
                time_ms: 0,
                request: Request::Say,
                told,
            });
        }
        assert!(through_a_file(&exchanges) == exchanges);
    }

    #[test]
    fn a_file_without_a_session_is_none() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("run.mcap");
        let recording = Recording::create(&path, &MadeBy::default());
        assert_eq!(recording.expect("a file").end(None::<&()>), None);
        assert_eq!(read(&path), Err(ReadError::NoSession));
        assert!(matches!(read(folder.path()), Err(ReadError::File(_))));
    }
}

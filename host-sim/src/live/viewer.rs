//! One viewer: a websocket, a cursor in the history, and what it asks for.
//!
//! A viewer is sent what it lacks at most about 30 times a second, at most a chunk at a time. One
//! that takes nothing, or answers no ping, is dropped. One that breaks the protocol or sends more
//! than it may is dropped too. Nobody else notices.

use core::sync::atomic::Ordering;
use core::time::Duration;
use std::io::ErrorKind;
use std::net::TcpStream;
use std::time::Instant;

use serde_json::json;
use tungstenite::error::Error;
use tungstenite::protocol::{Message, Role, WebSocketConfig};
use tungstenite::{Bytes, WebSocket};

use super::control::{Ask, Pace};
use super::log::Cursor;
use super::{Shared, count};

/// Time between two looks at the history: how long a read waits.
const TURN: Duration = Duration::from_millis(30);

/// Why a viewer goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Leave {
    /// It closed, or its connection broke.
    Gone,
    /// It broke the protocol.
    Broke,
    /// It did not take what it was sent.
    Slow,
    /// The program ends.
    Over,
}

struct Viewer<'a> {
    socket: WebSocket<TcpStream>,
    shared: &'a Shared,
    number: u64,
    cursor: Cursor,
    newest: u64,
    told: Option<(Pace, u64)>,
    /// The last sign of life, and the last ping.
    heard: Instant,
    pinged: Instant,
    /// Messages since a moment.
    messages: (Instant, u32),
}

/// Serves a viewer whose handshake is done, until it goes.
pub(super) fn serve(stream: TcpStream, shared: &Shared) {
    let limits = &shared.limits;
    if stream.set_read_timeout(Some(TURN)).is_err()
        || stream.set_write_timeout(Some(limits.patience)).is_err()
    {
        return;
    }
    let config = WebSocketConfig::default()
        .read_buffer_size(4 * 1024)
        .max_message_size(Some(limits.message_bytes))
        .max_frame_size(Some(limits.message_bytes));
    let tally = &shared.tally;
    tally.viewers.fetch_add(1, Ordering::Relaxed);
    let mut viewer = Viewer {
        socket: WebSocket::from_raw_socket(stream, Role::Server, Some(config)),
        shared,
        number: tally.came.fetch_add(1, Ordering::Relaxed) + 1,
        cursor: Cursor::default(),
        newest: 0,
        told: None,
        heard: Instant::now(),
        pinged: Instant::now(),
        messages: (Instant::now(), 0),
    };
    let leave = viewer.stay();
    tally.viewers.fetch_sub(1, Ordering::Relaxed);
    match leave {
        Leave::Gone => {}
        Leave::Broke => count(&tally.broken),
        Leave::Slow => count(&tally.dropped),
        Leave::Over => {
            let _ = viewer.socket.close(None);
            let _ = viewer.socket.flush();
        }
    }
}

impl Viewer<'_> {
    fn stay(&mut self) -> Leave {
        loop {
            let turn = self.hear().and_then(|()| self.tell());
            if let Err(leave) = turn {
                return leave;
            }
            if self.shared.is_closing() {
                // What is left of the history first.
                return match self.tell() {
                    Ok(()) => Leave::Over,
                    Err(leave) => leave,
                };
            }
        }
    }

    /// Reads what came; waits a turn if nothing did.
    fn hear(&mut self) -> Result<(), Leave> {
        match self.socket.read() {
            Ok(message) => {
                self.heard = Instant::now();
                match message {
                    Message::Text(text) => self.ask(text.as_str()),
                    Message::Binary(_) => Err(Leave::Broke),
                    Message::Close(_) => Err(Leave::Gone),
                    _ => Ok(()),
                }
            }
            Err(Error::Io(error)) if is_wait(error.kind()) => Ok(()),
            Err(Error::Capacity(_) | Error::Protocol(_) | Error::Utf8(_)) => {
                let _ = self.socket.close(None);
                Err(Leave::Broke)
            }
            Err(_) => Err(Leave::Gone),
        }
    }

    fn ask(&mut self, text: &str) -> Result<(), Leave> {
        let (since, number) = &mut self.messages;
        if since.elapsed() >= Duration::from_secs(1) {
            (*since, *number) = (Instant::now(), 0);
        }
        *number += 1;
        let answer = if *number > self.shared.limits.messages_a_second {
            Err("too many messages in a second".into())
        } else {
            serde_json::from_str::<Ask>(text)
                .map_err(|error| format!("not a message of this page: {error}"))
                .and_then(|ask| self.shared.desk.take(self.number, ask))
        };
        let Err(reason) = answer else {
            return Ok(());
        };
        count(&self.shared.tally.refused);
        self.send(Message::text(json!({ "refused": reason }).to_string()))
    }

    /// Sends what the viewer lacks, and a ping now and then.
    fn tell(&mut self) -> Result<(), Leave> {
        let about = (self.shared.desk.pace(), self.shared.viewers());
        if self.told != Some(about) {
            self.told = Some(about);
            let (pace, viewers) = about;
            let text = json!({ "pace": pace, "viewers": viewers, "you": self.number });
            self.send(Message::text(text.to_string()))?;
        }
        // In a block of their own, so that the lock is not held while something is sent.
        let (part, newest) = {
            let log = self.shared.log();
            let part = log.read(&mut self.cursor);
            (part, log.newest(&mut self.newest))
        };
        if let Some(part) = part {
            self.send_records(u8::from(part.is_anew), &part.bytes)?;
        }
        if let Some(records) = newest {
            self.send_records(2, &records)?;
        }
        let patience = self.shared.limits.patience;
        if self.heard.elapsed() > patience {
            return Err(Leave::Slow);
        }
        if self.pinged.elapsed() > patience / 4 {
            self.pinged = Instant::now();
            self.send(Message::Ping(Bytes::new()))?;
        }
        Ok(())
    }

    fn send_records(&mut self, how: u8, records: &[u8]) -> Result<(), Leave> {
        let mut bytes = Vec::with_capacity(1 + records.len());
        bytes.push(how);
        bytes.extend_from_slice(records);
        self.send(Message::binary(bytes))
    }

    fn send(&mut self, message: Message) -> Result<(), Leave> {
        match self.socket.send(message) {
            Ok(()) => Ok(()),
            Err(Error::Io(error)) if is_wait(error.kind()) => Err(Leave::Slow),
            Err(_) => Err(Leave::Gone),
        }
    }
}

/// Returns true if a read or write only waited too long.
fn is_wait(kind: ErrorKind) -> bool {
    matches!(
        kind,
        ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted
    )
}

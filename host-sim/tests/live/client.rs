//! A viewer as a program: a websocket, and what it was told.

use core::net::SocketAddr;
use core::time::Duration;
use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::time::Instant;

use std::collections::BTreeMap;

use serde_json::Value;
use tungstenite::handshake::client::generate_key;
use tungstenite::http::Request;
use tungstenite::{Message, WebSocket};

/// Longest wait for anything.
const PATIENCE: Duration = Duration::from_secs(60);

/// What a viewer was told.
#[derive(Debug, Default)]
pub(crate) struct Told {
    /// Bytes of the history.
    pub(crate) history: Vec<u8>,
    /// Time, believed x and y, true x and y, known share of each step.
    pub(crate) steps: Vec<[f64; 6]>,
    /// The cells of each tile, two bits each.
    pub(crate) tiles: BTreeMap<(i16, i16), [u8; 256]>,
    /// Statuses, in order.
    pub(crate) statuses: Vec<String>,
    /// What the robot does, and why.
    pub(crate) doings: Vec<Value>,
    /// Requests and answers.
    pub(crate) notes: Vec<Value>,
    /// Number of path records with a cell, of skeletons with a cell, of scans.
    pub(crate) seen: [usize; 3],
    /// What was refused.
    pub(crate) refused: Vec<String>,
    /// The end.
    pub(crate) end: Option<Value>,
    /// The run.
    pub(crate) run: Option<Value>,
}

/// A viewer.
pub(crate) struct Viewer {
    pub(crate) socket: WebSocket<TcpStream>,
    pub(crate) told: Told,
}

/// Asks for the websocket. Returns the status if it is refused.
pub(crate) fn knock(
    address: SocketAddr,
    query: &str,
    origin: &str,
) -> Result<WebSocket<TcpStream>, u16> {
    let stream = TcpStream::connect(address).expect("a connection");
    stream.set_read_timeout(Some(PATIENCE)).expect("a timeout");
    let url = format!("ws://{address}/ws{query}");
    let request = request(&url, address, Some(origin));
    match tungstenite::client::client(request, stream) {
        Ok((socket, _)) => Ok(socket),
        Err(tungstenite::HandshakeError::Failure(tungstenite::Error::Http(response))) => {
            Err(response.status().as_u16())
        }
        Err(error) => panic!("{error}"),
    }
}

/// Returns the request of a websocket.
pub(crate) fn request(url: &str, address: SocketAddr, origin: Option<&str>) -> Request<()> {
    let request = Request::get(url)
        .header("Host", address.to_string())
        .header("Connection", "Upgrade")
        .header("Upgrade", "websocket")
        .header("Sec-WebSocket-Version", "13")
        .header("Sec-WebSocket-Key", generate_key());
    let request = match origin {
        Some(origin) => request.header("Origin", origin),
        None => request,
    };
    request.body(()).expect("a request")
}

/// Sends a request and returns the body of the answer, which has a stated length.
pub(crate) fn say_whole(address: SocketAddr, text: &str) -> String {
    let mut stream = TcpStream::connect(address).expect("a connection");
    stream.set_read_timeout(Some(PATIENCE)).expect("a timeout");
    stream.write_all(text.as_bytes()).expect("sent");
    let (mut answer, mut part) = (Vec::new(), [0; 4096]);
    loop {
        let length = stream.read(&mut part).expect("an answer");
        answer.extend_from_slice(&part[..length]);
        let said = String::from_utf8_lossy(&answer).into_owned();
        let Some((head, body)) = said.split_once("\r\n\r\n") else {
            assert!(length > 0, "no whole answer");
            continue;
        };
        let head = head.to_ascii_lowercase();
        let stated = head
            .lines()
            .find_map(|line| line.strip_prefix("content-length:"));
        let stated: usize = stated.expect("a length").trim().parse().expect("a number");
        if body.len() >= stated || length == 0 {
            return body.into();
        }
    }
}

/// Sends bytes and returns all that is answered.
pub(crate) fn say(address: SocketAddr, text: &str) -> String {
    let mut stream = TcpStream::connect(address).expect("a connection");
    stream.set_read_timeout(Some(PATIENCE)).expect("a timeout");
    stream.write_all(text.as_bytes()).expect("sent");
    let mut answer = Vec::new();
    // A connection that is reset has said what it had to say.
    let _ = stream.read_to_end(&mut answer);
    String::from_utf8_lossy(&answer).into_owned()
}

impl Viewer {
    /// Comes by the page's own address.
    pub(crate) fn come(address: SocketAddr) -> Self {
        let socket = knock(address, "", &format!("http://{address}")).expect("let in");
        Self {
            socket,
            told: Told::default(),
        }
    }

    /// Sends a message.
    pub(crate) fn ask(&mut self, message: &str) {
        self.socket.send(Message::text(message)).expect("sent");
    }

    /// Reads until something holds.
    pub(crate) fn until(&mut self, what: &str, mut holds: impl FnMut(&Told) -> bool) -> &Told {
        let begun = Instant::now();
        while !holds(&self.told) {
            assert!(
                begun.elapsed() < PATIENCE,
                "no {what}: {:?}",
                self.told.statuses
            );
            self.read();
        }
        &self.told
    }

    /// Reads until the run has ended.
    pub(crate) fn until_end(&mut self) -> &Told {
        self.until("end", |told| told.end.is_some())
    }

    fn read(&mut self) {
        match self.socket.read().expect("a message") {
            Message::Binary(bytes) => self.told.take(&bytes),
            Message::Text(text) => {
                let text: Value = serde_json::from_str(&text).expect("JSON");
                self.told
                    .refused
                    .extend(text["refused"].as_str().map(String::from));
            }
            _ => {}
        }
    }
}

impl Told {
    fn take(&mut self, bytes: &[u8]) {
        let (how, records) = bytes.split_first().expect("a first byte");
        match how {
            0 => {}
            1 => *self = Self::default(),
            _ => return,
        }
        self.history.extend_from_slice(records);
        let mut rest = records;
        while let Some((head, after)) = rest.split_first_chunk::<5>() {
            let length = u32::from_le_bytes([head[1], head[2], head[3], head[4]]) as usize;
            self.enter(head[0], &after[..length]);
            rest = &after[length..];
        }
    }

    fn enter(&mut self, kind: u8, bytes: &[u8]) {
        let float =
            |at: usize| f64::from(f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()));
        let short = |at: usize| i16::from_le_bytes([bytes[at], bytes[at + 1]]);
        let json = || serde_json::from_slice::<Value>(bytes).expect("JSON");
        match kind {
            1 => self.run = Some(json()),
            2 => {
                let time_ms = u32::from_le_bytes(bytes[..4].try_into().unwrap());
                let places = [4, 8, 16, 20, 36].map(float);
                let [x, y, true_x, true_y, known] = places;
                self.steps
                    .push([f64::from(time_ms), x, y, true_x, true_y, known]);
            }
            3 => self
                .statuses
                .push(String::from_utf8(bytes.to_vec()).unwrap()),
            4 => {
                let tile = self.tiles.entry((short(0), short(2))).or_insert([0; 256]);
                let mask = u32::from_le_bytes(bytes[4..8].try_into().unwrap());
                let rows = (0..32).filter(|row| mask >> row & 1 == 1);
                for (row, cells) in rows.zip(bytes[8..].chunks_exact(8)) {
                    tile[8 * row..8 * row + 8].copy_from_slice(cells);
                }
            }
            5 => self.seen[1] += usize::from(bytes[4..].iter().any(|byte| *byte != 0)),
            6 => self.seen[2] += 1,
            7 => self.seen[0] += usize::from(bytes.len() > 3),
            8 => self.notes.push(json()),
            9 => self.end = Some(json()),
            10 => self.doings.push(json()),
            other => panic!("a record of kind {other}"),
        }
    }
}

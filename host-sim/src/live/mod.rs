//! The live page: a run in a browser while it runs, with its time line, pace and buttons.
//!
//! ```text
//!  run thread                       shared                      one thread a connection
//!  ──────────                       ──────                      ───────────────────────
//!  Observer::see ── records ─────►  Log (history, bounded) ◄──── Viewer: cursor, websocket out
//!        ▲                          newest scan                        │
//!        └──────── requests ──────  Desk (pace, bounded queue) ◄───────┘ websocket in
//!
//!  acceptor thread: counts connections, starts a thread for each, refuses the rest
//! ```
//!
//! **The run waits for no viewer.** It appends a few hundred bytes a step under a lock that is held
//! for microseconds. Viewers copy from the log and send without the lock. It waits only where it
//! was asked to: for the pace, or while the clock is held and someone is connected.
//!
//! **A look changes nothing.** The observer reads a device in this process through
//! [`crate::link::inside`], else the host's copy of the map. So the digest of a run is the same
//! with any number of viewers, until one makes a request of the device.
//!
//! **Messages.** To the page: binary, first byte 0 for the next records of the history, 1 for all
//! records anew, 2 for the newest scan, which is no part of the history; records as in `frame.rs`.
//! Text, JSON: the pace and the number of viewers, when they change; or `{"refused": why}`. From
//! the page: text, JSON, as in `control.rs`.
//!
//! **Who may come in** is in `gate.rs`; the limits are [`Limits`]. What is refused is counted.

mod control;
mod frame;
mod gate;
mod log;
mod observer;
mod page;
mod server;
mod viewer;

use core::net::{IpAddr, Ipv4Addr, SocketAddr};
use core::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use core::time::Duration;
use std::io;
use std::net::UdpSocket;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use serde::Serialize;

pub use control::Ask;
use control::Desk;
pub use frame::Kind;
use log::Log;
pub use observer::{About, Observer};
use server::Server;

/// The usual address.
pub const ADDRESS: SocketAddr = SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), 8047);

/// Longest wait for viewers at the end.
const FAREWELL: Duration = Duration::from_millis(500);

/// Bytes of the token's randomness.
const TOKEN_BYTES: usize = 16;

/// What a connection may take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Connections at a time; more get status 503.
    pub connections: usize,
    /// Bytes of a request's head.
    pub head_bytes: usize,
    /// Time for a request's head to come, and for a page to be taken.
    pub head: Duration,
    /// Bytes of a message of a viewer.
    pub message_bytes: usize,
    /// Messages of a viewer in a second; more are refused.
    pub messages_a_second: u32,
    /// Time for a viewer to take what it is sent, and to answer a ping.
    pub patience: Duration,
    /// Bytes of the history of a run.
    pub history_bytes: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            connections: 32,
            head_bytes: 8 * 1024,
            head: Duration::from_secs(5),
            message_bytes: 4 * 1024,
            messages_a_second: 50,
            patience: Duration::from_secs(20),
            history_bytes: 64 * 1024 * 1024,
        }
    }
}

/// What came so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Counts {
    /// Viewers that are connected now.
    pub viewers: u64,
    /// Viewers that ever came.
    pub came: u64,
    /// Connections beyond the limit.
    pub too_many: u64,
    /// Requests without a right to come in, or that were none.
    pub turned_away: u64,
    /// Requests whose head did not come in time or was too long.
    pub slow_heads: u64,
    /// Viewers that broke the protocol, or sent too much at once.
    pub broken: u64,
    /// Viewers that did not take what they were sent.
    pub dropped: u64,
    /// Messages that were refused.
    pub refused: u64,
}

#[derive(Debug, Default)]
struct Tally {
    viewers: AtomicU64,
    came: AtomicU64,
    too_many: AtomicU64,
    turned_away: AtomicU64,
    slow_heads: AtomicU64,
    broken: AtomicU64,
    dropped: AtomicU64,
    refused: AtomicU64,
}

/// What the threads share.
#[derive(Debug)]
struct Shared {
    log: Mutex<Log>,
    desk: Desk,
    tally: Tally,
    limits: Limits,
    token: Option<String>,
    closing: AtomicBool,
}

impl Shared {
    fn log(&self) -> MutexGuard<'_, Log> {
        // A thread that panicked left whole records behind.
        self.log.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn is_closing(&self) -> bool {
        self.closing.load(Ordering::Relaxed)
    }

    fn viewers(&self) -> u64 {
        self.tally.viewers.load(Ordering::Relaxed)
    }
}

fn count(counter: &AtomicU64) {
    counter.fetch_add(1, Ordering::Relaxed);
}

/// The server of a live page. It ends when this is dropped.
#[derive(Debug)]
pub struct Live {
    shared: Arc<Shared>,
    server: Server,
    pace: f64,
}

impl Live {
    /// Listens at an address, with a token unless that is loopback. The simulation is no faster
    /// than `pace`, in simulated seconds a second, until a viewer says otherwise; 0 is no limit.
    ///
    /// # Errors
    /// The address cannot be listened at, or the system has no random numbers for the token.
    pub fn open(address: SocketAddr, pace: f64, limits: Limits) -> io::Result<Self> {
        let token = match address.ip().is_loopback() {
            true => None,
            false => Some(token()?),
        };
        let shared = Arc::new(Shared {
            log: Mutex::new(Log::new(limits.history_bytes)),
            desk: Desk::new(pace),
            tally: Tally::default(),
            limits,
            token,
            closing: AtomicBool::new(false),
        });
        let server = Server::open(address, Arc::clone(&shared))?;
        Ok(Self {
            shared,
            server,
            pace,
        })
    }

    /// As [`Live::open`], at a free port if another program has this one.
    ///
    /// # Errors
    /// As [`Live::open`].
    pub fn open_near(address: SocketAddr, pace: f64, limits: Limits) -> io::Result<Self> {
        Self::open(address, pace, limits)
            .or_else(|_| Self::open(SocketAddr::new(address.ip(), 0), pace, limits))
    }

    /// Returns where it listens.
    #[must_use]
    pub const fn address(&self) -> SocketAddr {
        self.server.address()
    }

    /// Returns the page's address, with the token if there is one.
    #[must_use]
    pub fn url(&self) -> String {
        let mut address = self.address();
        if address.ip().is_unspecified() {
            address.set_ip(own_address(address.ip()).unwrap_or(address.ip()));
        }
        match &self.shared.token {
            None => format!("http://{address}/"),
            Some(token) => format!("http://{address}/?token={token}"),
        }
    }

    /// Begins another run: returns what watches it. Pages forget the last one. `interrupted` tells
    /// if the run is to end, while it waits for its pace.
    #[must_use]
    pub fn observer(
        &self,
        about: About,
        interrupted: impl Fn() -> bool + Send + 'static,
    ) -> Observer {
        Observer::new(Arc::clone(&self.shared), about, self.pace, interrupted)
    }

    /// Asks for something as a viewer with number 0 does: for the pace, before anyone has come.
    ///
    /// # Errors
    /// Why it is refused.
    pub fn ask(&self, ask: Ask) -> Result<(), String> {
        self.shared.desk.take(0, ask)
    }

    /// Returns what came so far.
    #[must_use]
    pub fn counts(&self) -> Counts {
        let tally = &self.shared.tally;
        let of = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
        Counts {
            viewers: of(&tally.viewers),
            came: of(&tally.came),
            too_many: of(&tally.too_many),
            turned_away: of(&tally.turned_away),
            slow_heads: of(&tally.slow_heads),
            broken: of(&tally.broken),
            dropped: of(&tally.dropped),
            refused: of(&tally.refused),
        }
    }

    /// Keeps pages after the last run: until nobody has been connected to any for `linger`, or
    /// `interrupted` says so.
    pub fn stay(pages: &[Self], linger: Duration, interrupted: impl Fn() -> bool) {
        let mut seen = Instant::now();
        while !interrupted() {
            if pages.iter().any(|page| page.shared.viewers() > 0) {
                seen = Instant::now();
            } else if seen.elapsed() >= linger {
                return;
            }
            std::thread::sleep(Duration::from_millis(50).min(linger));
        }
    }
}

impl Drop for Live {
    fn drop(&mut self) {
        self.shared.closing.store(true, Ordering::Relaxed);
        self.server.close();
        // Viewers get what they lack, if they take it at once.
        let begun = Instant::now();
        while self.shared.viewers() > 0 && begun.elapsed() < FAREWELL {
            std::thread::sleep(Duration::from_millis(5));
        }
    }
}

/// Makes a token: 32 hexadecimal digits.
fn token() -> io::Result<String> {
    let mut bytes = [0; TOKEN_BYTES];
    getrandom::fill(&mut bytes).map_err(|error| io::Error::other(error.to_string()))?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

/// Returns the address from which this machine would speak to others. Nothing is sent.
fn own_address(any: IpAddr) -> Option<IpAddr> {
    // Addresses for documentation: they lead to the usual way out.
    let far = match any {
        IpAddr::V4(_) => "192.0.2.1:9",
        IpAddr::V6(_) => "[2001:db8::1]:9",
    };
    let socket = UdpSocket::bind((any, 0)).ok()?;
    socket.connect(far).ok()?;
    Some(socket.local_addr().ok()?.ip())
}

//! The acceptor, and what a connection is given: the page, a websocket, or a refusal.
//!
//! A connection has one thread, one request, and a limit on everything: head, time, number.

use core::net::{Ipv4Addr, Ipv6Addr, SocketAddr};
use core::sync::atomic::{AtomicUsize, Ordering};
use core::time::Duration;
use std::io::{self, Read as _, Write as _};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::Arc;
use std::thread::{Builder, JoinHandle};
use std::time::Instant;

use tungstenite::handshake::machine::TryParse as _;
use tungstenite::handshake::server::{Request, create_response, write_response};
use tungstenite::http::StatusCode;

use super::gate::{self, Pass};
use super::page::{HEADERS, PAGE};
use super::{Shared, count, viewer};

/// The acceptor.
#[derive(Debug)]
pub(super) struct Server {
    address: SocketAddr,
    acceptor: Option<JoinHandle<()>>,
}

impl Server {
    /// Listens.
    pub(super) fn open(address: SocketAddr, shared: Arc<Shared>) -> io::Result<Self> {
        let listener = TcpListener::bind(address)?;
        let address = listener.local_addr()?;
        let accept = move || accept(&listener, &shared);
        let acceptor = Builder::new().name("live".into()).spawn(accept)?;
        Ok(Self {
            address,
            acceptor: Some(acceptor),
        })
    }

    /// Returns where it listens.
    pub(super) const fn address(&self) -> SocketAddr {
        self.address
    }

    /// Ends the acceptor, which must have been told that it is closing. A connection of its own
    /// wakes it.
    pub(super) fn close(&mut self) {
        let mut own = self.address;
        if own.ip().is_unspecified() {
            own.set_ip(match own {
                SocketAddr::V4(_) => Ipv4Addr::LOCALHOST.into(),
                SocketAddr::V6(_) => Ipv6Addr::LOCALHOST.into(),
            });
        }
        let woken = TcpStream::connect_timeout(&own, Duration::from_secs(1)).is_ok();
        if let Some(acceptor) = self.acceptor.take().filter(|_| woken) {
            // It has nothing to tell.
            let _ = acceptor.join();
        }
    }
}

/// A place among the connections, given back when it is dropped.
struct Place(Arc<AtomicUsize>);

impl Place {
    fn take(all: &Arc<AtomicUsize>, most: usize) -> Option<Self> {
        let before = all.fetch_add(1, Ordering::Relaxed);
        let place = Self(Arc::clone(all));
        (before < most).then_some(place)
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

fn accept(listener: &TcpListener, shared: &Arc<Shared>) {
    let all = Arc::new(AtomicUsize::new(0));
    loop {
        let stream = listener.accept();
        if shared.is_closing() {
            return;
        }
        let Ok((stream, _)) = stream else {
            // Out of descriptors: those in use are given back.
            std::thread::sleep(Duration::from_millis(50));
            continue;
        };
        let Some(place) = Place::take(&all, shared.limits.connections) else {
            count(&shared.tally.too_many);
            turn_away(stream);
            continue;
        };
        let shared = Arc::clone(shared);
        let meet = move || {
            let _place = place;
            meet(stream, &shared);
        };
        // Without a thread the connection is closed.
        let _ = Builder::new().name("live-viewer".into()).spawn(meet);
    }
}

/// Answers a connection beyond the limit without waiting for it.
fn turn_away(mut stream: TcpStream) {
    let _ = stream.set_nonblocking(true);
    let _ = stream.write(answer(StatusCode::SERVICE_UNAVAILABLE).as_bytes());
}

/// Reads a request and answers it.
fn meet(mut stream: TcpStream, shared: &Shared) {
    let _ = stream.set_nodelay(true);
    let _ = stream.set_write_timeout(Some(shared.limits.head));
    let request = match read_head(&mut stream, shared) {
        Ok(request) => request,
        Err(status) => {
            count(match status {
                StatusCode::BAD_REQUEST => &shared.tally.turned_away,
                _ => &shared.tally.slow_heads,
            });
            return refuse(stream, status);
        }
    };
    match gate::judge(&request, shared.token.as_deref()) {
        Ok(Pass::Page) => {
            let head = format!(
                "HTTP/1.1 200 OK\r\nConnection: close\r\nCache-Control: no-store\r\n\
                 Content-Length: {}\r\n{HEADERS}\r\n",
                PAGE.len()
            );
            let _ = stream.write_all(head.as_bytes());
            let _ = stream.write_all(PAGE.as_bytes());
            let _ = stream.shutdown(Shutdown::Write);
        }
        Ok(Pass::Socket) => match create_response(&request) {
            Ok(response) => {
                if write_response(&mut stream, &response).is_ok() {
                    viewer::serve(stream, shared);
                }
            }
            Err(_) => {
                count(&shared.tally.turned_away);
                refuse(stream, StatusCode::BAD_REQUEST);
            }
        },
        Err(status) => {
            count(&shared.tally.turned_away);
            refuse(stream, status);
        }
    }
}

/// Reads the head of a request, no longer than it may be, no longer than it may take.
fn read_head(stream: &mut TcpStream, shared: &Shared) -> Result<Request, StatusCode> {
    let limits = &shared.limits;
    let deadline = Instant::now() + limits.head;
    let (mut head, mut part) = (Vec::new(), [0; 1024]);
    loop {
        let left = deadline.saturating_duration_since(Instant::now());
        if left.is_zero() || stream.set_read_timeout(Some(left)).is_err() {
            return Err(StatusCode::REQUEST_TIMEOUT);
        }
        let length = match stream.read(&mut part) {
            Ok(0) => return Err(StatusCode::BAD_REQUEST),
            Ok(length) => length,
            Err(_) => return Err(StatusCode::REQUEST_TIMEOUT),
        };
        head.extend_from_slice(part.get(..length).unwrap_or_default());
        if head.len() > limits.head_bytes {
            return Err(StatusCode::REQUEST_HEADER_FIELDS_TOO_LARGE);
        }
        match Request::try_parse(&head) {
            // A page says nothing more before it has its answer.
            Ok(Some((length, request))) if length == head.len() => return Ok(request),
            Ok(None) => {}
            Ok(Some(_)) | Err(_) => return Err(StatusCode::BAD_REQUEST),
        }
    }
}

fn answer(status: StatusCode) -> String {
    let reason = status.canonical_reason().unwrap_or_default();
    let text = match status {
        StatusCode::FORBIDDEN => "the address, its token or the page that asks is not this page's",
        StatusCode::SERVICE_UNAVAILABLE => "too many connections; close other pages",
        _ => reason,
    };
    format!(
        "HTTP/1.1 {} {reason}\r\nConnection: close\r\nContent-Type: text/plain\r\n\
         Content-Length: {}\r\n\r\n{text}\n",
        status.as_u16(),
        text.len() + 1
    )
}

fn refuse(mut stream: TcpStream, status: StatusCode) {
    let _ = stream.write_all(answer(status).as_bytes());
    let _ = stream.shutdown(Shutdown::Write);
    // What was not read yet would reset the connection before the answer is read.
    let _ = stream.set_read_timeout(Some(Duration::from_millis(200)));
    let mut rest = [0; 4096];
    for _ in 0..16 {
        if !matches!(stream.read(&mut rest), Ok(length) if length > 0) {
            break;
        }
    }
}

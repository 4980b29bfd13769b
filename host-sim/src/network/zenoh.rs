//! Datagrams of a team on a zenoh router, or between zenoh peers.
//!
//! ```text
//! fieldline/team/N    what robot N says, one datagram a sample
//! ```
//!
//! Each process publishes under its own number and subscribes to all. The bytes are those of the
//! UDP datagrams, with the same tag. So a fleet that has a router, or ROS 2 with `rmw_zenoh`,
//! carries them beside its own topics, and needs no port of its own. Nothing is a ROS message.
//!
//! Whoever may use the router counts as a peer; a key shuts others out. Multicast scouting is off:
//! only the configured locators are used. zenoh drops samples when a queue is full, as UDP does.

use core::fmt;

use zenoh::handlers::FifoChannelHandler;
use zenoh::pubsub::{Publisher, Subscriber};
use zenoh::sample::{Locality, Sample};
use zenoh::{Config, Session, Wait as _};

use super::carrier::{Arrived, Carrier};
use super::spec::TeamSpec;

/// What the keys of all teams begin with.
const PREFIX: &str = "fieldline/team";

/// Datagrams over zenoh.
pub struct Zenoh {
    publisher: Publisher<'static>,
    subscriber: Subscriber<FifoChannelHandler<Sample>>,
    /// The session ends with it.
    session: Session,
}

impl Zenoh {
    /// Opens a session. A router or peer that does not answer yet is tried again by itself.
    ///
    /// # Errors
    /// zenoh's error.
    pub fn open(spec: &TeamSpec) -> Result<Self, String> {
        let session = zenoh::open(config(spec)?).wait();
        let session = session.map_err(|error| error.to_string())?;
        let publisher = session
            .declare_publisher(format!("{PREFIX}/{}", spec.id))
            .allowed_destination(Locality::Remote)
            .wait()
            .map_err(|error| error.to_string())?;
        let subscriber = session
            .declare_subscriber(format!("{PREFIX}/*"))
            .wait()
            .map_err(|error| error.to_string())?;
        Ok(Self {
            publisher,
            subscriber,
            session,
        })
    }
}

/// Returns the session's configuration.
fn config(spec: &TeamSpec) -> Result<Config, String> {
    let list = |locator: &Option<String>| {
        let list: Vec<&String> = locator.iter().collect();
        serde_json::to_string(&list).map_err(|error| error.to_string())
    };
    let mut config = Config::default();
    let settings = [
        ("mode", "\"peer\"".to_owned()),
        ("connect/endpoints", list(&spec.zenoh)?),
        ("listen/endpoints", list(&spec.zenoh_listen)?),
        ("scouting/multicast/enabled", "false".to_owned()),
    ];
    for (name, value) in settings {
        let set = config.insert_json5(name, &value);
        set.map_err(|error| format!("{name}: {error}"))?;
    }
    Ok(config)
}

impl fmt::Debug for Zenoh {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let id = self.session.zid().to_string();
        f.debug_struct("Zenoh").field("id", &id).finish()
    }
}

impl Carrier for Zenoh {
    /// One sample serves all.
    fn send(&mut self, bytes: &[u8]) -> u64 {
        u64::from(self.publisher.put(bytes).wait().is_ok())
    }

    fn receive(&mut self) -> Option<Arrived> {
        let sample = self.subscriber.try_recv().ok()??;
        Some(Arrived {
            bytes: sample.payload().to_bytes().into_owned(),
            from: None,
            is_known: true,
        })
    }
}

#[cfg(test)]
mod tests {
    use core::time::Duration;
    use std::net::TcpListener;
    use std::time::Instant;

    use super::*;

    /// Two sessions of this process, of which the second connects to the first over loopback TCP.
    fn sessions() -> [Zenoh; 2] {
        let port = TcpListener::bind("127.0.0.1:0").and_then(|it| it.local_addr());
        let locator = format!("tcp/127.0.0.1:{}", port.expect("a port").port());
        let open = |text: String| Zenoh::open(&text.parse().expect("a place")).expect("a session");
        [
            open(format!("id=0,zenoh-listen={locator}")),
            open(format!("id=1,zenoh={locator}")),
        ]
    }

    /// Sends until something arrives, because what is said before a subscription is known is lost.
    fn pass(from: &mut Zenoh, to: &mut Zenoh, bytes: &[u8]) -> Arrived {
        let since = Instant::now();
        while since.elapsed() < Duration::from_secs(20) {
            assert_eq!(from.send(bytes), 1);
            std::thread::sleep(Duration::from_millis(20));
            if let Some(arrived) = to.receive() {
                return arrived;
            }
        }
        panic!("nothing arrived in 20 s");
    }

    #[test]
    fn two_sessions_hear_each_other_and_not_themselves() {
        let [mut one, mut other] = sessions();
        let bytes: Vec<u8> = (0..=255).collect();
        for _ in 0..2 {
            let arrived = pass(&mut one, &mut other, &bytes);
            assert_eq!((arrived.bytes, arrived.is_known), (bytes.clone(), true));
            core::mem::swap(&mut one, &mut other);
        }
        // Nothing that came back is its own, so only copies of what the other said may wait.
        let said_last = [7; 9];
        pass(&mut one, &mut other, &said_last);
        while let Some(arrived) = one.receive() {
            assert_ne!(arrived.bytes, said_last);
        }
    }
}

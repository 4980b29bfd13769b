//! A process's place in a team, as `id=2,bind=127.0.0.1:47002,peers=10.0.0.3:47003`.
//!
//! | word | meaning | default |
//! | --- | --- | --- |
//! | `id=N` | this robot's number, 0 to 7 | required |
//! | `bind=ADDRESS:PORT` | where it hears packets | `0.0.0.0:47000` and its number |
//! | `peers=A:P+B:P` | where the others hear packets | none |
//! | `find=GROUP:PORT` | IPv4 multicast group in which members find each other | none |
//! | `interface=ADDRESS` | the network card for the group | the system's choice |
//! | `zenoh=LOCATOR` | a zenoh router or peer, as in `tcp/10.0.0.1:7447`, instead of UDP | none |
//! | `zenoh-listen=LOCATOR` | where zenoh peers may connect | none |
//! | `key=FILE` | file with the team's key, 16 bytes or more | none |
//! | `pace=N` | simulated seconds in one second | 1 |

use core::fmt;
use core::net::{Ipv4Addr, SocketAddr, SocketAddrV4};
use core::str::FromStr;
use std::net::ToSocketAddrs as _;
use std::path::{Path, PathBuf};

use super::envelope::{Key, ROBOTS};

/// Port of robot 0 if none is given.
pub const PORT: u16 = 47_000;
/// Least length of a key, bytes.
pub const LEAST_KEY: usize = 16;
/// Greatest pace.
const MOST_PACE: f64 = 1e3;

/// A process's place in a team.
#[derive(Clone, Debug, PartialEq)]
pub struct TeamSpec {
    /// The robot's number.
    pub id: u8,
    /// Where it hears packets.
    pub bind: SocketAddr,
    /// Where the others hear packets.
    pub peers: Vec<SocketAddr>,
    /// Group in which members find each other.
    pub find: Option<SocketAddrV4>,
    /// The network card for the group.
    pub interface: Ipv4Addr,
    /// A zenoh router or peer to connect to.
    pub zenoh: Option<String>,
    /// Where zenoh peers may connect.
    pub zenoh_listen: Option<String>,
    /// File with the key.
    pub key: Option<PathBuf>,
    /// Simulated seconds in one second.
    pub pace: f64,
}

/// Why a specification is invalid.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TeamSpecError {
    /// `id` is missing.
    NoId,
    /// Nobody can be reached: none of `peers`, `find` and the zenoh words is given.
    NoPeers,
    /// Words of UDP stand beside words of zenoh.
    TwoCarriers,
    /// A word is not known.
    Unknown(String),
    /// A word is given twice.
    Twice(String),
    /// A value is not of its kind.
    Value {
        /// The word.
        word: String,
        /// What it must be.
        kind: &'static str,
    },
    /// The key cannot be read, or is too short.
    Key {
        /// The file.
        file: PathBuf,
        /// The reason.
        reason: String,
    },
}

impl fmt::Display for TeamSpecError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoId => f.write_str("the robot's number is missing; say id=0 to id=7"),
            Self::NoPeers => f.write_str(
                "nobody can be reached; say peers=ADDRESS:PORT+ADDRESS:PORT, \
                 or find=GROUP:PORT as in find=239.70.76.1:47100",
            ),
            Self::TwoCarriers => f.write_str(
                "packets go over UDP or over zenoh; \
                 leave bind, peers, find and interface out, or zenoh and zenoh-listen",
            ),
            Self::Unknown(word) => write!(
                f,
                "unknown word '{word}'; use id=N, bind=A:P, peers=A:P+A:P, find=GROUP:PORT, \
                 interface=A, zenoh=LOCATOR, zenoh-listen=LOCATOR, key=FILE, pace=N, \
                 separated by commas"
            ),
            Self::Twice(name) => write!(f, "'{name}' is given twice; keep one"),
            Self::Value { word, kind } => write!(f, "bad value in '{word}'; it must be {kind}"),
            Self::Key { file, reason } => {
                write!(
                    f,
                    "key {}: {reason}; give a file of {LEAST_KEY} bytes or more",
                    file.display()
                )
            }
        }
    }
}

impl core::error::Error for TeamSpecError {}

impl FromStr for TeamSpec {
    type Err = TeamSpecError;

    fn from_str(text: &str) -> Result<Self, TeamSpecError> {
        let mut words = Words::default();
        for word in text.split(',').map(str::trim).filter(|it| !it.is_empty()) {
            words.read(word)?;
        }
        let id = words.id.ok_or(TeamSpecError::NoId)?;
        let has_zenoh = words.zenoh.is_some() || words.zenoh_listen.is_some();
        if !has_zenoh && words.peers.is_none() && words.find.is_none() {
            return Err(TeamSpecError::NoPeers);
        }
        if has_zenoh && words.has_udp() {
            return Err(TeamSpecError::TwoCarriers);
        }
        let usual = SocketAddr::from((Ipv4Addr::UNSPECIFIED, PORT + u16::from(id)));
        Ok(Self {
            id,
            bind: words.bind.unwrap_or(usual),
            peers: words.peers.unwrap_or_default(),
            find: words.find,
            interface: words.interface.unwrap_or(Ipv4Addr::UNSPECIFIED),
            zenoh: words.zenoh,
            zenoh_listen: words.zenoh_listen,
            key: words.key,
            pace: words.pace.unwrap_or(1.0),
        })
    }
}

impl TeamSpec {
    /// Reads the key; no key if none is given. Spaces and newlines around it do not count.
    ///
    /// # Errors
    /// [`TeamSpecError::Key`].
    pub fn read_key(&self) -> Result<Key, TeamSpecError> {
        let Some(file) = &self.key else {
            return Ok(Key::default());
        };
        read_key(file).map_err(|reason| TeamSpecError::Key {
            file: file.clone(),
            reason,
        })
    }
}

fn read_key(file: &Path) -> Result<Key, String> {
    let bytes = std::fs::read(file).map_err(|error| error.to_string())?;
    let bytes = bytes.trim_ascii();
    if bytes.len() < LEAST_KEY {
        return Err(format!("it has only {} bytes", bytes.len()));
    }
    Ok(Key::new(bytes))
}

/// The words read so far.
#[derive(Default)]
struct Words {
    id: Option<u8>,
    bind: Option<SocketAddr>,
    peers: Option<Vec<SocketAddr>>,
    find: Option<SocketAddrV4>,
    interface: Option<Ipv4Addr>,
    zenoh: Option<String>,
    zenoh_listen: Option<String>,
    key: Option<PathBuf>,
    pace: Option<f64>,
}

impl Words {
    /// Returns true if a word of UDP was read.
    const fn has_udp(&self) -> bool {
        self.bind.is_some()
            || self.peers.is_some()
            || self.find.is_some()
            || self.interface.is_some()
    }

    fn read(&mut self, word: &str) -> Result<(), TeamSpecError> {
        let unknown = || TeamSpecError::Unknown(word.into());
        let (name, value) = word.split_once('=').ok_or_else(unknown)?;
        let (name, value) = (name.trim(), value.trim());
        let bad = |kind| TeamSpecError::Value {
            word: word.into(),
            kind,
        };
        let address = |text: &str| {
            let mut found = text.to_socket_addrs().ok()?;
            found.next()
        };
        const ADDRESS: &str = "an address and a port, as in 10.0.0.3:47003";
        let again = match name {
            "id" => {
                let id = value.parse().ok().filter(|id| usize::from(*id) < ROBOTS);
                let id = id.ok_or_else(|| bad("a number from 0 to 7"))?;
                self.id.replace(id).is_some()
            }
            "bind" => {
                let bind = address(value).ok_or_else(|| bad(ADDRESS))?;
                self.bind.replace(bind).is_some()
            }
            "peers" => {
                let peers: Option<Vec<SocketAddr>> = value.split('+').map(address).collect();
                let peers = peers.filter(|peers| peers.len() < ROBOTS);
                let peers = peers.ok_or_else(|| bad("up to 7 addresses with ports, A:P+B:P"))?;
                self.peers.replace(peers).is_some()
            }
            "find" => {
                let group = value.parse().ok();
                let group = group.filter(|group: &SocketAddrV4| group.ip().is_multicast());
                let kind = "an IPv4 multicast group and a port, as in 239.70.76.1:47100";
                self.find.replace(group.ok_or_else(|| bad(kind))?).is_some()
            }
            "interface" => {
                let card = value.parse().map_err(|_| bad("an IPv4 address"))?;
                self.interface.replace(card).is_some()
            }
            "zenoh" | "zenoh-listen" => {
                let kind = "a locator, as in tcp/10.0.0.1:7447";
                let locator = Some(value).filter(|it| it.starts_with("tcp/"));
                let locator = locator.ok_or_else(|| bad(kind))?.to_owned();
                let place = match name {
                    "zenoh" => &mut self.zenoh,
                    _ => &mut self.zenoh_listen,
                };
                place.replace(locator).is_some()
            }
            "key" => self.key.replace(PathBuf::from(value)).is_some(),
            "pace" => {
                let pace = value.parse().ok();
                let pace = pace.filter(|pace: &f64| (0.01..=MOST_PACE).contains(pace));
                let pace = pace.ok_or_else(|| bad("from 0.01 to 1000"))?;
                self.pace.replace(pace).is_some()
            }
            _ => return Err(unknown()),
        };
        if again {
            return Err(TeamSpecError::Twice(name.into()));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_specification_is_read() {
        let spec: TeamSpec = "id=2, bind=127.0.0.1:9000,peers=127.0.0.1:9001+127.0.0.1:9002,\
                              find=239.1.2.3:9100,interface=127.0.0.1,key=team.key,pace=4"
            .parse()
            .unwrap();
        assert_eq!((spec.id, spec.bind.port(), spec.peers.len()), (2, 9000, 2));
        assert_eq!(spec.find.map(|group| group.port()), Some(9100));
        assert_eq!((spec.interface, spec.pace), (Ipv4Addr::LOCALHOST, 4.0));
        let least: TeamSpec = "id=3,find=239.1.2.3:9100".parse().unwrap();
        assert_eq!((least.bind.port(), least.pace), (47_003, 1.0));
        assert!(!least.read_key().unwrap().is_secret());
    }

    #[test]
    fn zenoh_is_read_and_stands_alone() {
        let spec: TeamSpec = "id=1,zenoh=tcp/10.0.0.1:7447".parse().unwrap();
        assert_eq!(spec.zenoh.as_deref(), Some("tcp/10.0.0.1:7447"));
        let spec: TeamSpec = "id=1,zenoh-listen=tcp/127.0.0.1:7447".parse().unwrap();
        assert_eq!(spec.zenoh_listen.as_deref(), Some("tcp/127.0.0.1:7447"));
        for udp in ["peers=127.0.0.1:1", "find=239.1.2.3:9", "bind=127.0.0.1:1"] {
            let error = format!("id=1,zenoh=tcp/a:1,{udp}").parse::<TeamSpec>();
            assert_eq!(error.unwrap_err(), TeamSpecError::TwoCarriers, "{udp}");
        }
    }

    #[test]
    fn an_invalid_specification_is_named() {
        let error = |text: &str| text.parse::<TeamSpec>().unwrap_err();
        assert_eq!(error(""), TeamSpecError::NoId);
        assert_eq!(error("peers=127.0.0.1:1"), TeamSpecError::NoId);
        assert_eq!(error("id=1"), TeamSpecError::NoPeers);
        assert_eq!(error("id=1,id=2"), TeamSpecError::Twice("id".into()));
        assert_eq!(
            error("id=1,colour=2"),
            TeamSpecError::Unknown("colour=2".into())
        );
        assert_eq!(error("id"), TeamSpecError::Unknown("id".into()));
        for text in [
            "id=8",
            "bind=here",
            "peers=127.0.0.1",
            "find=10.0.0.1:9",
            "interface=x",
            "pace=0",
            "zenoh=10.0.0.1:7447",
        ] {
            assert!(matches!(error(text), TeamSpecError::Value { .. }), "{text}");
        }
    }

    #[test]
    fn a_key_that_is_missing_or_short_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("key");
        let text = format!("id=1,find=239.1.2.3:9,key={}", file.display());
        let spec: TeamSpec = text.parse().unwrap();
        assert!(
            spec.read_key()
                .unwrap_err()
                .to_string()
                .contains("16 bytes")
        );
        std::fs::write(&file, "short\n").unwrap();
        assert!(spec.read_key().unwrap_err().to_string().contains("only 5"));
        std::fs::write(&file, "0123456789abcdef\n").unwrap();
        assert!(spec.read_key().unwrap().is_secret());
    }
}

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

use core::net::{Ipv4Addr, SocketAddr, SocketAddrV4};
use core::str::FromStr;
use std::net::ToSocketAddrs as _;
use std::path::{Path, PathBuf};

use super::envelope::{Key, ROBOTS};
use crate::spec::{Form, SpecError, Word};

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

const FORM: Form = Form {
    what: "word",
    usage: "id=N, bind=A:P, peers=A:P+A:P, find=GROUP:PORT, interface=A, zenoh=LOCATOR, \
            zenoh-listen=LOCATOR, key=FILE, pace=N, separated by commas",
    repeated: "",
};

impl FromStr for TeamSpec {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, SpecError> {
        let mut words = Words::default();
        FORM.read(text, |word| words.read(word))?;
        let refuse = |reason: &str| Err(SpecError::new(reason));
        let Some(id) = words.id else {
            return refuse("the robot's number is missing; say id=0 to id=7");
        };
        let has_zenoh = words.zenoh.is_some() || words.zenoh_listen.is_some();
        if !has_zenoh && words.peers.is_none() && words.find.is_none() {
            return refuse(
                "nobody can be reached; say peers=ADDRESS:PORT+ADDRESS:PORT, \
                 or find=GROUP:PORT as in find=239.70.76.1:47100",
            );
        }
        if has_zenoh && words.has_udp() {
            return refuse(
                "packets go over UDP or over zenoh; \
                 leave bind, peers, find and interface out, or zenoh and zenoh-listen",
            );
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
    /// The key cannot be read, or is too short.
    pub fn read_key(&self) -> Result<Key, SpecError> {
        let Some(file) = &self.key else {
            return Ok(Key::default());
        };
        read_key(file).map_err(|reason| {
            let file = file.display();
            SpecError::new(format!(
                "key {file}: {reason}; give a file of {LEAST_KEY} bytes or more"
            ))
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

    fn read(&mut self, word: &Word<'_>) -> Result<(), SpecError> {
        let address = |text: &str| text.to_socket_addrs().ok()?.next();
        let locator = || {
            let is_locator = |it: &String| it.starts_with("tcp/");
            word.parse(is_locator, "a locator, as in tcp/10.0.0.1:7447")
                .map(Some)
        };
        match word.key.as_str() {
            "id=" => {
                let fits = |id: &u8| usize::from(*id) < ROBOTS;
                self.id = Some(word.parse(fits, "a number from 0 to 7")?);
            }
            "bind=" => {
                let must = "an address and a port, as in 10.0.0.3:47003";
                self.bind = Some(address(word.value).ok_or_else(|| word.bad(must))?);
            }
            "peers=" => {
                let peers: Option<Vec<SocketAddr>> = word.value.split('+').map(address).collect();
                let peers = peers.filter(|peers| peers.len() < ROBOTS);
                let must = "up to 7 addresses with ports, A:P+B:P";
                self.peers = Some(peers.ok_or_else(|| word.bad(must))?);
            }
            "find=" => {
                let must = "an IPv4 multicast group and a port, as in 239.70.76.1:47100";
                let fits = |group: &SocketAddrV4| group.ip().is_multicast();
                self.find = Some(word.parse(fits, must)?);
            }
            "interface=" => self.interface = Some(word.parse(|_| true, "an IPv4 address")?),
            "zenoh=" => self.zenoh = locator()?,
            "zenoh-listen=" => self.zenoh_listen = locator()?,
            "key=" => self.key = Some(PathBuf::from(word.value)),
            "pace=" => self.pace = Some(word.number(0.01..=MOST_PACE, "from 0.01 to 1000")?),
            _ => return Err(word.unknown()),
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
            assert!(
                error.unwrap_err().to_string().contains("UDP or over zenoh"),
                "{udp}"
            );
        }
    }

    #[test]
    fn an_invalid_specification_is_named() {
        let error = |text: &str| text.parse::<TeamSpec>().unwrap_err().to_string();
        for (text, words) in [
            ("", "no word is named; use id=N"),
            ("peers=127.0.0.1:1", "number is missing"),
            ("id=1", "nobody can be reached"),
            ("id=1,id=2", "'id' is given twice"),
            ("id=1,colour=2", "unknown word 'colour=2'"),
            ("id", "unknown word 'id'"),
        ] {
            assert!(error(text).contains(words), "{text}: {}", error(text));
        }
        for text in [
            "id=8",
            "bind=here",
            "peers=127.0.0.1",
            "find=10.0.0.1:9",
            "interface=x",
            "pace=0",
            "zenoh=10.0.0.1:7447",
        ] {
            let error = error(text);
            assert!(
                error.contains("bad value") && error.contains(text),
                "{error}"
            );
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

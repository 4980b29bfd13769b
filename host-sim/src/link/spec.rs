//! Links by name: `direct`, `loopback`, `qemu`, `serial:DEVICE[@BAUD]`.

use core::fmt;
use core::str::FromStr;
use std::path::{Path, PathBuf};

use fieldline_planner::Tuning;
use fieldline_protocol::BAUD;

use super::direct::Direct;
use super::endpoint::{Endpoint, RetryPolicy};
use super::fault::{Faults, Faulty};
#[cfg(unix)]
use super::image::image;
use super::line::Line;
use super::loopback::LocalDevice;
#[cfg(unix)]
use super::qemu;
use super::stream::fresh_nonce;
use super::{Link, LinkError, serial};
use crate::near;
use crate::spec::SpecError;

/// A link by name.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum LinkSpec {
    /// A function call of the pilot.
    Direct,
    /// Frames to a device in this process.
    #[default]
    Loopback,
    /// Frames to the emulated chip.
    Qemu,
    /// Frames over a serial port.
    Serial {
        /// The port.
        device: String,
        /// Baud rate, bits per second.
        baud: u32,
    },
}

impl FromStr for LinkSpec {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, SpecError> {
        let port = match text {
            "direct" => return Ok(Self::Direct),
            "loopback" => return Ok(Self::Loopback),
            "qemu" => return Ok(Self::Qemu),
            _ => text.strip_prefix("serial:"),
        };
        let port = port.ok_or_else(|| {
            SpecError::new(format!(
                "unknown link '{text}'; use direct, loopback, qemu or serial:DEVICE[@BAUD]{}",
                near::hint(text, ["direct", "loopback", "qemu", "serial"])
            ))
        })?;
        let (device, baud) = port.rsplit_once('@').unwrap_or((port, ""));
        if device.is_empty() {
            let reason = "the serial port is missing; use serial:DEVICE[@BAUD], as in \
                          serial:/dev/ttyUSB0";
            return Err(SpecError::new(reason));
        }
        let baud = match (port.contains('@'), baud.parse()) {
            (false, _) => BAUD,
            (true, Ok(baud)) if baud > 0 => baud,
            _ => {
                return Err(SpecError::new(format!(
                    "bad baud rate '{baud}'; leave it out to use the image's {BAUD}"
                )));
            }
        };
        Ok(Self::Serial {
            device: device.into(),
            baud,
        })
    }
}

impl fmt::Display for LinkSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Direct => f.write_str("direct"),
            Self::Loopback => f.write_str("loopback"),
            Self::Qemu => f.write_str("qemu"),
            Self::Serial { device, baud } => write!(f, "serial:{device}@{baud}"),
        }
    }
}

/// Options of an opened link.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Options {
    /// Faults to inject into the line.
    pub faults: Faults,
    /// Seed of the faults.
    pub seed: u64,
    /// True if the robot moves while the host waits for an answer.
    pub real_time: bool,
    /// The planner's tuned constants, for a direct link; the defaults if `None`.
    pub tuning: Option<&'static Tuning>,
    /// The plugin that counts the cycles of the emulated chip; none are counted without it.
    pub cycles: Option<&'static Path>,
    /// Where it keeps cycles by instruction ([`RawProfile`](super::profile::RawProfile)), if
    /// anywhere.
    pub profile: Option<PathBuf>,
}

impl LinkSpec {
    /// Opens the link.
    ///
    /// # Errors
    /// As [`LinkError`]. Faults on a direct link, which has no bytes, are [`LinkError::Io`].
    pub fn open(&self, options: &Options) -> Result<Box<dyn Link>, LinkError> {
        let policy = |lockstep: RetryPolicy| RetryPolicy {
            greeting: lockstep.greeting,
            ..if options.real_time {
                RetryPolicy::REAL_TIME
            } else {
                lockstep
            }
        };
        match self {
            Self::Direct if options.faults == Faults::default() => {
                let tuning = options.tuning.unwrap_or(&Tuning::DEFAULT);
                Ok(Box::new(Direct::tuned(tuning)))
            }
            Self::Direct => Err(LinkError::Io(
                "a direct link has no bytes for faults; use --link loopback with --fault".into(),
            )),
            Self::Loopback => Ok(end(LocalDevice::new(), RetryPolicy::VIRTUAL, 1, options)),
            #[cfg(unix)]
            Self::Qemu => {
                let line =
                    qemu::open_watched(&image()?, options.cycles, options.profile.as_deref())?;
                let policy = policy(RetryPolicy::LOCKSTEP);
                Ok(end(line, policy, fresh_nonce(), options))
            }
            #[cfg(not(unix))]
            Self::Qemu => Err(LinkError::Io(
                "this system has no Unix sockets for the emulator; \
                 use --link serial with QEMU's -serial option"
                    .into(),
            )),
            Self::Serial { device, baud } => {
                let line = serial::open_line(device, *baud)?;
                let policy = policy(RetryPolicy::SERIAL);
                Ok(end(line, policy, fresh_nonce(), options))
            }
        }
    }
}

fn end<L: Line + 'static>(
    line: L,
    policy: RetryPolicy,
    nonce: u32,
    options: &Options,
) -> Box<dyn Link> {
    if options.faults == Faults::default() {
        return Box::new(Endpoint::new(line, policy, nonce));
    }
    let faulty = Faulty::new(line, options.faults, options.seed);
    Box::new(Endpoint::new(faulty, policy, nonce))
}

#[cfg(test)]
mod tests {
    use fieldline_protocol::BAUD;

    use super::{LinkSpec, Options};
    use crate::link::LinkError;
    use crate::link::fault::Faults;
    use crate::spec::SpecError;

    fn port(device: &str, baud: u32) -> Result<LinkSpec, SpecError> {
        Ok(LinkSpec::Serial {
            device: device.into(),
            baud,
        })
    }

    #[test]
    fn names_are_read_and_written() {
        assert_eq!("direct".parse(), Ok(LinkSpec::Direct));
        assert_eq!("loopback".parse(), Ok(LinkSpec::Loopback));
        assert_eq!("qemu".parse(), Ok(LinkSpec::Qemu));
        assert_eq!("serial:/dev/ttyUSB0".parse(), port("/dev/ttyUSB0", BAUD));
        assert_eq!("serial:COM3@9600".parse(), port("COM3", 9600));
        let spec: LinkSpec = "serial:/dev/a@1@57600".parse().unwrap();
        assert_eq!(spec.to_string(), "serial:/dev/a@1@57600");
    }

    #[test]
    fn an_invalid_name_is_explained() {
        for (text, words) in [
            ("tcp", "unknown link 'tcp'"),
            ("loopbak", "did you mean loopback?"),
            ("", "unknown link ''"),
            ("serial:", "port is missing"),
            ("serial:@9600", "port is missing"),
            ("serial:/dev/a@fast", "bad baud rate 'fast'"),
            ("serial:/dev/a@0", "bad baud rate '0'"),
            ("serial:/dev/a@", "bad baud rate ''"),
        ] {
            let error = text.parse::<LinkSpec>().unwrap_err().to_string();
            assert!(error.contains(words), "{text}: {error}");
        }
    }

    #[test]
    fn a_direct_link_refuses_faults() {
        let options = Options {
            faults: Faults {
                drop: 0.1,
                ..Faults::default()
            },
            ..Options::default()
        };
        let error = LinkSpec::Direct.open(&options).err();
        assert!(matches!(error, Some(LinkError::Io(_))), "{error:?}");
    }
}

//! The serial link: a serial port, or a pty in its place.

use std::io::ErrorKind as IoKind;

use fieldline_protocol::BAUD;
use serialport::{ErrorKind, SerialPort};

use super::LinkError;
use super::endpoint::{Endpoint, RetryPolicy};
use super::stream::{POLL, Stream, fresh_nonce};

/// A serial line.
pub type SerialLine = Stream<Box<dyn SerialPort>>;

/// Opens `device` at `baud`, 8N1, no flow control.
///
/// # Errors
/// [`LinkError::Io`] naming the port and the remedy.
pub fn open_line(device: &str, baud: u32) -> Result<SerialLine, LinkError> {
    let port = serialport::new(device, baud)
        .timeout(POLL)
        .open()
        .map_err(|error| LinkError::Io(explain(device, &error)))?;
    // Bytes from before the port was opened are at most half a frame.
    let _ = port.clear(serialport::ClearBuffer::Input);
    Ok(Stream::new(port, device))
}

/// Opens the host's end on a serial port, in lockstep.
///
/// # Errors
/// As [`open_line`].
pub fn serial(device: &str, baud: u32) -> Result<Endpoint<SerialLine>, LinkError> {
    let line = open_line(device, baud)?;
    Ok(Endpoint::new(line, RetryPolicy::SERIAL, fresh_nonce()))
}

fn explain(device: &str, error: &serialport::Error) -> String {
    let there = std::path::Path::new(device).exists();
    let remedy = match error.kind() {
        // The library reports a port that another program locked as no device.
        ErrorKind::NoDevice if there => {
            "another program has it open; end that program first".into()
        }
        ErrorKind::NoDevice | ErrorKind::Io(IoKind::NotFound) => {
            format!("there may be no such port; {}", available())
        }
        ErrorKind::Io(IoKind::PermissionDenied) => {
            "you may not open it; add your user to its group (often dialout)".into()
        }
        ErrorKind::InvalidInput => {
            format!("it does not support that baud rate; the image uses {BAUD}")
        }
        _ => "check that it is a serial port and that no other program uses it".into(),
    };
    format!("cannot open serial port {device}: {error}; {remedy}")
}

fn available() -> String {
    let ports = serialport::available_ports().unwrap_or_default();
    if ports.is_empty() {
        return "no serial port is plugged in".into();
    }
    let names: Vec<_> = ports.into_iter().map(|port| port.port_name).collect();
    format!("there are {}", names.join(", "))
}

#[cfg(test)]
mod tests {
    use super::{open_line, serial};
    use crate::link::LinkError;

    #[test]
    fn a_port_that_does_not_exist_is_named_with_a_remedy() {
        let error = serial("/dev/tty-nowhere", 115_200).unwrap_err();
        let LinkError::Io(text) = &error else {
            panic!("{error:?}");
        };
        assert!(text.contains("/dev/tty-nowhere"), "{text}");
        assert!(
            text.contains("no serial port is plugged in") || text.contains("there are"),
            "{text}"
        );
        assert!(!text.contains('\n'), "{text}");
    }

    #[test]
    fn a_file_is_not_a_port() {
        let error = open_line("/dev/null", 115_200).unwrap_err();
        assert!(error.to_string().contains("/dev/null"), "{error}");
    }
}

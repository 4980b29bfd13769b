//! The qemu link: the image in an emulated STM32F405, over a socket, or over a pty like a board on
//! a serial port.
//!
//! QEMU connects to a socket that is bound before QEMU starts, so the hello of the boot is not
//! lost. QEMU drops bytes for the image until the image has set up its UART; so the line counts as
//! open once the image has sent a byte. With `-icount shift=0,sleep=off` an instruction is one tick
//! of the virtual clock, so the instructions of a step are counted exactly.

use core::time::Duration;
use std::io::{BufRead, BufReader, ErrorKind};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Instant;

#[cfg(unix)]
use std::os::unix::net::{UnixListener, UnixStream};

use super::LinkError;
use super::cycles::{StepCost, StepFile};
use super::endpoint::{Endpoint, RetryPolicy};
use super::image::image;
use super::line::Line;
use super::stream::{POLL, Stream, fresh_nonce};

pub(super) const PROGRAM: &str = "qemu-system-arm";
/// Time for the emulator to start and connect, on a loaded machine.
const START_LIMIT: Duration = Duration::from_secs(30);
/// Time for the image's first byte, which comes milliseconds after the first instruction.
const BOOT_LIMIT: Duration = Duration::from_secs(10);

/// A running emulator; dropping this value ends it.
#[derive(Debug)]
pub(super) struct Emulator(Child);

impl Drop for Emulator {
    fn drop(&mut self) {
        // It may have ended by itself; then both calls fail, and nothing is left to do.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

impl Emulator {
    fn start(image: &Path, serial: &str, more: &[String]) -> Result<Self, LinkError> {
        if !image.is_file() {
            let what = format!(
                "there is no image at {}; type: cargo image",
                image.display()
            );
            return Err(LinkError::Io(what));
        }
        let kernel = image.to_string_lossy();
        let fixed = ["-icount", "shift=0,sleep=off", "-kernel", &*kernel];
        let arguments = fixed.into_iter().chain(more.iter().map(String::as_str));
        Self::spawn(serial, arguments)
    }

    /// Starts the emulator with a serial port and more arguments.
    pub(super) fn spawn<'a>(
        serial: &str,
        more: impl IntoIterator<Item = &'a str>,
    ) -> Result<Self, LinkError> {
        let child = Command::new(PROGRAM)
            .args(["-M", "netduinoplus2", "-display", "none"])
            .args(["-monitor", "none", "-nodefaults", "-serial", serial])
            .args(more)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn();
        child.map(Self).map_err(|error| {
            LinkError::Io(match error.kind() {
                ErrorKind::NotFound => format!(
                    "{PROGRAM} is not installed; \
                     type: apt-get install qemu-system-arm (or your system's package)"
                ),
                _ => format!("cannot start {PROGRAM}: {error}"),
            })
        })
    }

    /// Fails if the emulator has ended, with the last line of its error output.
    pub(super) fn check(&mut self) -> Result<(), LinkError> {
        let ended = self
            .0
            .try_wait()
            .map_err(|error| LinkError::Io(format!("cannot watch {PROGRAM}: {error}")))?;
        let Some(status) = ended else { return Ok(()) };
        let said = self.0.stderr.take().map(BufReader::new);
        let last = said.and_then(|said| said.lines().map_while(Result::ok).last());
        Err(LinkError::Io(format!(
            "{PROGRAM} ended ({status}): {}",
            last.unwrap_or_default()
        )))
    }
}

#[cfg(unix)]
impl Emulator {
    /// The reason of a failed line: the emulator's last line, if it has ended or ends within 1 s.
    fn explain(&mut self, error: LinkError) -> LinkError {
        let began = Instant::now();
        while began.elapsed() < Duration::from_secs(1) {
            if let Err(ended) = self.check() {
                return ended;
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        error
    }
}

/// A line to an emulated board.
#[cfg(unix)]
#[derive(Debug)]
pub struct QemuLine {
    stream: Stream<UnixStream>,
    emulator: Emulator,
    /// Bytes that the image sent at its boot, until the first receive.
    at_boot: Vec<u8>,
    /// What the plugin writes of each step, with a plugin.
    steps: Option<StepFile>,
}

#[cfg(unix)]
impl QemuLine {
    /// Waits for the image's first bytes. If none come, the hello fails later and names the fault.
    fn hear_boot(&mut self) -> Result<(), LinkError> {
        let began = Instant::now();
        let mut heard = Vec::new();
        while heard.is_empty() && began.elapsed() < BOOT_LIMIT {
            self.receive(&mut heard, POLL)?;
        }
        self.at_boot = heard;
        Ok(())
    }
}

#[cfg(unix)]
impl Line for QemuLine {
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        let sent = self.stream.send(bytes);
        sent.map_err(|error| self.emulator.explain(error))
    }

    fn receive(&mut self, into: &mut Vec<u8>, wait: Duration) -> Result<(), LinkError> {
        if !self.at_boot.is_empty() {
            into.append(&mut self.at_boot);
            return Ok(());
        }
        let received = self.stream.receive(into, wait);
        received.map_err(|error| self.emulator.explain(error))
    }

    fn now(&self) -> Duration {
        self.stream.now()
    }

    fn cycles(&self) -> Option<StepCost> {
        self.steps.as_ref()?.last()
    }
}

/// Starts `image` in the emulator.
///
/// # Errors
/// [`LinkError::Io`] naming what is missing and what to type.
#[cfg(unix)]
pub fn open_line(image: &Path) -> Result<QemuLine, LinkError> {
    open_watched(image, None, None)
}

/// Starts `image` in the emulator, with the plugin that counts cycles
/// ([`plugin`](super::cycles::plugin)) if one is given. It keeps a profile in the file `profile`,
/// if one is given.
///
/// # Errors
/// [`LinkError::Io`] naming what is missing and what to type.
#[cfg(unix)]
pub fn open_watched(
    image: &Path,
    plugin: Option<&Path>,
    profile: Option<&Path>,
) -> Result<QemuLine, LinkError> {
    let path = temporary("sock");
    let io = |what: &str, error: &std::io::Error| {
        LinkError::Io(format!("{what} {} failed: {error}", path.display()))
    };
    let listener = UnixListener::bind(&path).map_err(|error| io("binding socket", &error))?;
    let steps = plugin
        .map(|plugin| StepFile::new(plugin, temporary("steps"), profile))
        .transpose()?;
    let more = steps.as_ref().map_or_else(Vec::new, StepFile::arguments);
    let started = Emulator::start(image, &format!("unix:{}", path.display()), &more);
    let stream = started.and_then(|mut emulator| {
        let stream = accept(&listener, &mut emulator)?;
        Ok((stream, emulator))
    });
    // The socket's file is not needed once both ends are open, or if that failed.
    let _ = std::fs::remove_file(&path);
    let (stream, emulator) = stream?;
    stream
        .set_nonblocking(false)
        .and_then(|()| stream.set_read_timeout(Some(POLL)))
        .map_err(|error| io("setting up socket", &error))?;
    let mut line = QemuLine {
        stream: Stream::new(stream, "the emulator"),
        emulator,
        at_boot: Vec::new(),
        steps,
    };
    line.hear_boot()?;
    Ok(line)
}

/// Returns a path in the folder for temporary files that this process has not used yet.
pub(super) fn temporary(ending: &str) -> PathBuf {
    use core::sync::atomic::{AtomicU32, Ordering};
    static COUNT: AtomicU32 = AtomicU32::new(0);
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    let name = format!("fieldline-{}-{count}.{ending}", std::process::id());
    std::env::temp_dir().join(name)
}

#[cfg(unix)]
fn accept(listener: &UnixListener, emulator: &mut Emulator) -> Result<UnixStream, LinkError> {
    let io =
        |error: std::io::Error| LinkError::Io(format!("waiting for {PROGRAM} failed: {error}"));
    listener.set_nonblocking(true).map_err(io)?;
    let began = Instant::now();
    loop {
        match listener.accept() {
            Ok((stream, _)) => return Ok(stream),
            Err(error) if error.kind() == ErrorKind::WouldBlock => emulator.check()?,
            Err(error) => return Err(io(error)),
        }
        if began.elapsed() > START_LIMIT {
            return Err(LinkError::Io(format!(
                "{PROGRAM} did not connect in {START_LIMIT:?}"
            )));
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Builds the image and starts it in the emulator.
///
/// # Errors
/// [`LinkError::Io`] naming what is missing and what to type.
#[cfg(unix)]
pub fn qemu() -> Result<Endpoint<QemuLine>, LinkError> {
    let line = open_line(&image()?)?;
    Ok(Endpoint::new(line, RetryPolicy::LOCKSTEP, fresh_nonce()))
}

/// An emulated board on a pty, to be opened as a serial port; dropping this value ends it.
#[derive(Debug)]
pub struct PtyBoard {
    _emulator: Emulator,
    device: String,
}

impl PtyBoard {
    /// Starts `image` in the emulator.
    ///
    /// # Errors
    /// [`LinkError::Io`] naming what is missing and what to type.
    pub fn start(image: &Path) -> Result<Self, LinkError> {
        let mut emulator = Emulator::start(image, "pty", &[])?;
        let silent = || LinkError::Io(format!("{PROGRAM} did not say which pty it opened"));
        let said = emulator.0.stdout.take().ok_or_else(silent)?;
        let mut line = String::new();
        let _ = BufReader::new(said).read_line(&mut line);
        // "char device redirected to /dev/pts/0 (label serial0)"
        let device = line
            .split_whitespace()
            .find(|word| word.starts_with("/dev/"));
        let Some(device) = device.map(str::to_owned) else {
            emulator.check()?;
            return Err(silent());
        };
        Ok(Self {
            _emulator: emulator,
            device,
        })
    }

    /// The port to open.
    #[must_use]
    pub fn device(&self) -> &str {
        &self.device
    }
}

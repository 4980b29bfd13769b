//! Cycles of the emulated chip: the plugin of QEMU that counts them by a model, and what it writes.
//!
//! ```text
//! QEMU ─ plugin ─► file of this run: 56 bytes a step, before the image sends its reply ─► report
//! ```
//!
//! The plugin (`host-sim/qemu-cycles`) is built like the image: by cargo, from the source tree,
//! once a process. It changes nothing in the emulated chip, so a run has the same commands with it.
//! A run without it goes on without cycles. `docs/CYCLES.md` says what the model is and how far
//! off.

use core::cell::RefCell;
use core::time::Duration;
use std::fs::File;
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use std::time::Instant;

pub use fieldline_cycles::steps::StepCost;
use serde_json::Value;

use super::LinkError;
use super::cargo::{self, NotBuilt};
use super::qemu::{Emulator, PROGRAM, temporary};

/// Environment variable with the path of a plugin to use instead of a new build; `off` for none.
pub const PLUGIN_VARIABLE: &str = "FIELDLINE_CYCLES";

const PACKAGE: &str = "fieldline-qemu-cycles";
const LIBRARY: &str = "fieldline_qemu_cycles";
/// From this version on QEMU wants a plugin of a later interface.
const LATER_INTERFACE: u32 = 9;
/// Time in which QEMU loads a plugin or ends, on a loaded machine.
const TRIAL: Duration = Duration::from_secs(20);

/// Returns the plugin, built and tried once a process: the one in [`PLUGIN_VARIABLE`], or else one
/// from the source tree. `None` if the variable says `off`.
///
/// # Errors
/// [`LinkError::Io`] with the reason why no cycles can be counted.
pub fn plugin() -> Result<Option<&'static Path>, LinkError> {
    static PLUGIN: OnceLock<Result<Option<PathBuf>, LinkError>> = OnceLock::new();
    let found = PLUGIN.get_or_init(|| match std::env::var_os(PLUGIN_VARIABLE) {
        Some(value) if value == "off" => Ok(None),
        Some(path) => tried(PathBuf::from(path)).map(Some),
        None => build().and_then(tried).map(Some),
    });
    match found {
        Ok(path) => Ok(path.as_deref()),
        Err(error) => Err(error.clone()),
    }
}

fn build() -> Result<PathBuf, LinkError> {
    let mut arguments = vec!["--release"];
    if major(&version()?).is_some_and(|major| major >= LATER_INTERFACE) {
        arguments.extend(["--features", "qemu-9"]);
    }
    let built = cargo::build("host-sim/qemu-cycles", PACKAGE, &arguments);
    let messages = built.map_err(|error| {
        LinkError::Io(match error {
            NotBuilt::NoSources(root) => {
                format!(
                    "there is no source tree at {} with the plugin",
                    root.display()
                )
            }
            NotBuilt::NoCargo(error) => format!("cannot run cargo to build the plugin: {error}"),
            NotBuilt::Failed(log) => format!(
                "building the plugin failed: {}; \
                 type `cargo build --release -p {PACKAGE}` to see all of it",
                cargo::first_error(&log)
            ),
        })
    })?;
    let library = library(&messages);
    library.ok_or_else(|| LinkError::Io("cargo built the plugin and did not say where".into()))
}

/// Returns what QEMU says of itself.
fn version() -> Result<String, LinkError> {
    let output = Command::new(PROGRAM).arg("--version").output();
    let output = output.map_err(|error| LinkError::Io(format!("cannot run {PROGRAM}: {error}")))?;
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// The first number of `QEMU emulator version 7.2.22 (Debian …)`.
fn major(version: &str) -> Option<u32> {
    let mut words = version.split_whitespace();
    words.find(|word| *word == "version")?;
    words.next()?.split('.').next()?.parse().ok()
}

/// The plugin's file in cargo's messages.
fn library(messages: &str) -> Option<PathBuf> {
    let artifacts = messages
        .lines()
        .filter_map(|line| serde_json::from_str(line).ok());
    let mut of_plugin = artifacts.filter(|artifact: &Value| artifact["target"]["name"] == LIBRARY);
    let plugin = of_plugin.next_back()?;
    plugin["filenames"][0].as_str().map(PathBuf::from)
}

/// Starts an empty board with the plugin: a plugin that QEMU loads creates its file at once.
fn tried(plugin: PathBuf) -> Result<PathBuf, LinkError> {
    if !plugin.is_file() {
        let what = format!("there is no plugin at {}", plugin.display());
        return Err(LinkError::Io(what));
    }
    let steps = temporary("trial");
    let arguments = arguments(&plugin, &steps, None);
    let halted = ["-S"]
        .into_iter()
        .chain(arguments.iter().map(String::as_str));
    let mut emulator = Emulator::spawn("null", halted)?;
    let began = Instant::now();
    let loaded = loop {
        if steps.exists() {
            break Ok(());
        }
        if let Err(error) = emulator.check() {
            break Err(error);
        }
        if began.elapsed() > TRIAL {
            break Err(LinkError::Io(format!(
                "{PROGRAM} did not load it in {TRIAL:?}"
            )));
        }
        std::thread::sleep(Duration::from_millis(2));
    };
    drop(emulator);
    // It is not there if the trial failed.
    let _ = std::fs::remove_file(&steps);
    loaded.map(|()| plugin)
}

/// Arguments of QEMU.
fn arguments(plugin: &Path, steps: &Path, profile: Option<&Path>) -> Vec<String> {
    let mut option = format!("file={},steps={}", plugin.display(), steps.display());
    if let Some(profile) = profile {
        option += &format!(",profile={}", profile.display());
    }
    vec!["-plugin".into(), option]
}

/// The file in which a plugin writes the steps of a run. Its name ends with this value.
#[derive(Debug)]
pub(super) struct StepFile {
    file: File,
    path: PathBuf,
    arguments: Vec<String>,
    /// Bytes of a step that is not whole yet.
    begun: RefCell<Vec<u8>>,
}

impl StepFile {
    /// Makes an empty file for a plugin, which also keeps a profile if it has a file for it.
    pub(super) fn new(
        plugin: &Path,
        path: PathBuf,
        profile: Option<&Path>,
    ) -> Result<Self, LinkError> {
        let io = |error: io::Error| {
            LinkError::Io(format!(
                "cannot make {} for cycles: {error}",
                path.display()
            ))
        };
        File::create(&path).map_err(io)?;
        let file = File::open(&path).map_err(io)?;
        Ok(Self {
            file,
            arguments: arguments(plugin, &path, profile),
            path,
            begun: RefCell::default(),
        })
    }

    /// Returns QEMU's arguments.
    pub(super) fn arguments(&self) -> Vec<String> {
        self.arguments.clone()
    }

    /// Returns the last step that was written since the last call. A request that was answered
    /// without a step, as one that is repeated, has none.
    pub(super) fn last(&self) -> Option<StepCost> {
        let mut begun = self.begun.take();
        // What cannot be read now is read with the next step.
        let _ = (&self.file).read_to_end(&mut begun);
        let (whole, rest) = begun.as_chunks::<{ StepCost::BYTES }>();
        let last = whole.last().map(StepCost::from_bytes);
        self.begun.replace(rest.to_vec());
        last
    }
}

impl Drop for StepFile {
    fn drop(&mut self) {
        // Somebody may have cleaned up before.
        let _ = std::fs::remove_file(&self.path);
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write as _;
    use std::path::{Path, PathBuf};

    use super::{StepCost, StepFile, library, major, tried};

    #[test]
    fn the_version_is_the_first_number() {
        let debian = "QEMU emulator version 7.2.22 (Debian 1:7.2+dfsg-7+deb12u18)\nCopyright";
        assert_eq!(major(debian), Some(7));
        assert_eq!(major("QEMU emulator version 10.0.2"), Some(10));
        assert_eq!(major("no emulator"), None);
    }

    #[test]
    fn the_plugin_is_named_in_cargos_messages() {
        let messages = concat!(
            r#"{"reason":"compiler-artifact","target":{"name":"a"},"filenames":["/t/liba.rlib"]}"#,
            "\nnot JSON\n",
            r#"{"reason":"compiler-artifact","target":{"name":"fieldline_qemu_cycles"},"#,
            r#""filenames":["/t/libfieldline_qemu_cycles.so"]}"#,
            "\n",
            r#"{"reason":"build-finished","success":true}"#,
        );
        let expected = PathBuf::from("/t/libfieldline_qemu_cycles.so");
        assert_eq!(library(messages), Some(expected));
        assert_eq!(library("{}"), None);
    }

    #[test]
    fn a_plugin_that_is_not_there_is_named() {
        let error = tried(PathBuf::from("/no/plugin.so")).unwrap_err();
        assert!(
            error.to_string().contains("no plugin at /no/plugin.so"),
            "{error}"
        );
    }

    #[test]
    fn the_last_whole_step_is_read_once() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("steps");
        let steps = StepFile::new(Path::new("plugin.so"), path.clone(), None).unwrap();
        assert!(steps.arguments()[1].ends_with("steps"));
        let profiled = super::arguments(Path::new("plugin.so"), &path, Some(Path::new("p")));
        assert!(profiled[1].ends_with("steps,profile=p"));
        assert_eq!(steps.last(), None);
        let cost = |cycles| {
            let mut cost = StepCost::default();
            cost.stages[3].cycles = cycles;
            cost
        };
        let mut file = std::fs::OpenOptions::new()
            .append(true)
            .open(&path)
            .unwrap();
        let bytes = [cost(1).to_bytes(), cost(2).to_bytes(), cost(3).to_bytes()].concat();
        file.write_all(&bytes[..120]).unwrap();
        assert_eq!(steps.last(), Some(cost(2)));
        assert_eq!(steps.last(), None);
        file.write_all(&bytes[120..]).unwrap();
        assert_eq!(steps.last(), Some(cost(3)));
        drop(steps);
        assert!(!path.exists());
    }
}

//! The file of a session: JSON lines, first a head, then one request a line.
//!
//! ```text
//! {"fieldline_session":1,"generator":"absurd","seed":7,"tiles":200,"slots":250}
//! {"start":{"lasers":[{"z":"0.23","beams":181,…}],"max_linear":"0.7",…}}
//! {"observation":{"time_ms":200,"pose":{"x":"0.1"},"scans":[{"ranges_mm":"900x181"}]}}
//! "pause"
//! ```
//!
//! Quantities are decimal numbers in the units of the messages. A field that is left out has its
//! default. So a file replays also after the messages got new fields. `#` begins a comment line.

use core::fmt;
use std::fs;
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::ask::Ask;
use super::compact::{pack, unpack};
use super::target::Capacity;

/// Version of the format.
pub const FORMAT: u32 = 1;

/// The first line of a file.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Head {
    /// [`FORMAT`].
    pub fieldline_session: u32,
    /// Generator of the session.
    #[serde(default)]
    pub generator: String,
    /// Seed of the generator.
    #[serde(default)]
    pub seed: u64,
    /// Tiles and slots of the device's map.
    #[serde(flatten)]
    pub capacity: Capacity,
    /// What the session causes, or caused.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub causes: String,
}

/// A session to replay.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Script {
    /// Where it comes from.
    pub head: Head,
    /// Its requests.
    pub asks: Vec<Ask>,
}

/// Why a file is no session: file, line, what is wrong, and the remedy.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ScriptError {
    /// File.
    pub file: String,
    /// Line, from 1; 0 if the file cannot be read at all.
    pub line: usize,
    /// What is wrong, and the remedy.
    pub what: String,
}

impl fmt::Display for ScriptError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, line, what } = self;
        match line {
            0 => write!(f, "{file}: {what}"),
            _ => write!(f, "{file}:{line}: {what}"),
        }
    }
}

impl core::error::Error for ScriptError {}

impl Script {
    /// Reads a file.
    ///
    /// # Errors
    /// [`ScriptError`].
    pub fn load(path: &Path) -> Result<Self, ScriptError> {
        let file = path.display().to_string();
        match fs::read_to_string(path) {
            Ok(text) => Self::read(&file, &text),
            Err(error) => Err(ScriptError {
                file,
                line: 0,
                what: format!("cannot be read: {error}; name a file of a session"),
            }),
        }
    }

    /// Reads the text of a file.
    ///
    /// # Errors
    /// [`ScriptError`].
    pub fn read(file: &str, text: &str) -> Result<Self, ScriptError> {
        let at = |line: usize, what: String| ScriptError {
            file: file.into(),
            line,
            what,
        };
        let is_content = |line: &str| !line.trim().is_empty() && !line.starts_with('#');
        let mut lines = (1..).zip(text.lines()).filter(|(_, line)| is_content(line));
        let (first, line) = lines
            .next()
            .ok_or_else(|| at(1, format!("the file is empty; {HEAD_REMEDY}")))?;
        let head = head(line).map_err(|what| at(first, what))?;
        let asks = lines.map(|(number, line)| request(line).map_err(|what| at(number, what)));
        Ok(Self {
            head,
            asks: asks.collect::<Result<_, _>>()?,
        })
    }

    /// Writes a file, and the folder that it is in.
    ///
    /// # Errors
    /// If the system cannot write it.
    pub fn save(&self, path: &Path) -> std::io::Result<()> {
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder)?;
        }
        fs::write(path, self.to_string())
    }
}

const HEAD_REMEDY: &str = "begin it with {\"fieldline_session\":1}";

fn head(line: &str) -> Result<Head, String> {
    let head: Head = serde_json::from_str(line)
        .map_err(|error| format!("this is no head of a session: {error}; {HEAD_REMEDY}"))?;
    match head.fieldline_session {
        FORMAT => Ok(head),
        other => Err(format!(
            "the file has format {other} and this program reads {FORMAT}; \
             use the program that wrote it, or record the session again"
        )),
    }
}

fn request(line: &str) -> Result<Ask, String> {
    let remedy = "correct the line or leave it out";
    let value: Value = serde_json::from_str(line).map_err(|error| {
        format!("this is no JSON: {error}; write one request a line, as in \"pause\"")
    })?;
    let value = unpack("", value).map_err(|what| format!("{what}; {remedy}"))?;
    serde_json::from_value(value).map_err(|error| format!("{error}; {remedy}"))
}

impl fmt::Display for Script {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let head = serde_json::to_string(&self.head).map_err(|_| fmt::Error)?;
        writeln!(f, "{head}")?;
        for ask in &self.asks {
            let value = serde_json::to_value(ask).map_err(|_| fmt::Error)?;
            writeln!(f, "{}", pack("", value))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use fieldline_protocol::SCHEMA;

    use super::{FORMAT, Head, Script};
    use crate::session::ask::Ask;
    use crate::session::choices::Seeded;
    use crate::session::generate::Generator;
    use crate::session::target::Capacity;

    #[test]
    fn what_is_written_is_read() {
        for seed in 0..40 {
            let mut host = Generator::Absurd.host(Seeded::new(seed), 100);
            let asks: Vec<Ask> = core::iter::from_fn(|| host.next(None)).collect();
            let script = Script {
                head: Head {
                    fieldline_session: FORMAT,
                    generator: "absurd".into(),
                    seed,
                    capacity: Capacity::ALL[seed as usize % 4],
                    causes: String::new(),
                },
                asks,
            };
            let text = script.to_string();
            assert!(!text.contains(&SCHEMA.to_string()));
            assert_eq!(Script::read("f", &text).unwrap(), script);
        }
    }

    #[test]
    fn bad_files_are_refused_with_line_and_remedy() {
        let head = "{\"fieldline_session\":1}\n";
        for (text, line, words) in [
            ("", 1, "begin it with"),
            ("\"pause\"\n", 1, "begin it with"),
            ("{\"fieldline_session\":7}", 1, "format 7"),
            (&format!("{head}pause"), 2, "no JSON"),
            (&format!("{head}\n# x\n\"sleep\""), 4, "sleep"),
            (
                &format!("{head}{{\"start\":{{\"speed\":1}}}}"),
                2,
                "'speed'",
            ),
            (
                &format!("{head}{{\"tile\":{{\"x\":1}}}}"),
                2,
                "missing field",
            ),
            (
                &format!("{head}{{\"observation\":{{\"time_ms\":-1}}}}"),
                2,
                "invalid",
            ),
        ] {
            let error = Script::read("a.jsonl", text).unwrap_err();
            assert_eq!(error.line, line, "{error}");
            let text = error.to_string();
            assert!(
                text.starts_with("a.jsonl:") && text.contains(words),
                "{text}"
            );
            assert!(text.contains(';'), "no remedy: {text}");
        }
    }
}

//! What made a run: the program's version, its command line, its robot and every option.
//!
//! Options that only say where results go or how they are shown do not make a run. Two runs of a
//! folder are the same run made again if command and options are equal.

use core::fmt::Write as _;
use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

/// Version, command line, robot and options of a run.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MadeBy {
    /// Version of host-sim.
    pub version: String,
    /// Its arguments, the first is the command.
    pub command_line: Vec<String>,
    /// Name of the robot.
    pub robot: String,
    /// Every option by its name, with its value or its default. An option that is not given and
    /// has no default is not here.
    pub options: BTreeMap<String, String>,
}

/// The part of a report that is read here.
#[derive(Deserialize)]
struct Head {
    made_by: Option<MadeBy>,
}

impl MadeBy {
    /// Returns what made the run whose report is in a folder; `None` if there is none, or it does
    /// not say.
    #[must_use]
    pub fn of_folder(folder: &Path) -> Option<Self> {
        let text = std::fs::read_to_string(folder.join("report.json")).ok()?;
        serde_json::from_str::<Head>(&text).ok()?.made_by
    }

    /// Refuses a folder that holds a run made with other options.
    ///
    /// # Errors
    /// The folder, how both runs differ, and the remedy.
    pub fn may_replace(&self, folder: &Path) -> Result<(), String> {
        let Some(held) = Self::of_folder(folder) else {
            return Ok(());
        };
        if self.command() == held.command() && self.options == held.options {
            return Ok(());
        }
        Err(format!(
            "{} holds a run made by `{}`, and this one is made by `{}`; say --force to replace it, \
             or choose another folder with --out",
            folder.display(),
            held.against(self),
            self.against(&held),
        ))
    }

    /// Returns how a run and another one were made, if they differ in more than some options: first
    /// the other one, then this one.
    #[must_use]
    pub fn difference(&self, other: &Self, but_for: &[&str]) -> Option<[String; 2]> {
        let cut = |made: &Self| {
            let options = made.options.iter();
            let options = options.filter(|(name, _)| !but_for.contains(&name.as_str()));
            Self {
                options: options.map(|(a, b)| (a.clone(), b.clone())).collect(),
                ..made.clone()
            }
        };
        let (own, its) = (cut(self), cut(other));
        (own.options != its.options).then(|| [its.against(&own), own.against(&its)])
    }

    /// Returns the command: `explore`, `team` or `replay`.
    fn command(&self) -> Option<&str> {
        self.options.get("command").map(String::as_str)
    }

    /// Returns the command and the options that differ from those of another run.
    fn against(&self, other: &Self) -> String {
        let mut text = String::from(self.command().unwrap_or("host-sim"));
        for name in self.options.keys().chain(other.options.keys()) {
            let (own, its) = (self.options.get(name), other.options.get(name));
            let is_said = text.contains(&format!(" --{name} "));
            if own == its || is_said || name == "command" {
                continue;
            }
            // Writing into a string does not fail.
            let _ = match own {
                Some(value) => write!(text, " --{name} {value} "),
                None => write!(text, " (no --{name} )"),
            };
        }
        text.replace("  ", " ").replace(" )", ")").trim_end().into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn made(options: &[(&str, &str)]) -> MadeBy {
        let options = options
            .iter()
            .map(|(name, value)| ((*name).into(), (*value).into()));
        MadeBy {
            options: options.collect(),
            ..MadeBy::default()
        }
    }

    #[test]
    fn a_folder_of_other_options_is_not_replaced() {
        let folder = tempfile::tempdir().expect("a folder");
        let first = made(&[("command", "explore"), ("seed", "1"), ("people", "0")]);
        assert_eq!(first.may_replace(folder.path()), Ok(()));
        let report = serde_json::json!({"seed": 1, "made_by": first});
        std::fs::write(folder.path().join("report.json"), report.to_string()).expect("written");
        assert_eq!(MadeBy::of_folder(folder.path()), Some(first.clone()));
        assert_eq!(first.may_replace(folder.path()), Ok(()));
        let second = made(&[
            ("command", "explore"),
            ("seed", "2"),
            ("people", "0"),
            ("fault", "x"),
        ]);
        let error = second.may_replace(folder.path()).expect_err("another seed");
        for words in [
            "made by `explore --seed 1 (no --fault)`",
            "by `explore --fault x --seed 2`",
            "--force",
            "--out",
        ] {
            assert!(error.contains(words), "no {words:?} in {error}");
        }
        std::fs::write(folder.path().join("report.json"), "{").expect("written");
        assert_eq!(second.may_replace(folder.path()), Ok(()));
    }
}

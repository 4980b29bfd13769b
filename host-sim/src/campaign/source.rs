//! The lines of a campaign file, for faults that show after it was read: when worlds are opened and
//! options meet.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::CampaignError;

/// Where the parts of a plan come from.
#[derive(Clone, Debug, Default)]
pub struct Source {
    file: Option<PathBuf>,
    /// Lines, from 1, by key and name.
    lines: BTreeMap<(String, String), usize>,
}

impl Source {
    /// Makes the source of a file whose lines are not known yet.
    pub(super) fn new(file: &Path) -> Self {
        Self {
            file: Some(file.to_owned()),
            lines: BTreeMap::new(),
        }
    }

    /// Notes the line of an entry, from 1.
    pub(super) fn note(&mut self, key: &str, name: &str, line: usize) {
        self.lines.insert((key.to_owned(), name.to_owned()), line);
    }

    /// Returns the error with file and line of an entry, if they are known.
    #[must_use]
    pub fn error(&self, key: &str, name: &str, reason: impl Into<String>) -> CampaignError {
        let mut error = CampaignError::new(reason);
        error.file.clone_from(&self.file);
        error.line = self.lines.get(&(key.into(), name.into())).copied();
        error
    }

    /// Returns the error of an arm's arguments: at the line of the option that it names, or else at
    /// the line of the strategy or variant.
    #[must_use]
    pub fn argument_error(&self, entry: &str, reason: &str) -> CampaignError {
        let named = |name: &str| {
            let after = reason.split(&format!("--{name}")).nth(1);
            after
                .is_some_and(|rest| !rest.starts_with(|it: char| it == '-' || it.is_alphanumeric()))
        };
        let option = self.lines.keys().find(|(key, name)| {
            let is_option = key == "options" || *key == format!("variants/{entry}/options");
            is_option && named(name)
        });
        match option {
            Some((key, name)) => self.error(key, name, reason),
            None => self.error("strategies", entry, reason),
        }
    }

    /// Returns the error of the plan as a whole with file and the line of the key that it names.
    #[must_use]
    pub fn placed(&self, error: CampaignError) -> CampaignError {
        let named = |key: &&(String, String)| error.reason.contains(&format!("`{}`", key.0));
        let line = self
            .lines
            .keys()
            .find(named)
            .and_then(|key| self.lines.get(key));
        CampaignError {
            file: self.file.clone(),
            line: line.copied(),
            ..error
        }
    }
}

//! Comparisons of strategies, worlds and options over starts and seeds.
//!
//! | module | content |
//! | --- | --- |
//! | [`plan`] | what is compared: the trials of a campaign, in their order |
//! | [`spec`] | the campaign file: strict TOML, errors with file and line |
//! | [`source`] | the lines of that file |
//! | [`numbers`] | lists and ranges of numbers, as in `0..10` |
//! | [`trials`] | the trials on several threads |
//! | [`store`] | the folder of a campaign: one line a finished trial, resumed after a kill |
//! | [`results`] | tables and plots as files |
//! | [`shards`] | parts of a campaign, and their merge |
//! | [`columns`] | values of a trial by their path in the report |
//! | [`table`] | means, deviations and tests, for each world and strategy |
//! | [`markdown`], [`csv`] | the table as text |
//! | [`statistics`] | rank-sum, signed-rank and sign test |
//! | [`plots`] | box plots, and coverage over time |
//!
//! A campaign is a product: worlds × odometry × strategies × starts × seeds. A *trial* is one cell
//! of it, and means what `host-sim explore` with the arguments of [`plan::Trial::arguments`] means:
//! who runs trials gives an [`trials::Explore`].
//!
//! The campaigns of [`crate::session`] are another thing: those attack a device.

pub mod columns;
pub mod csv;
pub mod markdown;
pub mod numbers;
pub mod plan;
pub mod plots;
pub mod results;
pub mod shards;
pub mod source;
pub mod spec;
pub mod statistics;
pub mod store;
pub mod table;
pub mod trials;

use std::io;
use std::path::{Path, PathBuf};

/// The name of the plan's file in a campaign's folder.
pub const PLAN_FILE: &str = "campaign.toml";
/// The name of the results' file in a campaign's folder.
pub const TRIALS_FILE: &str = "trials.jsonl";

/// What is wrong with a campaign or its files.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CampaignError {
    /// The file, if the fault is in one.
    pub file: Option<PathBuf>,
    /// The line in the file, from 1.
    pub line: Option<usize>,
    /// The fault and the remedy.
    pub reason: String,
}

impl CampaignError {
    /// Makes an error that is in no file.
    #[must_use]
    pub fn new(reason: impl Into<String>) -> Self {
        Self {
            file: None,
            line: None,
            reason: reason.into(),
        }
    }

    /// Returns the error with its file, unless it has one.
    #[must_use]
    pub fn in_file(mut self, file: &Path) -> Self {
        self.file.get_or_insert_with(|| file.to_owned());
        self
    }

    /// Returns the error with its line, from 1.
    #[must_use]
    pub const fn at_line(mut self, line: usize) -> Self {
        self.line = Some(line);
        self
    }

    /// Makes the error of a file that cannot be read or written.
    #[must_use]
    pub fn io(what: &str, file: &Path, error: &io::Error) -> Self {
        Self::new(format!("cannot {what}: {error}")).in_file(file)
    }
}

impl core::fmt::Display for CampaignError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        if let Some(file) = &self.file {
            write!(f, "{}:", file.display())?;
            if let Some(line) = self.line {
                write!(f, "{line}:")?;
            }
            write!(f, " ")?;
        }
        write!(f, "{}", self.reason)
    }
}

impl core::error::Error for CampaignError {}

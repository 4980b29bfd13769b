//! Arguments that several commands have.

use std::path::{Path, PathBuf};

use anyhow::{Error, Result};
use clap::Args;

use host_sim::report::MadeBy;

use super::args::Impatience;
use super::values::{impatience, seed, time_limit, until};

/// Arguments of all that simulates or replays.
#[derive(Clone, Debug, Args)]
pub(super) struct CommonArgs {
    /// Seed of every random number
    #[arg(
        long,
        value_name = "N",
        default_value = "0",
        value_parser = seed,
        allow_negative_numbers = true
    )]
    pub(super) seed: u64,
    /// Print JSON and no text: one object a line, for each run or step
    #[arg(long)]
    pub(super) json: bool,
}

/// Arguments about the time of a run.
#[derive(Clone, Debug, Args)]
pub(super) struct PaceArgs {
    /// Simulated seconds after which a run ends
    #[arg(
        long,
        value_name = "S",
        default_value = "3600",
        value_parser = time_limit,
        allow_negative_numbers = true
    )]
    pub(super) time_limit: u32,
    /// Run no faster than real time
    #[arg(long)]
    pub(super) realtime: bool,
}

/// Arguments about the folder of the files.
#[derive(Clone, Debug, Args)]
pub(super) struct FolderArgs {
    /// Folder of the files; with several runs, the folder of their folders [default:
    /// out/WORLD-STRATEGY-SEED, on uneven ground out/WORLD-STRATEGY-uneven-SEED; of a team
    /// out/WORLD-STRATEGY-team-ROBOTS-SEED; of a replay out/LOG-replay-SEED]
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// Replace the run of the folder --out, though it was made with other options
    #[arg(long)]
    pub(super) force: bool,
}

impl FolderArgs {
    /// Refuses to replace the files of a run with other options, unless it is told to.
    ///
    /// # Errors
    /// The folder holds such a run.
    pub(super) fn check(&self, folder: &Path, made_by: &MadeBy) -> Result<()> {
        if self.out.is_some() && !self.force {
            made_by.may_replace(folder).map_err(Error::msg)?;
        }
        Ok(())
    }
}

/// Arguments of the strategies that know the area.
#[derive(Clone, Debug, Args)]
pub(super) struct SpaceArgs {
    /// Share of the area whose coverage ends the run, above 0, at most 1; for sbpf and esbpf
    #[arg(long, value_name = "SHARE", value_parser = until)]
    pub(super) until: Option<u16>,
    /// Simulated seconds without a newly covered cell after which sbpf or esbpf follows a path to
    /// a frontier, or never [default: never for sbpf, 5 for esbpf]
    #[arg(long, value_name = "S|never", value_parser = impatience, allow_negative_numbers = true)]
    pub(super) sbpf_impatience: Option<Impatience>,
}

impl SpaceArgs {
    /// Returns true if any of them is given.
    pub(super) const fn is_given(&self) -> bool {
        self.until.is_some() || self.sbpf_impatience.is_some()
    }
}

//! The arguments of the command line; `values.rs` parses their values.

mod explore;
mod words;

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

use host_sim::solve::Solver;

use super::bringup::BringupArgs;
use super::campaign::CampaignArgs;
use super::replay::ReplayArgs;
use super::sessions::{ReplaySessionArgs, SessionsArgs};
use super::team::TeamArgs;
pub(super) use explore::ExploreArgs;
pub(super) use words::{GroundArg, Impatience, LogArg, OdometryArg, SwitchArg, ThenArg};

/// Explore simulated worlds with the Fieldline planner; without a command, explore the built-in
/// office
#[derive(Debug, Parser)]
#[command(name = "host-sim", version)]
pub(super) struct Cli {
    #[command(subcommand)]
    pub(super) command: Option<Command>,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Explore worlds; write a folder with report, map, trajectory, commands and picture of each
    Explore(Box<ExploreArgs>),
    /// Bring up a device and its robot in six steps, each with what to do, what is seen and the
    /// remedy
    Bringup(Box<BringupArgs>),
    /// Compare strategies, worlds and options over starts and seeds; write every trial, tables and
    /// plots into a folder, and go on there after a kill
    Campaign(Box<CampaignArgs>),
    /// Explore a world with several robots; write a folder with report, map and picture of the team
    /// and a folder of each robot
    Team(Box<TeamArgs>),
    /// Localise and map along a recorded log; write a folder with map, trajectory and picture
    Replay(Box<ReplayArgs>),
    /// Attack devices with whole sessions, from absurd to plausible; print totals and findings
    Sessions(SessionsArgs),
    /// Replay a session from a file and judge every answer
    ReplaySession(ReplaySessionArgs),
    /// Print what the state of a run holds from which explore --resume goes on
    State {
        /// File session.state, or the folder that has it
        path: PathBuf,
        /// Print one JSON object
        #[arg(long)]
        json: bool,
    },
    /// List the built-in worlds and the kinds of generated ones
    Worlds {
        /// Print one JSON object a line
        #[arg(long)]
        json: bool,
    },
    /// List the robots that are known by name, or print one as a robot file
    Robots {
        /// Preset to print
        #[arg(value_name = "PRESET")]
        name: Option<String>,
        /// Print one JSON object a line
        #[arg(long, conflicts_with = "name")]
        json: bool,
    },
    /// List the planner's tuned constants with meaning, unit, range and default
    Tuning {
        /// One JSON object a line
        #[arg(long)]
        json: bool,
    },
    /// Solve the potential of one window drawn in a text file
    Solve(SolveArgs),
}

#[derive(Debug, Args)]
pub(super) struct SolveArgs {
    /// Text file of at most 61 x 61 characters, one a cell, greatest y first: # obstacle, G goal,
    /// . free, R robot
    pub(super) window: PathBuf,
    /// Preferences in the same layout, comma-separated, from -2 to 2
    #[arg(long, value_name = "EPS.csv")]
    pub(super) preference: Option<PathBuf>,
    /// Solver
    #[arg(long, value_enum, default_value_t = Solver::Multigrid)]
    pub(super) solver: Solver,
    /// File for q = 1 - p of every cell
    #[arg(long, value_name = "FIELD.csv")]
    pub(super) out: Option<PathBuf>,
    /// Print the answer as one JSON object
    #[arg(long)]
    pub(super) json: bool,
}

#[cfg(test)]
mod tests {
    use super::{Cli, ExploreArgs};
    use clap::{CommandFactory as _, Parser as _};

    #[test]
    fn the_definition_of_the_arguments_is_valid() {
        Cli::command().debug_assert();
    }

    #[test]
    fn no_command_is_explore_with_its_defaults() {
        let cli = Cli::parse_from(["host-sim", "explore"]);
        let Some(super::Command::Explore(args)) = cli.command else {
            panic!("explore");
        };
        let usual = ExploreArgs::default();
        assert_eq!(format!("{args:?}"), format!("{usual:?}"));
        assert_eq!(
            (usual.worlds, usual.strategy),
            (vec!["office".into()], "frontier".into())
        );
        assert_eq!(
            (usual.pace.time_limit, usual.wait.as_secs()),
            (3_600_000, 15)
        );
    }
}

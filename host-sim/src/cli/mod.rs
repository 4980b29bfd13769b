//! The command line.
//!
//! Exit status: 0 if everything is done and every run ended explored, 1 if a run ended otherwise or
//! a session has a finding, 2 if the input is bad or the run cannot begin. A campaign takes every
//! end of a run for a result: 1 if a trial has no report, or trials are left. An error is one line
//! on standard error that names the argument and the remedy. Standard output has results only:
//! text, or with `--json` one JSON object a line.

mod along;
mod args;
mod bringup;
mod campaign;
mod common;
mod explore;
mod film;
mod live;
mod made_by;
mod mission;
mod mission_file;
mod pictures;
mod prepared;
mod profile;
mod progress;
#[cfg(not(feature = "record"))]
#[path = "no_recording.rs"]
mod recording;
#[cfg(feature = "record")]
mod recording;
mod replay;
mod resume;
mod robot;
mod robots;
mod sessions;
mod solve;
mod state;
mod strategies;
mod team;
mod tuning;
mod values;
mod worlds;

use std::io::{self, Write as _};
use std::path::Path;
use std::process::ExitCode;

use anyhow::{Error, Result};
use clap::{CommandFactory as _, FromArgMatches as _};

use args::{Cli, Command, ExploreArgs};
use host_sim::link::cycles::plugin;
use host_sim::link::image::IMAGE_VARIABLE;
use host_sim::link::spec::LinkSpec;

/// Exit status if a run ended otherwise than explored.
const UNFINISHED: u8 = 1;
/// Exit status of bad input.
const BAD_INPUT: u8 = 2;

/// Parses the arguments, runs the command, and returns the exit status.
pub(crate) fn main() -> ExitCode {
    let cli = match parse(std::env::args_os()) {
        Ok(cli) => cli,
        Err(error) if !error.use_stderr() => {
            // The request for help or the version.
            let _ = say(&error.render().to_string());
            return ExitCode::SUCCESS;
        }
        Err(error) => return complain(&one_paragraph(&error)),
    };
    match run(&cli) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(UNFINISHED),
        // The reader of standard output ended, as `head` does.
        Err(error) if is_broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => complain(&format!("{error:#}")),
    }
}

fn parse(arguments: impl Iterator<Item = std::ffi::OsString>) -> Result<Cli, clap::Error> {
    let matches = Cli::command().try_get_matches_from(arguments)?;
    made_by::keep(&matches);
    Cli::from_arg_matches(&matches)
}

/// Runs the command; returns true if every run ended explored.
fn run(cli: &Cli) -> Result<bool> {
    match &cli.command {
        None => explore::run(&ExploreArgs::default()),
        Some(Command::Explore(args)) => explore::run(args),
        Some(Command::Bringup(args)) => bringup::run(args),
        Some(Command::Campaign(args)) => campaign::run(args),
        Some(Command::Team(args)) => team::run(args),
        Some(Command::Replay(args)) => replay::run(args),
        Some(Command::Sessions(args)) => sessions::run(args),
        Some(Command::ReplaySession(args)) => sessions::replay(args),
        Some(Command::State { path, json }) => state::run(path, *json).map(|()| true),
        Some(Command::Worlds { json }) => worlds::run(*json).map(|()| true),
        Some(Command::Robots { name, json }) => robots::run(name.as_deref(), *json).map(|()| true),
        Some(Command::Tuning { json }) => tuning::run(*json).map(|()| true),
        Some(Command::Solve(args)) => solve::run(args).map(|()| true),
    }
}

/// Prints a line on standard output.
fn say(line: &str) -> Result<()> {
    let mut out = io::stdout().lock();
    writeln!(out, "{}", line.trim_end())?;
    out.flush()?;
    Ok(())
}

/// Prints a line on standard error. A failure to print is ignored.
fn note(line: &str) {
    let _ = writeln!(io::stderr(), "{line}");
}

/// Says that a link builds an image first, which may take minutes.
fn note_build(link: &LinkSpec) {
    if *link == LinkSpec::Qemu && std::env::var_os(IMAGE_VARIABLE).is_none() {
        note("host-sim: --link qemu: builds the image for the chip, if it is not up to date");
    }
}

/// Returns the plugin that counts the cycles of an emulated chip. Says why if there is none: the
/// run goes on without cycles.
fn cycles(link: &LinkSpec) -> Option<&'static Path> {
    if *link != LinkSpec::Qemu {
        return None;
    }
    plugin().unwrap_or_else(|error| {
        note(&format!("host-sim: --link qemu: counts no cycles: {error}"));
        None
    })
}

fn complain(message: &str) -> ExitCode {
    let words: Vec<&str> = message.split_whitespace().collect();
    note(&format!("host-sim: {}", words.join(" ")));
    ExitCode::from(BAD_INPUT)
}

/// Returns the first paragraph of an error in the arguments, without the usage, and the place of
/// the help.
fn one_paragraph(error: &clap::Error) -> String {
    let text = error.render().to_string();
    let first = text.split("\n\n").next().unwrap_or_default();
    let first = first.trim_start_matches("error: ");
    let first = first.trim_end();
    let argument = std::env::args().nth(1);
    let command = Cli::command()
        .get_subcommands()
        .map(|command| command.get_name().to_owned())
        .find(|name| argument.as_ref() == Some(name));
    match command {
        Some(command) => format!("{first}; see host-sim {command} --help"),
        None => format!("{first}; see host-sim --help"),
    }
}

fn is_broken_pipe(error: &Error) -> bool {
    let io = error.downcast_ref::<io::Error>();
    io.is_some_and(|error| error.kind() == io::ErrorKind::BrokenPipe)
}

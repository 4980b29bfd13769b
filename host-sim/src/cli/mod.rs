//! The command line: what was asked for, done, and said.
//!
//! Exit status: 0 all that was asked for is done (every run finished explored), 1 a run ended otherwise, 2 the input was
//! bad or nothing could begin. An error is one line on standard error that names the thing and the remedy. Standard output
//! carries results only: text for people, or with `--json` one JSON object a line.

mod args;
mod explore;
mod pictures;
mod progress;
mod solve;
mod strategies;
mod worlds;

use std::io::{self, Write as _};
use std::process::ExitCode;

use anyhow::{Error, Result};
use clap::{CommandFactory as _, FromArgMatches as _};

use args::{Cli, Command, ExploreArgs};

/// What the program says of itself when a run ended otherwise than explored.
const UNFINISHED: u8 = 1;
/// What it says of bad input.
const BAD_INPUT: u8 = 2;

/// Reads the arguments, does the work, and tells how it went.
pub(crate) fn main() -> ExitCode {
    let cli = match parse(std::env::args_os()) {
        Ok(cli) => cli,
        Err(error) if !error.use_stderr() => {
            // Help or version was asked for.
            let _ = say(&error.render().to_string());
            return ExitCode::SUCCESS;
        }
        Err(error) => return complain(&one_paragraph(&error)),
    };
    match run(&cli) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(UNFINISHED),
        // Whoever read our output has had enough.
        Err(error) if is_broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => complain(&format!("{error:#}")),
    }
}

fn parse(arguments: impl Iterator<Item = std::ffi::OsString>) -> Result<Cli, clap::Error> {
    let matches = Cli::command().try_get_matches_from(arguments)?;
    Cli::from_arg_matches(&matches)
}

/// Whether all that was asked for is done.
fn run(cli: &Cli) -> Result<bool> {
    match &cli.command {
        None => explore::run(&ExploreArgs::default()),
        Some(Command::Explore(args)) => explore::run(args),
        Some(Command::Worlds { json }) => worlds::run(*json).map(|()| true),
        Some(Command::Solve(args)) => solve::run(args).map(|()| true),
    }
}

/// A line on standard output.
fn say(line: &str) -> Result<()> {
    let mut out = io::stdout().lock();
    writeln!(out, "{}", line.trim_end())?;
    out.flush()?;
    Ok(())
}

/// A line on standard error; nobody to hear it is no reason to fail.
fn note(line: &str) {
    let _ = writeln!(io::stderr(), "{line}");
}

fn complain(message: &str) -> ExitCode {
    let words: Vec<&str> = message.split_whitespace().collect();
    note(&format!("host-sim: {}", words.join(" ")));
    ExitCode::from(BAD_INPUT)
}

/// What is wrong with the arguments, without the usage below it.
fn one_paragraph(error: &clap::Error) -> String {
    let text = error.render().to_string();
    let first = text.split("\n\n").next().unwrap_or_default();
    let first = first.trim_start_matches("error: ");
    let first = first.trim_end();
    format!("{first}; see host-sim --help")
}

fn is_broken_pipe(error: &Error) -> bool {
    let io = error.downcast_ref::<io::Error>();
    io.is_some_and(|error| error.kind() == io::ErrorKind::BrokenPipe)
}

//! What the command line says: version, arguments, and every option with its value or default.

use std::sync::OnceLock;

use clap::parser::ArgMatches;
use clap::{Command, CommandFactory as _};

use host_sim::report::MadeBy;

use super::args::Cli;

/// Options that make no other run: where its results go, and how they are shown.
const SHOWN: [&str; 10] = [
    "out", "json", "force", "realtime", "live", "record", "profile", "film", "wait", "help",
];

static GIVEN: OnceLock<MadeBy> = OnceLock::new();

/// Keeps the arguments of this process.
pub(super) fn keep(matches: &ArgMatches) {
    let command_line = std::env::args().skip(1).collect();
    let told = options(&Cli::command(), matches);
    let _ = GIVEN.set(MadeBy {
        version: env!("CARGO_PKG_VERSION").into(),
        command_line,
        robot: String::new(),
        options: told.into_iter().collect(),
    });
}

/// Returns what makes a run of this process, with some options of its own: which of several worlds,
/// and where it begins.
pub(super) fn of_run(robot: &str, own: &[(&str, String)]) -> MadeBy {
    let mut made = GIVEN.get().cloned().unwrap_or_default();
    made.robot = robot.into();
    let own = own
        .iter()
        .map(|(name, value)| ((*name).to_owned(), value.clone()));
    made.options.extend(own);
    made
}

/// Returns the command as option `command`, and the values of its options. Without a command it is
/// explore with its defaults.
fn options(program: &Command, matches: &ArgMatches) -> Vec<(String, String)> {
    let Some((name, matches)) = matches.subcommand() else {
        let usual = program.clone().get_matches_from(["host-sim", "explore"]);
        return options(program, &usual);
    };
    let command = program.find_subcommand(name);
    let arguments = command.into_iter().flat_map(Command::get_arguments);
    let valued = arguments.filter_map(|argument| {
        let id = argument.get_id().as_str();
        let name = argument.get_long().unwrap_or(id);
        let raw = matches.try_get_raw(id).ok().flatten()?;
        let words: Vec<String> = raw.map(|it| it.to_string_lossy().into_owned()).collect();
        (!SHOWN.contains(&name)).then(|| (name.to_owned(), words.join(" ")))
    });
    core::iter::once(("command".to_owned(), name.to_owned()))
        .chain(valued)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(line: &str) -> Vec<(String, String)> {
        let matches = Cli::command().get_matches_from(line.split(' '));
        options(&Cli::command(), &matches)
    }

    #[test]
    fn a_default_that_is_said_is_the_same_run() {
        assert_eq!(of("host-sim"), of("host-sim explore"));
        let said = "host-sim explore --seed 0 --out x --json --force office";
        assert_eq!(of("host-sim explore"), of(said));
        assert_ne!(of("host-sim explore"), of("host-sim explore --check-field"));
        let told = of("host-sim explore --people 3 --tune a.b=1 --tune c.d=2");
        for (name, value) in [
            ("command", "explore"),
            ("people", "3"),
            ("tune", "a.b=1 c.d=2"),
        ] {
            assert!(
                told.contains(&(name.into(), value.into())),
                "{name}: {told:?}"
            );
        }
    }
}

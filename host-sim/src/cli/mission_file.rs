//! `--mission FILE`: what a mission file says is what the options would say.
//!
//! Invariant: nothing is said twice. A key of the file whose option is on the command line as well
//! is refused, and the error names both.

use anyhow::{Result, bail};

use host_sim::mission_file::{self, KEYS, MissionFile};

use super::args::{ExploreArgs, ThenArg};

/// Returns the arguments with what their mission file says, and the file's text; the arguments as
/// they are if they name none.
pub(super) fn applied(args: &ExploreArgs) -> Result<(ExploreArgs, Option<String>)> {
    let Some(path) = &args.mission else {
        return Ok((args.clone(), None));
    };
    let (mission, text) = mission_file::read(path)?;
    for (key, line) in &mission.lines {
        let option = KEYS.iter().find(|(known, _)| known == key);
        if let Some((_, option)) = option.filter(|(_, option)| is_given(args, option)) {
            bail!(
                "{}:{line}: key {key} and --{option} both say it; leave one of them out",
                path.display()
            );
        }
    }
    Ok((with(args, mission), Some(text)))
}

fn with(args: &ExploreArgs, mission: MissionFile) -> ExploreArgs {
    let mut args = args.clone();
    args.known = args.known.or(mission.known);
    args.known_pose = args.known_pose.or(mission.known_pose);
    args.bounds.extend(mission.bounds);
    args.no_go.extend(mission.no_go);
    args.goto.extend(mission.goals_m);
    args.pause.extend(mission.pauses);
    args.then = args.then.or(mission.home.then_some(ThenArg::Home));
    args.range_m = args.range_m.or(mission.range_m);
    args.time_s = args.time_s.or(mission.time_s);
    args.home_at = args.home_at.or(mission.home_at_ms);
    args
}

fn is_given(args: &ExploreArgs, option: &str) -> bool {
    match option {
        "known" => args.known.is_some(),
        "known-pose" => args.known_pose.is_some(),
        "bounds" => !args.bounds.is_empty(),
        "no-go" => !args.no_go.is_empty(),
        "goto" => !args.goto.is_empty(),
        "then" => args.then.is_some(),
        "range-m" => args.range_m.is_some(),
        "time-s" => args.time_s.is_some(),
        "home-at" => args.home_at.is_some(),
        _ => !args.pause.is_empty(),
    }
}

#[cfg(test)]
mod tests {
    use super::{KEYS, applied, is_given};
    use crate::cli::args::{Cli, Command, ExploreArgs};
    use clap::Parser as _;

    fn explore(words: &[&str]) -> ExploreArgs {
        let words = ["host-sim", "explore"].iter().chain(words);
        match Cli::parse_from(words).command {
            Some(Command::Explore(args)) => *args,
            _ => panic!("explore"),
        }
    }

    #[test]
    fn what_is_said_twice_is_refused_by_both_names() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("m.toml");
        let path = file.to_string_lossy();
        let map = folder.path().join("map.yaml");
        let map = map.to_string_lossy();
        for ((key, option), (value, word)) in KEYS.iter().zip([
            ("\"map.yaml\"", &*map),
            ("[1, 2, 90]", "1,2,90"),
            ("[[[0, 0], [1, 1]]]", "0,0,1,1"),
            ("[[[0, 0], [1, 1]]]", "0,0,1,1"),
            ("[[1, 2]]", "1,2"),
            ("\"home\"", "home"),
            ("10", "10"),
            ("10", "10"),
            ("10", "10"),
            ("[[10, 20]]", "10-20"),
        ]) {
            std::fs::write(&file, format!("\n{key} = {value}\n")).expect("written");
            let alone = explore(&["--mission", &path]);
            let (args, text) = applied(&alone).expect("the file alone");
            assert!(is_given(&args, option) && text.is_some(), "{key}");
            let given = explore(&["--mission", &path, &format!("--{option}"), word]);
            let error = applied(&given).expect_err(key).to_string();
            assert!(
                error.contains(&format!("m.toml:2: key {key} and --{option}")),
                "{error}"
            );
            let same = explore(&[&format!("--{option}"), word]);
            let named = ExploreArgs {
                mission: None,
                ..args
            };
            assert_eq!(format!("{named:?}"), format!("{same:?}"), "{key}");
        }
    }
}

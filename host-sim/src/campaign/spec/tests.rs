use std::path::Path;

use super::{options, parse};
use crate::campaign::plan::{Plan, Setting};

const WHOLE: &str = r#"
name = "doors"
worlds = ["office", "maze:1"]
strategies = ["bvp", "ouroboros"]
starts = [0, 2]
seeds = "0..3"
odometry = ["noisy", "papers"]
slam = ["off", "host"]
baseline = "bvp"
columns = ["sim_time_s"]

[options]
time-limit = 60.5
resume = true
tune = ["a=1", "b=2"]

[[variants]]
name = "nearest"
strategy = "frontier"
slam = "off"
[variants.options]
order = "nearest"
"#;

fn read(text: &str) -> Plan {
    let spec = parse(text, Path::new("c.toml"), "stem");
    spec.unwrap_or_else(|error| panic!("{error}")).plan
}

#[track_caller]
fn refused(text: &str, words: &[&str]) {
    let Err(error) = parse(text, Path::new("c.toml"), "stem") else {
        panic!("not refused: {text}");
    };
    let error = error.to_string();
    for word in words {
        assert!(error.contains(word), "no {word:?} in: {error}");
    }
}

#[test]
fn the_trials_are_the_product_in_order() {
    let plan = read(WHOLE);
    let labels: Vec<String> = plan.arms().into_iter().map(|arm| arm.label).collect();
    assert_eq!(
        labels,
        ["bvp", "ouroboros", "ouroboros slam=host", "nearest"]
    );
    let trials = plan.trials();
    assert_eq!(trials.len(), 2 * 2 * 4 * 2 * 3);
    assert_eq!(plan.count(), Some(trials.len()));
    assert!(
        trials
            .iter()
            .enumerate()
            .all(|(index, trial)| trial.index == index)
    );
    assert_eq!(
        trials[12].arguments().join(" "),
        "office --strategy=ouroboros --start=0 --seed=0 --odometry=noisy --slam=host --resume \
         --time-limit=60.5 --tune=a=1 --tune=b=2"
    );
    let last = trials.last().unwrap();
    assert_eq!(
        last.arguments().join(" "),
        "maze:1 --strategy=frontier --start=2 --seed=2 --odometry=papers --order=nearest --resume \
         --time-limit=60.5 --tune=a=1 --tune=b=2"
    );
    assert_eq!(
        last.in_short(),
        "maze:1, odometry papers · nearest · start 2 · seed 2"
    );
}

#[test]
fn a_plan_that_is_written_reads_as_the_same() {
    for text in [WHOLE, "worlds = [\"office\"]\nstrategies = [\"frontier\"]"] {
        let plan = read(text);
        assert_eq!(read(&plan.to_toml()), plan, "{}", plan.to_toml());
    }
}

#[test]
fn what_is_not_said_has_a_default() {
    let plan = read("worlds = [\"office\"]\nstrategies = [\"frontier\"]");
    assert_eq!(plan.name, "stem");
    assert_eq!(
        (plan.starts.clone(), plan.seeds.clone()),
        (vec![0], vec![0])
    );
    let arguments = plan.trials()[0].arguments().join(" ");
    assert_eq!(arguments, "office --strategy=frontier --start=0 --seed=0");
}

#[test]
fn bad_files_are_refused_with_their_line() {
    let base = "worlds = [\"office\"]\nstrategies = [\"frontier\"]\n";
    for (more, words) in [
        (
            "word = []",
            ["c.toml:3:", "unknown field `word`", "did you mean worlds?"],
        ),
        (
            "seeds = \"0-10\"",
            ["c.toml:3:", "`seeds`: '0-10'", "0..10"],
        ),
        ("seeds = true", ["c.toml:3:", "`seeds`", "0..10"]),
        ("starts = [1, -1]", ["c.toml:3:", "`starts`: '-1'", "say 3"]),
        (
            "starts = \"0..2,1\"",
            ["c.toml:3:", "`starts`", "1 is there twice"],
        ),
        (
            "\nodometry = 3",
            ["c.toml:4:", "`odometry`", "list of texts"],
        ),
        (
            "slam = [\"off\", \"off\"]",
            ["c.toml:3:", "`slam`", "off twice"],
        ),
        (
            "baseline = \"bvp\"",
            ["c.toml:3:", "`baseline` bvp", "frontier"],
        ),
        (
            "columns = [\"a..b\"]",
            ["c.toml:3:", "'a..b'", "coverage.fraction"],
        ),
        ("name = \"a/b\"", ["c.toml:3:", "'a/b'", "letters"]),
        ("shard = \"4/4\"", ["c.toml:3:", "out of range", "3/4"]),
        (
            "[options]\nseed = 3",
            ["c.toml:4:", "`seed`", "list `seeds`"],
        ),
        (
            "[options]\nx = 1\norder = [1]",
            ["c.toml:5:", "`order`", "list of texts"],
        ),
        (
            "[[variants]]\nname = \"x\"",
            ["c.toml:", "missing field", "`strategy`"],
        ),
        ("worlds = 1", ["c.toml:3:", "duplicate key", ""]),
        ("x = = 1", ["c.toml:3:", "", ""]),
    ] {
        refused(&format!("{base}{more}\n"), &words);
    }
    let no_worlds = "strategies = [\"bvp\"]";
    refused(no_worlds, &["c.toml", "missing field `worlds`"]);
    let no_strategy = "worlds = [\"a\"]\nstrategies = []";
    refused(no_strategy, &["`strategies` is empty"]);
    let twice = "worlds = [\"a\",\n\"a\"]\nstrategies = [\"bvp\"]";
    refused(twice, &["`worlds` has a twice"]);
}

#[test]
fn strategies_whose_default_odometry_differs_need_one() {
    let text = "worlds = [\"a\"]\nstrategies = [\"bvp\", \"frontier\"]\n";
    let error = read(text).check_odometry().unwrap_err().to_string();
    assert!(
        error.contains("frontier and bvp have different odometry by default"),
        "{error}"
    );
    let plan = read(&format!("{text}odometry = \"truth\""));
    assert_eq!(plan.check_odometry(), Ok(()));
    let own = "odometry = [\"truth\", \"noisy\"]\n[[variants]]\nname = \"x\"\n\
               strategy = \"frontier\"\nodometry = \"papers\"";
    refused(
        &format!("{text}{own}"),
        &["variant x has an odometry of its own"],
    );
}

#[test]
fn words_of_the_command_line_are_options() {
    let words = |text: &str| -> Vec<String> { text.split(' ').map(Into::into).collect() };
    let read = options(&words(
        "--time-limit 60 --order=nearest --resume --tune a=1 --tune b=2",
    ));
    let text = |text: &str| Setting::Text(text.into());
    let wanted = [
        ("order", text("nearest")),
        ("resume", Setting::Flag(true)),
        ("time-limit", text("60")),
        ("tune", Setting::Several(vec!["a=1".into(), "b=2".into()])),
    ];
    let wanted = wanted.map(|(name, setting)| (name.to_owned(), setting));
    assert_eq!(read.unwrap().into_iter().collect::<Vec<_>>(), wanted);
    for (bad, word) in [
        ("office", "'office' after --"),
        ("--seed 3", "list `seeds`"),
        ("--resume --resume=x", "with and without a value"),
    ] {
        let error = options(&words(bad)).unwrap_err().to_string();
        assert!(error.contains(word), "{error}");
    }
}

use std::fs;

use serde_json::value::RawValue;

use super::{Finished, Measured, Store, read_plan};
use crate::campaign::plan::Plan;
use crate::campaign::shards::{self, Shard};
use crate::campaign::{TRIALS_FILE, spec};

/// Returns the line of a trial of [`plan`] with the sample report and this time.
pub(in crate::campaign) fn finished(
    index: usize,
    world: &str,
    strategy: &str,
    sim_time_s: f64,
) -> Finished {
    let report = include_str!("../../report/sample.json").replace('\n', "");
    let report = report.replace("312.4", &sim_time_s.to_string());
    let trial = plan()
        .trials()
        .into_iter()
        .nth(index)
        .expect("a trial of the plan");
    Finished {
        world: world.into(),
        strategy: strategy.into(),
        failure: None,
        trial: Some(Measured {
            explored: true,
            below_1m: Some(0.9),
            wall_s: 1.5,
        }),
        coverage: vec![[0.0, 0.2], [sim_time_s / 2.0, 0.6], [sim_time_s, 0.99]],
        report: RawValue::from_string(report).ok(),
        ..Finished::failed(&trial, String::new())
    }
}

/// Two worlds, two strategies, three seeds: twelve trials.
pub(in crate::campaign) fn plan() -> Plan {
    let text = "worlds = [\"office\", \"cave\"]\nstrategies = [\"frontier\", \"ouroboros\"]\n\
                seeds = \"0..3\"\nbaseline = \"frontier\"";
    let spec = spec::parse(text, "c.toml".as_ref(), "sample");
    spec.expect("a good campaign").plan
}

/// All trials of the plan; their times grow with their number.
pub(in crate::campaign) fn all() -> Vec<Finished> {
    let trials = plan().trials();
    let line = |trial: &crate::campaign::plan::Trial| {
        let time_s = 100.0 + 10.0 * trial.index as f64;
        finished(trial.index, &trial.world, &trial.arm.label, time_s)
    };
    trials.iter().map(line).collect()
}

fn error<T>(result: Result<T, crate::campaign::CampaignError>) -> String {
    match result {
        Ok(_) => panic!("not refused"),
        Err(error) => error.to_string(),
    }
}

#[test]
fn a_folder_is_taken_up_where_it_was_left() {
    let folder = tempfile::tempdir().unwrap();
    let mut store = Store::open(folder.path(), &plan(), None, false).unwrap();
    for line in all().into_iter().take(5) {
        store.append(line).unwrap();
    }
    drop(store);
    let store = Store::open(folder.path(), &plan(), None, false).unwrap();
    assert_eq!((store.finished.len(), store.notes.len()), (5, 0));
    let open: Vec<usize> = store
        .open_trials(plan().trials())
        .iter()
        .map(|it| it.index)
        .collect();
    assert_eq!(open, [5, 6, 7, 8, 9, 10, 11]);
    let (kept, shard) = read_plan(folder.path()).unwrap();
    assert_eq!((kept, shard), (plan(), None));
}

#[test]
fn a_torn_last_line_is_cut_off_wherever_it_is_torn() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(TRIALS_FILE);
    let mut store = Store::open(folder.path(), &plan(), None, false).unwrap();
    for line in all().into_iter().take(3) {
        store.append(line).unwrap();
    }
    drop(store);
    let whole = fs::read(&path).unwrap();
    let second = whole
        .iter()
        .enumerate()
        .filter(|(_, byte)| **byte == b'\n')
        .nth(1)
        .unwrap()
        .0
        + 1;
    for end in [second + 1, second + 40, whole.len() - 20, whole.len() - 1] {
        fs::write(&path, &whole[..end]).unwrap();
        let mut store = Store::open(folder.path(), &plan(), None, false).unwrap();
        assert_eq!(store.finished.len(), 2, "{end}");
        assert!(
            store.notes[0].contains("trials.jsonl:3: the last line is torn"),
            "{end}"
        );
        store.append(all().remove(2)).unwrap();
        assert_eq!(fs::read(&path).unwrap(), whole, "{end}");
    }
}

#[test]
fn a_bad_line_before_the_last_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(TRIALS_FILE);
    let mut store = Store::open(folder.path(), &plan(), None, false).unwrap();
    for line in all() {
        store.append(line).unwrap();
    }
    drop(store);
    let whole = fs::read_to_string(&path).unwrap();
    let lines: Vec<&str> = whole.lines().collect();
    let with = |number: usize, line: &str| {
        let mut lines = lines.clone();
        lines[number] = line;
        fs::write(&path, lines.join("\n") + "\n").unwrap();
        error(Store::open(folder.path(), &plan(), None, false))
    };
    let torn = with(1, &lines[1][..30]);
    assert!(
        torn.contains("trials.jsonl:2: the line is no result of a trial"),
        "{torn}"
    );
    let twice = with(4, lines[3]);
    assert!(
        twice.contains("trials.jsonl:5: trial 3 is there twice"),
        "{twice}"
    );
    let alien = lines[6].replace("\"seed\":0,\"command\"", "\"seed\":9,\"command\"");
    let alien = with(6, &alien);
    assert!(
        alien.contains("trials.jsonl:7: trial 6 is of another campaign"),
        "{alien}"
    );
}

#[test]
fn another_campaign_and_another_shard_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let shard = Some(Shard { index: 1, of: 4 });
    drop(Store::open(folder.path(), &plan(), shard, false).unwrap());
    let mut other = plan();
    other.seeds.push(7);
    let refusal = error(Store::open(folder.path(), &other, shard, false));
    for word in [
        "campaign.toml: this folder has another campaign",
        "seeds = \"0..3\"",
        "0..3,7",
    ] {
        assert!(refusal.contains(word), "{refusal}");
    }
    let refusal = error(Store::open(folder.path(), &plan(), None, false));
    assert!(
        refusal.contains("has shard 1/4 of the campaign, not the whole"),
        "{refusal}"
    );
    // Columns are no part of the trials.
    other = plan();
    other.columns = vec!["sim_time_s".into()];
    drop(Store::open(folder.path(), &other, shard, false).unwrap());
    fs::remove_file(folder.path().join("campaign.toml")).unwrap();
    let refusal = error(Store::open(folder.path(), &plan(), shard, false));
    assert!(
        refusal.contains("there is no campaign.toml beside it"),
        "{refusal}"
    );
}

#[test]
fn two_writers_of_a_folder_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let mut first = Store::open(folder.path(), &plan(), None, false).unwrap();
    let refusal = error(Store::open(folder.path(), &plan(), None, false));
    assert!(refusal.contains("another process writes to"), "{refusal}");
    first.rewrite().unwrap();
    let refusal = error(Store::open(folder.path(), &plan(), None, false));
    assert!(refusal.contains("another process writes to"), "{refusal}");
}

#[test]
fn failed_trials_stay_unless_they_are_to_run_again() {
    let folder = tempfile::tempdir().unwrap();
    let mut store = Store::open(folder.path(), &plan(), None, false).unwrap();
    store.append(all().remove(0)).unwrap();
    let failed = Finished::failed(&plan().trials()[1], "panicked".into());
    store.append(failed).unwrap();
    drop(store);
    let count = |retry| {
        let store = Store::open(folder.path(), &plan(), None, retry).unwrap();
        store.finished.len()
    };
    assert_eq!((count(false), count(true), count(false)), (2, 1, 1));
}

/// Writes all shards of the plan but those left out, each with its trials.
fn shards(of: usize, without: &[usize]) -> (tempfile::TempDir, Vec<std::path::PathBuf>) {
    let root = tempfile::tempdir().unwrap();
    let mut folders = Vec::new();
    for index in (0..of).filter(|index| !without.contains(index)) {
        let folder = root.path().join(index.to_string());
        let shard = Shard { index, of };
        let mut store = Store::open(&folder, &plan(), Some(shard), false).unwrap();
        for line in all().into_iter().filter(|line| line.index % of == index) {
            store.append(line).unwrap();
        }
        folders.push(folder);
    }
    (root, folders)
}

#[test]
fn shards_in_any_order_merge_to_the_whole() {
    let (root, mut folders) = shards(5, &[]);
    folders.reverse();
    let out = root.path().join("out");
    for _ in 0..2 {
        let (merged, finished) = shards::merge(&folders, &out).unwrap();
        assert_eq!(merged, plan());
        let indices: Vec<usize> = finished.iter().map(|line| line.index).collect();
        assert_eq!(indices, (0..12).collect::<Vec<_>>());
        // The merged folder is that of a campaign that ran whole.
        let store = Store::open(&out, &plan(), None, false).unwrap();
        assert!(store.open_trials(plan().trials()).is_empty());
    }
}

#[test]
fn shards_that_do_not_belong_together_are_refused() {
    let (root, folders) = shards(4, &[1, 2]);
    let out = root.path().join("out");
    let refusal = error(shards::merge(&folders, &out));
    assert!(
        refusal.contains("2 of 4 shards are missing: 1/4, 2/4"),
        "{refusal}"
    );
    let twice = [folders[0].clone(), folders[0].clone()];
    let refusal = error(shards::merge(&twice, &out));
    assert!(refusal.contains("shard 0/4 is also in"), "{refusal}");
    let (_other, of_two) = shards(2, &[]);
    let refusal = error(shards::merge(
        &[folders[0].clone(), of_two[0].clone()],
        &out,
    ));
    assert!(refusal.contains("this is one of 2 shards"), "{refusal}");
    assert!(!out.exists(), "nothing was written");

    let mut other = plan();
    other
        .options
        .insert("people".into(), crate::campaign::plan::Setting::Whole(3));
    let alien = root.path().join("alien");
    drop(Store::open(&alien, &other, Some(Shard { index: 1, of: 4 }), false).unwrap());
    let refusal = error(shards::merge(&[folders[0].clone(), alien], &out));
    assert!(refusal.contains("not the campaign of"), "{refusal}");

    let whole = root.path().join("whole");
    drop(Store::open(&whole, &plan(), None, false).unwrap());
    let refusal = error(shards::merge(&[whole], &out));
    assert!(refusal.contains("a whole campaign, no shard"), "{refusal}");

    let begun = root.path().join("begun");
    drop(Store::open(&begun, &plan(), Some(Shard { index: 1, of: 4 }), false).unwrap());
    let refusal = error(shards::merge(&[begun], &out));
    assert!(
        refusal.contains("shard 1/4 has 0 of its 3 trials"),
        "{refusal}"
    );
}

use std::fs;

use super::{COLOURS, write};
use crate::campaign::store::Finished;
use crate::campaign::store::tests::{all, plan};

#[test]
fn every_plot_names_its_axes_worlds_and_strategies() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &plan(), &all()).unwrap();
    let read = |name: &str| fs::read_to_string(folder.path().join("plots").join(name)).unwrap();
    let time = read("time.svg");
    for word in [
        "office",
        "cave",
        "frontier",
        "ouroboros",
        "simulated time to the end, s",
    ] {
        assert!(time.contains(word), "{word}");
    }
    // A dot for each trial.
    assert_eq!(time.matches("<circle").count(), 12);
    let coverage = read("coverage-cave.svg");
    for word in [
        "cave",
        "frontier",
        "ouroboros",
        "simulated time, s",
        "known, %",
    ] {
        assert!(coverage.contains(word), "{word}");
    }
    assert_eq!(
        coverage.matches("<polygon").count(),
        2,
        "a band for each strategy"
    );
    assert!(read("error.svg").contains("mean error of the position, m"));
}

#[test]
fn without_a_result_there_is_no_plot() {
    let folder = tempfile::tempdir().unwrap();
    let failed = Finished::failed(&plan().trials()[0], "no device".into());
    write(folder.path(), &plan(), &[failed]).unwrap();
    assert_eq!(
        fs::read_dir(folder.path().join("plots")).unwrap().count(),
        0
    );
}

#[test]
fn colours_differ() {
    for (index, colour) in COLOURS.iter().enumerate() {
        assert!(!COLOURS[..index].contains(colour), "{index}");
    }
}

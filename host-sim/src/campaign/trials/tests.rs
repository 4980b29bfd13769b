use core::sync::atomic::{AtomicUsize, Ordering};

use fieldline_protocol::message::Command;

use super::{Crew, Explore, run};
use crate::campaign::store::Finished;
use crate::campaign::store::tests::plan;
use crate::report::Report;
use crate::report::tum::Stamped;
use crate::trial::{Flow, Progress, Record, Watch};

/// Steps of a run of [`Fake`].
const STEPS: u32 = 400;

/// Runs that take no time: one panics, one cannot begin.
struct Fake {
    began: AtomicUsize,
}

fn sample() -> Report {
    serde_json::from_str(include_str!("../../report/sample.json")).expect("a report")
}

impl Explore for Fake {
    fn explore(
        &self,
        arguments: &[String],
        watch: &mut dyn Watch,
    ) -> Result<(Report, Record), String> {
        self.began.fetch_add(1, Ordering::Relaxed);
        let is = |argument: &str| arguments.iter().any(|it| it == argument);
        if arguments[0] == "cave" && is("--seed=1") {
            assert!(is("--strategy=frontier"), "the sky falls");
            return Err("no device".into());
        }
        for step in 0..STEPS {
            let flow = watch.step(&Progress {
                time_ms: step * 1_000,
                coverage: f64::from(step) / f64::from(STEPS),
                path_m: 0.0,
                estimate: Stamped::default(),
                command: Command::default(),
            });
            if flow == Flow::Interrupt {
                break;
            }
        }
        Ok((sample(), Record::default()))
    }
}

/// Runs the plan on so many threads, and interrupts it once more than `stop` trials have begun.
fn results(jobs: usize, stop: usize) -> (Vec<Finished>, usize) {
    let explorer = Fake {
        began: AtomicUsize::new(0),
    };
    let crew = Crew {
        explorer: &explorer,
        jobs,
        interrupted: &|| explorer.began.load(Ordering::Relaxed) > stop,
    };
    let mut finished = Vec::new();
    run(&crew, &plan().trials(), &mut |line| {
        finished.push(line);
        Ok(())
    })
    .unwrap();
    finished.sort_by_key(|line| line.index);
    (finished, explorer.began.into_inner())
}

fn without_wall_time(finished: &[Finished]) -> Vec<String> {
    let line = |line: &Finished| {
        let mut line = line.clone();
        if let Some(trial) = &mut line.trial {
            trial.wall_s = 0.0;
        }
        serde_json::to_string(&line).unwrap()
    };
    finished.iter().map(line).collect()
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let (one, began) = results(1, usize::MAX);
    assert_eq!((one.len(), began), (12, 12));
    let (many, _) = results(7, usize::MAX);
    assert_eq!(without_wall_time(&one), without_wall_time(&many));
}

#[test]
fn a_panic_and_an_error_are_the_failures_of_their_trials() {
    let (finished, _) = results(3, usize::MAX);
    let failures: Vec<(usize, &str)> = finished
        .iter()
        .filter_map(|line| Some((line.index, line.failure.as_deref()?)))
        .collect();
    let [(7, error), (10, panic)] = failures[..] else {
        panic!("{failures:?}");
    };
    assert_eq!(error, "no device");
    assert!(
        panic.contains("panicked at") && panic.contains("trials/tests.rs"),
        "{panic}"
    );
    assert!(panic.ends_with("the sky falls"), "{panic}");
    assert!(finished[10].report.is_none() && finished[9].report.is_some());
}

#[test]
fn an_interrupted_trial_leaves_no_result() {
    let (finished, began) = results(1, 3);
    assert_eq!((finished.len(), began), (3, 4));
    // Of three trials on two threads, the second thread's may be given up too, but never halved.
    let (finished, _) = results(2, 3);
    assert!((2..=3).contains(&finished.len()), "{}", finished.len());
    for line in finished {
        assert_eq!(
            line.coverage.last(),
            Some(&[f64::from(STEPS) - 1.0, 0.9975])
        );
    }
}

#[test]
fn a_writer_that_fails_ends_the_campaign() {
    let explorer = Fake {
        began: AtomicUsize::new(0),
    };
    let crew = Crew {
        explorer: &explorer,
        jobs: 1,
        interrupted: &|| false,
    };
    let full = || crate::campaign::CampaignError::new("the disk is full");
    let result = run(&crew, &plan().trials(), &mut |_| Err(full()));
    assert_eq!(result, Err(full()));
    assert!(explorer.began.into_inner() < 12);
}

#[test]
fn coverage_is_kept_evenly_from_the_first_step_to_the_last() {
    let (finished, _) = results(1, 1);
    let coverage = &finished[0].coverage;
    assert!((51..=53).contains(&coverage.len()), "{}", coverage.len());
    assert_eq!(
        (coverage[0], coverage[coverage.len() - 1]),
        ([0.0, 0.0], [399.0, 0.9975])
    );
    let steps = coverage.windows(2).map(|pair| pair[1][0] - pair[0][0]);
    assert!(
        steps.into_iter().all(|step| step > 0.0 && step <= 16.0),
        "{coverage:?}"
    );
}

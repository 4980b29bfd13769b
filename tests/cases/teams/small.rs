//! Teams of two and three robots in small worlds; `golden/teams.txt` has their figures.

use std::sync::LazyLock;

use fieldline_tests::runs::in_parallel;
use fieldline_tests::teams::{TeamRun, table};
use fieldline_tests::{golden, worlds};
use host_sim::report::TeamReport;
use host_sim::world::World;

/// Least share of what can be seen that is known at the end.
const LEAST_COVERAGE: f64 = 0.98;

static LOOP: LazyLock<World> = LazyLock::new(|| worlds::builtin("loop"));
static HALL: LazyLock<World> = LazyLock::new(|| worlds::builtin("hall"));

fn runs() -> Vec<TeamRun<'static>> {
    let radios = ["loss=0", "off", "loss=0.5", "partition@10-70"];
    let mut runs: Vec<TeamRun<'static>> = radios
        .iter()
        .map(|radio| TeamRun {
            radio,
            ..TeamRun::of(&LOOP, 2)
        })
        .collect();
    runs.push(TeamRun {
        radio: "loss=0.3,delay=0.5,duplicate=0.3,reorder=0.3",
        apart: true,
        ..TeamRun::of(&LOOP, 2)
    });
    runs.push(TeamRun {
        leave: &["1@20"],
        ..TeamRun::of(&HALL, 2)
    });
    runs.push(TeamRun {
        leave: &["2@20"],
        join: &["2@50"],
        ..TeamRun::of(&HALL, 3)
    });
    runs
}

static REPORTS: LazyLock<Vec<TeamReport>> = LazyLock::new(|| in_parallel(&runs(), TeamRun::go));

#[test]
fn teams_explore_small_worlds_and_hit_no_wall() {
    let runs = runs();
    let text = table(&runs, &REPORTS).to_string();
    let digests = runs.iter().zip(REPORTS.iter());
    let digests: Vec<_> = digests.map(|(run, report)| run.digest(report)).collect();
    golden::compare_runs("teams", &text, &digests);
    for (run, report) in runs.iter().zip(REPORTS.iter()) {
        let what = run.settings();
        assert!(
            report.whole.explored(),
            "{what}: {:?}",
            report.whole.outcome
        );
        assert_eq!(report.whole.safety.collisions, 0, "{what}");
        let known = report.whole.coverage.fraction;
        assert!(known >= LEAST_COVERAGE, "{what}: {known}");
    }
}

#[test]
fn the_radio_loses_what_it_is_told_to_lose() {
    let report = |radio: &str| {
        let runs = runs();
        let index = runs
            .iter()
            .position(|run| run.radio == radio)
            .expect("a run");
        &REPORTS[index]
    };
    let traffic = |radio: &str| report(radio).radio.traffic;
    assert_eq!(traffic("off").sent, 0);
    assert_eq!(
        (traffic("loss=0").lost, traffic("loss=0").out_of_reach),
        (0, 0)
    );
    let half = traffic("loss=0.5");
    let share = half.lost as f64 / half.sent as f64;
    assert!((share - 0.5).abs() < 0.08, "{half:?}");
    // 300 steps of 0.2 s, two robots.
    assert!(traffic("partition@10-70").out_of_reach >= 600);
}

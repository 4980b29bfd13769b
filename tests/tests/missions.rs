//! Whole explorations with noisy lasers: what must hold of every run, and golden tables of how each went.
//!
//! `golden/missions.txt` has the built-in worlds, one run of each baseline beside them. `tests/run --full` adds
//! `missions-full.txt`, the same worlds with every strategy and seed, and `missions-data.txt`, the worlds drawn by others
//! where there are any. A changed row is a changed behaviour.

use core::fmt::Write as _;
use core::ops::Range;

use fieldline_tests::runs::{self, FRONTIER, Run};
use fieldline_tests::{full, golden, worlds};
use host_sim::report::Report;
use host_sim::world::World;

/// Share of what can be seen that must be known at the end.
const LEAST_COVERAGE: f64 = 0.98;
/// Seeds that were looked at while constants were chosen.
const SEEDS: Range<u64> = 0..5;
/// Seeds that were not.
const HELD_OUT: Range<u64> = 100..105;

fn assert_explored(reports: &[Report]) {
    let mut list = String::new();
    for report in reports.iter().filter(|report| report.strategy == FRONTIER) {
        for fault in runs::faults(report, LEAST_COVERAGE) {
            let _ = writeln!(list, "{} seed {}: {fault}", report.world, report.seed);
        }
    }
    assert!(list.is_empty(), "\n{list}");
}

fn builtins(names: &[&str]) -> Vec<World> {
    names.iter().map(|name| worlds::builtin(name)).collect()
}

#[test]
fn built_in_worlds_are_explored_whole_and_untouched() {
    let worlds = builtins(&worlds::EXPLORABLE);
    let reports = runs::sweep(&runs::each(&worlds, SEEDS, 0..1));
    golden::compare("missions.txt", &runs::table(&reports).to_string());
    assert_explored(&reports);
}

#[test]
fn the_same_seed_gives_the_same_run_and_another_one_another() {
    let world = worlds::builtin("narrow-doors");
    let digest = |seed| {
        let (world, strategy) = (&world, FRONTIER);
        let run = Run {
            world,
            strategy,
            seed,
            start: 0,
        };
        run.go().digest
    };
    assert_eq!(digest(7), digest(7));
    assert_ne!(digest(7), digest(8));
}

/// Nothing can be seen of the one room. The other is looked into through a gap that the robot does not fit through, and left.
#[test]
fn a_room_that_cannot_be_reached_is_looked_into_and_listed() {
    let worlds = builtins(&["unreachable-room"]);
    let reports = runs::sweep(&runs::each(&worlds, SEEDS, 0..0));
    assert_explored(&reports);
    for report in reports {
        let seed = report.seed;
        let left = &report.outcome.residual_frontiers;
        assert!(
            left.iter().any(|frontier| frontier.reason == "unreachable"),
            "seed {seed}: {left:?}"
        );
    }
}

#[test]
fn a_robot_that_starts_boxed_in_says_so() {
    let worlds = builtins(&["boxed-in"]);
    for report in runs::sweep(&runs::each(&worlds, SEEDS, 0..0)) {
        let outcome = (
            report.outcome.status.as_str(),
            report.outcome.reason.as_str(),
        );
        assert_eq!(outcome, ("finished", "boxed-in"), "seed {}", report.seed);
        assert_eq!(report.safety.collisions, 0);
        assert!(report.sim_time_s < 30.0, "{} s", report.sim_time_s);
    }
}

#[test]
fn a_hall_larger_than_the_lasers_see_is_explored() {
    let world = worlds::builtin("empty-hall");
    let [width, height] = world.size_m();
    assert!(
        width > 24.0 && height > 24.0,
        "more than twice their 12 m: from its middle no wall is seen"
    );
    for start in [0, 1] {
        let mission = host_sim::trial::mission::Mission {
            start,
            ..Default::default()
        };
        let mut link = host_sim::link::direct::Direct::new();
        let (report, _) =
            host_sim::trial::mission::explore(&mission, &world, &mut link, &mut runs::Unseen)
                .expect("the start is free");
        assert_eq!(
            runs::faults(&report, LEAST_COVERAGE),
            Vec::<String>::new(),
            "start {start}"
        );
    }
}

/// The tool refuses it; a device that is not asked by the tool says so itself.
#[test]
fn a_start_inside_a_wall_is_refused_by_name_and_remedy() {
    use host_sim::link::direct::Direct;
    use host_sim::trial::mission::{Mission, explore};
    use host_sim::world::{Occupancy, Start};

    let wall = Start {
        x_m: 0.05,
        y_m: 0.05,
        yaw_rad: 0.0,
    };
    let plan: Occupancy = worlds::builtin("office").occupancy().clone();
    let world = World::flat("walled", plan, vec![wall]);
    let error = explore(
        &Mission::default(),
        &world,
        &mut Direct::new(),
        &mut runs::Unseen,
    )
    .expect_err("there is no room for a robot in a wall");
    let text = error.to_string();
    assert!(
        text.contains("walled") && text.contains("robots[0]") && !text.contains('\n'),
        "{text}"
    );
}

#[test]
fn full_tables_of_the_built_in_worlds() {
    if !full() {
        return println!("skipped: FIELDLINE_FULL=1 or tests/run --full asks for it");
    }
    check_all("missions-full.txt", &builtins(&worlds::EXPLORABLE));
}

#[test]
fn full_tables_of_worlds_drawn_by_others() {
    if !full() {
        return println!("skipped: FIELDLINE_FULL=1 or tests/run --full asks for it");
    }
    if let Some(worlds) = worlds::drawn_by_others() {
        check_all("missions-data.txt", &worlds);
    }
}

fn check_all(name: &str, worlds: &[World]) {
    let mut text = String::new();
    let mut reports = Vec::new();
    for (title, seeds) in [
        ("Seeds looked at while constants were chosen", SEEDS),
        ("Seeds held out", HELD_OUT),
    ] {
        let runs = runs::sweep(&runs::each(worlds, seeds.clone(), seeds.clone()));
        let _ = write!(
            text,
            "{title}: {seeds:?}.\n\n{}\nMeans.\n\n{}\nEvery run.\n\n{}\n",
            runs::beside(&runs),
            runs::means(&runs),
            runs::table(&runs)
        );
        reports.extend(runs);
    }
    golden::compare(name, &format!("{}\n", text.trim_end()));
    assert_explored(&reports);
}

//! How much faster a team is than a robot: minutes.

use core::ops::Range;

use fieldline_tests::golden;
use fieldline_tests::runs::in_parallel;
use fieldline_tests::teams::{TeamRun, groups, speed_up, table};
use fieldline_tests::worlds;
use host_sim::world::World;

/// Seeds of every line, of `frontier` in built-in worlds.
const SEEDS: Range<u64> = 0..5;
/// Seeds of every line of the others, whose runs take longer.
const FEW_SEEDS: Range<u64> = 0..2;
/// A radio that loses nothing, and none.
const RADIOS: [&str; 2] = ["loss=0", "off"];
/// Worlds drawn by others: furnished rooms, a warehouse, an office floor, a small lab.
const DATA: [&str; 4] = [
    "ipa_lab_intel_furnitures",
    "nav2_warehouse",
    "patrol_cumberland",
    "stage_autolab",
];

/// Compares the table of these runs. No two robots that talk may touch.
fn measure(file: &str, runs: &[TeamRun<'_>], seeds: &Range<u64>) {
    let reports = in_parallel(runs, TeamRun::go);
    let text = format!(
        "Means over seeds {seeds:?}.\n\n{}\nEvery run.\n\n{}",
        speed_up(runs, &reports),
        table(runs, &reports)
    );
    golden::compare(file, &text);
    for (run, report) in runs.iter().zip(&reports) {
        if run.radio != "off" {
            let what = format!("{}, {}", run.world.name(), run.settings());
            assert_eq!(report.whole.safety.robot_contacts.unwrap_or(0), 0, "{what}");
        }
    }
}

#[test]
#[ignore = "takes minutes: 240 runs of up to four robots; tests/run --full runs it"]
fn two_three_and_four_robots_beside_one() {
    let worlds = worlds::builtins(&["office", "hall", "cave"]);
    measure(
        "teams-full.txt",
        &groups(&worlds, "frontier", &RADIOS, &SEEDS),
        &SEEDS,
    );
}

#[test]
#[ignore = "takes minutes: 48 runs of up to four robots; tests/run --full runs it"]
fn esbpf_by_two_three_and_four_robots_beside_one() {
    let worlds = worlds::builtins(&["office", "hall", "cave"]);
    measure(
        "teams-space-full.txt",
        &groups(&worlds, "esbpf", &RADIOS[..1], &FEW_SEEDS),
        &FEW_SEEDS,
    );
}

mod data {
    use super::*;

    #[test]
    #[ignore = "needs worlds drawn by others (FIELDLINE_DATA) and takes ten minutes"]
    fn teams_in_worlds_drawn_by_others() {
        let mut worlds = worlds::drawn_by_others();
        worlds.retain(|world: &World| DATA.contains(&world.name()));
        assert_eq!(worlds.len(), DATA.len(), "{DATA:?}");
        measure(
            "teams-data.txt",
            &groups(&worlds, "frontier", &RADIOS, &FEW_SEEDS),
            &FEW_SEEDS,
        );
    }
}

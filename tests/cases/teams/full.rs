//! How much faster a team is than a robot: minutes.

use core::ops::Range;

use fieldline_tests::runs::in_parallel;
use fieldline_tests::teams::{TeamRun, speed_up, table};
use fieldline_tests::{golden, worlds};

/// Seeds of every line.
const SEEDS: Range<u64> = 0..5;

#[test]
#[ignore = "takes minutes: 240 runs of up to four robots; tests/run --full runs it"]
fn two_three_and_four_robots_beside_one() {
    let worlds = worlds::builtins(&["office", "hall", "cave"]);
    let mut runs = Vec::new();
    for world in &worlds {
        for (apart, radio) in [
            (false, "loss=0"),
            (false, "off"),
            (true, "loss=0"),
            (true, "off"),
        ] {
            for robots in 1..=4 {
                runs.extend(SEEDS.map(|seed| TeamRun {
                    apart,
                    radio,
                    seed,
                    ..TeamRun::of(world, robots)
                }));
            }
        }
    }
    let reports = in_parallel(&runs, TeamRun::go);
    let text = format!(
        "Means over seeds {SEEDS:?}.\n\n{}\nEvery run.\n\n{}",
        speed_up(&runs, &reports),
        table(&runs, &reports)
    );
    golden::compare("teams-full.txt", &text);
}

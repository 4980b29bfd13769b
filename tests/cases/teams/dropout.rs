//! Three robots of which one leaves, or whose radio fails: minutes. `golden/teams-dropout.txt` has
//! the figures beside those of the whole team.

use core::ops::Range;

use fieldline_tests::runs::in_parallel;
use fieldline_tests::teams::{TeamRun, dropouts};
use fieldline_tests::{golden, worlds};

/// Seeds of every line.
const SEEDS: Range<u64> = 0..5;
/// Least share of what can be seen that is known at the end.
const LEAST_COVERAGE: f64 = 0.98;

mod full {
    use super::*;

    #[test]
    #[ignore = "takes minutes: 70 runs of three robots; tests/run --full runs it"]
    fn a_team_explores_whoever_leaves_and_whatever_the_air_does() {
        let worlds = worlds::builtins(&["office", "cave"]);
        let mut runs = Vec::new();
        for world in &worlds {
            let whole = TeamRun::of(world, 3);
            let kinds = [
                whole,
                TeamRun {
                    leave: &["1@30"],
                    ..whole
                },
                TeamRun {
                    leave: &["1@30"],
                    join: &["1@60"],
                    ..whole
                },
                TeamRun {
                    radio: "loss=0.5",
                    ..whole
                },
                TeamRun {
                    radio: "partition@20-80",
                    ..whole
                },
                TeamRun {
                    radio: "duplicate=0.5,delay=0.5,reorder=0.5",
                    ..whole
                },
                TeamRun {
                    radio: "off",
                    ..whole
                },
            ];
            for kind in kinds {
                runs.extend(SEEDS.map(|seed| TeamRun { seed, ..kind }));
            }
        }
        let ended = in_parallel(&runs, TeamRun::go_recorded);
        let table = dropouts(&runs, &ended);
        golden::compare("teams-dropout.txt", &format!("Seeds {SEEDS:?}.\n\n{table}"));
        for (run, (report, _)) in runs.iter().zip(&ended) {
            let what = format!(
                "{}, {}, seed {}",
                run.world.name(),
                run.settings(),
                run.seed
            );
            assert!(
                report.whole.explored(),
                "{what}: {:?}",
                report.whole.outcome
            );
            assert_eq!(report.whole.safety.collisions, 0, "{what}");
            let known = report.whole.coverage.fraction;
            assert!(known >= LEAST_COVERAGE, "{what}: {known}");
            if run.radio != "off" {
                assert_eq!(report.team.maps_equal, Some(true), "{what}");
            }
        }
    }
}

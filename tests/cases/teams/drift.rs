//! Teams whose odometry drifts, and whose starts are known or only roughly known, beside the truth.
//! `golden/teams-drift.txt` has two robots in one world. `golden/teams-drift-full.txt` has two and
//! three robots in three worlds.

use core::ops::Range;

use fieldline_tests::runs::in_parallel;
use fieldline_tests::teams::{TeamRun, alignment};
use fieldline_tests::{golden, worlds};
use host_sim::report::TeamReport;
use host_sim::report::team::Agreement;
use host_sim::trial::mission::OdometryProfile;
use host_sim::world::World;

/// Standard deviations of a robot that somebody put there by hand: 0.3 m and 5°.
const BY_HAND: &str = "0.3,5";
/// Greatest median of the error of the motion between two maps after the robots met.
const MOST_APART_M: f64 = 0.1;
const MOST_APART_DEG: f64 = 1.0;

/// Returns true if the maps of two robots agree in the median of a run.
fn is_one_map(apart: &Agreement) -> bool {
    apart.median_m <= MOST_APART_M && apart.median_deg <= MOST_APART_DEG
}

/// Returns the runs in a world: the truth, odometry that drifts, and starts known only roughly.
pub(crate) fn settings(world: &World, robots: usize, seed: u64) -> [TeamRun<'_>; 3] {
    let truth = TeamRun {
        seed,
        ..TeamRun::of(world, robots)
    };
    let drifts = TeamRun {
        odometry: OdometryProfile::Noisy,
        ..truth
    };
    let by_hand = TeamRun {
        start_error: BY_HAND,
        ..drifts
    };
    [truth, drifts, by_hand]
}

fn go(worlds: &[World], teams: &[usize], seeds: Range<u64>) -> (String, Vec<TeamReport>) {
    let kinds = worlds
        .iter()
        .flat_map(|world| teams.iter().map(move |robots| (world, *robots)));
    let runs: Vec<TeamRun<'_>> = kinds
        .flat_map(|(world, robots)| {
            let all = seeds.clone().map(move |seed| settings(world, robots, seed));
            all.flatten()
        })
        .collect();
    let reports = in_parallel(&runs, TeamRun::go);
    (alignment(&runs, &reports).to_string(), reports)
}

/// Two robots in the cave, which has no two places alike: they end with one map. Chance decides how
/// well a single team agrees, so one of five may fail. `known_red` asks it of every team.
#[test]
fn robots_with_rough_starts_agree_on_one_map() {
    let (text, reports) = go(&worlds::builtins(&["cave"]), &[2], 0..5);
    golden::compare("teams-drift.txt", &text);
    for report in &reports {
        let what = report.headline();
        assert!(report.whole.explored(), "{what}");
    }
    let drifts: Vec<_> = reports.iter().skip(1).step_by(3).collect();
    let by_hand: Vec<_> = reports.iter().skip(2).step_by(3).collect();
    for kind in [drifts, by_hand] {
        let apart: Vec<_> = kind.iter().filter_map(|it| it.team.agreement).collect();
        let agree = apart.iter().filter(|it| is_one_map(it)).count();
        assert!(apart.len() == 5 && agree >= 4, "{apart:?}");
        assert!(kind.iter().all(|it| it.team.maps_equal == Some(true)));
    }
}

mod known_red {
    use super::*;

    #[test]
    #[ignore = "of ten teams with drift two are 0.12 and 0.17 m apart, one of them 2.2 degrees"]
    fn every_team_agrees_on_one_map() {
        let (_, reports) = go(&worlds::builtins(&["cave"]), &[2], 0..5);
        for report in reports.chunks(3).flat_map(|of_seed| of_seed.iter().skip(1)) {
            let apart = report.team.agreement.expect("the robots met");
            assert!(is_one_map(&apart), "{apart:?}");
        }
    }
}

mod full {
    use super::*;

    #[test]
    #[ignore = "takes minutes: 90 runs of two and three robots; tests/run --full runs it"]
    fn teams_with_drift_beside_the_truth() {
        let worlds = worlds::builtins(&["office", "hall", "cave"]);
        let (text, reports) = go(&worlds, &[2, 3], 0..5);
        golden::compare("teams-drift-full.txt", &text);
        let apart = reports.iter().filter_map(|report| report.team.agreement);
        let mut medians_m: Vec<f64> = apart.map(|it| it.median_m).collect();
        medians_m.sort_by(f64::total_cmp);
        assert!(
            medians_m[medians_m.len() / 2] <= MOST_APART_M,
            "{medians_m:?}"
        );
    }
}

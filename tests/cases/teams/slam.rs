//! Loops closed by a graph beside the link of each robot of a team.
//!
//! `golden/team-slam.txt` has two robots with the papers' odometry, with and without the graphs.

use fieldline_tests::runs::in_parallel;
use fieldline_tests::table::{Table, number};
use fieldline_tests::teams::{CONTACTS, Column, END, EQUAL_MAPS, HITS, TeamRun, by_run};
use fieldline_tests::{golden, worlds};
use host_sim::link::Link;
use host_sim::link::loopback::loopback;
use host_sim::report::TeamReport;
use host_sim::slam::{SlamPlace, SlamReport};
use host_sim::trial::mission::OdometryProfile;
use host_sim::world::World;

const PLACES: [SlamPlace; 2] = [SlamPlace::Off, SlamPlace::Host];

fn run(world: &World, slam: SlamPlace, seed: u64) -> TeamRun<'_> {
    TeamRun {
        odometry: OdometryProfile::Papers,
        slam,
        seed,
        ..TeamRun::of(world, 2)
    }
}

fn slams(report: &TeamReport) -> impl Iterator<Item = &SlamReport> {
    let robots = report.robots.iter();
    robots.filter_map(|robot| robot.report.slam.as_ref())
}

fn corrections(report: &TeamReport) -> usize {
    slams(report).map(|slam| slam.corrections).sum()
}

/// Returns the error of each robot's pose, in the mean of its steps or at most, metres.
fn errors(report: &TeamReport, is_mean: bool) -> String {
    let error = |robot: &host_sim::report::team::Robot| {
        let at = &robot.report.localization;
        number(
            if is_mean {
                at.mean_error_m
            } else {
                at.max_error_m
            },
            2,
        )
    };
    let errors: Vec<String> = report.robots.iter().map(error).collect();
    errors.join("/")
}

fn table(runs: &[TeamRun<'_>], reports: &[TeamReport]) -> Table {
    let columns: [Column; 8] = [
        END,
        ("error m", |_, it| errors(it, true)),
        ("most m", |_, it| errors(it, false)),
        ("closed", |_, it| {
            let closed = slams(it).map(|slam| slam.closed);
            closed.sum::<usize>().to_string()
        }),
        ("corrections", |_, it| corrections(it).to_string()),
        HITS,
        CONTACTS,
        EQUAL_MAPS,
    ];
    by_run(&columns, runs, reports)
}

/// The robots' maps are equal at the end, so a peer has no wall of a tile from before a correction.
#[test]
fn a_team_corrects_its_maps_and_they_are_equal() {
    let worlds = worlds::builtins(&["office", "ouroboros-a"]);
    let runs: Vec<TeamRun<'_>> = worlds
        .iter()
        .flat_map(|world| (0..2).map(move |seed| (world, seed)))
        .flat_map(|(world, seed)| PLACES.map(|slam| run(world, slam, seed)))
        .collect();
    let reports = in_parallel(&runs, TeamRun::go);
    let digests = runs.iter().zip(&reports);
    let digests: Vec<_> = digests.map(|(run, report)| run.digest(report)).collect();
    golden::compare_runs("team-slam", &table(&runs, &reports).to_string(), &digests);
    for (run, report) in runs.iter().zip(&reports) {
        let what = format!("{} {}", run.settings(), run.seed);
        assert_eq!(report.whole.safety.collisions, 0, "{what}");
        assert_eq!(report.whole.safety.robot_contacts, Some(0), "{what}");
        assert_eq!(report.team.maps_equal, Some(true), "{what}");
        let follows = (run.slam == SlamPlace::Host).then_some(true);
        assert_eq!(report.whole.debug.map_matches_mirror, follows, "{what}");
    }
    let corrected = reports.iter().filter(|report| corrections(report) > 0);
    assert!(corrected.count() > 1, "no two runs closed a loop");
}

#[test]
fn a_teams_corrections_are_the_same_over_bytes() {
    let worlds = worlds::builtins(&["office"]);
    let run = run(&worlds[0], SlamPlace::Host, 0);
    let by_call = run.go();
    let link = |_| -> Box<dyn Link> { Box::new(loopback()) };
    let (by_bytes, _) = run.go_by((0..run.robots).map(link).collect());
    assert_eq!(by_call.whole.digest, by_bytes.whole.digest);
    assert!(slams(&by_call).eq(slams(&by_bytes)));
    assert!(corrections(&by_call) > 2, "{}", corrections(&by_call));
}

/// Robots that do not know their starts keep maps of their own until they are certain; a graph
/// corrects such a map, too, and follows it into the team's coordinates.
#[test]
fn a_graph_follows_its_map_into_the_teams_coordinates() {
    let worlds = worlds::builtins(&["office"]);
    let run = TeamRun {
        start_error: "0.3,5",
        ..run(&worlds[0], SlamPlace::Host, 0)
    };
    let report = run.go();
    let met = report.robots.iter().filter(|robot| robot.met_s.is_some());
    assert_eq!(met.count(), 2, "both came into the team's coordinates");
    assert_eq!(report.whole.debug.map_matches_mirror, Some(true));
    assert_eq!(report.team.maps_equal, Some(true));
    assert_eq!(report.whole.safety.collisions, 0);
}

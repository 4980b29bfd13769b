//! Whole runs of teams in the simulator: several robots, the radio, leaving and joining.

use host_sim::link::Link;
use host_sim::link::direct::Direct;
use host_sim::report::{Report, TeamReport};
use host_sim::trial::mission::{self, Mission};
use host_sim::trial::team::{Appointment, TeamError, TeamMission, TeamRecord, Timetable, explore};
use host_sim::world::World;

fn world() -> World {
    World::builtin("loop").expect("built in")
}

fn mission() -> Mission {
    Mission {
        seed: 3,
        ..Mission::default()
    }
}

fn links(robots: usize) -> Vec<Box<dyn Link>> {
    let link = |_| -> Box<dyn Link> { Box::new(Direct::new()) };
    (0..robots).map(link).collect()
}

fn run(team: &TeamMission) -> (TeamReport, TeamRecord) {
    let run = explore(team, &world(), &mut links(team.robots), &mut ());
    run.expect("the team begins")
}

fn radio(team: TeamMission, spec: &str) -> TeamMission {
    TeamMission {
        radio: spec.parse().expect("a radio"),
        ..team
    }
}

fn short(time_limit_ms: u32) -> Mission {
    Mission {
        time_limit_ms,
        ..mission()
    }
}

fn at(text: &str) -> Vec<Appointment> {
    vec![text.parse().expect("an appointment")]
}

#[test]
fn a_team_of_one_is_the_robot_alone() {
    let (alone, _) = mission::explore(&mission(), &world(), &mut Direct::new(), &mut ())
        .expect("the robot begins");
    let (team, record) = run(&radio(TeamMission::of(mission(), 1), "off"));
    assert_eq!(team.whole.digest, alone.digest);
    assert_eq!(team.robots[0].report.digest, alone.digest);
    assert_eq!(team.whole.coverage, alone.coverage);
    assert_eq!(team.whole.outcome, alone.outcome);
    assert_eq!(team.whole.steps, alone.steps);
    // The team's is measured on the positions of the record, which are rounded for the wire.
    let overlap = |report: &Report| report.path_overlap.expect("measured");
    assert!((overlap(&team.whole) - overlap(&alone)).abs() < 1e-3);
    assert_eq!(team.whole.debug.map_matches_mirror, Some(true));
    assert_eq!(team.whole.safety.robot_contacts, Some(0));
    assert_eq!(
        (team.team.driven_after_another, team.team.measured_twice),
        (0.0, 0.0)
    );
    assert_eq!(record.robots.len(), 1);
}

#[test]
fn the_same_settings_give_the_same_run() {
    let spec = "range=8,loss=0.3,delay=0.5,duplicate=0.2,reorder=0.2,partition@10-20";
    let team = radio(TeamMission::of(short(40_000), 3), spec);
    let facts = |report: &TeamReport| {
        let team = (report.radio.traffic, report.team.clone());
        (report.whole.digest.clone(), report.whole.coverage, team)
    };
    let first = run(&team).0;
    assert_eq!(facts(&first), facts(&run(&team).0));
    let traffic = first.radio.traffic;
    assert!(
        traffic.lost > 0 && traffic.heard > 0 && traffic.out_of_reach > 0,
        "{traffic:?}"
    );
    assert_eq!(first.whole.outcome.status, "time-limit");
    let other = TeamMission {
        mission: Mission {
            seed: 4,
            ..short(40_000)
        },
        ..team
    };
    assert_ne!(first.whole.digest, run(&other).0.whole.digest);
}

#[test]
fn robots_without_a_radio_explore_alone_and_the_team_knows_what_all_know() {
    let (report, record) = run(&radio(TeamMission::of(mission(), 2), "off"));
    assert_eq!(report.radio.traffic.sent, 0);
    assert_eq!(report.team.maps_equal, None);
    assert_eq!(report.whole.debug.map_matches_mirror, Some(true));
    assert_eq!(report.whole.safety.collisions, 0);
    let own = |k: usize| report.robots[k].report.coverage;
    let team = report.whole.coverage;
    assert!(team.fraction >= own(0).fraction.max(own(1).fraction));
    for milestone in [team.t90_s.zip(own(0).t90_s), team.t90_s.zip(own(1).t90_s)] {
        let (of_team, of_robot) = milestone.expect("both know 90 %");
        assert!(of_team <= of_robot);
    }
    let known = |k: usize| record.robots[k].map.known();
    assert!(record.map.known() >= known(0).max(known(1)));
    let lengths = |k: usize| report.robots[k].report.path_length_m;
    assert_eq!(report.whole.path_length_m, lengths(0) + lengths(1));
}

#[test]
fn a_robot_that_leaves_stands_and_is_silent_and_joins_with_an_empty_map() {
    let team = TeamMission {
        timetable: Timetable {
            leave: at("1@20"),
            join: at("1@40"),
        },
        ..TeamMission::of(short(60_000), 2)
    };
    let (report, record) = run(&team);
    assert_eq!(report.team.timetable, ["leave 1@20", "join 1@40"]);
    assert_eq!((report.robots[0].boots, report.robots[1].boots), (1, 2));
    let times = record.robots[1].steps.iter().map(|step| step.truth.time_ms);
    let times: Vec<u32> = times.collect();
    let gap = times.windows(2).find(|pair| pair[1] - pair[0] > 200);
    assert_eq!(gap, Some(&[19_800, 40_000][..]));
    let place = |time_ms: u32| {
        let mut steps = record.robots[1].steps.iter().map(|step| step.truth);
        let truth = steps
            .find(|truth| truth.time_ms == time_ms)
            .expect("a step");
        [truth.x_m, truth.y_m]
    };
    let (left, joined) = (place(19_800), place(40_000));
    let rolled_m = (joined[0] - left[0]).hypot(joined[1] - left[1]);
    assert!(rolled_m < 1.0, "{rolled_m}");
    // For 100 periods of 20 s nothing that robot 0 says finds a hearer.
    assert!(report.radio.traffic.out_of_reach >= 100);
    let gone = TeamMission {
        timetable: Timetable {
            leave: at("1@20"),
            join: Vec::new(),
        },
        ..TeamMission::of(mission(), 2)
    };
    let (report, _) = run(&gone);
    assert_eq!(report.robots[1].report.outcome.status, "left");
    // What the other one gave up before it left is listed too.
    let (whole, stayed) = (report.whole.outcome, &report.robots[0].report.outcome);
    assert_eq!(
        (&whole.status, &whole.reason),
        (&stayed.status, &stayed.reason)
    );
}

#[test]
fn a_team_that_cannot_begin_says_why() {
    let error = |team: &TeamMission| {
        let begun = explore(team, &world(), &mut links(8), &mut ());
        begun.expect_err("it cannot begin").to_string()
    };
    for robots in [0, 9] {
        let text = error(&TeamMission::of(mission(), robots));
        assert!(text.contains("give 1 to 8"), "{text}");
    }
    let stranger = radio(TeamMission::of(mission(), 2), "partition@1-2:0/3");
    assert!(error(&stranger).contains("robot 3"));
    let unknown = TeamMission {
        timetable: Timetable {
            leave: at("2@20"),
            join: Vec::new(),
        },
        ..TeamMission::of(mission(), 2)
    };
    assert!(error(&unknown).contains("numbers 0 to 1"));
    let place = world().starts()[0];
    let crowded = TeamMission {
        places: Some(vec![place, place]),
        ..TeamMission::of(mission(), 2)
    };
    assert!(error(&crowded).contains("overlap"));
    let boxed = World::builtin("boxed-in").expect("built in");
    let begun = explore(
        &TeamMission::of(mission(), 8),
        &boxed,
        &mut links(8),
        &mut (),
    );
    assert!(matches!(begun, Err(TeamError::Room { robots: 8, .. })));
}

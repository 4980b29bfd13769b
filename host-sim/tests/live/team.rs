//! The pages of a team: each shows its own robot, and takes no requests of the device.

use host_sim::link::Link;
use host_sim::link::loopback::loopback;
use host_sim::live::{About, Limits, Live, Observer};
use host_sim::radio::RadioSpec;
use host_sim::trial::mission::Mission;
use host_sim::trial::sight::Sight;
use host_sim::trial::team::{StartError, TeamMission, TeamRecord, Timetable, explore};
use host_sim::trial::{Flow, Progress, Watch};
use host_sim::world::World;

use crate::client::Viewer;
use crate::{answered, open};

const ROBOTS: usize = 2;

/// The pages, robot by robot.
struct Pages(Vec<Observer>);

impl Watch for Pages {
    fn step(&mut self, _: &Progress) -> Flow {
        Flow::Continue
    }

    fn see_robot(&mut self, robot: usize, sight: &mut Sight<'_>) {
        if let Some(page) = self.0.get_mut(robot) {
            page.see(sight);
        }
    }
}

/// Explores for 30 s; returns the digest of each robot, and their records.
fn run(watch: &mut dyn Watch) -> (Vec<String>, TeamRecord) {
    let team = TeamMission {
        mission: Mission {
            time_limit_ms: 30_000,
            link: "loopback".into(),
            ..Mission::default()
        },
        robots: ROBOTS,
        links: vec!["loopback".into(); ROBOTS],
        apart: false,
        places: None,
        start_error: StartError::default(),
        radio: RadioSpec::default(),
        timetable: Timetable::default(),
    };
    let world = World::builtin("hall").expect("a world");
    let mut links: Vec<Box<dyn Link>> = Vec::new();
    links.resize_with(ROBOTS, || Box::new(loopback()));
    let (report, record) = explore(&team, &world, &mut links, watch).expect("a run");
    let digests = report.robots.iter().map(|it| it.report.digest.clone());
    (digests.collect(), record)
}

#[test]
fn each_robot_of_a_team_has_a_page_and_takes_no_requests() {
    let (alone, _) = run(&mut ());
    let lives: Vec<Live> = (0..ROBOTS).map(|_| open(Limits::default())).collect();
    let come = |live: &Live| Viewer::come(live.address());
    let mut viewers: Vec<Viewer> = lives.iter().map(come).collect();
    viewers[1].ask(r#"{"do":"go-to","x":1.0,"y":1.0}"#);
    let observer = |live: &Live| live.observer(About::default(), || false);
    let mut pages = Pages(lives.iter().map(observer).collect());
    // The request waits on the page's desk from here on.
    while lives[1].counts().viewers == 0 {
        std::thread::yield_now();
    }
    let (digests, record) = run(&mut pages);
    assert_eq!(digests, alone, "a look changes nothing");
    pages.0.iter_mut().for_each(|page| page.fail("over"));
    for (viewer, record) in viewers.iter_mut().zip(&record.robots) {
        let told = viewer.until_end();
        assert_eq!(told.steps.len(), record.steps.len());
        let (last, step) = (told.steps.last().unwrap(), record.steps.last().unwrap());
        assert!((last[1] - step.estimate.x_m).abs() < 1e-4);
        assert!((last[2] - step.estimate.y_m).abs() < 1e-4);
        assert!(told.tiles.len() > 3, "a map: {}", told.tiles.len());
    }
    let told = viewers.pop().expect("a viewer").told;
    let (done, why) = answered(&told, "go to 1.00,1.00").expect("an answer");
    assert!(!done && why.contains("a robot of a team"), "{why}");
}

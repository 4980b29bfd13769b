//! The live page: what viewers are told, what they may ask, and what a run does not notice.
//!
//! A viewer is a program with a websocket; `browser.rs` has a browser.

mod again;
mod browser;
mod client;
mod hostile;
mod team;

use core::net::SocketAddr;
use std::thread;

use client::{Viewer, say};
use host_sim::fence::{Fence, Polygon};
use host_sim::link::Link;
use host_sim::link::LinkError;
use host_sim::link::direct::Direct;
use host_sim::link::endpoint::{Endpoint, RetryPolicy};
use host_sim::link::line::Line;
use host_sim::link::loopback::{LocalDevice, loopback};
use host_sim::live::{About, Ask, Limits, Live};
use host_sim::report::Report;
use host_sim::report::grid_map::MapCell;
use host_sim::trial::Record;
use host_sim::trial::mission::{self, Mission, OdometryProfile};
use host_sim::world::World;

/// A small world, explored in a hundred simulated seconds.
const WORLD: &str = "unreachable-room";

fn mission() -> Mission {
    Mission {
        odometry: OdometryProfile::Noisy,
        localise: true,
        link: "loopback".into(),
        ..Mission::default()
    }
}

/// Opens a page on a free port.
fn open(limits: Limits) -> Live {
    Live::open(SocketAddr::from(([127, 0, 0, 1], 0)), 0.0, limits).expect("a port")
}

/// Makes a run that is shown.
fn shown(live: &Live, link: &mut dyn Link) -> (Report, Record) {
    shown_as(live, &mission(), link)
}

fn shown_as(live: &Live, mission: &Mission, link: &mut dyn Link) -> (Report, Record) {
    let about = About {
        world: WORLD.into(),
        ..About::default()
    };
    let mut observer = live.observer(about, || false);
    let world = World::builtin(WORLD).expect("a world");
    let run = mission::explore(mission, &world, link, &mut observer).expect("a run");
    observer.end(&run.0);
    run
}

/// Makes a run that nobody sees.
fn unseen(mission: &Mission) -> Report {
    let world = World::builtin(WORLD).expect("a world");
    let run = mission::explore(mission, &world, &mut loopback(), &mut ());
    run.expect("a run").0
}

#[test]
fn the_page_is_served_whole() {
    let live = open(Limits::default());
    let get = |path: &str| {
        let host = live.address();
        say(
            host,
            &format!("GET {path} HTTP/1.1\r\nHost: {host}\r\n\r\n"),
        )
    };
    let page = get("/");
    assert!(page.starts_with("HTTP/1.1 200 OK\r\n"), "{page}");
    assert!(page.contains("default-src 'none'") && page.contains("<canvas id=\"map\""));
    assert!(page.trim_end().ends_with("</html>"));
    assert!(get("/other").starts_with("HTTP/1.1 404 "));
    assert_eq!(live.url(), format!("http://{}/", live.address()));
}

#[test]
fn the_digest_is_the_same_with_any_number_of_viewers() {
    let alone = unseen(&mission());
    for number in [0, 1, 10] {
        let live = open(Limits::default());
        let viewers: Vec<_> = (0..number)
            .map(|_| {
                let mut viewer = Viewer::come(live.address());
                thread::spawn(move || {
                    viewer.until_end();
                    viewer.told.history
                })
            })
            .collect();
        let (report, _) = shown(&live, &mut loopback());
        assert_eq!(report.digest, alone.digest, "{number} viewers");
        assert_eq!(report.link_stats, alone.link_stats, "a look sends nothing");
        assert_eq!(report.live_requests, []);
        let told: Vec<_> = viewers
            .into_iter()
            .map(|it| it.join().expect("told"))
            .collect();
        assert!(
            told.iter()
                .all(|history| history == &told[0] && !history.is_empty())
        );
        assert_eq!(live.counts().came, number);
    }
}

/// Compares what a viewer was told with the record of the run.
fn compare(told: &client::Told, report: &Report, record: &Record) {
    assert_eq!(told.steps.len(), record.steps.len());
    let (last, step) = (told.steps.last().unwrap(), record.steps.last().unwrap());
    let truth = [
        step.estimate.x_m,
        step.estimate.y_m,
        step.truth.x_m,
        step.truth.y_m,
    ];
    for (told, is) in last[1..5].iter().zip(truth) {
        assert!((told - is).abs() < 1e-4, "{told} {is}");
    }
    assert!((last[5] - report.coverage.fraction).abs() < 1e-4);
    let class = |x: i32, y: i32| {
        let key = (x.div_euclid(32) as i16, y.div_euclid(32) as i16);
        let cell = (y.rem_euclid(32) * 32 + x.rem_euclid(32)) as usize;
        let bits = told
            .tiles
            .get(&key)
            .map_or(0, |tile| tile[cell / 4] >> (2 * (cell % 4)) & 3);
        [
            MapCell::Unknown,
            MapCell::Free,
            MapCell::Obstacle,
            MapCell::NegativeObstacle,
        ][usize::from(bits)]
    };
    let map = &record.map;
    let mut known = 0;
    for (x, y) in (-400..400).flat_map(|x| (-400..400).map(move |y| (x, y))) {
        assert_eq!(class(x, y), map.get(x, y), "cell {x}, {y}");
        known += u32::from(map.get(x, y) != MapCell::Unknown);
    }
    assert!(known > 5_000);
    let end = told.end.as_ref().expect("an end");
    assert_eq!(end["reason"], report.outcome.reason);
    assert_eq!(end["digest"], report.digest);
    assert_eq!(told.statuses.first().map(String::as_str), Some("exploring"));
    let mission = report
        .mission
        .iter()
        .map(|entry| serde_json::to_value(entry).unwrap());
    let mission: Vec<_> = mission.collect();
    // What the robot began to do with the last step is in the report only.
    let told = told.doings.as_slice();
    assert!(!told.is_empty() && mission.len() <= told.len() + 1);
    assert_eq!(told, &mission[..told.len()]);
}

/// A device behind a line that nobody looks into, as behind a serial port.
struct Far(LocalDevice);

impl Line for Far {
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.0.send(bytes)
    }

    fn receive(&mut self, into: &mut Vec<u8>, wait: core::time::Duration) -> Result<(), LinkError> {
        self.0.receive(into, wait)
    }

    fn now(&self) -> core::time::Duration {
        self.0.now()
    }
}

#[test]
fn what_is_shown_is_what_the_report_says() {
    let far = Endpoint::new(Far(LocalDevice::new()), RetryPolicy::VIRTUAL, 1);
    let links: [(Box<dyn Link>, bool); 3] = [
        (Box::new(Direct::new()), true),
        (Box::new(loopback()), true),
        (Box::new(far), false),
    ];
    for (mut link, is_inside) in links {
        let live = open(Limits::default());
        let mut early = Viewer::come(live.address());
        let (report, record) = shown(&live, link.as_mut());
        compare(early.until_end(), &report, &record);
        let [paths, skeletons, scans] = early.told.seen;
        assert_eq!(paths > 0 && skeletons > 0, is_inside);
        assert!(scans > record.steps.len() / 4);
        assert_eq!(early.told.run.as_ref().unwrap()["inside"], is_inside);
        // Who comes after the end is told the same.
        let mut late = Viewer::come(live.address());
        compare(late.until_end(), &report, &record);
        assert!(late.told.history == early.told.history);
    }
}

#[test]
fn two_runs_after_each_other_are_told_apart() {
    let live = open(Limits::default());
    let (first, _) = shown(&live, &mut loopback());
    let mut viewer = Viewer::come(live.address());
    viewer.until_end();
    let about = About {
        world: "another".into(),
        ..About::default()
    };
    let mut observer = live.observer(about, || false);
    observer.fail("the device does not answer");
    let told = viewer.until("the second end", |told| {
        told.end
            .as_ref()
            .is_some_and(|end| end["digest"] != first.digest)
    });
    assert_eq!(told.steps.len(), 0);
    assert_eq!(
        told.end.as_ref().unwrap()["headline"],
        "the device does not answer"
    );
}

/// Runs with a viewer who holds the clock before the first step; `act` is what it does then.
fn steered(mission: &Mission, act: impl FnOnce(&mut Viewer)) -> (Report, Record, client::Told) {
    let live = open(Limits::default());
    let mut viewer = Viewer::come(live.address());
    live.ask(Ask::Hold { on: true }).expect("held");
    let run = thread::scope(|scope| {
        let run = scope.spawn(|| {
            while live.counts().viewers == 0 {
                thread::yield_now();
            }
            shown_as(&live, mission, &mut loopback())
        });
        viewer.until("a first step", |told| !told.steps.is_empty());
        act(&mut viewer);
        viewer.until_end();
        run.join().expect("a run")
    });
    (run.0, run.1, viewer.told)
}

fn answered(told: &client::Told, request: &str) -> Option<(bool, String)> {
    let note = told
        .notes
        .iter()
        .rev()
        .find(|it| it["request"] == request)?;
    Some((note["done"].as_bool()?, note["answer"].as_str()?.into()))
}

#[test]
fn a_click_takes_the_robot_to_a_place_and_resume_goes_on_exploring() {
    let mut place = [0.0; 2];
    let (report, record, told) = steered(&mission(), |viewer| {
        let [_, x, y, ..] = viewer.told.steps[0];
        place = [x + 1.5, y + 0.5];
        viewer.ask(&format!(
            r#"{{"do":"go-to","x":{},"y":{}}}"#,
            place[0], place[1]
        ));
        viewer.ask(r#"{"do":"hold","on":false}"#);
        viewer.until("arrival", |told| {
            told.statuses.iter().any(|it| it == "arrived(goal)")
        });
        viewer.ask(r#"{"do":"resume"}"#);
    });
    assert_eq!(
        told.statuses[..4],
        ["exploring", "going(goal)", "arrived(goal)", "exploring"]
    );
    let words = |request: &str| report.live_requests.iter().find(|it| it.request == request);
    let name = format!("go to {:.2},{:.2}", place[0], place[1]);
    assert!(
        words(&name).is_some_and(|it| it.done),
        "{:?}",
        report.live_requests
    );
    assert!(words("resume").is_some_and(|it| it.done && it.answer == "exploring"));
    assert_eq!(answered(&told, &name), Some((true, "going(goal)".into())));
    assert!(report.explored(), "{:?}", report.outcome);
    assert!(report.to_text().contains("2 requests of viewers"));
    let [trip] = &report.trips[..] else {
        panic!("{:?}", report.trips);
    };
    assert!(
        trip.reached && trip.error_m < 0.3 && trip.true_error_m < 0.4,
        "{trip:?}"
    );
    assert_ne!(report.digest, unseen(&mission()).digest);
    assert_eq!(report.debug.map_matches_mirror, Some(true));
    // Odometry alone would be off by far more when the robot stands.
    let apart = |step: &[f64; 6]| (step[1] - step[3]).hypot(step[2] - step[4]);
    assert!(told.steps.iter().map(apart).fold(0.0, f64::max) < 0.3);
    assert_eq!(told.steps.len(), record.steps.len());
}

#[test]
fn a_refusal_is_told_with_its_reason_and_the_run_goes_on() {
    let mission = Mission {
        fence: Fence {
            no_go: vec![Polygon::rectangle([4.0, 1.0, 0.5, 0.5])],
            ..Fence::default()
        },
        ..mission()
    };
    let (report, _, told) = steered(&mission, |viewer| {
        viewer.ask(r#"{"do":"go-to","x":4.25,"y":1.25}"#);
        viewer.ask(r#"{"do":"resume"}"#);
        viewer.ask(r#"{"do":"go-to","x":1e300,"y":5}"#);
        viewer.ask(r#"{"do":"reset"}"#);
        viewer.ask(r#"{"do":"hold","on":false}"#);
    });
    let (done, reason) = answered(&told, "go to 4.25,1.25").expect("an answer");
    assert!(!done && reason.len() > 20, "{reason}");
    assert!(answered(&told, "resume").is_some_and(|(done, _)| !done));
    let refused = |word: &str| told.refused.iter().any(|it| it.contains(word));
    assert!(refused("3200") && refused("reset"), "{:?}", told.refused);
    assert!(report.explored());
    let alone = unseen(&mission);
    assert_eq!(
        report.digest, alone.digest,
        "what is refused changes nothing"
    );
    assert_eq!(
        report.live_requests.len(),
        2,
        "what reached the device is told"
    );
}

#[test]
fn a_robot_that_is_paused_stands_until_it_goes_on_or_is_stopped() {
    let (report, record, told) = steered(&mission(), |viewer| {
        viewer.ask(r#"{"do":"speed","factor":10}"#);
        viewer.ask(r#"{"do":"hold","on":false}"#);
        viewer.until("a drive", |told| {
            let [_, _, _, x, y, _] = told.steps[0];
            let off = |step: &[f64; 6]| (step[3] - x).hypot(step[4] - y);
            told.steps.last().is_some_and(|step| off(step) > 0.3)
        });
        viewer.ask(r#"{"do":"pause"}"#);
        let paused = |told: &client::Told| told.statuses.last().is_some_and(|it| it == "paused");
        viewer.until("pause", paused);
        let (from, began) = (viewer.told.steps.len(), std::time::Instant::now());
        // It brakes for some steps.
        viewer.until("ten steps more", |told| told.steps.len() > from + 10);
        let steps = &viewer.told.steps;
        let [.., x, y, _] = steps[from + 8];
        assert_eq!(&steps[from + 10][3..5], [x, y], "it stands");
        assert!(
            began.elapsed().as_secs_f64() > 1.0,
            "no faster than real time"
        );
        viewer.ask(r#"{"do":"resume"}"#);
        viewer.until("exploring", |told| {
            told.statuses.last().is_some_and(|it| it == "exploring")
        });
        viewer.ask(r#"{"do":"stop"}"#);
    });
    assert_eq!(report.outcome.reason, "stopped");
    assert_eq!(report.debug.map_matches_mirror, Some(true));
    assert_eq!(told.end.as_ref().unwrap()["requests"], 3);
    assert_eq!(told.steps.len(), record.steps.len());
}

#[test]
fn home_cuts_a_drive_of_the_orders_short_and_it_is_made_later() {
    let live = open(Limits::default());
    let mut viewer = Viewer::come(live.address());
    live.ask(Ask::Speed { factor: 60.0 }).expect("a pace");
    let world = World::builtin(WORLD).expect("a world");
    let start = world.starts()[0];
    let goal = [start.x_m + 3.0, start.y_m + 1.0];
    let mission = Mission {
        orders: host_sim::trial::itinerary::Orders {
            goals_m: vec![goal],
            ..Default::default()
        },
        ..mission()
    };
    let report = thread::scope(|scope| {
        let live = &live;
        let run = scope.spawn(move || {
            let mut observer = live.observer(About::default(), || false);
            let world = World::builtin(WORLD).expect("a world");
            let run = mission::explore(&mission, &world, &mut loopback(), &mut observer);
            let (report, _) = run.expect("a run");
            observer.end(&report);
            report
        });
        let last = |told: &client::Told, is: &str| told.statuses.last().is_some_and(|it| it == is);
        viewer.until("the goal", |told| last(told, "going(goal)"));
        viewer.ask(r#"{"do":"home"}"#);
        viewer.until("home", |told| last(told, "arrived(home)"));
        viewer.ask(r#"{"do":"speed","factor":0}"#);
        viewer.ask(r#"{"do":"resume"}"#);
        viewer.until_end();
        run.join().expect("a run")
    });
    let kinds: Vec<_> = report
        .trips
        .iter()
        .map(|it| (it.to.as_str(), it.reached))
        .collect();
    assert_eq!(kinds, [("goal", false), ("home", true), ("goal", true)]);
    assert!(report.explored(), "{:?}", report.outcome);
}

//! The page of a log that is replayed: it shows odometry where a run shows the truth, and takes no
//! requests.

use fieldline_protocol::message::Control;
use host_sim::link::loopback::loopback;
use host_sim::link::{Link, LinkError};
use host_sim::live::{About, Limits, Observer};
use host_sim::replay::carmen::{Beams, LogScan};
use host_sim::replay::run::{self, Replayed};
use host_sim::replay::wire::LogLaser;
use host_sim::trial::sight::Sight;
use host_sim::trial::{Flow, Progress, Watch};

use crate::client::Viewer;
use crate::open;

const SCANS: u32 = 40;

/// A drive of 4 m along the middle of a hall of 12 x 5 m.
fn log() -> Vec<LogScan> {
    let beams = Beams::half_turn(181);
    let scan = |k: u32| {
        let place = [0.1 * f64::from(k), 0.0, 0.0];
        let range = |beam: u32| {
            let (sin, cos) = (beams.first_rad + f64::from(beam) * beams.step_rad).sin_cos();
            let side = 2.5 / sin.abs().max(1e-3);
            side.min((8.0 - place[0]) / cos.max(1e-3))
        };
        LogScan {
            line: k as usize + 1,
            time: 0.2 * f64::from(k),
            ranges: (0..181).map(range).collect(),
            beams,
            laser: place,
            odometry: place,
            speed: [0.0; 2],
        }
    };
    (0..SCANS).map(scan).collect()
}

/// A page whose viewer sends the robot home.
struct Page {
    observer: Observer,
    answer: Option<LinkError>,
}

impl Watch for Page {
    fn step(&mut self, _: &Progress) -> Flow {
        Flow::Continue
    }

    fn see(&mut self, sight: &mut Sight<'_>) {
        self.observer.see(sight);
        let answer = sight.request(&Control::Home);
        self.answer = self.answer.take().or(answer.err());
    }
}

/// Replays the log with odometry that drifts.
fn replayed(watch: &mut dyn Watch) -> (Replayed, Vec<[f64; 3]>) {
    let scans = log();
    let odometry = run::odometry(&scans, Some(20.0), 1);
    let link: &mut dyn Link = &mut loopback();
    let laser = LogLaser::of(&scans);
    let replayed = run::run(&laser, &scans, &odometry, link, None, watch);
    (replayed.expect("a replay"), odometry)
}

#[test]
fn a_log_is_shown_with_its_odometry_and_takes_no_requests() {
    let (alone, _) = replayed(&mut ());
    let live = open(Limits::default());
    let mut viewer = Viewer::come(live.address());
    let mut page = Page {
        observer: live.observer(About::default(), || false),
        answer: None,
    };
    let (seen, odometry) = replayed(&mut page);
    assert_eq!(seen, alone, "a look changes nothing");
    let Some(LinkError::Refused(why)) = &page.answer else {
        panic!("{:?}", page.answer);
    };
    assert!(why.contains("made again"), "{why}");
    page.observer.end_again("a log: 40 scans\nand more");
    let told = viewer.until_end();
    assert_eq!(told.run.as_ref().expect("a run")["again"], true);
    assert_eq!(told.steps.len(), SCANS as usize);
    for ((step, pose), odom) in told.steps.iter().zip(&seen.poses).zip(&odometry) {
        let [_, x, y, second_x, second_y, _] = step;
        assert!((x - pose[0]).hypot(y - pose[1]) < 1e-3, "{step:?} {pose:?}");
        assert!((second_x - odom[0]).hypot(second_y - odom[1]) < 1e-3);
    }
    assert_eq!(told.steps.last().expect("a step")[5], 1.0);
    assert!(told.tiles.len() > 3, "a map: {}", told.tiles.len());
    let end = told.end.as_ref().expect("an end");
    assert_eq!(end["reason"], "replayed");
    assert_eq!(end["headline"], "a log: 40 scans");
}

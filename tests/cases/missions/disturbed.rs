//! Faults of wheels and lasers while the device corrects odometry.
//!
//! A *disturbance* lasts from one time to another. What must hold:
//!
//! - the robot touches nothing;
//! - the device does not say that it tracks while its position is wrong by more than
//!   [`WRONG_M`], except for [`DOUBT_MS`] after the beginning: it takes some scans to be sure;
//! - within [`RECOVERY_MS`] after the end it tracks again, within [`RIGHT_M`], and still does when
//!   the run ends, or the run ends with *pose lost*.
//!
//! Where the scan does not observe the position, in a hall wider than the range and in a long bare
//! corridor, odometry must hold it: the mean error is at most [`DRIFT_M`], and the device says that
//! it does not observe.
//!
//! `golden/disturbed.txt` has a row for each run; `golden/disturbed-full.txt` those of ten seeds.

use core::fmt::Write as _;
use core::ops::Range;

use fieldline_protocol::message::{Fault, Quality};
use fieldline_tests::table::{Table, number};
use fieldline_tests::{golden, runs, worlds};
use host_sim::link::direct::Direct;
use host_sim::report::{InputFaults, Report};
use host_sim::trial::mission::{Mission, OdometryProfile};
use host_sim::trial::{Ending, Record, Step};
use host_sim::world::{Start, World};

/// Error beyond which a robot that says that it tracks is wrong, metres.
const WRONG_M: f64 = 0.5;
/// Error within which a robot has recovered, metres.
const RIGHT_M: f64 = 0.3;
/// Greatest mean error where odometry alone holds the position, metres.
const DRIFT_M: f64 = 0.35;
/// Least share of the ground that is truly seen there.
const LEAST_SEEN: f64 = 0.97;
/// Least share of the steps there in which the device says that it does not observe.
const LEAST_DEGENERATE: f64 = 0.2;
/// Time in which the device may find out, milliseconds.
const DOUBT_MS: u32 = 1_000;
/// Time in which the device must recover, milliseconds.
const RECOVERY_MS: u32 = 5_000;
/// Simulated time of a short scene, milliseconds.
const SHORT_MS: u32 = 90_000;

/// One disturbed run.
#[derive(Clone, Copy, Debug)]
struct Scene<'a> {
    world: &'a World,
    place: Option<Start>,
    /// As on the command line; empty for none.
    disturbances: &'a str,
    /// Seconds from and to which the disturbance lasts.
    lasts_s: [u32; 2],
    seed: u64,
    until_ms: u32,
}

/// What came of it.
struct Outcome {
    report: Report,
    record: Record,
}

impl Scene<'_> {
    fn go(&self) -> Outcome {
        let mission = Mission {
            seed: self.seed,
            place: self.place,
            odometry: OdometryProfile::Noisy,
            localise: true,
            time_limit_ms: self.until_ms,
            disturbances: match self.disturbances {
                "" => Default::default(),
                text => text.parse().expect("valid"),
            },
            ..Mission::default()
        };
        let (report, record) = runs::explored(&mission, self.world, &mut Direct::new());
        Outcome { report, record }
    }

    fn lasts_ms(&self) -> [u32; 2] {
        self.lasts_s.map(|seconds| 1000 * seconds)
    }
}

fn error_m(step: &Step) -> f64 {
    (step.estimate.x_m - step.truth.x_m).hypot(step.estimate.y_m - step.truth.y_m)
}

fn quality(step: &Step) -> Quality {
    step.command.location.map_or(Quality::Lost, |at| at.quality)
}

fn tracks(step: &Step) -> bool {
    quality(step) == Quality::Tracking
}

impl Outcome {
    /// Returns the steps from a time on, up to another.
    fn steps(&self, from_ms: u32, to_ms: u32) -> impl Iterator<Item = &Step> {
        let steps = self.record.steps.iter();
        steps.filter(move |step| (from_ms..to_ms).contains(&step.truth.time_ms))
    }

    /// Returns the time from the end of the disturbance until the device tracks again.
    fn recovery_ms(&self, scene: &Scene<'_>) -> Option<u32> {
        let [_, end_ms] = scene.lasts_ms();
        let mut after = self.steps(end_ms, u32::MAX);
        let well = after.find(|step| tracks(step) && error_m(step) <= RIGHT_M);
        well.map(|step| step.truth.time_ms - end_ms)
    }

    /// Returns the seconds in which the device wrongly says that it tracks.
    fn deceived_s(&self, scene: &Scene<'_>) -> f64 {
        let [begin_ms, _] = scene.lasts_ms();
        let steps = self.steps(begin_ms + DOUBT_MS, u32::MAX);
        let wrong = steps.filter(|step| tracks(step) && error_m(step) > WRONG_M);
        wrong.count() as f64 * 0.2
    }

    fn has_lost_its_pose(&self) -> bool {
        self.record.ending == Ending::Fault(Fault::PoseLost)
    }

    fn faults(&self, scene: &Scene<'_>) -> Vec<String> {
        let mut faults = Vec::new();
        let collisions = self.report.safety.collisions;
        if collisions > 0 {
            faults.push(format!("{collisions} collisions"));
        }
        let deceived_s = self.deceived_s(scene);
        if deceived_s > 0.0 {
            faults.push(format!(
                "says for {deceived_s:.1} s that it tracks, and does not"
            ));
        }
        let is_late = self.recovery_ms(scene).is_none_or(|ms| ms > RECOVERY_MS);
        let end_m = self.report.localization.end_error_m.unwrap_or(f64::MAX);
        if (is_late || end_m > RIGHT_M) && !self.has_lost_its_pose() {
            faults.push(format!("not recovered, {end_m:.2} m wrong at the end"));
        }
        faults
    }

    /// Lists what fails where the scan does not observe the position.
    fn silence(&self) -> Vec<String> {
        let mut faults = runs::faults(&self.report, LEAST_SEEN);
        let quality = self.report.localization.quality;
        let degenerate = quality.map_or(0.0, |shares| shares.degenerate);
        if degenerate < LEAST_DEGENERATE {
            faults.push(format!("says so only in {degenerate:.2} of the steps"));
        }
        faults
    }
}

/// Runs scenes; returns them with their outcomes.
fn play<'a>(scenes: &'a [Scene<'a>]) -> Vec<(&'a Scene<'a>, Outcome)> {
    let outcomes = runs::in_parallel(scenes, Scene::go);
    scenes.iter().zip(outcomes).collect()
}

fn table(played: &[(&Scene<'_>, Outcome)]) -> String {
    let columns = [
        "world",
        "disturbances",
        "end",
        "seed",
        "most m",
        "tracking %",
        "lost %",
        "after s",
        "deceived s",
        "end m",
        "touched",
    ];
    let mut table = Table::new(3, &columns);
    for (scene, outcome) in played {
        let [begin_ms, end_ms] = scene.lasts_ms();
        let during: Vec<&Step> = outcome.steps(begin_ms, end_ms + RECOVERY_MS).collect();
        let share = |of: &dyn Fn(&Step) -> bool| {
            100.0 * during.iter().filter(|step| of(step)).count() as f64 / during.len() as f64
        };
        let most_m = during.iter().map(|step| error_m(step)).fold(0.0, f64::max);
        let recovery_s = outcome.recovery_ms(scene).map(|ms| f64::from(ms) / 1000.0);
        let report = &outcome.report;
        table.row(vec![
            report.world.clone(),
            report.disturbances.clone().unwrap_or_default(),
            report.outcome.reason.clone(),
            report.seed.to_string(),
            number(Some(most_m), 2),
            number(Some(share(&tracks)), 0),
            number(Some(share(&|step| quality(step) == Quality::Lost)), 0),
            number(recovery_s, 1),
            number(Some(outcome.deceived_s(scene)), 1),
            number(report.localization.end_error_m, 2),
            report.safety.collisions.to_string(),
        ]);
    }
    table.to_string()
}

/// Asserts that nothing fails.
fn assert_faultless(
    played: &[(&Scene<'_>, Outcome)],
    faults: fn(&Outcome, &Scene<'_>) -> Vec<String>,
) {
    let mut list = String::new();
    for (scene, outcome) in played {
        for fault in faults(outcome, scene) {
            let world = &outcome.report.world;
            let _ = writeln!(
                list,
                "{world} {} seed {}: {fault}",
                scene.disturbances, scene.seed
            );
        }
    }
    assert!(list.is_empty(), "\n{list}");
}

/// A slip of 0.5 m and 20° in one step.
const SLIP: (&str, [u32; 2]) = ("slip@40", [40, 41]);
/// The other disturbances, and when they last.
const OTHERS: [(&str, [u32; 2]); 4] = [
    ("spin@40-43", [40, 43]),
    ("push@40-43", [40, 43]),
    ("dark@40-42", [40, 42]),
    ("missing=0.3", [0, 80]),
];

fn scenes<'a>(
    world: &'a World,
    disturbances: &'static [(&'static str, [u32; 2])],
    seeds: Range<u64>,
) -> Vec<Scene<'a>> {
    let scene = |&(disturbances, lasts_s), seed| Scene {
        world,
        place: None,
        disturbances,
        lasts_s,
        seed,
        until_ms: SHORT_MS,
    };
    let of = |it| seeds.clone().map(move |seed| scene(it, seed));
    disturbances.iter().flat_map(of).collect()
}

/// The device takes such a jump for an odometry that began anew, and goes on where it stood.
#[test]
fn odometry_that_begins_anew_in_the_middle_of_a_run_changes_little() {
    let office = worlds::builtin("office");
    let scene = |disturbances| Scene {
        world: &office,
        place: None,
        disturbances,
        lasts_s: [100, 100],
        seed: 1,
        until_ms: u32::MAX,
    };
    let scenes = [scene(""), scene("restart@100")];
    let played = play(&scenes);
    let [(_, whole), (_, restarted)] = played.as_slice() else {
        panic!("two runs");
    };
    assert_eq!(whole.report.input_faults, InputFaults::default());
    let one = InputFaults {
        jumps: 1,
        ..InputFaults::default()
    };
    assert_eq!(restarted.report.input_faults, one);
    let errors_m = [whole, restarted].map(|outcome| {
        assert!(outcome.report.explored(), "{:?}", outcome.report.outcome);
        assert_eq!(outcome.report.safety.collisions, 0);
        outcome.report.localization.max_error_m.unwrap_or(f64::MAX)
    });
    assert!(errors_m[1] < errors_m[0] + 0.05, "{errors_m:?} m");
}

#[test]
fn after_faults_of_wheels_and_lasers_the_device_tracks_again() {
    let office = worlds::builtin("office");
    let scenes = scenes(&office, &OTHERS, 0..2);
    let played = play(&scenes);
    golden::compare("disturbed.txt", &table(&played));
    // A robot that is pushed while its wheels stand may touch something (`known_red`). It is not
    // deceived either.
    let is_pushed = |scene: &Scene<'_>| scene.disturbances.starts_with("push");
    let (pushed, others): (Vec<_>, Vec<_>) =
        played.into_iter().partition(|(scene, _)| is_pushed(scene));
    assert_eq!((pushed.len(), others.len()), (2, 6));
    assert_faultless(&others, Outcome::faults);
    for (scene, outcome) in &pushed {
        assert_eq!(outcome.deceived_s(scene), 0.0, "seed {}", scene.seed);
    }
}

/// A bare corridor of 60 × 2.4 m.
fn corridor() -> World {
    let wall = "#".repeat(304);
    let floor = format!("##{}##", ".".repeat(300));
    let row = |row: usize| {
        if (2..14).contains(&row) {
            &*floor
        } else {
            &*wall
        }
    };
    World::picture("corridor", 0.2, &(0..16).map(row).collect::<Vec<_>>())
}

/// Returns whole runs of five seeds in a hall wider than the range and in the corridor.
fn wide<'a>(hall: &'a World, corridor: &'a World) -> Vec<Scene<'a>> {
    let start = Start {
        x_m: 2.0,
        y_m: 1.6,
        yaw_rad: 0.0,
    };
    let scene = |(world, place), seed| Scene {
        world,
        place,
        disturbances: "",
        lasts_s: [0, 0],
        seed,
        until_ms: 3_600_000,
    };
    let of = |it| (0..5).map(move |seed| scene(it, seed));
    [(hall, None), (corridor, Some(start))]
        .into_iter()
        .flat_map(of)
        .collect()
}

mod full {
    use super::*;

    #[test]
    #[ignore = "takes a minute: 50 runs; tests/run --full runs it"]
    fn faults_of_wheels_and_lasers_with_ten_seeds() {
        let office = worlds::builtin("office");
        let mut all = scenes(&office, &[SLIP], 0..10);
        all.extend(scenes(&office, &OTHERS, 0..10));
        golden::compare("disturbed-full.txt", &table(&play(&all)));
    }

    #[test]
    #[ignore = "takes a minute: 10 runs; tests/run --full runs it"]
    fn after_a_slip_the_device_tracks_again() {
        let office = worlds::builtin("office");
        assert_faultless(&play(&scenes(&office, &[SLIP], 0..10)), Outcome::faults);
    }

    #[test]
    #[ignore = "takes a minute: 10 runs; tests/run --full runs it"]
    fn where_the_scan_does_not_observe_the_position_the_device_says_so() {
        let (hall, corridor) = (worlds::builtin("empty-hall"), corridor());
        assert_faultless(&play(&wide(&hall, &corridor)), |outcome, _| {
            outcome.silence()
        });
    }
}

mod known_red {
    use super::*;

    #[test]
    #[ignore = "of ten robots that are pushed one is 0.45 m wrong after it"]
    fn after_other_faults_with_ten_seeds_the_device_tracks_again() {
        let office = worlds::builtin("office");
        assert_faultless(&play(&scenes(&office, &OTHERS, 0..10)), Outcome::faults);
    }

    #[test]
    #[ignore = "beyond 0.35 m: four of five seeds in the hall"]
    fn odometry_alone_holds_the_position() {
        let (hall, corridor) = (worlds::builtin("empty-hall"), corridor());
        assert_faultless(&play(&wide(&hall, &corridor)), |outcome, _| {
            let mean_m = outcome.report.localization.mean_error_m;
            let drift_m = mean_m.filter(|mean_m| *mean_m > DRIFT_M);
            drift_m
                .map(|mean_m| format!("mean error {mean_m:.2} m"))
                .into_iter()
                .collect()
        });
    }
}

//! Runs with a scripted device and a point robot: every end, and the record after it.

use fieldline_protocol::message::{
    Command, Control, Fault, Finish, Identity, Location, Observation, Path, Quality, Reply,
    Request, ResidualFrontier, ResidualReason, Start, Status, Tile, Twist,
};
use fixed::types::{I4F12, I16F16};

use super::itinerary::Orders;
use super::{Body, Cast, Ending, Flow, Progress, Record, Setup, Survey, Watch, run};
use crate::link::cycles::StepCost;
use crate::link::{End, Link, LinkError, LinkStats};
use crate::report::Percentiles;
use crate::report::tum::Stamped;
use crate::sim::Loss;

/// A point robot that drives along x.
#[derive(Default)]
struct Point {
    time_ms: u32,
    x_m: f64,
    driven: Vec<Option<Twist>>,
    /// It falls beyond this x, if there is one.
    rim_m: Option<f64>,
}

impl Body for Point {
    fn period_ms(&self) -> u32 {
        100
    }
    fn observe(&mut self) -> Observation {
        let mut observation = Observation {
            time_ms: self.time_ms,
            ..Observation::default()
        };
        observation.pose.x = I16F16::from_num(self.x_m + 0.25);
        observation
    }
    fn drive(&mut self, velocity: Option<Twist>) {
        self.time_ms += 100;
        self.x_m += velocity.unwrap_or_default().linear.to_num::<f64>() * 0.1;
        self.driven.push(velocity);
    }
    fn truth(&self) -> Stamped {
        Stamped {
            time_ms: self.time_ms,
            x_m: self.x_m,
            z_m: self.x_m * if self.x_m < 0.2 { 0.5 } else { -1.0 },
            ..Stamped::default()
        }
    }
    fn loss(&self) -> Option<Loss> {
        self.rim_m
            .filter(|rim_m| self.x_m > *rim_m)
            .map(|_| Loss::Fell)
    }
}

/// Answers from a script; the last line repeats.
struct Script {
    answers: Vec<Result<Command, LinkError>>,
    asked: usize,
    controls: Vec<Control>,
}

impl Script {
    fn new(answers: Vec<Result<Command, LinkError>>) -> Self {
        Self {
            answers,
            asked: 0,
            controls: Vec::new(),
        }
    }
}

impl Link for Script {
    fn ask(&mut self, request: &Request) -> Result<Reply, LinkError> {
        Ok(match request {
            Request::Hello { .. } => Reply::Hello(Identity::default()),
            Request::Control(control) => {
                self.controls.push(control.clone());
                Reply::Control(Status::Exploring)
            }
            Request::Observation(_) => {
                let line = self.asked.min(self.answers.len() - 1);
                self.asked += 1;
                Reply::Command(self.answers[line].clone()?)
            }
            // Three tiles on a diagonal, the last of them far from the start.
            Request::Tile { x, y } => {
                Reply::Tile(((0..3).contains(x) && x == y).then(|| a_tile(*x, *y)))
            }
            Request::FieldRow { .. } => Reply::FieldRow(None),
            Request::Frontiers => {
                let left = ResidualFrontier {
                    x: 30,
                    y: -13,
                    cells: 4,
                    reason: ResidualReason::Unreachable,
                };
                Reply::Frontiers([left].into_iter().collect())
            }
            Request::Path { .. } => Reply::Path(Path::default()),
            Request::Hear(_) => Reply::Heard,
            Request::Say => Reply::Say(None),
            Request::Correct(_) | Request::Tiles(_) | Request::Recall(_) => {
                return Err(LinkError::Refused("a script has no map".into()));
            }
        })
    }

    fn end(&self) -> &dyn End {
        self
    }
}

impl End for Script {
    fn stats(&self) -> LinkStats {
        LinkStats {
            sent: self.asked as u64,
            ..LinkStats::default()
        }
    }
}

/// A tile whose cells are all free.
fn a_tile(x: i16, y: i16) -> Tile {
    Tile {
        x,
        y,
        cells: heapless::Vec::from_slice(&[0b0101_0101; 256]).unwrap(),
        skeleton: heapless::Vec::new(),
        closed_regions: 1,
        given_up_regions: 2,
        visit_stamps: [0, 7, 0, 9],
    }
}

struct Counting(u64);

impl Survey for Counting {
    fn note(&mut self, _: &Observation, _: &Stamped, _: &Command) -> f64 {
        self.0 += 1;
        self.0 as f64 / 1_000.0
    }
}

struct Until(u32);

impl Watch for Until {
    fn step(&mut self, progress: &Progress) -> Flow {
        if progress.time_ms >= self.0 {
            Flow::Interrupt
        } else {
            Flow::Continue
        }
    }
}

fn command(status: Status, linear: f64) -> Result<Command, LinkError> {
    Ok(Command {
        velocity: Twist {
            linear: I4F12::from_num(linear),
            ..Twist::default()
        },
        status,
        ..Command::default()
    })
}

fn trial(link: &mut Script, body: &mut Point, interrupt_ms: u32) -> Record {
    let setup = Setup {
        start: Start::default(),
        time_limit_ms: 120_000,
        check_field: false,
        snapshots: 2,
        resumes: false,
        orders: Orders::default(),
        corrects: false,
        known: None,
    };
    let mut cast = Cast {
        link,
        body,
        survey: &mut Counting(0),
        watch: &mut Until(interrupt_ms),
        corrector: &mut (),
        keeper: &mut (),
    };
    run(&setup, &mut cast)
}

fn ends(answers: Vec<Result<Command, LinkError>>) -> (Record, Script, Point) {
    let (mut link, mut body) = (Script::new(answers), Point::default());
    let record = trial(&mut link, &mut body, u32::MAX);
    (record, link, body)
}

#[test]
fn snapshots_are_taken_evenly_during_the_run() {
    let mut link = Script::new(vec![command(Status::Exploring, 0.5)]);
    let record = trial(&mut link, &mut Point::default(), 9_000);
    assert_eq!(record.ending, Ending::Interrupted);
    let moments = record.snapshots.iter();
    let moments: Vec<_> = moments.map(|m| (m.progress.time_ms, m.steps)).collect();
    // Taken at 0, 2, 4, 6 and 8 s, and thinned to every 4 s.
    assert_eq!(moments, [(4_000, 41), (8_000, 81)]);
    let last = &record.snapshots[1];
    assert_eq!(
        (last.progress.coverage, last.map.known()),
        (0.081, 3 * 1024)
    );
}

#[test]
fn a_finish_ends_the_run_and_all_data_is_read() {
    let (record, link, body) = ends(vec![
        command(Status::Exploring, 0.5),
        command(Status::Exploring, 0.5),
        command(Status::Finished(Finish::Explored), 0.5),
    ]);
    assert_eq!(record.ending, Ending::Finished(Finish::Explored));
    assert_eq!(record.steps.len(), 3);
    assert!((record.path_m - 0.1).abs() < 1e-3, "{}", record.path_m);
    assert!((record.coverage - 0.003).abs() < 1e-12);
    assert_eq!(record.link_stats.sent, 3);
    assert_eq!(
        record.tiles.len(),
        3,
        "tiles that touch at a corner are found"
    );
    assert_eq!(record.map.known(), 3 * 1024);
    assert_eq!(link.controls.len(), 1, "a finished device is not stopped");
    // The velocity that came with the finish is not driven.
    assert_eq!(body.driven.len(), 2 + 30);
    assert!(
        body.driven[2..]
            .iter()
            .all(|twist| *twist == Some(Twist::default()))
    );
    let outcome = record.outcome();
    assert_eq!(
        (outcome.status.as_str(), outcome.reason.as_str()),
        ("finished", "explored")
    );
    let frontier = &outcome.residual_frontiers[0];
    assert_eq!((frontier.x_m, frontier.y_m), (3.05, -1.25));
    let error = record.localization();
    assert!((error.mean_error_m.unwrap() - 0.25).abs() < 1e-4);
}

#[test]
fn a_fault_ends_the_run() {
    let (record, ..) = ends(vec![command(Status::Fault(Fault::MapFull), 0.0)]);
    assert_eq!(record.ending, Ending::Fault(Fault::MapFull));
    assert_eq!(record.steps.len(), 1);
}

#[test]
fn a_robot_that_fell_ends_the_run_at_once() {
    let mut link = Script::new(vec![command(Status::Exploring, 0.5)]);
    let mut body = Point {
        rim_m: Some(0.22),
        ..Point::default()
    };
    let record = trial(&mut link, &mut body, u32::MAX);
    assert_eq!(record.ending, Ending::Lost(Loss::Fell));
    // Five periods of 5 cm go beyond the rim; the fifth is the last that was commanded.
    assert_eq!((record.steps.len(), body.driven.len()), (5, 5 + 30));
    assert_eq!(link.controls.last(), Some(&Control::Stop));
}

#[test]
fn height_change_is_the_sum_of_all_ups_and_downs() {
    let (record, ..) = ends(vec![
        command(Status::Exploring, 0.5),
        command(Status::Exploring, 0.5),
        command(Status::Exploring, 0.5),
        command(Status::Exploring, 0.5),
        command(Status::Finished(Finish::Explored), 0.0),
    ]);
    // Heights 0, 0.025, 0.05, 0.075, −0.2.
    assert!(
        (record.height_change_m - 0.35).abs() < 1e-3,
        "{}",
        record.height_change_m
    );
}

#[test]
fn after_a_broken_link_the_robot_gets_no_command() {
    let (record, link, body) = ends(vec![
        command(Status::Exploring, 0.5),
        Err(LinkError::Silent),
    ]);
    assert_eq!(record.ending, Ending::Link(LinkError::Silent));
    assert!(body.driven[0].is_some_and(|twist| twist != Twist::default()));
    assert_eq!(body.driven[1..], [None; 30], "silence, not a command");
    assert_eq!(link.controls.len(), 1, "nothing is sent over a dead link");
    assert!(record.tiles.is_empty());
}

#[test]
fn a_robot_at_rest_is_frozen_and_told_to_stop() {
    let (record, link, _) = ends(vec![command(Status::Exploring, 0.0)]);
    assert_eq!(record.ending, Ending::Frozen);
    assert_eq!(record.steps.last().unwrap().truth.time_ms, 60_000);
    assert_eq!(link.controls.last(), Some(&Control::Stop));
}

#[test]
fn a_paused_robot_is_not_frozen_and_the_time_limit_ends_it() {
    let (record, ..) = ends(vec![command(Status::Paused, 0.0)]);
    assert_eq!(record.ending, Ending::TimeLimit);
    assert_eq!(record.steps.last().unwrap().truth.time_ms, 120_000);
}

#[test]
fn a_lost_robot_may_stand_while_it_searches_for_its_place() {
    let standing = |quality| {
        let answer = command(Status::Exploring, 0.0).map(|command| Command {
            location: Some(Location {
                quality,
                ..Location::default()
            }),
            ..command
        });
        ends(vec![answer]).0.ending
    };
    assert_eq!(standing(Quality::Lost), Ending::TimeLimit);
    assert_eq!(standing(Quality::Tracking), Ending::Frozen);
}

#[test]
fn an_interrupt_stops_the_robot_and_keeps_the_record() {
    let mut link = Script::new(vec![command(Status::Exploring, 0.5)]);
    let mut body = Point::default();
    let record = trial(&mut link, &mut body, 3_000);
    assert_eq!(record.ending, Ending::Interrupted);
    assert_eq!(record.steps.len(), 31);
    assert_eq!(link.controls.last(), Some(&Control::Stop));
    assert_eq!(*body.driven.last().unwrap(), Some(Twist::default()));
}

#[test]
fn the_digest_is_of_the_commands_alone() {
    let answers = || {
        vec![
            command(Status::Exploring, 0.5),
            command(Status::Finished(Finish::Explored), 0.0),
        ]
    };
    let (first, ..) = ends(answers());
    let (second, ..) = ends(answers());
    assert_eq!(first.digest, second.digest);
    let (other, ..) = ends(vec![
        command(Status::Exploring, 0.25),
        command(Status::Finished(Finish::Explored), 0.0),
    ]);
    assert_ne!(first.digest, other.digest);
}

#[test]
fn cycles_are_reported_of_the_steps_that_have_them() {
    let exploring = || command(Status::Exploring, 0.1);
    let last = command(Status::Finished(Finish::Explored), 0.0);
    let (mut record, ..) = ends(vec![exploring(), exploring(), last]);
    for (step, cycles) in record.steps.iter_mut().zip([1_680_000, 3_360_000]) {
        let mut cost = StepCost::default();
        cost.stages[1].cycles = cycles;
        step.cycles = Some(cost);
    }
    let planner = record.planner();
    let of = |it: Option<Percentiles>| it.map(|it| (it.p50, it.max));
    assert_eq!(of(planner.cycles), Some((1.68e6, 3.36e6)));
    assert_eq!(of(planner.ms), Some((10.0, 20.0)));
    let stages = planner.stage_cycles.unwrap();
    assert_eq!((stages.sense.max, stages.solve.max), (3.36e6, 0.0));
}

#[test]
fn costs_are_reported_only_where_the_device_measures() {
    let mut measured = command(Status::Finished(Finish::Explored), 0.0).unwrap();
    measured.cost.instructions = 4_000_000;
    measured.cost.stages.solve = 3_000_000;
    measured.cost.stack_bytes = 2_048;
    measured.cost.budget_exhausted = true;
    let (record, ..) = ends(vec![command(Status::Exploring, 0.1), Ok(measured)]);
    let planner = record.planner();
    assert_eq!(planner.instructions.unwrap().max, 4e6);
    let stages = planner.stage_instructions.unwrap();
    assert_eq!((stages.solve.p50, stages.drive.max), (3e6, 0.0));
    assert_eq!(planner.stack_bytes, Some(2_048));
    assert!(planner.round_trip_us.unwrap().p50 >= 0.0);
    assert_eq!(record.field().budget_exhausted_steps, 1);
    let (record, ..) = ends(vec![command(Status::Finished(Finish::Explored), 0.0)]);
    assert_eq!(record.planner().instructions, None);
    assert_eq!(record.planner().stage_instructions, None);
    assert_eq!(record.planner().cycles, None);
    assert_eq!(record.planner().stage_cycles, None);
    assert_eq!(record.planner().stack_bytes, None);
}

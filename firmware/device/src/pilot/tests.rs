//! States of a session, and helpers for the other tests of this crate.

use std::boxed::Box;

use fieldline_planner::{State, Tuning, Workspace};
use fieldline_protocol::message::{
    Activity, Beacon, Body, Budget, Control, Correct, CorrectedTiles, Errand, Fault, Fence,
    FencePolygon, Finish, Hull, Laser, LoopLimits, Member, Observation, Order, Packet, Parameter,
    Refusal, Scan, SpaceField, Start, Status, Strategy, Team, Twist,
};
use fixed::types::{I4F12, I16F16};

use super::{Memory, Pilot};

mod corrections;

/// Returns a session of the 3-AT with a level and a tilted laser of 181 beams over 180°.
pub(crate) fn start() -> Start {
    let level = Laser {
        x: I4F12::lit("0.1"),
        y: I4F12::ZERO,
        z: I4F12::lit("0.4"),
        pitch: I4F12::ZERO,
        first_bearing: I16F16::lit("-1.5708"),
        bearing_step: I16F16::lit("0.017453"),
        beams: 181,
        range_limit_mm: 12_000,
    };
    let tilted = Laser {
        pitch: I4F12::lit("0.349"),
        ..level
    };
    Start {
        strategy: Strategy::Frontier,
        lasers: [level, tilted].into_iter().collect(),
        hull: Hull::default(),
        robot_radius_mm: 300,
        max_linear: I4F12::lit("0.7"),
        max_angular: I4F12::lit("2.44"),
        linear_accel: I4F12::lit("0.3"),
        angular_accel: I4F12::lit("1.745"),
        period_ms: 200,
        uneven_ground: None,
        loops: LoopLimits::default(),
        order: Order::default(),
        team: None,
        localise: false,
        survey: false,
        fence: Fence::default(),
        budget: Budget::default(),
    }
}

/// Returns an observation that matches [`start`], with 4 m of free space all around.
pub(crate) fn observation(time_ms: u32) -> Observation {
    let scan = Scan {
        ranges_mm: [4000; 181].into_iter().collect(),
    };
    Observation {
        time_ms,
        scans: [scan.clone(), scan].into_iter().collect(),
        ..Observation::default()
    }
}

/// The memory of a small planner.
pub(crate) struct Bench {
    state: Box<State<4, 400>>,
    workspace: Box<Workspace>,
}

impl Bench {
    pub(crate) fn new() -> Self {
        Self {
            state: Box::new(State::new()),
            workspace: Box::new(Workspace::new()),
        }
    }

    pub(crate) fn memory(&mut self) -> Memory<'_, 4, 400> {
        Memory {
            state: &mut self.state,
            workspace: &mut self.workspace,
            tuning: &Tuning::DEFAULT,
        }
    }
}

fn started() -> (Pilot, Bench) {
    let (mut pilot, mut bench) = (Pilot::new(), Bench::new());
    let status = pilot.control(&mut bench.memory(), &Control::Start(start()));
    assert_eq!(status, Ok(Status::Exploring));
    (pilot, bench)
}

#[test]
fn nothing_happens_before_a_start() {
    let (mut pilot, mut bench) = (Pilot::new(), Bench::new());
    assert_eq!(pilot.status(), Status::Idle);
    for control in [Control::Pause, Control::Resume, Control::Stop] {
        let refused = pilot.control(&mut bench.memory(), &control);
        assert_eq!(refused, Err(Refusal::NotStarted), "{control:?}");
    }
    let refused = pilot.observe(&mut bench.memory(), &observation(0), &mut ());
    assert_eq!(refused, Err(Refusal::NotStarted));
}

#[test]
fn a_survey_maps_and_localises_and_never_moves_or_ends() {
    let (mut pilot, mut bench) = (Pilot::new(), Bench::new());
    let level = start().lasers[0];
    // A strategy that would end at the first covered cell.
    let metres = I16F16::from_num::<i32>;
    let field = SpaceField {
        origin: (metres(-1), metres(-1)),
        size: (metres(2), metres(2)),
        until_permille: 1,
        impatience_s: None,
    };
    let survey = Start {
        strategy: Strategy::Esbpf(field),
        lasers: [level].into_iter().collect(),
        localise: true,
        survey: true,
        ..start()
    };
    let status = pilot.control(&mut bench.memory(), &Control::Start(survey));
    assert_eq!(status, Ok(Status::Exploring));
    // 4 m of free space is a closed room: a session that explores ends in it.
    for step in 0..60 {
        let mut scan = observation(200 * step);
        scan.scans.truncate(1);
        if step == 0 {
            // Somebody stands before the laser: an exploration would not start.
            scan.scans[0].ranges_mm.fill(50);
        }
        let command = pilot.observe(&mut bench.memory(), &scan, &mut ()).unwrap();
        assert_eq!(command.status, Status::Exploring);
        assert_eq!(command.velocity, Twist::default());
        assert!(command.location.is_some());
    }
    assert!(Pilot::tile(&bench.memory(), 0, 0).is_some());
    assert_eq!(Pilot::field_row(&bench.memory(), 0), None);
}

#[test]
fn a_refused_start_changes_nothing() {
    let (mut pilot, mut bench) = started();
    let bad = Start {
        robot_radius_mm: 0,
        ..start()
    };
    let refused = pilot.control(&mut bench.memory(), &Control::Start(bad));
    assert_eq!(refused, Err(Refusal::BadParameter(Parameter::Radius)));
    assert_eq!(pilot.status(), Status::Exploring);
}

#[test]
fn a_pause_holds_until_resume() {
    let (mut pilot, mut bench) = started();
    let paused = pilot.control(&mut bench.memory(), &Control::Pause);
    assert_eq!(paused, Ok(Status::Paused));
    let command = pilot
        .observe(&mut bench.memory(), &observation(100), &mut ())
        .unwrap();
    assert_eq!(
        (command.status, command.velocity),
        (Status::Paused, Twist::default())
    );
    let resumed = pilot.control(&mut bench.memory(), &Control::Resume);
    assert_eq!(resumed, Ok(Status::Exploring));
}

#[test]
fn a_stopped_session_stays_stopped() {
    let (mut pilot, mut bench) = started();
    let stopped = Status::Finished(Finish::Stopped);
    assert_eq!(
        pilot.control(&mut bench.memory(), &Control::Stop),
        Ok(stopped)
    );
    assert_eq!(
        pilot.control(&mut bench.memory(), &Control::Resume),
        Ok(stopped)
    );
    let command = pilot
        .observe(&mut bench.memory(), &observation(100), &mut ())
        .unwrap();
    assert_eq!(
        (command.status, command.velocity),
        (stopped, Twist::default())
    );
}

#[test]
fn the_emergency_stop_holds_until_released_and_resumed() {
    let (mut pilot, mut bench) = started();
    pilot.set_emergency_stop(true);
    let command = pilot
        .observe(&mut bench.memory(), &observation(100), &mut ())
        .unwrap();
    assert_eq!(
        (command.status, command.velocity),
        (Status::EmergencyStop, Twist::default())
    );
    let held = pilot.control(&mut bench.memory(), &Control::Resume);
    assert_eq!(held, Ok(Status::EmergencyStop), "still pressed");
    let held = pilot.control(&mut bench.memory(), &Control::Start(start()));
    assert_eq!(held, Ok(Status::EmergencyStop), "still pressed");
    pilot.set_emergency_stop(false);
    assert_eq!(
        pilot.status(),
        Status::EmergencyStop,
        "a release does not resume"
    );
    let resumed = pilot.control(&mut bench.memory(), &Control::Resume);
    assert_eq!(resumed, Ok(Status::Exploring));
}

#[test]
fn a_wrong_observation_is_a_fault_until_the_next() {
    let (mut pilot, mut bench) = started();
    let mut wrong = observation(100);
    wrong.scans[1].ranges_mm.pop();
    let command = pilot.observe(&mut bench.memory(), &wrong, &mut ()).unwrap();
    assert_eq!(command.status, Status::Fault(Fault::BadObservation));
    assert_eq!(command.velocity, Twist::default());
    assert_eq!(pilot.status(), Status::Exploring);
}

#[test]
fn a_reset_ends_the_session_but_not_the_emergency_stop() {
    let (mut pilot, mut bench) = started();
    pilot.set_emergency_stop(true);
    let status = pilot.control(&mut bench.memory(), &Control::Reset);
    assert_eq!(status, Ok(Status::EmergencyStop));
    pilot.set_emergency_stop(false);
    let refused = pilot.observe(&mut bench.memory(), &observation(0), &mut ());
    assert_eq!(refused, Err(Refusal::NotStarted));
}

fn in_team() -> (Pilot, Bench) {
    let (mut pilot, mut bench) = (Pilot::new(), Bench::new());
    let team = Team {
        member: Member { id: 1, boot: 4 },
        origin: (I16F16::lit("2"), I16F16::lit("-1")),
        yaw: I16F16::lit("1.570796"),
        sd_mm: 0,
        sd_mrad: 0,
    };
    let start = Start {
        team: Some(team),
        ..start()
    };
    let status = pilot.control(&mut bench.memory(), &Control::Start(start));
    assert_eq!(status, Ok(Status::Exploring));
    (pilot, bench)
}

fn of_another(sequence: u16) -> Packet {
    Packet {
        from: Member { id: 2, boot: 0 },
        sequence,
        body: Body::Beacon(Beacon::default()),
    }
}

#[test]
fn a_robot_alone_neither_hears_nor_says() {
    let (mut pilot, mut bench) = (Pilot::new(), Bench::new());
    let mut memory = bench.memory();
    assert_eq!(pilot.say(&mut memory), Err(Refusal::NotStarted));
    let (mut pilot, mut bench) = started();
    let mut memory = bench.memory();
    assert_eq!(pilot.say(&mut memory), Err(Refusal::NoTeam));
    let heard = pilot.hear(&mut memory, &of_another(0));
    assert_eq!(heard, Err(Refusal::NoTeam));
}

/// Returns the first packet after an observation.
fn said(pilot: &mut Pilot, bench: &mut Bench, observation: &Observation) -> Option<Packet> {
    let mut memory = bench.memory();
    pilot.observe(&mut memory, observation, &mut ()).unwrap();
    pilot.say(&mut memory).unwrap()
}

/// Returns the beacon after an observation.
fn beacon(pilot: &mut Pilot, bench: &mut Bench, time_ms: u32) -> Beacon {
    match said(pilot, bench, &observation(time_ms)).map(|packet| packet.body) {
        Some(Body::Beacon(beacon)) => beacon,
        other => panic!("{other:?}"),
    }
}

/// The odometry starts at (2 m, −1 m) of the team and is turned left by a right angle.
#[test]
fn a_beacon_tells_the_pose_in_the_coordinates_of_the_team() {
    let (mut pilot, mut bench) = in_team();
    assert_eq!(pilot.say(&mut bench.memory()), Ok(None), "no step yet");
    let mut observation = observation(0);
    observation.pose.x = I16F16::lit("0.5");
    let first = said(&mut pilot, &mut bench, &observation).unwrap();
    assert_eq!((first.from.id, first.from.boot, first.sequence), (1, 4, 0));
    let Body::Beacon(beacon) = first.body else {
        panic!("{first:?}");
    };
    assert_eq!((beacon.x_cm, beacon.y_cm), (200, -50));
    assert!((beacon.yaw.to_num::<f32>() - core::f32::consts::FRAC_PI_2).abs() < 1e-3);
    assert_eq!((beacon.half_length_cm, beacon.half_width_cm), (26, 25));
    assert_eq!(beacon.activity, Activity::Exploring);
}

#[test]
fn a_robot_that_stands_by_order_goes_on_to_say_so() {
    let (mut pilot, mut bench) = in_team();
    let orders = [
        (Control::Pause, Activity::Standing),
        (Control::Resume, Activity::Exploring),
        (Control::Stop, Activity::Gone),
    ];
    for (time_ms, (order, activity)) in (0..).step_by(200).zip(orders) {
        pilot.control(&mut bench.memory(), &order).unwrap();
        let beacon = beacon(&mut pilot, &mut bench, time_ms);
        assert_eq!(beacon.activity, activity, "{order:?}");
    }
}

#[test]
fn peers_are_heard_and_the_own_packets_are_not() {
    let (mut pilot, mut bench) = in_team();
    let mut own = of_another(0);
    own.from.id = 1;
    pilot.hear(&mut bench.memory(), &own).unwrap();
    assert_eq!(bench.state.peers().count(), 0);
    pilot.hear(&mut bench.memory(), &of_another(1)).unwrap();
    assert_eq!(bench.state.peers().count(), 1);
}

/// Returns a square with the middle at the start and this half side.
fn square(half_m: i32, bounds: bool) -> Fence {
    let at = I16F16::from_num::<i32>(half_m);
    let corners = [(-at, -at), (at, -at), (at, at), (-at, at)];
    Fence {
        corners: corners.into_iter().collect(),
        polygons: [FencePolygon { corners: 4, bounds }].into_iter().collect(),
    }
}

#[test]
fn a_fence_that_is_none_is_refused_and_a_start_outside_ends() {
    let (mut pilot, mut bench) = (Pilot::new(), Bench::new());
    let mut crossed = square(3, true);
    crossed.corners.swap(0, 1);
    let mut short = square(3, true);
    short.corners.pop();
    let mut long = square(3, true);
    long.corners.extend([(I16F16::ZERO, I16F16::ZERO)]);
    for fence in [crossed, short, long] {
        let fenced = Control::Start(Start { fence, ..start() });
        let refused = pilot.control(&mut bench.memory(), &fenced);
        assert_eq!(refused, Err(Refusal::BadParameter(Parameter::Fence)));
    }
    for (fence, status) in [
        (square(2, true), Status::Exploring),
        (square(2, false), Status::Fault(Fault::StartForbidden)),
    ] {
        let fenced = Control::Start(Start { fence, ..start() });
        pilot.control(&mut bench.memory(), &fenced).unwrap();
        let command = pilot.observe(&mut bench.memory(), &observation(0), &mut ());
        assert_eq!(command.unwrap().status, status);
    }
    let refused = pilot.control(&mut bench.memory(), &Control::Home);
    assert_eq!(refused, Err(Refusal::NotReady));
}

/// A session that was given a map goes on: the robot may stand where a start is refused.
#[test]
fn a_session_with_a_map_is_no_start() {
    let (mut pilot, mut bench) = (Pilot::new(), Bench::new());
    let fence = square(2, false);
    let fenced = Control::Start(Start { fence, ..start() });
    pilot.control(&mut bench.memory(), &fenced).unwrap();
    let opening = Correct {
        epoch: 1,
        ..Correct::default()
    };
    pilot.correct(&mut bench.memory(), &opening).unwrap();
    let last = CorrectedTiles {
        epoch: 1,
        last: true,
        ..CorrectedTiles::default()
    };
    let progress = pilot.tiles(&mut bench.memory(), &last).unwrap();
    assert!(progress.closed);
    let command = pilot.observe(&mut bench.memory(), &observation(0), &mut ());
    assert_eq!(command.unwrap().status, Status::Exploring);
    let home = pilot.control(&mut bench.memory(), &Control::Home);
    assert_eq!(
        home,
        Err(Refusal::BadGoal),
        "home lies in the no-go polygon"
    );
}

/// A device that was reset begins its session where the robot is, and is told where home is.
#[test]
fn home_is_where_it_is_set_and_no_longer_where_the_session_began() {
    let (mut pilot, mut bench) = (Pilot::new(), Bench::new());
    let set = |x: f32| Control::SetHome {
        x: I16F16::from_num(x),
        y: I16F16::ZERO,
        yaw: I16F16::ZERO,
    };
    let refused = pilot.control(&mut bench.memory(), &set(0.0));
    assert_eq!(refused, Err(Refusal::NotStarted));
    let go = Control::Start(start());
    pilot.control(&mut bench.memory(), &go).unwrap();
    let far = pilot.control(&mut bench.memory(), &set(4_000.0));
    assert_eq!(far, Err(Refusal::BadGoal));
    pilot.control(&mut bench.memory(), &set(-7.5)).unwrap();
    pilot
        .observe(&mut bench.memory(), &observation(0), &mut ())
        .unwrap();
    assert_eq!(bench.memory().state.home().x_m, -7.5);
    let home = pilot.control(&mut bench.memory(), &Control::Home);
    assert_eq!(home, Ok(Status::Going(Errand::Home)));
    pilot.control(&mut bench.memory(), &go).unwrap();
    pilot
        .observe(&mut bench.memory(), &observation(0), &mut ())
        .unwrap();
    assert_eq!(bench.memory().state.home().x_m, 0.0, "a new session");
}

#[test]
fn orders_are_taken_once_there_is_a_scan_and_say_why_not() {
    let (mut pilot, mut bench) = (Pilot::new(), Bench::new());
    let go_to = |x: i32| Control::GoTo {
        x: I16F16::from_num(x),
        y: I16F16::ZERO,
    };
    let order = |pilot: &mut Pilot, bench: &mut Bench, control: &Control| {
        pilot.control(&mut bench.memory(), control)
    };
    assert_eq!(
        order(&mut pilot, &mut bench, &Control::Home),
        Err(Refusal::NotStarted)
    );
    let fence = square(3, true);
    let fenced = Control::Start(Start { fence, ..start() });
    pilot.control(&mut bench.memory(), &fenced).unwrap();
    assert_eq!(
        order(&mut pilot, &mut bench, &Control::Home),
        Err(Refusal::NotReady)
    );
    pilot
        .observe(&mut bench.memory(), &observation(0), &mut ())
        .unwrap();
    for far in [4, 30_000] {
        assert_eq!(
            order(&mut pilot, &mut bench, &go_to(far)),
            Err(Refusal::BadGoal)
        );
    }
    let going = Status::Going(Errand::Goal);
    assert_eq!(order(&mut pilot, &mut bench, &go_to(2)), Ok(going));
    assert_eq!(
        order(&mut pilot, &mut bench, &Control::Pause),
        Ok(Status::Paused)
    );
    assert_eq!(order(&mut pilot, &mut bench, &Control::Resume), Ok(going));
    let home = order(&mut pilot, &mut bench, &Control::Home);
    assert_eq!(home, Ok(Status::Going(Errand::Home)));
    // The robot has not moved.
    let command = pilot.observe(&mut bench.memory(), &observation(200), &mut ());
    let mut status = command.unwrap().status;
    for step in 2..20 {
        let command = pilot.observe(&mut bench.memory(), &observation(200 * step), &mut ());
        status = command.unwrap().status;
    }
    assert_eq!(status, Status::Arrived(Errand::Home));
    let explore = order(&mut pilot, &mut bench, &Control::Explore);
    assert_eq!(explore, Ok(Status::Exploring));
    order(&mut pilot, &mut bench, &Control::Stop).unwrap();
    assert_eq!(
        order(&mut pilot, &mut bench, &Control::Home),
        Err(Refusal::NotReady)
    );
}

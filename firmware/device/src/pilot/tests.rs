//! States of a session, and helpers for the other tests of this crate.

use std::boxed::Box;

use fieldline_planner::{State, Tuning, Workspace};
use fieldline_protocol::message::{
    Activity, Beacon, Body, Budget, Command, Control, Correct, CorrectedTiles, CorrectionProgress,
    Errand, Fault, Fence, FencePolygon, Finish, Hull, Laser, LoopLimits, Member, Observation,
    Order, Packet, Parameter, Recall, Refusal, Scan, SpaceField, Start, Status, Strategy, Team,
    Twist,
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
        turn_time_ms: 0,
        newest_first: false,
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

/// A pilot and its memory.
struct Device {
    pilot: Pilot,
    bench: Bench,
}

impl Device {
    fn new() -> Self {
        Self {
            pilot: Pilot::new(),
            bench: Bench::new(),
        }
    }

    /// Returns a device with a session.
    fn started(start: Start) -> Self {
        let mut device = Self::new();
        assert_eq!(device.order(&Control::Start(start)), Ok(Status::Exploring));
        device
    }

    fn order(&mut self, control: &Control) -> Result<Status, Refusal> {
        self.pilot.control(&mut self.bench.memory(), control)
    }

    fn observe(&mut self, observation: &Observation) -> Result<Command, Refusal> {
        let mut memory = self.bench.memory();
        self.pilot.observe(&mut memory, observation, &mut ())
    }

    /// Returns the status and the velocity after an observation at a time.
    fn answer(&mut self, time_ms: u32) -> (Status, Twist) {
        let command = self.observe(&observation(time_ms)).unwrap();
        (command.status, command.velocity)
    }

    fn say(&mut self) -> Result<Option<Packet>, Refusal> {
        self.pilot.say(&mut self.bench.memory())
    }

    fn hear(&mut self, packet: &Packet) -> Result<(), Refusal> {
        self.pilot.hear(&mut self.bench.memory(), packet)
    }

    fn correct(&mut self, correct: &Correct) -> Result<CorrectionProgress, Refusal> {
        self.pilot.correct(&mut self.bench.memory(), correct)
    }

    fn tiles(&mut self, part: &CorrectedTiles) -> Result<CorrectionProgress, Refusal> {
        self.pilot.tiles(&mut self.bench.memory(), part)
    }

    fn recall(&mut self, recall: &Recall) -> Result<CorrectionProgress, Refusal> {
        self.pilot.recall(&mut self.bench.memory(), recall)
    }

    /// Returns the first packet after an observation.
    fn said(&mut self, observation: &Observation) -> Option<Packet> {
        self.observe(observation).unwrap();
        self.say().unwrap()
    }
}

#[test]
fn nothing_happens_before_a_start() {
    let mut device = Device::new();
    assert_eq!(device.pilot.status(), Status::Idle);
    for control in [Control::Pause, Control::Resume, Control::Stop] {
        let refused = device.order(&control);
        assert_eq!(refused, Err(Refusal::NotStarted), "{control:?}");
    }
    let refused = device.observe(&observation(0));
    assert_eq!(refused, Err(Refusal::NotStarted));
}

#[test]
fn a_survey_maps_and_localises_and_never_moves_or_ends() {
    let mut device = Device::new();
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
    let status = device.order(&Control::Start(survey));
    assert_eq!(status, Ok(Status::Exploring));
    // 4 m of free space is a closed room: a session that explores ends in it.
    for step in 0..60 {
        let mut scan = observation(200 * step);
        scan.scans.truncate(1);
        if step == 0 {
            // Somebody stands before the laser: an exploration would not start.
            scan.scans[0].ranges_mm.fill(50);
        }
        let command = device.observe(&scan).unwrap();
        assert_eq!(command.status, Status::Exploring);
        assert_eq!(command.velocity, Twist::default());
        assert!(command.location.is_some());
    }
    assert!(device.bench.memory().tile(0, 0).is_some());
    assert_eq!(device.bench.memory().field_row(0), None);
}

#[test]
fn a_refused_start_changes_nothing() {
    let mut device = Device::started(start());
    let bad = Start {
        robot_radius_mm: 0,
        ..start()
    };
    let refused = device.order(&Control::Start(bad));
    assert_eq!(refused, Err(Refusal::BadParameter(Parameter::Radius)));
    assert_eq!(device.pilot.status(), Status::Exploring);
}

#[test]
fn a_pause_holds_until_resume() {
    let mut device = Device::started(start());
    let paused = device.order(&Control::Pause);
    assert_eq!(paused, Ok(Status::Paused));
    assert_eq!(device.answer(100), (Status::Paused, Twist::default()));
    let resumed = device.order(&Control::Resume);
    assert_eq!(resumed, Ok(Status::Exploring));
}

#[test]
fn a_stopped_session_stays_stopped() {
    let mut device = Device::started(start());
    let stopped = Status::Finished(Finish::Stopped);
    assert_eq!(device.order(&Control::Stop), Ok(stopped));
    assert_eq!(device.order(&Control::Resume), Ok(stopped));
    assert_eq!(device.answer(100), (stopped, Twist::default()));
}

#[test]
fn the_emergency_stop_holds_until_released_and_resumed() {
    let mut device = Device::started(start());
    device.pilot.set_emergency_stop(true);
    assert_eq!(
        device.answer(100),
        (Status::EmergencyStop, Twist::default())
    );
    let held = device.order(&Control::Resume);
    assert_eq!(held, Ok(Status::EmergencyStop), "still pressed");
    let held = device.order(&Control::Start(start()));
    assert_eq!(held, Ok(Status::EmergencyStop), "still pressed");
    device.pilot.set_emergency_stop(false);
    assert_eq!(
        device.pilot.status(),
        Status::EmergencyStop,
        "a release does not resume"
    );
    let resumed = device.order(&Control::Resume);
    assert_eq!(resumed, Ok(Status::Exploring));
}

#[test]
fn a_wrong_observation_is_a_fault_until_the_next() {
    let mut device = Device::started(start());
    let mut wrong = observation(100);
    wrong.scans[1].ranges_mm.pop();
    let command = device.observe(&wrong).unwrap();
    assert_eq!(command.status, Status::Fault(Fault::BadObservation));
    assert_eq!(command.velocity, Twist::default());
    assert_eq!(device.pilot.status(), Status::Exploring);
}

#[test]
fn a_reset_ends_the_session_but_not_the_emergency_stop() {
    let mut device = Device::started(start());
    device.pilot.set_emergency_stop(true);
    let status = device.order(&Control::Reset);
    assert_eq!(status, Ok(Status::EmergencyStop));
    device.pilot.set_emergency_stop(false);
    let refused = device.observe(&observation(0));
    assert_eq!(refused, Err(Refusal::NotStarted));
}

fn in_team() -> Device {
    let team = Team {
        member: Member { id: 1, boot: 4 },
        origin: (I16F16::lit("2"), I16F16::lit("-1")),
        yaw: I16F16::lit("1.570796"),
        sd_mm: 0,
        sd_mrad: 0,
    };
    Device::started(Start {
        team: Some(team),
        ..start()
    })
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
    let mut device = Device::new();
    assert_eq!(device.say(), Err(Refusal::NotStarted));
    let mut device = Device::started(start());
    assert_eq!(device.say(), Err(Refusal::NoTeam));
    let heard = device.hear(&of_another(0));
    assert_eq!(heard, Err(Refusal::NoTeam));
}

/// The odometry starts at (2 m, −1 m) of the team and is turned left by a right angle.
#[test]
fn a_beacon_tells_the_pose_in_the_coordinates_of_the_team() {
    let mut device = in_team();
    assert_eq!(device.say(), Ok(None), "no step yet");
    let mut observation = observation(0);
    observation.pose.x = I16F16::lit("0.5");
    let first = device.said(&observation).unwrap();
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
    let mut device = in_team();
    let orders = [
        (Control::Pause, Activity::Standing),
        (Control::Resume, Activity::Exploring),
        (Control::Stop, Activity::Gone),
    ];
    for (time_ms, (order, activity)) in (0..).step_by(200).zip(orders) {
        device.order(&order).unwrap();
        match device.said(&observation(time_ms)).map(|packet| packet.body) {
            Some(Body::Beacon(beacon)) => assert_eq!(beacon.activity, activity, "{order:?}"),
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn peers_are_heard_and_the_own_packets_are_not() {
    let mut device = in_team();
    let mut own = of_another(0);
    own.from.id = 1;
    device.hear(&own).unwrap();
    assert_eq!(device.bench.state.peers().count(), 0);
    device.hear(&of_another(1)).unwrap();
    assert_eq!(device.bench.state.peers().count(), 1);
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
    let mut device = Device::new();
    let mut crossed = square(3, true);
    crossed.corners.swap(0, 1);
    let mut short = square(3, true);
    short.corners.pop();
    let mut long = square(3, true);
    long.corners.extend([(I16F16::ZERO, I16F16::ZERO)]);
    for fence in [crossed, short, long] {
        let fenced = Control::Start(Start { fence, ..start() });
        let refused = device.order(&fenced);
        assert_eq!(refused, Err(Refusal::BadParameter(Parameter::Fence)));
    }
    for (fence, status) in [
        (square(2, true), Status::Exploring),
        (square(2, false), Status::Fault(Fault::StartForbidden)),
    ] {
        let fenced = Control::Start(Start { fence, ..start() });
        device.order(&fenced).unwrap();
        assert_eq!(device.answer(0).0, status);
    }
    let refused = device.order(&Control::Home);
    assert_eq!(refused, Err(Refusal::NotReady));
}

/// A session that was given a map goes on: the robot may stand where a start is refused.
#[test]
fn a_session_with_a_map_is_no_start() {
    let mut device = Device::new();
    let fence = square(2, false);
    let fenced = Control::Start(Start { fence, ..start() });
    device.order(&fenced).unwrap();
    let opening = Correct {
        epoch: 1,
        ..Correct::default()
    };
    device.correct(&opening).unwrap();
    let last = CorrectedTiles {
        epoch: 1,
        last: true,
        ..CorrectedTiles::default()
    };
    let progress = device.tiles(&last).unwrap();
    assert!(progress.closed);
    assert_eq!(device.answer(0).0, Status::Exploring);
    let home = device.order(&Control::Home);
    assert_eq!(
        home,
        Err(Refusal::BadGoal),
        "home lies in the no-go polygon"
    );
}

/// A device that was reset begins its session where the robot is, and is told where home is.
#[test]
fn home_is_where_it_is_set_and_no_longer_where_the_session_began() {
    let mut device = Device::new();
    let set = |x: f32| Control::SetHome {
        x: I16F16::from_num(x),
        y: I16F16::ZERO,
        yaw: I16F16::ZERO,
    };
    let refused = device.order(&set(0.0));
    assert_eq!(refused, Err(Refusal::NotStarted));
    let go = Control::Start(start());
    device.order(&go).unwrap();
    let far = device.order(&set(4_000.0));
    assert_eq!(far, Err(Refusal::BadGoal));
    device.order(&set(-7.5)).unwrap();
    device.observe(&observation(0)).unwrap();
    assert_eq!(device.bench.memory().state.home().x_m, -7.5);
    let home = device.order(&Control::Home);
    assert_eq!(home, Ok(Status::Going(Errand::Home)));
    device.order(&go).unwrap();
    device.observe(&observation(0)).unwrap();
    assert_eq!(device.bench.memory().state.home().x_m, 0.0, "a new session");
}

#[test]
fn orders_are_taken_once_there_is_a_scan_and_say_why_not() {
    let mut device = Device::new();
    let go_to = |x: i32| Control::GoTo {
        x: I16F16::from_num(x),
        y: I16F16::ZERO,
    };
    assert_eq!(device.order(&Control::Home), Err(Refusal::NotStarted));
    let fence = square(3, true);
    let fenced = Control::Start(Start { fence, ..start() });
    device.order(&fenced).unwrap();
    assert_eq!(device.order(&Control::Home), Err(Refusal::NotReady));
    device.observe(&observation(0)).unwrap();
    for far in [4, 30_000] {
        assert_eq!(device.order(&go_to(far)), Err(Refusal::BadGoal));
    }
    let going = Status::Going(Errand::Goal);
    assert_eq!(device.order(&go_to(2)), Ok(going));
    assert_eq!(device.order(&Control::Pause), Ok(Status::Paused));
    assert_eq!(device.order(&Control::Resume), Ok(going));
    let home = device.order(&Control::Home);
    assert_eq!(home, Ok(Status::Going(Errand::Home)));
    // The robot has not moved.
    let last = (1..20).map(|step| device.answer(200 * step).0).last();
    assert_eq!(last, Some(Status::Arrived(Errand::Home)));
    let explore = device.order(&Control::Explore);
    assert_eq!(explore, Ok(Status::Exploring));
    device.order(&Control::Stop).unwrap();
    assert_eq!(device.order(&Control::Home), Err(Refusal::NotReady));
}

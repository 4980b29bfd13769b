//! Errands of a robot in a closed room, by whole steps: where it may say that it has arrived, when
//! it drives backwards, and that a turn which does not come on ends.

use std::boxed::Box;
use std::vec::Vec;

use super::{Going, PROMISED, Task};
use crate::geometry::{Point, Pose, Twist};
use crate::math;
use crate::robot::{LaserMount, RobotShape};
use crate::status::{Errand, Status};
use crate::{Capacity, Config, Input, Planner, State};

/// Time from one step to the next, milliseconds.
const PERIOD_MS: u32 = 200;
/// Beams of the laser, a degree apart, the first one to the right.
const BEAMS: usize = 181;
/// Place of the laser ahead of the robot's middle, metres.
const AHEAD_M: f32 = 0.10;

/// A robot in a room with its walls along the axes.
struct Room {
    /// Least and greatest x and y of the room, metres.
    least: [f32; 2],
    most: [f32; 2],
    planner: Box<Planner<Capacity<24, 40>>>,
    pose: Pose,
    velocity: Twist,
    time_ms: u32,
}

impl Room {
    fn new(least: [f32; 2], most: [f32; 2]) -> Self {
        let config = Config::builder(RobotShape::PIONEER_3AT)
            .laser(LaserMount::level(AHEAD_M, 0.40))
            .build()
            .expect("a configuration");
        let mut room = Self {
            least,
            most,
            planner: Box::new(Planner::new(&config)),
            pose: Pose::default(),
            velocity: Twist::default(),
            time_ms: 0,
        };
        room.step();
        room
    }

    /// Returns the scan from where the robot stands, millimetres.
    fn scan(&self) -> Vec<u16> {
        let yaw_rad = self.pose.yaw_rad;
        let (sin, cos) = (yaw_rad.sin(), yaw_rad.cos());
        let from = [self.pose.x_m + AHEAD_M * cos, self.pose.y_m + AHEAD_M * sin];
        let beam = |k: usize| {
            let bearing = yaw_rad + (k as f32 - 90.0) * math::PI / 180.0;
            let way = [bearing.cos(), bearing.sin()];
            let to_wall = |axis: usize| {
                let wall = if way[axis] > 0.0 {
                    self.most
                } else {
                    self.least
                };
                (wall[axis] - from[axis]) / way[axis]
            };
            let ranges = [0, 1].map(|axis| match way[axis].abs() > 1e-4 {
                true => to_wall(axis),
                false => f32::INFINITY,
            });
            (1000.0 * ranges[0].min(ranges[1]).clamp(0.03, 8.0)) as u16
        };
        (0..BEAMS).map(beam).collect()
    }

    /// Makes a step, and drives what it says.
    fn step(&mut self) -> Status {
        let scan = self.scan();
        let output = self.planner.step(&Input {
            time_ms: self.time_ms,
            pose: self.pose,
            velocity: self.velocity,
            scans: [&scan, &[]],
        });
        self.velocity = output.velocity;
        self.drive(self.velocity);
        output.status
    }

    fn drive(&mut self, velocity: Twist) {
        let seconds = PERIOD_MS as f32 / 1000.0;
        let turn = velocity.angular_radps * seconds;
        let yaw_rad = self.pose.yaw_rad + 0.5 * turn;
        self.pose.x_m += velocity.linear_mps * seconds * yaw_rad.cos();
        self.pose.y_m += velocity.linear_mps * seconds * yaw_rad.sin();
        self.pose.yaw_rad = math::wrap(self.pose.yaw_rad + turn);
        self.time_ms += PERIOD_MS;
    }

    /// Gives an order, and drives until the errand has ended, at most so many seconds. `after` may
    /// move the robot after each step. Returns the status at the end, and the seconds.
    fn go(
        &mut self,
        task: Task,
        most_s: u32,
        mut after: impl FnMut(&mut Self, Twist),
    ) -> (Status, u32) {
        self.planner.order(task).expect("an order");
        let begun_ms = self.time_ms;
        loop {
            let status = self.step();
            let seconds = (self.time_ms - begun_ms) / 1000;
            if !matches!(status, Status::Going(_)) || seconds >= most_s {
                return (status, seconds);
            }
            let velocity = self.velocity;
            after(self, velocity);
        }
    }

    /// Asserts that the robot stands where home is promised to be.
    fn assert_home(&self, what: &str) {
        let off_m = self.pose.point().distance_m(Point { x_m: 0.0, y_m: 0.0 });
        let off_rad = self.pose.yaw_rad.abs();
        assert!(
            off_m <= PROMISED.0 && off_rad <= PROMISED.1,
            "{what}: {off_m} m, {off_rad} rad"
        );
    }
}

#[test]
fn at_home_is_within_a_fifth_of_a_metre_and_ten_degrees_from_wherever_it_came() {
    // A goal must be known, and the robot has looked ahead only.
    for degrees in [-80, -40, 0, 30, 75] {
        let bearing = degrees as f32 * math::PI / 180.0;
        let there = Point {
            x_m: 1.6 * bearing.cos(),
            y_m: 1.6 * bearing.sin(),
        };
        let mut room = Room::new([-3.0, -3.0], [3.0, 3.0]);
        for _ in 0..5 {
            room.step();
        }
        let (status, _) = room.go(Task::GoTo(there), 60, |_, _| {});
        assert_eq!(status, Status::Arrived(Errand::Goal), "{degrees}");
        let off_m = room.pose.point().distance_m(there);
        assert!(off_m <= PROMISED.0, "{degrees}: {off_m} m");
        let (status, _) = room.go(Task::Home, 60, |_, _| {});
        assert_eq!(status, Status::Arrived(Errand::Home), "{degrees}");
        room.assert_home("at home");
    }
}

/// A corridor leaves the hull a decimetre on each side: it can drive, and not turn.
#[test]
fn a_robot_that_cannot_turn_to_home_backs_to_it() {
    let mut room = Room::new([-1.0, -0.35], [4.0, 0.35]);
    let (status, _) = room.go(Task::GoTo(Point { x_m: 0.8, y_m: 0.0 }), 60, |_, _| {});
    assert_eq!(status, Status::Arrived(Errand::Goal));
    let (mut backs, mut most_rad) = (0, 0.0_f32);
    let (status, seconds) = room.go(Task::Home, 60, |room, velocity| {
        backs += u32::from(velocity.linear_mps < 0.0);
        most_rad = most_rad.max(room.pose.yaw_rad.abs());
    });
    assert_eq!(status, Status::Arrived(Errand::Home), "after {seconds} s");
    room.assert_home("backwards");
    assert!(
        backs > 10 && most_rad < 0.5,
        "{backs} steps, {most_rad} rad"
    );
}

/// It can turn there, so it drives home with its nose ahead.
#[test]
fn a_robot_that_can_turn_to_home_does_not_back() {
    let mut room = Room::new([-3.0, -3.0], [3.0, 3.0]);
    let _ = room.go(Task::GoTo(Point { x_m: 0.8, y_m: 0.0 }), 60, |_, _| {});
    let mut backs = 0;
    let (status, _) = room.go(Task::Home, 60, |_, velocity| {
        backs += u32::from(velocity.linear_mps < -0.01);
    });
    assert_eq!((status, backs), (Status::Arrived(Errand::Home), 0));
}

/// The wheels turn, and the robot is turned back by as much every other second.
#[test]
fn a_turn_that_does_not_come_on_ends() {
    let mut room = Room::new([-3.0, -3.0], [3.0, 3.0]);
    let (status, _) = room.go(Task::GoTo(Point { x_m: 1.2, y_m: 0.0 }), 60, |_, _| {});
    assert_eq!(status, Status::Arrived(Errand::Goal));
    let mut held_rad = None;
    let (status, seconds) = room.go(Task::Home, 120, |room, velocity| {
        let is_there = room.pose.point().distance_m(Point { x_m: 0.0, y_m: 0.0 }) < 0.1;
        if is_there && velocity.linear_mps == 0.0 {
            let held_rad = *held_rad.get_or_insert(room.pose.yaw_rad);
            if (room.time_ms / 1000).is_multiple_of(2) {
                room.pose.yaw_rad = held_rad;
            }
        }
    });
    assert_eq!(
        status,
        Status::Unreachable(Errand::Home),
        "after {seconds} s"
    );
    assert!(seconds < 60, "{seconds} s");
}

/// A turn of half a degree a step takes a minute, and comes on all the time.
#[test]
fn a_slow_turn_has_the_time_that_it_takes() {
    let mut room = Room::new([-3.0, -3.0], [3.0, 3.0]);
    let (status, _) = room.go(Task::GoTo(Point { x_m: 1.2, y_m: 0.0 }), 60, |_, _| {});
    assert_eq!(status, Status::Arrived(Errand::Goal));
    let (status, seconds) = room.go(Task::Home, 120, |room, velocity| {
        let is_there = room.pose.point().distance_m(Point { x_m: 0.0, y_m: 0.0 }) < 0.1;
        if is_there && velocity.linear_mps == 0.0 {
            let turned = velocity.angular_radps * 0.2;
            let slow = turned.clamp(-0.0087, 0.0087);
            room.pose.yaw_rad = math::wrap(room.pose.yaw_rad - turned + slow);
        }
    });
    assert_eq!(status, Status::Arrived(Errand::Home), "after {seconds} s");
    room.assert_home("slowly");
    assert!(seconds > 40, "{seconds} s");
}

/// Nothing leads nearer: a robot within 0.2 m turns where it stands, once; another one has ended.
#[test]
fn where_nothing_leads_nearer_the_robot_turns_if_it_is_as_near_as_promised() {
    let begin = |x_m: f32| {
        let mut state = Box::new(State::<16, 20>::new());
        let home = Going::new(Errand::Home, Point { x_m, y_m: 0.0 }, Some(1.0));
        state.plan_anew(Some(home));
        state.give_up_errand();
        state
    };
    assert_eq!(begin(0.25).status, Status::Unreachable(Errand::Home));
    let mut state = begin(0.15);
    assert_eq!(state.status, Status::Going(Errand::Home));
    assert!(state.errands.last.is_there);
    state.give_up_errand();
    assert_eq!(state.status, Status::Going(Errand::Home), "it turns");
    // It slipped away, and nothing leads back.
    state.errands.last.is_there = false;
    state.give_up_errand();
    assert_eq!(state.status, Status::Unreachable(Errand::Home));
}

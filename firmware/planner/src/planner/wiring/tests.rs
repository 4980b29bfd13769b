//! Each hypothesis in drawn scenes: a room with a niche, which decides all of them, and places that
//! decide nothing.

use std::vec::Vec;

use super::Wiring;
use crate::config::Config;
use crate::geometry::{Point, Pose, Twist};
use crate::input::{Input, NO_RETURN_MM};
use crate::math;
use crate::robot::{LaserMount, RobotShape};
use crate::status::Mistake;

/// Walls, from point to point, metres.
type Walls = &'static [[f32; 4]];

/// A room of 6 × 4 m with a niche and a pillar.
const ROOM: Walls = &[
    [-2.0, -1.5, 4.0, -1.5],
    [4.0, -1.5, 4.0, 2.5],
    [4.0, 2.5, 1.0, 2.5],
    [1.0, 2.5, 1.0, 3.5],
    [1.0, 3.5, -0.5, 3.5],
    [-0.5, 3.5, -0.5, 2.5],
    [-0.5, 2.5, -2.0, 2.5],
    [-2.0, 2.5, -2.0, -1.5],
    [2.4, -0.8, 2.8, -0.8],
    [2.4, -0.8, 2.4, -0.4],
];
/// A straight corridor, longer than the range.
const CORRIDOR: Walls = &[[-40.0, -1.0, 40.0, -1.0], [-40.0, 1.0, 40.0, 1.0]];

/// What is wired wrongly. The factors are of way and turn.
#[derive(Clone, Copy)]
struct Wrong {
    heard: [f32; 2],
    odometry: [f32; 2],
    is_mirrored: bool,
    laser_rad: f32,
    scan_stands: bool,
    clock: u32,
}

const RIGHT: Wrong = Wrong {
    heard: [1.0; 2],
    odometry: [1.0; 2],
    is_mirrored: false,
    laser_rad: 0.0,
    scan_stands: false,
    clock: 1,
};

/// Returns the range of a beam, millimetres.
fn cast(walls: Walls, from: Point, bearing_rad: f32) -> u16 {
    let (sin, cos) = math::sin_cos(bearing_rad);
    let hits = walls.iter().filter_map(|&[ax, ay, bx, by]| {
        let (dx, dy) = (bx - ax, by - ay);
        let cross = cos * dy - sin * dx;
        if cross.abs() < 1e-6 {
            return None;
        }
        let (ox, oy) = (ax - from.x_m, ay - from.y_m);
        let along = (ox * dy - oy * dx) / cross;
        let part = (ox * sin - oy * cos) / cross;
        (along > 0.0 && (0.0..=1.0).contains(&part)).then_some(along)
    });
    let nearest = hits.fold(f32::INFINITY, f32::min);
    if nearest < 12.0 {
        (1000.0 * nearest) as u16
    } else {
        NO_RETURN_MM
    }
}

/// A robot that drives in a room and is checked.
struct Robot {
    walls: Walls,
    wrong: Wrong,
    config: Config,
    truth: Pose,
    odometry: Pose,
    time_ms: u32,
    check: Wiring,
    way_m: f32,
    turn_rad: f32,
}

impl Robot {
    fn new(walls: Walls, wrong: Wrong) -> Self {
        let laser = LaserMount {
            first_bearing_rad: -core::f32::consts::PI,
            bearing_step_rad: 2.0 * core::f32::consts::PI / 180.0,
            beams: 180,
            ..LaserMount::level(0.10, 0.40)
        };
        let builder = Config::builder(RobotShape::PIONEER_3AT).laser(laser);
        Self {
            walls,
            wrong,
            config: builder.build().expect("valid"),
            truth: Pose::default(),
            odometry: Pose::default(),
            time_ms: 0,
            check: Wiring::new(),
            way_m: 0.0,
            turn_rad: 0.0,
        }
    }

    fn scan(&self) -> Vec<u16> {
        let laser = &self.config.lasers[0];
        let truth = if self.wrong.scan_stands {
            Pose::default()
        } else {
            self.truth
        };
        let from = truth.to_map(Point {
            x_m: laser.x_m,
            y_m: laser.y_m,
        });
        let beams = 0..laser.beams;
        let range = |number: u16| {
            let bearing = laser.first_bearing_rad + f32::from(number) * laser.bearing_step_rad;
            let side = if self.wrong.is_mirrored { -1.0 } else { 1.0 };
            let looks = truth.yaw_rad + side * bearing + self.wrong.laser_rad;
            cast(self.walls, from, looks)
        };
        beams.map(range).collect()
    }

    /// Checks a report.
    fn report(&mut self) -> Option<Mistake> {
        let ranges = self.scan();
        let input = Input {
            time_ms: self.time_ms,
            pose: self.odometry,
            velocity: Twist::default(),
            scans: [&ranges, &[]],
        };
        let host_ms = self.time_ms * self.wrong.clock;
        self.check.watch(&self.config, &input, (host_ms, 0), false)
    }

    /// Drives so many periods; returns the mistake that is told.
    fn drive(&mut self, linear_mps: f32, angular_radps: f32, periods: u32) -> Option<Mistake> {
        for _ in 0..periods {
            if let Some(mistake) = self.report() {
                return Some(mistake);
            }
            self.check.tell(Twist {
                linear_mps,
                angular_radps,
            });
            let way_m = 0.2 * linear_mps * self.wrong.heard[0];
            let turn_rad = 0.2 * angular_radps * self.wrong.heard[1];
            self.truth = moved(&self.truth, way_m, turn_rad);
            let [way, turn] = self.wrong.odometry;
            self.odometry = moved(&self.odometry, way * way_m, turn * turn_rad);
            self.time_ms += 200;
            self.way_m += way_m.abs();
            self.turn_rad += turn_rad.abs();
        }
        None
    }

    /// A first drive: turns to and fro, and goes ahead and back.
    fn first_drive(&mut self) -> Option<Mistake> {
        self.drive(0.0, 0.6, 14)
            .or_else(|| self.drive(0.0, -0.6, 14))
            .or_else(|| self.drive(0.4, 0.0, 14))
            .or_else(|| self.drive(-0.4, 0.0, 14))
            .or_else(|| self.report())
    }
}

fn moved(pose: &Pose, way_m: f32, turn_rad: f32) -> Pose {
    let Point { x_m, y_m } = pose.to_map(Point {
        x_m: way_m,
        y_m: 0.0,
    });
    Pose {
        x_m,
        y_m,
        yaw_rad: math::wrap(pose.yaw_rad + turn_rad),
        ..*pose
    }
}

#[test]
fn a_robot_that_is_wired_rightly_passes_and_is_not_checked_again() {
    let mut robot = Robot::new(ROOM, RIGHT);
    assert_eq!(robot.first_drive(), None);
    assert!(robot.check.is_over, "{:?}", robot.check);
    robot.wrong.is_mirrored = true;
    assert_eq!(robot.first_drive(), None, "it only looks at the beginning");
}

/// The scans stand while the odometry goes on, and rightly so. A corridor does not end the check.
#[test]
fn wheels_that_slip_while_the_robot_turns_on_the_spot_are_no_mistake() {
    let mut robot = Robot::new(CORRIDOR, RIGHT);
    assert_eq!(robot.drive(0.4, 0.0, 7), None);
    for period in 0..60 {
        assert_eq!(robot.drive(0.0, 1.2, 1), None, "period {period}");
        robot.odometry = moved(&robot.odometry, 0.08, 0.0);
    }
}

#[test]
fn each_mistake_is_told_in_the_first_metre_and_quarter_turn() {
    let mirrored = Wrong {
        is_mirrored: true,
        ..RIGHT
    };
    let standing = Wrong {
        scan_stands: true,
        ..RIGHT
    };
    let heard = |way, turn| Wrong {
        heard: [way, turn],
        ..RIGHT
    };
    let odometry = |way, turn| Wrong {
        odometry: [way, turn],
        ..RIGHT
    };
    let laser = |quarters: f32| Wrong {
        laser_rad: quarters * core::f32::consts::FRAC_PI_2,
        ..RIGHT
    };
    for (wrong, mistake) in [
        (mirrored, Mistake::ScanMirrored),
        (odometry(1.0, -1.0), Mistake::YawReversed),
        (heard(1.0, -1.0), Mistake::TurnsReversed),
        (heard(-1.0, 1.0), Mistake::DriveReversed),
        (odometry(-1.0, 1.0), Mistake::WayReversed),
        (laser(1.0), Mistake::LaserTurnedLeft),
        (laser(-1.0), Mistake::LaserTurnedRight),
        (laser(2.0), Mistake::LaserTurnedBack),
        (odometry(2.0, 1.0), Mistake::WayTooLong),
        (odometry(0.5, 1.0), Mistake::WayTooShort),
        (odometry(0.001, 1.0), Mistake::WayTooShort),
        (odometry(1000.0, 1.0), Mistake::WayTooLong),
        (odometry(1.0, 2.0), Mistake::TurnTooGreat),
        (odometry(1.0, 0.5), Mistake::TurnTooSmall),
        (odometry(1.0, 0.0), Mistake::TurnTooSmall),
        (standing, Mistake::ScanStands),
    ] {
        assert_is_told_soon(wrong, mistake);
    }
}

/// Asserts that a first drive tells the mistake within two legs of the way, or of the turn.
fn assert_is_told_soon(wrong: Wrong, mistake: Mistake) {
    let mut robot = Robot::new(ROOM, wrong);
    assert_eq!(robot.first_drive(), Some(mistake));
    // Two legs by odometry; one that counts half has gone twice as far.
    assert!(robot.way_m <= 1.2, "{mistake}: {} m", robot.way_m);
    // The way is checked after a turn to and fro, of 193 degrees in all.
    let turned = if robot.way_m > 0.0 {
        robot.turn_rad - 3.36
    } else {
        robot.turn_rad
    };
    // Odometry that counts half has turned twice as far; one that counts nothing takes four
    // legs of the command.
    let most_rad = if (0.0..1.0).contains(&wrong.odometry[1]) {
        2.8
    } else {
        1.6
    };
    assert!(turned <= most_rad, "{mistake}: {turned} rad");
}

#[test]
fn a_clock_that_stands_or_runs_is_told_and_one_that_is_late_is_not() {
    for (clock, told) in [
        (0, Some(Mistake::ClockStands)),
        (1000, Some(Mistake::ClockFast)),
        (3, None),
    ] {
        let mut robot = Robot::new(ROOM, Wrong { clock, ..RIGHT });
        assert_eq!(robot.drive(0.0, 0.0, 30), told);
    }
}

#[test]
fn ranges_of_metres_that_are_taken_for_millimetres_are_told_at_once() {
    let mut robot = Robot::new(ROOM, RIGHT);
    let ranges: Vec<u16> = robot.scan().iter().map(|mm| mm / 1000).collect();
    let input = Input {
        time_ms: 0,
        pose: Pose::default(),
        velocity: Twist::default(),
        scans: [&ranges, &[]],
    };
    let told = robot.check.watch(&robot.config, &input, (0, 0), false);
    assert_eq!(told, Some(Mistake::RangesTooShort));
}

/// Along a corridor no scan tells how far the robot drove, and whether ahead or back.
#[test]
fn what_the_surroundings_do_not_decide_is_not_told() {
    for odometry in [[1.0, 1.0], [2.0, 1.0], [0.5, 1.0]] {
        let mut robot = Robot::new(CORRIDOR, Wrong { odometry, ..RIGHT });
        for _ in 0..8 {
            assert_eq!(robot.drive(0.4, 0.0, 40), None);
        }
        assert!(!robot.check.is_over, "the turn was not checked");
    }
}

/// A robot that is held, or whose motors are off, does nothing that contradicts its odometry.
#[test]
fn a_robot_that_is_held_is_not_accused() {
    let held = Wrong {
        heard: [0.0; 2],
        ..RIGHT
    };
    assert_eq!(Robot::new(ROOM, held).first_drive(), None);
}

#[test]
fn one_restart_of_the_odometry_is_no_mistake() {
    let mut robot = Robot::new(ROOM, RIGHT);
    assert_eq!(robot.drive(0.4, 0.0, 5), None);
    robot.odometry = Pose::default();
    assert_eq!(robot.first_drive(), None);
}

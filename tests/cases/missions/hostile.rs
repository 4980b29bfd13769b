//! No well-formed request, however absurd, makes the device panic, fall silent, or drive too fast.
//!
//! `protocol/tests/hostile.rs` attacks the bytes. Here every frame is well-formed and its content
//! is absurd: robots that jump, clocks that run backwards, ranges at random, sessions of every
//! shape, requests in any order. The device may answer with a refusal or a command. Overflow checks
//! and debug assertions are on in this profile.

use fieldline_protocol::message::{
    Command, Control, Hull, Laser, LoopLimits, MAX_BEAMS, NO_RETURN_MM, Observation, Order, Pose,
    Scan, Start, Status, Strategy, Twist,
};
use fieldline_tests::random::Random;
use fixed::types::{I4F12, I16F16};
use host_sim::link::loopback::loopback;
use host_sim::link::{Link, LinkError};

/// Most requests of a session.
const MOST_REQUESTS: u64 = 400;

/// A host that sends well-formed messages with absurd content.
struct AbsurdHost {
    random: Random,
    start: Start,
    time_ms: u32,
    pose: Pose,
}

impl AbsurdHost {
    fn new(seed: u64) -> Self {
        Self {
            random: Random::new(seed),
            start: Start::default(),
            time_ms: 0,
            pose: Pose::default(),
        }
    }

    fn wide(&mut self) -> I16F16 {
        I16F16::from_bits(self.random.bits() as i32)
    }

    fn narrow(&mut self) -> I4F12 {
        I4F12::from_bits(self.random.bits() as i16)
    }

    /// Draws an angle within half a turn; rarely, any number.
    fn angle(&mut self) -> I16F16 {
        if self.random.once_in(50) {
            return self.wide();
        }
        I16F16::from_bits(self.random.between(-205_887, 205_887) as i32)
    }

    /// Draws a step within 15 cm; rarely, any number.
    fn stride(&mut self) -> I16F16 {
        if self.random.once_in(200) {
            return self.wide();
        }
        I16F16::from_bits(self.random.between(-10_000, 10_000) as i32)
    }

    fn laser(&mut self, level: bool) -> Laser {
        let beams = 1 + self.random.below(MAX_BEAMS as u64) as u16;
        let step = I16F16::from_num(self.random.between(1, 6283)) / 1000 / i32::from(beams);
        let mut laser = Laser {
            x: I4F12::from_bits(self.random.between(-8192, 8192) as i16),
            y: I4F12::from_bits(self.random.between(-8192, 8192) as i16),
            z: I4F12::from_bits(self.random.between(1, 8192) as i16),
            pitch: I4F12::from_bits(self.random.between(0, if level { 200 } else { 6400 }) as i16),
            first_bearing: self.angle(),
            bearing_step: step.max(I16F16::DELTA),
            beams,
            range_limit_mm: 1 + self.random.below(u64::from(NO_RETURN_MM) - 1) as u16,
        };
        if self.random.once_in(40) {
            laser.pitch = self.narrow();
            laser.z = self.narrow();
            laser.bearing_step = self.wide();
            laser.beams = self.random.bits() as u16;
            laser.range_limit_mm = self.random.bits() as u16;
        }
        laser
    }

    fn hull(&mut self) -> Hull {
        let mut side = || self.random.between(1, 1200) as u16;
        Hull {
            length_mm: side(),
            width_mm: side(),
            height_mm: side(),
        }
    }

    fn loops(&mut self) -> LoopLimits {
        let mut length = || self.wide().max(I16F16::ZERO);
        LoopLimits {
            least: length(),
            most: length(),
            most_per_frontier: length(),
            detour: length(),
            slack: length(),
        }
    }

    fn order(&mut self) -> Order {
        if self.random.once_in(2) {
            Order::Nearest
        } else {
            Order::Gain {
                worth: self.narrow().min(I4F12::ONE),
            }
        }
    }

    fn session(&mut self) -> Start {
        let count = if self.random.once_in(30) {
            0
        } else {
            1 + self.random.below(2)
        };
        let mut start = Start {
            strategy: Strategy::Frontier,
            lasers: (0..count).map(|k| self.laser(k == 0)).collect(),
            hull: self.hull(),
            robot_radius_mm: self.random.between(50, 600) as u16,
            max_linear: self.narrow().max(I4F12::DELTA),
            max_angular: self.narrow().max(I4F12::DELTA),
            linear_accel: I4F12::MAX,
            angular_accel: I4F12::MAX,
            period_ms: self.random.between(100, 400) as u16,
            uneven_ground: None,
            loops: self.loops(),
            order: self.order(),
            team: None,
            localise: count == 1,
            survey: false,
        };
        for (speed, accel) in [
            (start.max_linear, &mut start.linear_accel),
            (start.max_angular, &mut start.angular_accel),
        ] {
            let least = i64::from(speed.to_bits()) / 3 + 1;
            *accel = I4F12::from_bits(self.random.between(least, i64::from(i16::MAX)) as i16);
        }
        if self.random.once_in(30) {
            start.robot_radius_mm = self.random.bits() as u16;
            start.max_linear = self.narrow();
        }
        start
    }

    /// Draws ranges that wander, with gaps and random values.
    fn scan(&mut self, beams: u16) -> Scan {
        let mut range = self.random.between(50, 12_000);
        let mut draw = |_| {
            range = (range + self.random.between(-300, 300)).clamp(1, 16_000);
            match self.random.below(12) {
                0 => NO_RETURN_MM,
                1 => self.random.bits() as u16,
                _ => range as u16,
            }
        };
        Scan {
            ranges_mm: (0..usize::from(beams).min(MAX_BEAMS))
                .map(&mut draw)
                .collect(),
        }
    }

    fn observation(&mut self) -> Observation {
        let late = if self.random.once_in(40) {
            self.random.bits() as u32
        } else {
            200
        };
        self.time_ms = self.time_ms.wrapping_add(late);
        self.pose.x = self.pose.x.wrapping_add(self.stride());
        self.pose.y = self.pose.y.wrapping_add(self.stride());
        self.pose.yaw = self.angle();
        if self.random.once_in(20) {
            (self.pose.z, self.pose.roll, self.pose.pitch) =
                (self.wide(), self.angle(), self.angle());
        }
        let beams: Vec<u16> = self.start.lasers.iter().map(|laser| laser.beams).collect();
        let scans = beams.into_iter().map(|beams| {
            let wrong = self.random.once_in(60);
            self.scan(if wrong { beams / 2 } else { beams })
        });
        Observation {
            scans: scans.collect(),
            time_ms: self.time_ms,
            pose: self.pose,
            velocity: Twist {
                linear: I4F12::from_bits(self.random.bits() as i16),
                angular: I4F12::from_bits(self.random.bits() as i16),
            },
        }
    }

    /// Makes one request. An answer or a refusal is fine.
    fn ask(&mut self, link: &mut dyn Link) -> Result<(), LinkError> {
        let (x, y) = (self.random.bits() as i16, self.random.bits() as i16);
        match self.random.below(60) {
            0 => {
                let start = self.session();
                link.control(&Control::Start(start.clone()))?;
                self.start = start;
            }
            1 => drop(link.control(&Control::Pause)?),
            2..5 => drop(link.control(&Control::Resume)?),
            5 if self.random.once_in(10) => drop(link.control(&Control::Stop)?),
            6..9 => drop(link.tile(x % 12, y % 12)?),
            9 => drop(link.tile(x, y)?),
            10 => drop(link.field_row(x as u8 % 64)?),
            11 => drop(link.field_row(x as u8)?),
            12 => drop(link.frontiers()?),
            13 => drop(link.hello()?),
            _ => {
                let observation = self.observation();
                self.check(&link.observe(&observation)?);
            }
        }
        Ok(())
    }

    /// Asserts that a command keeps to the session's limits, and is 0 unless the device explores.
    fn check(&self, command: &Command) {
        let Twist { linear, angular } = command.velocity;
        let (most_linear, most_angular) = (self.start.max_linear, self.start.max_angular);
        assert!(
            (-most_linear..=most_linear).contains(&linear),
            "{command:?}"
        );
        assert!(
            (-most_angular..=most_angular).contains(&angular),
            "{command:?}"
        );
        if command.status != Status::Exploring {
            assert_eq!(command.velocity, Twist::default(), "{command:?}");
        }
    }
}

/// Runs sessions with a seed each.
pub(crate) fn check(sessions: u64) {
    let (mut explored, mut refused) = (0, 0);
    for seed in 0..sessions {
        let (mut host, mut link) = (AbsurdHost::new(seed), loopback());
        host.start = host.session();
        let begun = link.control(&Control::Start(host.start.clone()));
        explored += u64::from(begun.is_ok());
        for request in 0..host.random.below(MOST_REQUESTS) {
            match host.ask(&mut link) {
                Ok(()) => {}
                Err(LinkError::Refused(_)) => refused += 1,
                Err(error) => panic!("seed {seed}, request {request}: {error}"),
            }
        }
        assert!(
            link.hello().is_ok(),
            "seed {seed}: the device must still answer"
        );
    }
    assert!(
        explored * 2 > sessions,
        "more than half of the sessions must begin: {explored}"
    );
    assert!(
        refused > sessions,
        "more requests than sessions must be refused: {refused}"
    );
}

#[test]
fn an_absurd_host_gets_answers_and_the_robot_stays_slow() {
    check(60);
}

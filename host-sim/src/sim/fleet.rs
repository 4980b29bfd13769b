//! Several robots in one world: they see each other and can hit each other.
//!
//! Time passes for all at once: in each substep one robot after another moves, in the order of
//! their numbers, past the others where they then are. A robot that would overlap another stops,
//! as at a wall. A *meeting* is a pair of robots that touch. It counts once, and ends when they
//! are [`CONTACT_OVER_M`] apart. It is no collision with the world, and is counted apart. A fleet
//! of one robot is that robot alone, bit for bit.

use std::collections::BTreeSet;
use thiserror::Error;

use fieldline_protocol::message::{Observation, Twist};

use super::motion::CONTACT_OVER_M;
use super::{SimConfig, Simulator};
use crate::robot::{FARTHEST_M, OtherRobot};
use crate::world::{World, WorldError};

/// Why robots cannot stand in a world together.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum FleetError {
    /// One of them cannot stand at its start.
    #[error("robot {robot}: {error}")]
    Start {
        /// The robot's number, from 0.
        robot: usize,
        /// Why.
        error: WorldError,
    },
    /// Two of them overlap at their starts.
    #[error(
        "robots {} and {} overlap at their starts; choose starts farther apart",
        robots[0], robots[1]
    )]
    Overlap {
        /// The robots' numbers, from 0.
        robots: [usize; 2],
    },
}

/// Robots in one world.
#[derive(Clone, Debug)]
pub struct Fleet<'w> {
    robots: Vec<Simulator<'w>>,
    /// Pairs that touch, the lesser number first.
    touching: BTreeSet<[usize; 2]>,
    /// Meetings of each robot.
    contacts: Vec<u32>,
    meetings: u32,
    min_gap_m: f64,
}

impl<'w> Fleet<'w> {
    /// Puts robots at their starts.
    ///
    /// # Errors
    /// [`FleetError`] if one cannot stand at its start or two overlap there.
    pub fn new(world: &'w World, configs: &[SimConfig]) -> Result<Self, FleetError> {
        let placed = (0..).zip(configs).map(|(robot, config)| {
            Simulator::new(world, config.clone())
                .map_err(|error| FleetError::Start { robot, error })
        });
        let robots: Vec<Simulator<'w>> = placed.collect::<Result<_, _>>()?;
        let mut fleet = Self {
            contacts: vec![0; robots.len()],
            robots,
            touching: BTreeSet::new(),
            meetings: 0,
            min_gap_m: FARTHEST_M,
        };
        if let Some(robots) = fleet.pairs().find(|pair| fleet.gap_m(*pair) == 0.0) {
            return Err(FleetError::Overlap { robots });
        }
        fleet.part();
        for robot in 0..fleet.len() {
            fleet.look_around(robot);
        }
        Ok(fleet)
    }

    /// Number of robots.
    #[must_use]
    pub fn len(&self) -> usize {
        self.robots.len()
    }

    /// Returns true if there are no robots.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.robots.is_empty()
    }

    /// The robots, in the order of their numbers.
    #[must_use]
    pub fn robots(&self) -> &[Simulator<'w>] {
        &self.robots
    }

    /// Measures an observation by a robot. Every call draws new noise.
    pub fn observe(&mut self, robot: usize) -> Observation {
        self.look_around(robot);
        self.robots[robot].observe()
    }

    /// Drives all robots for one period; the commands are in the order of their numbers. `None`
    /// means that no command came.
    pub fn drive(&mut self, commands: &[Option<Twist>]) {
        let told = commands.iter().copied().chain(core::iter::repeat(None));
        for (robot, command) in self.robots.iter_mut().zip(told) {
            robot.begin_period(command);
        }
        let Some(first) = self.robots.first() else {
            return;
        };
        let (period_ms, substep_ms) = (first.config.period_ms, first.config.substep_ms);
        let mut passed_ms = 0;
        while passed_ms < period_ms {
            let step_ms = substep_ms.clamp(1, period_ms - passed_ms);
            for robot in 0..self.len() {
                self.look_around(robot);
                self.robots[robot].advance(step_ms);
                self.count_contact(robot);
            }
            self.part();
            passed_ms += step_ms;
        }
        for robot in &mut self.robots {
            robot.end_period();
        }
    }

    /// Meetings so far: pairs of robots that began to touch.
    #[must_use]
    pub fn meetings(&self) -> u32 {
        self.meetings
    }

    /// Meetings of one robot so far.
    #[must_use]
    pub fn contacts(&self, robot: usize) -> u32 {
        self.contacts.get(robot).copied().unwrap_or(0)
    }

    /// Least distance between two robots so far, metres: 0 after a meeting, at most
    /// [`FARTHEST_M`].
    #[must_use]
    pub fn min_gap_m(&self) -> f64 {
        self.min_gap_m
    }

    /// Tells a robot where the others are.
    fn look_around(&mut self, robot: usize) {
        let others = (0..self.len()).filter(|other| *other != robot);
        let others: Vec<OtherRobot> = others.map(|other| self.body(other)).collect();
        self.robots[robot].others = others;
    }

    fn body(&self, robot: usize) -> OtherRobot {
        let simulator = &self.robots[robot];
        OtherRobot::new(simulator.config.footprint, simulator.pose)
    }

    /// Counts a contact if another robot stopped this one in the last substep.
    fn count_contact(&mut self, robot: usize) {
        let Some(bumped) = self.robots[robot].bumped else {
            return;
        };
        // A robot's list of the others leaves out the robot itself.
        let other = bumped + usize::from(bumped >= robot);
        self.min_gap_m = 0.0;
        if self.touching.insert([robot.min(other), robot.max(other)]) {
            self.meetings += 1;
            for number in [robot, other] {
                self.contacts[number] += 1;
            }
        }
    }

    /// Ends the contacts of robots that are apart, and measures the least gap.
    fn part(&mut self) {
        for pair in self.pairs() {
            let gap_m = self.gap_m(pair);
            self.min_gap_m = self.min_gap_m.min(gap_m);
            if gap_m >= CONTACT_OVER_M {
                self.touching.remove(&pair);
            }
        }
    }

    fn gap_m(&self, [a, b]: [usize; 2]) -> f64 {
        let simulator = &self.robots[a];
        let footprint = &simulator.config.footprint;
        footprint.gap_m(&simulator.pose, &self.body(b))
    }

    /// All pairs of robots, the lesser number first.
    fn pairs(&self) -> impl Iterator<Item = [usize; 2]> + use<> {
        let count = self.len();
        (0..count).flat_map(move |a| (a + 1..count).map(move |b| [a, b]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::Velocity;
    use crate::world::Start;

    fn forwards(linear_mps: f64) -> Option<Twist> {
        let velocity = Velocity {
            linear_mps,
            angular_radps: 0.0,
        };
        Some(velocity.to_wire())
    }

    /// A corridor of 8 × 2 m.
    fn corridor() -> World {
        World::picture("corridor", 0.5, &["................"; 4])
    }

    fn at(x_m: f64, yaw_rad: f64) -> SimConfig {
        SimConfig {
            place: Some(Start {
                x_m,
                y_m: 1.0,
                yaw_rad,
            }),
            ..SimConfig::default()
        }
    }

    #[test]
    fn a_fleet_of_one_is_the_robot_alone_bit_for_bit() {
        let world = World::builtin("office").expect("built in");
        let config = SimConfig::default();
        let mut alone = Simulator::new(&world, config.clone()).expect("fits");
        let mut fleet = Fleet::new(&world, &[config]).expect("fits");
        for step in 0..60 {
            assert_eq!(fleet.observe(0), alone.observe());
            let command = forwards(if step % 7 < 5 { 0.6 } else { -0.2 });
            alone.drive(command);
            fleet.drive(&[command]);
            assert_eq!(fleet.robots()[0].pose(), alone.pose());
        }
        assert_eq!((fleet.meetings(), fleet.min_gap_m()), (0, FARTHEST_M));
    }

    #[test]
    fn robots_that_drive_into_each_other_stop_and_count_once_and_hit_no_wall() {
        let world = corridor();
        let pi = core::f64::consts::PI;
        let mut fleet = Fleet::new(&world, &[at(1.0, 0.0), at(7.0, pi)]).expect("fits");
        for _ in 0..100 {
            fleet.drive(&[forwards(0.5), forwards(0.5)]);
        }
        assert_eq!((fleet.meetings(), fleet.min_gap_m()), (1, 0.0));
        assert_eq!((fleet.contacts(0), fleet.contacts(1)), (1, 1));
        let collisions = fleet.robots().iter().map(|robot| robot.safety().collisions);
        assert_eq!(collisions.sum::<u32>(), 0);
        let apart_m = fleet.robots()[1].pose().x_m - fleet.robots()[0].pose().x_m;
        assert!((0.508..0.52).contains(&apart_m), "{apart_m}");
        // They part and meet again.
        for speed in [-0.3, 0.5] {
            for _ in 0..25 {
                fleet.drive(&[forwards(speed), forwards(0.0)]);
            }
        }
        assert_eq!(fleet.meetings(), 2);
    }

    #[test]
    fn both_lasers_see_the_other_robot_where_it_is() {
        let world = corridor();
        let seen = |configs: &[SimConfig]| {
            let mut fleet = Fleet::new(&world, configs).expect("fits");
            let observation = fleet.observe(0);
            [0, 1].map(|laser: usize| f64::from(observation.scans[laser].ranges_mm[90]) / 1000.0)
        };
        let [alone, both] = [seen(&[at(1.0, 0.0)]), seen(&[at(1.0, 0.0), at(2.0, 0.0)])];
        // The lasers are 0.10 and 0.15 m ahead; the tilted one looks 20° down.
        let level_m = 1.0 - 0.254 - 0.10;
        let tilted_m = (1.0 - 0.254 - 0.15) / 20.0_f64.to_radians().cos();
        assert!((both[0] - level_m).abs() < 0.05, "{both:?}");
        assert!((both[1] - tilted_m).abs() < 0.05, "{both:?}");
        assert!(alone[0] > 6.0 && alone[1] > 1.2, "{alone:?}");
    }

    #[test]
    fn starts_that_overlap_are_refused() {
        let world = corridor();
        let error = Fleet::new(&world, &[at(1.0, 0.0), at(4.0, 0.0), at(4.4, 0.0)]);
        let error = error.expect_err("they overlap");
        assert_eq!(error, FleetError::Overlap { robots: [1, 2] });
        let error = Fleet::new(&world, &[at(1.0, 0.0), at(9.0, 0.0)]).expect_err("outside");
        assert!(error.to_string().starts_with("robot 1: "), "{error}");
    }
}

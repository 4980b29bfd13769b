//! The robots of other processes, where their beacons say.
//!
//! Each process simulates its own robot. So that robots of several processes see each other and can
//! hit each other, every process puts the others into its world: a hull at the pose of its last
//! beacon. The others do not move during a period, and stand where they were last heard of, as a
//! robot does whose computer failed. On lossless links a pose is a period old at most. Metres.

use core::fmt::Debug;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use fieldline_protocol::message::{Beacon, Body, Observation, Packet, Twist};

use crate::report::tum::Stamped;
use crate::robot::{Footprint, Pose};
use crate::sim::{Loss, Simulator};
use crate::trial;

#[derive(Debug, Default)]
struct Known {
    hulls: BTreeMap<u8, (Footprint, Pose)>,
    contacts: u32,
}

/// What is known of the robots of other processes. Clones know the same.
#[derive(Clone, Debug, Default)]
pub struct Neighbours(Arc<Mutex<Known>>);

impl Neighbours {
    /// Takes a packet: a beacon tells where its robot is.
    pub fn note(&self, packet: &Packet) {
        if let Body::Beacon(beacon) = &packet.body {
            self.known().hulls.insert(packet.from.id, hull_of(beacon));
        }
    }

    /// Returns how often the robot began to touch another one.
    #[must_use]
    pub fn contacts(&self) -> u32 {
        self.known().contacts
    }

    fn known(&self) -> MutexGuard<'_, Known> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn hull_of(beacon: &Beacon) -> (Footprint, Pose) {
    let metres = |cm: i16| f64::from(cm) / 100.0;
    let footprint = Footprint {
        half_length_m: metres(beacon.half_length_cm.into()),
        half_width_m: metres(beacon.half_width_cm.into()),
        ..Footprint::PIONEER_3AT
    };
    let pose = Pose {
        x_m: metres(beacon.x_cm),
        y_m: metres(beacon.y_cm),
        yaw_rad: beacon.yaw.to_num(),
        ..Pose::default()
    };
    (footprint, pose)
}

/// A simulated robot among the robots of other processes.
#[derive(Debug)]
pub struct Guest<'a, 'w> {
    simulator: &'a mut Simulator<'w>,
    neighbours: &'a Neighbours,
    touches: bool,
}

impl<'a, 'w> Guest<'a, 'w> {
    /// Puts a robot among others.
    #[must_use]
    pub const fn new(simulator: &'a mut Simulator<'w>, neighbours: &'a Neighbours) -> Self {
        Self {
            simulator,
            neighbours,
            touches: false,
        }
    }

    fn look_around(&mut self) {
        let hulls = self.neighbours.known().hulls.values().copied().collect();
        self.simulator.stand_among(hulls);
    }
}

impl trial::Body for Guest<'_, '_> {
    fn period_ms(&self) -> u32 {
        trial::Body::period_ms(self.simulator)
    }

    fn observe(&mut self) -> Observation {
        self.look_around();
        self.simulator.observe()
    }

    fn drive(&mut self, velocity: Option<Twist>) {
        self.look_around();
        self.simulator.drive(velocity);
        let touches = self.simulator.is_held_by_robot();
        self.neighbours.known().contacts += u32::from(touches && !self.touches);
        self.touches = touches;
    }

    fn truth(&self) -> Stamped {
        trial::Body::truth(self.simulator)
    }

    fn loss(&self) -> Option<Loss> {
        self.simulator.loss()
    }
}

#[cfg(test)]
mod tests {
    use fieldline_protocol::message::Member;

    use super::*;
    use crate::robot::Velocity;
    use crate::sim::SimConfig;
    use crate::trial::Body as _;
    use crate::world::{Start, World};

    fn beacon(x_cm: i16) -> Packet {
        Packet {
            from: Member { id: 3, boot: 1 },
            sequence: 0,
            body: Body::Beacon(Beacon {
                x_cm,
                y_cm: 100,
                half_length_cm: 26,
                half_width_cm: 25,
                ..Beacon::default()
            }),
        }
    }

    #[test]
    fn a_neighbour_is_seen_and_held_against_where_its_beacon_says() {
        let world = World::picture("corridor", 0.5, &["................"; 4]);
        let start = Start {
            x_m: 1.0,
            y_m: 1.0,
            yaw_rad: 0.0,
        };
        let config = SimConfig {
            place: Some(start),
            ..SimConfig::default()
        };
        let mut simulator = Simulator::new(&world, config).expect("fits");
        let neighbours = Neighbours::default();
        let mut guest = Guest::new(&mut simulator, &neighbours);
        let ahead_m =
            |guest: &mut Guest<'_, '_>| f64::from(guest.observe().scans[0].ranges_mm[90]) / 1000.0;
        assert!(ahead_m(&mut guest) > 6.0, "nobody is there");
        neighbours.note(&beacon(300));
        let seen_m = ahead_m(&mut guest);
        assert!((seen_m - (3.0 - 0.26 - 1.1)).abs() < 0.05, "{seen_m}");
        let forwards = Velocity {
            linear_mps: 0.5,
            angular_radps: 0.0,
        };
        for _ in 0..40 {
            guest.drive(Some(forwards.to_wire()));
        }
        let front_m = guest.simulator.pose().x_m + 0.254;
        assert!((2.70..2.74).contains(&front_m), "{front_m}");
        assert_eq!(neighbours.contacts(), 1);
        // It drives away; a later beacon counts, not an earlier one of the same robot.
        neighbours.note(&beacon(700));
        for _ in 0..10 {
            guest.drive(Some(forwards.to_wire()));
        }
        assert!(guest.simulator.pose().x_m > 3.0);
        assert_eq!(neighbours.contacts(), 1);
    }
}

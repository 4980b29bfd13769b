//! The simulated radio of a team: it carries bytes from one robot to all that can hear it.
//!
//! A packet is *out of reach* of a hearer if the hearer is too far away, behind walls, or in
//! another partition. Within reach it may be lost, late, doubled or out of order. What becomes of a
//! packet is decided for each hearer on its own when it is sent, by a fixed number of draws of one
//! seeded stream: so a change of one probability does not shift the others. Metres, milliseconds.

mod spec;

use serde::{Deserialize, Serialize};

use crate::robot::{Noise, Source, distance_m};
use crate::world::{GridTraversal, World};
pub use spec::{HELD_MS, MOST_ROBOTS, Partition, RadioSpec, Walls};

/// What the radio did, in packets; as in a report.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Traffic {
    /// Bytes that all robots sent: the lengths of the packets in the air.
    pub sent_bytes: u64,
    /// Packets that all robots sent, each once, whatever the number of hearers.
    pub sent: u64,
    /// Packets that a hearer heard; second copies count.
    pub heard: u64,
    /// Packets that a hearer within reach lost.
    pub lost: u64,
    /// Packets that a hearer could not hear: too far, behind walls, in another partition, or away.
    pub out_of_reach: u64,
}

/// A robot on the air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Station {
    /// Where it is, metres.
    pub at_m: [f64; 2],
    /// False if it left the team: it hears nothing.
    pub listens: bool,
}

/// A packet on its way.
#[derive(Clone, Debug)]
struct OnAir {
    due_ms: u32,
    to: usize,
    bytes: Vec<u8>,
}

/// The radio.
#[derive(Clone, Debug)]
pub struct Radio<'w> {
    world: &'w World,
    spec: RadioSpec,
    noise: Noise,
    on_air: Vec<OnAir>,
    traffic: Traffic,
}

impl<'w> Radio<'w> {
    /// A radio in a world.
    #[must_use]
    pub fn new(world: &'w World, spec: RadioSpec, seed: u64) -> Self {
        Self {
            world,
            spec,
            noise: Noise::new(seed, Source::Radio),
            on_air: Vec::new(),
            traffic: Traffic::default(),
        }
    }

    /// Sends a packet from one of the stations to all others.
    pub fn send(&mut self, time_ms: u32, from: usize, bytes: &[u8], stations: &[Station]) {
        self.traffic.sent += 1;
        self.traffic.sent_bytes += bytes.len() as u64;
        for to in (0..stations.len()).filter(|to| *to != from) {
            let draws = [(); 5].map(|()| self.noise.uniform());
            if !stations[to].listens || !self.reaches(time_ms, [from, to], stations) {
                self.traffic.out_of_reach += 1;
            } else if draws[0] < self.spec.loss {
                self.traffic.lost += 1;
            } else {
                let copies = 1 + usize::from(draws[1] < self.spec.duplicate);
                for late in &draws[2..2 + copies] {
                    let held = u32::from(draws[4] < self.spec.reorder) * HELD_MS;
                    let delay_ms = (late * f64::from(self.spec.delay_ms)) as u32 + held;
                    self.on_air.push(OnAir {
                        due_ms: time_ms + delay_ms,
                        to,
                        bytes: bytes.to_vec(),
                    });
                }
            }
        }
    }

    /// Returns the packets that a station hears until a time, in the order of their arrival. One
    /// that does not listen then loses them.
    pub fn hear(&mut self, time_ms: u32, to: usize, listens: bool) -> Vec<Vec<u8>> {
        let mine = |packet: &mut OnAir| packet.to == to && packet.due_ms <= time_ms;
        let mut due: Vec<OnAir> = self.on_air.extract_if(.., mine).collect();
        // Stable: packets that are due together arrive as they were sent.
        due.sort_by_key(|packet| packet.due_ms);
        if !listens {
            self.traffic.out_of_reach += due.len() as u64;
            return Vec::new();
        }
        self.traffic.heard += due.len() as u64;
        due.into_iter().map(|packet| packet.bytes).collect()
    }

    /// What the radio did so far.
    #[must_use]
    pub const fn traffic(&self) -> Traffic {
        self.traffic
    }

    /// The specification.
    #[must_use]
    pub const fn spec(&self) -> &RadioSpec {
        &self.spec
    }

    fn reaches(&self, time_ms: u32, pair: [usize; 2], stations: &[Station]) -> bool {
        let mut partitions = self.spec.partitions.iter();
        if !self.spec.on || partitions.any(|it| it.parts(time_ms, pair, stations.len())) {
            return false;
        }
        let [from_m, to_m] = pair.map(|robot| stations[robot].at_m);
        let apart_m = distance_m(from_m, to_m);
        let walls_m = match self.spec.walls {
            Walls::Metres(metres) if metres > 0.0 => {
                metres * f64::from(walls_between(self.world, from_m, to_m))
            }
            Walls::Metres(_) => 0.0,
            Walls::Block if walls_between(self.world, from_m, to_m) > 0 => return false,
            Walls::Block => 0.0,
        };
        apart_m + walls_m <= self.spec.range_m
    }
}

/// Number of walls on the line between two points: how often it enters solid cells.
fn walls_between(world: &World, from_m: [f64; 2], to_m: [f64; 2]) -> u32 {
    let grid = world.occupancy();
    let (origin_m, cell_m) = (grid.origin_m(), grid.resolution_m());
    let start = [0, 1].map(|k| (from_m[k] - origin_m[k]) / cell_m);
    // The line's parameter goes from 0 to 1.
    let speed = [0, 1].map(|k| (to_m[k] - from_m[k]) / cell_m);
    let mut traversal = GridTraversal::new(start, speed);
    let (mut walls, mut in_wall) = (0, false);
    while traversal.entered_m <= 1.0 {
        let [i, j] = traversal.cell;
        let solid = grid.is_solid(crate::world::GridCell { i, j });
        walls += u32::from(solid && !in_wall);
        in_wall = solid;
        if traversal.left_m() > 1.0 {
            break;
        }
        traversal.advance();
    }
    walls
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two rooms with a wall from x = 4 to 4.5 m.
    fn rooms() -> World {
        World::picture("rooms", 0.5, &["........#......."; 4])
    }

    fn stations(xs: &[f64]) -> Vec<Station> {
        let at = |x: &f64| Station {
            at_m: [*x, 1.0],
            listens: true,
        };
        xs.iter().map(at).collect()
    }

    fn heard(world: &World, spec: &str, xs: &[f64], packets: u32) -> (Vec<Vec<Vec<u8>>>, Traffic) {
        let mut radio = Radio::new(world, spec.parse().expect("valid"), 3);
        for k in 0..packets {
            radio.send(200 * k, 0, &k.to_le_bytes(), &stations(xs));
        }
        let all = (0..xs.len()).map(|to| radio.hear(1_000_000, to, true));
        (all.collect(), radio.traffic())
    }

    #[test]
    fn range_and_walls_decide_who_hears() {
        let world = rooms();
        let count = |spec: &str, x: f64| heard(&world, spec, &[1.0, x], 1).0[1].len();
        assert_eq!((count("range=2", 3.0), count("range=2", 3.01)), (1, 0));
        assert_eq!(
            (count("walls=block", 3.9), count("walls=block", 5.0)),
            (1, 0)
        );
        assert_eq!(
            (
                count("range=6,walls=2", 5.0),
                count("range=6,walls=2.1", 5.0)
            ),
            (1, 0)
        );
        assert_eq!((count("off", 1.5), count("loss=0", 5.0)), (0, 1));
        assert_eq!(walls_between(&world, [1.0, 1.0], [1.0, 1.0]), 0);
        assert_eq!(walls_between(&world, [7.0, 1.0], [1.0, 0.2]), 1);
    }

    #[test]
    fn a_perfect_radio_brings_every_packet_once_and_in_order() {
        let (heard, traffic) = heard(&rooms(), "loss=0", &[1.0, 2.0, 3.0], 50);
        let sent: Vec<Vec<u8>> = (0..50_u32).map(|k| k.to_le_bytes().to_vec()).collect();
        assert_eq!(heard, [vec![], sent.clone(), sent]);
        let counted = Traffic {
            sent_bytes: 200,
            sent: 50,
            heard: 100,
            lost: 0,
            out_of_reach: 0,
        };
        assert_eq!(traffic, counted);
    }

    #[test]
    fn loss_doubling_and_order_have_their_rates() {
        let spec = "loss=0.3,duplicate=0.2,reorder=0.25";
        let (heard, traffic) = heard(&rooms(), spec, &[1.0, 2.0], 4_000);
        // Four standard errors.
        let share = |count: u64, of: u64| count as f64 / of as f64;
        assert!(
            (share(traffic.lost, 4_000) - 0.3).abs() < 0.029,
            "{traffic:?}"
        );
        let kept = 4_000 - traffic.lost;
        assert!(
            (share(traffic.heard - kept, kept) - 0.2).abs() < 0.031,
            "{traffic:?}"
        );
        let numbers = heard[1]
            .iter()
            .map(|bytes| u32::from_le_bytes(bytes[..].try_into().unwrap()));
        let numbers: Vec<u32> = numbers.collect();
        let overtaken = numbers.windows(2).filter(|pair| pair[1] < pair[0]).count();
        assert!(overtaken > 300, "{overtaken}");
    }

    #[test]
    fn a_change_of_one_rate_leaves_the_other_draws_as_they_were() {
        let lost = |spec: &str| heard(&rooms(), spec, &[1.0, 2.0], 500).1.lost;
        assert_eq!(
            lost("loss=0.3"),
            lost("loss=0.3,duplicate=0.4,delay=2,reorder=0.3")
        );
    }

    #[test]
    fn late_packets_come_when_they_are_due_and_not_to_one_that_is_away() {
        let world = rooms();
        let mut radio = Radio::new(&world, "delay=1".parse().unwrap(), 7);
        for _ in 0..100 {
            radio.send(0, 0, b"x", &stations(&[1.0, 2.0]));
        }
        let early = radio.hear(500, 1, true).len();
        assert!((30..70).contains(&early), "{early}");
        assert_eq!(radio.hear(1_000, 1, false).len(), 0);
        assert_eq!(radio.hear(2_000, 1, true).len(), 0);
        assert_eq!(radio.traffic().out_of_reach, 100 - early as u64);
    }
}

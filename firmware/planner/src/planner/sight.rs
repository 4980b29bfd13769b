//! Scans in a team: a beam that ends in a peer is no measurement of the map.
//!
//! Such a beam becomes invalid for everything that enters scans, and for the match of the scan with
//! the map. It still says that nothing stands before the peer, so on flat ground it frees the cells
//! up to there. Otherwise two robots that drive towards each other would always have a frontier
//! between them.
//!
//! Units: millimetres of range, metres.

use heapless::Vec;

use crate::config::Config;
use crate::geometry::{MapPose, Pose};
use crate::input::{INVALID_MM, Input, informative_range_mm};
use crate::planner::state::State;
use crate::robot::MAX_BEAMS;
use crate::team::peers::Peers;

/// A beam that ends in a peer frees the cells up to this distance before it, millimetres: two
/// cells.
const BEFORE_PEER_MM: u16 = 200;

/// The ranges of a scan.
pub(super) type Ranges = Vec<u16, { MAX_BEAMS as usize }>;

impl<const TILES: usize, const SLOTS: usize> State<TILES, SLOTS> {
    /// Locates the robot and enters scans and odometry, without the beams that end in a peer as
    /// seen from the pose that odometry tells. Not inlined: its scans lie on the stack only while
    /// the planner senses.
    #[inline(never)]
    pub(super) fn enter_without_peers(
        &mut self,
        config: &Config,
        input: &Input<'_>,
        expected: &Pose,
    ) -> MapPose {
        let mut seen = [const { Ranges::new() }; 2];
        hide_peers(config, self.team.peers(), input, expected, &mut seen);
        let [first, second] = &seen;
        let without_peers = Input {
            scans: [first, second],
            ..*input
        };
        let MapPose(pose) = self.enter(config, &without_peers);
        if !self.ground.is_uneven() && self.localiser.may_enter() {
            self.free_before_peers(config, &Input { pose, ..*input }, &seen);
        }
        MapPose(pose)
    }

    /// Frees the cells before the peers, along the beams of the level lasers that were hidden.
    fn free_before_peers(&mut self, config: &Config, input: &Input<'_>, seen: &[Ranges; 2]) {
        let scans = config.lasers.iter().zip(input.scans.iter().zip(seen));
        for (laser, (scan, seen)) in scans.filter(|(laser, _)| laser.is_level()) {
            for (number, (&range_mm, &seen_mm)) in scan.iter().zip(seen).enumerate() {
                let was_hidden = seen_mm == INVALID_MM && range_mm < laser.range_limit_mm;
                let free_mm = range_mm.checked_sub(BEFORE_PEER_MM);
                let Some(free_mm) = free_mm.filter(|_| was_hidden) else {
                    continue;
                };
                let beam = (number, f32::from(free_mm) * 1e-3);
                let tuning = &config.tuning.map;
                self.map.free_view(tuning, &input.pose, laser, beam);
            }
        }
    }
}

/// Copies the ranges of an input but those of beams that end in a peer.
pub(super) fn hide_peers(
    config: &Config,
    peers: &Peers,
    input: &Input<'_>,
    expected: &Pose,
    seen: &mut [Ranges; 2],
) {
    for ((laser, scan), seen) in config.lasers.iter().zip(input.scans).zip(seen) {
        // A dropout is known by its neighbours, which may be hidden.
        let range = |i| informative_range_mm(scan, i, laser.range_limit_mm);
        let ranges = (0..scan.len()).map(|i| range(i).unwrap_or(INVALID_MM));
        seen.extend(ranges.take(MAX_BEAMS.into()));
        peers.hide(input.time_ms, expected, laser, seen);
    }
}

#[cfg(test)]
mod tests {
    use std::boxed::Box;

    use crate::config::{Config, Member, TeamPlace};
    use crate::geometry::{Cell, MapPose, Point, Pose, Twist};
    use crate::input::{INVALID_MM, Input};
    use crate::map::Class;
    use crate::planner::ground_model::GroundModel;
    use crate::planner::state::State;
    use crate::robot::{LaserMount, RobotShape};
    use crate::team::packet::{Beacon, Body, Packet};

    fn config(localise: bool) -> Config {
        let team = TeamPlace {
            member: Member { id: 0, boot: 0 },
            ..TeamPlace::default()
        };
        let builder = Config::builder(RobotShape::PIONEER_3AT)
            .laser(LaserMount::level(0.10, 0.40))
            .team(team);
        builder.localise(localise).build().expect("valid")
    }

    /// Returns the state of a robot that hears a peer so far ahead.
    fn state_beside_peer(config: &Config, x_m: f32) -> Box<State<20, 64>> {
        let mut state = Box::new(State::<20, 64>::new());
        state.reset(config);
        let place = Pose {
            x_m,
            ..Pose::default()
        };
        let beacon = Beacon {
            half_cm: (26, 25),
            ..Beacon::default()
        };
        let packet = Packet {
            from: Member { id: 1, boot: 0 },
            sequence: 1,
            body: Body::Beacon(beacon.at(&place)),
        };
        state.hear(config, &packet);
        state
    }

    fn input<'a>(time_ms: u32, yaw_rad: f32, ranges_mm: &'a [u16; 181]) -> Input<'a> {
        let pose = Pose {
            yaw_rad,
            ..Pose::default()
        };
        Input {
            time_ms,
            pose,
            velocity: Twist::default(),
            scans: [ranges_mm, &[]],
        }
    }

    /// Walls ahead and at both sides.
    fn room_mm(number: usize) -> u16 {
        let (sin, cos) = (number as f32 - 90.0).to_radians().sin_cos();
        (2_750.0 / cos.max(0.01)).min(2_550.0 / sin.abs().max(0.01)) as u16
    }

    /// Odometry says that the robot turned, and the scan that it did not. Beams end a little before
    /// the wall, where the peer may be, or a little behind it.
    #[test]
    fn a_peer_does_not_move_the_pose() {
        let config = config(true);
        let located = |peer_mm: u16| {
            let mut state = state_beside_peer(&config, 2.3);
            let mut ranges_mm = core::array::from_fn(room_mm);
            for step in 0..3 {
                let input = input(200 * step, 0.0, &ranges_mm);
                state.enter_without_peers(&config, &input, &input.pose);
            }
            ranges_mm[90..95].fill(peer_mm);
            let input = input(600, 0.05, &ranges_mm);
            state.enter_without_peers(&config, &input, &input.pose)
        };
        let MapPose(without) = located(INVALID_MM);
        assert!(without.yaw_rad.abs() < 0.02, "{without:?}");
        assert_eq!(located(2_680), MapPose(without));
        assert_ne!(
            located(2_800),
            MapPose(without),
            "behind the wall is no peer"
        );
    }

    /// The hull of a silent peer grows, and so may hide a wall from the map.
    #[test]
    fn a_wall_that_seems_a_peer_is_no_cell_of_the_map_and_still_an_obstacle_for_the_hull() {
        let config = config(false);
        let mut state = state_beside_peer(&config, 1.6);
        let ranges_mm = [900; 181];
        let input = input(2_000, 0.0, &ranges_mm);
        state.enter_without_peers(&config, &input, &input.pose);
        state.note_surroundings(&config, &input);
        // Ahead, and to the left, where no peer is.
        let is_wall = |x, y| state.map.tiles().class(Cell { x, y }) == Class::Obstacle;
        assert!(!(8..12).any(|x| is_wall(x, 0)));
        assert!((8..12).any(|y| is_wall(1, y)));
        let GroundModel::Flat(points) = &state.ground else {
            panic!("the ground is flat");
        };
        let is_ahead = |point: &&Point| point.x_m > 0.0 && point.y_m.abs() < 0.1;
        let ahead = points.points().iter().find(is_ahead).expect("a point");
        assert!((ahead.x_m - 1.0).abs() < 0.01, "{ahead:?}");
    }
}

//! The hulls of the peers: which places they take. [`super::hidden_beams`] says which beams they
//! stop.
//!
//! - For the drive a peer is points on its outline. A peer that may move takes the circle that it
//!   needs to turn, and the places of that circle up to where it can stop. If both robots keep out
//!   of that place of the other, both can stop.
//!
//! ```text
//! stops in   |v| · age + v² / 2a
//! ```
//!
//! Units: metres, seconds, radians.

use crate::config::Config;
use crate::geometry::{Point, RobotFrame};
use crate::math;
use crate::team::peers::{Peer, Peers};

/// Greatest motion of a peer that its last beacon could not tell, metres: it may accelerate for two
/// periods.
const LATENCY_M: f32 = 0.025;
/// A peer whose place is less well known is no obstacle for the drive, centimetres: it would stand
/// in the way where it is not. The lasers see it where it is.
const MOST_SD_CM: u8 = 15;
/// Peers within this distance are obstacles for the drive, metres.
const NEAR_M: f32 = 4.0;
/// Greatest distance between two points of an outline, metres: less than half of a robot's side.
const POINT_EVERY_M: f32 = 0.15;
/// Greatest number of points on a side of an outline.
const MOST_SIDE_POINTS: u32 = 12;

/// The place that a peer takes: a rectangle in its own frame, or all places of a circle that moves
/// along it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hull {
    frame: RobotFrame,
    pub(super) centre: Point,
    /// Extents ahead of the centre, behind it, and to each side.
    front_m: f32,
    back_m: f32,
    half_width_m: f32,
    /// Its ends are half circles.
    is_round: bool,
}

impl Hull {
    /// Returns a peer's hull, grown on all sides.
    pub(super) fn of(peer: &Peer, now_ms: u32, grown_m: f32) -> Self {
        let pose = peer.pose(now_ms);
        let (length, width) = peer.beacon.half_cm;
        let half = |cm: u8| f32::from(cm) * 0.01 + grown_m;
        Self {
            frame: RobotFrame::of(&pose),
            centre: pose.point(),
            front_m: half(length),
            back_m: half(length),
            half_width_m: half(width),
            is_round: false,
        }
    }

    /// Returns the place that a peer may take by turning on the spot: its hull's circle. A peer
    /// that stands for good does not turn.
    ///
    /// With a square around the circle two robots that start side by side wait for each other
    /// (measured: docs/MEASURED.md, "Place that a peer turns in").
    fn turning(peer: &Peer, now_ms: u32) -> Self {
        let sd_m = f32::from(peer.beacon.sd_cm) * 0.01;
        let hull = Self::of(peer, now_ms, sd_m);
        if !(peer.beacon.activity.moves() && peer.has_claims(now_ms)) {
            return hull;
        }
        let radius_m = hull.radius_m();
        Self {
            front_m: radius_m,
            back_m: radius_m,
            half_width_m: radius_m,
            is_round: true,
            ..hull
        }
    }

    /// Returns the place that a peer takes until it can stand.
    fn swept(peer: &Peer, now_ms: u32, config: &Config) -> Self {
        let mut hull = Self::turning(peer, now_ms);
        let speed_mps = peer.beacon.velocity.linear_mps;
        if peer.beacon.activity.moves() && peer.has_claims(now_ms) {
            hull.front_m += LATENCY_M;
            hull.back_m += LATENCY_M;
            hull.half_width_m += LATENCY_M;
            let braking_m = speed_mps * speed_mps / (2.0 * config.linear_accel_mps2);
            let stops_m = speed_mps.abs() * config.period_s + braking_m;
            if speed_mps > 0.0 {
                hull.front_m += stops_m;
            } else {
                hull.back_m += stops_m;
            }
        }
        hull
    }

    /// Returns true if a point lies inside.
    pub(crate) fn holds(&self, point: Point) -> bool {
        let Point { x_m, y_m } = self.frame.to_robot(point);
        x_m <= self.front_m && x_m >= -self.back_m && y_m.abs() <= self.half_width_m
    }

    /// Returns the radius of a circle around the centre that holds the hull.
    pub(super) fn radius_m(&self) -> f32 {
        let along_m = self.front_m.max(self.back_m);
        math::sqrt(along_m * along_m + self.half_width_m * self.half_width_m)
    }

    /// Returns the place of a point of the rectangle, so far along it and across it. What lies
    /// beyond a round end is moved to its edge.
    #[inline(never)]
    fn place(&self, along_m: f32, across_m: f32) -> Point {
        let (x_m, y_m) = (along_m - self.back_m, across_m - self.half_width_m);
        let radius_m = self.half_width_m;
        let middle_m = x_m.min(self.front_m - radius_m).max(radius_m - self.back_m);
        let beyond_m = math::sqrt((x_m - middle_m) * (x_m - middle_m) + y_m * y_m);
        let part = if self.is_round {
            radius_m / beyond_m.max(radius_m)
        } else {
            1.0
        };
        self.frame.to_map(Point {
            x_m: middle_m + part * (x_m - middle_m),
            y_m: part * y_m,
        })
    }

    /// Returns points on the outline, corners included.
    pub(crate) fn outline(self) -> impl Iterator<Item = Point> {
        let (length_m, width_m) = (self.front_m + self.back_m, 2.0 * self.half_width_m);
        let at = move |along_m, across_m| self.place(along_m, across_m);
        let sides = side(length_m).flat_map(move |k| [at(k, 0.0), at(k, width_m)]);
        let ends = side(width_m).flat_map(move |k| [at(0.0, k), at(length_m, k)]);
        sides.chain(ends)
    }

    /// Returns points all over the hull, a map cell or less apart.
    pub(crate) fn area(self) -> impl Iterator<Item = Point> {
        let across = move |k: f32| side(2.0 * self.half_width_m).map(move |m| self.place(k, m));
        side(self.front_m + self.back_m).flat_map(across)
    }
}

/// Returns places along a side, its ends included.
fn side(length_m: f32) -> impl Iterator<Item = f32> {
    let parts = math::floor(length_m / POINT_EVERY_M) as u32 + 1;
    let parts = parts.min(MOST_SIDE_POINTS);
    (0..=parts).map(move |k| length_m * k as f32 / parts as f32)
}

impl Peers {
    /// Returns the peers whose place is known.
    pub(super) fn placed(&self) -> impl Iterator<Item = &Peer> {
        self.iter().filter(|peer| peer.beacon.sd_cm <= MOST_SD_CM)
    }

    /// Returns the places that the peers near the robot may take by turning, each with its number.
    pub(crate) fn turning(&self, now_ms: u32, robot: Point) -> impl Iterator<Item = (u8, Hull)> {
        self.placed()
            .map(move |peer| (peer.member.id, Hull::turning(peer, now_ms)))
            .filter(move |(_, hull)| hull.centre.distance2(robot) <= NEAR_M * NEAR_M)
    }

    /// Returns the peers near the robot, each with the place that it takes until it can stand.
    pub(crate) fn near(
        &self,
        now_ms: u32,
        robot: Point,
        config: &Config,
    ) -> impl Iterator<Item = (&Peer, Hull)> {
        self.placed()
            .map(move |peer| (peer, Hull::swept(peer, now_ms, config)))
            .filter(move |(_, hull)| hull.centre.distance2(robot) <= NEAR_M * NEAR_M)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use std::vec::Vec;

    use super::*;
    use crate::config::Member;
    use crate::geometry::{Pose, Twist};
    use crate::team::packet::Beacon;

    /// A peer of 0.52 m × 0.50 m.
    pub(crate) fn peers(x_m: f32, y_m: f32, speed_mps: f32) -> Peers {
        peers_known_to(0, x_m, y_m, speed_mps)
    }

    /// The same, with the standard deviation of its place.
    pub(crate) fn peers_known_to(sd_cm: u8, x_m: f32, y_m: f32, speed_mps: f32) -> Peers {
        let beacon = Beacon {
            half_cm: (26, 25),
            sd_cm,
            velocity: Twist {
                linear_mps: speed_mps,
                angular_radps: 0.0,
            },
            ..Beacon::default()
        };
        let beacon = beacon.at(&Pose {
            x_m,
            y_m,
            yaw_rad: math::PI,
            ..Pose::default()
        });
        let mut peers = Peers::new();
        peers.hear(Member { id: 2, boot: 0 }, 0, &beacon, 0);
        peers
    }

    #[test]
    fn a_moving_peer_takes_the_place_up_to_where_it_stops() {
        let config = Config::pioneer_3at(heapless::Vec::new());
        let outline = |speed_mps| -> (f32, f32) {
            let peers = peers(2.0, 0.0, speed_mps);
            let (_, hull) = peers
                .near(0, Point::default(), &config)
                .next()
                .expect("near");
            let ends = hull.outline().map(|point| point.x_m);
            ends.fold((9.0, -9.0), |(least, most), x| (x.min(least), x.max(most)))
        };
        let close = |(least, most): (f32, f32), expected: (f32, f32)| {
            (least - expected.0).abs() < 1e-3 && (most - expected.1).abs() < 1e-3
        };
        // Half of its diagonal, and what it may do unseen.
        let half = 0.360_7 + LATENCY_M;
        assert!(close(outline(0.0), (2.0 - half, 2.0 + half)));
        // It looks west: 0.6 · 0.2 + 0.36 / 0.6.
        assert!(close(outline(0.6), (2.0 - half - 0.72, 2.0 + half)));
        assert!(close(outline(-0.6), (2.0 - half, 2.0 + half + 0.72)));
    }

    /// A square around the circle would reach over a robot beside it, and the two robots would wait
    /// for each other to turn.
    #[test]
    fn a_peer_that_turns_takes_its_circle() {
        let peers = peers(2.0, 0.0, 0.0);
        let (_, hull) = peers.turning(0, Point::default()).next().expect("near");
        let far_m = |point: Point| point.distance_m(hull.centre);
        for point in hull.outline() {
            assert!((far_m(point) - 0.360_7).abs() < 1e-3, "{}", far_m(point));
        }
        assert!(hull.area().all(|point| far_m(point) < 0.361));
        assert!(hull.area().any(|point| far_m(point) < 0.15), "its middle");
    }

    #[test]
    fn the_points_of_an_outline_leave_no_gap_for_a_robot() {
        let config = Config::pioneer_3at(heapless::Vec::new());
        let peers = peers(2.0, 0.0, 0.7);
        let (_, hull) = peers
            .near(0, Point::default(), &config)
            .next()
            .expect("near");
        let points: Vec<Point> = hull.outline().collect();
        assert!(points.len() < 64, "{}", points.len());
        for point in &points {
            let others = points.iter().filter(|other| other.distance2(*point) > 1e-6);
            let nearest = others
                .map(|other| other.distance_m(*point))
                .fold(9.0, f32::min);
            assert!(nearest <= POINT_EVERY_M + 1e-3, "{nearest}");
        }
        assert!(
            hull.area()
                .all(|point| hull.frame.to_robot(point).y_m.abs() <= 0.387)
        );
    }
}

//! A member of the team in sight corrects the motion from the robot's own map to the team's
//! coordinates.
//!
//! The member's beacon says where it is, and so which beams should end on its hull. The hull is
//! shifted and turned about the robot until they do:
//!
//! ```text
//! minimise  s Σ w(r) r² / σ² + (y − x)ᵀ P⁻¹ (y − x)        over y, the robot's pose in its map
//! r = n · (end − face)    for the face that the beam met: of those that look at the laser, or that
//!                         it passed outside, the outermost
//! w = 1 / (1 + (r / σ)²),   s = 1 / (1 + beams / 4): they share the errors of both poses
//! ```
//!
//! Beams count whose ends lie near the hull's place and not near an obstacle of the map. A sighting
//! is refused if few of them lie on the hull in the end, or if y is improbable.
//!
//! Units: metres, radians; beams' ends in the robot's map.

use heapless::Vec;

use crate::config::Config;
use crate::geometry::{MapFromOdom, MapPose, OdomPose, Point, Pose, RobotFrame};
use crate::input::Input;
use crate::localise::Symmetric;
use crate::map::Tiles;
use crate::map::integrate::level_beams;
use crate::map::neighbourhood::Neighbourhood;
use crate::math;
use crate::robot::MAX_BEAMS;
use crate::team::Team;
use crate::team::hidden_beams::{GAP_M, extent_m};
use crate::team::peers::Peer;

/// Standard deviation of a beam's end on a hull: noise of the range, of the beacon's pose, and of
/// the hull, which is said in centimetres.
const SIGMA_M: f32 = 0.05;
/// Beams whose errors count as independent.
const INDEPENDENT: f32 = 4.0;
/// Fewest beams of a sighting.
const LEAST_BEAMS: usize = 6;
/// Share of the beams that must lie on the hull, within two deviations.
const LEAST_SHARE: f32 = 0.8;
/// A greater standard deviation of the member's own place tells nothing, centimetres.
const MOST_SD_CM: u8 = 10;
/// Farthest place at which ends of beams belong to the hull, metres beside it.
const MOST_GATE_M: f32 = 0.8;
/// Squared distance from the motion before, in standard deviations, above which a sighting is an
/// error: 1 of 100 is, of three numbers.
const MOST_GAP: f32 = 11.3;
/// Greatest number of Gauss–Newton steps.
const ITERATIONS: u8 = 6;

/// Ends of beams.
type Ends = Vec<Point, { MAX_BEAMS as usize }>;

/// The hull of a member, as a rectangle.
#[derive(Clone, Copy)]
struct Sides {
    half_length_m: f32,
    half_width_m: f32,
}

impl Sides {
    fn of(peer: &Peer) -> Self {
        let (length, width) = peer.beacon.half_cm;
        Self {
            half_length_m: f32::from(length) * 0.01,
            half_width_m: f32::from(width) * 0.01,
        }
    }

    /// Returns the distance of a beam's end to the face that it met, and the face's normal. All in
    /// the hull's frame.
    fn face(self, end: Point, laser: Point) -> (f32, (f32, f32)) {
        let faces = [
            (end.x_m, laser.x_m, self.half_length_m, (1.0, 0.0)),
            (end.y_m, laser.y_m, self.half_width_m, (0.0, 1.0)),
        ];
        let both = faces.into_iter().flat_map(|(end, laser, half, (x, y))| {
            [1.0, -1.0].map(|sign| {
                let off_m = sign * end - half;
                let looks = sign * laser > half;
                (off_m, looks || off_m > 0.0, (sign * x, sign * y))
            })
        });
        let met = both.filter(|(_, counts, _)| *counts);
        let outermost = met.max_by(|a, b| a.0.total_cmp(&b.0));
        outermost.map_or((0.0, (0.0, 0.0)), |(off_m, _, normal)| (off_m, normal))
    }
}

/// The beams that may have met a hull.
struct Sighting {
    laser: Point,
    sides: Sides,
    /// The hull's pose in the robot's frame.
    at: OdomPose,
}

impl Sighting {
    /// Returns the sums of a Gauss–Newton step at a pose of the robot, and the share of the beams
    /// that lie on the hull.
    #[inline(never)]
    fn sums(&self, ends: &[Point], robot: &Pose) -> (Symmetric, [f32; 3], f32) {
        let MapPose(hull) = MapFromOdom::of(robot).apply(&self.at);
        let frame = RobotFrame::of(&hull);
        let (sin, cos) = math::sin_cos(hull.yaw_rad);
        let laser = frame.to_robot(self.laser);
        let share = 1.0 / (1.0 + ends.len() as f32 / INDEPENDENT);
        let (mut h, mut b, mut close) = (Symmetric::ZERO, [0.0; 3], 0_u16);
        for end in ends {
            let (r, (x, y)) = self.sides.face(frame.to_robot(*end), laser);
            let (nx, ny) = (cos * x - sin * y, sin * x + cos * y);
            let (ax, ay) = (end.x_m - robot.x_m, end.y_m - robot.y_m);
            let row = [nx, ny, ny * ax - nx * ay];
            let far = r / SIGMA_M;
            let weight = share / (SIGMA_M * SIGMA_M * (1.0 + far * far));
            h.add_outer(weight, row);
            for (b, j) in b.iter_mut().zip(row) {
                *b += weight * r * j;
            }
            close += u16::from(far.abs() <= 2.0);
        }
        (h, b, f32::from(close) / ends.len() as f32)
    }

    /// Returns the robot's pose in its map that fits the sighting, with its covariance; `None` if
    /// none does.
    fn fit(
        &self,
        ends: &[Point],
        robot: &Pose,
        covariance: &Symmetric,
    ) -> Option<(Pose, Symmetric)> {
        let information = covariance.inverse()?;
        let mut pose = *robot;
        let away = |pose: &Pose| {
            [
                robot.x_m - pose.x_m,
                robot.y_m - pose.y_m,
                math::wrap(robot.yaw_rad - pose.yaw_rad),
            ]
        };
        for _ in 0..ITERATIONS {
            let (h, [bx, by, bt], _) = self.sums(ends, &pose);
            let [px, py, pt] = information.times(away(&pose));
            let step = (h + information).solve([bx + px, by + py, bt + pt]);
            let [dx, dy, turn] = step?;
            pose.x_m += dx;
            pose.y_m += dy;
            pose.yaw_rad = math::wrap(pose.yaw_rad + turn);
        }
        let (h, _, share) = self.sums(ends, &pose);
        let gap = away(&pose);
        let gap: f32 = gap
            .into_iter()
            .zip(information.times(gap))
            .map(|(a, b)| a * b)
            .sum();
        let covariance = (h + information).inverse()?;
        (share >= LEAST_SHARE && gap <= MOST_GAP).then_some((pose, covariance))
    }
}

impl Team {
    /// Takes the members in sight for measurements of the motion to the team's coordinates. The
    /// input's pose is the one in the robot's map.
    #[inline(never)]
    pub(crate) fn sight<const TILES: usize, const SLOTS: usize>(
        &mut self,
        config: &Config,
        tiles: &Tiles<TILES, SLOTS>,
        input: &Input<'_>,
    ) {
        let mut found = None;
        for peer in self.peers.iter() {
            if peer.said_sd_cm > MOST_SD_CM || !peer.has_claims(input.time_ms) {
                continue;
            }
            let Some((sighting, ends)) = self.sighting(peer, config, tiles, input) else {
                continue;
            };
            // A thing is as large as a hull, and a gap parts it from the next one.
            let is_one = |a: &Point, b: &Point| a.distance_m(*b) <= GAP_M;
            let is_hull = |thing: &&[Point]| {
                let most_m = 2.0 * peer.radius_m() + SIGMA_M;
                thing.len() >= LEAST_BEAMS && extent_m(thing.iter().copied()) <= most_m
            };
            let prior = self.frame.spread();
            let things = ends.chunk_by(is_one).filter(is_hull);
            let mut fits = things.filter_map(|thing| sighting.fit(thing, &input.pose, &prior));
            // Of two things that may be the member none counts.
            let fit = fits.next();
            found = found.or(fit.filter(|_| fits.next().is_none()));
        }
        if let Some((pose, covariance)) = found {
            self.frame.correct(&input.pose, &pose, covariance);
        }
    }

    /// Returns the beams that may have met a peer.
    fn sighting<const TILES: usize, const SLOTS: usize>(
        &self,
        peer: &Peer,
        config: &Config,
        tiles: &Tiles<TILES, SLOTS>,
        input: &Input<'_>,
    ) -> Option<(Sighting, Ends)> {
        let mut level = config.lasers.iter().zip(input.scans);
        let (laser, ranges_mm) = level.find(|(laser, _)| laser.is_level())?;
        let robot = RobotFrame::of(&input.pose);
        let hull = peer.pose(input.time_ms);
        let sides = Sides::of(peer);
        let frame = RobotFrame::of(&hull);
        let sd_m = f32::from(peer.beacon.sd_cm) * 0.01;
        let gate_m = (3.0 * sd_m + SIGMA_M).min(MOST_GATE_M);
        // Another robot would look the same.
        let apart_m = 2.0 * (gate_m + peer.radius_m());
        let mut others = self
            .peers
            .iter()
            .filter(|it| it.member.id != peer.member.id);
        if others.any(|it| it.pose(input.time_ms).point().distance_m(hull.point()) <= apart_m) {
            return None;
        }
        let mut near = Neighbourhood::of(tiles);
        let is_near = |end: &Point| {
            let Point { x_m, y_m } = frame.to_robot(*end);
            let cell = end.cell().offset(-2, -2);
            x_m.abs() <= sides.half_length_m + gate_m
                && y_m.abs() <= sides.half_width_m + gate_m
                && near.obstacles_from::<5>(cell) == 0
        };
        let beams = level_beams(&Pose::default(), laser, ranges_mm, &config.tuning.map);
        let ends = beams
            .filter(|beam| beam.hit)
            .map(|beam| robot.to_map(beam.end()));
        let ends: Ends = ends.filter(is_near).take(MAX_BEAMS.into()).collect();
        let at = robot.to_robot(hull.point());
        let sighting = Sighting {
            laser: robot.to_map(Point {
                x_m: laser.x_m,
                y_m: laser.y_m,
            }),
            sides,
            at: OdomPose(Pose {
                x_m: at.x_m,
                y_m: at.y_m,
                yaw_rad: math::wrap(hull.yaw_rad - input.pose.yaw_rad),
                ..Pose::default()
            }),
        };
        (ends.len() >= LEAST_BEAMS).then_some((sighting, ends))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A hull of 0.5 × 0.5 m.
    fn sighting(at: Pose) -> Sighting {
        Sighting {
            laser: Point::default(),
            sides: Sides {
                half_length_m: 0.25,
                half_width_m: 0.25,
            },
            at: OdomPose(at),
        }
    }

    /// Ends of beams on the near and the left face of a hull that is at a place.
    fn ends(at: &Pose) -> Ends {
        let near = (0..12).map(|k| (-0.25, -0.25 + k as f32 * 0.045));
        let left = (0..6).map(|k| (-0.25 + k as f32 * 0.09, 0.25));
        let place = |(x_m, y_m)| at.to_map(Point { x_m, y_m });
        near.chain(left).map(place).collect()
    }

    const PRIOR: Symmetric = Symmetric {
        xx: 0.09,
        yy: 0.09,
        tt: 0.0076,
        ..Symmetric::ZERO
    };

    fn at(x_m: f32, y_m: f32, yaw_rad: f32) -> Pose {
        Pose {
            x_m,
            y_m,
            yaw_rad,
            ..Pose::default()
        }
    }

    #[test]
    fn the_hull_is_found_a_quarter_metre_off() {
        let told = at(2.0, -1.0, 0.3);
        let truly = at(2.2, -0.85, 0.3);
        let robot = Pose::default();
        let found = sighting(told).fit(&ends(&truly), &robot, &PRIOR);
        let (pose, covariance) = found.expect("in sight");
        let MapPose(hull) = MapFromOdom::of(&pose).apply(&OdomPose(told));
        assert!(hull.point().distance_m(truly.point()) < 0.03, "{hull:?}");
        assert!(covariance.xx < 0.3 * PRIOR.xx && covariance.tt < PRIOR.tt);
    }

    #[test]
    fn a_wall_is_no_hull() {
        let wall: Ends = (0..24)
            .map(|k| Point {
                x_m: 1.9,
                y_m: -1.5 + k as f32 * 0.08,
            })
            .collect();
        let found = sighting(at(2.0, -1.0, 0.3)).fit(&wall, &Pose::default(), &PRIOR);
        assert!(found.is_none(), "{found:?}");
    }
}

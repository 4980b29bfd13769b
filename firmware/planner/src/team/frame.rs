//! The motion from the robot's own map to the team's coordinates.
//!
//! A robot whose start is known only roughly draws its map in coordinates of its own. What it says
//! is moved by the motion T, and what it hears is moved back:
//!
//! ```text
//! X = T ∘ x         x: the robot's pose in its map, X: in the team's coordinates
//! P                 covariance of x, if X is right: of T, seen from the robot
//! P ← F P Fᵀ        when the robot moves by a shift (`localise::carry`)
//! ```
//!
//! Tiles of the team (`localise::overlap`) and a member in sight (`sighting`) correct x while X
//! stays, and so T. Once T is certain and some tiles agree, the robot moves its map by T and
//! is one of the team: T is the identity from then on.
//!
//! Only a robot whose map lies in the team's coordinates says tiles, so every tile in the air does.
//!
//! Invariant: P is positive definite while the map is the robot's own.
//! Units: metres, radians.

use crate::config::{LocaliseTuning, TeamPlace};
use crate::geometry::{CELL_M, Cell, MapFromOdom, MapPose, OdomPose, Point, Pose};
use crate::localise::{MOST_CELLS, Overlap, Symmetric, add_tile, carry, is_of_tile, overlap, sd_m};
use crate::map::{Class, Map, Tiles};
use crate::math;
use crate::team::packet::{Beacon, TeamTile};

/// A tile is asked for if the standard deviation of its place is at most this, metres.
const REACH_M: f32 = 0.8;
/// Greatest standard deviations of a motion that is certain.
const CERTAIN_M: f32 = 0.04;
const CERTAIN_RAD: f32 = 0.0087;
/// Least standard deviation of the robot's place that it says. A place that is known less well than
/// to 0.15 m is no measurement for others, so that two robots do not confirm each other's error.
const LEAST_SAID_M: f32 = 0.2;
/// Samples in a row that must agree with the map before.
const AGREED_SAMPLES: u8 = 3;
/// Fewest cells of a sample that is matched.
const LEAST_CELLS: usize = 50;
/// A correction that is greater shows that the motion is not settled.
const SETTLED_M: f32 = 0.03;
const SETTLED_RAD: f32 = 0.005;
/// Growth of the variances with a sample that contradicts the map.
const DOUBT: f32 = 1.2;
/// Standard deviations of what a correction leaves open: corrections share errors of both maps.
const SHARED_M: f32 = 0.02;
const SHARED_RAD: f32 = 0.006;

/// The motion from the robot's own map to the team's coordinates.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct OwnFrame {
    /// The map lies in the robot's own coordinates.
    is_own: bool,
    /// The robot made a step.
    has_moved: bool,
    /// Samples that agreed with the map since one contradicted or moved it.
    agreed: u8,
    /// A sample was matched in this step.
    has_matched: bool,
    /// The page of the sample, and its number of cells.
    page: Option<u16>,
    cells: u8,
    team_from_own: MapFromOdom,
    covariance: Symmetric,
}

/// A motion with its covariance about the robot.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion {
    /// From the robot's map to the team's coordinates.
    pub(crate) team_from_own: MapFromOdom,
    /// Its covariance, about the robot.
    pub(crate) covariance: Symmetric,
}

impl OwnFrame {
    /// Returns the frame of a robot whose map lies in the team's coordinates.
    pub(crate) const fn new() -> Self {
        Self {
            is_own: false,
            has_moved: false,
            agreed: 0,
            has_matched: false,
            page: None,
            cells: 0,
            team_from_own: MapFromOdom::IDENTITY,
            covariance: Symmetric::ZERO,
        }
    }

    /// Returns the frame at a start.
    pub(crate) fn at(place: &TeamPlace) -> Self {
        let (sd_m, sd_rad) = (place.sd_m, place.sd_rad);
        Self {
            is_own: sd_m > 0.0 && sd_rad > 0.0,
            covariance: Symmetric::diagonal(sd_m * sd_m, sd_m * sd_m, sd_rad * sd_rad),
            ..Self::new()
        }
    }

    /// Returns true if the map lies in the robot's own coordinates.
    pub(crate) const fn is_own(&self) -> bool {
        self.is_own
    }

    /// Returns true if what others say of places has a meaning: always in the team's coordinates,
    /// and from the first step on in others.
    pub(crate) const fn is_placed(&self) -> bool {
        self.has_moved || !self.is_own
    }

    /// Notes that the robot moved in its map.
    pub(crate) fn follow(&mut self, from: &Pose, to: &Pose) {
        self.has_matched = false;
        if core::mem::replace(&mut self.has_moved, true) {
            self.covariance = carry(&self.covariance, shift(from.point(), to.point()));
        }
    }

    /// Returns the standard deviation of a place of the robot's map in the team's coordinates.
    pub(crate) fn sd_m(&self, robot: Point, place: Point) -> f32 {
        if !self.is_own {
            return 0.0;
        }
        sd_m(&self.covariance, robot, place)
    }

    /// Returns a beacon of this robot as it is said. `robot` is its place in its map.
    pub(crate) fn said(&self, beacon: Beacon, robot: Point) -> Beacon {
        if !self.is_own {
            return beacon;
        }
        let sd_m = self.sd_m(robot, robot).max(LEAST_SAID_M);
        beacon.moved(&self.team_from_own, sd_m)
    }

    /// Returns a beacon of another robot as it is in this robot's map.
    pub(crate) fn heard(&self, beacon: &Beacon, robot: Point) -> Beacon {
        if !self.is_own {
            return beacon.clone();
        }
        let own_from_team = self.team_from_own.inverse();
        let place = own_from_team.point(beacon.point());
        beacon.moved(&own_from_team, self.sd_m(robot, place))
    }

    /// Returns the middle of a tile of the team in the robot's map; `None` if its place is not
    /// known to the reach of a match.
    pub(crate) fn middle(&self, tile: (i8, i8), robot: Point) -> Option<Point> {
        let middle = |k: i8| (f32::from(k) + 0.5) * 32.0 * CELL_M;
        let place = self.team_from_own.inverse().point(Point {
            x_m: middle(tile.0),
            y_m: middle(tile.1),
        });
        (self.sd_m(robot, place) <= REACH_M).then_some(place)
    }

    /// Takes a tile of the team into the sample. A full sample, or one whose first tile comes
    /// again, is a measurement of the motion.
    pub(crate) fn hear_tile<const TILES: usize, const SLOTS: usize>(
        &mut self,
        said: &TeamTile,
        robot: &Pose,
        map: &mut Map<TILES, SLOTS>,
        tuning: &LocaliseTuning,
    ) {
        if self.has_matched || self.middle(said.tile, robot.point()).is_none() {
            return;
        }
        if self.page.is_none() {
            self.page = map.take_sample().map(|page| page as u16);
        }
        let Some(page) = self.page.map(usize::from) else {
            return;
        };
        let tile = (said.tile.0.into(), said.tile.1.into());
        let cells = usize::from(self.cells);
        let sample = map.sample(page).get(..cells).unwrap_or_default();
        let is_there = sample.iter().any(|word| is_of_tile(*word, tile));
        if is_there || cells >= MOST_CELLS {
            if cells >= LEAST_CELLS {
                self.measure(sample, robot, map.tiles(), tuning);
            }
            self.cells = 0;
        }
        let own_from_team = self.team_from_own.inverse();
        let mut words = [0; MOST_CELLS];
        let mut count = 0;
        let is_floor = |cell: Cell| {
            let own = own_from_team.point(cell.centre()).cell();
            map.class(own) == Class::Free
        };
        add_tile(tile, &said.planes, is_floor, |word| {
            if let Some(place) = words.get_mut(count) {
                *place = word;
                count += 1;
            }
        });
        let free = map
            .sample_mut(page)
            .get_mut(usize::from(self.cells)..MOST_CELLS);
        for (place, word) in free
            .unwrap_or_default()
            .iter_mut()
            .zip(words.iter().take(count))
        {
            *place = *word;
            self.cells += 1;
        }
    }

    /// Matches the sample with the map.
    fn measure<const TILES: usize, const SLOTS: usize>(
        &mut self,
        sample: &[u32],
        robot: &Pose,
        tiles: &Tiles<TILES, SLOTS>,
        tuning: &LocaliseTuning,
    ) {
        self.has_matched = true;
        let MapPose(there) = self.team_from_own.apply(&OdomPose(*robot));
        let found = overlap(tiles, sample, (&there, robot), &self.spread(), tuning);
        match found {
            Overlap::Silent => {}
            Overlap::Contradicted => {
                self.agreed = 0;
                self.covariance = self.covariance.scaled(DOUBT);
            }
            Overlap::Matched { pose, covariance } => {
                let moved_m = pose.point().distance_m(robot.point());
                let turned_rad = math::wrap(pose.yaw_rad - robot.yaw_rad).abs();
                if moved_m > SETTLED_M || turned_rad > SETTLED_RAD {
                    self.agreed = 0;
                }
                self.agreed = self.agreed.saturating_add(1);
                self.correct(robot, &pose, covariance);
            }
        }
    }

    /// Returns the covariance before a correction.
    pub(crate) fn spread(&self) -> Symmetric {
        let (m, rad) = (SHARED_M * SHARED_M, SHARED_RAD * SHARED_RAD);
        self.covariance + Symmetric::diagonal(m, m, rad)
    }

    /// Takes a corrected pose of the robot in its map, with its covariance: the pose that fits the
    /// one in the team's coordinates.
    pub(crate) fn correct(&mut self, robot: &Pose, corrected: &Pose, covariance: Symmetric) {
        let MapPose(there) = self.team_from_own.apply(&OdomPose(*robot));
        self.team_from_own = MapFromOdom::between(&OdomPose(*corrected), &MapPose(there));
        self.covariance = covariance;
    }

    /// Returns the motion once it is certain. The map lies in the team's coordinates from then on.
    ///
    /// Also returns the page of the sample.
    pub(crate) fn take_certain(&mut self) -> Option<(Motion, Option<usize>)> {
        let p = &self.covariance;
        let is_certain = self.agreed >= AGREED_SAMPLES
            && p.xx.max(p.yy) <= CERTAIN_M * CERTAIN_M
            && p.tt <= CERTAIN_RAD * CERTAIN_RAD;
        let motion = Motion {
            team_from_own: self.team_from_own,
            covariance: self.covariance,
        };
        (self.is_own && is_certain).then(|| {
            let page = self.page.map(usize::from);
            *self = Self::new();
            (motion, page)
        })
    }
}

fn shift(from: Point, to: Point) -> Point {
    Point {
        x_m: to.x_m - from.x_m,
        y_m: to.y_m - from.y_m,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame() -> OwnFrame {
        OwnFrame::at(&TeamPlace {
            sd_m: 0.3,
            sd_rad: 0.1,
            ..TeamPlace::default()
        })
    }

    fn at(x_m: f32, y_m: f32) -> Pose {
        Pose {
            x_m,
            y_m,
            ..Pose::default()
        }
    }

    #[test]
    fn a_known_start_says_and_hears_as_it_is() {
        let frame = OwnFrame::at(&TeamPlace::default());
        let beacon = Beacon::default().at(&at(3.0, 4.0));
        assert_eq!(frame.said(beacon.clone(), Point::default()), beacon);
        assert_eq!(frame.heard(&beacon, Point::default()), beacon);
    }

    #[test]
    fn a_place_far_from_the_start_is_known_less() {
        let mut frame = frame();
        frame.follow(&at(0.0, 0.0), &at(20.0, 10.0));
        let start = Point {
            x_m: 20.0,
            y_m: 10.0,
        };
        let far = Point { x_m: 24.0, ..start };
        assert!((frame.sd_m(start, start) - 0.3).abs() < 1e-6);
        assert!((frame.sd_m(start, far) - 0.5).abs() < 1e-3);
        // The robot drives there; the place of the start is known as before.
        frame.follow(&at(20.0, 10.0), &at(24.0, 10.0));
        assert!((frame.sd_m(far, far) - 0.5).abs() < 1e-3);
        assert!((frame.sd_m(far, start) - 0.3).abs() < 1e-3);
    }

    #[test]
    fn a_correction_moves_what_is_said_and_heard() {
        let mut frame = frame();
        let robot = at(5.0, 2.0);
        frame.follow(&robot, &robot);
        let corrected = Pose {
            yaw_rad: 0.1,
            ..at(5.2, 2.1)
        };
        frame.correct(&robot, &corrected, Symmetric::diagonal(1e-4, 1e-4, 1e-5));
        // The robot is where it was in the team's coordinates, if it is at the corrected pose here.
        let said = frame.said(Beacon::default().at(&corrected), corrected.point());
        assert_eq!((said.position_cm, said.sd_cm), ((500, 200), 20));
        assert!(said.yaw_rad.abs() < 1e-5);
        let heard = frame.heard(&said, corrected.point());
        assert!(heard.point().distance_m(corrected.point()) < 0.01);
        assert!((heard.yaw_rad - 0.1).abs() < 1e-5);
    }

    #[test]
    fn only_a_certain_motion_that_samples_confirm_is_taken() {
        let mut frame = frame();
        frame.agreed = AGREED_SAMPLES;
        assert!(frame.take_certain().is_none(), "not certain");
        frame.covariance = Symmetric::diagonal(1e-4, 1e-4, 1e-5);
        frame.agreed = AGREED_SAMPLES - 1;
        assert!(frame.take_certain().is_none(), "not confirmed");
        frame.agreed = AGREED_SAMPLES;
        assert!(frame.take_certain().is_some() && !frame.is_own());
        assert!(frame.take_certain().is_none(), "only once");
    }
}

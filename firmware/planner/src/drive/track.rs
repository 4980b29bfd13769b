//! The robot's own track: its last poses, along which it can drive back out of a narrow place.
//!
//! Where the hull was there is room for it, whatever the map says. So a robot that is wedged
//! follows its track backwards, up to a place where it can turn.
//!
//! ```text
//! pₙ = pₙ₋₁ ⊕ qₙ      q: the difference of two poses, rounded; in the frame of the older one
//! ```
//!
//! Only the last pose p is kept, and the differences before it. A difference is taken from the
//! rounded pose, so rounding errors do not add up. Where the robot comes back to its track, the
//! loop in between is forgotten. So the track leads out of every place that the robot drove into,
//! also after it drove to and fro in there.
//!
//! A straight way is one difference, so the track is longer. A robot without a path that blocked
//! what it came through goes back along its track, up to where a path leads on. Measured:
//! docs/MEASURED.md, "A straight way of the track", "A robot without a path goes back".
//!
//! Invariant: the older poses are those that were recorded, within 2 mm and 0.3°, but those on a
//! straight way.
//! Units: metres, radians; map frame.

use crate::drive::hull::Place;
use crate::geometry::{MapFromOdom, MapPose, OdomPose, Point, Pose, RobotFrame, Twist};
use crate::math;

/// Differences that are kept: at least 2.8 m of way, and 28 m of straight way.
pub(crate) const MOST: usize = 56;
/// A pose this far from the last one is recorded, metres; or turned this much, radians. The hull's
/// corners move as far in both.
const STEP_M: f32 = 0.05;
const STEP_RAD: f32 = 0.14;
/// Units of the differences: 4 mm ahead, 1 mm aside, and 0.57°.
const UNITS: [f32; 3] = [4e-3, 1e-3, 1e-2];
/// A robot this near to its track is back on it, metres and radians: half of what is recorded, so
/// that a robot that drives on never is.
const BACK_M: f32 = 0.5 * STEP_M;
const BACK_RAD: f32 = 0.5 * STEP_RAD;
/// A way is straight, and one difference, if it leads aside and turns by no more than this, metres
/// and radians.
const STRAIGHT_M: f32 = 0.005;
const STRAIGHT_RAD: f32 = 0.02;
/// Way along the track by which a retreat leaves its place, metres: that of a robot that moved.
const LEAVE_M: f32 = 0.3;
/// A pose this near is reached, metres along the track and radians.
const REACHED_M: f32 = 0.015;
const REACHED_RAD: f32 = 0.04;
/// Turn for a metre of distance from the track, radians.
const BACK_ON_TRACK: f32 = 3.0;
/// Greatest speed of a robot that backs where it looks the other way, metres per second.
pub(crate) const BACK_MPS: f32 = 0.15;
/// Greatest turn rate back along the track, radians per second.
const BACK_RADPS: f32 = 0.5;

/// The last poses, as a ring of differences.
#[derive(Clone, Debug)]
pub(crate) struct Track {
    differences: [[i8; 3]; MOST],
    /// Number of differences, and the place of the next one.
    len: u8,
    next: u8,
    /// Number of differences at which a retreat has left its place.
    left: u8,
    /// The last pose; no robot was seen before the first.
    last: [f32; 3],
    has_last: bool,
}

/// The way from a pose to the next one.
struct Piece {
    from: [f32; 3],
    to: [f32; 3],
    /// The difference of both, in its units.
    units: [i8; 3],
}

/// Returns the difference `to` − `from`, in the frame of `from`.
fn difference([x, y, yaw]: [f32; 3], to: [f32; 3]) -> [f32; 3] {
    let (sin, cos) = math::sin_cos(yaw);
    let (dx, dy) = (to[0] - x, to[1] - y);
    [
        dx * cos + dy * sin,
        dy * cos - dx * sin,
        math::wrap(to[2] - yaw),
    ]
}

impl Track {
    /// Returns an empty track.
    pub(crate) const fn new() -> Self {
        Self {
            differences: [[0; 3]; MOST],
            len: 0,
            next: 0,
            left: 0,
            last: [0.0; 3],
            has_last: false,
        }
    }

    /// Forgets all poses.
    pub(crate) const fn clear(&mut self) {
        (self.len, self.has_last) = (0, false);
    }

    /// Returns the last pose, x, y and yaw; `None` before the first one.
    pub(crate) fn end(&self) -> Option<[f32; 3]> {
        self.has_last.then_some(self.last)
    }

    /// Returns the differences, the oldest first, in units of 4 mm, 1 mm and 0.01 rad.
    pub(crate) fn differences(&self) -> impl Iterator<Item = [i8; 3]> + '_ {
        (1..=self.len).rev().map(|back| self.difference(back))
    }

    /// Returns the track that ends at this pose after these differences, the oldest first. Of more
    /// than [`MOST`] the last ones count.
    pub(crate) fn of(end: Option<[f32; 3]>, differences: impl Iterator<Item = [i8; 3]>) -> Self {
        let mut track = Self::new();
        let Some(end) = end else {
            return track;
        };
        (track.last, track.has_last) = (end, true);
        differences.for_each(|units| track.push(units));
        track
    }

    /// Appends a difference; of a full track the oldest one goes.
    fn push(&mut self, units: [i8; 3]) {
        if let Some(place) = self.differences.get_mut(usize::from(self.next)) {
            *place = units;
        }
        self.next = (self.next + 1) % MOST as u8;
        self.len = (self.len + 1).min(MOST as u8);
    }

    /// Moves the track with the robot.
    pub(crate) fn correct(&mut self, motion: &MapFromOdom) {
        let [x_m, y_m, yaw_rad] = self.last;
        let MapPose(pose) = motion.apply(&OdomPose(Pose {
            x_m,
            y_m,
            yaw_rad,
            ..Pose::default()
        }));
        self.last = [pose.x_m, pose.y_m, pose.yaw_rad];
    }

    /// Returns true if there is no way back.
    pub(crate) const fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Records a pose, if the robot moved since the last one. A jump of half a metre, or of an
    /// eighth aside, begins a new track.
    pub(crate) fn record(&mut self, pose: &Pose) {
        let now = [pose.x_m, pose.y_m, pose.yaw_rad];
        if !self.has_moved(now) {
            return;
        }
        self.forget_loop(now);
        if !self.has_moved(now) {
            return;
        }
        let moved = difference(self.last, now);
        let joined = self.straight_to(now);
        if joined.is_some() {
            self.drop_last();
        }
        match joined.or_else(|| rounded(moved)).filter(|_| self.has_last) {
            None => {
                self.clear();
                (self.last, self.has_last) = (now, true);
            }
            Some(units) => {
                self.push(units);
                let [dx, dy, turn] = metres(units);
                let (sin, cos) = math::sin_cos(self.last[2]);
                self.last[0] += dx * cos - dy * sin;
                self.last[1] += dx * sin + dy * cos;
                self.last[2] = math::wrap(self.last[2] + turn);
            }
        }
    }

    /// Returns true if a pose is no longer the last one.
    fn has_moved(&self, now: [f32; 3]) -> bool {
        let [dx, dy, turn] = difference(self.last, now);
        !self.has_last || dx * dx + dy * dy >= STEP_M * STEP_M || turn.abs() >= STEP_RAD
    }

    /// Drops the poses since the robot was first at `now`, if it was there before.
    fn forget_loop(&mut self, now: [f32; 3]) {
        let was_at = |Piece { from, units, .. }: &Piece| {
            let [length, ..] = metres(*units);
            let [along, aside, turn] = difference(*from, now);
            let beyond = along - along.clamp(length.min(0.0), length.max(0.0));
            beyond * beyond + aside * aside < BACK_M * BACK_M && turn.abs() < BACK_RAD
        };
        let backs = (1..).zip(self.pieces());
        let first = backs.filter(|(_, piece)| was_at(piece)).last();
        let drop = first.map_or(0, |(back, _)| back);
        (0..drop).for_each(|_| self.drop_last());
    }

    /// Returns the difference from the pose before the last one, if the way from there is straight.
    fn straight_to(&self, now: [f32; 3]) -> Option<[i8; 3]> {
        let way = difference(self.before_last()?, now);
        let [_, aside, turn] = way;
        let is_straight = aside.abs() <= STRAIGHT_M && turn.abs() <= STRAIGHT_RAD;
        rounded(way).filter(|_| is_straight)
    }

    /// Returns true if the track leads past a point of the map, by no more than this, metres.
    pub(crate) fn passes(&self, point: Point, within_m: f32) -> bool {
        let at = |[x_m, y_m, _]: [f32; 3]| Point { x_m, y_m };
        self.pieces()
            .any(|piece| point.to_line2(at(piece.from), at(piece.to)) <= within_m * within_m)
    }

    /// Returns the pieces of the track, the last one first.
    fn pieces(&self) -> impl Iterator<Item = Piece> + '_ {
        let mut pose = self.last;
        (1..=self.len).map(move |back| {
            let (to, units) = (pose, self.difference(back));
            pose = before(to, units);
            Piece {
                from: pose,
                to,
                units,
            }
        })
    }

    /// Returns the difference from the pose that lies `back` before the last one, in its units.
    fn difference(&self, back: u8) -> [i8; 3] {
        let place = (usize::from(self.next) + MOST - usize::from(back)) % MOST;
        self.differences.get(place).copied().unwrap_or_default()
    }

    /// Notes where a retreat begins.
    pub(crate) fn begin_retreat(&mut self) {
        let mut far_m = 0.0;
        let back = self.pieces().take_while(|piece| {
            let [dx, dy, _] = metres(piece.units);
            let is_near = far_m < LEAVE_M;
            far_m += math::sqrt(dx * dx + dy * dy);
            is_near
        });
        let back = back.count() as u8;
        // The pose at the end of the way is reached when it is dropped.
        self.left = (self.len - back).saturating_sub(1);
    }

    /// Returns true if the retreat has left the place where it began: it has followed the track for
    /// [`LEAVE_M`], or to its beginning.
    pub(crate) const fn has_left(&self) -> bool {
        self.len <= self.left
    }

    /// Returns the velocity back along the track for a robot at `pose`, and drops the poses that it
    /// has reached; `None` at the track's beginning.
    pub(crate) fn back(&mut self, pose: &Pose, period_s: f32) -> Option<Twist> {
        loop {
            let place = self.place(pose)?;
            let (sin, cos) = math::sin_cos(0.5 * place.yaw_rad);
            let along = place.x_m * cos + place.y_m * sin;
            let across = place.y_m * cos - place.x_m * sin;
            let along = if along.abs() < REACHED_M { 0.0 } else { along };
            let turn = place.yaw_rad
                + if along == 0.0 {
                    0.0
                } else {
                    BACK_ON_TRACK * across * along.signum()
                };
            if along != 0.0 || turn.abs() >= REACHED_RAD {
                let seconds = (along.abs() / BACK_MPS)
                    .max(turn.abs() / BACK_RADPS)
                    .max(period_s);
                return Some(Twist {
                    linear_mps: along / seconds,
                    angular_radps: turn / seconds,
                });
            }
            self.drop_last();
        }
    }

    /// Returns the last pose, seen from a robot.
    fn place(&self, robot: &Pose) -> Option<Place> {
        let [x_m, y_m, yaw_rad] = self.last;
        let at = RobotFrame::of(robot).to_robot(Point { x_m, y_m });
        self.has_last.then(|| Place {
            x_m: at.x_m,
            y_m: at.y_m,
            yaw_rad: math::wrap(yaw_rad - robot.yaw_rad),
        })
    }

    /// Returns the pose before the last one.
    fn before_last(&self) -> Option<[f32; 3]> {
        (self.len > 0).then(|| before(self.last, self.difference(1)))
    }

    /// Drops the last pose.
    fn drop_last(&mut self) {
        let Some(before) = self.before_last() else {
            self.clear();
            return;
        };
        self.last = before;
        self.len -= 1;
        self.next = self.next.checked_sub(1).unwrap_or(MOST as u8 - 1);
    }
}

/// Returns the pose from which a difference, in its units, leads to this one.
fn before([x, y, yaw]: [f32; 3], units: [i8; 3]) -> [f32; 3] {
    let [dx, dy, turn] = metres(units);
    let yaw = math::wrap(yaw - turn);
    let (sin, cos) = math::sin_cos(yaw);
    [x - dx * cos + dy * sin, y - dx * sin - dy * cos, yaw]
}

/// Returns a difference in its units; `None` if it does not fit.
fn rounded(moved: [f32; 3]) -> Option<[i8; 3]> {
    let mut units = [0; 3];
    for ((unit, moved), size) in units.iter_mut().zip(moved).zip(UNITS) {
        *unit = i8::try_from(math::floor(moved / size + 0.5)).ok()?;
    }
    Some(units)
}

fn metres(units: [i8; 3]) -> [f32; 3] {
    let mut metres = [0.0; 3];
    for ((metre, unit), size) in metres.iter_mut().zip(units).zip(UNITS) {
        *metre = f32::from(unit) * size;
    }
    metres
}

#[cfg(test)]
mod tests;

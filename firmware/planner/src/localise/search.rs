//! The wider search of a lost robot: at which shift and turn do most beams end on obstacles?
//!
//! ```text
//! score(dx, dy, turn) = Σ over beams of obstacle(end + (dx, dy)),   −16 ≤ dx, dy < 16 cells
//! ```
//!
//! A turn takes all 1,024 shifts at once. A row of 32 cells is a word, and counts are kept bit by
//! bit: plane k of a row of shifts holds bit k of 32 counts. To add a beam is to carry a word
//! through six planes.
//!
//! | rounds | place | turns | decided |
//! | --- | --- | --- | --- |
//! | 0 | where odometry has the robot | that odometry allows | after it |
//! | 1 to 8 | the eight squares of 3.2 m around it | the same | after all |
//! | 9 to 17 | all nine | all | after all |
//!
//! A lost robot stands, so its yaw is wrong by what wheels slipped: 30°, or three standard
//! deviations of odometry. Only if no place fits so, the robot may have been carried.
//!
//! A step takes a few turns, and all rounds take 243 steps, which is 49 s. The best shift and turn
//! and the best one elsewhere are the starts of alignments (`lost`).
//!
//! Units: map cells, radians.

use crate::geometry::{CELL_M, MapFromOdom, MapPose, OdomPose, Pose, RobotFrame};
use crate::localise::in_cells;
use crate::localise::scan_points::ScanPoint;
use crate::map::Tiles;
use crate::math;

/// Shifts along a side of the square.
const SIDE: i32 = 32;
/// Bits of a count.
const PLANES: usize = 6;
/// Greatest number of beams: the greatest count.
const MOST_BEAMS: usize = (1 << PLANES) - 1;
/// Turn from one try to the next, radians: 2°, a cell at 2.9 m.
const TURN_RAD: f32 = 2.0 * math::PI / TURNS as f32;
/// Tries of a whole turn.
const TURNS: u16 = 180;
/// Least tries of a round with the turns that odometry allows.
const LEAST_TURNS: u16 = 31;
/// Turns that differ by more are two places, radians.
const APART_RAD: f32 = 10.0 * math::PI / 180.0;
/// Turns of a step.
const TURNS_PER_STEP: u16 = 8;
/// Places of the rounds, in squares. The rounds go over them twice.
const PLACES: [(i32, i32); 9] = [
    (0, 0),
    (1, 0),
    (-1, 0),
    (0, 1),
    (0, -1),
    (1, 1),
    (-1, 1),
    (1, -1),
    (-1, -1),
];

/// A shift and a turn.
#[derive(Clone, Copy, Debug, Default)]
struct Candidate {
    /// In 64ths of a beam: nearer ones win ties. 0 for none.
    score: i32,
    motion: MapFromOdom,
}

impl Candidate {
    /// Returns true if this is another place than that of `other`. It is asked for twice, so it is
    /// not inlined.
    #[inline(never)]
    fn is_apart(&self, other: &Self, odom: &OdomPose) -> bool {
        let [a, b] = [self, other].map(|it| in_cells(&it.motion.apply(odom).0));
        are_apart(&a, &b)
    }
}

/// Returns true if two poses are more than [`APART`] cells or 10° from each other.
#[inline(never)]
pub(super) fn are_apart(a: &[f32; 3], b: &[f32; 3]) -> bool {
    let apart = APART as f32;
    (a[0] - b[0]).abs() > apart
        || (a[1] - b[1]).abs() > apart
        || math::wrap(a[2] - b[2]).abs() > APART_RAD
}

/// The state of a search.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Search {
    round: u8,
    turn: u16,
    /// The best candidate, and the best one elsewhere.
    best: Candidate,
    rival: Candidate,
}

/// The counts of the shifts: for each row of shifts its planes.
type Counts = [[u32; PLANES]; SIDE as usize];

impl Search {
    /// Returns a search that begins.
    pub(super) const fn new() -> Self {
        const NONE: Candidate = Candidate {
            score: 0,
            motion: MapFromOdom::IDENTITY,
        };
        Self {
            round: 0,
            turn: 0,
            best: NONE,
            rival: NONE,
        }
    }

    /// Tries a few turns. It runs only while the robot is lost. Returns the best candidate and the
    /// best one elsewhere where the search is to decide. `yaw_sd_rad` is the standard deviation of
    /// the yaw.
    #[cold]
    #[inline(never)]
    pub(super) fn advance<const TILES: usize, const SLOTS: usize>(
        &mut self,
        tiles: &Tiles<TILES, SLOTS>,
        points: &[ScanPoint],
        (odom, predicted): (&OdomPose, &MapPose),
        yaw_sd_rad: f32,
    ) -> Option<[Option<MapFromOdom>; 2]> {
        if self.is_over() {
            return None;
        }
        let places = PLACES.len();
        let &(right, up) = PLACES.get(usize::from(self.round) % places)?;
        let side_m = SIDE as f32 * CELL_M;
        let place = Pose {
            x_m: predicted.0.x_m + right as f32 * side_m,
            y_m: predicted.0.y_m + up as f32 * side_m,
            ..predicted.0
        };
        for _ in 0..TURNS_PER_STEP {
            self.take(tiles, points, odom, &place);
            self.turn += 1;
            if self.turn >= self.turns(yaw_sd_rad) {
                let found = [self.best, self.rival];
                self.turn = 0;
                self.round += 1;
                let is_stage = usize::from(self.round).is_multiple_of(places);
                if is_stage {
                    let round = self.round;
                    *self = Self {
                        round,
                        ..Self::new()
                    };
                }
                return (is_stage || self.round == 1)
                    .then(|| found.map(|it| (it.score > 0).then_some(it.motion)));
            }
        }
        None
    }

    /// Returns true in the first round.
    pub(super) const fn is_near(&self) -> bool {
        self.round == 0
    }

    /// Returns true if all rounds are over.
    pub(super) const fn is_over(&self) -> bool {
        self.round as usize >= 2 * PLACES.len()
    }

    /// Returns the number of tries of this round.
    fn turns(&self, yaw_sd_rad: f32) -> u16 {
        if usize::from(self.round) >= PLACES.len() {
            return TURNS;
        }
        let allowed = (6.0 * yaw_sd_rad / TURN_RAD) as u16;
        allowed.clamp(LEAST_TURNS, TURNS)
    }

    /// Tries all shifts at one turn: 0, +1, −1, +2, −2, …
    fn take<const TILES: usize, const SLOTS: usize>(
        &mut self,
        tiles: &Tiles<TILES, SLOTS>,
        points: &[ScanPoint],
        odom: &OdomPose,
        place: &Pose,
    ) {
        let half = f32::from(self.turn.div_ceil(2));
        let sign = if self.turn % 2 == 1 { 1.0 } else { -1.0 };
        let turned = Pose {
            yaw_rad: math::wrap(place.yaw_rad + sign * half * TURN_RAD),
            ..*place
        };
        let counts = count(tiles, points, &turned);
        for (dy, planes) in (-SIDE / 2..).zip(&counts) {
            let mut planes = *planes;
            // The best shift of a row, and the best one elsewhere in it.
            for _ in 0..2 {
                let (hits, mask) = most(&planes);
                let dx = nearest(mask);
                let score = 64 * hits as i32 - dx.abs() - dy.abs();
                if score <= self.rival.score {
                    break;
                }
                let shifted = Pose {
                    x_m: turned.x_m + dx as f32 * CELL_M,
                    y_m: turned.y_m + dy as f32 * CELL_M,
                    ..turned
                };
                let motion = MapFromOdom::between(odom, &MapPose(shifted));
                self.rank(Candidate { score, motion }, odom);
                planes = planes.map(|plane| plane & !beside(dx));
            }
        }
    }

    /// Enters a candidate that is better than the best one elsewhere.
    #[inline(never)]
    fn rank(&mut self, found: Candidate, odom: &OdomPose) {
        let is_apart = found.is_apart(&self.best, odom);
        if found.score <= self.best.score {
            if is_apart {
                self.rival = found;
            }
            return;
        }
        if is_apart {
            self.rival = self.best;
        } else if !found.is_apart(&self.rival, odom) {
            self.rival.score = 0;
        }
        self.best = found;
    }
}

/// Returns the bits of the shifts of a row that are the same place as this one.
const fn beside(dx: i32) -> u32 {
    const ALL: u64 = (1 << (2 * APART + 1)) - 1;
    (ALL << (dx + SIDE / 2) >> APART) as u32
}

/// The best of all shifts of a pose.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Peak {
    /// Beams that end on obstacles there.
    pub(super) hits: u32,
    /// The same for the best shift that is more than [`APART`] cells away.
    pub(super) second: u32,
    /// The shift, cells.
    pub(super) shift: (i32, i32),
}

/// Shifts farther apart are two places, cells.
pub(super) const APART: i32 = 3;

/// Returns the best of all shifts of a pose.
pub(super) fn peak<const TILES: usize, const SLOTS: usize>(
    tiles: &Tiles<TILES, SLOTS>,
    points: &[ScanPoint],
    pose: &Pose,
) -> Peak {
    let counts = count(tiles, points, pose);
    let mut peak = Peak::default();
    for (dy, planes) in (-SIDE / 2..).zip(&counts) {
        let (hits, mask) = most(planes);
        if hits > peak.hits {
            (peak.hits, peak.shift) = (hits, (nearest(mask), dy));
        }
    }
    let (x, y) = peak.shift;
    let beside = beside(x);
    for (dy, planes) in (-SIDE / 2..).zip(&counts) {
        let is_near = (dy - y).abs() <= APART;
        let kept = if is_near { !beside } else { u32::MAX };
        let (hits, _) = most(&planes.map(|plane| plane & kept));
        peak.second = peak.second.max(hits);
    }
    peak
}

/// Counts the beams that end on obstacles, for all shifts of a pose.
fn count<const TILES: usize, const SLOTS: usize>(
    tiles: &Tiles<TILES, SLOTS>,
    points: &[ScanPoint],
    pose: &Pose,
) -> Counts {
    let mut counts = [[0; PLANES]; SIDE as usize];
    let stride = points.len().div_ceil(MOST_BEAMS).max(1);
    let frame = RobotFrame::of(pose);
    for point in points.iter().step_by(stride) {
        let corner = frame.to_map(point.end).cell().offset(-SIDE / 2, -SIDE / 2);
        let mut rows = counts.iter_mut();
        tiles.standing_block(corner, |row| {
            let mut carry = row;
            for plane in rows.next().into_iter().flatten() {
                let both = *plane & carry;
                *plane ^= carry;
                carry = both;
            }
        });
    }
    counts
}

/// Returns the greatest count of a row, and the shifts that have it. It is not inlined: it is
/// called from four places.
#[inline(never)]
fn most(planes: &[u32; PLANES]) -> (u32, u32) {
    let mut mask = u32::MAX;
    let mut count = 0;
    for plane in planes.iter().rev() {
        count <<= 1;
        if mask & plane != 0 {
            mask &= plane;
            count |= 1;
        }
    }
    (count, mask)
}

/// Returns the shift of a row that is nearest to none.
const fn nearest(mask: u32) -> i32 {
    let right = (mask >> (SIDE / 2)).trailing_zeros() as i32;
    let left = (mask << (SIDE / 2)).leading_zeros() as i32 + 1;
    if right <= left { right } else { -left }
}

#[cfg(test)]
mod tests;

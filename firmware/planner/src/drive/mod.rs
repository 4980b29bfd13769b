//! From the field's heading to a velocity of a skid-steer robot that touches nothing.
//!
//! The wish is to turn towards the heading at the rate `k·error` and to drive forward at
//! `v_max·cos²(error)`. A candidate (v, ω) is admissible if the robot's rectangle stays clear of
//! every obstacle point while the robot follows the candidate for one period and then brakes to a
//! stop, from its measured velocity and within its acceleration limits. The drive takes the first
//! admissible candidate, in order of distance from the wish. If there is none, the robot turns on
//! the spot or drives straight back. If it cannot, a recovery leads out. If none is found either,
//! the robot is *wedged*: it retreats along its own track to a place where it can turn. Where it
//! cannot drive faster than it creeps, a *lane* takes the place of the field's heading.
//!
//! Invariant: after every commanded velocity a stop is possible that touches nothing known, so the
//! zero command is always safe.
//!
//! Units: metres, seconds, radians; robot frame, x forward.

mod collision;
pub(crate) mod contact;
mod incline;
mod lane;
mod motion;
mod open_list;
mod recovery;
mod roll_out;
mod search_query;
pub(crate) mod side_slope;
mod track;

pub use collision::{CollisionChecker, Place};
pub(crate) use incline::Incline;
pub use recovery::SCRATCH_WORDS;
pub use search_query::SearchQuery;

use crate::config::Config;
use crate::geometry::{OdomPose, Twist};
use crate::math;
use contact::{Contact, ContactSense};
use lane::Lane;
use motion::{MotionSet, Recovery};
use recovery::{Search, SearchBudget, SearchOutcome};
use roll_out::roll_out;
use track::Track;

/// Clearance at speed, metres: three sigma of a range and one of the odometry between two scans.
const MARGIN_M: f32 = 0.06;
/// Clearance while creeping through a narrow place, metres: two sigma of a range.
const CREEP_MARGIN_M: f32 = 0.025;
/// Clearances of a recovery, metres: that of the first search, and of the next one. The nearest of
/// many points of a wall is two sigma nearer than the wall, so the free space is wider than the
/// smaller one.
const SEARCH_MARGINS_M: [f32; 2] = [0.03, 0.012];
/// Clearance while a recovery is driven, metres.
const RECOVERY_MARGIN_M: f32 = 0.008;
/// Greatest speed that counts as creeping, and the speed of reversing, metres per second.
const CREEP_MPS: f32 = 0.15;
/// Wished turn rate per radian of error, 1/s.
const TURN_GAIN: f32 = 2.0;
/// Greatest wished turn rate, as a part of the robot's.
const TURN_PART: f32 = 0.6;
/// Slower turn rate that is tried next, as a part of the wished one.
const SLOW_TURN_PART: f32 = 0.4;
/// Least error for which the robot turns on the spot first, radians.
const TURN_FIRST_RAD: f32 = 0.9;
/// Greatest error that needs no turn on the spot, radians.
const ALIGNED_RAD: f32 = 0.12;
/// Speeds of the candidates ahead, as parts of the wished one, in the order of trial.
const SPEED_PARTS: [f32; 3] = [1.0, 0.5, 0.2];
/// Turn rates of the candidates ahead beside the wished one, radians per second, in the order of
/// trial for each speed.
const TURN_OFFSETS_RADPS: [f32; 5] = [0.0, 0.25, -0.25, 0.6, -0.6];

/// Turn rate of a robot that looks around, radians per second.
const LOOK_AROUND_RADPS: f32 = 0.6;

/// Budget of a search in one step.
const SEARCH_BUDGET: SearchBudget = SearchBudget {
    poses: 250,
    points: 60_000,
};
/// Budget in the first step of a search: that step has solved a field as well.
const FIRST_BUDGET: SearchBudget = SearchBudget {
    poses: SEARCH_BUDGET.poses / 3,
    points: SEARCH_BUDGET.points / 3,
};
/// Steps between a search that found nothing and the next one, where the ground bounds the
/// headings: about the steps of two skeletons.
const REST_STEPS: u8 = 20;
/// Steps for which the robot creeps on as far as it goes, after a search that found nothing: time
/// for a hull's length. The points of a tight gap are often seen better from within. It does so
/// only when nothing else is left to explore, because the gap may not let it out again. In
/// `aria_columbia`, five seeds, lanes followed:
///
/// | the robot creeps on | at once | when nothing else is left |
/// | --- | --- | --- |
/// | runs of five that know 90 % at the end | 3 | 4 |
const SQUEEZE_STEPS: u8 = 30;
/// Greatest difference of the error to half a turn for driving straight back, radians.
const REVERSE_RAD: f32 = 0.35;
/// Turn rate while reversing, per radian of that difference, 1/s.
const REVERSE_GAIN: f32 = 0.5;
/// Greatest speed of a robot that counts as standing, metres per second.
const STANDING_MPS: f32 = 0.02;
/// Greatest turn rate of a robot that counts as standing, radians per second.
const STANDING_RADPS: f32 = 0.05;

/// The drive's state: the recovery in progress, or the search for one.
#[derive(Debug)]
pub struct Drive {
    recovery: Recovery,
    search: Option<Search>,
    /// The side to which it looks around.
    looks_right: bool,
    /// Steps until the next search may begin, after one that found nothing.
    rest_steps: u8,
    contact: ContactSense,
    track: Track,
    /// The robot goes back along its track.
    retreats: bool,
    /// The last searches found no recovery.
    wedged: bool,
    /// Steps for which the robot still creeps on where no roll-out leads through.
    squeeze_steps: u8,
    /// The lane of the search.
    lane: Option<Lane>,
}

impl Drive {
    /// Returns a drive at rest.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            recovery: Recovery::new(),
            search: None,
            looks_right: false,
            rest_steps: 0,
            contact: ContactSense::new(),
            track: Track::new(),
            retreats: false,
            wedged: false,
            squeeze_steps: 0,
            lane: None,
        }
    }

    /// Notes the velocity that the robot is told to drive for the next period.
    pub(crate) const fn tell(&mut self, told: Twist) {
        self.contact.tell(told);
    }

    /// Notes where the robot is.
    pub(crate) fn note_pose(&mut self, OdomPose(pose): &OdomPose) {
        if !self.retreats {
            self.track.record(pose);
        }
    }

    /// Returns true while the robot goes back along its track.
    pub(crate) const fn is_retreating(&self) -> bool {
        self.retreats
    }

    /// Returns true once for each time that the robot was wedged.
    pub(crate) const fn take_wedged(&mut self) -> bool {
        core::mem::replace(&mut self.wedged, false)
    }

    /// Returns the velocity back along the track; zero at its end. `checker` has the obstacle
    /// points that the robot has measured, and no cells of the map: there is room on the track.
    pub(crate) fn retreat(
        &mut self,
        config: &Config,
        OdomPose(pose): &OdomPose,
        checker: &CollisionChecker,
        now: Twist,
    ) -> Twist {
        let twist = self.track.back(pose, config.period_s);
        let twist = twist.filter(|twist| checker.admits(*twist, now, config, RECOVERY_MARGIN_M));
        self.retreats = twist.is_some();
        twist.unwrap_or_default()
    }

    /// Ends the retreat where the robot can turn. `checker` has all obstacles.
    pub(crate) fn end_retreat(&mut self, checker: &CollisionChecker) {
        self.retreats &= !can_turn_about(checker);
    }

    /// Compares the measured velocity with what was told. A contact ends recovery, search and
    /// retreat.
    pub(crate) fn feel(&mut self, config: &Config, measured: Twist) -> Option<Contact> {
        let contact = self.contact.feel(config, measured)?;
        self.recovery.clear();
        self.search = None;
        if self.retreats {
            self.track.clear();
            self.retreats = false;
        }
        Some(contact)
    }

    /// Returns true during a search. Its poses are in the scratch memory, which must not change
    /// until the search ends.
    #[must_use]
    pub const fn is_searching(&self) -> bool {
        self.search.is_some()
    }

    /// Returns true if the last search found nothing and the next one has to wait.
    #[must_use]
    pub(crate) const fn is_resting(&self) -> bool {
        self.rest_steps > 0
    }

    /// Returns the velocity that follows the field's heading at the robot's place, for a robot with
    /// the velocity `now`; zero if no candidate is admissible, and during a search.
    ///
    /// `scratch` holds at least [`SCRATCH_WORDS`].
    pub fn follow<H: Fn(Place) -> Option<f32>>(
        &mut self,
        config: &Config,
        query: &mut SearchQuery<'_, H>,
        now: Twist,
        scratch: &mut [u32],
    ) -> Twist {
        self.rest_steps = self.rest_steps.saturating_sub(1);
        let checker = query.checker;
        query.lane = self.lane;
        let admits = |&twist: &Twist| checker.admits(twist, now, config, RECOVERY_MARGIN_M);
        let mut budget = SEARCH_BUDGET;
        let field = (query.heading_at)(Place::default());
        // Recovery and search count with robots where they were.
        if checker.has_company() && field.is_some_and(|it| is_open(config, it, now, checker)) {
            self.recovery.clear();
            self.search = None;
        }
        if self.search.is_none() {
            let planned = self.recovery.next(config.period_s);
            if let Some(twist) = planned.filter(admits) {
                return twist;
            }
            self.recovery.clear();
            let Some(field) = field else {
                return Twist::default();
            };
            if let Some(twist) = self.direct(config, field, now, query) {
                return twist;
            }
            if is_moving(now) || self.is_resting() {
                return Twist::default();
            }
            let first = MotionSet::of(config.period_s, |twist| admits(&twist));
            self.search = Some(Search::start(SEARCH_MARGINS_M[0], first, scratch));
            budget = FIRST_BUDGET;
        }
        self.continue_search(query, budget, scratch);
        // The planner does nothing else during a search. In open space, where only the slope holds
        // the robot, one search would follow the other.
        if self.search.is_none() && self.recovery.is_empty() && checker.bounds_headings() {
            self.rest_steps = REST_STEPS;
        }
        Twist::default()
    }

    /// Returns the first admissible velocity that needs no recovery: along the lane, if there is
    /// one, or else along the field's heading.
    fn direct<H: Fn(Place) -> Option<f32>>(
        &mut self,
        config: &Config,
        field: f32,
        now: Twist,
        query: &mut SearchQuery<'_, H>,
    ) -> Option<Twist> {
        let rolls = self.squeeze_steps == 0 && !query.checker.has_company();
        self.squeeze_steps = self.squeeze_steps.saturating_sub(1);
        self.lane = lane(config, field, now, query.checker);
        query.lane = self.lane;
        let in_lane = query.lane.and_then(|_| {
            let error = query.misalignment(Place::default())?;
            direct_candidate(config, error, now, query, rolls)
        });
        query.lane = None;
        let found = in_lane.or_else(|| direct_candidate(config, field, now, query, rolls));
        query.lane = self.lane;
        found
    }

    /// Turns on the spot to look around, as far as there is room: to one side, then to the other.
    pub(crate) fn look_around(
        &mut self,
        config: &Config,
        checker: &CollisionChecker,
        now: Twist,
    ) -> Twist {
        // A search is valid only for the pose in which it began.
        self.search = None;
        for _ in 0..2 {
            let turn = Twist {
                linear_mps: 0.0,
                angular_radps: if self.looks_right {
                    -LOOK_AROUND_RADPS
                } else {
                    LOOK_AROUND_RADPS
                },
            };
            if checker.admits(turn, now, config, CREEP_MARGIN_M) {
                return turn;
            }
            self.looks_right = !self.looks_right;
        }
        Twist::default()
    }

    /// Continues the search within `budget`, and begins the next attempt if this one fails.
    fn continue_search<H: Fn(Place) -> Option<f32>>(
        &mut self,
        query: &SearchQuery<'_, H>,
        budget: SearchBudget,
        scratch: &mut [u32],
    ) {
        let Some(search) = &mut self.search else {
            return;
        };
        match search.advance(query, budget, scratch) {
            SearchOutcome::Pending => {}
            SearchOutcome::Found(recovery) => {
                self.recovery = recovery;
                self.search = None;
            }
            SearchOutcome::Nothing => {
                let (margin_m, first) = (search.margin_m, search.first);
                let next = SEARCH_MARGINS_M.into_iter().find(|&next| next < margin_m);
                self.search = next.map(|next| Search::start(next, first, scratch));
                // On a slope that bounds the headings, the robot takes another heading instead.
                // What another robot closes will be open again.
                let may_wait = query.checker.bounds_headings() || query.checker.has_company();
                if next.is_none() && !may_wait {
                    self.wedged = self.squeeze_steps > 0 || !query.squeezes;
                    self.squeeze_steps = if self.wedged { 0 } else { SQUEEZE_STEPS };
                    self.retreats = self.wedged && !can_turn_about(query.checker);
                }
            }
        }
    }
}

impl Default for Drive {
    fn default() -> Self {
        Self::new()
    }
}

/// Returns true if the robot can follow the field's heading faster than it creeps.
fn is_open(config: &Config, field: f32, now: Twist, checker: &CollisionChecker) -> bool {
    ahead(config, field)
        .filter(|twist| twist.linear_mps > CREEP_MPS)
        .any(|twist| checker.admits(twist, now, config, MARGIN_M))
}

/// Returns the lane to follow, if there is one and the robot would creep ahead. Beside another
/// robot and on slopes that bound the headings there is none.
fn lane(config: &Config, field: f32, now: Twist, checker: &CollisionChecker) -> Option<Lane> {
    let is_free = !checker.has_company() && !checker.bounds_headings();
    let turns_first = field.abs() > TURN_FIRST_RAD;
    if !is_free || turns_first || is_open(config, field, now, checker) {
        return None;
    }
    let [_, least_m] = SEARCH_MARGINS_M;
    Lane::find(checker, field, least_m)
}

/// Returns true if there is room for half a turn on the spot, and so for every turn of a rectangle.
fn can_turn_about(checker: &CollisionChecker) -> bool {
    checker.is_arc_clear(Place::default(), 0.0, math::PI, CREEP_MARGIN_M)
}

fn is_moving(now: Twist) -> bool {
    now.linear_mps.abs() > STANDING_MPS || now.angular_radps.abs() > STANDING_RADPS
}

/// Returns the first admissible velocity that needs no recovery: ahead (at creeping speed only if
/// the robot can roll on, where `rolls` asks for it), a turn on the spot, straight back, or a turn
/// of the robot's back towards the heading on a slope too steep to turn
/// fully.
fn direct_candidate<H: Fn(Place) -> Option<f32>>(
    config: &Config,
    error: f32,
    now: Twist,
    query: &SearchQuery<'_, H>,
    rolls: bool,
) -> Option<Twist> {
    let checker = query.checker;
    let admits = |&twist: &Twist| {
        let creeps = twist.linear_mps.abs() <= CREEP_MPS;
        let margin_m = if creeps { CREEP_MARGIN_M } else { MARGIN_M };
        checker.admits(twist, now, config, margin_m)
    };
    // A turn that the robot cannot finish would wedge it.
    let can_turn = |turn| checker.is_arc_clear(Place::default(), 0.0, turn, CREEP_MARGIN_M);
    let turn = |error| turns(config, error).into_iter().flatten().find(admits);
    let opposite = math::wrap(error + math::PI);
    // A gap that the robot cannot follow the field through would wedge it.
    let may_go_on = |&twist: &Twist| {
        !rolls || twist.linear_mps > CREEP_MPS || {
            let [_, least_m] = SEARCH_MARGINS_M;
            roll_out(query, Place::default(), false, least_m, &mut 0).is_some()
        }
    };
    let wish = ahead(config, error).find(admits);
    wish.filter(may_go_on)
        .or_else(|| turn(error).filter(|_| can_turn(error)))
        .or_else(|| back(opposite).filter(admits))
        .or_else(|| {
            let turns_back = checker.is_steep() && can_turn(opposite);
            turns_back.then(|| turn(opposite)).flatten()
        })
}

/// Returns the velocity straight back, if `opposite`, the error of the robot's back, is small.
fn back(opposite: f32) -> Option<Twist> {
    (opposite.abs() < REVERSE_RAD).then_some(Twist {
        linear_mps: -CREEP_MPS,
        angular_radps: REVERSE_GAIN * opposite,
    })
}

/// Returns the candidates ahead, the wish first; none if the robot has to turn first.
fn ahead(config: &Config, error: f32) -> impl Iterator<Item = Twist> {
    let wish_radps = turn_rate(config, error);
    let (_, cos) = math::sin_cos(error);
    let wish_mps = if error.abs() > TURN_FIRST_RAD {
        0.0
    } else {
        config.max_linear_mps * cos * cos
    };
    let most = config.max_angular_radps;
    let speeds = SPEED_PARTS.into_iter().filter(move |_| wish_mps > 0.0);
    speeds.flat_map(move |part| {
        TURN_OFFSETS_RADPS.map(|offset| Twist {
            linear_mps: wish_mps * part,
            angular_radps: (wish_radps + offset).clamp(-most, most),
        })
    })
}

/// Returns the turns on the spot towards the heading, the quick one first; none if it is aligned.
fn turns(config: &Config, error: f32) -> Option<[Twist; 2]> {
    let quick = turn_rate(config, error);
    (error.abs() > ALIGNED_RAD).then(|| {
        [quick, SLOW_TURN_PART * quick].map(|angular_radps| Twist {
            linear_mps: 0.0,
            angular_radps,
        })
    })
}

fn turn_rate(config: &Config, error: f32) -> f32 {
    let most = TURN_PART * config.max_angular_radps;
    (TURN_GAIN * error).clamp(-most, most)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point, Pose};
    use crate::robot::RobotShape;

    /// Returns the speed of a robot that has a recovery backwards and free ground ahead, with
    /// another robot 2 m beside it.
    fn speed_mps(peer_may_move: bool) -> f32 {
        let config = Config::pioneer_3at(heapless::Vec::new());
        let mut checker = CollisionChecker::empty(&RobotShape::PIONEER_3AT);
        let beside = Point { x_m: 0.0, y_m: 2.0 };
        checker.keep_off_hull(&Pose::default(), core::iter::once(beside), peer_may_move);
        let mut query = SearchQuery::new(&checker, |_: Place| Some(0.0), None);
        let mut drive = Drive::new();
        for _ in 0..8 {
            drive
                .recovery
                .motions
                .push(motion::BACKWARD)
                .expect("there is room");
        }
        let mut scratch = std::vec![0; SCRATCH_WORDS];
        drive
            .follow(&config, &mut query, Twist::default(), &mut scratch)
            .linear_mps
    }

    #[test]
    fn a_recovery_ends_when_a_robot_that_drives_on_has_left_the_way_open() {
        assert!(speed_mps(true) > CREEP_MPS);
        assert!(speed_mps(false) < 0.0, "walls do not leave");
    }
}

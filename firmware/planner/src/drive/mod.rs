//! From the field's heading to a velocity of a skid-steer robot that touches nothing.
//!
//! The wish is to turn towards the heading at the rate `k·error` and to drive forward at
//! `v_max·cos²(error)`. A candidate (v, ω) is admissible if the robot's rectangle stays clear of
//! every obstacle point while the robot follows the candidate for one period and then brakes to a
//! stop, from its measured velocity and within its acceleration limits. The drive takes the first
//! admissible candidate, in order of distance from the wish. If there is none, the robot turns on
//! the spot or drives straight back. If it cannot, a recovery leads out. If none is found either,
//! the robot is *wedged*. A passage that is blocked, for this or another reason, is left backwards
//! along the robot's own track, to a place where it can turn, or, if no path is left, to where one
//! leads on. Where it cannot drive faster than it creeps, a *lane* takes the place of the field's
//! heading.
//!
//! Invariant: after every commanded velocity a stop is possible that touches nothing known, so the
//! zero command is always safe.
//!
//! Units: metres, seconds, radians; robot frame, x forward.

mod collision;
pub(crate) mod contact;
mod dead_ends;
mod direct;
mod hull;
mod incline;
mod lane;
mod motion;
mod open_list;
mod recovery;
mod retreat;
mod roll_out;
mod search_query;
pub(crate) mod side_slope;
pub(crate) mod track;

pub use collision::CollisionChecker;
pub use hull::Place;
pub(crate) use incline::Incline;
pub use recovery::SCRATCH_WORDS;
pub use search_query::SearchQuery;

use crate::config::Config;
use crate::geometry::{MapFromOdom, MapPose, Point, Twist};
use collision::LEAST_MARGIN_M;
use contact::{Contact, ContactSense};
use direct::CREEP_MARGIN_M;
use lane::Lane;
use motion::{MotionSet, Recovery};
use recovery::{Search, SearchBudget, SearchOutcome};
use track::Track;

/// Clearances of a recovery, metres: that of the first search, and of the next one. The next one is
/// hardly more than what the robot keeps while it drives the recovery.
const SEARCH_MARGINS_M: [f32; 2] = [0.03, 0.02];
/// The only clearance while something else is left to explore, metres. A gap with less may let the
/// robot in and not out again (measured: docs/MEASURED.md, "Clearance while something else is
/// left").
const CAREFUL_MARGINS_M: [f32; 1] = [0.05];

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
/// only when nothing else is left to explore, because the gap may not let it out again (measured:
/// docs/MEASURED.md, "When a robot creeps on").
const SQUEEZE_STEPS: u8 = 30;
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
    pub(crate) fn note_pose(&mut self, MapPose(pose): &MapPose) {
        if !self.retreats {
            self.track.record(pose);
        }
    }

    /// Returns the robot's track.
    pub(crate) const fn track(&self) -> &Track {
        &self.track
    }

    /// Takes over the track of a robot that came where this one is.
    pub(crate) const fn came_along(&mut self, track: Track) {
        self.track = track;
    }

    /// Goes on after a correction of the map: the track moves with the robot, and what was begun in
    /// the old map ends.
    pub(crate) fn correct(&mut self, motion: &MapFromOdom) {
        self.track.correct(motion);
        self.recovery.clear();
        (self.search, self.lane) = (None, None);
        (self.retreats, self.wedged) = (false, false);
    }

    /// Returns true while the robot drives motions that a search found.
    pub(crate) fn is_recovering(&self) -> bool {
        !self.recovery.is_empty()
    }

    /// Returns true while the robot goes back along its track.
    pub(crate) const fn is_retreating(&self) -> bool {
        self.retreats
    }

    /// Returns true once for each time that the robot was wedged.
    pub(crate) const fn take_wedged(&mut self) -> bool {
        core::mem::replace(&mut self.wedged, false)
    }

    /// Returns true if the robot's track leads past a point of the map, by no more than so many
    /// metres.
    pub(crate) fn came_past(&self, point: Point, within_m: f32) -> bool {
        self.track.passes(point, within_m)
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
        let admits = |&twist: &Twist| checker.admits(twist, now, config, LEAST_MARGIN_M);
        let mut budget = SEARCH_BUDGET;
        let field = (query.heading_at)(Place::default());
        // Recovery and search count with robots where they were.
        if checker.has_company()
            && field.is_some_and(|it| direct::is_open(config, it, now, checker))
        {
            self.recovery.clear();
            self.search = None;
        }
        if self.search.is_none() {
            let ahead = || direct::straight(config, now, checker);
            if let Some(twist) = query.is_surrounded.then(ahead).flatten() {
                return twist;
            }
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
            let margin_m = query.margins_m().first().copied().unwrap_or_default();
            self.search = Some(Search::start(margin_m, first, scratch));
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
        let margin = (query.checker, query.least_margin_m());
        self.lane = direct::lane(config, field, now, margin);
        query.lane = self.lane;
        let in_lane = query.lane.and_then(|_| {
            let error = query.misalignment(Place::default())?;
            direct::velocity(config, error, now, query, rolls)
        });
        query.lane = None;
        let found = in_lane.or_else(|| direct::velocity(config, field, now, query, rolls));
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
                let mut margins_m = query.margins_m().iter();
                let next = margins_m.find(|&&next| next < margin_m);
                self.search = next.map(|&next| Search::start(next, first, scratch));
                // On a slope that bounds the headings, the robot takes another heading instead.
                if next.is_none() && !query.checker.bounds_headings() {
                    let squeezes = query.squeezes && !query.checker.has_company();
                    self.wedged = self.squeeze_steps > 0 || !squeezes;
                    self.squeeze_steps = if self.wedged { 0 } else { SQUEEZE_STEPS };
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

fn is_moving(now: Twist) -> bool {
    now.linear_mps.abs() > STANDING_MPS || now.angular_radps.abs() > STANDING_RADPS
}

#[cfg(test)]
mod tests;

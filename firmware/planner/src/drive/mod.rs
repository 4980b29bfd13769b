//! From the field's heading to a velocity of a skid-steer robot that touches nothing.
//!
//! The wish is: turn towards the heading with rate `k·error`, go forward with `v_max·cos²(error)`. The wish is then tried
//! against the near field: a candidate (v, ω) is admissible if the robot's rectangle stays clear of every point while the
//! robot, from its measured velocity and within its acceleration limits, follows the candidate for one period and then
//! brakes to a stop. The first admissible one, in order of distance from the wish, is driven; where none is, the robot
//! turns on the spot, and where it cannot, a [`manoeuvre`] leads out.
//!
//! Invariant: whatever is driven can be followed by a stop that touches nothing known, so the zero command is always safe.
//! Units: metres, seconds, radians; robot frame, x forward.

pub mod collision;
pub mod incline;
mod motion;
mod open_list;
pub mod recovery;
mod search_query;
pub mod side_slope;

pub use collision::{CollisionChecker, Place};
pub use incline::Incline;
pub use recovery::{Attempt, Budget, Choice, Found, Ground, Leads, Plan, Search};

use crate::config::Config;
use crate::geometry::Twist;
use crate::math;

/// Clearance kept at speed, metres: three sigma of a range and one of the odometry between two scans.
const MARGIN_M: f32 = 0.06;
/// Clearance kept when creeping through a narrow place, metres: two sigma of a range.
const CREEP_MARGIN_M: f32 = 0.025;
/// What is asked of a manoeuvre, less and less. The nearest of many points of a wall is two sigma nearer than the wall, so there
/// is more room than the narrower clearance says; the last attempt only wants the robot to stand elsewhere.
const ATTEMPTS: [Attempt; 3] = [
    Attempt {
        margin_m: 0.03,
        leads: Leads::Farther,
    },
    Attempt {
        margin_m: 0.012,
        leads: Leads::Farther,
    },
    Attempt {
        margin_m: 0.012,
        leads: Leads::Elsewhere,
    },
];
/// Clearance kept while a manoeuvre is driven, metres.
const PLAN_KEPT_M: f32 = 0.008;
/// Speed at and below which the robot creeps, metres a second.
const CREEP_MPS: f32 = 0.15;
/// Turn rate wished for a radian of error, 1/s.
const TURN_GAIN: f32 = 2.0;
/// Beyond this error the robot turns on the spot, radians.
const TURN_FIRST_RAD: f32 = 0.9;
/// An error smaller than this is none, radians.
const ALIGNED_RAD: f32 = 0.12;

/// Turn rate of a robot that looks around, radians a second.
const LOOK_AROUND_RADPS: f32 = 0.6;

/// Instalment of a search: what a step may look at.
const SEARCH_BUDGET: Budget = Budget {
    poses: 250,
    points: 60_000,
};
/// The first instalment: in its step a field was solved as well.
const FIRST_BUDGET: Budget = Budget {
    poses: SEARCH_BUDGET.poses / 3,
    points: SEARCH_BUDGET.points / 3,
};
/// Steps between a search that found nothing and the next, on ground that inclines: some two skeletons.
const REST_STEPS: u8 = 20;
/// Speed backwards where there is no room to turn, metres a second.
const REVERSE_MPS: f32 = 0.15;
/// An error this near to half a turn can be driven backwards, radians.
const REVERSE_RAD: f32 = 0.35;

/// What the drive remembers: the manoeuvre in progress, or the search for one.
#[derive(Debug, Default)]
pub struct Drive {
    plan: Plan,
    search: Option<Search>,
    /// To which side it looks around.
    looks_right: bool,
    /// Steps until the next search may begin, where one found nothing.
    rest: u8,
}

impl Drive {
    /// At rest.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            plan: Plan::new(),
            search: None,
            looks_right: false,
            rest: 0,
        }
    }

    /// Whether a search is going on: its poses are in the scratch, which nobody else may use until it is over.
    #[must_use]
    pub const fn is_searching(&self) -> bool {
        self.search.is_some()
    }

    /// Whether the last search found nothing, and the next one has to wait.
    #[must_use]
    pub const fn is_resting(&self) -> bool {
        self.rest > 0
    }

    /// The velocity for the heading that the field has at the robot's place, from the velocity `now`; zero where nothing is
    /// admissible, and while a search goes on.
    pub fn follow<H: Fn(Place) -> Option<f32>>(
        &mut self,
        config: &Config,
        ground: &Ground<'_, H>,
        now: Twist,
        scratch: &mut [u32],
    ) -> Twist {
        self.rest = self.rest.saturating_sub(1);
        let surround = ground.surround;
        let mut budget = SEARCH_BUDGET;
        if self.search.is_none() {
            let planned = self.plan.next(config.period_s);
            if let Some(twist) = planned.filter(|&t| surround.admits(t, now, config, PLAN_KEPT_M)) {
                return twist;
            }
            self.plan.clear();
            let Some(error) = (ground.heading_at)(Place::default()) else {
                return Twist::default();
            };
            if let Some(twist) = directly(config, error, now, surround) {
                return twist;
            }
            if is_moving(now) || self.is_resting() {
                return Twist::default();
            }
            let first = Choice::of(config.period_s, |twist| {
                surround.admits(twist, now, config, PLAN_KEPT_M)
            });
            self.search = Some(Search::start(ATTEMPTS[0], first, scratch));
            budget = FIRST_BUDGET;
        }
        self.go_on_searching(ground, budget, scratch);
        // Nothing else is planned while a search goes on, and in the open, held by the slope only, one would follow the other.
        if self.search.is_none() && self.plan.is_empty() && surround.inclines() {
            self.rest = REST_STEPS;
        }
        Twist::default()
    }

    /// Turn on the spot to see what is around, as far as there is room, to one side and then to the other.
    pub fn look_around(
        &mut self,
        config: &Config,
        surround: &CollisionChecker,
        now: Twist,
    ) -> Twist {
        // A search is for where the robot stands.
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
            if surround.admits(turn, now, config, CREEP_MARGIN_M) {
                return turn;
            }
            self.looks_right = !self.looks_right;
        }
        Twist::default()
    }

    fn go_on_searching<H: Fn(Place) -> Option<f32>>(
        &mut self,
        ground: &Ground<'_, H>,
        budget: Budget,
        scratch: &mut [u32],
    ) {
        let Some(search) = &mut self.search else {
            return;
        };
        match search.advance(ground, budget, scratch) {
            Found::Pending => {}
            Found::Plan(plan) => {
                self.plan = plan;
                self.search = None;
            }
            Found::Nothing => {
                let tried = ATTEMPTS
                    .iter()
                    .position(|&attempt| attempt == search.attempt());
                let next = tried.and_then(|tried| ATTEMPTS.get(tried + 1));
                let first = search.first();
                self.search = next.map(|&attempt| Search::start(attempt, first, scratch));
            }
        }
    }
}

fn is_moving(now: Twist) -> bool {
    now.linear_mps.abs() > 0.02 || now.angular_radps.abs() > 0.05
}

/// What needs no manoeuvre: ahead, turning on the spot, or straight back.
fn directly(config: &Config, error: f32, now: Twist, surround: &CollisionChecker) -> Option<Twist> {
    let admits = |&twist: &Twist| {
        let creeps = twist.linear_mps.abs() <= CREEP_MPS;
        surround.admits(
            twist,
            now,
            config,
            if creeps { CREEP_MARGIN_M } else { MARGIN_M },
        )
    };
    let ahead = ahead(config, error).into_iter().flatten().find(admits);
    // A turn that could not be finished would wedge the robot.
    let turnable = || surround.is_arc_clear(Place::default(), 0.0, error, CREEP_MARGIN_M);
    ahead
        .or_else(|| {
            turns(config, error)
                .into_iter()
                .flatten()
                .find(admits)
                .filter(|_| turnable())
        })
        .or_else(|| back(error).filter(admits))
        .or_else(|| {
            turns_away(config, error, surround)
                .into_iter()
                .flatten()
                .find(admits)
        })
}

/// Turns that bring its back to where the robot goes, on a slope that it may not turn round on.
fn turns_away(config: &Config, error: f32, surround: &CollisionChecker) -> [Option<Twist>; 2] {
    let askew = math::wrap(error + math::PI);
    if surround.is_steep() && surround.is_arc_clear(Place::default(), 0.0, askew, CREEP_MARGIN_M) {
        turns(config, askew)
    } else {
        [None; 2]
    }
}

/// Straight back, where the heading is behind.
fn back(error: f32) -> Option<Twist> {
    let askew = math::wrap(error + math::PI);
    (askew.abs() < REVERSE_RAD).then_some(Twist {
        linear_mps: -REVERSE_MPS,
        angular_radps: 0.5 * askew,
    })
}

/// Ways forward, the wish first.
fn ahead(config: &Config, error: f32) -> [Option<Twist>; 15] {
    let wish_w = turn_rate(config, error);
    let (_, cos) = math::sin_cos(error);
    let wish_v = if error.abs() > TURN_FIRST_RAD {
        0.0
    } else {
        config.max_linear_mps * cos * cos
    };
    core::array::from_fn(|i| {
        let part = [1.0, 0.5, 0.2].get(i / 5).copied().unwrap_or(0.0);
        let offset = [0.0, 0.25, -0.25, 0.6, -0.6]
            .get(i % 5)
            .copied()
            .unwrap_or(0.0);
        let most = config.max_angular_radps;
        (wish_v > 0.0).then(|| Twist {
            linear_mps: wish_v * part,
            angular_radps: (wish_w + offset).clamp(-most, most),
        })
    })
}

/// Turns on the spot towards the heading, the quick one first.
fn turns(config: &Config, error: f32) -> [Option<Twist>; 2] {
    let quick = turn_rate(config, error);
    [quick, 0.4 * quick].map(|angular_radps| {
        (error.abs() > ALIGNED_RAD).then_some(Twist {
            linear_mps: 0.0,
            angular_radps,
        })
    })
}

fn turn_rate(config: &Config, error: f32) -> f32 {
    let most = 0.6 * config.max_angular_radps;
    (TURN_GAIN * error).clamp(-most, most)
}

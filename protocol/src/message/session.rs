//! The parameters of a session, and the requests that change its state.
//!
//! Units: metres, radians, seconds.

use fixed::types::{I4F12, I16F16};
use heapless::Vec;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

#[cfg(doc)]
use super::{Identity, MAX_BEAMS, Status};
use super::{MAX_SCANS, Team};

/// Mounting and sweep of a laser.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Laser {
    /// Metres ahead of the robot's centre.
    pub x: I4F12,
    /// Metres to the left of the robot's centre.
    pub y: I4F12,
    /// Metres above the ground.
    pub z: I4F12,
    /// Radians; positive looks down.
    pub pitch: I4F12,
    /// Bearing of the first beam, radians; negative is to the right.
    pub first_bearing: I16F16,
    /// Angle from one beam to the next, radians.
    pub bearing_step: I16F16,
    /// Number of beams in a sweep, at most [`MAX_BEAMS`].
    pub beams: u16,
    /// Range limit, millimetres: the laser reports nothing beyond it.
    pub range_limit_mm: u16,
    /// Time from the first beam to the last one, milliseconds: at most 500, and 0 if all beams are
    /// of one instant or the laser looks down. The device moves the beams to the instant of the
    /// newest one, for which the observation's pose stands.
    pub turn_time_ms: u16,
    /// True if the first beam is the newest, false if it is the oldest.
    pub newest_first: bool,
}

/// The strategy that plans.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Strategy {
    /// Drive to one unexplored centre cell after the other.
    #[default]
    Frontier,
    /// Drive to one unexplored centre cell after the other, and close loops on the way.
    Ouroboros,
    /// Follow rails by the time of their last visit, and patrol on them.
    Tdbvp {
        /// Duration of the patrol after everything is explored, seconds. The status stays
        /// [`Status::Exploring`] until it ends.
        patrol_s: u16,
        /// Time without a new place after which the robot follows a path to what is left to
        /// explore, seconds; `None` for never.
        impatience_s: Option<u16>,
    },
    /// Follow a space-based potential field over an area of known size.
    Sbpf(SpaceField),
    /// The same field with gates and conveyor belts.
    Esbpf(SpaceField),
}

/// Parameters of a space-based potential field.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct SpaceField {
    /// Least x and y of the area, metres.
    pub origin: (I16F16, I16F16),
    /// Width and height of the area, metres.
    pub size: (I16F16, I16F16),
    /// Coverage that ends the exploration, thousandths of the area.
    pub until_permille: u16,
    /// Time without a newly covered cell after which the robot follows a path to the nearest
    /// frontier, seconds; `None` for never.
    pub impatience_s: Option<u16>,
}

impl Strategy {
    /// Returns the strategy's own order of frontiers: by gain for [`Strategy::Frontier`], the
    /// nearest first, as in the papers, for the others.
    #[must_use]
    pub fn order(self) -> Order {
        match self {
            Self::Frontier => Order::default(),
            Self::Ouroboros | Self::Tdbvp { .. } => Order::Nearest {
                worth: I4F12::lit("0.25"),
            },
            Self::Sbpf(_) | Self::Esbpf(_) => Order::Nearest { worth: I4F12::ZERO },
        }
    }
}

/// The order in which frontiers are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Order {
    /// First the frontier of the greatest gain for its cost.
    Gain {
        /// Least gain of a trip, square metres for each metre of way: 0 to 7. What is not worth the
        /// trip is left; 0 leaves nothing. Default: 0.25.
        worth: I4F12,
    },
    /// First the nearest frontier.
    Nearest {
        /// As for [`Gain`](Self::Gain).
        worth: I4F12,
    },
}

impl Order {
    /// Returns the least gain of a trip, square metres for each metre of way.
    #[must_use]
    pub const fn worth(self) -> I4F12 {
        match self {
            Self::Gain { worth } | Self::Nearest { worth } => worth,
        }
    }
}

impl Default for Order {
    fn default() -> Self {
        Self::Gain {
            worth: I4F12::lit("0.25"),
        }
    }
}

/// The preferences that shape the field on uneven ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Preference {
    /// No preference.
    Off,
    /// Prefer ground at the robot's own height.
    Height,
    /// One preference for the whole window; it grows as the field becomes flat.
    Global,
    /// Both preferences.
    #[default]
    Both,
}

/// Parameters of uneven ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct UnevenGround {
    /// The preferences in use.
    pub preference: Preference,
    /// True if goals on other height levels cost more; independent of the preferences.
    pub levels: bool,
    /// Height above the surrounding ground from which a cell is an obstacle, metres.
    pub obstacle: I4F12,
    /// Distance within which a return of the level laser over unmeasured ground is an obstacle,
    /// metres.
    pub near: I4F12,
    /// Height below the neighbouring ground from which a return is the inside of a hole and not
    /// ground, metres; negative.
    pub hole: I4F12,
    /// Least preference, −2 to 0.
    pub least: I4F12,
    /// Greatest preference, 0 to 2.
    pub most: I4F12,
    /// Preference lost per metre of height, at least 0.
    pub height_scale: I4F12,
    /// Scale of the global preference, at least 0: the preference gained each time that the field's
    /// steepness falls by a factor e.
    pub global_scale: I16F16,
    /// Steepest slope that the robot may drive up or down, radians.
    pub climb: I4F12,
    /// Steepest slope that the robot may drive across, radians. A value equal to `climb` sets no
    /// limit.
    pub roll: I4F12,
    /// Highest edge that the robot may drive over, metres.
    pub step: I4F12,
}

/// The robot's hull: a box over a rectangle whose middle is the robot's centre. Default: a Pioneer
/// 3-AT.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Hull {
    /// Length along the heading, millimetres: 1 to 4000.
    pub length_mm: u16,
    /// Width over the wheels, millimetres: 1 to 4000.
    pub width_mm: u16,
    /// Height of the top above the ground, millimetres: at most 2000.
    pub height_mm: u16,
}

impl Default for Hull {
    fn default() -> Self {
        Self {
            length_mm: 508,
            width_mm: 497,
            height_mm: 277,
        }
    }
}

/// Limits of the loops that strategy Ouroboros closes, metres of path; all at least 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct LoopLimits {
    /// Least length of a loop. Default: 20.
    pub least: I16F16,
    /// Greatest length of a loop when nothing else is left to explore. Default: 120.
    pub most: I16F16,
    /// Metres by which the greatest length grows with each metre of frontier that is left.
    /// Default: 10.
    pub most_per_frontier: I16F16,
    /// Ratio of the way that the robot may drive to the greatest expected length. Default: 2.
    pub detour: I16F16,
    /// Metres that the robot may drive beyond that. Default: 20.
    pub slack: I16F16,
}

impl Default for LoopLimits {
    fn default() -> Self {
        Self {
            least: I16F16::lit("20"),
            most: I16F16::lit("120"),
            most_per_frontier: I16F16::lit("10"),
            detour: I16F16::lit("2"),
            slack: I16F16::lit("20"),
        }
    }
}

/// Maximum number of corners of all polygons of a fence.
pub const FENCE_CORNERS: usize = 32;
/// Maximum number of polygons of a fence.
pub const FENCE_POLYGONS: usize = FENCE_CORNERS / 3;

/// A polygon of a fence.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct FencePolygon {
    /// Number of its corners in [`Fence::corners`], after those of the polygons before it; at least
    /// 3.
    pub corners: u8,
    /// True if the robot stays inside, false if it stays out.
    pub bounds: bool,
}

/// Where the robot may be: inside of all bounds, and out of all other polygons. A polygon is
/// simple; its corners go round in either direction.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Fence {
    /// The corners of one polygon after the other: x and y in the odometry's coordinates, in a team
    /// in the team's, metres.
    pub corners: Vec<(I16F16, I16F16), FENCE_CORNERS>,
    /// The polygons; without any, the robot may be everywhere.
    pub polygons: Vec<FencePolygon, FENCE_POLYGONS>,
}

/// What the robot may drive. When the way home takes as much as is left, the robot drives home by
/// itself: the status is [`Status::Going`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Budget {
    /// Metres; `None` for any.
    pub range_m: Option<u16>,
    /// Seconds; `None` for any.
    pub time_s: Option<u16>,
}

/// The parameters of a session.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Start {
    /// The strategy that plans.
    pub strategy: Strategy,
    /// The laser scanners.
    pub lasers: Vec<Laser, MAX_SCANS>,
    /// The robot's hull.
    pub hull: Hull,
    /// Radius around the robot's centre that the planner keeps clear, millimetres: 50 to 600.
    pub robot_radius_mm: u16,
    /// Maximum speed, metres per second.
    pub max_linear: I4F12,
    /// Maximum turn rate, radians per second.
    pub max_angular: I4F12,
    /// Acceleration and braking that the robot always reaches, metres per second squared.
    pub linear_accel: I4F12,
    /// Angular acceleration and braking that the robot always reaches, radians per second squared.
    pub angular_accel: I4F12,
    /// Time from one observation to the next, milliseconds: 100 to 400. The robot drives a command
    /// for this long.
    pub period_ms: u16,
    /// Parameters of uneven ground: the planner measures heights, avoids holes and edges, and
    /// prefers level ground. `None` means flat ground, where lasers see only what stands on it.
    pub uneven_ground: Option<UnevenGround>,
    /// Limits of loops, for [`Strategy::Ouroboros`].
    pub loops: LoopLimits,
    /// The order in which frontiers are taken.
    pub order: Order,
    /// The robot's place in a team; `None` for a robot alone.
    pub team: Option<Team>,
    /// True if the device corrects odometry by the level scan. False takes odometry for the pose.
    pub localise: bool,
    /// True if the device only localises and maps. It plans nothing, every velocity is zero, and
    /// the status stays [`Status::Exploring`].
    pub survey: bool,
    /// Where the robot may be. What lies elsewhere is mapped and not explored.
    pub fence: Fence,
    /// What the robot may drive before it must be home.
    pub budget: Budget,
}

/// A change of the session's state.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
#[allow(
    clippy::large_enum_variant,
    reason = "no heap to box into; one lives at a time"
)]
pub enum Control {
    /// Forget the map and start a new session.
    Start(Start),
    /// Stand still until resumed.
    Pause,
    /// Continue after a pause or an emergency stop.
    Resume,
    /// End the session. The map stays readable.
    Stop,
    /// Reboot the device.
    Reset,
    /// Drive to the pose at which the session began, with its heading. The session need not have
    /// ended: its exploration goes on with [`Control::Explore`].
    Home,
    /// Drive to a point in the map's coordinates.
    GoTo {
        /// Metres.
        x: I16F16,
        /// Metres.
        y: I16F16,
    },
    /// Go on exploring.
    Explore,
    /// Home is this pose of the map, whatever the first scan's is. A device that was reset is told
    /// so where its session truly began.
    SetHome {
        /// Metres.
        x: I16F16,
        /// Metres.
        y: I16F16,
        /// Radians.
        yaw: I16F16,
    },
}

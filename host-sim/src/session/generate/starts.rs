//! Parameters of sessions: any that a device permits, or those of an ordinary Pioneer 3-AT.

use std::sync::OnceLock;

use fieldline_protocol::message::{
    Hull, Laser, LoopLimits, MAX_BEAMS, Member, NO_RETURN_MM, Order, Preference, SpaceField, Start,
    Strategy, Team, UnevenGround,
};
use fixed::types::{I4F12, I16F16};

use super::fences;
use super::quantities::{angle, narrow, narrow_within, wide, wide_within};
use crate::session::choices::Choices;
use crate::sim::{SimConfig, Simulator};
use crate::trial::uneven::TABLE_I;
use crate::world::World;

/// Draws parameters that the device permits; rarely, some that it refuses.
pub(super) fn any(choices: &mut impl Choices) -> Start {
    let is_uneven = choices.once_in(3);
    let lasers = match choices.below(30) {
        29 => 0,
        _ if is_uneven => 2,
        _ => 1 + choices.below(2),
    };
    let mut start = Start {
        strategy: strategy(choices),
        lasers: (0..lasers).map(|k| laser(choices, k == 0)).collect(),
        hull: hull(choices),
        robot_radius_mm: choices.between(50, 600) as u16,
        max_linear: narrow(choices).max(I4F12::DELTA),
        max_angular: narrow(choices).max(I4F12::DELTA),
        linear_accel: I4F12::MAX,
        angular_accel: I4F12::MAX,
        period_ms: choices.between(100, 400) as u16,
        uneven_ground: is_uneven.then(|| uneven(choices)),
        loops: loops(choices),
        order: order(choices),
        team: choices.once_in(2).then(|| team(choices)),
        localise: choices.once_in(2),
        survey: choices.once_in(12),
        fence: fences::fence(choices),
        budget: fences::budget(choices),
    };
    start.linear_accel = acceleration(choices, start.max_linear);
    start.angular_accel = acceleration(choices, start.max_angular);
    if choices.once_in(30) {
        start.robot_radius_mm = choices.bits(16) as u16;
        start.max_linear = narrow(choices);
    }
    start
}

/// Draws an acceleration that stops the robot within three seconds.
fn acceleration(choices: &mut impl Choices, speed: I4F12) -> I4F12 {
    let least = i64::from(speed.to_bits()) / 3 + 1;
    narrow_within(choices, least, i64::from(i16::MAX))
}

/// Draws the parameters of a Pioneer 3-AT with any strategy, ground, team and order.
pub(super) fn pioneer(choices: &mut impl Choices) -> Start {
    let strategy = match strategy(choices) {
        Strategy::Sbpf(field) => Strategy::Sbpf(around(field)),
        Strategy::Esbpf(field) => Strategy::Esbpf(around(field)),
        other => other,
    };
    let mut start = announced().clone();
    start.strategy = strategy;
    start.order = strategy.order();
    if choices.once_in(3) {
        start.order = order(choices);
    }
    start.localise = choices.once_in(2);
    start.survey = choices.once_in(12);
    start.uneven_ground = choices.once_in(3).then_some(TABLE_I);
    start.team = choices.once_in(2).then(|| ordinary_team(choices));
    start.fence = fences::fence(choices);
    start.budget = fences::budget(choices);
    start
}

/// An area of a usual size around the start.
fn around(field: SpaceField) -> SpaceField {
    SpaceField {
        origin: (I16F16::lit("-10"), I16F16::lit("-10")),
        size: (I16F16::lit("40"), I16F16::lit("40")),
        ..field
    }
}

/// The start message of the simulated robot.
fn announced() -> &'static Start {
    static START: OnceLock<Start> = OnceLock::new();
    START.get_or_init(|| {
        let world = World::builtin("partition");
        let robot = world
            .as_ref()
            .and_then(|world| Simulator::new(world, SimConfig::default()).ok());
        robot.map_or_else(Start::default, |robot| {
            robot.start_message(Strategy::Frontier)
        })
    })
}

/// Draws a place in a team whose coordinates are the robot's own.
fn ordinary_team(choices: &mut impl Choices) -> Team {
    Team {
        member: Member {
            id: choices.below(8) as u8,
            boot: 1,
        },
        sd_mm: if choices.once_in(2) { 300 } else { 0 },
        sd_mrad: if choices.once_in(2) { 90 } else { 0 },
        ..Team::default()
    }
}

fn team(choices: &mut impl Choices) -> Team {
    let near = !choices.once_in(3);
    let offset = |choices: &mut _| if near { I16F16::ZERO } else { wide(choices) };
    Team {
        member: Member {
            id: if choices.once_in(4) {
                choices.bits(8) as u8
            } else {
                choices.below(8) as u8
            },
            boot: choices.bits(16) as u16,
        },
        origin: (offset(choices), offset(choices)),
        yaw: offset(choices),
        sd_mm: if choices.once_in(2) {
            choices.bits(16) as u16
        } else {
            0
        },
        sd_mrad: if choices.once_in(2) {
            choices.bits(16) as u16
        } else {
            0
        },
    }
}

fn seconds(choices: &mut impl Choices) -> Option<u16> {
    match choices.below(4) {
        0 | 1 => None,
        2 => Some(choices.below(20) as u16),
        _ => Some(choices.bits(16) as u16),
    }
}

fn space(choices: &mut impl Choices) -> SpaceField {
    let mut corner = || I16F16::from_num(choices.between(-60, 5));
    let origin = (corner(), corner());
    let mut side = || wide_within(choices, 6_554, 128 << 16);
    SpaceField {
        origin,
        size: (side(), side()),
        until_permille: 1 + choices.below(1_000) as u16,
        impatience_s: seconds(choices),
    }
}

fn strategy(choices: &mut impl Choices) -> Strategy {
    match choices.below(5) {
        0 => Strategy::Frontier,
        1 => Strategy::Ouroboros,
        2 => Strategy::Tdbvp {
            patrol_s: if choices.once_in(2) {
                choices.bits(16) as u16
            } else {
                0
            },
            impatience_s: seconds(choices),
        },
        3 => Strategy::Sbpf(space(choices)),
        _ => Strategy::Esbpf(space(choices)),
    }
}

fn uneven(choices: &mut impl Choices) -> UnevenGround {
    let preferences = [
        Preference::Off,
        Preference::Height,
        Preference::Global,
        Preference::Both,
    ];
    UnevenGround {
        preference: choices.pick(&preferences),
        levels: choices.once_in(2),
        obstacle: narrow_within(choices, 1, 28_000),
        near: narrow_within(choices, 1, 28_000),
        hole: narrow_within(choices, -28_000, -1),
        least: narrow_within(choices, -8_192, 0),
        most: narrow_within(choices, 0, 8_192),
        height_scale: narrow_within(choices, 0, i64::from(i16::MAX)),
        global_scale: wide_within(choices, 0, i64::from(i32::MAX)),
        climb: narrow_within(choices, 1, 3_216),
        roll: narrow_within(choices, 1, 3_216),
        step: narrow_within(choices, 1, i64::from(i16::MAX)),
    }
}

fn laser(choices: &mut impl Choices, level: bool) -> Laser {
    let beams = 1 + choices.below(MAX_BEAMS as u64) as u16;
    let step = I16F16::from_num(choices.between(1, 6_283)) / 1_000 / i32::from(beams);
    let mut laser = Laser {
        x: narrow_within(choices, -8_192, 8_192),
        y: narrow_within(choices, -8_192, 8_192),
        z: narrow_within(choices, 1, 8_192),
        pitch: narrow_within(choices, 0, if level { 200 } else { 6_400 }),
        first_bearing: angle(choices),
        bearing_step: step.max(I16F16::DELTA),
        beams,
        range_limit_mm: 1 + choices.below(u64::from(NO_RETURN_MM) - 1) as u16,
        ..Laser::default()
    };
    // A level laser may turn.
    if laser.pitch <= I4F12::lit("0.048") && choices.once_in(2) {
        laser.turn_time_ms = choices.below(501) as u16;
        laser.newest_first = choices.once_in(2);
    }
    if choices.once_in(40) {
        laser.pitch = narrow(choices);
        laser.z = narrow(choices);
        laser.bearing_step = wide(choices);
        laser.beams = choices.bits(16) as u16;
        laser.range_limit_mm = choices.bits(16) as u16;
        laser.turn_time_ms = choices.bits(16) as u16;
    }
    laser
}

/// Draws a hull. Rarely it is as large as the wire permits.
fn hull(choices: &mut impl Choices) -> Hull {
    let longest = if choices.once_in(8) { 4_000 } else { 1_200 };
    let mut side = |longest: i64| choices.between(1, longest) as u16;
    Hull {
        length_mm: side(longest),
        width_mm: side(longest),
        height_mm: side(longest.min(2_000)),
    }
}

fn loops(choices: &mut impl Choices) -> LoopLimits {
    if choices.once_in(3) {
        return LoopLimits::default();
    }
    let mut length = || wide(choices).max(I16F16::ZERO);
    LoopLimits {
        least: length(),
        most: length(),
        most_per_frontier: length(),
        detour: length(),
        slack: length(),
    }
}

fn order(choices: &mut impl Choices) -> Order {
    match choices.below(3) {
        0 => Order::Nearest { worth: I4F12::ZERO },
        1 => Order::Gain { worth: I4F12::ZERO },
        _ => Order::Gain {
            worth: narrow_within(choices, 0, 7 << 12),
        },
    }
}

//! The keys of a robot file, as they stand there.

use serde::Deserialize;
use serde_saphyr::Spanned;

/// A number with the place where it stands.
pub(super) type Number = Spanned<f64>;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Keys {
    pub(super) hull: Spanned<HullKeys>,
    pub(super) clearance: Option<Number>,
    pub(super) drive: Spanned<DriveKeys>,
    pub(super) lasers: Spanned<Vec<Spanned<LaserKeys>>>,
    pub(super) odometry: Option<OdometryKeys>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct HullKeys {
    pub(super) length: Option<Number>,
    pub(super) width: Option<Number>,
    pub(super) radius: Option<Number>,
    pub(super) height: Number,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DriveKeys {
    pub(super) track: Option<Number>,
    pub(super) effective_track: Option<Number>,
    pub(super) speed: Number,
    pub(super) turn_rate: Number,
    pub(super) acceleration: Number,
    pub(super) braking: Option<Number>,
    pub(super) turn_acceleration: Number,
    pub(super) wheel_speed: Option<Number>,
    pub(super) turns_on_the_spot: Option<Spanned<bool>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LaserKeys {
    pub(super) x: Number,
    pub(super) y: Number,
    pub(super) z: Number,
    pub(super) yaw: Option<Number>,
    pub(super) pitch: Option<Number>,
    #[serde(default)]
    pub(super) upside_down: bool,
    #[serde(default)]
    pub(super) clockwise: bool,
    pub(super) first: Option<Number>,
    pub(super) step: Option<Number>,
    pub(super) field: Option<Number>,
    pub(super) beams: Number,
    pub(super) turn_time: Option<Number>,
    #[serde(default)]
    pub(super) newest_first: bool,
    pub(super) least_range: Option<Number>,
    pub(super) range: Number,
    pub(super) noise: Option<NoiseKeys>,
    pub(super) mask: Option<Vec<Spanned<[f64; 2]>>>,
    pub(super) ignore_hull: Option<bool>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct NoiseKeys {
    pub(super) sd: Option<Number>,
    pub(super) lost: Option<Number>,
    pub(super) false_return: Option<Number>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct OdometryKeys {
    pub(super) times: Option<Number>,
    pub(super) turn_by_turn: Option<Number>,
    pub(super) turn_by_distance: Option<Number>,
    pub(super) distance_by_distance: Option<Number>,
    pub(super) distance_by_turn: Option<Number>,
    pub(super) distance_scale: Option<Number>,
    pub(super) turn_scale: Option<Number>,
}

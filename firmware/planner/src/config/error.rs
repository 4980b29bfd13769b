//! The error of a configuration: the parameter that is out of its range.

use core::fmt;

/// A parameter of a [`Config`](crate::Config) that is checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameter {
    /// Number of lasers.
    Lasers,
    /// Beams of a laser.
    Beams,
    /// Range limit of a laser, millimetres.
    RangeLimit,
    /// First bearing of a laser, radians.
    FirstBearing,
    /// Bearing from one beam to the next, radians.
    BearingStep,
    /// Sweep of a laser from its first beam to its last, radians.
    Sweep,
    /// Pitch of a laser, radians.
    Pitch,
    /// Distance of a laser from the robot's centre along one axis, metres.
    Mount,
    /// Height of a laser, metres.
    LaserHeight,
    /// Turn time of a laser, milliseconds: 0 for one that is not level.
    TurnTime,
    /// Half the robot's length, metres.
    HalfLength,
    /// Half the robot's width, metres.
    HalfWidth,
    /// Height of the robot, metres.
    Height,
    /// Radius of the disc that paths are planned for, metres.
    Radius,
    /// Greatest speed, metres per second.
    MaxLinear,
    /// Greatest turn rate, radians per second.
    MaxAngular,
    /// Acceleration, metres per second squared.
    LinearAccel,
    /// Angular acceleration, radians per second squared.
    AngularAccel,
    /// Time from one step to the next, seconds.
    Period,
    /// Least preference `ε_hmin`.
    LeastPreference,
    /// Greatest preference `ε_gmax`.
    MostPreference,
    /// Another parameter of [`UnevenGround`](crate::UnevenGround).
    UnevenGround,
    /// Side or corner of an [`Area`](crate::Area), map cells.
    Area,
    /// Target coverage of an area, thousandths.
    Coverage,
    /// A parameter of [`LoopLimits`](crate::LoopLimits).
    LoopLimits,
    /// The worth of an [`Order`](crate::Order).
    Worth,
    /// A parameter of [`SolverConfig`](crate::SolverConfig).
    Solver,
    /// A parameter of [`TeamPlace`](crate::TeamPlace), metres and radians.
    TeamPlace,
    /// Corners of a [`Fence`](crate::Fence), of a polygon or of all together.
    FenceCorners,
    /// Coordinate of a corner of a fence, metres.
    FenceCorner,
    /// Area of a polygon of a fence, square metres.
    FenceArea,
    /// Crossings of the sides of a polygon of a fence.
    FenceCrossings,
}

impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Lasers => "number of lasers",
            Self::Beams => "beams of a laser",
            Self::RangeLimit => "range limit of a laser (mm)",
            Self::FirstBearing => "first bearing of a laser (rad)",
            Self::BearingStep => "bearing step of a laser (rad)",
            Self::Sweep => "sweep of a laser (rad)",
            Self::Pitch => "pitch of a laser (rad)",
            Self::Mount => "offset of a laser (m)",
            Self::LaserHeight => "height of a laser (m)",
            Self::TurnTime => "turn time of a laser (ms)",
            Self::HalfLength => "half length of the robot (m)",
            Self::HalfWidth => "half width of the robot (m)",
            Self::Height => "height of the robot (m)",
            Self::Radius => "planning radius (m)",
            Self::MaxLinear => "greatest speed (m/s)",
            Self::MaxAngular => "greatest turn rate (rad/s)",
            Self::LinearAccel => "acceleration (m/s²)",
            Self::AngularAccel => "angular acceleration (rad/s²)",
            Self::Period => "period of a step (s)",
            Self::LeastPreference => "least preference",
            Self::MostPreference => "greatest preference",
            Self::UnevenGround => "parameter of uneven ground",
            Self::Area => "area (map cells)",
            Self::Coverage => "target coverage (1/1000)",
            Self::LoopLimits => "limit of loops",
            Self::Worth => "worth",
            Self::TeamPlace => "place in the team (m, rad)",
            Self::Solver => "parameter of the solver",
            Self::FenceCorners => "corners of a fence",
            Self::FenceCorner => "corner of a fence (m)",
            Self::FenceArea => "area of a polygon of a fence (m²)",
            Self::FenceCrossings => "crossings of a polygon of a fence",
        })
    }
}

/// A parameter that is out of its range, or not a number.
///
/// ```
/// use fieldline_planner::{Config, LaserMount, Parameter, RobotShape};
///
/// let error = Config::builder(RobotShape::PIONEER_3AT)
///     .laser(LaserMount::level(0.1, 0.4))
///     .radius_m(0.7)
///     .build()
///     .unwrap_err();
/// assert_eq!(error.parameter, Parameter::Radius);
/// assert_eq!(error.to_string(), "planning radius (m) is 0.7; it must be within 0.05 and 0.6");
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConfigError {
    /// The parameter.
    pub parameter: Parameter,
    /// Its value, in its unit.
    pub value: f32,
    /// The least value that it may have, in its unit.
    pub least: f32,
    /// The greatest value that it may have, in its unit.
    pub most: f32,
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            parameter,
            value,
            least,
            most,
        } = self;
        write!(
            f,
            "{parameter} is {value}; it must be within {least} and {most}"
        )
    }
}

impl core::error::Error for ConfigError {}

//! Values of arguments: words that are one of few, and what they mean.

use clap::ValueEnum;

use fieldline_protocol::message::Preference;
use host_sim::baseline::bvp_papers::Precision;
use host_sim::link::fault::Faults;
use host_sim::spec::SpecError;
use host_sim::trial::mission::OdometryProfile;

/// A log that is printed during a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum LogArg {
    /// What the robot does and why
    Mission,
}

/// What follows the exploration.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum ThenArg {
    /// Drive home
    Home,
}

/// A place, metres.
pub(in crate::cli) type Place = [f64; 2];

/// Seconds without a new place; `None` for never.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::cli) struct Impatience(pub(in crate::cli) Option<u16>);

/// Faults, and the text that names them.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::cli) struct FaultArg {
    pub(in crate::cli) text: String,
    pub(in crate::cli) faults: Faults,
}

impl core::str::FromStr for FaultArg {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, SpecError> {
        Ok(Self {
            text: text.into(),
            faults: text.parse()?,
        })
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum GroundArg {
    /// Take all ground for level
    Flat,
    /// Measure heights; avoid steps, slopes and holes
    Uneven,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum PreferenceArg {
    /// No preference
    Off,
    /// Prefer ground at the robot's own height
    Height,
    /// One preference for the whole window, which grows as the field becomes flat
    Global,
    /// The sum of both
    Both,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum PrecisionArg {
    /// Single precision
    F32,
    /// Double precision
    F64,
}

impl From<PrecisionArg> for Precision {
    fn from(precision: PrecisionArg) -> Self {
        match precision {
            PrecisionArg::F32 => Self::F32,
            PrecisionArg::F64 => Self::F64,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum SwitchArg {
    On,
    Off,
}

impl From<PreferenceArg> for Preference {
    fn from(which: PreferenceArg) -> Self {
        match which {
            PreferenceArg::Off => Self::Off,
            PreferenceArg::Height => Self::Height,
            PreferenceArg::Global => Self::Global,
            PreferenceArg::Both => Self::Both,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum OdometryArg {
    /// The true pose
    Truth,
    /// Wheel encoders and an inertial unit, with errors
    Noisy,
    /// Variances 20 times larger, as in the papers
    Papers,
    /// Scale errors of 0.75 %, no random walk
    Mobilesim,
}

impl From<OdometryArg> for OdometryProfile {
    fn from(which: OdometryArg) -> Self {
        match which {
            OdometryArg::Truth => Self::Truth,
            OdometryArg::Noisy => Self::Noisy,
            OdometryArg::Papers => Self::Papers,
            OdometryArg::Mobilesim => Self::MobileSim,
        }
    }
}

//! Errors of the odometry by name.

use crate::robot::OdometryNoise;

/// Errors of the odometry, by name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OdometryProfile {
    /// The true pose.
    #[default]
    Truth,
    /// [`OdometryNoise::default`].
    Noisy,
    /// [`OdometryNoise::papers`].
    Papers,
    /// [`OdometryNoise::mobilesim`].
    MobileSim,
}

impl OdometryProfile {
    /// Returns the name on the command line and in the report.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Truth => "truth",
            Self::Noisy => "noisy",
            Self::Papers => "papers",
            Self::MobileSim => "mobilesim",
        }
    }

    /// Returns the noise; `None` for the truth.
    #[must_use]
    pub fn noise(self) -> Option<OdometryNoise> {
        match self {
            Self::Truth => None,
            Self::Noisy => Some(OdometryNoise::default()),
            Self::Papers => Some(OdometryNoise::papers()),
            Self::MobileSim => Some(OdometryNoise::mobilesim()),
        }
    }
}

//! Parameters of uneven ground, and which preferences bend the field on it.
//!
//! Units: metres; slopes are tangents; preferences are pure numbers.

/// `K_n`, width of the kernel in cells [Maffei20, Table I].
pub const KERNEL_CELLS: usize = 20;

/// Which preferences are used.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PreferenceMode {
    /// None.
    Off,
    /// `ε_height`.
    Height,
    /// `ε_global`.
    Global,
    /// Their sum.
    #[default]
    Both,
}

impl PreferenceMode {
    /// Whether heights count.
    #[must_use]
    pub const fn has_heights(self) -> bool {
        matches!(self, Self::Height | Self::Both)
    }
}

/// Parameters of uneven ground [Maffei20, Table I], and the robot's limits on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnevenGround {
    /// Which preferences are used. Default: both.
    pub mode: PreferenceMode,
    /// `h_obs`: what stands higher than this over the mean ground around it is an obstacle, metres.
    /// Default: 0.30.
    pub obstacle_m: f32,
    /// `d_obs`: what the level laser meets nearer than this over ground not yet measured is an
    /// obstacle, metres. Default: 1.5.
    pub near_m: f32,
    /// `h_hole`: ground lower than this under what is beside it, with nothing measured between, is
    /// itself a negative obstacle, metres. Default: −0.60.
    pub hole_m: f32,
    /// `ε_hmin`, at least −2. Default: −0.5.
    pub least_preference: f32,
    /// `ε_gmax`, at most 2. Default: 0.5.
    pub most_preference: f32,
    /// `λ_h`, per metre. Default: 2.0.
    pub height_scale: f32,
    /// `λ_g`. Default: 0.005.
    pub global_scale: f32,
    /// Steepest slope that may be driven on, a tangent. Default: 0.364 (20°, the 3-AT's grade).
    pub climb: f32,
    /// Steepest slope that may be driven across, a tangent; as large as `climb`, there is no such
    /// limit. Default: as `climb`; the 3-AT's is 0.268 (15°).
    pub roll: f32,
    /// Highest edge that may be driven over, metres. Default: 0.07.
    pub step_m: f32,
}

impl UnevenGround {
    /// Table I, and the limits of a Pioneer 3-AT.
    pub const TABLE_I: Self = Self {
        mode: PreferenceMode::Both,
        obstacle_m: 0.30,
        near_m: 1.5,
        hole_m: -0.60,
        least_preference: -0.5,
        most_preference: 0.5,
        height_scale: 2.0,
        global_scale: 0.005,
        climb: 0.364,
        roll: 0.364,
        step_m: 0.07,
    };
}

impl Default for UnevenGround {
    fn default() -> Self {
        Self::TABLE_I
    }
}

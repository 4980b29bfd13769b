//! What ground is preferred: ε of every cell of the window [Maffei-Terrain, III-C].
//!
//! ```text
//! ε_height(x, y) = max(−λ_h |h(x_r, y_r) − h(x, y)|, ε_hmin)        (eq. 3; 0 where the height is unknown)
//! ε_global       = min(−λ_g ln p_diff(x_r, y_r), ε_gmax)            (eq. 4)
//! ε(x, y)        = ε_global + ε_height(x, y), within [ε_hmin, ε_gmax]     (eq. 5)
//! ```
//!
//! `p_diff` is that of the last field ([`crate::field::preference`]). Below 1e-10 the field around the robot is so flat that ε_height is
//! left out until `p_diff` is above 1e-4 again. Where it is 0, ε_global is at its limit. Before the first field it is 0.

use super::Terrain;
use crate::math;

/// `p_diff` below which heights no longer count.
pub const TOO_FLAT: f32 = 1e-10;
/// `p_diff` above which they count again.
pub const STEEP_AGAIN: f32 = 1e-4;

/// Which preferences are used.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// None.
    Off,
    /// ε_height.
    Height,
    /// ε_global.
    Global,
    /// Their sum.
    #[default]
    Both,
}

/// What the preferences remember from field to field.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Preferences {
    p_diff: Option<f32>,
    ignores_heights: bool,
}

/// Of a cell whose height differs by so much from the robot's [eq. 3].
#[must_use]
pub fn of_height(terrain: &Terrain, difference_m: f32) -> f32 {
    (-terrain.height_scale * difference_m.abs()).max(terrain.least_preference)
}

/// Of all cells [eq. 4].
#[must_use]
pub fn of_flatness(terrain: &Terrain, p_diff: f32) -> f32 {
    if p_diff > 0.0 {
        (-terrain.global_scale * math::ln(p_diff)).min(terrain.most_preference)
    } else {
        terrain.most_preference
    }
}

impl Preferences {
    /// Before the first field.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            p_diff: None,
            ignores_heights: false,
        }
    }

    /// A field was solved, with this `p_diff` around the robot.
    pub fn note(&mut self, p_diff: f32) {
        self.p_diff = Some(p_diff);
        if p_diff < TOO_FLAT {
            self.ignores_heights = true;
        } else if p_diff > STEEP_AGAIN {
            self.ignores_heights = false;
        }
    }

    /// Whether the field is so flat that heights do not count.
    #[must_use]
    pub const fn ignores_heights(&self) -> bool {
        self.ignores_heights
    }

    /// The last field's `p_diff`.
    #[must_use]
    pub const fn p_diff(&self) -> Option<f32> {
        self.p_diff
    }

    /// ε_global, if it is used.
    #[must_use]
    pub fn global(&self, terrain: &Terrain) -> f32 {
        match (terrain.mode, self.p_diff) {
            (Mode::Global | Mode::Both, Some(p_diff)) => of_flatness(terrain, p_diff),
            _ => 0.0,
        }
    }

    /// ε of a cell, given ε_global and how much its height differs from the robot's, if that is known [eq. 5].
    #[must_use]
    pub fn of_cell(&self, terrain: &Terrain, global: f32, difference_m: Option<f32>) -> f32 {
        let heights = matches!(terrain.mode, Mode::Height | Mode::Both) && !self.ignores_heights;
        let height = match difference_m {
            Some(difference_m) if heights => of_height(terrain, difference_m),
            _ => 0.0,
        };
        (global + height).clamp(terrain.least_preference, terrain.most_preference)
    }
}

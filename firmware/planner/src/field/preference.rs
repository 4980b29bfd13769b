//! Preferences on uneven ground: ε of every cell of the window \[Maffei20, III-C\].
//!
//! ```text
//! ε_height(x, y) = max(−λ_h |h(x_r, y_r) − h(x, y)|, ε_hmin)     (eq. 3; 0 for an unknown height)
//! ε_global       = min(−λ_g ln p_diff(x_r, y_r), ε_gmax)         (eq. 4)
//! ε(x, y)        = ε_global + ε_height(x, y), within [ε_hmin, ε_gmax]                     (eq. 5)
//! p_diff(r)      = mean of |p_r − p_n| over the cells n of the kernel around the robot's cell r
//! ```
//!
//! `p_diff` is that of the last field. Below 1e-10 the field around the robot is so flat that
//! `ε_height` does not count until `p_diff` is above 1e-4 again. If `p_diff` is 0, `ε_global` is at
//! its limit. Before the first field `ε_global` is 0.
//!
//! Conventions where the paper is silent: the kernel is 20 cells wide, an even number. It covers 10
//! columns to the left of the robot's and 9 to the right, 10 rows below and 9 above. Only free
//! cells from which a goal is reachable count, without the robot's own. The mean is of absolute
//! differences, because the signed mean of a harmonic field is about zero.
//!
//! For q = 1 − p, `|p_r − p_n| = |q_r − q_n|`, and small values keep their precision: in a
//! converged field `p_diff` is right to 1e-4 down to 1e-30.
//!
//! Units: heights in metres; ε and `p_diff` are pure numbers.

use crate::config::{FieldTuning, KERNEL_CELLS, PreferenceMode, UnevenGround};
use crate::field::window::{GOAL, SIDE, Window};
use crate::geometry::Pose;
use crate::math;

/// `p_diff` below which heights no longer count \[Maffei20, III-C\].
const TOO_FLAT: f32 = 1e-10;
/// `p_diff` above which they count again \[Maffei20, III-C\].
const STEEP_AGAIN: f32 = 1e-4;

/// Returns `p_diff` at cell (x, y), from 0 to 1; 0 if the cell reaches no goal or is alone in its
/// kernel.
#[must_use]
pub fn p_diff(window: &Window, x: usize, y: usize) -> f32 {
    if !window.is_reached(x, y) {
        return 0.0;
    }
    let q_robot = window.q(x, y);
    let half = KERNEL_CELLS / 2;
    let (mut sum, mut cells) = (0.0, 0_u16);
    for row in y.saturating_sub(half)..(y + half).min(SIDE) {
        for column in x.saturating_sub(half)..(x + half).min(SIDE) {
            if window.is_reached(column, row) && (column, row) != (x, y) {
                sum += (window.q(column, row) - q_robot).abs();
                cells += 1;
            }
        }
    }
    if cells == 0 {
        0.0
    } else {
        sum / f32::from(cells) / GOAL
    }
}

/// The state of the preferences between fields.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Preferences {
    p_diff: Option<f32>,
    ignores_heights: bool,
    reference_m: f32,
}

/// Returns `ε_height` for a height difference to the robot [eq. 3].
fn of_height(ground: &UnevenGround, difference_m: f32) -> f32 {
    (-ground.height_scale * difference_m.abs()).max(ground.least_preference)
}

/// Returns `ε_global` [eq. 4].
#[must_use]
pub fn of_flatness(ground: &UnevenGround, p_diff: f32) -> f32 {
    if p_diff > 0.0 {
        (-ground.global_scale * math::ln(p_diff)).min(ground.most_preference)
    } else {
        ground.most_preference
    }
}

impl Preferences {
    /// Returns the state before the first field.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            p_diff: None,
            ignores_heights: false,
            reference_m: 0.0,
        }
    }

    /// Notes the height of the ground if the robot stands on it about level.
    pub(crate) fn note_pose(&mut self, pose: &Pose, tuning: &FieldTuning) {
        let is_level = |angle_rad: f32| angle_rad.abs() < tuning.level_rad;
        if is_level(pose.roll_rad) && is_level(pose.pitch_rad) {
            self.reference_m = pose.z_m;
        }
    }

    /// Returns the height of the last ground on which the robot stood level, metres.
    #[must_use]
    pub(crate) const fn reference_m(&self) -> f32 {
        self.reference_m
    }

    /// Notes `p_diff` around the robot in a solved field.
    pub fn note(&mut self, p_diff: f32) {
        self.p_diff = Some(p_diff);
        if p_diff < TOO_FLAT {
            self.ignores_heights = true;
        } else if p_diff > STEEP_AGAIN {
            self.ignores_heights = false;
        }
    }

    /// Returns `p_diff` of the last field around the robot; `None` before the first.
    #[must_use]
    pub const fn p_diff(&self) -> Option<f32> {
        self.p_diff
    }

    /// Returns true if heights do not count because the field was too flat.
    #[must_use]
    pub const fn ignores_heights(&self) -> bool {
        self.ignores_heights
    }

    /// Returns `ε_global`; 0 if the mode does not use it.
    #[must_use]
    pub fn global(&self, ground: &UnevenGround) -> f32 {
        match (ground.mode, self.p_diff) {
            (PreferenceMode::Global | PreferenceMode::Both, Some(p_diff)) => {
                of_flatness(ground, p_diff)
            }
            _ => 0.0,
        }
    }

    /// Returns ε of a cell, given `ε_global` and its height above the robot's ground, if that is
    /// known [eq. 5].
    #[must_use]
    pub fn of_cell(&self, ground: &UnevenGround, global: f32, difference_m: Option<f32>) -> f32 {
        let heights = ground.mode.has_heights() && !self.ignores_heights;
        let height = match difference_m {
            Some(difference_m) if heights => of_height(ground, difference_m),
            _ => 0.0,
        };
        (global + height).clamp(ground.least_preference, ground.most_preference)
    }
}

#[cfg(test)]
mod tests {
    use std::boxed::Box;

    use super::{
        PreferenceMode, Preferences, STEEP_AGAIN, TOO_FLAT, of_flatness, of_height, p_diff,
    };
    use crate::config::UnevenGround;
    use crate::field::{GOAL, Preference, SCRATCH_FLOATS, SIDE, SolverConfig, Stop, Window, solve};

    /// Pseudorandom numbers in [0, 1).
    struct Random(u64);

    impl Random {
        fn next(&mut self) -> f64 {
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        }
    }

    fn close(ours: f32, exact: f64) -> bool {
        (f64::from(ours) - exact).abs() <= 1e-4 * exact.abs() + 1e-30
    }

    fn solved(free: &[u64; SIDE], goal: &[u64; SIDE], epsilon: f32) -> Box<Window> {
        let mut window = Box::new(Window::new());
        window.set_boundary(free, goal);
        window.set_preferences(|_, _| Preference::nearest(epsilon));
        let mut scratch = [0.0; SCRATCH_FLOATS];
        let config = SolverConfig {
            max_cycles: 200,
            ..SolverConfig::default()
        };
        assert_eq!(
            solve(&mut window, &mut scratch, &config).stop,
            Stop::Converged
        );
        window
    }

    /// Returns the mean of `|q_r − q_n|` over the kernel, in f64.
    fn exact_p_diff(window: &Window, x: i32, y: i32) -> f64 {
        let q = |x: i32, y: i32| f64::from(window.q(x as usize, y as usize)) / f64::from(GOAL);
        let (mut sum, mut cells) = (0.0, 0.0);
        for v in (y - 10).max(0)..(y + 10).min(SIDE as i32) {
            for u in (x - 10).max(0)..(x + 10).min(SIDE as i32) {
                if window.is_reached(u as usize, v as usize) && (u, v) != (x, y) {
                    sum += (q(x, y) - q(u, v)).abs();
                    cells += 1.0;
                }
            }
        }
        sum / cells
    }

    /// Compares eqs. 3 to 5 and `p_diff` with f64, in random windows.
    #[test]
    fn random_states_equal_the_formulas_in_f64() {
        let mut random = Random(7);
        let mut states = 0;
        while states < 120 {
            let density = 0.25 * random.next();
            let free: [u64; SIDE] = core::array::from_fn(|_| {
                (0..SIDE).fold(0, |row, x| row | u64::from(random.next() > density) << x)
            });
            let mut goal = [0; SIDE];
            goal[(random.next() * 61.0) as usize] = 1 << (random.next() * 61.0) as u32;
            let window = solved(&free, &goal, 0.0);
            let (x, y) = (
                (random.next() * 61.0) as usize,
                (random.next() * 61.0) as usize,
            );
            if !window.is_reached(x, y) {
                continue;
            }
            states += 1;
            let flatness = p_diff(&window, x, y);
            assert!(close(flatness, exact_p_diff(&window, x as i32, y as i32)));

            let [scale_h, scale_g, least, most] =
                [4.0, 0.05, -2.0, 2.0].map(|most| (random.next() * most) as f32);
            let ground = UnevenGround {
                height_scale: scale_h,
                global_scale: scale_g,
                least_preference: least,
                most_preference: most,
                ..UnevenGround::TABLE_I
            };
            let mut preferences = Preferences::new();
            preferences.note(flatness);
            let exact_global =
                (-f64::from(scale_g) * f64::from(flatness).ln()).min(f64::from(most));
            let global = preferences.global(&ground);
            assert!(close(global, exact_global), "{global} {exact_global}");
            let difference = (random.next() - 0.5) as f32;
            let exact_height =
                (-f64::from(scale_h) * f64::from(difference).abs()).max(f64::from(least));
            assert!(close(of_height(&ground, difference), exact_height));
            let counts = if flatness < TOO_FLAT {
                0.0
            } else {
                exact_height
            };
            let sum = exact_global + counts;
            let exact = sum.clamp(f64::from(least), f64::from(most));
            let ours = preferences.of_cell(&ground, global, Some(difference));
            // A sum of opposite signs is only as exact as its terms.
            let error = (f64::from(ours) - exact).abs();
            assert!(
                error <= 1e-4 * exact.abs().max(exact_global),
                "{ours} {exact}"
            );
        }
    }

    /// Returns a winding corridor two cells wide. Its far end is flatter than 1e-10; nearer to the
    /// goal `p_diff` is above 1e-4.
    fn corridor() -> ([u64; SIDE], [u64; SIDE]) {
        let mut free = [0; SIDE];
        for (y, row) in free.iter_mut().enumerate() {
            let turn = if y / 3 % 2 == 0 { 1 << 60 } else { 1 };
            *row = if y % 3 == 2 { turn } else { (1 << SIDE) - 1 };
        }
        let mut goal = [0; SIDE];
        goal[0] = 1;
        (free, goal)
    }

    #[test]
    fn heights_are_left_out_below_1e10_and_come_back_above_1e4() {
        let (free, goal) = corridor();
        let window = solved(&free, &goal, 0.0);
        let ground = UnevenGround::TABLE_I;
        let mut preferences = Preferences::new();
        // Towards the flat end and back, row by row of the corridor.
        let (mut left_out, mut back_at) = (0.0, 0.0);
        let rows = (0..SIDE).chain((0..SIDE).rev()).filter(|y| y % 3 == 0);
        let mut before = false;
        for y in rows {
            for x in [10, 30, 50] {
                let flatness = p_diff(&window, x, y);
                preferences.note(flatness);
                match (before, preferences.ignores_heights) {
                    (false, true) => left_out = flatness,
                    (true, false) => back_at = flatness,
                    (true, true) => assert!(flatness <= STEEP_AGAIN),
                    (false, false) => assert!(flatness >= TOO_FLAT),
                }
                before = preferences.ignores_heights;
                let global = preferences.global(&ground);
                let level = preferences.of_cell(&ground, global, Some(0.0));
                let lower = preferences.of_cell(&ground, global, Some(-0.2));
                assert_eq!(before, level == lower, "{flatness}");
            }
        }
        assert!(left_out > 0.0 && left_out < TOO_FLAT, "{left_out}");
        assert!(back_at > STEEP_AGAIN, "{back_at}");
    }

    #[test]
    fn the_thresholds_are_the_papers() {
        let mut preferences = Preferences::new();
        let mut ignores = |p_diff: f32| {
            preferences.note(p_diff);
            preferences.ignores_heights
        };
        let noted = [1e-9, 1.1e-10, 0.9e-10, 1e-7, 0.9e-4, 1.1e-4, 1e-9].map(&mut ignores);
        assert_eq!(noted, [false, false, true, true, true, false, false]);
    }

    #[test]
    fn the_mode_says_what_counts() {
        let mut preferences = Preferences::new();
        preferences.note(1e-3);
        let global = of_flatness(&UnevenGround::TABLE_I, 1e-3);
        let of = |mode, difference_m| {
            let ground = UnevenGround {
                mode,
                ..UnevenGround::TABLE_I
            };
            preferences.of_cell(&ground, preferences.global(&ground), difference_m)
        };
        assert_eq!(of(PreferenceMode::Off, Some(0.1)), 0.0);
        assert_eq!(of(PreferenceMode::Height, Some(0.1)), -0.2);
        assert_eq!(of(PreferenceMode::Height, Some(-9.0)), -0.5);
        assert_eq!(of(PreferenceMode::Height, None), 0.0);
        assert_eq!(of(PreferenceMode::Global, Some(0.1)), global);
        assert_eq!(of(PreferenceMode::Both, Some(0.1)), global - 0.2);
        assert_eq!(of(PreferenceMode::Both, None), global);
        // A field without differences has the greatest preference.
        assert_eq!(of_flatness(&UnevenGround::TABLE_I, 0.0), 0.5);
    }
}

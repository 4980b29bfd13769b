//! What the tests of the field share: seeded windows, the f64 truth about them, and angles.

pub(crate) mod golden;
pub(crate) mod oracle;
pub(crate) mod scenes;

use fieldline_planner::field::SIDE;
use fieldline_planner::math;

/// Bit masks of the window's rows: bit x of row y.
pub(crate) type Rows = [u64; SIDE];

/// Every cell of the window, row by row.
pub(crate) fn cells() -> impl Iterator<Item = (usize, usize)> {
    (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y)))
}

/// Sine and cosine that are the same on every host.
pub(crate) fn sin_cos(angle: f64) -> (f64, f64) {
    let (sin, cos) = math::sin_cos(math::wrap(angle as f32));
    (f64::from(sin), f64::from(cos))
}

/// Degrees between two angles in radians, from 0 to 180.
pub(crate) fn degrees_between(a: f64, b: f64) -> f64 {
    let turn = (a - b).rem_euclid(core::f64::consts::TAU);
    turn.min(core::f64::consts::TAU - turn).to_degrees()
}

/// A small seeded generator (xorshift64*), so that every run sees the same windows.
pub(crate) struct Random(u64);

impl Random {
    /// A stream of its own for each `seed`.
    pub(crate) fn new(seed: u64) -> Self {
        let mut random = Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
        for _ in 0..8 {
            random.bits();
        }
        random
    }

    /// 64 random bits.
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_F491_4F6C_DD1D)
    }

    /// Uniform in [0, 1).
    pub(crate) fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Uniform in `low..high`.
    pub(crate) fn between(&mut self, low: i32, high: i32) -> i32 {
        low + (self.unit() * f64::from(high - low)) as i32
    }

    /// True with the given probability.
    pub(crate) fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    /// Uniform in 0 to 2π.
    pub(crate) fn angle(&mut self) -> f64 {
        self.unit() * core::f64::consts::TAU
    }
}

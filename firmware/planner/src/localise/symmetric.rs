//! Symmetric 3 × 3 matrices over (x, y, yaw): covariances and information; eigenvalues over (x, y).
//!
//! ```text
//! A = ⎡ xx xy xt ⎤      A = L D Lᵀ      A⁻¹ column by column
//!     ⎢ xy yy yt ⎥
//!     ⎣ xt yt tt ⎦
//! ```
//!
//! Units: cells and radians, or metres and radians, as the user says.

use core::ops::Add;

use crate::math;

/// A pivot below this share of its diagonal element is a rounding error.
const LEAST_PIVOT: f32 = 1e-6;

/// A symmetric matrix.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Symmetric {
    pub(crate) xx: f32,
    pub(crate) xy: f32,
    pub(crate) yy: f32,
    pub(crate) xt: f32,
    pub(crate) yt: f32,
    pub(crate) tt: f32,
}

impl Symmetric {
    /// The zero matrix.
    pub(crate) const ZERO: Self = Self {
        xx: 0.0,
        xy: 0.0,
        yy: 0.0,
        xt: 0.0,
        yt: 0.0,
        tt: 0.0,
    };

    /// Returns the matrix with these diagonal elements.
    pub(crate) fn diagonal(xx: f32, yy: f32, tt: f32) -> Self {
        Self {
            xx,
            yy,
            tt,
            ..Self::default()
        }
    }

    /// Returns the product with a vector.
    pub(crate) fn times(&self, [x, y, t]: [f32; 3]) -> [f32; 3] {
        [
            self.xx * x + self.xy * y + self.xt * t,
            self.xy * x + self.yy * y + self.yt * t,
            self.xt * x + self.yt * y + self.tt * t,
        ]
    }

    /// Returns the multiple by a number.
    pub(crate) fn scaled(&self, by: f32) -> Self {
        Self {
            xx: by * self.xx,
            xy: by * self.xy,
            yy: by * self.yy,
            xt: by * self.xt,
            yt: by * self.yt,
            tt: by * self.tt,
        }
    }

    /// Adds `weight · v vᵀ`.
    #[inline(always)]
    pub(crate) fn add_outer(&mut self, weight: f32, [x, y, t]: [f32; 3]) {
        let (wx, wy) = (weight * x, weight * y);
        self.xx += wx * x;
        self.xy += wx * y;
        self.yy += wy * y;
        self.xt += wx * t;
        self.yt += wy * t;
        self.tt += weight * t * t;
    }

    /// Returns the solution of `A v = b`; `None` unless the matrix is positive definite.
    pub(crate) fn solve(&self, [b0, b1, b2]: [f32; 3]) -> Option<[f32; 3]> {
        let d0 = self.xx;
        let (l1, l2) = (self.xy / d0, self.xt / d0);
        let d1 = self.yy - l1 * self.xy;
        let rest = self.yt - l2 * self.xy;
        let l21 = rest / d1;
        let d2 = self.tt - l2 * self.xt - l21 * rest;
        let is_positive = d0 > 0.0 && d1 > LEAST_PIVOT * self.yy && d2 > LEAST_PIVOT * self.tt;
        if !is_positive {
            return None;
        }
        let y1 = b1 - l1 * b0;
        let y2 = b2 - l2 * b0 - l21 * y1;
        let t = y2 / d2;
        let y = y1 / d1 - l21 * t;
        Some([b0 / d0 - l1 * y - l2 * t, y, t])
    }

    /// Returns the inverse; `None` unless the matrix is positive definite.
    pub(crate) fn inverse(&self) -> Option<Self> {
        let [xx, _, _] = self.solve([1.0, 0.0, 0.0])?;
        let [xy, yy, _] = self.solve([0.0, 1.0, 0.0])?;
        let [xt, yt, tt] = self.solve([0.0, 0.0, 1.0])?;
        Some(Self {
            xx,
            xy,
            yy,
            xt,
            yt,
            tt,
        })
    }
}

/// The eigenvalues of a symmetric 2 × 2 matrix, and the eigenvector of the least.
///
/// ```text
/// λ = (xx + yy) / 2 ± root,    root² = ((xx − yy) / 2)² + xy²
/// ```
#[derive(Clone, Copy, Debug)]
pub(super) struct Eigen {
    half_sum: f32,
    half_gap: f32,
    xy: f32,
    /// Half of the difference of the eigenvalues.
    pub(super) root: f32,
}

impl Eigen {
    pub(super) fn of([xx, xy, yy]: [f32; 3]) -> Self {
        let half_gap = 0.5 * (xx - yy);
        Self {
            half_sum: 0.5 * (xx + yy),
            half_gap,
            xy,
            root: math::sqrt(half_gap * half_gap + xy * xy),
        }
    }

    pub(super) fn least(&self) -> f32 {
        self.half_sum - self.root
    }

    pub(super) fn greatest(&self) -> f32 {
        self.half_sum + self.root
    }

    /// Returns the unit eigenvector of the least eigenvalue. The eigenvalues must differ.
    pub(super) fn least_direction(&self) -> [f32; 2] {
        // Of the two forms of the eigenvector this one does not cancel.
        let (x, y) = if self.half_gap > 0.0 {
            (-self.xy, self.half_gap + self.root)
        } else {
            (self.root - self.half_gap, -self.xy)
        };
        let length = 1.0 / math::sqrt(x * x + y * y);
        [x * length, y * length]
    }
}

impl Add for Symmetric {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            xx: self.xx + other.xx,
            xy: self.xy + other.xy,
            yy: self.yy + other.yy,
            xt: self.xt + other.xt,
            yt: self.yt + other.yt,
            tt: self.tt + other.tt,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Eigen, Symmetric};

    #[test]
    fn a_matrix_times_its_eigenvector_is_the_multiple() {
        for [xx, xy, yy] in [
            [3.0, 1.0, 1.0],
            [1.0, -2.0, 5.0],
            [1.0, 0.0, 4.0],
            [4.0, 0.0, 1.0],
        ] {
            let eigen = Eigen::of([xx, xy, yy]);
            let [x, y] = eigen.least_direction();
            let least = eigen.least();
            assert!((xx * x + xy * y - least * x).abs() < 1e-5, "{eigen:?}");
            assert!((xy * x + yy * y - least * y).abs() < 1e-5, "{eigen:?}");
            assert!((least + eigen.greatest() - xx - yy).abs() < 1e-5);
        }
    }

    #[test]
    fn the_inverse_of_the_inverse_is_the_matrix() {
        let mut matrix = Symmetric::diagonal(0.5, 0.2, 10.0);
        matrix.add_outer(2.0, [1.0, -0.5, 20.0]);
        matrix.add_outer(3.0, [-0.2, 1.0, -5.0]);
        let v = [0.3, -0.7, 0.01];
        let solved = matrix.solve(matrix.times(v)).expect("positive");
        for (found, wanted) in solved.iter().zip(v) {
            assert!((found - wanted).abs() < 1e-4, "{solved:?}");
        }
        let again = matrix
            .inverse()
            .and_then(|it| it.inverse())
            .expect("positive");
        assert!((again.tt / matrix.tt - 1.0).abs() < 1e-3, "{again:?}");
        assert!((again.xy - matrix.xy).abs() < 1e-3 * matrix.xx, "{again:?}");
    }

    #[test]
    fn a_matrix_that_is_not_positive_has_no_solution() {
        let mut flat = Symmetric::default();
        assert_eq!(flat.solve([1.0; 3]), None);
        flat.add_outer(1.0, [1.0, 2.0, 3.0]);
        assert_eq!(flat.inverse(), None);
    }
}

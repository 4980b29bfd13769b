//! Symmetric 3 × 3 matrices: information of a motion (along, across, turn).
//!
//! ```text
//! A = L Lᵀ,   L lower triangular
//! ```
//!
//! Units: 1/m², 1/(m rad), 1/rad².

use crate::pose::{sin_cos, sqrt};

/// A 3 × 3 matrix, row by row.
pub type Matrix = [[f32; 3]; 3];
/// Three numbers: two of length and an angle.
pub type Vector = [f32; 3];

/// A matrix of zeros.
pub(crate) const ZERO: Matrix = [[0.0; 3]; 3];

/// Returns the diagonal matrix.
pub const fn diagonal([x, y, yaw]: Vector) -> Matrix {
    [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, yaw]]
}

/// Returns A x.
pub fn times(a: &Matrix, x: &Vector) -> Vector {
    a.map(|row| dot(&row, x))
}

/// Returns Aᵀ x.
pub(crate) fn transposed_times(a: &Matrix, x: &Vector) -> Vector {
    [0, 1, 2].map(|column| {
        let rows = a.iter().zip(x);
        rows.map(|(row, x)| row.get(column).copied().unwrap_or(0.0) * x)
            .sum()
    })
}

pub(crate) fn dot([a, b, c]: &Vector, [x, y, z]: &Vector) -> f32 {
    a * x + b * y + c * z
}

/// Returns A + B.
pub(crate) fn sum(a: &Matrix, b: &Matrix) -> Matrix {
    let mut sum = *a;
    for (row, other) in sum.iter_mut().zip(b) {
        for (cell, other) in row.iter_mut().zip(other) {
            *cell += other;
        }
    }
    sum
}

/// Adds w j jᵀ to a matrix.
pub fn add_outer(a: &mut Matrix, j: &Vector, w: f32) {
    for (row, x) in a.iter_mut().zip(j) {
        for (cell, y) in row.iter_mut().zip(j) {
            *cell += w * x * y;
        }
    }
}

/// Returns Rᵀ A R, with R the turn of the plane by an angle.
pub fn turned(a: &Matrix, angle: f32) -> Matrix {
    let (sin, cos) = sin_cos(angle);
    let turn = |[x, y, z]: Vector| [cos * x + sin * y, cos * y - sin * x, z];
    // The columns of A R, then the rows of Rᵀ (A R); A is symmetric.
    let [one, two, three] = a.map(turn);
    let columns = transpose(&[one, two, three]).map(turn);
    transpose(&columns)
}

fn transpose([a, b, c]: &Matrix) -> Matrix {
    [[a[0], b[0], c[0]], [a[1], b[1], c[1]], [a[2], b[2], c[2]]]
}

/// The factor L of a positive definite matrix.
#[derive(Clone, Copy, Debug)]
pub struct Cholesky {
    diagonal: Vector,
    /// Below the diagonal: (1, 0), (2, 0), (2, 1).
    below: Vector,
}

impl Cholesky {
    /// The factor of the unit matrix.
    pub const UNIT: Self = Self {
        diagonal: [1.0; 3],
        below: [0.0; 3],
    };

    /// Factors a matrix; `None` if it is not positive definite.
    pub fn of(a: &Matrix) -> Option<Self> {
        let [[a00, ..], [a10, a11, _], [a20, a21, a22]] = *a;
        let root = |square: f32| (square > 0.0).then(|| sqrt(square));
        let l00 = root(a00)?;
        let (l10, l20) = (a10 / l00, a20 / l00);
        let l11 = root(a11 - l10 * l10)?;
        let l21 = (a21 - l20 * l10) / l11;
        let l22 = root(a22 - l20 * l20 - l21 * l21)?;
        Some(Self {
            diagonal: [l00, l11, l22],
            below: [l10, l20, l21],
        })
    }

    /// Returns Lᵀ x.
    pub(crate) fn whitened(&self, [x, y, z]: &Vector) -> Vector {
        let ([l00, l11, l22], [l10, l20, l21]) = (self.diagonal, self.below);
        [l00 * x + l10 * y + l20 * z, l11 * y + l21 * z, l22 * z]
    }

    /// Returns the logarithm of the root of A's determinant.
    pub fn log_root_determinant(&self) -> f32 {
        self.diagonal.iter().map(|it| libm::logf(*it)).sum()
    }

    /// Returns L⁻¹ x.
    pub(crate) fn forward(&self, [x, y, z]: &Vector) -> Vector {
        let ([l00, l11, l22], [l10, l20, l21]) = (self.diagonal, self.below);
        let a = x / l00;
        let b = (y - l10 * a) / l11;
        [a, b, (z - l20 * a - l21 * b) / l22]
    }

    /// Returns L⁻ᵀ x.
    pub fn backward(&self, [x, y, z]: &Vector) -> Vector {
        let ([l00, l11, l22], [l10, l20, l21]) = (self.diagonal, self.below);
        let c = z / l22;
        let b = (y - l21 * c) / l11;
        [(x - l10 * b - l20 * c) / l00, b, c]
    }

    /// Returns the solution x of L Lᵀ x = b.
    pub fn solve(&self, b: &Vector) -> Vector {
        self.backward(&self.forward(b))
    }
}

/// Returns the least eigenvalue of the position's information, the heading eliminated, 1/m².
pub(crate) fn least_eigenvalue(a: &Matrix) -> f32 {
    let [[xx, xy, xt], [_, yy, yt], [_, _, tt]] = *a;
    let part = if tt > 0.0 { 1.0 / tt } else { 0.0 };
    let (xx, xy, yy) = (
        xx - xt * xt * part,
        xy - xt * yt * part,
        yy - yt * yt * part,
    );
    let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
    mean - sqrt(half * half + xy * xy)
}

#[cfg(test)]
mod tests {
    use super::{Cholesky, Matrix, diagonal, least_eigenvalue, times, turned};

    const A: Matrix = [[9.0, 2.0, -1.0], [2.0, 6.0, 0.5], [-1.0, 0.5, 3.0]];

    fn near(a: &[f32; 3], b: &[f32; 3]) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-5)
    }

    #[test]
    fn a_factor_solves_its_matrix() {
        let factor = Cholesky::of(&A).unwrap();
        let x = [0.3, -1.2, 2.0];
        assert!(near(&factor.solve(&times(&A, &x)), &x));
        assert!(near(&factor.forward(&times(&A, &x)), &factor.whitened(&x)));
        assert!(near(&factor.backward(&factor.whitened(&x)), &x));
        assert!(Cholesky::of(&diagonal([1.0, -1.0, 1.0])).is_none());
        assert!(Cholesky::of(&diagonal([1.0, f32::NAN, 1.0])).is_none());
    }

    #[test]
    fn a_quarter_turn_swaps_the_axes_and_a_whole_one_none() {
        let quarter = turned(&A, core::f32::consts::FRAC_PI_2);
        assert!(near(&quarter[0], &[6.0, -2.0, 0.5]), "{quarter:?}");
        assert!(near(&quarter[2], &[0.5, 1.0, 3.0]), "{quarter:?}");
        let back = turned(&turned(&A, 0.7), -0.7);
        assert!(back.iter().zip(&A).all(|(a, b)| near(a, b)));
    }

    #[test]
    fn a_corridor_has_no_information_along_it() {
        let along = turned(&diagonal([0.0, 50.0, 200.0]), 0.4);
        assert!(least_eigenvalue(&along).abs() < 1e-4);
        assert!((least_eigenvalue(&diagonal([4.0, 50.0, 200.0])) - 4.0).abs() < 1e-4);
    }
}

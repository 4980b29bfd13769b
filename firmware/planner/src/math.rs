//! Elementary functions that compute the same bits on the host and on the target.
//!
//! On a host, the standard library's inherent `f32` methods shadow those of micromath and libm, and
//! they round differently. So all other files call the functions of this file. Its tests assert
//! every bound that a function states.
//!
//! Units: radians.

use micromath::F32Ext;

/// π.
pub const PI: f32 = core::f32::consts::PI;

/// Returns the greatest integer not above `x`, for |x| < 2³¹; saturates beyond.
#[must_use]
pub fn floor(x: f32) -> i32 {
    F32Ext::floor(x) as i32
}

/// Returns the correctly rounded square root.
#[must_use]
pub fn sqrt(x: f32) -> f32 {
    libm::sqrtf(x)
}

/// Returns the angle of the vector (x, y) in (−π, π]; 0 for the null vector.
#[must_use]
pub fn atan2(y: f32, x: f32) -> f32 {
    libm::atan2f(y, x)
}

/// Returns the natural logarithm.
#[must_use]
pub fn ln(x: f32) -> f32 {
    libm::logf(x)
}

/// Returns `x` to the power of `y`.
#[must_use]
pub fn powf(x: f32, y: f32) -> f32 {
    libm::powf(x, y)
}

/// Returns the equal angle in [−π, π], for |angle| up to a few hundred turns.
#[inline(never)]
#[must_use]
pub fn wrap(angle: f32) -> f32 {
    let turns = floor(angle / (2.0 * PI) + 0.5);
    angle - turns as f32 * (2.0 * PI)
}

/// Returns sine and cosine of an angle. Both errors are below 1e-7 for |angle| ≤ 8π.
///
/// It reduces the angle to ±π/4 and evaluates polynomials of degree 7 and 8. Not inlined: it is
/// called from many places, and a copy in each of them takes flash.
#[inline(never)]
#[must_use]
pub fn sin_cos(angle: f32) -> (f32, f32) {
    let quarter = floor(angle * (2.0 / PI) + 0.5);
    let k = quarter as f32;
    // π/2 in two parts (Cody–Waite), so that the reduced angle keeps its low bits.
    let r = (angle - k * 1.570_312_5) - k * 4.838_268e-4;
    let r2 = r * r;
    let s = r + r * r2 * (-1.666_665_5e-1 + r2 * (8.332_161e-3 + r2 * -1.951_529_6e-4));
    let c =
        1.0 - 0.5 * r2 + r2 * r2 * (4.166_664_6e-2 + r2 * (-1.388_731_6e-3 + r2 * 2.443_315_7e-5));
    match quarter & 3 {
        0 => (s, c),
        1 => (c, -s),
        2 => (-s, -c),
        _ => (-c, s),
    }
}

#[cfg(test)]
mod tests {
    use super::{floor, sin_cos, wrap};

    #[test]
    fn sine_and_cosine_within_a_ten_millionth() {
        // Steps of 0.3 mrad up to 8π.
        for i in -83_776..=83_776 {
            let x = i as f32 * 3e-4;
            let (s, c) = sin_cos(x);
            assert!((f64::from(s) - f64::from(x).sin()).abs() < 1e-7, "sin {x}");
            assert!((f64::from(c) - f64::from(x).cos()).abs() < 1e-7, "cos {x}");
        }
    }

    #[test]
    fn floor_and_wrap() {
        assert_eq!(
            [floor(-0.1), floor(0.0), floor(2.9), floor(-3.0)],
            [-1, 0, 2, -3]
        );
        assert!((wrap(7.0) - (7.0 - 2.0 * super::PI)).abs() < 1e-6);
    }
}

//! Number of times that a path crosses a slope from one height level to the other.
//!
//! The lower level is below the first height, the upper level above the second; the slope lies
//! between. On the slope a robot still counts to the level that it left, so turning back half way
//! is no crossing. Metres.

/// Changes of level along a path of ground heights; the first level that it reaches is no change.
#[must_use]
pub fn crossings(heights_m: impl IntoIterator<Item = f64>, [low_m, high_m]: [f64; 2]) -> u32 {
    let (mut upper, mut changes) = (None, 0);
    for height_m in heights_m {
        let now = if height_m < low_m {
            Some(false)
        } else if height_m > high_m {
            Some(true)
        } else {
            continue;
        };
        changes += u32::from(upper.is_some() && upper != now);
        upper = now;
    }
    changes
}

#[cfg(test)]
mod tests {
    use super::crossings;

    #[test]
    fn turning_back_on_the_slope_is_no_crossing() {
        let count = |heights_m: &[f64]| crossings(heights_m.iter().copied(), [0.2, 1.6]);
        assert_eq!(count(&[]), 0);
        assert_eq!(count(&[0.0, 0.1, 1.5, 0.3, 0.0]), 0);
        assert_eq!(count(&[0.0, 0.8, 1.7, 1.5, 1.8]), 1);
        assert_eq!(count(&[1.8, 0.1, 0.9, 1.7, 0.9, 0.0]), 3);
        // If the path begins on the slope, the first level that it reaches counts as its start.
        assert_eq!(count(&[0.9, 1.8, 0.9]), 0);
        assert_eq!(count(&[0.9, 1.8, 0.0]), 1);
    }

    #[test]
    fn a_height_at_a_threshold_is_on_the_slope() {
        assert_eq!(crossings([0.0, 1.6, 0.2, 1.6], [0.2, 1.6]), 0);
    }
}

//! How often a path goes from one storey of the ground to the other.
//!
//! A storey is whatever lies below the first height, or above the second; between them lies the slope. Somebody is in the storey that he was
//! in last, so that who turns back half way has not crossed. Metres.

/// Changes of storey along a path of ground heights; the first storey that it comes to is no change.
#[must_use]
pub fn crossings(heights_m: impl IntoIterator<Item = f64>, [low_m, high_m]: [f64; 2]) -> u32 {
    let (mut upstairs, mut changes) = (None, 0);
    for height_m in heights_m {
        let now = if height_m < low_m {
            Some(false)
        } else if height_m > high_m {
            Some(true)
        } else {
            continue;
        };
        changes += u32::from(upstairs.is_some() && upstairs != now);
        upstairs = now;
    }
    changes
}

#[cfg(test)]
mod tests {
    use super::crossings;

    #[test]
    fn who_turns_back_on_the_slope_has_not_crossed() {
        let count = |heights_m: &[f64]| crossings(heights_m.iter().copied(), [0.2, 1.6]);
        assert_eq!(count(&[]), 0);
        assert_eq!(count(&[0.0, 0.1, 1.5, 0.3, 0.0]), 0);
        assert_eq!(count(&[0.0, 0.8, 1.7, 1.5, 1.8]), 1);
        assert_eq!(count(&[1.8, 0.1, 0.9, 1.7, 0.9, 0.0]), 3);
        // Where it begins on the slope, the storey that it comes to first counts as its own.
        assert_eq!(count(&[0.9, 1.8, 0.9]), 0);
        assert_eq!(count(&[0.9, 1.8, 0.0]), 1);
    }

    #[test]
    fn a_height_at_a_threshold_is_on_the_slope() {
        assert_eq!(crossings([0.0, 1.6, 0.2, 1.6], [0.2, 1.6]), 0);
    }
}

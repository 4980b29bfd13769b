//! Half and double of a constant, within its range.

use fieldline_planner::{Tuned, Tuning};

/// Half of the default.
pub const HALF: f32 = 0.5;
/// Twice the default.
pub const DOUBLE: f32 = 2.0;

/// Returns the value of `constant` at `share` of its default, and the tuning with it.
///
/// The value is clamped to the range. A whole number is rounded; if that gives the default again,
/// the value is the next whole number. `None` if the range has no other value on that side.
#[must_use]
pub fn scaled(constant: &Tuned, share: f32) -> Option<(f32, Tuning)> {
    let Tuned {
        least,
        most,
        default,
        ..
    } = *constant;
    let exact = share * default;
    let next = default + if exact < default { -1.0 } else { 1.0 };
    let name = format!("{}.{}", constant.room, constant.name);
    [exact, exact.round(), next].into_iter().find_map(|value| {
        let value = value.clamp(least, most);
        let mut tuning = Tuning::DEFAULT;
        let is_set = value != default && tuning.set(&name, value).is_ok();
        is_set.then_some((value, tuning))
    })
}

#[cfg(test)]
mod tests {
    use super::{DOUBLE, HALF, scaled};
    use fieldline_planner::{Tuned, Tuning};

    /// Returns a constant with another range.
    fn within(least: f32, most: f32) -> Tuned {
        let mut found = None;
        Tuning::DEFAULT.parameters(|tuned| {
            if (tuned.room, tuned.name) == ("ouroboros", "least_behind_m") {
                found = Some(tuned);
            }
        });
        let tuned = found.expect("ouroboros has this constant");
        Tuned {
            least,
            most,
            ..tuned
        }
    }

    #[test]
    fn a_value_stays_within_the_range_and_is_not_the_default() {
        let value = |least, most, share| scaled(&within(least, most), share).map(|it| it.0);
        let default = within(0.0, 0.0).default;
        assert_eq!(value(0.5, 10.0, HALF), Some(0.5 * default));
        assert_eq!(value(0.5, 10.0, DOUBLE), Some(2.0 * default));
        assert_eq!(value(0.9 * default, 10.0, HALF), Some(0.9 * default));
        assert_eq!(value(0.5, default, DOUBLE), None);
    }

    #[test]
    fn only_the_constant_changes_and_every_constant_can() {
        Tuning::DEFAULT.parameters(|tuned| {
            let sides = [HALF, DOUBLE].map(|share| scaled(&tuned, share));
            assert!(sides.iter().any(Option::is_some), "{tuned}");
            for (value, tuning) in sides.into_iter().flatten() {
                let mut changed = Vec::new();
                tuning.parameters(|now| {
                    if now.value != now.default {
                        changed.push((now.name, now.value));
                    }
                });
                assert_eq!(changed, [(tuned.name, value)]);
            }
        });
    }
}

//! Limits of the ground: what a robot may use, and what it does not survive.
//!
//! A set has four numbers: the slope along the heading, the slope across it, the highest edge that
//! a wheel climbs, and the deepest edge that it goes down. There are two sets. The *working*
//! limits decide what counts as reachable and as traversable. Beyond the *failing* limits an edge
//! stops the robot, or it falls, or it tips over. Between the two it drives on, and the report
//! says for how long.
//!
//! Working: a climb of 20° (the data sheet of the 3-AT gives a grade of 35 %, 19.3°), 15° to the
//! side, edges of 0.07 m. Failing: a step of 0.10 m, from the data sheet; 30° and 25°; a drop of
//! 0.15 m, at which the wheelbase leans by 29°. With a wheelbase of 0.268 m, a track of 0.394 m
//! and the centre of mass 0.2 m up, the static margins are 34° and 45°; the rest is for bumps and
//! braking, which are not simulated.
//!
//! Angles in radians, lengths in metres. The text form has degrees and metres:
//! `climb=20,roll=15,step=0.07,drop=0.07`.

use core::fmt;

use crate::spec::{Form, SpecError};

/// Limits of the ground under a robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Greatest slope along the heading, up or down, radians.
    pub climb_rad: f64,
    /// Greatest slope across the heading, radians.
    pub roll_rad: f64,
    /// Highest edge that a wheel goes up, metres.
    pub step_m: f64,
    /// Deepest edge that a wheel goes down, metres.
    pub drop_m: f64,
}

impl Limits {
    /// Ground that the robot may use: 20°, 15°, 0.07 m, 0.07 m.
    pub const WORKING: Self = Self {
        climb_rad: 20.0 * DEGREE,
        roll_rad: 15.0 * DEGREE,
        step_m: 0.07,
        drop_m: 0.07,
    };

    /// Ground that the robot just survives: 30°, 25°, 0.10 m, 0.15 m.
    pub const FAILING: Self = Self {
        climb_rad: 30.0 * DEGREE,
        roll_rad: 25.0 * DEGREE,
        step_m: 0.10,
        drop_m: 0.15,
    };

    /// Returns true if an attitude is within the slopes.
    #[must_use]
    pub fn holds_attitude(&self, pitch_rad: f64, roll_rad: f64) -> bool {
        // The angles on a slope exactly at the limit have a rounding error.
        pitch_rad.abs() <= self.climb_rad + SLACK && roll_rad.abs() <= self.roll_rad + SLACK
    }

    /// Returns true if every limit of `self` is at most that of `other`.
    #[must_use]
    pub fn is_within(&self, other: &Self) -> bool {
        let pairs = self.numbers().into_iter().zip(other.numbers());
        pairs.into_iter().all(|(own, others)| own <= others)
    }

    fn numbers(&self) -> [f64; 4] {
        [self.climb_rad, self.roll_rad, self.step_m, self.drop_m]
    }
}

const DEGREE: f64 = core::f64::consts::PI / 180.0;
/// Rounding errors of heights and angles that do not break a limit; metres or radians.
pub(super) const SLACK: f64 = 1e-6;

const FORM: Form = Form {
    what: "limit",
    usage: "for instance climb=20,roll=15,step=0.07,drop=0.07 (degrees and metres, any of them)",
    repeated: "",
};

impl Limits {
    /// Returns these limits with the changes that a text names.
    ///
    /// # Errors
    /// [`SpecError`] for an unknown name, a value that is no number, an angle beyond 60° or a
    /// length beyond 1 m.
    pub fn changed(mut self, text: &str) -> Result<Self, SpecError> {
        FORM.read(text, |word| {
            let (slot, most, unit) = match word.key.as_str() {
                "climb=" => (&mut self.climb_rad, 60.0, DEGREE),
                "roll=" => (&mut self.roll_rad, 60.0, DEGREE),
                "step=" => (&mut self.step_m, 1.0, 1.0),
                "drop=" => (&mut self.drop_m, 1.0, 1.0),
                _ => return Err(word.unknown()),
            };
            let must = format!("above 0 and at most {most} (degrees and metres)");
            *slot = word.parse(|value: &f64| *value > 0.0 && *value <= most, &must)? * unit;
            Ok(())
        })?;
        Ok(self)
    }
}

impl fmt::Display for Limits {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // A hundredth of a degree is precise enough; adding 0 turns −0 into 0.
        let degrees = |rad: f64| (rad / DEGREE * 100.0).round() / 100.0 + 0.0;
        write!(
            f,
            "climb={},roll={},step={},drop={}",
            degrees(self.climb_rad),
            degrees(self.roll_rad),
            self.step_m,
            self.drop_m
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_changes_what_it_names() {
        let changed = Limits::WORKING.changed("climb=25, drop=0.05");
        let expected = Limits {
            climb_rad: 25.0 * DEGREE,
            drop_m: 0.05,
            ..Limits::WORKING
        };
        assert_eq!(changed, Ok(expected));
        assert_eq!(expected.to_string(), "climb=25,roll=15,step=0.07,drop=0.05");
        assert_eq!(Limits::WORKING.changed(&expected.to_string()), Ok(expected));
    }

    #[test]
    fn a_bad_limit_is_named() {
        for (text, word) in [
            ("", "climb=20"),
            ("climb", "'climb'; use for instance climb=20"),
            ("climb=nan", "'climb=nan'"),
            ("climb=61", "at most 60"),
            ("step=-0.1", "'step=-0.1'"),
            ("step=2", "at most 1"),
            ("tilt=3", "'tilt=3'; use for instance climb=20"),
        ] {
            let error = Limits::WORKING.changed(text).expect_err(text).to_string();
            assert!(error.contains(word), "{error}");
        }
    }

    #[test]
    fn the_working_limits_are_within_the_failing_ones() {
        assert!(Limits::WORKING.is_within(&Limits::FAILING));
        assert!(!Limits::FAILING.is_within(&Limits::WORKING));
        let [climb, side] = [Limits::WORKING.climb_rad, Limits::WORKING.roll_rad];
        assert!(Limits::WORKING.holds_attitude(-climb, side));
        assert!(!Limits::WORKING.holds_attitude(climb + 1e-3, 0.0));
        assert!(!Limits::WORKING.holds_attitude(0.0, -side - 1e-3));
    }
}

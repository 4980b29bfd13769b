//! The parameters of uneven ground as text, such as `h_obs=0.3,eps_gmax=0.5,roll=15`.
//!
//! The names are those of \[Maffei20, Table I\], and so are the defaults; `climb` and `roll`
//! (degrees) and `step` (metres) are the robot's own. A preference beyond ±2 is refused, because
//! the relaxation of the field would diverge.

use fieldline_protocol::message::{Preference, UnevenGround};
use fixed::types::{I4F12, I16F16};

use crate::spec::{Form, SpecError};

/// The values of \[Maffei20, Table I\], and the 3-AT's limits.
pub const TABLE_I: UnevenGround = UnevenGround {
    preference: Preference::Both,
    levels: has_levels(Preference::Both),
    obstacle: I4F12::lit("0.30"),
    near: I4F12::lit("1.5"),
    hole: I4F12::lit("-0.60"),
    least: I4F12::lit("-0.5"),
    most: I4F12::lit("0.5"),
    height_scale: I4F12::lit("2"),
    global_scale: I16F16::lit("0.005"),
    climb: I4F12::lit("0.349"),
    roll: I4F12::lit("0.349"),
    step: I4F12::lit("0.07"),
};

/// Returns true if goals have height levels by default: with a preference for heights.
#[must_use]
pub const fn has_levels(preference: Preference) -> bool {
    matches!(preference, Preference::Height | Preference::Both)
}

/// Converts degrees to the wire's radians, rounded to the nearest step, so that 20° equal the
/// default.
#[must_use]
pub fn radians(degrees: f64) -> I4F12 {
    let step = I4F12::DELTA.to_num::<f64>();
    I4F12::saturating_from_num((degrees.to_radians() / step).round() * step)
}

const FORM: Form = Form {
    what: "parameter",
    usage: "for instance h_obs=0.3,h_hole=-0.6,eps_gmax=0.5",
    repeated: "",
};

/// Returns the least and the greatest value of a parameter, and the reason.
fn bounds(name: &str) -> Option<([f64; 2], &'static str)> {
    let diverges = "beyond 2 the potential leaves [0, 1] and the relaxation diverges";
    Some(match name {
        "eps_hmin" => ([-2.0, 0.0], diverges),
        "eps_gmax" => ([0.0, 2.0], diverges),
        "h_obs" => ([0.01, 7.0], "it is a height in metres"),
        "d_obs" => ([0.01, 7.0], "it is a distance in metres"),
        "h_hole" => ([-7.0, -0.01], "it is a height below the ground in metres"),
        "lambda_h" => ([0.0, 7.0], "it is a scale"),
        "lambda_g" => ([0.0, 100.0], "it is a scale"),
        "climb" | "roll" => ([1.0, 45.0], "it is a slope in degrees"),
        "step" => ([0.01, 1.0], "it is a height in metres"),
        _ => return None,
    })
}

/// Returns these parameters with the changes that a text names.
///
/// # Errors
/// [`SpecError`] for an unknown name, a text that is no number, and a number out of range.
pub fn changed(mut ground: UnevenGround, text: &str) -> Result<UnevenGround, SpecError> {
    FORM.read(text, |word| {
        let Some(([least, most], reason)) = bounds(word.name()) else {
            return Err(word.unknown());
        };
        let must = format!("from {least} to {most}: {reason}");
        let value = word.number(least..=most, &must)?;
        let short = I4F12::saturating_from_num(value);
        match word.name() {
            "eps_hmin" => ground.least = short,
            "eps_gmax" => ground.most = short,
            "h_obs" => ground.obstacle = short,
            "d_obs" => ground.near = short,
            "h_hole" => ground.hole = short,
            "lambda_h" => ground.height_scale = short,
            "lambda_g" => ground.global_scale = I16F16::saturating_from_num(value),
            "climb" => ground.climb = radians(value),
            "roll" => ground.roll = radians(value),
            _ => ground.step = short,
        }
        Ok(())
    })?;
    Ok(ground)
}

#[cfg(test)]
mod tests {
    use super::{TABLE_I, changed};
    use fixed::types::{I4F12, I16F16};

    #[test]
    fn text_changes_the_named_parameters() {
        let ground = changed(TABLE_I, "h_hole=-0.75, lambda_g=0.25,eps_gmax=2").unwrap();
        assert_eq!(ground.hole, I4F12::lit("-0.75"));
        assert_eq!(ground.global_scale, I16F16::lit("0.25"));
        assert_eq!(ground.most, I4F12::lit("2"));
        assert_eq!(ground.least, TABLE_I.least);
    }

    #[test]
    fn a_roll_limit_as_large_as_the_climb_is_the_default() {
        assert_eq!(TABLE_I.roll, TABLE_I.climb);
        assert_eq!(changed(TABLE_I, "climb=20,roll=20").unwrap(), TABLE_I);
        let limited = changed(TABLE_I, "roll=15").unwrap();
        assert!(limited.roll < limited.climb);
        let error = changed(TABLE_I, "roll=0").unwrap_err().to_string();
        assert!(
            error.contains("'roll=0'; it must be from 1 to 45"),
            "{error}"
        );
    }

    #[test]
    fn a_preference_beyond_two_is_refused_with_the_reason() {
        for text in [
            "eps_gmax=2.1",
            "eps_hmin=-2.001",
            "eps_hmin=0.5",
            "eps_gmax=nan",
        ] {
            let error = changed(TABLE_I, text).unwrap_err().to_string();
            assert!(error.contains("diverges") && error.contains("2"), "{error}");
        }
    }

    #[test]
    fn the_bad_part_is_named() {
        for (text, word) in [
            ("", "eps_gmax=0.5"),
            ("h_obs", "'h_obs'; it must be"),
            ("h_obs=-1", "'h_obs=-1'"),
            ("h_hole=0.6", "below the ground"),
            (
                "gravity=9",
                "'gravity=9'; use for instance h_obs=0.3,h_hole=-0.6,eps_gmax=0.5",
            ),
        ] {
            let error = changed(TABLE_I, text).unwrap_err().to_string();
            assert!(error.contains(word), "{error}");
        }
    }
}

//! Tuned constants of the planner, one struct a room, with meaning, unit, range and default.
//!
//! A [`Tuning`] is constant during a session. A [`Config`](crate::Config) refers to it, so that on
//! a chip the defaults stay in flash. [`Tuning::parameters`] lists the active set, for a bug report
//! or a help page.
//!
//! Units: as each parameter says.

use core::fmt;

mod value;

use value::Value;

/// The description of a tuned constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuned {
    /// The room, for example `ground`.
    pub room: &'static str,
    /// The name of the field.
    pub name: &'static str,
    /// What the constant means.
    pub meaning: &'static str,
    /// The unit; `1` for a pure number.
    pub unit: &'static str,
    /// The least accepted value, in its unit.
    pub least: f32,
    /// The greatest accepted value, in its unit.
    pub most: f32,
    /// The default, in its unit.
    pub default: f32,
    /// The active value, in its unit.
    pub value: f32,
}

impl fmt::Display for Tuned {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            room, name, value, ..
        } = self;
        write!(f, "{room}.{name}={value}")
    }
}

/// Why a tuned constant cannot be set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TuningError {
    /// No constant has this name.
    Unknown,
    /// The value is out of its range, or not a number, or not a whole number where one is needed.
    OutOfRange {
        /// The least accepted value.
        least: f32,
        /// The greatest accepted value.
        most: f32,
    },
}

impl fmt::Display for TuningError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unknown => f.write_str("no tuned constant has this name"),
            Self::OutOfRange { least, most } => {
                write!(
                    f,
                    "the value must be within {least} and {most}, and whole if the default is"
                )
            }
        }
    }
}

impl core::error::Error for TuningError {}

/// Declares a struct of tuned constants: each with its meaning as a doc comment, its type, default,
/// range and unit.
macro_rules! tuning {
    (
        $(#[$attribute:meta])*
        $room:literal $name:ident {
            $(
                $(#[doc = $meaning:literal])+
                $field:ident: $type:ty = $default:expr,
                $least:literal..=$most:literal, $unit:literal;
            )*
        }
    ) => {
        $(#[$attribute])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $name {
            $(
                $(#[doc = $meaning])+
                #[doc = concat!(
                    "\n\nUnit: ", $unit,
                    ". Range: ", stringify!($least), " to ", stringify!($most),
                    ". Default: ", stringify!($default), "."
                )]
                pub $field: $type,
            )*
        }

        impl $name {
            /// The defaults.
            pub const DEFAULT: Self = Self { $($field: $default,)* };

            /// The number of constants.
            pub const COUNT: usize = 0 $(+ { let _ = stringify!($field); 1 })*;

            /// Calls `visit` with each constant and its description.
            pub(super) fn visit(
                &mut self,
                visit: &mut dyn FnMut(
                    &mut dyn $crate::config::tuning::value::Value,
                    $crate::config::tuning::Tuned,
                ),
            ) {
                use $crate::config::tuning::value::Value;
                $(
                    let description = $crate::config::tuning::Tuned {
                        room: $room,
                        name: stringify!($field),
                        meaning: concat!($($meaning),+).trim_ascii_start(),
                        unit: $unit,
                        least: $least as f32,
                        most: $most as f32,
                        default: Value::get(&Self::DEFAULT.$field),
                        value: Value::get(&self.$field),
                    };
                    visit(&mut self.$field, description);
                )*
            }
        }
    };
}

/// Joins the rooms' structs to one.
macro_rules! rooms {
    ($($module:ident: $name:ident, $doc:literal;)*) => {
        $(mod $module;)*
        $(pub use $module::$name;)*

        /// All tuned constants.
        ///
        /// ```
        /// use fieldline_planner::{LocaliseTuning, Tuned, Tuning, TuningError};
        ///
        /// let mut tuning = Tuning::DEFAULT;
        /// assert_eq!(tuning.set("no.such", 1.0), Err(TuningError::Unknown));
        /// assert_eq!(tuning.localise, LocaliseTuning::DEFAULT);
        /// tuning.parameters(|tuned: Tuned| println!("{tuned}: {} {}", tuned.meaning, tuned.unit));
        /// ```
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct Tuning {
            $(#[doc = $doc] pub $module: $name,)*
        }

        impl Tuning {
            /// The defaults.
            pub const DEFAULT: Self = Self { $($module: $name::DEFAULT,)* };
            /// The number of constants.
            pub const COUNT: usize = 0 $(+ $name::COUNT)*;

            fn visit(&mut self, visit: &mut dyn FnMut(&mut dyn Value, Tuned)) {
                $(self.$module.visit(visit);)*
            }
        }
    };
}

rooms! {
    ground: GroundTuning, "Uneven ground.";
    map: MapTuning, "The map.";
    localise: LocaliseTuning, "Localisation.";
    field: FieldTuning, "The window's field.";
    tdbvp: TdbvpTuning, "Rails of time.";
    ouroboros: OuroborosTuning, "Loop closing.";
    order: OrderTuning, "The order of goals.";
    sbpf: SbpfTuning, "Space-based potential field.";
}

impl Tuning {
    /// Calls `each` with the description of every constant, room by room.
    pub fn parameters(&self, mut each: impl FnMut(Tuned)) {
        // The visitor needs a place to write to: a copy.
        let mut copy = *self;
        copy.visit(&mut |_, tuned| each(tuned));
    }

    /// Sets the constant `room.name`.
    ///
    /// # Errors
    /// [`TuningError`]. Nothing is set then.
    pub fn set(&mut self, name: &str, value: f32) -> Result<(), TuningError> {
        let mut result = Err(TuningError::Unknown);
        self.visit(&mut |field, tuned| {
            let is_named = name
                .split_once('.')
                .is_some_and(|(room, name)| room == tuned.room && name == tuned.name);
            if is_named {
                let (least, most) = (tuned.least, tuned.most);
                let is_inside = value >= least && value <= most;
                result = if is_inside && field.set(value) {
                    Ok(())
                } else {
                    Err(TuningError::OutOfRange { least, most })
                };
            }
        });
        result
    }
}

#[cfg(test)]
mod tests {
    use super::{Tuning, TuningError};

    #[test]
    fn every_default_is_within_its_range_and_described() {
        let mut names = std::collections::BTreeSet::new();
        Tuning::DEFAULT.parameters(|tuned| {
            assert!(
                (tuned.least..=tuned.most).contains(&tuned.default),
                "{tuned}"
            );
            assert!(
                tuned.meaning.ends_with('.') && !tuned.unit.is_empty(),
                "{tuned}"
            );
            assert!(names.insert((tuned.room, tuned.name)), "{tuned} twice");
        });
        assert_eq!(names.len(), Tuning::COUNT);
    }

    #[test]
    fn every_constant_can_be_set_by_name_within_its_range() {
        Tuning::DEFAULT.parameters(|tuned| {
            let name = std::format!("{}.{}", tuned.room, tuned.name);
            let mut tuning = Tuning::DEFAULT;
            for value in [tuned.least, tuned.most] {
                assert_eq!(tuning.set(&name, value), Ok(()), "{name}");
                let mut found = None;
                tuning.parameters(|now| {
                    if (now.room, now.name) == (tuned.room, tuned.name) {
                        found = Some(now.value);
                    }
                });
                assert_eq!(found, Some(value), "{name}");
            }
            let too_large = tuning.set(&name, tuned.most * 1.01 + 1.0);
            assert!(
                matches!(too_large, Err(TuningError::OutOfRange { .. })),
                "{name}"
            );
            assert!(tuning.set(&name, f32::NAN).is_err(), "{name}");
        });
        let mut tuning = Tuning::DEFAULT;
        assert_eq!(tuning.set("ground.none", 1.0), Err(TuningError::Unknown));
    }
}

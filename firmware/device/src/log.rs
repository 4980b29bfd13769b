//! Log macros: those of defmt with the feature `defmt`, no log without it.

#[cfg(feature = "defmt")]
pub(crate) use defmt::{info, warn as warning};

/// Uses its values, so that no variable is unused, and writes nothing.
#[cfg(not(feature = "defmt"))]
macro_rules! nothing {
    ($text:literal $(, $value:expr)* $(,)?) => {{ $( let _ = &$value; )* }};
}
#[cfg(not(feature = "defmt"))]
pub(crate) use {nothing as info, nothing as warning};

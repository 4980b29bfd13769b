//! Log macros: defmt's with the feature `defmt`, nothing without.

#[cfg(feature = "defmt")]
pub(crate) use defmt::{info, warn as warning};

/// Evaluates its values, so that nothing is unused, and says nothing.
#[cfg(not(feature = "defmt"))]
macro_rules! nothing {
    ($text:literal $(, $value:expr)* $(,)?) => {{ $( let _ = &$value; )* }};
}
#[cfg(not(feature = "defmt"))]
pub(crate) use {nothing as info, nothing as warning};

//! Log macros: defmt's with the feature `defmt`, nothing without.

#[cfg(feature = "defmt")]
macro_rules! info {
    ($($message:tt)*) => { defmt::info!($($message)*) };
}
#[cfg(feature = "defmt")]
macro_rules! warning {
    ($($message:tt)*) => { defmt::warn!($($message)*) };
}

#[cfg(not(feature = "defmt"))]
macro_rules! info {
    ($text:literal $(, $value:expr)* $(,)?) => {{ $( let _ = &$value; )* }};
}
#[cfg(not(feature = "defmt"))]
macro_rules! warning {
    ($text:literal $(, $value:expr)* $(,)?) => {{ $( let _ = &$value; )* }};
}

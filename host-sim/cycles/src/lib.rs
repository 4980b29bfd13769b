#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

pub mod block;
pub mod chip;
pub mod decode;
pub mod flash;
pub mod instruction;
pub mod ledger;
mod lines;
pub mod price;
pub mod profile;
pub mod steps;
pub mod watcher;

/// Clock of the core, hertz.
pub const CLOCK_HZ: u32 = 168_000_000;

/// Name of the model: a table that was made by another one is not comparable.
pub const MODEL: &str = "stm32f405-168-1";

/// Returns the milliseconds of a number of cycles at [`CLOCK_HZ`].
#[must_use]
pub fn milliseconds(cycles: f64) -> f64 {
    cycles / (f64::from(CLOCK_HZ) / 1e3)
}

//! The image for the chip: its size, the bound of its stack, and runs of it in the emulator.
//!
//! Every case is ignored by default: it needs the Rust target of the chip, most cases need QEMU as
//! well. `tests/run` installs both and runs them.

mod decoder;
mod flat;
mod full;
mod loops;
mod matrix;
mod milliseconds;
mod sessions;
mod size;
mod space;
mod stack;
mod team;
mod uneven;

//! What the tests across crates have in common: runs, tables, golden files, the machine they run on.
//!
//! | file | what |
//! | --- | --- |
//! | [`golden`] | committed tables: compare, or rewrite with `BLESS=1` |
//! | [`random`] | seeded numbers |
//! | [`table`] | columns of text |
//! | [`runs`] | whole explorations, several at a time, and their row in a table |
//! | [`loops`] | tables of explorations that close loops, with the papers' ratios |
//! | [`history`] | what the map said of every cell, and when |
//! | [`watched`] | a link that is looked at after every step |
//! | [`uneven`] | whole explorations of uneven ground, and their row in a table |
//! | [`wilcoxon`] | the signed-rank test of paired runs |
//! | [`worlds`] | the built-in worlds by kind; worlds drawn by others, where there are any |
//! | [`plot`] | lines over a pair of axes, as an SVG |
//! | [`starts`] | starts drawn at random, for worlds that have but one |
//! | [`costs`] | instructions of a step on the emulated chip |
//! | [`emulator`] | the image and QEMU, or the word why not |
//! | [`elf`] | what an image takes of flash and memory |
//!
//! Three environment variables decide what a test run does: `BLESS=1` rewrites golden files, `FIELDLINE_FULL=1` adds
//! what takes long, `FIELDLINE_HIL=1` makes a missing emulator a failure instead of a skipped test, and `FIELDLINE_HIL=0`
//! leaves out what needs the image.

pub mod costs;
pub mod elf;
pub mod emulator;
pub mod golden;
pub mod history;
pub mod loops;
pub mod plot;
pub mod random;
pub mod runs;
pub mod starts;
pub mod table;
pub mod uneven;
pub mod watched;
pub mod wilcoxon;
pub mod worlds;

/// Whether what takes long was asked for (`FIELDLINE_FULL=1`, as `tests/run --full` says).
#[must_use]
pub fn full() -> bool {
    is_set("FIELDLINE_FULL")
}

fn is_set(name: &str) -> bool {
    std::env::var_os(name).is_some_and(|value| value == "1")
}

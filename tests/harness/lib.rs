//! What the cases share: runs, worlds, tables, golden files, and the chip's image.
//!
//! | module | content |
//! | --- | --- |
//! | [`golden`] | committed files: compare, or rewrite with `BLESS=1` |
//! | [`digests`] | digests of command streams, all in `golden/digests.txt` |
//! | [`random`] | the one source of seeded numbers |
//! | [`random_missions`] | missions drawn at random, with resets of the device, kills of its host |
//! | [`table`] | columns of text |
//! | [`runs`] | whole explorations, several at a time |
//! | [`flat`] | tables of explorations of flat worlds |
//! | [`flatness`] | how flat the field around the robot was in a run |
//! | [`loops`] | the table of explorations that close loops, with the papers' ratios |
//! | [`uneven`] | whole explorations of uneven ground, and their table |
//! | [`odometry`] | explorations with odometry that drifts, and their tables |
//! | [`truth`] | maps of uneven ground against the true ground |
//! | [`teams`] | explorations by teams, and their tables |
//! | [`meetings`] | robots that meet where there is no room to pass |
//! | [`history`] | every change of every map cell, with its time |
//! | [`watched`] | a link that is read after every step |
//! | [`worlds`] | the built-in worlds by kind; worlds drawn by others |
//! | [`places`] | pits and a building, found in a world's definition |
//! | [`orders`] | orders of frontiers beside one another, as ratios to a baseline |
//! | [`sessions`] | whole sessions of hostile hosts, and the corpus |
//! | [`fences`] | fences drawn at random around a start |
//! | [`starts`] | starts drawn at random in a flat world |
//! | [`ablation`] | every tuned constant at half and at double its default |
//! | [`bitmap`] | seeded bit maps; thinning and search cell by cell, as oracles |
//! | [`field`] | seeded windows of the field, and their solution in f64 |
//! | [`plot`] | lines over a pair of axes, as an SVG |
//! | [`costs`] | instructions of a step on the emulated chip |
//! | [`milliseconds`] | milliseconds of a step, by the model of the chip's cycles |
//! | [`emulator`] | the image for the chip, and QEMU |
//! | [`elf`] | flash and memory that an image takes |
//! | [`stack`] | bound of the stack that an image takes, from its machine code |
//!
//! Three environment variables have a meaning: `BLESS=1` rewrites golden files, `FIELDLINE_DATA`
//! names the folder with worlds drawn by others, and `ABLATION_RUNS` limits the runs of a room.
//! Cases that take hours, or that need what a machine may lack, are `#[ignore]`d with the
//! reason; `tests/README.md` says how to run them.

pub mod ablation;
pub mod bitmap;
pub mod costs;
pub mod digests;
pub mod elf;
pub mod emulator;
pub mod ends;
pub mod fences;
pub mod field;
pub mod flat;
pub mod flatness;
pub mod golden;
pub mod history;
pub mod loops;
pub mod meetings;
pub mod milliseconds;
pub mod odometry;
pub mod orders;
pub mod places;
pub mod plot;
pub mod random;
pub mod random_missions;
pub mod runs;
pub mod sessions;
pub mod stack;
pub mod starts;
pub mod table;
pub mod teams;
pub mod truth;
pub mod uneven;
pub mod watched;
pub mod worlds;

/// Runs the Rust in the project's pages as tests.
#[cfg(doctest)]
mod pages {
    #[doc = include_str!("../../README.md")]
    mod readme {}
    #[doc = include_str!("../../CONTRIBUTING.md")]
    mod contributing {}
}

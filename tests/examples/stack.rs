//! Bound of the stack of an image: `cargo run -p fieldline-tests --example stack [-- ELF]`.
//!
//! Without a file it builds the image. It ends with an error if there is a call of which no rule
//! says whom it reaches.

use std::path::PathBuf;
use std::process::ExitCode;

use fieldline_tests::{emulator, stack};

fn main() -> ExitCode {
    let path = std::env::args()
        .nth(1)
        .map_or_else(emulator::image, PathBuf::from);
    let program = match stack::read(&path) {
        Ok(program) => program,
        Err(error) => {
            eprintln!("{error}");
            return ExitCode::FAILURE;
        }
    };
    let bounds = stack::bounds(&program, &stack::RULES);
    print!("{}", stack::report(&program, &bounds));
    bounds.unknown.iter().for_each(|it| eprintln!("{it}"));
    ExitCode::from(u8::from(!bounds.unknown.is_empty()))
}

//! `host-sim`: explore worlds, list them, solve a window. See `README.md` beside this crate.
#![forbid(unsafe_code)]

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::main()
}

//! `host-sim solve`: solves one window from a file; prints the answer and writes the field.

use std::fs;
use std::path::Path;

use anyhow::{Context as _, Result, anyhow};

use host_sim::solve;
use host_sim::solve::sheet::{self, Sheet};

use super::args::SolveArgs;
use super::{note, say};

/// Solves one window.
pub(super) fn run(args: &SolveArgs) -> Result<()> {
    let drawn = read(&args.window)?;
    let sheet = Sheet::parse(&drawn).with_context(|| args.window.display().to_string())?;
    let epsilon = match &args.preference {
        None => None,
        Some(path) => {
            let rows = sheet::preferences(&read(path)?, &sheet);
            Some(rows.with_context(|| path.display().to_string())?)
        }
    };
    let solved = solve::run(&sheet, epsilon.as_deref(), args.solver);
    if let Some(path) = &args.out {
        fs::write(path, solved.csv()).map_err(|error| {
            anyhow!(
                "cannot write {} ({error}); choose another --out",
                path.display()
            )
        })?;
        note(&format!("field written to {}", path.display()));
    }
    if args.json {
        say(&solved.answer.to_json_line())
    } else {
        say(&solved.answer.to_text())
    }
}

fn read(path: &Path) -> Result<String> {
    let bytes = fs::read(path).map_err(|error| {
        anyhow!(
            "cannot read {} ({error}); give an existing file",
            path.display()
        )
    })?;
    String::from_utf8(bytes)
        .ok()
        .with_context(|| format!("{} is no text; give a plain text file", path.display()))
}

//! Outcomes on the disk, one line a run, so that an interrupted ablation goes on where it stopped.
//!
//! A store belongs to one program: its file's name has the hash of the executable. After any change
//! of the code all runs are made again.

use core::hash::{Hash as _, Hasher as _};
use std::collections::HashMap;
use std::fs::{File, OpenOptions};
use std::hash::DefaultHasher;
use std::io::{self, Write as _};
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use super::effect::Outcome;

/// The store.
#[derive(Debug)]
pub struct Store {
    known: HashMap<String, Outcome>,
    file: Mutex<File>,
}

impl Store {
    /// Opens the store of this program in a folder.
    ///
    /// # Errors
    /// If the program or the file cannot be read.
    pub fn open(folder: &Path) -> io::Result<Self> {
        let mut hash = DefaultHasher::new();
        std::fs::read(std::env::current_exe()?)?.hash(&mut hash);
        let path = folder.join(format!("ablation-{:016x}.txt", hash.finish()));
        let file = OpenOptions::new().create(true).append(true).open(&path)?;
        let text = std::fs::read_to_string(&path)?;
        let known = text.lines().filter_map(|line| {
            let (key, outcome) = line.split_once(' ')?;
            Some((key.to_owned(), Outcome::parse(outcome)?))
        });
        Ok(Self {
            known: known.collect(),
            file: Mutex::new(file),
        })
    }

    /// Returns the outcome of `key`; makes and stores it if the store does not have it.
    ///
    /// # Panics
    /// If the file cannot be written.
    pub fn get_or(&self, key: &str, make: impl FnOnce() -> Outcome) -> Outcome {
        if let Some(outcome) = self.known.get(key) {
            return outcome.clone();
        }
        let outcome = make();
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        // One write a line: an interrupted line is shorter, and is not parsed.
        let line = format!("{key} {outcome}\n");
        if let Err(error) = file.write_all(line.as_bytes()) {
            panic!("cannot store an outcome: {error}");
        }
        outcome
    }
}

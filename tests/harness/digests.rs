//! Digests of command streams, all in one file: `golden/digests.txt`, one line for each run.
//!
//! ```text
//! WORLD STRATEGY SETTINGS START SEED DIGEST TABLES
//! ```
//!
//! The first five words say which run it is. The link is not among them, because a run gives the
//! same commands over every link. `SETTINGS` is `-` for the usual ones. `DIGEST` is the first 8 of
//! the 32 digits of the report. `TABLES` lists the golden tables with figures of that run. Lines
//! are sorted.
//!
//! Equal digests mean that every velocity and every status of the run is the same, bit for bit.
//! A change of the drive rewrites digests here; figure tables change only where figures do.

use core::fmt;
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use host_sim::report::Report;

use crate::golden;

/// Name of the file.
const FILE: &str = "digests.txt";
/// First lines of the file.
const HEAD: &str = "\
# Digests of command streams. BLESS=1 before a test rewrites the lines of its tables.
# world strategy settings start seed digest tables
";
/// Digits of a digest that are kept.
const DIGITS: usize = 8;

/// Guards the file: cases of one binary run at the same time.
static LOCK: Mutex<()> = Mutex::new(());

/// Everything that decides a run.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Key {
    world: String,
    strategy: String,
    settings: String,
    start: usize,
    seed: u64,
}

/// A run and the digest of its commands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Digest {
    key: Key,
    digest: String,
}

impl Digest {
    /// Returns the digest of a run. `settings` says what differs from the usual mission, without
    /// spaces; it is `-` if nothing does.
    #[must_use]
    pub fn of(report: &Report, settings: &str) -> Self {
        Self {
            key: Key {
                world: report.world.clone(),
                strategy: report.strategy.clone(),
                settings: settings.into(),
                start: report.start,
                seed: report.seed,
            },
            digest: report.digest.chars().take(DIGITS).collect(),
        }
    }

    /// Returns the digests of runs with the same settings.
    #[must_use]
    pub fn of_all(reports: &[Report], settings: &str) -> Vec<Self> {
        let digest = |report| Self::of(report, settings);
        reports.iter().map(digest).collect()
    }
}

/// The file: digest and tables of every run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Book(BTreeMap<Key, (String, Vec<String>)>);

impl Book {
    /// Reads the text of the file; returns `None` if a line has not seven words.
    fn parse(text: &str) -> Option<Self> {
        let lines = text.lines().filter(|line| !line.starts_with('#'));
        let entry = |line: &str| {
            let words: Vec<&str> = line.split(' ').collect();
            let [world, strategy, settings, start, seed, digest, tables] = words[..] else {
                return None;
            };
            let key = Key {
                world: world.into(),
                strategy: strategy.into(),
                settings: settings.into(),
                start: start.parse().ok()?,
                seed: seed.parse().ok()?,
            };
            let tables = tables.split(',').map(str::to_owned).collect();
            Some((key, (digest.to_owned(), tables)))
        };
        lines.map(entry).collect::<Option<_>>().map(Self)
    }

    /// Makes `runs` the runs of a table. A run that is in no table any more is dropped.
    fn set(&mut self, table: &str, runs: &[Digest]) {
        for (_, tables) in self.0.values_mut() {
            tables.retain(|name| name != table);
        }
        for run in runs {
            let (digest, tables) = self.0.entry(run.key.clone()).or_default();
            digest.clone_from(&run.digest);
            tables.push(table.to_owned());
            tables.sort();
        }
        self.0.retain(|_, (_, tables)| !tables.is_empty());
    }
}

impl fmt::Display for Book {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(HEAD)?;
        for (key, (digest, tables)) in &self.0 {
            let (start, seed, tables) = (key.start, key.seed, tables.join(","));
            let (world, strategy, settings) = (&key.world, &key.strategy, &key.settings);
            writeln!(
                f,
                "{world} {strategy} {settings} {start} {seed} {digest} {tables}"
            )?;
        }
        Ok(())
    }
}

/// Compares the digests of the runs behind a golden table with the file; `BLESS=1` rewrites the
/// table's lines.
///
/// # Panics
/// If a digest differs, a run has no line, or a line of the table has no run.
pub fn compare(table: &str, runs: &[Digest]) {
    let guard = LOCK.lock().unwrap_or_else(PoisonError::into_inner);
    let path = golden::path(FILE);
    let text = golden::read(&path);
    let Some(mut book) = Book::parse(&text) else {
        panic!("{} has a line that is no run", path.display());
    };
    book.set(table, runs);
    let now = book.to_string();
    let same = now == text || golden::bless(&path, &now);
    drop(guard);
    assert!(
        same,
        "{} differs in runs of {table} (- golden, + now); BLESS=1 rewrites it:\n{}",
        path.display(),
        only_in_one(&text, &now)
    );
}

/// Lists the lines that only one of two texts has.
fn only_in_one(old: &str, new: &str) -> String {
    let missing = |from: &str, other: &str, sign: char| {
        let lines = from
            .lines()
            .filter(|line| !other.lines().any(|o| o == *line));
        lines
            .map(|line| format!("{sign} {line}\n"))
            .collect::<String>()
    };
    missing(old, new, '-') + &missing(new, old, '+')
}

#[cfg(test)]
mod tests {
    use super::{Book, Digest, HEAD, Key, only_in_one};
    use crate::golden;

    fn digest(world: &str, seed: u64, digest: &str) -> Digest {
        let key = Key {
            world: world.into(),
            strategy: "bvp".into(),
            settings: "-".into(),
            start: 0,
            seed,
        };
        let digest = digest.into();
        Digest { key, digest }
    }

    #[test]
    fn the_committed_file_is_in_the_form_that_a_test_writes() {
        let text = golden::read(&golden::path(super::FILE));
        let book = Book::parse(&text).expect("seven words a line");
        assert!(book.to_string() == text);
        assert!(book.0.len() > 1000);
        for table in book.0.values().flat_map(|(_, tables)| tables) {
            let path = golden::path(&format!("{table}.txt"));
            assert!(path.is_file(), "{} has no figures", path.display());
        }
    }

    #[test]
    fn a_run_of_two_tables_has_one_line() {
        let mut book = Book::default();
        book.set("b", &[digest("hall", 10, "01"), digest("hall", 9, "02")]);
        book.set("a", &[digest("hall", 9, "03")]);
        let lines = "hall bvp - 0 9 03 a,b\nhall bvp - 0 10 01 b\n";
        assert_eq!(book.to_string(), format!("{HEAD}{lines}"));
        assert_eq!(Book::parse(&book.to_string()), Some(book));
    }

    #[test]
    fn a_run_that_no_table_has_is_dropped() {
        let mut book = Book::default();
        book.set("a", &[digest("hall", 0, "01"), digest("cave", 0, "02")]);
        book.set("a", &[digest("cave", 0, "02")]);
        assert_eq!(book.to_string(), format!("{HEAD}cave bvp - 0 0 02 a\n"));
        assert_eq!(Book::parse("hall bvp - 0 0 01\n"), None);
    }

    #[test]
    fn a_changed_digest_is_two_lines_of_the_message() {
        assert_eq!(
            only_in_one("a 1\nb 2\nc 3\n", "a 1\nb 4\nc 3\n"),
            "- b 2\n+ b 4\n"
        );
    }
}

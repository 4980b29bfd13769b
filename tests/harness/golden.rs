//! Golden files: committed results. A change of behaviour is a changed row in a review.
//!
//! `tests/golden/NAME` holds the result of the last run with `BLESS=1`. Without it a case compares:
//! byte for byte, or number by number within a share where figures depend on the compiler.
//! [`bless`] is the one place that decides and writes.

use std::fs;
use std::path::{Path, PathBuf};

use crate::digests::{self, Digest};

/// Returns the path of golden file `name`.
#[must_use]
pub fn path(name: &str) -> PathBuf {
    root().join("tests/golden").join(name)
}

/// Root of the repository.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Reads a golden file; returns an empty text if it does not exist.
pub(crate) fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_default()
}

/// Writes `text` to `path` if `BLESS=1` is set. Returns true if it is set.
///
/// # Panics
/// If the file cannot be written.
pub fn bless(path: &Path, text: &str) -> bool {
    let blessing = std::env::var_os("BLESS").is_some_and(|value| value == "1");
    if blessing && let Err(error) = fs::write(path, text) {
        panic!("cannot write {}: {error}", path.display());
    }
    blessing
}

/// Compares `text` with golden file `name`, byte for byte; `BLESS=1` rewrites the file.
///
/// # Panics
/// If they differ. The message lists every line that differs.
pub fn compare(name: &str, text: &str) {
    compare_about(name, text, 0.0);
}

/// Compares figures with golden table `name`.txt, then the runs' digests with those of the table.
///
/// # Panics
/// If either differs.
pub fn compare_runs(name: &str, text: &str, runs: &[Digest]) {
    compare(&format!("{name}.txt"), text);
    digests::compare(name, runs);
}

/// Compares `text` with golden file `name`. Numbers may differ by `share` of the golden number;
/// if `share` is 0, the texts must be equal. `BLESS=1` rewrites the file.
///
/// # Panics
/// If they differ by more. The message lists every line that differs.
pub fn compare_about(name: &str, text: &str, share: f64) {
    let path = path(name);
    if bless(&path, text) {
        return;
    }
    let golden = read(&path);
    let same_lines = golden.lines().count() == text.lines().count();
    let mut pairs = golden.lines().zip(text.lines());
    let near = share > 0.0 && same_lines && pairs.all(|(old, new)| is_about(old, new, share));
    assert!(
        golden == text || near,
        "{} differs by more than {} % (- golden, + now); BLESS=1 rewrites it:\n{}",
        path.display(),
        share * 100.0,
        differences(&golden, text)
    );
}

/// Compares `text` with the part of the documentation between the marks `<!-- NAME -->` and
/// `<!-- /NAME -->`, in `README.md` or in a page of `docs/`. `BLESS=1` rewrites that part.
///
/// # Panics
/// If they differ, or if no page has the marks.
pub fn compare_with_docs(name: &str, text: &str) {
    let page = pages().into_iter().find_map(|path| {
        let page = read(&path);
        let parts = parts(&page, name)?.map(str::to_owned);
        Some((path, parts))
    });
    let Some((path, [before, between, after])) = page else {
        panic!("neither README.md nor a page of docs/ has a part <!-- {name} -->");
    };
    if between == text || bless(&path, &format!("{before}{text}{after}")) {
        return;
    }
    panic!(
        "{} differs at <!-- {name} --> (- page, + now); BLESS=1 rewrites it:\n{}",
        path.display(),
        differences(&between, text)
    );
}

/// Paths of `README.md` and of the pages of `docs/`.
fn pages() -> Vec<PathBuf> {
    let mut pages = vec![root().join("README.md")];
    if let Ok(entries) = root().join("docs").read_dir() {
        let paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
        pages.extend(paths.filter(|path| path.extension().is_some_and(|end| end == "md")));
    }
    pages.sort();
    pages
}

/// Splits a page into the text before, between and after the marks of a name. The marks belong to
/// the outer parts.
fn parts<'a>(text: &'a str, name: &str) -> Option<[&'a str; 3]> {
    let (open, close) = (format!("<!-- {name} -->\n"), format!("<!-- /{name} -->"));
    let begin = text.find(&open)? + open.len();
    let end = begin + text.get(begin..)?.find(&close)?;
    Some([text.get(..begin)?, text.get(begin..end)?, text.get(end..)?])
}

/// Returns true if two lines have the same words, and numbers within `share` of the old ones.
fn is_about(old: &str, new: &str, share: f64) -> bool {
    let near = |(a, b): (&str, &str)| match (a.parse::<f64>(), b.parse::<f64>()) {
        (Ok(was), Ok(is)) => (is - was).abs() <= share * was.abs(),
        _ => a == b,
    };
    let count = |line: &str| line.split_whitespace().count();
    count(old) == count(new) && old.split_whitespace().zip(new.split_whitespace()).all(near)
}

/// Lists the lines that differ, in their order.
pub(crate) fn differences(golden: &str, text: &str) -> String {
    let (old, new): (Vec<_>, Vec<_>) = (golden.lines().collect(), text.lines().collect());
    let mut lines = String::new();
    for k in 0..old.len().max(new.len()) {
        let (was, is) = (old.get(k), new.get(k));
        if was == is {
            continue;
        }
        for (sign, line) in [('-', was), ('+', is)] {
            if let Some(line) = line {
                lines.push_str(&format!("{sign} {line}\n"));
            }
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::{differences, is_about, parts};

    #[test]
    fn numbers_may_drift_and_words_may_not() {
        assert!(is_about("loop   100 2.00", "loop 104  1.91", 0.05));
        assert!(!is_about("loop 100", "loop 106", 0.05));
        assert!(!is_about("loop 100", "pool 100", 0.05));
        assert!(!is_about("loop 100", "loop 100 1", 0.05));
        assert!(!is_about("loop 0", "loop 1", 0.05));
        assert!(!is_about("loop -", "loop 1", 0.05));
    }

    #[test]
    fn a_part_lies_between_its_marks() {
        let text = "a\n<!-- x -->\nb\nc\n<!-- /x -->\nd\n";
        let [before, between, after] = parts(text, "x").expect("both marks");
        assert_eq!((before, between), ("a\n<!-- x -->\n", "b\nc\n"));
        assert_eq!(after, "<!-- /x -->\nd\n");
        assert_eq!(parts(text, "y"), None);
        assert_eq!(parts("<!-- /x --><!-- x -->\n", "x"), None);
    }

    #[test]
    fn only_lines_that_differ_are_shown() {
        assert_eq!(differences("a\nb\nc\n", "a\nB\nc\nd\n"), "- b\n+ B\n+ d\n");
        assert_eq!(differences("a\n", "a\n"), "");
    }
}

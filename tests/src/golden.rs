//! Golden files: tables that are committed, so that a change of behaviour is a changed row in a review.
//!
//! `tests/golden/NAME` holds what the test last wrote with `BLESS=1`. Without it the test compares: byte for byte, or, where
//! figures depend on the compiler, number by number within a share of each.

use std::fs;
use std::path::PathBuf;

/// Where golden file `name` lies.
#[must_use]
pub fn path(name: &str) -> PathBuf {
    [env!("CARGO_MANIFEST_DIR"), "golden", name]
        .iter()
        .collect()
}

/// Whether golden files are to be rewritten.
#[must_use]
pub fn blessing() -> bool {
    crate::is_set("BLESS")
}

/// What golden file `name` holds; nothing if there is none.
#[must_use]
pub fn read(name: &str) -> String {
    fs::read_to_string(path(name)).unwrap_or_default()
}

/// Rewrite golden file `name`.
///
/// # Panics
/// If it cannot be written.
pub fn write(name: &str, text: &str) {
    let path = path(name);
    if let Err(error) = fs::write(&path, text) {
        panic!("cannot write {}: {error}", path.display());
    }
}

/// Compare with golden file `name`, or rewrite it where that is asked for.
///
/// # Panics
/// If they differ, with every line that does.
pub fn compare(name: &str, text: &str) {
    if blessing() {
        return write(name, text);
    }
    let golden = read(name);
    assert!(
        golden == text,
        "{} differs (- golden, + now); BLESS=1 rewrites it:\n{}",
        path(name).display(),
        differences(&golden, text)
    );
}

/// Compare with what the read-me at the root says between the marks `<!-- NAME -->` and `<!-- /NAME -->`, or rewrite that where it is asked for.
///
/// # Panics
/// If they differ, or the marks are not there.
pub fn compare_with_readme(name: &str, text: &str) {
    let path: PathBuf = [env!("CARGO_MANIFEST_DIR"), "..", "README.md"]
        .iter()
        .collect();
    let readme = fs::read_to_string(&path).unwrap_or_default();
    let Some([before, between, after]) = parts(&readme, name) else {
        panic!("README.md has no part <!-- {name} -->");
    };
    if between == text {
        return;
    }
    assert!(
        blessing(),
        "README.md differs at <!-- {name} --> (- read-me, + now); BLESS=1 rewrites it:\n{}",
        differences(between, text)
    );
    if let Err(error) = fs::write(&path, format!("{before}{text}{after}")) {
        panic!("cannot write {}: {error}", path.display());
    }
}

/// What lies before, between and after the marks of a name; the marks belong to the outer parts.
fn parts<'a>(text: &'a str, name: &str) -> Option<[&'a str; 3]> {
    let (open, close) = (format!("<!-- {name} -->\n"), format!("<!-- /{name} -->"));
    let begin = text.find(&open)? + open.len();
    let end = begin + text.get(begin..)?.find(&close)?;
    Some([text.get(..begin)?, text.get(begin..end)?, text.get(end..)?])
}

/// Compare with golden file `name`, where numbers may differ by `share` of the golden one; or rewrite it where that is asked
/// for.
///
/// # Panics
/// If they differ by more, with every line that does.
pub fn compare_about(name: &str, text: &str, share: f64) {
    if blessing() {
        return write(name, text);
    }
    let golden = read(name);
    let lines = golden.lines().count() == text.lines().count();
    let pairs = || golden.lines().zip(text.lines());
    assert!(
        lines && pairs().all(|(old, new)| is_about(old, new, share)),
        "{} differs by more than {} % (- golden, + now); BLESS=1 rewrites it:\n{}",
        path(name).display(),
        share * 100.0,
        differences(&golden, text)
    );
}

/// Whether two lines have the same words, and numbers that are near.
fn is_about(old: &str, new: &str, share: f64) -> bool {
    let near = |(a, b): (&str, &str)| match (a.parse::<f64>(), b.parse::<f64>()) {
        (Ok(was), Ok(is)) => (is - was).abs() <= share * was.abs(),
        _ => a == b,
    };
    let count = |line: &str| line.split_whitespace().count();
    count(old) == count(new) && old.split_whitespace().zip(new.split_whitespace()).all(near)
}

/// The lines that differ, in their order.
fn differences(golden: &str, text: &str) -> String {
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

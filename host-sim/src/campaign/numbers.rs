//! Whole numbers as lists and ranges: `3`, `0..10`, `0,2,5..8`. A range is without its end.

/// Most numbers of one list.
const MOST: u64 = 1_000_000;

/// Parses numbers.
///
/// # Errors
/// A part that is no number and no range, an empty or very long list, or a number that is twice in
/// it.
pub fn parse(text: &str) -> Result<Vec<u64>, String> {
    let mut numbers = Vec::new();
    for part in text.split(',') {
        let range = range(part.trim()).ok_or_else(|| {
            format!("'{part}' is no number and no range; say 3, or 0..10, which is without 10")
        })?;
        if range.end - range.start + numbers.len() as u64 > MOST {
            return Err(format!("'{text}' has more than {MOST} numbers"));
        }
        numbers.extend(range);
    }
    distinct(numbers)
}

/// Returns the numbers; refuses a number that is there twice, and an empty list.
///
/// # Errors
/// The number that is there twice, or that the list is empty.
pub fn distinct(numbers: Vec<u64>) -> Result<Vec<u64>, String> {
    let mut sorted = numbers.clone();
    sorted.sort_unstable();
    match sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        _ if sorted.is_empty() => Err("give at least one number".into()),
        Some(pair) => Err(format!("{} is there twice", pair[0])),
        None => Ok(numbers),
    }
}

/// Returns the numbers as text that [`parse`] takes.
#[must_use]
pub fn text(numbers: &[u64]) -> String {
    let runs = numbers.chunk_by(|a, b| a.checked_add(1) == Some(*b));
    let words = runs.map(|run| match run {
        [first, .., last] if *last < u64::MAX => format!("{first}..{}", last + 1),
        run => run.iter().map(u64::to_string).collect::<Vec<_>>().join(","),
    });
    words.collect::<Vec<_>>().join(",")
}

fn range(part: &str) -> Option<core::ops::Range<u64>> {
    let range = match part.split_once("..") {
        Some((from, to)) => from.parse().ok()?..to.parse().ok()?,
        None => {
            let number: u64 = part.parse().ok()?;
            number..number.checked_add(1)?
        }
    };
    Some(range).filter(|range| !range.is_empty())
}

#[cfg(test)]
mod tests {
    use super::{parse, text};

    #[test]
    fn lists_and_ranges_are_read_and_written() {
        assert_eq!(parse("0..3"), Ok(vec![0, 1, 2]));
        assert_eq!(parse("7, 0..2"), Ok(vec![7, 0, 1]));
        for written in ["0..3", "7", "7,0..2", "1,3,5"] {
            assert_eq!(text(&parse(written).unwrap()), written);
        }
    }

    #[test]
    fn bad_lists_are_refused() {
        for (bad, word) in [
            ("", "''"),
            ("a..b", "'a..b'"),
            ("3..3", "'3..3'"),
            ("5..2", "'5..2'"),
            ("-1", "'-1'"),
            ("0..3,2", "2 is there twice"),
            ("0..9999999999", "more than"),
        ] {
            let error = parse(bad).unwrap_err();
            assert!(error.contains(word), "{bad}: {error}");
        }
    }
}

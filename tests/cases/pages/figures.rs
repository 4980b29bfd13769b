//! Figures of a text, and whether a golden file has them.
//!
//! A figure is a number with a point, a number of at least 10, or any number with a unit. It is
//! golden if a number of the file rounds to it. Per cent may be a share there, millions ones, KB
//! bytes, and centimetres and millimetres metres.

/// Units that make a figure of a small number too.
const UNITS: [&str; 20] = [
    "%", "°", "m ", "m.", "m,", "m)", "m²", "s ", "s.", "s,", "s)", "cm", "mm", "ms", "KB", "MB",
    "bytes", "million", "minutes", "hours",
];

/// A number of a text.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Figure {
    /// As it stands there.
    pub(crate) text: String,
    value: f64,
    /// Half of its last digit.
    half: f64,
    /// What stands behind it.
    unit: Option<&'static str>,
}

/// Returns the numbers of a text that belong to no word, such as in `STM32` or `3-DX`.
pub(crate) fn numbers(text: &str) -> Vec<Figure> {
    let mut numbers = Vec::new();
    let mut rest = text;
    let mut before = ' ';
    while let Some(first) = rest.chars().next() {
        if !first.is_ascii_digit() {
            let is_minus = first == '-' && before.is_alphanumeric();
            before = if is_minus { 'a' } else { first };
            rest = &rest[first.len_utf8()..];
            continue;
        }
        let length = length(rest);
        let (number, after) = rest.split_at(length);
        let mut next = after.chars();
        let ends = match next.next() {
            Some('-') => !next.next().is_some_and(char::is_alphabetic),
            // A version.
            Some('.') => !next.next().is_some_and(|next| next.is_ascii_digit()),
            next => !next.is_some_and(|next| next.is_alphabetic() || next == '_'),
        };
        if ends && !before.is_alphabetic() && before != '_' {
            numbers.extend(Figure::new(number, after));
        }
        before = '0';
        rest = after;
    }
    numbers
}

/// Returns the figures of a text.
pub(crate) fn figures(text: &str) -> Vec<Figure> {
    let is_figure = |it: &Figure| it.text.contains('.') || it.value >= 10.0 || it.unit.is_some();
    numbers(text).into_iter().filter(is_figure).collect()
}

/// Returns the length of the number at the beginning of a text: digits, commas before three more,
/// a point before more, an exponent.
fn length(text: &str) -> usize {
    let digits = |from: usize| {
        let rest = text.get(from..).unwrap_or_default();
        rest.bytes().take_while(u8::is_ascii_digit).count()
    };
    let has = |at: usize, sign: &str| text.get(at..).is_some_and(|it| it.starts_with(sign));
    let mut end = digits(0);
    while has(end, ",") && digits(end + 1) == 3 {
        end += 4;
    }
    if has(end, ".") && digits(end + 1) > 0 {
        end += 1 + digits(end + 1);
    }
    for sign in ["e-", "e"] {
        let from = end + sign.len();
        if has(end, sign) && digits(from) > 0 {
            return from + digits(from);
        }
    }
    end
}

impl Figure {
    fn new(number: &str, after: &str) -> Option<Self> {
        let plain = number.replace(',', "");
        let (mantissa, exponent) = plain.split_once('e').unwrap_or((&plain, "0"));
        let digits = mantissa
            .split_once('.')
            .map_or(0, |(_, digits)| digits.len());
        let last = exponent.parse::<i32>().ok()? - i32::try_from(digits).ok()?;
        let after = after.trim_start();
        Some(Self {
            text: number.into(),
            value: plain.parse().ok()?,
            half: 0.5 * 10_f64.powi(last),
            unit: UNITS.into_iter().find(|unit| after.starts_with(unit)),
        })
    }

    /// Returns true if `value` rounds to this figure.
    pub(crate) fn rounds(&self, value: f64) -> bool {
        (self.value - value).abs() <= self.half * 1.000_001
    }

    /// Returns true if one of the golden numbers rounds to this figure.
    pub(crate) fn is_among(&self, golden: &[Self]) -> bool {
        let scale = match self.unit {
            Some("%") => 100.0,
            Some("million") => 1e-6,
            Some("KB") => 1.0 / 1024.0,
            Some("cm") => 100.0,
            Some("mm") => 1000.0,
            _ => 1.0,
        };
        golden
            .iter()
            .any(|it| self.rounds(it.value) || self.rounds(it.value * scale))
    }
}

/// Returns the value of terms such as `267.7 / 187.4 - 1`, from left to right.
///
/// # Errors
/// If an operand is neither 1 nor 100 nor golden, or an operator is unknown.
pub(crate) fn evaluated(terms: &str, golden: &[Figure]) -> Result<f64, String> {
    let mut words = terms.split(' ');
    let operand = |word: Option<&str>| {
        let word = word.unwrap_or_default();
        let figure = Figure::new(word, "").ok_or(format!("'{word}' is no number"))?;
        if !matches!(word, "1" | "100") && !figure.is_among(golden) {
            return Err(format!("{word} is in no golden file of the section"));
        }
        Ok(figure.value)
    };
    let mut value = operand(words.next())?;
    while let Some(operator) = words.next() {
        let next = operand(words.next())?;
        value = match operator {
            "+" => value + next,
            "-" => value - next,
            "*" => value * next,
            "/" => value / next,
            _ => return Err(format!("'{operator}' is no operator")),
        };
    }
    Ok(value)
}

//! The known name that an unknown one is nearest to.

/// Least likeness of a name that is suggested, from 0 to 1 [Winkler 1990].
const ALIKE: f64 = 0.8;

/// Returns `; did you mean X?` if a known name is near, or else nothing.
#[must_use]
pub fn hint<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    let likeness = |other: &str| strsim::jaro_winkler(name, other);
    let nearest = known
        .into_iter()
        .max_by(|a, b| likeness(a).total_cmp(&likeness(b)));
    match nearest.filter(|nearest| likeness(nearest) >= ALIKE) {
        Some(nearest) => format!("; did you mean {nearest}?"),
        None => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::hint;

    #[test]
    fn a_near_name_is_suggested_and_a_far_one_is_not() {
        let known = ["worlds", "strategies", "seeds"];
        assert_eq!(hint("word", known), "; did you mean worlds?");
        assert_eq!(hint("seed", known), "; did you mean seeds?");
        assert_eq!(hint("x", known), "");
        assert_eq!(hint("x", []), "");
    }
}

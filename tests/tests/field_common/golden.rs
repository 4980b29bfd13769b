//! Committed results: a change of behaviour is a diff in review.

/// Compare with a golden file, or write it if the environment says `BLESS=1`.
pub(crate) fn compare_with_golden(name: &str, text: &str) {
    let path = format!("{}/golden/{name}", env!("CARGO_MANIFEST_DIR"));
    if std::env::var_os("BLESS").is_some_and(|value| value == "1") {
        std::fs::write(&path, text).unwrap();
    }
    let golden = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        golden == text,
        "{path} differs; BLESS=1 rewrites it. Now:\n{text}"
    );
}

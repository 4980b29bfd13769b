//! Sessions that take hours, with debug assertions.

use fieldline_tests::sessions::{check_in_process, has_assertions};

/// A third of a million seeds of three generators.
#[test]
#[ignore = "takes hours: a million sessions; tests/run --full runs it"]
fn a_million_sessions_with_debug_assertions() {
    assert!(has_assertions(), "leave --release out");
    check_in_process(1_000_000..1_333_334);
}

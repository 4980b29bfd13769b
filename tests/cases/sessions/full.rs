//! Sessions that take hours, with debug assertions.

use fieldline_tests::sessions::{check_in_process, has_assertions};
use host_sim::session::generate::Generator;

/// A plausible session has fifty times the steps of another one, so there are fewer of them.
#[test]
#[ignore = "takes hours: a million sessions; tests/run --full runs it"]
fn a_million_sessions_with_debug_assertions() {
    assert!(has_assertions(), "leave --release out");
    check_in_process(&[Generator::Absurd, Generator::Tame], 1_000_000..1_475_000);
    check_in_process(&[Generator::Plausible], 1_000_000..1_050_000);
}

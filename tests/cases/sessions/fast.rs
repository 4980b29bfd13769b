//! Sessions that take half an hour, against the optimised device.

use fieldline_tests::sessions::{check_in_process, has_assertions};
use host_sim::session::generate::Generator;

/// A third of a hundred thousand seeds of three generators.
#[test]
#[ignore = "takes half an hour with --release: 100,000 sessions; tests/run --full runs it"]
fn a_hundred_thousand_optimised_sessions() {
    assert!(!has_assertions(), "say --release");
    check_in_process(&Generator::ALL, 2_000_000..2_033_334);
}

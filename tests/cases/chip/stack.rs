//! Bound of the image's stack: it holds for every input, because it counts every path.
//!
//! `golden/stack.txt` has the bound, the chain of calls that reaches it, and the largest frames.

use fieldline_tests::{costs, emulator, golden, stack};

/// Most bytes that any input may take of the 16 KB.
pub(crate) const MOST: u32 = 15 * 1024;

#[test]
#[ignore = "needs the image; tests/run runs it"]
fn no_input_takes_more_than_the_stack_has() {
    let program = stack::read(&emulator::image()).expect("cargo built it a moment ago");
    let bounds = stack::bounds(&program, &stack::RULES);
    let report = stack::report(&program, &bounds);
    assert_eq!(bounds.unknown, Vec::<String>::new());
    assert!(bounds.bytes() <= MOST, "{report}");
    golden::compare_about("stack.txt", &report, costs::DRIFT);
}

//! Cases that take hours: `tests/run --full` runs them.

use fieldline_tests::worlds;

use crate::whole;

#[test]
#[ignore = "takes hours: 210 runs; tests/run --full runs it"]
fn built_in_worlds_with_every_seed_and_strategy() {
    whole::check_all("missions-full", &worlds::builtins(&worlds::EXPLORABLE));
}

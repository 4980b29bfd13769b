//! Cases in worlds drawn by others, which `FIELDLINE_DATA` names.

use fieldline_tests::worlds;

use crate::whole;

#[test]
#[ignore = "needs worlds drawn by others (FIELDLINE_DATA) and takes hours"]
fn flat_worlds_with_every_seed_and_strategy() {
    whole::check_all("missions-data", &worlds::drawn_by_others());
}

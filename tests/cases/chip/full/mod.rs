//! Cases that take hours: `tests/run --full` runs them.

use fieldline_tests::emulator::{chip, image};
use fieldline_tests::runs::in_parallel;
use fieldline_tests::{costs, worlds};

use crate::{flat, sessions, uneven};

mod iteration;

#[test]
#[ignore = "needs the image and QEMU, and takes hours; tests/run --full runs it"]
fn every_flat_world_is_within_the_chips_budget() {
    let image = image();
    let worlds = worlds::builtins(&worlds::EXPLORABLE);
    let reports = in_parallel(&worlds, |world| flat::on_both(world, &mut chip(&image)));
    costs::check("costs-full.txt", &reports);
}

#[test]
#[ignore = "needs the image and QEMU, and takes hours; tests/run --full runs it"]
fn every_uneven_world_is_within_the_chips_budget() {
    let image = image();
    let worlds = worlds::builtins(&worlds::UNEVEN);
    let reports = in_parallel(&worlds, |world| uneven::on_both(world, &mut chip(&image)));
    costs::check("costs-terrain.txt", &reports);
}

/// Two thousand sessions of three generators.
#[test]
#[ignore = "takes an hour: 2000 sessions; tests/run --full runs it"]
fn two_thousand_hostile_sessions() {
    sessions::check("sessions-full.txt", &(15_000_000..15_000_667));
}

/// Worlds drawn by others.
mod data {
    use super::{chip, costs, flat, image, in_parallel, worlds};

    #[test]
    #[ignore = "needs worlds drawn by others (FIELDLINE_DATA), the image and QEMU; takes hours"]
    fn every_flat_world_is_within_the_chips_budget() {
        let image = image();
        let worlds = worlds::drawn_by_others();
        let reports = in_parallel(&worlds, |world| flat::on_both(world, &mut chip(&image)));
        costs::check("costs-data.txt", &reports);
    }
}

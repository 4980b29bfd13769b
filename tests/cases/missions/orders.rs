//! Orders of frontiers beside one another: `golden/orders-full.txt` and `golden/orders-data.txt`.

use fieldline_tests::orders::{by_world, sweep, table, variants};
use fieldline_tests::{golden, worlds};
use host_sim::world::World;

/// Generated worlds beside the built-in ones.
const GENERATED: [&str; 8] = [
    "rooms:0",
    "rooms:1",
    "rooms:2",
    "rooms:3",
    "dungeon:0",
    "dungeon:1",
    "maze:0",
    "maze:1",
];

fn check(name: &str, worlds: &[World], seeds: &[u64]) {
    let variants = variants();
    let reports = sweep(worlds, seeds, &variants);
    let text = format!(
        "Ratios to greedy-frontier in the same world with the same seed, seeds {seeds:?}, means \
         of {} runs.\n\n{}\nThe first order in each world.\n\n{}",
        worlds.len() * seeds.len(),
        table(&variants, &reports),
        by_world(&variants, &reports)
    );
    golden::compare(&format!("{name}.txt"), &text);
}

mod full {
    use super::{GENERATED, World, check, worlds};

    #[test]
    #[ignore = "takes a quarter of an hour: 420 runs; tests/run --full runs it"]
    fn orders_in_built_in_and_generated_worlds() {
        let mut all = worlds::builtins(&worlds::EXPLORABLE);
        let generated = GENERATED.map(|name| World::open(name).unwrap());
        all.extend(generated);
        check("orders-full", &all, &[0, 1]);
    }
}

mod data {
    use super::{check, worlds};

    #[test]
    #[ignore = "needs worlds drawn by others (FIELDLINE_DATA) and takes hours"]
    fn orders_in_worlds_drawn_by_others() {
        check("orders-data", &worlds::drawn_by_others(), &[0]);
    }
}

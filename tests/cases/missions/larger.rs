//! Floors larger than the pool of the device's map: tiles far from the robot are coded
//! (`fieldline_planner::map`, `compaction`).
//!
//! A code loses nothing. So as long as everything fits, the robot drives as one whose map has a
//! page for each tile, bit for bit.

use fieldline_device::{SLOTS, TILES};
use fieldline_tests::golden;
use fieldline_tests::runs::{FRONTIER, Run, assert_same, explored, in_parallel};
use fieldline_tests::table::{Table, number};
use host_sim::link::endpoint::{Endpoint, RetryPolicy};
use host_sim::link::loopback::LocalDevice;
use host_sim::report::Report;
use host_sim::trial::Record;
use host_sim::trial::mission::Mission;
use host_sim::world::World;

/// Simulated milliseconds that a run may take.
const LIMIT_MS: u32 = 7_200_000;

fn open(name: &str) -> World {
    World::open(name).unwrap_or_else(|error| panic!("{error}"))
}

/// Explores with a page for each tile.
fn with_pages(world: &World) -> (Report, Record) {
    let device = LocalDevice::<{ SLOTS + 32 }, SLOTS>::sized();
    let mut link = Endpoint::new(device, RetryPolicy::VIRTUAL, 1);
    explored(&mission(), world, &mut link)
}

fn mission() -> Mission {
    Mission {
        strategy: FRONTIER.into(),
        link: "loopback".into(),
        time_limit_ms: LIMIT_MS,
        ..Mission::default()
    }
}

#[test]
fn a_map_with_coded_tiles_drives_as_one_with_a_page_for_each() {
    let world = open("dungeon:5:60x50");
    let (pages, record) = with_pages(&world);
    let coded = Run::first(&world, FRONTIER).go();
    assert!(record.tiles.len() > TILES, "no tile had to be coded");
    assert_eq!(pages.outcome.reason, "explored");
    assert_same(&pages, &coded);
}

mod full {
    use super::*;
    use host_sim::link::direct::Direct;

    /// No constant was chosen on these floors.
    const WORLDS: [&str; 9] = [
        "dungeon:5:60x50",
        "dungeon:6:64x64",
        "dungeon:7:128x32",
        "rooms:8:60x45",
        "rooms:9:70x55",
        "rooms:10:64x64",
        "maze:5:60x60",
        "maze:6:50x45",
        "maze:7:45x40",
    ];

    #[test]
    #[ignore = "takes minutes: 18 runs of large floors; tests/run --full runs it"]
    fn large_floors() {
        let runs = in_parallel(&WORLDS, |name| {
            let world = open(name);
            let coded = explored(&mission(), &world, &mut Direct::new()).0;
            (coded, with_pages(&world).0)
        });
        let mut table = Table::new(
            2,
            &[
                "world",
                "ended",
                "floor m2",
                "known m2",
                "known %",
                "end s",
                "way m",
                "hits",
                "with pages",
                "known m2",
            ],
        );
        for (coded, pages) in &runs {
            let coverage = &coded.coverage;
            table.row(vec![
                coded.world.clone(),
                coded.outcome.reason.clone(),
                number(Some(coverage.explorable_m2), 0),
                number(Some(coverage.known_m2), 0),
                number(Some(100.0 * coverage.fraction), 1),
                number(Some(coded.sim_time_s), 0),
                number(Some(coded.path_length_m), 0),
                coded.safety.collisions.to_string(),
                if coded.digest == pages.digest {
                    "equal".into()
                } else {
                    pages.outcome.reason.clone()
                },
                number(Some(pages.coverage.known_m2), 0),
            ]);
        }
        golden::compare("larger-full.txt", &table.to_string());
        for (coded, pages) in &runs {
            assert_eq!(coded.safety.collisions, 0, "{}", coded.world);
            let is_over = coded.outcome.reason == "explored";
            assert!(!is_over || coded.digest == pages.digest, "{}", coded.world);
        }
    }
}

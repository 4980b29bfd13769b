//! Generated worlds repeat, differ by seed, and are as hard as their descriptions say, and no
//! harder.

use std::sync::LazyLock;

use super::sheet::Door;
use super::{DOOR_M, Drawing, KINDS, Kind, LEAST_SHARE, Name, draw};
use crate::metrics::CellSet;
use crate::robot::{Footprint, RADIUS_M};
use crate::world::occupancy::{Class, GridCell};
use crate::world::{Start, World};

/// Seeds of each kind.
const SEEDS: u64 = 40;
/// What the cells add to the width of a door, metres: one cell at each end.
const CELLS_M: f64 = 0.1;

/// Draws the world of a kind and a seed.
fn drawn(kind: Kind, seed: u64, size_m: Option<[f64; 2]>) -> (World, Drawing) {
    let name = Name { kind, seed, size_m };
    draw(&name).unwrap_or_else(|| panic!("{name} has no drawing"))
}

/// The number of free cells, and a sum that depends on the places of all classes.
fn fingerprint(world: &World) -> (usize, u32) {
    let classes = world.occupancy().classes();
    let free = classes.iter().filter(|class| **class == Class::Free);
    let sum = classes.iter().fold(0_u32, |sum, class| {
        sum.wrapping_mul(31).wrapping_add(*class as u32)
    });
    (free.count(), sum)
}

/// What the tests look at in a world; the worlds themselves would fill the memory.
struct Facts {
    name: String,
    fingerprint: (usize, u32),
    /// Least distance from the robot to a wall over headings at the start, metres.
    clearance_m: f64,
    /// Of the places where the robot fits, the share that it reaches.
    share: f64,
    /// Places that it reaches, square metres.
    reach_m2: f64,
    /// Stated and measured widths of the doors, metres.
    doors_m: Vec<[f64; 2]>,
}

impl Facts {
    fn new(kind: Kind, seed: u64) -> Self {
        let (world, drawing) = drawn(kind, seed, None);
        let start = world.starts()[0];
        let turned = (0..6).map(|k| Start {
            yaw_rad: f64::from(k),
            ..start
        });
        let clearances = turned.map(|start| world.clearance_m(&Footprint::PIONEER_3AT, start));
        let room = |cell| world.distance().from_centre_m(cell) >= RADIUS_M - 1e-9;
        let [width, height] = [world.occupancy().width(), world.occupancy().height()];
        let cells = (0..height as i64).flat_map(|j| (0..width as i64).map(move |i| (i, j)));
        let fits = cells.filter(|&(i, j)| room(GridCell { i, j })).count();
        let reach = CellSet::reach(&world, start, RADIUS_M).count() as f64;
        let doors = drawing.doors.iter();
        Self {
            name: world.name().to_owned(),
            fingerprint: fingerprint(&world),
            clearance_m: clearances.fold(f64::INFINITY, f64::min),
            share: reach / fits as f64,
            reach_m2: reach * 0.0025,
            doors_m: doors
                .map(|door| [door.width_m, measured_m(&world, door)])
                .collect(),
        }
    }
}

/// The first seeds of every kind, drawn once for all tests.
static SOME: LazyLock<Vec<(Kind, Vec<Facts>)>> = LazyLock::new(|| {
    let of = |kind| (0..SEEDS).map(|seed| Facts::new(kind, seed)).collect();
    KINDS.into_iter().map(|kind| (kind, of(kind))).collect()
});

fn open(name: &str) -> World {
    World::open(name).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn drawings_do_not_change() {
    // A changed drawing changes every result on it.
    let names = ["maze:1", "rooms:1", "dungeon:1"];
    let prints = names.map(|name| {
        let world = open(name);
        (name, fingerprint(&world), world.starts()[0])
    });
    let start = |x_m, y_m, yaw_rad| Start { x_m, y_m, yaw_rad };
    let expected = [
        (
            "maze:1",
            (81_301, 3_686_098_429),
            start(9.975, 4.975, -1.705),
        ),
        (
            "rooms:1",
            (165_736, 2_973_497_470),
            start(14.275, 2.925, -2.687),
        ),
        (
            "dungeon:1",
            (59_975, 1_320_010_671),
            start(8.875, 8.075, 2.112),
        ),
    ];
    assert_eq!(prints, expected);
}

#[test]
fn the_same_name_gives_the_same_world_and_other_seeds_give_others() {
    for (kind, worlds) in SOME.iter() {
        let prints: Vec<_> = worlds.iter().map(|facts| facts.fingerprint).collect();
        for (k, print) in prints.iter().enumerate() {
            assert!(!prints[..k].contains(print), "{kind:?} {k}");
        }
        for seed in [0, 7] {
            let again = open(&format!("{}:{seed}", kind.word()));
            assert_eq!(
                fingerprint(&again),
                prints[seed as usize],
                "{kind:?} {seed}"
            );
        }
    }
}

#[test]
fn the_name_says_kind_seed_and_size() {
    for (name, canonical, size_m) in [
        ("rooms:7:40x25", "rooms:7:40x25", [40.0, 25.0]),
        ("maze:007:12.34x9", "maze:7:12.35x9", [12.35, 9.0]),
        (
            "dungeon:18446744073709551615:8x8",
            "dungeon:18446744073709551615:8x8",
            [8.0, 8.0],
        ),
        ("rooms:3:128x32", "rooms:3:128x32", [128.0, 32.0]),
        ("maze:3:64x64", "maze:3:64x64", [64.0, 64.0]),
    ] {
        let world = open(name);
        assert_eq!(world.name(), canonical);
        for (is, wanted) in world.size_m().into_iter().zip(size_m) {
            assert!((is - wanted).abs() < 1e-9, "{name}: {is}");
        }
    }
    assert_eq!(open("maze:3").name(), "maze:3");
}

#[test]
fn the_robot_has_room_at_the_start_and_reaches_most_of_the_world() {
    for facts in SOME.iter().flat_map(|(_, worlds)| worlds) {
        let Facts {
            name,
            clearance_m,
            share,
            reach_m2,
            ..
        } = facts;
        assert!(*clearance_m > 0.1, "{name}: {clearance_m}");
        assert!(*share >= LEAST_SHARE, "{name}: {share}");
        assert!(*reach_m2 > 3.0, "{name}: {reach_m2}");
    }
}

/// Width of a door in the drawing's cells, metres.
fn measured_m(world: &World, door: &Door) -> f64 {
    let until_solid = |sign: f64| {
        let at = |k: i32| {
            let away_m = sign * f64::from(k) * 0.01;
            [0, 1].map(|axis| door.middle[axis] + away_m * door.along[axis])
        };
        let steps = (0..200).find(|&k| world.is_solid(at(k)[0], at(k)[1]));
        f64::from(steps.unwrap_or(200)) * 0.01
    };
    until_solid(1.0) + until_solid(-1.0)
}

#[test]
fn doors_are_open_and_as_wide_as_stated() {
    for (kind, worlds) in SOME.iter() {
        for Facts { name, doors_m, .. } in worlds {
            for &[stated_m, is_m] in doors_m {
                let range_m = DOOR_M[0] - 1e-9..DOOR_M[1] + 1e-9;
                assert!(range_m.contains(&stated_m), "{name}: {stated_m}");
                assert!(
                    (is_m - stated_m).abs() < CELLS_M,
                    "{name}: {stated_m} {is_m}"
                );
            }
        }
        let count: usize = worlds.iter().map(|facts| facts.doors_m.len()).sum();
        assert!(count > 100, "{kind:?}: {count} doors");
    }
}

#[test]
fn small_worlds_have_a_start_too() {
    for kind in KINDS {
        for seed in 0..SEEDS {
            let (world, _) = drawn(kind, seed, Some([8.0, 8.0]));
            assert_eq!(world.starts().len(), 1);
        }
    }
}

#[test]
fn a_bad_seed_or_size_is_refused_by_name_and_remedy() {
    let seed = "the seed must be a whole number from 0 to 18446744073709551615; say";
    let large = "is too large; say 64x64, 128x32 or less";
    for (name, reason) in [
        ("maze", format!("{seed} maze:1")),
        ("rooms:", format!("{seed} rooms:1")),
        ("dungeon:-1", format!("{seed} dungeon:1")),
        ("maze:+1", format!("{seed} maze:1")),
        ("maze:18446744073709551616", format!("{seed} maze:1")),
        (
            "maze:1:12",
            "the size must be width x height in metres; say maze:1:20x15".into(),
        ),
        (
            "maze:1:nanx10",
            "the size must be width x height in metres; say maze:1:20x15".into(),
        ),
        (
            "rooms:1:7.9x20",
            "a size of 7.9x20 m is too small; say 8x8 or more".into(),
        ),
        (
            "rooms:1:-20x20",
            "a size of -20x20 m is too small; say 8x8 or more".into(),
        ),
        ("rooms:1:128x128", format!("a size of 128x128 m {large}")),
        ("rooms:1:1e300x9", format!("a size of 1e300x9 m {large}")),
        ("rooms:1:129x10", format!("a size of 129x10 m {large}")),
        (
            "rooms:1:20x20:3",
            "nothing follows the size; say rooms:1:20x15".into(),
        ),
    ] {
        let error = World::open(name).expect_err(name).to_string();
        assert_eq!(error, format!("{name}: {reason}"));
    }
    let file = World::open("maze.yaml").expect_err("no such file");
    assert!(file.to_string().contains("cannot read this world"));
}

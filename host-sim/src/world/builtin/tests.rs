//! The built-in worlds do not change, and they are as their descriptions say.

use super::*;
use crate::metrics::{CellSet, Coverage};
use crate::robot::{Footprint, RADIUS_M};

#[test]
fn the_robot_fits_at_every_start_and_can_turn_there() {
    for builtin in builtins() {
        let world = World::builtin(builtin.name).expect("listed");
        assert!(!world.starts().is_empty());
        for start in world.starts() {
            let turned = |k: u32| Start {
                yaw_rad: f64::from(k),
                ..*start
            };
            let clearance = (0..6)
                .map(|k| world.clearance_m(&Footprint::PIONEER_3AT, turned(k)))
                .fold(f64::INFINITY, f64::min);
            assert!(clearance > 0.1, "{}: {clearance}", builtin.name);
        }
    }
}

#[test]
fn drawings_do_not_change() {
    // A changed drawing changes every result on it. Compared are the number of free cells and a sum
    // that depends on their places.
    let fingerprint = |world: &World| {
        let classes = world.occupancy().classes().iter();
        classes.fold((0, 0_u32), |(free, sum), class| {
            let bit = u32::from(*class == super::super::Class::Free);
            (free + bit, sum.wrapping_mul(31).wrapping_add(bit))
        })
    };
    let flat = |builtin: &&Builtin| builtin.file.ground.is_none();
    let prints: Vec<_> = (builtins().iter().filter(flat))
        .map(|builtin| {
            let world = World::builtin(builtin.name).expect("listed");
            (builtin.name, fingerprint(&world))
        })
        .collect();
    let expected = [
        ("office", (115_412, 3_156_533_628)),
        ("cave", (76_337, 1_078_126_173)),
        ("loop", (52_256, 1_009_329_408)),
        ("cluttered", (86_345, 3_978_289_357)),
        ("hall", (229_376, 3_185_510_912)),
        ("empty-hall", (360_000, 281_830_400)),
        ("narrow-doors", (44_784, 3_584_075_896)),
        ("unreachable-room", (50_296, 2_037_409_664)),
        ("boxed-in", (14_016, 405_072_896)),
        ("ouroboros-a", (149_600, 804_963_840)),
        ("ouroboros-b", (140_800, 3_408_814_080)),
        ("ouroboros-c", (214_172, 3_718_203_840)),
        ("ouroboros-d", (156_762, 2_793_279_844)),
        ("tdbvp-adjacent", (140_800, 1_353_605_120)),
        ("tdbvp-nested", (111_200, 3_258_082_816)),
        ("tdbvp-floor", (180_328, 1_935_914_624)),
        ("two-rooms", (30_912, 388_566_016)),
        ("c-room", (39_072, 608_782_848)),
        ("partition", (5_520, 1_152_153_856)),
    ];
    assert_eq!(prints, expected);
}

#[test]
fn heights_do_not_change() {
    // The millimetres of all samples, mixed by their places; a hole counts as −9 m.
    let print = |world: &World| {
        let ground = world.elevation()?;
        let [width, height] = [ground.width(), ground.height()];
        let sample = |k: usize| {
            let [x, y] = [k % width, k / width].map(|k| (k as f64 + 0.5) * 0.05);
            ground.ground_m(x, y).unwrap_or(-9.0)
        };
        let millimetres = |k| (sample(k) * 1000.0).round() as i64 as u32;
        let print = (0..width * height).fold(0_u32, |sum, k| {
            sum.wrapping_mul(31).wrapping_add(millimetres(k))
        });
        Some((width, height, print))
    };
    let prints: Vec<_> = builtins()
        .iter()
        .filter_map(|builtin| {
            let world = World::builtin(builtin.name).expect("listed");
            print(&world).map(|print| (builtin.name, print))
        })
        .collect();
    let expected = [
        ("slope", (600, 480, 1_123_588_077)),
        ("holes", (520, 520, 898_812_457)),
        ("building", (520, 480, 2_100_395_965)),
        ("cliff", (560, 480, 3_635_953_818)),
        ("spiral", (520, 520, 1_296_959_269)),
        ("kerbs", (480, 240, 2_156_071_872)),
        ("waves", (600, 600, 1_319_302_230)),
        ("pass", (520, 400, 1_629_892_402)),
        ("causeway", (520, 280, 3_972_178_064)),
    ];
    assert_eq!(prints, expected);
}

/// The share of the free floor around the first start that the robot's lasers can see.
fn visible_share(name: &str) -> f64 {
    let world = World::builtin(name).expect("listed");
    let start = world.starts()[0];
    let free = CellSet::free(&world, start).count() as f64 * 0.0025;
    Coverage::new(&world, start, RADIUS_M, 12.0).reachable_m2() / free
}

#[test]
fn rooms_are_as_open_as_the_descriptions_say() {
    for name in [
        "office",
        "cave",
        "loop",
        "cluttered",
        "hall",
        "empty-hall",
        "narrow-doors",
    ] {
        let share = visible_share(name);
        assert!((0.99..1.01).contains(&share), "{name}: {share}");
    }
    assert!(visible_share("unreachable-room") < 0.99);
    let closet = World::builtin("boxed-in").expect("listed");
    assert_eq!(CellSet::free(&closet, closet.starts()[0]).count(), 400);
}

#[test]
fn all_starts_of_a_world_are_connected() {
    for builtin in builtins() {
        let world = World::builtin(builtin.name).expect("listed");
        if world.elevation().is_some() {
            continue;
        }
        let reach = CellSet::reach(&world, world.starts()[0], RADIUS_M);
        for start in world.starts() {
            let cell = world.occupancy().cell_at(start.x_m, start.y_m);
            assert!(reach.contains(cell), "{} {start:?}", builtin.name);
        }
    }
}

#[test]
fn doors_are_as_wide_as_their_names_say() {
    let world = World::builtin("narrow-doors").expect("listed");
    let grid = world.occupancy();
    // Along the middle of the wall with the doors.
    let doors = places("narrow-doors");
    let j = grid.cell_at(0.0, doors[0].point_m[1]).j;
    let mut widths = vec![0];
    for i in 0..grid.width() as i64 {
        if grid.is_solid(super::super::GridCell { i, j }) {
            widths.push(0);
        } else if let Some(last) = widths.last_mut() {
            *last += 1;
        }
    }
    widths.retain(|cells| *cells > 0);
    assert_eq!(widths, [13, 14, 15, 16, 18]);
    let named = doors.iter().map(|door| {
        let [x0, _, x1, _] = door.extent_m;
        ((x1 - x0) / 0.05).round() as i32
    });
    assert!(named.eq(widths), "{doors:?}");
}

#[test]
fn places_lie_in_their_world_and_have_names_of_their_own() {
    for builtin in builtins() {
        let world = World::builtin(builtin.name).expect("listed");
        let [width, height] = world.size_m();
        for (k, one) in builtin.places.iter().enumerate() {
            let [x0, y0, x1, y1] = one.extent_m;
            assert!(x0 >= 0.0 && x1 <= width && x0 < x1, "{one:?}");
            assert!(y0 >= 0.0 && y1 <= height && y0 < y1, "{one:?}");
            let [x, y] = one.point_m;
            assert!(x >= x0 && x <= x1 && y >= y0 && y <= y1, "{one:?}");
            assert_eq!(place(builtin.name, &one.name), Some(one));
            assert!(
                builtin.places[..k]
                    .iter()
                    .all(|other| other.name != one.name)
            );
        }
    }
    assert!(places("no such world").is_empty());
}

/// Doors and gaps are free, holes and drops lie below the ground west of them, islands above it.
#[test]
fn places_are_what_their_names_say() {
    for builtin in builtins() {
        let world = World::builtin(builtin.name).expect("listed");
        for place in &builtin.places {
            let [x, y] = place.point_m;
            let rise_m = world.ground_m(x, y).map(|ground_m| {
                let beside_m = world.ground_m(place.extent_m[0] - 0.5, y);
                ground_m - beside_m.expect("ground beside it")
            });
            let name = &place.name;
            if name.contains("door") || name.contains("gap") || name.contains("entrance") {
                assert!(!world.is_solid(x, y), "{}: {name}", builtin.name);
            } else if name.contains("hole") || name.contains("drop") {
                assert!(rise_m.is_none_or(|m| m < -0.9), "{}: {name}", builtin.name);
            } else if name.contains("island") || name.contains("hill") {
                assert!(rise_m.is_some_and(|m| m > 0.04), "{}: {name}", builtin.name);
            }
        }
    }
}

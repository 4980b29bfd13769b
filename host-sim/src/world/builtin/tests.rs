//! Drawings stay as they are, and are as their descriptions say.

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
fn drawings_stay_as_they_are() {
    // A change of a drawing changes every result on it: free cells, and a sum that depends on their places.
    let fingerprint = |world: &World| {
        let classes = world.occupancy().classes().iter();
        classes.fold((0, 0_u32), |(free, sum), class| {
            let bit = u32::from(*class == super::super::Class::Free);
            (free + bit, sum.wrapping_mul(31).wrapping_add(bit))
        })
    };
    let prints: Vec<_> = builtins()
        .iter()
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
    ];
    assert_eq!(prints[..9], expected);
    let published = [
        ("ouroboros-a", (149_600, 804_963_840)),
        ("ouroboros-b", (140_800, 3_408_814_080)),
        ("ouroboros-c", (214_172, 3_718_203_840)),
        ("ouroboros-d", (156_762, 2_793_279_844)),
        ("tdbvp-adjacent", (140_800, 1_353_605_120)),
        ("tdbvp-nested", (111_200, 3_258_082_816)),
        ("tdbvp-floor", (180_328, 1_935_914_624)),
    ];
    assert_eq!(prints[prints.len() - 7..], published);
}

#[test]
fn ground_stays_as_it_is() {
    // Millimetres of all samples, mixed by their places; −1 m more for a hole.
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

/// Share of the free floor around the first start that the robot's disc could see.
fn visible_share(name: &str) -> f64 {
    let world = World::builtin(name).expect("listed");
    let start = world.starts()[0];
    let free = CellSet::free(&world, start).count() as f64 * 0.0025;
    Coverage::new(&world, start, RADIUS_M, 12.0).reachable_m2() / free
}

#[test]
fn every_room_is_as_open_as_the_description_says() {
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
fn starts_of_a_world_lie_in_one_piece() {
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
fn doors_are_as_wide_as_they_say() {
    let world = World::builtin("narrow-doors").expect("listed");
    let grid = world.occupancy();
    // Along the middle of the wall with the doors.
    let j = grid.cell_at(0.0, 2.7).j;
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
}

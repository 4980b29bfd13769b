//! Tests: to enter a beam tile by tile gives the same map as cell by cell.
//!
//! Ranges are millimetres, lengths metres.

use super::*;

const TUNING: MapTuning = MapTuning::DEFAULT;

const LASER: LaserMount = LaserMount::level(0.0, 0.4);

/// The slow twin of [`Map::free_along`]: cell by cell, with the map's public methods.
fn free_slowly<const SIZE: usize>(map: &mut Map<SIZE, SIZE>, beam: &Beam) {
    let (start, length_m) = (beam.at(beam.free_from_m), beam.length_m - beam.free_from_m);
    let mut traversal = Traversal::new(start, beam.direction, length_m, beam.hit);
    let mut goes_on = length_m > 0.0;
    while goes_on && !traversal.is_over() {
        let tile = traversal.tile();
        goes_on = traversal.cross_tile(|row, bit, leaves_m| {
            let cell = Traversal::cell(tile, row, bit);
            let class = map.class(cell);
            let kept = match class {
                Class::Free => !beam.is_counted(),
                Class::Unknown => false,
                _ => beam.hit && leaves_m > length_m - TUNING.guard_m,
            };
            if kept {
                return true;
            }
            let now = if map.evidence.covers(cell) {
                map.evidence.pass(cell, class, &TUNING)
            } else if class == Class::Unknown {
                Class::Free
            } else {
                class
            };
            if map.tiles.set(cell, now).is_err() {
                return false;
            }
            beam.hit || class.is_open()
        });
    }
}

fn random(seed: &mut u32) -> u32 {
    *seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    *seed >> 8
}

/// Returns a scan of a messy room: walls with holes, and noise.
fn scan(seed: &mut u32) -> [u16; 181] {
    let wall = 1_000 + random(seed) % 8_000;
    core::array::from_fn(|i| match random(seed) % 8 {
        0 => NO_RETURN_MM,
        1 => INVALID_MM,
        _ if i / 20 % 3 == 0 => NO_RETURN_MM,
        _ => (wall + random(seed) % 300) as u16,
    })
}

#[test]
fn going_by_tiles_is_going_by_cells() {
    // The small map has no room for all beams; the two must agree on it too.
    go_by_tiles_and_by_cells::<36>();
    go_by_tiles_and_by_cells::<144>();
}

fn go_by_tiles_and_by_cells<const SIZE: usize>() {
    let mut seed = 7;
    let (mut fast, mut slow) = (Map::<SIZE, SIZE>::new(), Map::<SIZE, SIZE>::new());
    for map in [&mut fast, &mut slow] {
        map.reset();
        map.evidence.reset(Cell::default());
    }
    for k in 0..60 {
        let pose = Pose {
            x_m: 0.07 * k as f32 - 1.0,
            y_m: 0.003 * (random(&mut seed) % 100) as f32,
            yaw_rad: 0.2 * k as f32,
            ..Pose::default()
        };
        let ranges = scan(&mut seed);
        fast.integrate(&TUNING, &pose, (&LASER, &ranges), Share::ALL);
        for beam in level_beams(&pose, &LASER, &ranges, &TUNING) {
            free_slowly(&mut slow, &beam);
        }
        for beam in level_beams(&pose, &LASER, &ranges, &TUNING).filter(|beam| beam.hit) {
            slow.hit(&TUNING, beam.end().cell());
        }
        for map in [&mut fast, &mut slow] {
            map.evidence.follow(pose.point().cell());
        }
    }
    assert!(fast.tiles.used() > 9);
    // The slow twin keeps evidence for cells without room, which has no effect.
    assert!(SIZE == 36 || fast.evidence == slow.evidence);
    for tile in (-9..9).flat_map(|y| (-9..9).map(move |x| (x, y))) {
        let of = |map: &Map<SIZE, SIZE>| map.tiles.packed(tile.0, tile.1);
        assert_eq!(of(&fast), of(&slow), "tile {tile:?}");
    }
}

fn share_of(lasers: &[LaserMount], ranges_mm: u16, time_ms: u32) -> Share {
    let lasers = lasers.iter().cloned().collect();
    let ranges_mm = [ranges_mm; 181];
    let input = Input {
        time_ms,
        pose: Pose::default(),
        velocity: crate::geometry::Twist::default(),
        scans: [&ranges_mm, &ranges_mm],
    };
    Share::of(&Config::pioneer_3at(lasers), &input)
}

#[test]
fn one_laser_of_twelve_metres_always_enters_all_beams() {
    for time_ms in [0, 200, 1_000] {
        assert_eq!(share_of(&[LASER], NO_RETURN_MM, time_ms), Share::ALL);
    }
}

#[test]
fn long_beams_take_turns_and_none_is_left_out() {
    let long = LaserMount {
        range_limit_mm: 16_000,
        ..LASER
    };
    let lasers = [long, long];
    let every = share_of(&lasers, NO_RETURN_MM, 0).every;
    assert_eq!(every, 3, "362 beams of 16 m");
    let mut entered = [0; 181];
    for step in 0..3 {
        let share = share_of(&lasers, NO_RETURN_MM, 200 * step);
        for (number, entered) in entered.iter_mut().enumerate() {
            *entered += u8::from(share.has(number));
        }
    }
    assert_eq!(entered, [1; 181]);
    assert_eq!(share_of(&lasers, 2_000, 0), Share::ALL, "a small room");
}

//! Occupancy maps: how they are read, and the error line for each fault.

use std::fs;
use std::path::PathBuf;

use host_sim::metrics::CellSet;
use host_sim::world::{Class, GridCell, Ray, Surface, World, builtins};

use super::{Folder, KEYS, png};

/// The world as characters, greatest y first.
fn drawn(world: &World) -> Vec<String> {
    let grid = world.occupancy();
    let (width, height) = (grid.width() as i64, grid.height() as i64);
    let character = |i, j| match grid.class(GridCell { i, j }) {
        Class::Wall => '#',
        Class::Unknown => '?',
        Class::Free => '.',
    };
    (0..height)
        .rev()
        .map(|j| (0..width).map(|i| character(i, j)).collect())
        .collect()
}

#[test]
fn shades_become_classes_and_the_top_row_has_the_greatest_y() {
    let folder = Folder::new("shades");
    // Occupancy of 205 is 0.196078, just above the usual threshold of 0.196: unknown.
    folder.write(
        "map.pgm",
        b"P2 3 3 255\n254 254 0\n254 205 206\n254 89 90\n",
    );
    let robots = "robots: [[-0.5, 2.5, 1.25], [-0.5, 4.5]]\n";
    let path = folder.write("plan.yaml", format!("image: map.pgm\n{KEYS}{robots}"));
    let world = World::load(&path).expect("loads");
    assert_eq!(drawn(&world), ["..#", ".?.", ".#?"]);
    assert_eq!(world.name(), "plan");
    assert_eq!(world.starts()[0].yaw_rad, 1.25);
    assert_eq!(world.starts()[1].y_m, 4.5);
    assert!(world.is_solid(1.5, 4.5) && !world.is_solid(0.5, 4.5) && world.is_solid(-1.5, 4.5));
    // Negated, with wide thresholds: white is wall.
    let text = format!(
        "image: map.pgm\n{KEYS}negate: yes\nfree_thresh: 0.4\noccupied_thresh: 0.9\n\
         mode: trinary\nrobots: [[1.5, 4.5, 0]]"
    );
    let world = World::load(&folder.write("negated.yaml", text)).expect("loads");
    assert_eq!(drawn(&world), ["##.", "#??", "#.."]);
}

#[test]
fn png_of_every_kind_reads_the_same() {
    use png::{
        BitDepth::{Eight, One, Sixteen, Two},
        ColorType::{Grayscale, GrayscaleAlpha, Indexed, Rgb, Rgba},
    };
    let folder = Folder::new("png");
    let kinds: [(&str, _, &[u8]); 7] = [
        ("bits", (Grayscale, One), &[0b0100_0000, 0b1100_0000]),
        ("grey", (Grayscale, Eight), &[0, 255, 255, 255]),
        (
            "wide",
            (Grayscale, Sixteen),
            &[0, 9, 255, 255, 255, 255, 254, 9],
        ),
        ("palette", (Indexed, Two), &[0b0001_0000, 0b0101_0000]),
        (
            "colour",
            (Rgb, Eight),
            &[9, 0, 0, 255, 250, 255, 255, 255, 255, 255, 255, 255],
        ),
        (
            "alpha",
            (GrayscaleAlpha, Eight),
            &[0, 255, 255, 255, 255, 255, 255, 255],
        ),
        (
            "rgba",
            (Rgba, Eight),
            &[
                0, 0, 0, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255,
            ],
        ),
    ];
    for (name, kind, data) in kinds {
        png(&folder.0.join("map.png"), (2, 2), kind, data);
        let text = format!("image: map.png\n{KEYS}robots: [[-0.5, 2.5, 0]]");
        let world = World::load(&folder.write("world.yaml", text)).expect(name);
        assert_eq!(drawn(&world), ["#.", ".."], "{name}");
    }
    // With an alpha channel opaque greys keep their class; transparent pixels are unknown.
    let data = [205, 255, 255, 254, 255, 255, 0, 0];
    png(
        &folder.0.join("map.png"),
        (2, 2),
        (GrayscaleAlpha, Eight),
        &data,
    );
    let text = format!("image: map.png\n{KEYS}robots: [[-0.5, 2.5, 0]]");
    let world = World::load(&folder.write("world.yaml", text)).expect("loads");
    assert_eq!(drawn(&world), ["??", ".?"]);
}

/// `faults.txt` has a world file in a line, with `\n` between its lines, and below it the error.
#[test]
fn each_fault_has_its_error_line() {
    let folder = Folder::new("mistakes");
    folder.write(
        "map.pgm",
        b"P2 3 3 255\n254 254 254 254 254 254 254 254 0\n",
    );
    folder.write("dark.pgm", b"P2 1 1 255\n0\n");
    folder.write("cut.pgm", b"P5 3 3 255\n\x01\x02");
    folder.write("odd.pgm", b"P5 2 1 255\n\x01\x02\x03");
    folder.write("text.png", b"hello");
    png(
        &folder.0.join("colour.png"),
        (1, 1),
        (png::ColorType::Rgb, png::BitDepth::Eight),
        &[1, 2, 3],
    );
    let whole = fs::read(folder.0.join("colour.png")).expect("just written");
    // Black walls, and a floor that was never painted.
    png(
        &folder.0.join("clear.png"),
        (2, 2),
        (png::ColorType::GrayscaleAlpha, png::BitDepth::Eight),
        &[0, 255, 0, 0, 0, 0, 0, 0],
    );
    folder.write("cut.png", &whole[..whole.len() - 20]);
    folder.write("tail.png", &whole[..whole.len() - 6]);
    let known = "image, resolution, origin, negate, occupied_thresh, free_thresh, mode, \
                 wall_height, glass, low, elevation, robots";
    let filled = |text: &str| {
        text.replace("{good}", "image: map.pgm\n{keys}")
            .replace("{keys}", KEYS)
            .replace("{turned}", &KEYS.replace(", 0]", ", 0.5]"))
            .replace("{known}", known)
            .replace("\\n", "\n")
    };
    let lines: Vec<&str> = include_str!("faults.txt").lines().collect();
    let (cases, rest) = lines.as_chunks::<2>();
    assert!(cases.len() > 30 && rest.is_empty());
    for [text, error] in cases {
        let error = format!("world.yaml: {}", filled(error.trim_start()));
        assert_eq!(folder.error(&filled(text)), error, "{text}");
    }
}

#[test]
fn one_bad_start_is_noted_and_the_others_are_good() {
    let folder = Folder::new("starts");
    folder.write(
        "map.pgm",
        b"P2 3 3 255\n254 254 254 254 254 254 254 254 0\n",
    );
    let text = format!("image: map.pgm\n{KEYS}robots: [[0.5, 3.5], [1.5, 2.5], [0.5, 4.5]]");
    let world = World::load(&folder.write("world.yaml", text)).expect("two starts are good");
    assert_eq!(world.starts().len(), 3);
    let note = "robots[1]: (1.50, 2.50) lies in a wall; the most room is at (0.50, 3.50); no run \
                begins there, the other starts are good";
    assert_eq!(world.notes(), [note]);
}

/// A corridor with three posts of a cell: of glass, low, and of the usual height.
#[test]
fn a_beam_goes_through_glass_and_over_what_is_low_and_the_robot_does_not() {
    let folder = Folder::new("glass");
    folder.write("map.pgm", b"P2 9 1 255\n254 254 0 254 0 254 0 254 0\n");
    let keys = "image: map.pgm\nresolution: 1.0\norigin: [0, 0, 0]\nrobots: [[1, 0.5, 0]]\n";
    let text = format!("{keys}glass: [[2, 0, 3, 1]]\nlow: [[4, 0, 5, 1, 0.2]]\n");
    let plain = World::load(&folder.write("plain.yaml", keys)).expect("loads");
    let world = World::load(&folder.write("world.yaml", text)).expect("loads");
    let range = |world: &World, z: f64, down: f64| {
        let norm = f64::hypot(1.0, down);
        let ray = Ray {
            origin_m: [0.5, 0.5, z],
            direction: [1.0 / norm, 0.0, -down / norm],
        };
        let hit = world.cast(&ray, 12.0).expect("the corridor ends");
        ((hit.range_m / norm * 1e6).round() / 1e6, hit.surface)
    };
    assert_eq!(range(&plain, 0.4, 0.0), (1.5, Surface::Wall));
    // Through the glass, over the low post, to the third.
    assert_eq!(range(&world, 0.4, 0.0), (5.5, Surface::Wall));
    // A beam below 0.2 m meets the low post; one that looks down meets its top or the ground.
    assert_eq!(range(&world, 0.1, 0.0), (3.5, Surface::Wall));
    assert_eq!(range(&world, 0.4, 0.05), (4.0, Surface::Top));
    assert_eq!(range(&world, 0.4, 0.2), (2.0, Surface::Ground));
    for x in [2.5, 4.5, 6.5] {
        assert!(world.is_solid(x, 0.5), "{x}");
    }
    for (line, error) in [
        (
            "glass: [[3, 0, 4, 1]]",
            "glass[0]: no wall cell has its centre there; draw the wall in the image",
        ),
        (
            "glass: [[3, 0, 2, 1]]",
            "glass[0]: a list of 4 is not [x0, y0, x1, y1] in metres with x0 < x1, y0 < y1 and a \
             height above 0",
        ),
        (
            "low: [[4, 0, 5, 1]]",
            "low[0]: a list of 4 is not [x0, y0, x1, y1, height] in metres with x0 < x1, y0 < y1 \
             and a height above 0",
        ),
        (
            "low: 0.2",
            "low: 0.2 is not a list of [x0, y0, x1, y1, height]; give metres",
        ),
    ] {
        assert_eq!(
            folder.error(&format!("{keys}{line}")),
            format!("world.yaml: {error}")
        );
    }
}

#[test]
fn raw_values_are_occupancies_in_percent() {
    let folder = Folder::new("raw");
    folder.write("map.pgm", b"P2 3 3 255\n0 19 20\n65 66 100\n0 101 255\n");
    let text = format!("image: map.pgm\n{KEYS}mode: raw\nrobots: [[-0.5, 4.5, 0]]");
    let world = World::load(&folder.write("world.yaml", text)).expect("loads");
    assert_eq!(drawn(&world), ["..?", "?##", ".??"]);
}

#[test]
fn a_turned_origin_turns_the_picture_about_its_lower_left_corner() {
    let folder = Folder::new("turned");
    folder.write("map.pgm", b"P2 3 2 255\n254 254 254\n254 254 0\n");
    let keys = "resolution: 1\norigin: [-1.0, 2.0, 1.5707963267948966]\n";
    let text = format!("image: map.pgm\n{keys}robots: [[-1.5, 2.5, 0]]");
    let world = World::load(&folder.write("world.yaml", text)).expect("loads");
    // A quarter turn to the left: what was to the right is above.
    assert_eq!(drawn(&world), [".#", "..", ".."]);
    let [x, y] = world.occupancy().origin_m();
    assert!(
        (x + 3.0).abs() < 1e-9 && (y - 2.0).abs() < 1e-9,
        "({x}, {y})"
    );
    assert!(world.is_solid(-1.5, 4.5) && !world.is_solid(-2.5, 4.5));
}

#[test]
fn a_turned_room_keeps_its_walls_closed() {
    let folder = Folder::new("askew");
    let side = 40;
    let border = |k: i32| k == 0 || k == side - 1;
    let pixel = |k: i32| {
        if border(k / side) || border(k % side) {
            "0 "
        } else {
            "254 "
        }
    };
    let pixels: String = (0..side * side).map(pixel).collect();
    folder.write("map.pgm", format!("P2 {side} {side} 255\n{pixels}"));
    for yaw in [0.3, -0.785, 2.0] {
        let (sin, cos) = f64::sin_cos(yaw);
        // The middle of the room.
        let [x, y] = [cos - sin, sin + cos];
        let text = format!(
            "image: map.pgm\nresolution: 0.05\norigin: [0, 0, {yaw}]\nrobots: [[{x}, {y}, 0]]"
        );
        let world = World::load(&folder.write("world.yaml", text)).expect("loads");
        let free = CellSet::free(&world, world.starts()[0]);
        let area_m2 = free.count() as f64 * 0.05 * 0.05;
        // Inside of the walls are 1.9 m squared.
        assert!((area_m2 - 3.61).abs() < 0.1, "{yaw}: {area_m2}");
    }
}

#[test]
fn a_large_picture_is_cut_to_its_known_part() {
    let folder = Folder::new("large");
    let (width, height) = (2_100, 2_000);
    let mut pixels = vec![205_u8; width * height];
    for row in 900..940 {
        pixels[row * width + 1_000..row * width + 1_060].fill(254);
    }
    let mut pgm = format!("P5 {width} {height} 255\n").into_bytes();
    pgm.extend(pixels);
    folder.write("map.pgm", pgm);
    let text = "image: map.pgm\nresolution: 0.05\norigin: [-10, -20, 0]\nrobots: [[41, 34, 0]]";
    let world = World::load(&folder.write("world.yaml", text)).expect("loads");
    let grid = world.occupancy();
    assert_eq!((grid.width(), grid.height()), (62, 42));
    // Outside lie walls of the usual height, as in the whole picture.
    let ray = |z| Ray {
        origin_m: [41.0, 34.0, z],
        direction: [1.0, 0.0, 0.0],
    };
    assert!(
        world
            .cast(&ray(1.4), 12.0)
            .is_some_and(|hit| hit.range_m < 3.0)
    );
    assert_eq!(world.cast(&ray(1.6), 12.0), None);
    // Row 939 from the top is row 1060 from the bottom, and one row of rim is below it.
    let [x, y] = grid.origin_m();
    assert!(
        (x - 39.95).abs() < 1e-9 && (y - 32.95).abs() < 1e-9,
        "({x}, {y})"
    );
}

#[test]
fn a_floor_that_takes_too_much_memory_is_refused() {
    let folder = Folder::new("huge");
    let (width, height) = (5_000, 5_000);
    let mut pgm = format!("P5 {width} {height} 255\n").into_bytes();
    pgm.resize(pgm.len() + width * height, 254);
    folder.write("map.pgm", pgm);
    let error = folder.error("image: map.pgm\nresolution: 0.05\norigin: [0, 0, 0]");
    let expected = "world.yaml: image: the known part has 5000 x 5000 cells of 0.05 m, which take \
                    about 2.2 GB, and 2.0 GB is the limit; scale the picture down, or cut it";
    assert_eq!(error, expected);
}

#[test]
fn a_threshold_that_frees_the_unknown_grey_and_clear_pixels_are_noted() {
    let folder = Folder::new("grey");
    folder.write("map.pgm", b"P2 2 2 255\n254 254 254 205\n");
    let text = format!("image: map.pgm\n{KEYS}free_thresh: 0.25\nrobots: [[-0.5, 3.5, 0]]");
    let world = World::load(&folder.write("world.yaml", text)).expect("loads");
    let note = "free_thresh 0.25 makes grey 205 free, which map savers write for unknown: 25.0 % \
                of the pixels; write free_thresh: 0.196";
    assert_eq!(world.notes(), [note]);
    let kind = (png::ColorType::GrayscaleAlpha, png::BitDepth::Eight);
    let data = [255, 255, 255, 255, 255, 255, 0, 0];
    png(&folder.0.join("map.png"), (2, 2), kind, &data);
    let text = format!("image: map.png\n{KEYS}robots: [[-0.5, 3.5, 0]]");
    let world = World::load(&folder.write("world.yaml", text)).expect("loads");
    let note = "25.0 % of its pixels are transparent and count as unknown; flatten the picture \
                onto white if they are floor";
    assert_eq!(world.notes(), [note]);
}

#[test]
fn the_error_for_an_unknown_world_lists_the_built_in_ones() {
    let error = World::open("ofice").expect_err("no such world").to_string();
    let begin = "ofice: cannot read this world (No such file or directory (os error 2)); \
                 give a world file or a built-in world: office, cave, ";
    assert!(error.starts_with(begin), "{error}");
    assert!(error.ends_with("; did you mean office?"), "{error}");
    for builtin in builtins() {
        assert!(error.contains(builtin.name), "{error}");
    }
}

#[test]
#[ignore = "needs world files of others: set FIELDLINE_DATA to the folder above `worlds`"]
fn the_worlds_of_others_load() {
    let data = std::env::var_os("FIELDLINE_DATA").expect("FIELDLINE_DATA names a folder");
    let folder = PathBuf::from(data).join("worlds");
    let files = fs::read_dir(&folder).expect("a folder of world files");
    let mut count = 0;
    for file in files.flatten() {
        let world = World::load(&file.path()).unwrap_or_else(|error| panic!("{error}"));
        let start = world.starts()[0];
        assert!(
            world.ground_m(start.x_m, start.y_m).is_some(),
            "{}",
            world.name()
        );
        count += 1;
    }
    assert!(count > 0, "no world file in {}", folder.display());
}

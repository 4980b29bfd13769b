//! Occupancy maps: how they are read, and the error line for each fault.

use std::fs;
use std::path::PathBuf;

use host_sim::world::{Class, GridCell, World, builtins};

use crate::{Folder, KEYS, png};

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
        "image: map.pgm\n{KEYS}negate: 1\nfree_thresh: 0.4\noccupied_thresh: 0.9\n\
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
    folder.write("cut.png", &whole[..whole.len() - 20]);
    folder.write("tail.png", &whole[..whole.len() - 6]);
    let good = format!("image: map.pgm\n{KEYS}");
    let heights = |rest: &str| format!("{KEYS}elevation: {{image: map.pgm, {rest}}}");
    let known = "image, resolution, origin, negate, occupied_thresh, free_thresh, mode, \
                 wall_height, elevation, robots";
    let cases = [
        (
            format!("{good}robot: []"),
            format!("robot: unknown key; known are {known}"),
        ),
        (
            heights("z_min: 0, z_max: 1, nodata: 0"),
            "elevation.nodata: unknown key; \
             known are image, z_min, z_max, no_data, bits, resolution, origin"
                .into(),
        ),
        (
            String::new(),
            format!("nothing is not a table; write `key: value` with {known}"),
        ),
        (
            "image: [".into(),
            "unclosed bracket '[' at line 1, column 8; correct the YAML there".into(),
        ),
        (
            format!("{good}resolution: 2"),
            "duplicate mapping key: resolution not allowed here at line 4, column 1; \
             correct the YAML there"
                .into(),
        ),
        (
            "image: map.pgm\nresolution: 1".into(),
            "origin: missing; add for instance `origin: [0, 0, 0]`".into(),
        ),
        (
            "image: map.pgm\norigin: [0, 0]".into(),
            "resolution: missing; add for instance `resolution: 0.05`".into(),
        ),
        (
            KEYS.into(),
            "image: missing; give an image, an elevation, or both".into(),
        ),
        (
            "resolution: wide\norigin: [0, 0]".into(),
            "resolution: `wide` is not a number; give one".into(),
        ),
        (
            "resolution: -1\norigin: [0, 0]".into(),
            "resolution: -1 is not a length above 0 m; give metres".into(),
        ),
        (
            "resolution: 1\norigin: [0, 0, 0.5]".into(),
            "origin: a yaw of 0.5 is not supported; rotate the image and set it to 0".into(),
        ),
        (
            "resolution: 1\norigin: 3".into(),
            "origin: 3 is not [x, y, yaw]; give metres and radians".into(),
        ),
        (
            format!("{good}free_thresh: 0"),
            "free_thresh: 0 is not between 0 and 1; the usual value is 0.196".into(),
        ),
        (
            format!("{good}occupied_thresh: 1.5"),
            "occupied_thresh: 1.5 is not between free_thresh (0.196) and 1; \
             the usual value is 0.65"
                .into(),
        ),
        (
            format!("{good}free_thresh: 0.7"),
            "occupied_thresh: 0.65 is not between free_thresh (0.7) and 1; \
             the usual value is 0.65"
                .into(),
        ),
        (
            format!("{good}negate: 2"),
            "negate: 2 is not 0 or 1; give one of them".into(),
        ),
        (
            format!("{good}mode: raw"),
            "mode: raw is not supported; use trinary".into(),
        ),
        (
            heights("z_min: 2, z_max: 2"),
            "elevation.z_max: 2 is not above z_min (2); swap or correct them".into(),
        ),
        (
            heights("z_min: 0, z_max: 1, no_data: x"),
            "elevation.no_data: `x` is not a number; give one".into(),
        ),
        (
            format!("{KEYS}elevation: {{image: colour.png, z_min: 0, z_max: 1}}"),
            "image colour.png: heights must be grey, and this image has colours; convert it".into(),
        ),
        (
            format!("image: none.pgm\n{KEYS}"),
            "image none.pgm: No such file or directory (os error 2); \
             paths are relative to the world file"
                .into(),
        ),
        (
            format!("image: text.png\n{KEYS}"),
            "image text.png: neither PGM (P2, P5) nor PNG; convert it to one of them".into(),
        ),
        (
            format!("image: cut.pgm\n{KEYS}"),
            "image cut.pgm: truncated, 2 of 9 pixels; copy the whole file".into(),
        ),
        (
            format!("image: odd.pgm\n{KEYS}"),
            "image odd.pgm: more data than the 2 pixels of its header; \
             correct the width and height"
                .into(),
        ),
        (
            format!("image: cut.png\n{KEYS}"),
            "image cut.png: truncated; copy the whole file".into(),
        ),
        (
            format!("image: tail.png\n{KEYS}"),
            "image tail.png: truncated; copy the whole file".into(),
        ),
        (
            format!("{good}robots: []"),
            "robots: a list of 0 is not a list of [x, y, yaw]; give at least one start".into(),
        ),
        (
            format!("{good}robots: [[1]]"),
            "robots[0]: a list of 1 is not [x, y, yaw]; give metres and radians".into(),
        ),
        (
            format!("{good}robots: [[1.5, 2.5, 0]]"),
            "robots[0]: (1.50, 2.50) lies in a wall; the most room is at (0.50, 3.50)".into(),
        ),
        (
            format!("{good}robots: [[0.5, 3.5], [0.75, 2.5]]"),
            "robots[1]: (0.75, 2.50) is too close to a wall, the robot overlaps it; \
             the most room is at (0.50, 3.50)"
                .into(),
        ),
        (
            format!("{good}robots: [[9, 2.5]]"),
            "robots[0]: (9.00, 2.50) lies outside of the map; the most room is at (0.50, 3.50)"
                .into(),
        ),
        (
            format!("image: dark.pgm\n{KEYS}"),
            "robots[0]: (-0.50, 2.50) lies in a wall; \
             no place in the world is free; check negate and the thresholds"
                .into(),
        ),
    ];
    for (text, error) in cases {
        assert_eq!(
            folder.error(&text),
            format!("world.yaml: {error}"),
            "{text}"
        );
    }
}

#[test]
fn the_error_for_an_unknown_world_lists_the_built_in_ones() {
    let error = World::open("ofice").expect_err("no such world").to_string();
    let begin = "ofice: cannot read this world (No such file or directory (os error 2)); \
                 give a world file or a built-in world: office, cave, ";
    assert!(error.starts_with(begin), "{error}");
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

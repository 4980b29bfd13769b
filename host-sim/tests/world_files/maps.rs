//! World files: what is read, and the one line that is said when something is wrong.

use std::fs;
use std::path::{Path, PathBuf};

use host_sim::world::{Class, GridCell, World};

/// A folder of its own for each test, removed at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(test: &str) -> Self {
        let path = std::env::temp_dir().join(format!("fieldline-{}-{test}", std::process::id()));
        fs::create_dir_all(&path).expect("temporary folder");
        Self(path)
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.join(name);
        fs::write(&path, bytes).expect("temporary file");
        path
    }

    /// The message for a world file with this text, without the folder.
    fn complaint(&self, text: &str) -> String {
        let path = self.write("world.yaml", text);
        let error = World::load(&path).expect_err("must not load").to_string();
        assert!(!error.contains('\n'), "one line: {error}");
        error.replace(&format!("{}/", self.0.display()), "")
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

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

fn png(path: &Path, size: (u32, u32), kind: (png::ColorType, png::BitDepth), data: &[u8]) {
    let file = fs::File::create(path).expect("temporary file");
    let mut encoder = png::Encoder::new(file, size.0, size.1);
    encoder.set_color(kind.0);
    encoder.set_depth(kind.1);
    if kind.0 == png::ColorType::Indexed {
        encoder.set_palette(vec![0, 0, 0, 255, 255, 255, 205, 205, 205]);
    }
    let mut writer = encoder.write_header().expect("header");
    writer.write_image_data(data).expect("data");
}

const KEYS: &str = "resolution: 1.0\norigin: [-1, 2, 0]\n";

#[test]
fn shades_become_classes_with_the_top_row_at_the_greatest_y() {
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
        "image: map.pgm\n{KEYS}negate: 1\nfree_thresh: 0.4\noccupied_thresh: 0.9\nmode: trinary\nrobots: [[1.5, 4.5, 0]]"
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
    // Opaque greys keep their meaning beside an alpha channel; what is transparent is unknown.
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
fn heights_are_linear_between_the_samples() {
    let folder = Folder::new("heights");
    folder.write("z.pgm", b"P2 3 2 5\n1 3 5\n1 1 0\n");
    let elevation = "elevation: {image: z.pgm, z_min: -1, z_max: 3, no_data: 0}\n";
    let path = folder.write("world.yaml", format!("{KEYS}{elevation}wall_height: 2\n"));
    let world = World::load(&path).expect("loads");
    // Samples at x = −0.5, 0.5, 1.5 and y = 2.5 (lower row), 3.5 (upper row); 1 is −1 m, 5 is 3 m, 0 is a hole.
    assert_eq!(world.ground_m(-0.5, 3.5), Some(-1.0));
    assert_eq!(world.ground_m(0.5, 3.5), Some(1.0));
    assert_eq!(world.ground_m(0.0, 3.0), Some(-0.5));
    assert_eq!(world.ground_m(-1.0, 2.0), Some(-1.0));
    assert_eq!(world.ground_m(1.0, 3.0), None);
    assert_eq!(world.ground_m(-1.1, 3.0), None);
    assert_eq!(world.wall_height_m(), 2.0);
    assert_eq!(world.size_m(), [3.0, 2.0]);
    // Without robots the start is the origin of the frame, or else the first of the widest places.
    assert_eq!((world.starts()[0].x_m, world.starts()[0].y_m), (-0.5, 2.5));
}

#[test]
fn every_mistake_is_named_in_one_line() {
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
    let known = "image, resolution, origin, negate, occupied_thresh, free_thresh, mode, wall_height, elevation, robots";
    let cases = [
        (format!("{good}robot: []"), format!("robot: unknown key; known are {known}")),
        (heights("z_min: 0, z_max: 1, nodata: 0"), "elevation.nodata: unknown key; known are image, z_min, z_max, no_data, bits, resolution, origin".into()),
        (String::new(), format!("nothing is not a table; write `key: value` with {known}")),
        ("image: [".into(), "unclosed bracket '[' at line 1, column 8; correct the YAML there".into()),
        (format!("{good}resolution: 2"), "duplicate mapping key: resolution not allowed here at line 4, column 1; correct the YAML there".into()),
        ("image: map.pgm\nresolution: 1".into(), "origin: missing; add for instance `origin: [0, 0, 0]`".into()),
        ("image: map.pgm\norigin: [0, 0]".into(), "resolution: missing; add for instance `resolution: 0.05`".into()),
        (KEYS.into(), "image: missing; give an image, an elevation, or both".into()),
        ("resolution: wide\norigin: [0, 0]".into(), "resolution: `wide` is not a number".into()),
        ("resolution: -1\norigin: [0, 0]".into(), "resolution: -1 is not a length above 0 m".into()),
        ("resolution: 1\norigin: [0, 0, 0.5]".into(), "origin: a yaw of 0.5 is not supported; rotate the image and set it to 0".into()),
        ("resolution: 1\norigin: 3".into(), "origin: 3 is not [x, y, yaw]".into()),
        (format!("{good}free_thresh: 0"), "free_thresh: 0 is not between 0 and 1".into()),
        (format!("{good}occupied_thresh: 1.5"), "occupied_thresh: 1.5 is not between free_thresh (0.196) and 1".into()),
        (format!("{good}free_thresh: 0.7"), "occupied_thresh: 0.65 is not between free_thresh (0.7) and 1".into()),
        (format!("{good}negate: 2"), "negate: 2 is not 0 or 1".into()),
        (format!("{good}mode: raw"), "mode: raw is not supported; use trinary".into()),
        (heights("z_min: 2, z_max: 2"), "elevation.z_max: 2 is not above z_min (2)".into()),
        (heights("z_min: 0, z_max: 1, no_data: x"), "elevation.no_data: `x` is not a number".into()),
        (format!("{KEYS}elevation: {{image: colour.png, z_min: 0, z_max: 1}}"), "image colour.png: heights must be grey, and this image has colours; convert it".into()),
        (format!("image: none.pgm\n{KEYS}"), "image none.pgm: No such file or directory (os error 2); paths are relative to the world file".into()),
        (format!("image: text.png\n{KEYS}"), "image text.png: neither PGM (P2, P5) nor PNG; convert it".into()),
        (format!("image: cut.pgm\n{KEYS}"), "image cut.pgm: truncated, 2 of 9 pixels; copy the whole file".into()),
        (format!("image: odd.pgm\n{KEYS}"), "image odd.pgm: more data than the 2 pixels of its header; correct the width and height".into()),
        (format!("image: cut.png\n{KEYS}"), "image cut.png: truncated; copy the whole file".into()),
        (format!("image: tail.png\n{KEYS}"), "image tail.png: truncated; copy the whole file".into()),
        (format!("{good}robots: []"), "robots: a list of 0 is not a list of [x, y, yaw], at least one".into()),
        (format!("{good}robots: [[1]]"), "robots[0]: a list of 1 is not [x, y, yaw]".into()),
        (format!("{good}robots: [[1.5, 2.5, 0]]"), "robots[0]: (1.50, 2.50) lies in a wall; most room is at (0.50, 3.50)".into()),
        (format!("{good}robots: [[0.5, 3.5], [0.75, 2.5]]"), "robots[1]: (0.75, 2.50) is too close to a wall, the robot overlaps it; most room is at (0.50, 3.50)".into()),
        (format!("{good}robots: [[9, 2.5]]"), "robots[0]: (9.00, 2.50) lies outside of the map; most room is at (0.50, 3.50)".into()),
        (format!("image: dark.pgm\n{KEYS}"), "robots[0]: (-0.50, 2.50) lies in a wall; nothing is free anywhere, check negate and the thresholds".into()),
    ];
    for (text, complaint) in cases {
        assert_eq!(
            folder.complaint(&text),
            format!("world.yaml: {complaint}"),
            "{text}"
        );
    }
}

#[test]
fn heights_that_cannot_be_meant_are_named_in_one_line() {
    let folder = Folder::new("bad-heights");
    let white = |width: usize, height: usize| {
        let mut bytes = format!("P5 {width} {height} 255\n").into_bytes();
        bytes.extend(vec![254; width * height]);
        bytes
    };
    folder.write("map.pgm", white(6, 4));
    folder.write("small.pgm", white(3, 2));
    folder.write("z8.pgm", white(6, 4));
    let mut wide = b"P5 6 4 65535\n".to_vec();
    wide.extend(vec![77; 48]);
    folder.write("z16.pgm", &wide);
    folder.write("claimed.pgm", &wide[..wide.len() - 24]);
    folder.write(
        "empty.pgm",
        b"P2 6 4 9\n0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0\n",
    );
    let world = |image: &str, rest: &str| {
        format!("image: map.pgm\n{KEYS}elevation: {{image: {image}, z_min: 0, z_max: 1{rest}}}\n")
    };
    let cases = [
        (
            world("small.pgm", ""),
            "image small.pgm: 3 x 2 pixels of heights, but the map has 6 x 4; give elevation a resolution and an origin of its own, or images of one size",
        ),
        (
            world("z8.pgm", ", bits: 16"),
            "image z8.pgm: 8-bit grey (values up to 255), but elevation.bits says 16; save it with 16 bits, or correct bits",
        ),
        (
            world("z16.pgm", ", bits: 8"),
            "image z16.pgm: 16-bit grey (values up to 65535), but elevation.bits says 8; save it with 8 bits, or correct bits",
        ),
        (
            world("z8.pgm", ", bits: 12"),
            "elevation.bits: 12 is neither 8 nor 16",
        ),
        (
            world("z8.pgm", ", no_data: 65535"),
            "image z8.pgm: values go up to 255 (8 bits), so none can be no_data (65535); save it with 16 bits, or correct no_data",
        ),
        (
            world("claimed.pgm", ""),
            "image claimed.pgm: its header claims samples of 16 bits (a greatest value above 255), but it holds one byte a pixel; set the greatest value to 255, or save it with 16 bits",
        ),
        (
            world("empty.pgm", ", no_data: 0"),
            "image empty.pgm: no pixel of it has a surface; check no_data",
        ),
        (
            format!("{KEYS}elevation: {{image: z8.pgm, z_min: .nan, z_max: 1}}"),
            "value `.nan` is not a finite number at line 3, column 35; correct the YAML there",
        ),
        (
            format!("{KEYS}elevation: {{image: z8.pgm, z_min: 0, z_max: .inf}}"),
            "value `.inf` is not a finite number at line 3, column 45; correct the YAML there",
        ),
        (
            format!("{KEYS}elevation: {{image: z8.pgm, z_min: 3, z_max: 1}}"),
            "elevation.z_max: 1 is not above z_min (3)",
        ),
    ];
    for (text, complaint) in cases {
        assert_eq!(
            folder.complaint(&text),
            format!("world.yaml: {complaint}"),
            "{text}"
        );
    }
}

/// A world of 20 × 10 m at 0.5 m a pixel, of these heights and this start.
fn heights(folder: &Folder, name: &str, value: impl Fn(usize) -> u16, more: &str) -> PathBuf {
    let mut bytes = b"P5 40 20 65535\n".to_vec();
    for _ in 0..20 {
        bytes.extend((0..40).flat_map(|i| value(i).to_be_bytes()));
    }
    folder.write(&format!("{name}.pgm"), bytes);
    let keys = "resolution: 0.5\norigin: [0, 0, 0]\n";
    let elevation = format!(
        "elevation: {{image: {name}.pgm, z_min: 0, z_max: 6.5535, no_data: 0, bits: 16}}\n"
    );
    folder.write(&format!("{name}.yaml"), format!("{keys}{elevation}{more}"))
}

#[test]
fn a_start_over_no_data_or_on_a_cliff_is_refused_with_a_better_place() {
    let folder = Folder::new("bad-ground");
    let hole = |i: usize| if i < 12 { 0 } else { 1000 };
    let path = heights(&folder, "hole", hole, "robots: [[2, 5, 0]]");
    let error = World::load(&path).expect_err("a hole").to_string();
    assert!(
        error.ends_with("robots[0]: (2.00, 5.00) has no ground under the robot's wheels; most room is at (10.75, 4.75)"),
        "{error}"
    );
    // A metre a pixel from x = 10 on: 63°. The file loads, for limits are the run's; the run is refused.
    let cliff = |i: usize| 1000 + 10_000 * i.saturating_sub(20).min(5) as u16;
    let path = heights(&folder, "cliff", cliff, "robots: [[11.5, 5, 0]]");
    let world = World::load(&path).expect("loads");
    let config = host_sim::sim::SimConfig::default();
    let error = host_sim::sim::Simulator::new(&world, config)
        .expect_err("too steep")
        .to_string();
    assert_eq!(
        error,
        "cliff: robots[0]: the robot would tip over, at a pitch of -63.4 and a roll of 0.0 degrees; most room is at (4.75, 4.75)"
    );
    // Without robots the start is amid easy ground, far from the steep middle.
    let path = heights(&folder, "default", cliff, "");
    let start = World::load(&path).expect("loads").starts()[0];
    assert_eq!((start.x_m, start.y_m), (4.75, 4.75));
}

#[test]
fn transparent_pixels_have_no_surface() {
    let folder = Folder::new("clear-ground");
    // Two rows of four: the right half cannot be seen.
    let row = [[10, 255], [10, 255], [10, 0], [10, 254]].concat();
    let kind = (png::ColorType::GrayscaleAlpha, png::BitDepth::Eight);
    png(
        &folder.0.join("z.png"),
        (4, 2),
        kind,
        &[&row[..], &row].concat(),
    );
    let text = "resolution: 2\norigin: [0, 0, 0]\nelevation: {image: z.png, z_min: 0, z_max: 25.5}\nrobots: [[1.5, 2, 0]]";
    let world = World::load(&folder.write("world.yaml", text)).expect("loads");
    let height = |x_m: f64| world.ground_m(x_m, 2.0);
    assert!((height(1.5).expect("ground") - 1.0).abs() < 1e-12);
    assert_eq!([3.5, 5.0, 7.5].map(height), [None; 3]);
    assert!(world.notes().iter().any(|note| note.starts_with("50.0 %")));
}

#[test]
fn what_may_surprise_about_the_ground_is_noted() {
    let folder = Folder::new("notes");
    folder.write("map.pgm", b"P2 4 2 255\n254 254 254 254 254 254 254 254\n");
    folder.write("z.pgm", b"P2 2 2 255\n0 9 9 9\n");
    let elevation = "elevation: {image: z.pgm, z_min: 0, z_max: 12.75, no_data: 0, resolution: 1, origin: [0, 0]}";
    let text = format!(
        "image: map.pgm\nresolution: 1\norigin: [0, 0, 0]\n{elevation}\nrobots: [[1.75, 0.5, 0]]\n"
    );
    let world = World::load(&folder.write("world.yaml", text)).expect("loads");
    assert_eq!(
        world.notes(),
        [
            "its heights come in steps of 0.050 m (8 bits over 12.75 m): slopes become stairs; 16 bits would be smooth",
            "25.0 % of its pixels have no surface: holes without a floor",
            "it does not cover the map: 50.0 % of the free floor lie beyond it, without ground",
        ]
    );
    assert_eq!(World::open("slope").expect("built in").notes(), [""; 0]);
}

#[test]
fn an_unknown_world_lists_the_built_in_ones() {
    let error = World::open("ofice").expect_err("no such world").to_string();
    assert_eq!(
        error,
        "ofice: cannot read this world (No such file or directory (os error 2)); give a world file or a built-in world: \
         office, cave, loop, cluttered, hall, empty-hall, narrow-doors, unreachable-room, boxed-in, slope, holes, building, \
         cliff, spiral, kerbs, waves, pass, causeway, ouroboros-a, ouroboros-b, ouroboros-c, ouroboros-d, tdbvp-adjacent, tdbvp-nested, tdbvp-floor"
    );
}

#[test]
fn the_shared_worlds_load() {
    let folder = std::env::var_os("FIELDLINE_DATA")
        .map_or_else(
            || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data"),
            PathBuf::from,
        )
        .join("worlds");
    let Ok(files) = fs::read_dir(&folder) else {
        println!("skipped: no worlds in {}", folder.display());
        return;
    };
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

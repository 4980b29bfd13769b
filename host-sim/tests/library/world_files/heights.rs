//! Heights: how they are read, and the error lines and notes about them.

use std::path::PathBuf;

use host_sim::world::World;

use super::{Folder, KEYS, png};

#[test]
fn heights_are_linear_between_the_samples() {
    let folder = Folder::new("heights");
    folder.write("z.pgm", b"P2 3 2 5\n1 3 5\n1 1 0\n");
    let elevation = "elevation: {image: z.pgm, z_min: -1, z_max: 3, no_data: 0}\n";
    let path = folder.write("world.yaml", format!("{KEYS}{elevation}wall_height: 2\n"));
    let world = World::load(&path).expect("loads");
    // Samples are at x = −0.5, 0.5, 1.5 m and y = 2.5 m (lower row), 3.5 m (upper row). 1 is −1 m,
    // 5 is 3 m, 0 is a hole.
    assert_eq!(world.ground_m(-0.5, 3.5), Some(-1.0));
    assert_eq!(world.ground_m(0.5, 3.5), Some(1.0));
    assert_eq!(world.ground_m(0.0, 3.0), Some(-0.5));
    assert_eq!(world.ground_m(-1.0, 2.0), Some(-1.0));
    assert_eq!(world.ground_m(1.0, 3.0), None);
    assert_eq!(world.ground_m(-1.1, 3.0), None);
    assert_eq!(world.wall_height_m(), 2.0);
    assert_eq!(world.size_m(), [3.0, 2.0]);
    // Without robots the start is the origin of the frame, or else the first of the widest
    // places.
    assert_eq!((world.starts()[0].x_m, world.starts()[0].y_m), (-0.5, 2.5));
}

/// A folder with a floor of 6 × 4 pixels, and heights of which some are wrong.
fn pictures() -> Folder {
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
    folder
}

#[test]
fn each_fault_of_the_heights_has_its_error_line() {
    let folder = pictures();
    let world = |image: &str, rest: &str| {
        format!("image: map.pgm\n{KEYS}elevation: {{image: {image}, z_min: 0, z_max: 1{rest}}}\n")
    };
    let cases = [
        (
            world("small.pgm", ""),
            "image small.pgm: 3 x 2 pixels of heights, but the map has 6 x 4; \
             give elevation a resolution and an origin of its own, or images of one size",
        ),
        (
            world("z8.pgm", ", bits: 16"),
            "image z8.pgm: 8-bit grey (values up to 255), but elevation.bits says 16; \
             save it with 16 bits, or correct bits",
        ),
        (
            world("z16.pgm", ", bits: 8"),
            "image z16.pgm: 16-bit grey (values up to 65535), but elevation.bits says 8; \
             save it with 8 bits, or correct bits",
        ),
        (
            world("z8.pgm", ", bits: 12"),
            "elevation.bits: 12 is neither 8 nor 16; give one of them",
        ),
        (
            world("z8.pgm", ", no_data: 65535"),
            "image z8.pgm: values go up to 255 (8 bits), so none can be no_data (65535); \
             save it with 16 bits, or correct no_data",
        ),
        (
            world("claimed.pgm", ""),
            "image claimed.pgm: its header claims samples of 16 bits (a greatest value above 255), \
             but it holds one byte a pixel; \
             set the greatest value to 255, or save it with 16 bits",
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
            "elevation.z_max: 1 is not above z_min (3); swap or correct them",
        ),
    ];
    for (text, error) in cases {
        let error = format!("world.yaml: {error}");
        assert_eq!(folder.error(&text), error, "{text}");
    }
}

/// Writes a world of 20 × 10 m at 0.5 m per pixel, with these heights and more keys.
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
fn a_start_over_a_hole_or_on_a_cliff_is_refused() {
    let folder = Folder::new("bad-ground");
    let hole = |i: usize| if i < 12 { 0 } else { 1000 };
    let path = heights(&folder, "hole", hole, "robots: [[2, 5, 0]]");
    let error = World::load(&path).expect_err("a hole").to_string();
    assert!(
        error.ends_with(
            "robots[0]: (2.00, 5.00) has no ground under the robot's wheels; \
             the most room is at (10.75, 4.75)"
        ),
        "{error}"
    );
    // From x = 10 m on the ground rises by 1 m per pixel, 63°. The file loads, because limits
    // belong to the run; the run is refused.
    let cliff = |i: usize| 1000 + 10_000 * i.saturating_sub(20).min(5) as u16;
    let path = heights(&folder, "cliff", cliff, "robots: [[11.5, 5, 0]]");
    let world = World::load(&path).expect("loads");
    let config = host_sim::sim::SimConfig::default();
    let error = host_sim::sim::Simulator::new(&world, config)
        .expect_err("too steep")
        .to_string();
    assert_eq!(
        error,
        "cliff: robots[0]: the robot would tip over, \
         at a pitch of -63.4 and a roll of 0.0 degrees; the most room is at (4.75, 4.75)"
    );
    // Without robots the start is in the middle of easy ground, far from the steep part.
    let path = heights(&folder, "default", cliff, "");
    let start = World::load(&path).expect("loads").starts()[0];
    assert_eq!((start.x_m, start.y_m), (4.75, 4.75));
}

#[test]
fn transparent_pixels_have_no_surface() {
    let folder = Folder::new("clear-ground");
    // Two rows of four pixels; the right half is transparent.
    let row = [[10, 255], [10, 255], [10, 0], [10, 254]].concat();
    let kind = (png::ColorType::GrayscaleAlpha, png::BitDepth::Eight);
    png(
        &folder.0.join("z.png"),
        (4, 2),
        kind,
        &[&row[..], &row].concat(),
    );
    let text = "resolution: 2\norigin: [0, 0, 0]\n\
                elevation: {image: z.png, z_min: 0, z_max: 25.5}\nrobots: [[1.5, 2, 0]]";
    let world = World::load(&folder.write("world.yaml", text)).expect("loads");
    let height = |x_m: f64| world.ground_m(x_m, 2.0);
    assert!((height(1.5).expect("ground") - 1.0).abs() < 1e-12);
    assert_eq!([3.5, 5.0, 7.5].map(height), [None; 3]);
    assert!(world.notes().iter().any(|note| note.starts_with("50.0 %")));
}

#[test]
fn surprising_ground_has_notes() {
    let folder = Folder::new("notes");
    folder.write("map.pgm", b"P2 4 2 255\n254 254 254 254 254 254 254 254\n");
    folder.write("z.pgm", b"P2 2 2 255\n0 9 9 9\n");
    let elevation = "elevation: {image: z.pgm, z_min: 0, z_max: 12.75, no_data: 0, \
                     resolution: 1, origin: [0, 0]}";
    let text = format!(
        "image: map.pgm\nresolution: 1\norigin: [0, 0, 0]\n{elevation}\nrobots: [[1.75, 0.5, 0]]\n"
    );
    let world = World::load(&folder.write("world.yaml", text)).expect("loads");
    assert_eq!(
        world.notes(),
        [
            "its heights come in steps of 0.050 m (8 bits over 12.75 m): \
             slopes become stairs; 16 bits would be smooth",
            "25.0 % of its pixels have no surface: holes without a floor",
            "it does not cover the map: 50.0 % of the free floor lie beyond it, without ground",
        ]
    );
    assert_eq!(World::open("slope").expect("built in").notes(), [""; 0]);
}

//! What can be asserted of a picture: places, colours at places, and that odd runs draw at all.

use super::{Frame, Scene, run_png};
use crate::report::tum::Stamped;
use crate::report::{GridMap, MapCell};
use crate::trial::snapshot::{Window, WindowCell};

fn decode(png: &[u8]) -> tiny_skia::Pixmap {
    tiny_skia::Pixmap::decode_png(png).expect("a PNG")
}

/// A room of 100 × 80 cells with a wall and a door, the robot's path through it and a window around its end.
fn room() -> (GridMap, Vec<Stamped>, Window) {
    let mut map = GridMap::unknown(-50, -40, 100, 80);
    for y in -38..38 {
        for x in -48..48 {
            let rim = x == -48 || x == 47 || y == -38 || y == 37;
            let wall = x == 0 && !(10..22).contains(&y);
            let cell = if rim || wall {
                MapCell::Obstacle
            } else {
                MapCell::Free
            };
            map.set(x, y, cell);
        }
    }
    for x in -40..40 {
        map.set_skeleton(x, 14);
    }
    let path = (0..600).map(|i| Stamped {
        time_ms: i * 100,
        x_m: -3.5 + f64::from(i) * 0.012,
        y_m: 1.5 + (f64::from(i) * 0.02).sin() * 0.4,
        yaw_rad: 0.3,
        ..Stamped::default()
    });
    let cells = (0..61 * 61).map(|i| {
        let (x, y) = (i % 61 - 5, i / 61 - 28);
        match (x, y) {
            (40, 30) => WindowCell::Goal,
            _ if map.get(x, y) == MapCell::Obstacle => WindowCell::Obstacle,
            _ => WindowCell::Free,
        }
    });
    let cells: Vec<WindowCell> = cells.collect();
    let q = crate::trial::oracle::solve(&cells);
    let window = Window {
        origin_x: -5,
        origin_y: -28,
        cell_m: 0.1,
        q: q.iter().map(|q| *q as f32).collect(),
        cells,
    };
    (map, path.collect(), window)
}

#[test]
fn colours_are_where_the_map_says() {
    let (map, path, window) = room();
    let scene = Scene {
        title: "room · frontier · seed 1",
        subtitle: "explored 99.2 % in 1:00 min, 7.2 m driven",
        map: &map,
        path: &path,
        window: Some(&window),
        residue: &[(-2.0, -3.0)],
    };
    let png = run_png(&scene);
    if let Ok(folder) = std::env::var("FIELDLINE_PICTURES") {
        std::fs::write(std::path::Path::new(&folder).join("room.png"), &png).unwrap();
    }
    let (page, frame) = (decode(&png), Frame::around(&map));
    let colour = |x_m: f64, y_m: f64| {
        let (x, y) = frame.metres(x_m, y_m);
        let pixel = page.pixel(x as u32, y as u32).unwrap();
        (pixel.red(), pixel.green(), pixel.blue())
    };
    assert_eq!(colour(-4.95, 0.05), (0xe8, 0xeb, 0xef), "unknown");
    assert_eq!(colour(-3.05, -2.05), (0xff, 0xff, 0xff), "free");
    assert_eq!(colour(-4.75, 0.05), (0x2b, 0x33, 0x3d), "wall");
    assert_eq!(colour(-2.0, -3.0), (0xe0, 0x8e, 0x0b), "residual frontier");
    let (start, end) = (path[0], path[599]);
    assert_eq!(
        colour(start.x_m, start.y_m),
        (0xff, 0xff, 0xff),
        "the ring's eye"
    );
    assert_eq!(
        colour(end.x_m, end.y_m),
        (0x1d, 0x23, 0x2b),
        "the end's head"
    );
}

#[test]
fn a_run_that_saw_nothing_still_has_a_picture() {
    let scene = Scene {
        title: "nothing",
        subtitle: "",
        map: &GridMap::default(),
        path: &[],
        window: None,
        residue: &[],
    };
    assert!(decode(&run_png(&scene)).width() > 400);
}

#[test]
fn large_maps_keep_whole_pixels() {
    let side = |cells: usize| Frame::around(&GridMap::unknown(0, 0, cells, cells / 2)).cell_px;
    assert_eq!([20, 100, 300, 640, 1_300].map(side), [14, 6, 4, 2, 2]);
}

#[test]
fn pixels_and_spots_agree() {
    let frame = Frame::around(&GridMap::unknown(-7, 3, 30, 20));
    let rim = 3 * frame.cell_px;
    let (left, top) = frame.pixel(-7, 22);
    assert_eq!((left, top), (frame.left + rim, frame.top + rim));
    let (x, y) = frame.spot(-7.0, 23.0);
    assert_eq!((x, y), (left as f32, top as f32));
    let (x, y) = frame.metres(2.3, 0.3);
    let right = frame.left + frame.width() - rim;
    let bottom = frame.top + frame.height() - rim;
    assert_eq!((x.round() as i32, y.round() as i32), (right, bottom));
    assert!(frame.holds((x, y)) && !frame.holds((x, 0.0)));
}

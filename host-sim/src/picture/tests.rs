//! Tests of places and colours, and pictures of unusual runs.

use super::panels::Strip;
use super::{FOOTER, Frame, GAP, GOOD_SIDE, Ground, MARGIN, Scene, area, run_png};
use crate::metrics::{Footing, GroundTruth};
use crate::report::grid_map::StrategyData;
use crate::report::tum::Stamped;
use crate::report::{GridMap, MapCell};
use crate::robot::{Limits, RADIUS_M};
use crate::trial::planned_path::PlannedPath;
use crate::trial::relief::Relief;
use crate::trial::snapshot::{Window, WindowCell};
use crate::world::World;

fn decode(png: &[u8]) -> tiny_skia::Pixmap {
    tiny_skia::Pixmap::decode_png(png).expect("a PNG")
}

fn around(map: &GridMap) -> Frame {
    Frame::around(area(map), GOOD_SIDE)
}

/// Makes a scene with a map and nothing else.
fn scene_of(map: &GridMap) -> Scene<'_> {
    Scene {
        subtitle: "explored 99.2 % in 1:00 min, 7.2 m driven",
        ..Scene::plain("room · frontier · seed 1", map, &[])
    }
}

/// Makes a room of 100 × 80 cells with a wall and a door, a path through it, and a window around
/// the end of the path.
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
        path: &path,
        window: Some(&window),
        residual: &[(-2.0, -3.0)],
        ..scene_of(&map)
    };
    let png = run_png(&scene);
    if let Ok(folder) = std::env::var("FIELDLINE_PICTURES") {
        std::fs::write(std::path::Path::new(&folder).join("room.png"), &png).unwrap();
    }
    let (page, frame) = (decode(&png), around(&map));
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
    let png = run_png(&scene_of(&GridMap::default()));
    assert!(decode(&png).width() > 400);
}

#[test]
fn the_true_ground_lies_beside_the_map_in_the_same_frame() {
    let world = World::builtin("causeway").expect("listed");
    let footing = Footing::new(&world, world.starts()[0], RADIUS_M, &Limits::WORKING);
    let truth = GroundTruth::new(&world, &footing, &Limits::WORKING);
    let ground = Ground::new(&world, &truth, 0.0);
    // The robot has seen a corner of the world only.
    let mut map = GridMap::unknown(20, 20, 40, 40);
    map.set(30, 30, MapCell::NegativeObstacle);
    let scene = Scene {
        ground: Some(ground),
        ..scene_of(&map)
    };
    let (page, frame) = (decode(&run_png(&scene)), Frame::of(&scene));
    let beside = frame.beside();
    let colour = |frame: &Frame, x_m: f64, y_m: f64| {
        let (x, y) = frame.metres(x_m, y_m);
        let pixel = page.pixel(x as u32, y as u32).unwrap();
        (pixel.red(), pixel.green(), pixel.blue())
    };
    assert_eq!(frame.columns, 260 + 6);
    assert!(beside.left + beside.width() < page.width() as i32);
    let (negative, unknown) = ((0x8a, 0x5a, 0x3b), (0xe8, 0xeb, 0xef));
    assert_eq!(colour(&frame, 3.05, 3.05), negative, "the robot's map");
    assert_eq!(colour(&frame, 13.05, 3.05), unknown, "not on its map");
    assert_eq!(colour(&beside, 13.05, 3.05), negative, "no floor");
    assert_eq!(colour(&beside, 0.05, 3.05), (0x2b, 0x33, 0x3d), "fence");
    assert_eq!(colour(&beside, -0.15, 3.05), unknown, "outside");
    // Reachable ground is sand, unreachable ground is greyed.
    let light = |(r, g, b): (u8, u8, u8)| (r > 0xd8 && g > 0xc8, r > b);
    assert_eq!(light(colour(&beside, 4.05, 7.05)), (true, true));
    assert_eq!(light(colour(&beside, 13.05, 11.05)), (false, false));
}

#[test]
fn the_last_window_is_in_four_panels_below_the_maps() {
    let world = World::builtin("causeway").expect("listed");
    let footing = Footing::new(&world, world.starts()[0], RADIUS_M, &Limits::WORKING);
    let truth = GroundTruth::new(&world, &footing, &Limits::WORKING);
    let (map, path, window) = room();
    // The western half lies 1 m higher, the north is not measured, and the east repels.
    let cells = 0..61 * 61;
    let relief = Relief {
        heights_m: cells
            .clone()
            .map(|i| (i < 50 * 61).then_some(if i % 61 < 30 { 1.0 } else { 0.0 }))
            .collect(),
        preferences: cells
            .map(|i| if i % 61 < 30 { 0.0 } else { -0.5 })
            .collect(),
    };
    let scene = Scene {
        path: &path,
        window: Some(&window),
        relief: Some(&relief),
        ground: Some(Ground::new(&world, &truth, 0.0)),
        ..scene_of(&map)
    };
    let (page, frame) = (decode(&run_png(&scene)), Frame::of(&scene));
    let right = frame.beside();
    let top = frame.top + frame.height() + FOOTER;
    let strip = Strip::under(MARGIN, top, right.left + right.width() - MARGIN);
    assert!(top + strip.height() < page.height() as i32);
    let side = strip.height() / 61;
    let colour = |panel: i32, x: i32, y: i32| {
        let left = MARGIN + panel * (61 * side + GAP);
        let (x, y) = (left + x * side + 1, top + (60 - y) * side + 1);
        let pixel = page.pixel(x as u32, y as u32).unwrap();
        (pixel.red(), pixel.green(), pixel.blue())
    };
    let unknown = (0xe8, 0xeb, 0xef);
    assert_eq!(colour(0, 20, 20), (0xf6, 0xe6, 0xc8), "high");
    assert_eq!(colour(0, 40, 20), (0x5f, 0x93, 0x9c), "low");
    assert_eq!(colour(0, 20, 55), unknown, "not measured");
    // The wall is column 5 of the window. The goal at (40, 30) is column 45 of row 58.
    assert_eq!(colour(1, 5, 20), (0x2b, 0x33, 0x3d), "wall");
    assert_eq!(colour(1, 20, 20), (0xff, 0xff, 0xff), "free");
    assert_eq!(colour(1, 45, 58), (0x1f, 0x6f, 0xb2), "goal");
    assert_eq!(colour(2, 20, 20), (0xf7, 0xf7, 0xf7), "neither");
    assert_eq!(colour(2, 40, 20), (0xb3, 0x58, 0x06), "repels");
    assert_eq!(colour(2, 5, 20), unknown, "no field in a wall");
    let light = |(r, g, b): (u8, u8, u8)| u32::from(r) + u32::from(g) + u32::from(b);
    assert!(light(colour(3, 44, 56)) > light(colour(3, 10, 3)), "nearer");
}

#[test]
fn a_page_has_room_for_a_later_map() {
    let (early, late) = (
        GridMap::unknown(0, 0, 30, 20),
        GridMap::unknown(-40, -10, 90, 120),
    );
    let size = |map, room_for| {
        let page = decode(&run_png(&Scene {
            room_for,
            ..scene_of(map)
        }));
        (page.width(), page.height())
    };
    assert_ne!(size(&early, None), size(&late, None));
    assert_eq!(size(&early, Some(&late)), size(&late, None));
}

#[test]
fn large_maps_keep_whole_pixels() {
    let side = |cells: usize| around(&GridMap::unknown(0, 0, cells, cells / 2)).cell_px;
    assert_eq!([20, 100, 300, 640, 1_300].map(side), [14, 6, 4, 2, 2]);
}

#[test]
fn pixels_and_spots_agree() {
    let frame = around(&GridMap::unknown(-7, 3, 30, 20));
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

#[test]
fn loops_and_rails_are_drawn_at_their_places() {
    let (mut map, path, _) = room();
    // Tile (-1, 0): its lower left region is closed, the third one is given up, and its two lower
    // places have stamps.
    let data = StrategyData {
        closed_regions: 1,
        given_up_regions: 4,
        visit_stamps: [3, 9, 0, 0],
    };
    map.set_strategy_data((-1, 0), data);
    let planned_path = PlannedPath {
        tractor: Some((-40, -20)),
        shield: Some([(20, -30), (20, -20)]),
        cells: vec![(30, -10), (30, 0)],
    };
    let scene = Scene {
        path: &path[..1],
        planned_path: Some(&planned_path),
        given_up: &[(-2.0, -3.0)],
        ..scene_of(&map)
    };
    let (page, frame) = (decode(&run_png(&scene)), around(&map));
    let colour = |x_m: f64, y_m: f64| {
        let (x, y) = frame.metres(x_m, y_m);
        let pixel = page.pixel(x as u32, y as u32).unwrap();
        (pixel.red(), pixel.green(), pixel.blue())
    };
    let red = (0xc0, 0x1f, 0x2e);
    assert_eq!(colour(-3.9, -1.9), red, "the tractor point");
    assert_eq!(colour(2.1, -2.4), red, "the shield");
    assert_eq!(colour(-2.0, -3.0), red, "a loop given up");
    assert_eq!(
        colour(3.1, -0.5),
        (0x1f, 0x6f, 0xb2),
        "the path to the goal"
    );
    assert_eq!(colour(-3.15, 0.15), (0xe6, 0xf3, 0xe4), "a closed region");
    assert_eq!(colour(-2.25, 0.15), (0xff, 0xff, 0xff), "beside it");
    assert_eq!(colour(-1.45, 0.15), (0xfb, 0xea, 0xdc), "a given up region");
    // Beside the line of the skeleton, which lies on the band. The younger rail is darker.
    let band = |x_m: f64| colour(x_m, 1.56);
    assert_eq!(band(-2.5), (0xbf, 0xe5, 0xbb), "the oldest rail");
    assert_eq!(band(-0.7), (0x0b, 0x55, 0x3c), "the newest rail");
    assert_eq!(band(1.0), (0xff, 0xff, 0xff), "never visited");
}

//! Known maps: their cells, their frames, and what is refused.

use core::f64::consts::FRAC_PI_2;

use host_sim::known_map::{KnownMap, Loaded, pose_of};
use host_sim::robot::{Footprint, Pose};
use host_sim::world::{Class, GridCell, Occupancy, World};

/// Where the robot starts in all tests.
const START: (f64, f64) = (2.0, 1.0);

fn start() -> Pose {
    Pose {
        x_m: START.0,
        y_m: START.1,
        ..Pose::default()
    }
}

/// A free floor of 4 × 2 m with its least corner at the origin.
fn floor(resolution_m: f64) -> Occupancy {
    let cells = |side_m: f64| (side_m / resolution_m).round() as usize;
    Occupancy::filled(
        cells(4.0),
        cells(2.0),
        resolution_m,
        [0.0, 0.0],
        Class::Free,
    )
}

fn load(plan: Occupancy, pose: Option<[f64; 3]>) -> Result<Loaded, String> {
    let pose = pose.map(|it| pose_of(it).expect("a pose"));
    let map = KnownMap::new("m.yaml", plan, pose);
    let loaded = map.load_for(&start(), &Footprint::PIONEER_3AT);
    loaded.map_err(|error| error.to_string())
}

/// Returns the class of a cell of the map.
fn class(loaded: &Loaded, (x, y): (i32, i32)) -> u32 {
    let key = [x, y].map(|at| at.div_euclid(32) as i16);
    let mut tiles = loaded.correction.tiles.iter();
    let tile = tiles.find(|tile| [tile.key.0, tile.key.1] == key);
    tile.map_or(0, |tile| {
        let bit = |plane: &[u32; 32]| plane[(y & 31) as usize] >> (x & 31) & 1;
        bit(&tile.classes[0]) | bit(&tile.classes[1]) << 1
    })
}

#[test]
fn a_cell_is_an_obstacle_if_a_pixel_is_and_free_if_all_are() {
    for (resolution_m, pixels) in [(0.1, 1), (0.05, 2), (0.02, 5)] {
        let mut plan = floor(resolution_m);
        for (cell, class) in [(3, Class::Wall), (5, Class::Unknown)] {
            let (i, j) = (cell * pixels, 4 * pixels);
            plan.set(GridCell { i, j }, class);
        }
        let loaded = load(plan, None).expect("a map");
        let row = [2, 3, 4, 5, 6].map(|x| class(&loaded, (x, 4)));
        assert_eq!(row, [1, 2, 1, 0, 1], "{resolution_m}");
        assert_eq!(class(&loaded, (-1, 4)), 0);
        assert!((loaded.known_m2 - 7.99).abs() < 1e-9, "{}", loaded.known_m2);
    }
}

#[test]
fn a_pixel_larger_than_a_cell_fills_all_of_its_cells() {
    let mut plan = floor(0.2);
    plan.set(GridCell { i: 2, j: 3 }, Class::Wall);
    let loaded = load(plan, None).expect("a map");
    let cells = [(3, 6), (4, 6), (5, 7), (6, 7)].map(|cell| class(&loaded, cell));
    assert_eq!(cells, [1, 2, 2, 1]);
}

/// The robot faces north at (1, 3) of the file, and east at (2, 1) of the map.
#[test]
fn a_pose_in_the_file_turns_and_shifts_it() {
    let mut plan = Occupancy::filled(40, 60, 0.1, [0.0, 0.0], Class::Free);
    plan.set(GridCell { i: 5, j: 40 }, Class::Wall);
    let loaded = load(plan, Some([1.0, 3.0, 90.0])).expect("a map");
    // 1.05 m ahead and 0.45 m to the left.
    assert_eq!(class(&loaded, (30, 14)), 2);
    let known: u32 = loaded
        .correction
        .tiles
        .iter()
        .flat_map(|tile| tile.classes[1])
        .map(u32::count_ones)
        .sum();
    assert_eq!(known, 1);
    // 3 m behind it is the file's end.
    assert_eq!(
        [class(&loaded, (-10, 10)), class(&loaded, (-11, 10))],
        [1, 0]
    );
    let turned = pose_of([0.0, 0.0, 90.0]).expect("a pose");
    assert!((turned.yaw_rad - FRAC_PI_2).abs() < 1e-12);
}

#[test]
fn the_tile_of_the_robot_comes_first() {
    let plan = Occupancy::filled(200, 200, 0.1, [-8.0, -8.0], Class::Free);
    let loaded = load(plan, None).expect("a map");
    let keys: Vec<_> = loaded.correction.tiles.iter().map(|it| it.key).collect();
    assert_eq!((keys[0], keys.len()), ((0, 0), 49));
    assert_eq!(loaded.correction.epoch, 1);
}

#[test]
fn a_robot_that_does_not_stand_in_the_map_is_refused_with_the_remedy() {
    let outside = load(floor(0.1), Some([9.0, 1.0, 0.0])).expect_err("outside");
    assert!(
        outside.starts_with("--known m.yaml: the robot's start (9.00, 1.00) lies outside"),
        "{outside}"
    );
    let mut plan = floor(0.1);
    plan.set(GridCell { i: 20, j: 10 }, Class::Wall);
    let inside = load(plan, None).expect_err("a wall");
    for error in [outside, inside] {
        assert!(error.contains("--known-pose X,Y,DEG"), "{error}");
    }
    // A wall beside the hull is none in it, and one a cell deep in it neither.
    let mut plan = floor(0.1);
    plan.set(GridCell { i: 20, j: 12 }, Class::Wall);
    assert!(load(plan, None).is_ok());
}

#[test]
fn a_map_that_no_device_holds_is_refused_with_its_size() {
    let plan = Occupancy::filled(800, 800, 0.1, [0.0, 0.0], Class::Free);
    let error = load(plan, None).expect_err("625 tiles");
    assert!(error.contains("takes 625 tiles of 3.2 m"), "{error}");
    assert!(error.contains("erase"), "{error}");
    let mut plan = Occupancy::filled(500, 2, 1.0, [0.0, 0.0], Class::Unknown);
    for i in [1, 2, 3, 499] {
        plan.set(GridCell { i, j: 1 }, Class::Free);
        plan.set(GridCell { i, j: 0 }, Class::Free);
    }
    let error = load(plan, None).expect_err("too far apart");
    assert!(error.contains("403 m apart"), "{error}");

    let map = KnownMap::new("m.yaml", floor(0.1), None);
    let loaded = load(floor(0.1), None).expect("a map");
    assert!(map.check_room(&loaded, 2).is_ok(), "4 m are two tiles");
    let error = map.check_room(&loaded, 1).expect_err("one page");
    assert!(error.to_string().contains("room for 1;"), "{error}");
}

#[test]
fn a_file_that_knows_nothing_or_is_none_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("map.yaml");
    let load = || {
        KnownMap::load(&path, None)
            .expect_err("refused")
            .to_string()
    };
    let missing = load();
    assert!(missing.starts_with("--known ") && missing.contains("cannot read this map"));
    std::fs::write(&path, "resolution: 0.05\norigin: [0, 0, 0]\n").expect("written");
    assert!(load().contains("image: missing"));
    std::fs::write(&path, "image: m.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n").expect("written");
    assert!(load().contains("m.pgm"));
    std::fs::write(folder.path().join("m.pgm"), b"P5\n2 1\n255\n\xcd\xcd").expect("written");
    let nothing = load();
    assert!(nothing.contains("every pixel is unknown"), "{nothing}");
    // The world's own starts do not count.
    std::fs::write(folder.path().join("m.pgm"), b"P5\n2 1\n255\n\xfe\x00").expect("written");
    let robots = "image: m.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nrobots: [[9, 9, 0]]\n";
    std::fs::write(&path, robots).expect("written");
    assert!(KnownMap::load(&path, None).is_ok());
    assert!(World::load(&path).is_err());
}

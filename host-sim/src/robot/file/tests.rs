use super::*;

const GOOD: &str = "\
hull: {length: 0.4, width: 0.3, height: 0.2}
drive: {track: 0.25, speed: 0.5, turn_rate: 90, acceleration: 0.4, turn_acceleration: 90}
lasers:
  - x: 0.1
    y: 0
    z: 0.2
    field: 270
    beams: 541
    range: 10
    mask: [[40, 50], [170, -170]]
odometry: {times: 4}
";

fn of(text: &str) -> Result<RobotSpec, RobotError> {
    read("my.yaml", "my", text)
}

#[test]
fn a_file_is_a_robot() {
    let robot = of(GOOD).expect("good");
    assert_eq!(robot.name, "my");
    assert_eq!(robot.hull, Footprint::rectangle(0.4, 0.3, 0.2));
    assert!((robot.radius_m - 0.20).abs() < 1e-6, "{}", robot.radius_m);
    assert_eq!(robot.drive.braking_mps2, 0.4);
    let wheels_mps = 0.5 + 0.125 * 90.0_f64.to_radians();
    assert!((robot.drive.side_mps - wheels_mps).abs() < 1e-12);
    let lidar = &robot.lidars[0];
    assert!((lidar.first_rad.to_degrees() + 135.0).abs() < 1e-9);
    assert!((lidar.step_rad.to_degrees() - 0.5).abs() < 1e-9);
    assert!(lidar.ignores_hull && lidar.mask.len() == 2);
    let usual = OdometryNoise::default();
    assert_eq!(robot.odometry.turn_by_turn, 4.0 * usual.turn_by_turn);
    assert_eq!(robot.odometry.turn_scale, usual.turn_scale);
}

#[test]
fn a_disc_is_round() {
    let disc = GOOD.replace("length: 0.4, width: 0.3", "radius: 0.2");
    assert_eq!(of(&disc).expect("good").hull, Footprint::disc(0.2, 0.2));
}

/// Each fault with its line and a word of its remedy.
#[test]
fn a_fault_names_file_line_and_remedy() {
    for (was, is, line, word) in [
        ("length: 0.4, ", "", 1, "give one of the two"),
        ("height: 0.2", "hight: 0.2", 1, "hight"),
        ("height: 0.2", "height: 3", 1, "give 0 to 2 m"),
        ("width: 0.3", "width: 1.4", 1, "at most 1.1"),
        ("track: 0.25, ", "", 2, "effective_track"),
        ("speed: 0.5", "speed: fast", 2, "floating point in `drive:"),
        (
            "speed: 0.5",
            "speed: 1.6",
            2,
            "acceleration is 0.4; give 0.53",
        ),
        ("speed: 0.5", "speed: .nan", 2, "nan"),
        (
            "turn_rate: 90",
            "turn_rate: 90, turns_on_the_spot: false",
            2,
            "turns on the spot",
        ),
        ("z: 0.2\n", "z: 0\n", 6, "give 0.01"),
        ("    field: 270\n", "", 4, "`field`"),
        ("field: 270", "step: 1", 4, "needs `first`"),
        ("beams: 541", "beams: 3", 8, "4 to 4096"),
        ("beams: 541", "beams: 5.5", 8, "a whole number"),
        ("range: 10", "range: 10\n    pitch: 20", 10, "pitch is 20"),
        (
            "range: 10",
            "range: 10\n    least_range: 11",
            10,
            "give 0 to 10 m",
        ),
        (
            "range: 10",
            "range: 10\n    turn_time: 100",
            10,
            "turn_time is 100; give 0 to 0.5 s",
        ),
        ("[40, 50]", "[40, 900]", 10, "as in [170, -170]"),
        ("[40, 50]", "[-180, 179.9]", 4, "covers every beam"),
        ("times: 4", "times: -1", 11, "give 0 to 1000"),
        ("times: 4", "time: 4", 11, "time"),
    ] {
        assert!(GOOD.contains(was), "{was}");
        let error = of(&GOOD.replacen(was, is, 1)).expect_err(is).to_string();
        let place = format!("my.yaml:{line}: ");
        let says = error.to_lowercase().contains(&word.to_lowercase());
        assert!(error.starts_with(&place) && says, "{is}: {error}");
    }
}

#[test]
fn a_lidar_may_take_a_turn() {
    let still = &of(GOOD).expect("good").lidars[0];
    assert_eq!((still.turn_time_s, still.newest_first), (0.0, false));
    let turning = "range: 10\n    turn_time: 0.1\n    newest_first: true";
    let text = GOOD.replace("range: 10", turning);
    let lidar = &of(&text).expect("good").lidars[0];
    assert_eq!((lidar.turn_time_s, lidar.newest_first), (0.1, true));
    let place = "  - {x: 0, y: 0, z: 0.3, pitch: 20, field: 180, beams: 181, range: 8";
    let down = format!("{place}, turn_time: 0.1}}\nodometry");
    let error = of(&GOOD.replace("odometry", &down)).expect_err("it looks down");
    assert!(error.to_string().contains("level lasers only"), "{error}");
}

#[test]
fn broken_yaml_and_missing_keys_have_a_line_too() {
    for text in ["", "hull: [", "a: b", "- 1", "hull: {height: 1}\n"] {
        let error = of(text).expect_err(text).to_string();
        assert!(error.starts_with("my.yaml:"), "{text}: {error}");
        assert!(error.contains("docs/ROBOT.md"), "{text}: {error}");
    }
}

#[test]
fn a_missing_file_lists_the_presets() {
    let error = RobotSpec::open("no/robot.yaml")
        .expect_err("missing")
        .to_string();
    assert!(
        error.contains("no/robot.yaml") && error.contains("turtlebot3-burger"),
        "{error}"
    );
}

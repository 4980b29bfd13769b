//! Scenes: a robot that drives through boxes, with odometry that errs.
//!
//! The truth, the rays and the odometry are f64. The scan is exact to a millimetre.

mod lost;
mod slips;
mod twin;

use std::boxed::Box;
use std::vec::Vec;

use super::{Localiser, Quality};
use crate::config::{Config, UnevenGround};
use crate::geometry::{Cell, MapPose, Pose, Twist};
use crate::input::{INVALID_MM, Input, NO_RETURN_MM};
use crate::map::Map;
use crate::robot::LaserMount;

/// A solid rectangle: least and greatest x, least and greatest y, metres.
type Solid = [f64; 4];
/// x, y and yaw.
type State = [f64; 3];

/// Returns the walls of a room, 0.2 m thick, outside of its inner rectangle.
fn room([x0, x1, y0, y1]: Solid) -> Vec<Solid> {
    std::vec![
        [x0 - 0.2, x1 + 0.2, y0 - 0.2, y0],
        [x0 - 0.2, x1 + 0.2, y1, y1 + 0.2],
        [x0 - 0.2, x0, y0, y1],
        [x1, x1 + 0.2, y0, y1],
    ]
}

/// Returns a room with two boxes, whose views differ everywhere.
fn furnished() -> Vec<Solid> {
    let mut solids = room([-2.03, 6.04, -2.52, 3.01]);
    solids.extend([[3.1, 4.2, 1.2, 1.9], [0.9, 1.4, -2.5, -1.6]]);
    solids
}

/// Returns the distance to the first solid along a ray.
fn cast(solids: &[Solid], [x, y]: [f64; 2], bearing: f64) -> f64 {
    let (sin, cos) = bearing.sin_cos();
    let enter = |solid: &Solid| {
        let slab = |from: f64, along: f64, low: f64, high: f64| {
            let (a, b) = ((low - from) / along, (high - from) / along);
            (a.min(b), a.max(b))
        };
        let (x_in, x_out) = slab(x, cos, solid[0], solid[1]);
        let (y_in, y_out) = slab(y, sin, solid[2], solid[3]);
        let (near, far) = (x_in.max(y_in), x_out.min(y_out));
        (near < far && near > 0.0).then_some(near)
    };
    solids.iter().filter_map(enter).fold(f64::MAX, f64::min)
}

/// Returns the pose after a distance and a turn.
fn moved([x, y, yaw]: State, forward: f64, turn: f64) -> State {
    let middle = yaw + 0.5 * turn;
    let (sin, cos) = middle.sin_cos();
    [x + forward * cos, y + forward * sin, yaw + turn]
}

fn pose([x, y, yaw]: State) -> Pose {
    Pose {
        x_m: x as f32,
        y_m: y as f32,
        yaw_rad: crate::math::wrap(yaw as f32),
        ..Pose::default()
    }
}

/// A robot in a scene.
struct Scene {
    config: Config,
    solids: Vec<Solid>,
    truth: State,
    odom: State,
    localiser: Localiser,
    map: Box<Map<64, 400>>,
    /// Steps of the figure.
    driven: u32,
    /// Changes a scan.
    spoil: fn(usize, u16) -> u16,
}

impl Scene {
    fn new(solids: Vec<Solid>) -> Self {
        let laser = LaserMount::level(0.0, 0.4);
        let config = Config {
            localise: true,
            ..Config::pioneer_3at([laser].into_iter().collect())
        };
        let mut map = Box::<Map<64, 400>>::default();
        map.begin(&config);
        Self {
            config,
            solids,
            truth: [0.0; 3],
            odom: [0.0; 3],
            localiser: Localiser::new(),
            map,
            driven: 0,
            spoil: |_, range| range,
        }
    }

    fn scan(&self) -> [u16; 181] {
        core::array::from_fn(|k| {
            let [x, y, yaw] = self.truth;
            let bearing = yaw + (k as f64 - 90.0).to_radians();
            let range_mm = (1000.0 * cast(&self.solids, [x, y], bearing)).min(1e6) as u32;
            let range = if range_mm < 12_000 {
                range_mm as u16
            } else {
                NO_RETURN_MM
            };
            (self.spoil)(k, range)
        })
    }

    /// Moves the robot and its odometry, each by a distance and a turn, and takes a step.
    fn step(&mut self, truly: (f64, f64), says: (f64, f64)) {
        self.truth = moved(self.truth, truly.0, truly.1);
        self.odom = moved(self.odom, says.0, says.1);
        let scan = self.scan();
        let input = Input {
            time_ms: 0,
            pose: pose(self.odom),
            velocity: Twist::default(),
            scans: [&scan, &[]],
        };
        let MapPose(pose) = self.localiser.locate(&self.config, &self.map, &input);
        if self.localiser.may_enter() {
            self.map.observe(&self.config, &Input { pose, ..input });
        }
    }

    /// Drives a figure of eight for this number of steps. Odometry is 2 % long and 4 % over.
    fn drive(&mut self, steps: u32) {
        for _ in 0..steps {
            let turn = if self.driven % 158 < 79 { 0.08 } else { -0.08 };
            self.driven += 1;
            self.step((0.06, turn), (0.0612, 1.04 * turn));
        }
    }

    /// Stands for this number of steps.
    fn stand(&mut self, steps: u32) {
        for _ in 0..steps {
            self.step((0.0, 0.0), (0.0, 0.0));
        }
    }

    /// Returns the errors of position and yaw.
    fn errors(&self) -> (f64, f64) {
        let MapPose(pose) = self.localiser.location().pose;
        let [x, y, yaw] = self.truth;
        let off = (f64::from(pose.x_m) - x).hypot(f64::from(pose.y_m) - y);
        (
            off,
            f64::from(crate::math::wrap(pose.yaw_rad - yaw as f32)).abs(),
        )
    }

    fn quality(&self) -> Quality {
        self.localiser.location().quality
    }

    fn assert_found(&self) {
        let (off_m, turned) = self.errors();
        assert!(off_m < 0.10 && turned < 0.03, "{off_m} m, {turned} rad");
        assert_eq!(self.quality(), Quality::Tracking);
    }
}

#[test]
fn in_a_room_the_drift_of_odometry_is_corrected() {
    let mut scene = Scene::new(furnished());
    scene.drive(400);
    let drift = (scene.odom[0] - scene.truth[0]).hypot(scene.odom[1] - scene.truth[1]);
    assert!(drift > 0.15, "odometry alone: {drift}");
    scene.assert_found();
}

#[test]
fn without_localisation_the_pose_is_odometrys_bit_for_bit() {
    let mut scene = Scene::new(furnished());
    scene.config.localise = false;
    for _ in 0..20 {
        scene.step((0.1, 0.05), (0.1, 0.06));
        assert_eq!(scene.localiser.location().pose.0, pose(scene.odom));
        assert!(scene.localiser.may_enter());
    }
}

#[test]
fn along_a_bare_corridor_odometry_keeps_its_value() {
    let mut scene = Scene::new(std::vec![
        [-40.0, 80.0, -1.4, -1.0],
        [-40.0, 80.0, 1.0, 1.4]
    ]);
    // Odometry turns a little to the left of the truth.
    for _ in 0..200 {
        scene.step((0.1, 0.0), (0.1, 0.0004));
    }
    let Quality::Degenerate(Some(direction)) = scene.quality() else {
        panic!("{:?}", scene.quality())
    };
    assert!(direction.sin().abs() < 0.05, "along x: {direction}");
    let MapPose(found) = scene.localiser.location().pose;
    assert!(
        f64::from(found.y_m - 0.0).abs() < 0.06,
        "across: {}",
        found.y_m
    );
    assert!((found.x_m - 20.0).abs() < 0.1, "along: {}", found.x_m);
    assert!(found.yaw_rad.abs() < 0.01, "{}", found.yaw_rad);
    let [xx, _, yy, ..] = scene.localiser.location().covariance;
    assert!(xx > 10.0 * yy, "the covariance says so: {xx} {yy}");
}

#[test]
fn in_a_hall_beyond_the_range_odometry_holds_the_pose() {
    let mut scene = Scene::new(room([-60.0, 60.0, -60.0, 60.0]));
    for _ in 0..50 {
        scene.step((0.1, 0.02), (0.1, 0.02));
    }
    assert_eq!(scene.quality(), Quality::Degenerate(None));
    let (off_m, turned) = scene.errors();
    assert!(off_m < 1e-3 && turned < 1e-4, "{off_m} {turned}");
}

#[test]
fn after_a_slip_the_robot_is_lost_and_enters_nothing_until_it_is_found() {
    let mut scene = Scene::new(furnished());
    scene.drive(200);
    let edits = scene.map.tiles().edits();
    // The robot is shoved half a metre and 20° within a step; the wheels saw nothing of it.
    scene.step((0.5, 0.35), (0.0, 0.0));
    let mut was_lost = false;
    for _ in 0..25 {
        scene.stand(1);
        if scene.quality() == Quality::Lost {
            was_lost = true;
            assert_eq!(scene.map.tiles().edits(), edits, "nothing is entered");
        }
    }
    assert!(was_lost, "it says so");
    scene.assert_found();
}

#[test]
fn a_robot_carried_to_a_place_unlike_any_other_stays_lost() {
    let mut scene = Scene::new(furnished());
    scene.drive(200);
    let edits = scene.map.tiles().edits();
    let thing = |k: u32| {
        let bearing = f64::from(k) * 0.35;
        let range = 0.8 + 0.9 * f64::from(k * 7 % 5);
        let (x, y) = (range * bearing.cos(), range * bearing.sin());
        [x - 0.15, x + 0.15, y - 0.1, y + 0.1]
    };
    scene.solids = (0..18).map(thing).collect();
    scene.truth = [0.0; 3];
    scene.stand(500);
    assert_eq!(scene.quality(), Quality::Lost);
    assert!(scene.localiser.has_given_up());
    assert_eq!(scene.map.tiles().edits(), edits);
}

#[test]
fn wheels_that_spin_for_a_metre_do_not_move_the_robot() {
    let mut scene = Scene::new(furnished());
    scene.drive(200);
    for _ in 0..10 {
        scene.step((0.0, 0.0), (0.1, 0.0));
    }
    scene.stand(25);
    scene.assert_found();
}

#[test]
fn a_robot_that_slides_half_a_metre_while_its_wheels_stand_is_followed() {
    let mut scene = Scene::new(furnished());
    scene.drive(200);
    for _ in 0..10 {
        scene.step((0.05, 0.0), (0.0, 0.0));
    }
    scene.stand(25);
    scene.assert_found();
}

#[test]
fn a_third_of_the_beams_may_be_missing() {
    let mut scene = Scene::new(furnished());
    scene.spoil = |k, range| if k * 7 % 10 < 3 { INVALID_MM } else { range };
    scene.drive(400);
    scene.assert_found();
}

#[test]
fn two_seconds_without_a_scan_are_bridged() {
    let mut scene = Scene::new(furnished());
    scene.drive(200);
    scene.spoil = |_, _| INVALID_MM;
    for _ in 0..10 {
        scene.drive(1);
        assert_eq!(scene.quality(), Quality::Degenerate(None));
    }
    scene.spoil = |_, range| range;
    scene.drive(10);
    scene.assert_found();
}

/// On a slope a wrong height would put the ground that is measured next beside what is known.
#[test]
fn the_robot_stands_on_the_ground_that_the_map_has_under_it() {
    let config = Config {
        localise: true,
        ground: Some(UnevenGround::TABLE_I),
        ..Config::pioneer_3at(heapless::Vec::new())
    };
    let slope = 0.25_f32;
    let mut map = Box::<Map<152, 400>>::default();
    map.begin(&config);
    // Twice: a height that was measured once may be a false return.
    for _ in 0..2 {
        map.set_ground_heights(Cell { x: 0, y: 0 }, |cell| Some(slope * cell.centre().x_m));
    }
    let mut localiser = Localiser::new();
    let mut locate = |x_m: f32, error_m: f32| {
        let pose = Pose {
            x_m,
            z_m: slope * x_m + error_m,
            pitch_rad: -slope.atan(),
            ..Pose::default()
        };
        let input = Input {
            time_ms: 0,
            pose,
            velocity: Twist::default(),
            scans: [&[], &[]],
        };
        let MapPose(found) = localiser.locate(&config, &map, &input);
        found.z_m - slope * x_m
    };
    assert!(locate(0.0, 0.0).abs() < 0.01);
    assert!(locate(0.4, 0.12).abs() < 0.01, "odometry is too high");
    assert!(locate(0.8, -0.08).abs() < 0.01, "and too low");
    assert!(
        (locate(20.0, -0.08) - 0.0).abs() < 0.01,
        "it stays so on new ground"
    );
}

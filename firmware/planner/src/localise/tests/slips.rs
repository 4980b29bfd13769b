//! Robots whose wheels turn in vain, or that move without them, at full speed and while they turn.

use super::{Scene, State, furnished, pose};
use crate::localise::alignment::Frame;
use crate::localise::occupancy::occupancy;
use crate::localise::scan_points::{ScanPoint, ScanPoints, scan_points};
use crate::localise::{in_cells, slip::likelier};
use crate::map::neighbourhood::Neighbourhood;
use crate::robot::LaserMount;

/// Distance and turn of a step.
type Step = (f64, f64);

const STANDS: Step = (0.0, 0.0);

/// A robot that has seen its room, drives at a speed, and slips for 3 s.
fn slipped(before: Step, truly: Step, says: Step) -> Scene {
    let mut scene = Scene::new(furnished());
    scene.drive(200);
    for _ in 0..3 {
        scene.step(before, before);
    }
    for _ in 0..15 {
        scene.step(truly, says);
    }
    scene
}

#[test]
fn wheels_that_spin_at_full_speed_do_not_move_the_robot() {
    for wheels in [(0.14, 0.0), (-0.14, 0.0), (0.02, 0.2), (0.1, -0.25)] {
        slipped(STANDS, STANDS, wheels).assert_found();
    }
}

#[test]
fn a_robot_that_goes_on_while_its_wheels_stand_is_followed() {
    for speed in [(0.0, 0.2), (0.0, -0.25), (0.06, 0.12)] {
        slipped(speed, speed, STANDS).assert_found();
    }
}

#[test]
fn without_a_slip_the_prediction_is_odometrys() {
    let mut scene = Scene::new(furnished());
    scene.drive(100);
    for _ in 0..100 {
        let before = scene.truth;
        scene.drive(1);
        assert_eq!(scene.chosen(scene.truth, [before, before]), None);
    }
}

/// Recorded logs often have a scan each metre. The robot weaves between boxes that hide each other.
#[test]
fn steps_that_leave_scans_out_are_no_slips() {
    let mut solids = std::vec![[-8.0, 60.0, -1.9, -1.5], [-8.0, 60.0, 1.5, 1.9]];
    solids.extend((0..40).map(|k| {
        let x = 1.7 * f64::from(k) - 4.0 + 0.3 * f64::from(k * 7 % 5);
        let deep = 0.6 * (0.4 + 0.15 * f64::from(k * 3 % 5));
        let sides = [[1.5 - deep, 1.5], [-1.5, deep - 1.5]];
        let [low, high] = sides[usize::from(k % 2 == 1)];
        [x, x + 0.7, low, high]
    }));
    for step_m in [0.5, 0.75] {
        let mut scene = Scene::new(solids.clone());
        for k in 0..30 {
            let turn = if k % 2 == 0 { 0.3 } else { -0.3 };
            scene.step((step_m, turn), (step_m, turn));
        }
        let (off_m, turned) = scene.errors();
        assert!(off_m < 0.3 && turned < 0.03, "{off_m} m, {turned} rad");
    }
}

/// The gain of each other prediction, beam by beam, and which is chosen.
#[test]
fn the_chosen_prediction_is_that_of_a_naive_twin() {
    let mut scene = Scene::new(furnished());
    scene.drive(150);
    let [x, y, yaw] = scene.truth;
    let mut chosen = [0; 3];
    for k in 0..80_u8 {
        let (off, turned) = (
            f64::from(k % 8) * 0.05 - 0.2,
            f64::from(k / 8) * 0.03 - 0.15,
        );
        let odometry = [x + off, y - 0.5 * off, yaw + turned];
        let others = [
            [x, y + off, yaw - 0.5 * turned],
            [x - 0.5 * off, y, yaw + off],
        ];
        let found = scene.chosen(odometry, others);
        assert_eq!(found, scene.naively(odometry, others), "{k}");
        chosen[found.unwrap_or(2)] += 1;
    }
    assert!(chosen.iter().all(|count| *count > 3), "{chosen:?}");
}

impl Scene {
    fn points(&self) -> ScanPoints {
        let laser = LaserMount::level(0.0, 0.4);
        let mut points = ScanPoints::new();
        scan_points(
            &self.config,
            &pose(self.truth),
            (&laser, &self.scan()),
            &mut points,
        );
        points
    }

    fn chosen(&self, odometry: State, others: [State; 2]) -> Option<usize> {
        let tuning = &self.config.tuning.localise;
        let others = others.map(|it| in_cells(&pose(it)));
        let odometry = in_cells(&pose(odometry));
        likelier(self.map.tiles(), &self.points(), odometry, others, tuning)
    }

    fn naively(&self, odometry: State, others: [State; 2]) -> Option<usize> {
        let tuning = &self.config.tuning.localise;
        let tiles = self.map.tiles();
        let frames = [odometry, others[0], others[1]].map(|it| Frame::of(in_cells(&pose(it))));
        let residual = |end| {
            occupancy(&mut Neighbourhood::of(tiles), end)
                .map_or(1.0, |it| f64::from(1.0 - it.value))
        };
        let cost = |r: f64| {
            let (c, information) = (tuning.robust_cells, tuning.beam_information);
            f64::from(information) * r * r / (1.0 + r * r / f64::from(c * c))
        };
        let gain = |k: usize, point: &ScanPoint| {
            let [from, to] = [&frames[0], &frames[k]].map(|frame| frame.reach(point).1);
            let (dx, dy) = (f64::from(to.0 - from.0), f64::from(to.1 - from.1));
            let apart = point.normal.map_or(dx.hypot(dy), |normal| {
                let (nx, ny) = frames[0].turn(normal);
                (f64::from(nx) * dx + f64::from(ny) * dy).abs()
            });
            if apart < 0.5 {
                0.0
            } else {
                cost(residual(from)) - cost(residual(to))
            }
        };
        let points = self.points();
        let gains = [1, 2].map(|k| points.iter().map(|point| gain(k, point)).sum::<f64>());
        let best = if gains[1] > gains[0] { 1 } else { 0 };
        (gains[best] > f64::from(tuning.slip_price)).then_some(best)
    }
}

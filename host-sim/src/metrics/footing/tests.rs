//! Reached and covered cells of small synthetic grounds.

use super::*;
use crate::world::{Class, Elevation, GridCell, Occupancy};

impl Footing {
    /// Returns true if the robot reaches a cell in a heading, counted counter-clockwise from east.
    pub(crate) fn reaches_heading(&self, cell: Cell, heading: usize) -> bool {
        let index = self.area.index(cell);
        index.is_some_and(|index| self.reached[index] >> (heading % HEADINGS) & 1 == 1)
    }
}

/// Ground of 10 × 6 m, sampled every 5 cm, with a start at (1, 3) that faces east.
fn world(height_m: impl Fn(f64, f64) -> f64) -> (World, Start) {
    let size = [200, 120];
    let elevation = Elevation::from_fn(size, 0.05, [0.0, 0.0], height_m);
    let start = Start {
        x_m: 1.0,
        y_m: 3.0,
        yaw_rad: 0.0,
    };
    let floor = Occupancy::filled(size[0], size[1], 0.05, [0.0, 0.0], Class::Free);
    (World::uneven("test", floor, elevation, vec![start]), start)
}

fn footing(height_m: impl Fn(f64, f64) -> f64, limits: &Limits) -> Footing {
    let (world, start) = world(height_m);
    Footing::new(&world, start, 0.3, limits)
}

fn cell(x_m: f64, y_m: f64) -> Cell {
    let of = |m: f64| (m / MAP_CELL_M).floor() as i32;
    Cell {
        x: of(x_m),
        y: of(y_m),
    }
}

/// A plane that rises eastwards from x = 3 to x = 7 m, level on both sides, rounded over 0.5 m.
fn ramp(degrees: f64) -> impl Fn(f64, f64) -> f64 {
    let grade = degrees.to_radians().tan();
    let soft = |t: f64| {
        if t < 0.0 {
            0.0
        } else if t < 0.5 {
            t * t
        } else {
            t - 0.25
        }
    };
    move |x: f64, _| grade * (soft(x - 3.0) - soft(x - 6.5))
}

#[test]
fn level_ground_is_reached_up_to_the_radius_and_covered() {
    let footing = footing(|_, _| 0.4, &Limits::WORKING);
    // Centres from 0.35 to 9.65 m and from 0.35 to 5.65 m.
    let reached = (0..footing.area().len())
        .filter(|index| footing.reaches(footing.area().cell(*index)))
        .count();
    assert_eq!(reached, 94 * 54);
    assert!(footing.covers(cell(0.15, 3.0)) && footing.covers(cell(5.0, 0.05)));
    assert!((0..HEADINGS).all(|k| footing.reaches_heading(cell(5.0, 3.0), k)));
}

#[test]
fn a_slope_too_steep_to_cross_is_climbed_head_on() {
    let gentle = footing(ramp(12.0), &Limits::WORKING);
    assert!((0..HEADINGS).all(|k| gentle.reaches_heading(cell(5.0, 3.0), k)));
    let steep = footing(ramp(18.0), &Limits::WORKING);
    assert!(steep.reaches(cell(9.0, 3.0)), "the top");
    let headings: Vec<usize> = (0..HEADINGS)
        .filter(|k| steep.reaches_heading(cell(5.0, 3.0), *k))
        .collect();
    // A slope of 18° crossed at an angle φ rolls by atan(tan 18° sin φ): 12.9° at 45°, 16.7° at
    // 67.5°.
    assert_eq!(headings, [0, 1, 2, 6, 7, 8, 9, 10, 14, 15]);
    let closed = footing(ramp(23.0), &Limits::WORKING);
    assert!(!closed.reaches(cell(5.0, 3.0)) && !closed.reaches(cell(9.0, 3.0)));
    let wider = Limits::WORKING.changed("climb=25").expect("limits");
    assert!(footing(ramp(23.0), &wider).reaches(cell(9.0, 3.0)));
}

#[test]
fn an_edge_is_crossed_where_it_is_low_enough() {
    let kerb = |height_m: f64| move |x: f64, _| if x > 5.0 { height_m } else { 0.0 };
    for (height_m, passes) in [(0.05, true), (0.10, false), (-0.05, true), (-0.3, false)] {
        let footing = footing(kerb(height_m), &Limits::WORKING);
        assert_eq!(footing.reaches(cell(8.0, 3.0)), passes, "{height_m}");
        assert_eq!(footing.covers(cell(8.0, 3.0)), passes, "{height_m}");
        assert!(footing.covers(cell(4.6, 3.0)), "{height_m}");
    }
}

#[test]
fn wheels_stay_a_radius_off_a_hole_and_its_rim_is_not_gentle() {
    let hole = |x: f64, y: f64| {
        if (x - 5.0).abs() < 1.0 && (y - 3.0).abs() < 1.0 {
            f64::NAN
        } else {
            0.0
        }
    };
    let footing = footing(hole, &Limits::WORKING);
    // The front axle is 0.134 m ahead of the centre; surface ends within a sample of 4.0.
    assert!(!footing.reaches_heading(cell(3.85, 3.0), 0));
    assert!(footing.reaches_heading(cell(3.65, 3.0), 0));
    assert!(footing.reaches(cell(8.0, 3.0)) && !footing.covers(cell(5.0, 3.0)));
    let (world, _) = world(hole);
    assert!(!is_gentle(&world, cell(3.95, 3.0), &Limits::WORKING));
    assert!(is_gentle(&world, cell(3.75, 3.0), &Limits::WORKING));
}

#[test]
fn walls_keep_their_distance_as_on_flat_ground() {
    let (world, start) = world(|_, _| 0.0);
    let mut grid = world.occupancy().clone();
    // A wall with a gap of 0.7 m in its middle.
    for j in (0..120).filter(|j| !(53..67).contains(j)) {
        grid.set(GridCell { i: 100, j }, Class::Wall);
    }
    let elevation = world.elevation().expect("uneven").clone();
    let world = World::uneven("wall", grid, elevation, vec![start]);
    assert!(Footing::new(&world, start, 0.3, &Limits::WORKING).reaches(cell(8.0, 3.0)));
    assert!(!Footing::new(&world, start, 0.4, &Limits::WORKING).reaches(cell(8.0, 3.0)));
}

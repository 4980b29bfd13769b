//! Heights, marks and glimpses of single cells, and what leaves the window.

use std::boxed::Box;

use crate::geometry::Cell;
use crate::ground::elevation::{Elevation, Heights, WINDOW_CELLS};

struct Bench {
    heights: Box<[u8]>,
    marks: Box<[u8]>,
    origin: Cell,
}

impl Bench {
    fn new() -> Self {
        Self {
            heights: std::vec![0; 2 * WINDOW_CELLS].into(),
            marks: std::vec![0; WINDOW_CELLS].into(),
            origin: Cell::default(),
        }
    }

    fn window(&mut self) -> Elevation<'_> {
        Elevation::new(&mut self.heights, &mut self.marks, &mut self.origin)
    }

    fn read(&self) -> Heights<'_> {
        Heights::new(&self.heights, &self.marks, self.origin)
    }
}

const CELL: Cell = Cell { x: -3, y: 7 };

fn around_zero() -> Bench {
    let mut bench = Bench::new();
    bench.window().follow(Cell::default());
    bench
}

#[test]
fn a_mean_is_the_mean() {
    let mut bench = around_zero();
    let (mut sum, mut count) = (0.0, 0.0);
    for z_m in [-1.30_f32, -1.26, -1.31, -1.25, -1.28, -1.24, -1.33] {
        bench.window().measure(CELL, z_m);
        (sum, count) = (sum + f64::from(z_m), count + 1.0);
        let mean = f64::from(bench.read().height_m(CELL).expect("measured"));
        // Every mean before may have been rounded by half a step of 2 mm.
        assert!((mean - sum / count).abs() < 0.002, "{mean}");
    }
    assert_eq!(bench.read().count(CELL), 7);
    assert_eq!(bench.read().height_m(Cell { x: 7, y: -3 }), None);
}

#[test]
fn one_false_height_changes_nothing_and_many_are_believed() {
    let mut bench = around_zero();
    for _ in 0..4 {
        bench.window().measure(CELL, 0.5);
    }
    bench.window().measure(CELL, 0.9);
    assert_eq!(bench.read().height_m(CELL), Some(0.5));
    // Of two that differ the lower one stays: a beam may meet something above the ground, but nothing below it.
    let other = Cell { x: 0, y: 0 };
    bench.window().measure(other, 0.9);
    bench.window().measure(other, 0.5);
    assert_eq!(bench.read().height_m(other), Some(0.5));
}

#[test]
fn what_leaves_the_window_is_forgotten_and_the_rest_stays() {
    let mut bench = around_zero();
    for k in -31..31 {
        bench.window().measure(Cell { x: k, y: k }, 0.01 * k as f32);
    }
    for (dx, dy) in [(3, 0), (-5, 9), (0, -20), (-2, 2)] {
        let at = bench.origin;
        let before: std::vec::Vec<_> = (-31..31)
            .map(|k| bench.read().height_m(Cell { x: k, y: k }))
            .collect();
        let centre = Cell {
            x: at.x + 32 + dx,
            y: at.y + 32 + dy,
        };
        bench.window().follow(centre);
        for (k, before) in (-31..31).zip(before) {
            let inside = (k - centre.x + 32) as u32 <= 63 && (k - centre.y + 32) as u32 <= 63;
            let expected = before.filter(|_| inside);
            assert_eq!(bench.read().height_m(Cell { x: k, y: k }), expected, "{k}");
        }
    }
    bench.window().follow(Cell { x: 500, y: -9 });
    assert!((-31..31).all(|k| bench.read().count(Cell { x: k, y: k }) == 0));
}

#[test]
fn a_suspicion_ends_with_a_height_and_with_the_window() {
    let mut bench = around_zero();
    bench.window().mark_possible_drop(CELL);
    assert!(bench.read().is_possible_drop(CELL) && !bench.read().is_drop(CELL));
    assert_eq!(bench.read().height_m(CELL), None);
    bench.window().measure(CELL, 0.25);
    bench.window().mark_possible_drop(CELL);
    assert!(!bench.read().is_possible_drop(CELL));
    assert_eq!(bench.read().height_m(CELL), Some(0.25));
    let other = Cell { x: -30, y: 2 };
    bench.window().mark_possible_drop(other);
    bench.window().follow(Cell { x: 9, y: 0 });
    bench.window().follow(Cell { x: 0, y: 0 });
    assert!(!bench.read().is_possible_drop(other));
    bench.window().mark_possible_drop(other);
    bench.window().mark_drop(other);
    assert!(!bench.read().is_possible_drop(other), "it is sure now");
}

#[test]
fn a_glimpse_denies_that_ground_is_gone_and_is_no_height() {
    let mut bench = around_zero();
    bench.window().mark_drop(CELL);
    bench.window().measure_low_confidence(CELL, -0.5);
    bench.window().measure_low_confidence(CELL, -0.4);
    bench.window().mark_drop(CELL);
    bench.window().mark_possible_drop(CELL);
    assert!(!bench.read().is_drop(CELL) && !bench.read().is_possible_drop(CELL));
    let low_confidence_m = bench.read().low_confidence_m(CELL).expect("glimpsed");
    assert!(
        (low_confidence_m + 0.45).abs() < 0.002,
        "{low_confidence_m}"
    );
    assert_eq!(bench.read().height_m(CELL), None);
    assert_eq!(bench.read().count(CELL), 0);
    // The first measured height counts alone, and later glimpses not at all.
    bench.window().measure(CELL, 0.25);
    bench.window().measure_low_confidence(CELL, 0.5);
    assert_eq!(bench.read().height_m(CELL), Some(0.25));
    assert_eq!(bench.read().count(CELL), 1);
    assert_eq!(bench.read().low_confidence_m(CELL), None);
}

#[test]
fn what_stands_or_is_stood_on_was_not_glimpsed() {
    let mut bench = around_zero();
    bench.window().measure_low_confidence(CELL, 0.0);
    bench.window().mark_obstacle(CELL);
    bench.window().mark_obstacle(CELL);
    assert!(bench.read().is_obstacle(CELL));
    assert_eq!(bench.read().height_m(CELL), None);
    bench.window().measure_low_confidence(CELL, 0.0);
    bench.window().mark_wheel_contact(CELL, 0.125);
    assert_eq!(bench.read().height_m(CELL), Some(0.125));
    assert!(!bench.read().is_obstacle(CELL));
}

#[test]
fn marks_come_and_go() {
    let mut bench = around_zero();
    bench.window().mark_drop(CELL);
    assert!(bench.read().is_drop(CELL));
    // Measured ground is not gone, and cannot be said to be.
    bench.window().measure(CELL, 0.0);
    bench.window().mark_drop(CELL);
    assert!(!bench.read().is_drop(CELL));
    bench.window().mark_obstacle(CELL);
    assert!(
        !bench.read().is_obstacle(CELL),
        "once may be a false return"
    );
    bench.window().mark_obstacle(CELL);
    assert!(bench.read().is_obstacle(CELL));
    for _ in 0..2 {
        bench.window().measure(CELL, 0.0);
    }
    assert!(!bench.read().is_obstacle(CELL));
}

//! Tests of single cells (heights, marks, low confidence), and of cells that leave the window.

use std::boxed::Box;

use crate::config::GroundTuning;
use crate::geometry::Cell;
use crate::ground::elevation::{Elevation, Heights, WINDOW_CELLS};

const TUNING: GroundTuning = GroundTuning::DEFAULT;

/// An elevation window with its memory.
pub(crate) struct OwnedWindow {
    heights: Box<[u8]>,
    marks: Box<[u8]>,
    origin: Cell,
}

impl OwnedWindow {
    /// An empty window with `centre` in its middle.
    pub(crate) fn new(centre: Cell) -> Self {
        let mut owned = Self {
            heights: std::vec![0; 2 * WINDOW_CELLS].into(),
            marks: std::vec![0; WINDOW_CELLS].into(),
            origin: Cell::default(),
        };
        owned.write().follow(centre);
        owned
    }

    /// The window, for writing.
    pub(crate) fn write(&mut self) -> Elevation<'_> {
        Elevation::new(
            &mut self.heights,
            &mut self.marks,
            &mut self.origin,
            &TUNING,
        )
    }

    /// The window, for reading.
    pub(crate) fn read(&self) -> Heights<'_> {
        Heights::new(&self.heights, &self.marks, self.origin)
    }
}

const CELL: Cell = Cell { x: -3, y: 7 };

/// A window around cell (0, 0).
fn around_zero() -> OwnedWindow {
    OwnedWindow::new(Cell::default())
}

#[test]
fn the_stored_mean_is_the_mean_of_the_heights() {
    let mut owned = around_zero();
    let (mut sum, mut count) = (0.0, 0.0);
    for z_m in [-1.30_f32, -1.26, -1.31, -1.25, -1.28, -1.24, -1.33] {
        owned.write().measure(CELL, z_m);
        (sum, count) = (sum + f64::from(z_m), count + 1.0);
        let mean = f64::from(owned.read().height_m(CELL).expect("measured"));
        // Each earlier mean may be rounded by half a step of 2 mm.
        assert!((mean - sum / count).abs() < 0.002, "{mean}");
    }
    assert_eq!(owned.read().count(CELL), 7);
    assert_eq!(owned.read().height_m(Cell { x: 7, y: -3 }), None);
}

#[test]
fn one_outlier_does_not_move_the_mean() {
    let mut owned = around_zero();
    for _ in 0..4 {
        owned.write().measure(CELL, 0.5);
    }
    owned.write().measure(CELL, 0.9);
    assert_eq!(owned.read().height_m(CELL), Some(0.5));
    // Of two first heights the lower one stays: a beam may hit something above the ground, and
    // nothing below it.
    let other = Cell { x: 0, y: 0 };
    owned.write().measure(other, 0.9);
    owned.write().measure(other, 0.5);
    assert_eq!(owned.read().height_m(other), Some(0.5));
}

#[test]
fn cells_that_leave_the_window_are_cleared_and_the_others_stay() {
    let mut owned = around_zero();
    for k in -31..31 {
        owned.write().measure(Cell { x: k, y: k }, 0.01 * k as f32);
    }
    for (dx, dy) in [(3, 0), (-5, 9), (0, -20), (-2, 2)] {
        let at = owned.origin;
        let before: std::vec::Vec<_> = (-31..31)
            .map(|k| owned.read().height_m(Cell { x: k, y: k }))
            .collect();
        let centre = at.offset(32 + dx, 32 + dy);
        owned.write().follow(centre);
        for (k, before) in (-31..31).zip(before) {
            let inside = (k - centre.x + 32) as u32 <= 63 && (k - centre.y + 32) as u32 <= 63;
            let expected = before.filter(|_| inside);
            assert_eq!(owned.read().height_m(Cell { x: k, y: k }), expected, "{k}");
        }
    }
    owned.write().follow(Cell { x: 500, y: -9 });
    assert!((-31..31).all(|k| owned.read().count(Cell { x: k, y: k }) == 0));
}

#[test]
fn a_possible_drop_ends_with_a_height_or_outside_the_window() {
    let mut owned = around_zero();
    owned.write().mark_possible_drop(CELL);
    assert!(owned.read().is_possible_drop(CELL) && !owned.read().is_drop(CELL));
    assert_eq!(owned.read().height_m(CELL), None);
    owned.write().measure(CELL, 0.25);
    owned.write().mark_possible_drop(CELL);
    assert!(!owned.read().is_possible_drop(CELL));
    assert_eq!(owned.read().height_m(CELL), Some(0.25));
    let other = Cell { x: -30, y: 2 };
    owned.write().mark_possible_drop(other);
    owned.write().follow(Cell { x: 9, y: 0 });
    owned.write().follow(Cell { x: 0, y: 0 });
    assert!(!owned.read().is_possible_drop(other));
    owned.write().mark_possible_drop(other);
    owned.write().mark_drop(other);
    assert!(
        !owned.read().is_possible_drop(other),
        "the drop is marked now"
    );
}

#[test]
fn a_height_of_low_confidence_denies_a_drop_and_is_no_height() {
    let mut owned = around_zero();
    owned.write().mark_drop(CELL);
    owned.write().measure_low_confidence(CELL, -0.5);
    owned.write().measure_low_confidence(CELL, -0.4);
    owned.write().mark_drop(CELL);
    owned.write().mark_possible_drop(CELL);
    assert!(!owned.read().is_drop(CELL) && !owned.read().is_possible_drop(CELL));
    let low_confidence_m = owned.read().low_confidence_m(CELL).expect("low confidence");
    assert!(
        (low_confidence_m + 0.45).abs() < 0.002,
        "{low_confidence_m}"
    );
    assert_eq!(owned.read().height_m(CELL), None);
    assert_eq!(owned.read().count(CELL), 0);
    // The first measured height replaces the mean, and later low confidence is ignored.
    owned.write().measure(CELL, 0.25);
    owned.write().measure_low_confidence(CELL, 0.5);
    assert_eq!(owned.read().height_m(CELL), Some(0.25));
    assert_eq!(owned.read().count(CELL), 1);
    assert_eq!(owned.read().low_confidence_m(CELL), None);
}

#[test]
fn an_obstacle_or_a_wheel_discards_a_height_of_low_confidence() {
    let mut owned = around_zero();
    owned.write().measure_low_confidence(CELL, 0.0);
    owned.write().mark_obstacle(CELL);
    owned.write().mark_obstacle(CELL);
    assert!(owned.read().is_obstacle(CELL, &TUNING));
    assert_eq!(owned.read().height_m(CELL), None);
    owned.write().measure_low_confidence(CELL, 0.0);
    owned.write().mark_wheel_contact(CELL, 0.125);
    assert_eq!(owned.read().height_m(CELL), Some(0.125));
    assert!(!owned.read().is_obstacle(CELL, &TUNING));
}

#[test]
fn measured_ground_removes_marks() {
    let mut owned = around_zero();
    owned.write().mark_drop(CELL);
    assert!(owned.read().is_drop(CELL));
    // Measured ground is no drop, and cannot become one.
    owned.write().measure(CELL, 0.0);
    owned.write().mark_drop(CELL);
    assert!(!owned.read().is_drop(CELL));
    owned.write().mark_obstacle(CELL);
    assert!(
        !owned.read().is_obstacle(CELL, &TUNING),
        "one hit may be a false return"
    );
    owned.write().mark_obstacle(CELL);
    assert!(owned.read().is_obstacle(CELL, &TUNING));
    for _ in 0..2 {
        owned.write().measure(CELL, 0.0);
    }
    assert!(!owned.read().is_obstacle(CELL, &TUNING));
}

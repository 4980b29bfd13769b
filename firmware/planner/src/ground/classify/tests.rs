//! Tests of gaps of unmeasured ground: which of them the ground on both sides spans.

use crate::config::{GroundTuning, UnevenGround};
use crate::geometry::Cell;
use crate::grid::at;
use crate::grid::bits::tests::Rng;
use crate::ground::classify::{RiseLimits, is_bridged};
use crate::ground::elevation::tests::OwnedWindow;

/// The limits of a robot with the default parameters.
fn limits() -> RiseLimits<'static> {
    RiseLimits::new(&UnevenGround::TABLE_I, &GroundTuning::DEFAULT)
}

/// At the corner of a hole ground lies on two sides of a cell, but it spans only one direction.
#[test]
fn ground_spans_a_gap_and_not_the_corner_of_a_hole() {
    for (corner, expected) in [(true, false), (false, true)] {
        let mut owned = OwnedWindow::new(Cell::default());
        let mut window = owned.write();
        let all = (-30..30).flat_map(|y| (-30..30).map(move |x| Cell { x, y }));
        let gone = |cell: &Cell| (0..if corner { 25 } else { 6 }).contains(&cell.x);
        let gone = |cell: &Cell| gone(cell) && (!corner || cell.y >= 0);
        for cell in all.filter(|cell| !gone(cell)) {
            window.measure(cell, 0.0);
        }
        let cell = Cell { x: 2, y: 2 };
        let spans = super::spans_gap(&window.read(), &limits(), cell, 0.0);
        assert_eq!(spans, expected, "corner: {corner}");
    }
}

/// Returns true if ground spans the middle of a gap of eight columns. `height_m` gives the height
/// of the ground by x.
fn spans_gap(slack_m: f32, height_m: impl Fn(f32) -> f32) -> bool {
    let mut owned = OwnedWindow::new(Cell::default());
    let mut window = owned.write();
    let all = (-30..30).flat_map(|y| (-30..30).map(move |x| Cell { x, y }));
    for cell in all.filter(|cell| !(0..8).contains(&cell.x)) {
        window.measure(cell, height_m(cell.centre().x_m));
    }
    let middle = Cell { x: 4, y: 2 };
    super::spans_gap(&window.read(), &limits(), middle, slack_m)
}

/// Across the gap a brow and a kerb look alike: 0.2 m down. The ground beside the gap differs.
#[test]
fn ground_spans_a_brow_and_not_a_kerb_in_a_gap() {
    let spans = |height_m: fn(f32) -> f32| spans_gap(0.0, height_m);
    assert!(spans(|x| -0.15 * x * x.max(0.0)), "a brow");
    assert!(spans(|x| -0.2 * x), "a slope");
    assert!(!spans(|x| if x > 0.4 { -0.2 } else { 0.0 }));
    assert!(spans(|x| if x > 0.4 { -0.05 } else { 0.0 }), "low");
    let steep = |x: f32| -0.33 * x;
    assert!(spans(steep), "a slope that may be climbed");
    assert!(
        !spans_gap(0.001, steep),
        "as steep as a shadow, with a noisy attitude"
    );
}

/// Returns true if ground spans the middle of a gap of eight by eight cells in level ground. One
/// cell beside the gap was measured 0.5 m too high, once and then `again` times.
fn spans_beside_a_false_height(slack_m: f32, again: u32) -> bool {
    let mut owned = OwnedWindow::new(Cell::default());
    let mut window = owned.write();
    let wrong = Cell { x: 8, y: 4 };
    let all = (-30..30).flat_map(|y| (-30..30).map(move |x| Cell { x, y }));
    let gap = 0..8;
    for cell in all.filter(|cell| !(gap.contains(&cell.x) && gap.contains(&cell.y))) {
        if cell != wrong {
            window.measure(cell, 0.0);
            window.measure(cell, 0.0);
        }
    }
    for _ in 0..=again {
        window.measure(wrong, 0.5);
    }
    let middle = Cell { x: 4, y: 4 };
    super::spans_gap(&window.read(), &limits(), middle, slack_m)
}

#[test]
fn one_false_height_beside_a_gap_does_not_refuse_it() {
    assert!(spans_beside_a_false_height(0.0, 0));
    assert!(!spans_beside_a_false_height(0.0, 1));
    assert!(!spans_beside_a_false_height(0.05, 0), "a noisy attitude");
}

/// Errors of the attitude lift a slope of 0.2 by 4 cm before a gap and lower it by 4 cm behind.
#[test]
fn ground_spans_a_gap_in_spite_of_errors_of_the_attitude() {
    let lift_m = |x: f32| {
        if (-0.2..=1.0).contains(&x) {
            -0.04 * x.signum()
        } else {
            0.0
        }
    };
    let slope = |x: f32| -0.2 * x + lift_m(x);
    let steep = |x: f32| if x > 0.4 { -0.5 } else { 0.0 };
    assert!(!spans_gap(0.0, slope));
    assert!(spans_gap(0.085, slope));
    assert!(!spans_gap(0.085, steep), "a drop of half a metre");
}

/// The rows of bits agree with the cells, in a window of scattered marks of every kind.
#[test]
fn rows_of_bits_agree_with_their_cells() {
    let mut rng = Rng(5);
    let mut owned = OwnedWindow::new(Cell { x: 13, y: -41 });
    let mut window = owned.write();
    for _ in 0..1500 {
        let bits = rng.next();
        let cell = Cell {
            x: (bits & 63) as i32 - 20,
            y: (bits >> 8 & 63) as i32 - 70,
        };
        match bits >> 16 & 7 {
            0 => window.measure_low_confidence(cell, 0.1),
            1 => window.mark_obstacle(cell),
            2 => window.mark_drop(cell),
            3 => window.mark_possible_drop(cell),
            _ => window.measure(cell, 0.1 * (bits >> 20 & 3) as f32),
        }
    }
    let heights = window.read();
    let all = heights.all_rows();
    let limits = limits();
    let origin = heights.origin();
    let is_measured = |cell: Cell| heights.fixed(cell).is_some();
    let mut seen = [0; 3];
    for y in origin.y - 2..origin.y + 66 {
        let bridged = super::bridged((&heights, &all), &limits, y, u64::MAX);
        let rows = heights.rows(y);
        assert_eq!(at(&all, (y - origin.y) as usize), rows, "{y}");
        for k in 0..64 {
            let cell = Cell { x: origin.x + k, y };
            let bits = [rows.marked, rows.measured, bridged].map(|row| row >> k & 1 == 1);
            let is_marked = heights.mark(cell) != 0;
            let is_bridge = !is_measured(cell) && is_bridged(&heights, &limits, cell);
            assert_eq!(bits, [is_marked, is_measured(cell), is_bridge], "{cell:?}");
            for (count, bit) in seen.iter_mut().zip(bits) {
                *count += u32::from(bit);
            }
        }
    }
    assert!(seen.iter().all(|&count| count > 300), "{seen:?}");
}

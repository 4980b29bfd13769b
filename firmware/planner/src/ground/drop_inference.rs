//! Drop inference: marks drops near the robot that no beam saw.
//!
//! ```text
//! inferred:  a possible drop, or a cell on a rim; near the robot; no ground spans it
//! on a rim:  no beam ever met it, and of the eight cells around one is a drop and one is measured
//! ```
//!
//! A possible drop comes from a beam that is too gentle to tell a rim from a slope, or that meets
//! what may be the slope behind a brow ([`super::survey`]). A rim needs no beam: at the corner of a
//! hole the beams pass over the drop and meet the face of the other side just below the ground, as
//! in a dip, so no beam shows the last cells before the corner. A robot that drives along one side
//! would turn there beside ground that it never saw. A rim does not end in the open, so the drop
//! continues along measured ground.
//!
//! Inferred drops are weaker than drops that a beam saw:
//!
//! - They do not count against the ground beside them, and the first measured height removes them.
//! - A drop on a rim does not override free ground in the map. When the robot comes back or
//!   reverses, the window holds only the strip that it stood on. A confirmed possible drop does
//!   override it: a hole's far wall and the foot of a kerb are measured as ground from the other
//!   side.
//!
//! A possible drop is confirmed under a noisy attitude too. The robot may come back with a pose
//! that is 0.5 m off, and the map then calls the hole's rim free (measured: docs/MEASURED.md,
//! "Possible drops under a noisy attitude").
//!
//! Departs from \[Maffei20, III-B\]: the paper marks all undetected ground on the ray to the robot.
//!
//! Units: metres, map cells.

use crate::config::UnevenGround;
use crate::geometry::Cell;
use crate::ground::classify::{RiseLimits, is_bridged, spans_gap};
use crate::ground::elevation::Elevation;

/// Infers drops around the robot's cell. `slack_m` is the difference of two heights that errors of
/// the attitude alone explain, metres.
pub(super) fn infer_drops(
    elevation: &mut Elevation<'_>,
    ground: &UnevenGround,
    robot: Cell,
    slack_m: f32,
) {
    let tuning = elevation.tuning;
    let reach = tuning.near_cells;
    let side = 2 * reach + 1;
    let near = |k: i32| robot.offset(k % side - reach, k / side - reach);
    let all = 0..side * side;
    let limits = RiseLimits::new(ground, tuning);
    for cell in all.clone().map(near) {
        let heights = elevation.read();
        if heights.is_possible_drop(cell) && !spans_gap(&heights, &limits, cell, slack_m) {
            elevation.confirm_drop(cell);
        }
    }
    // Forwards and backwards, so that a rim continues in both directions.
    for cell in all.clone().chain(all.rev()).map(near) {
        let heights = elevation.read();
        if heights.is_on_rim(cell)
            && !is_bridged(&heights, &limits, cell)
            && !spans_gap(&heights, &limits, cell, slack_m)
        {
            elevation.infer_drop(cell);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::string::String;

    use super::infer_drops;
    use crate::config::{GroundTuning, UnevenGround};
    use crate::geometry::Cell;
    use crate::grid::{Class, Row};
    use crate::ground::classify::{self, RiseLimits};
    use crate::ground::elevation::Heights;
    use crate::ground::elevation::tests::OwnedWindow;

    /// Returns the rows after two steps of inference, from the north, with the robot in the middle:
    /// `.` measured at 0, `v` a drop, `s` a possible drop, a space never met.
    fn after_inference(rows: &[&str]) -> String {
        let mut owned = OwnedWindow::new(Cell::default());
        let mut window = owned.write();
        let (width, height) = (rows[0].len() as i32, rows.len() as i32);
        let cells = || (0..height).flat_map(|r| (0..width).map(move |k| (r, k)));
        let place = |(r, k): (i32, i32)| Cell {
            x: k - width / 2,
            y: height / 2 - r,
        };
        for (r, k) in cells() {
            let cell = place((r, k));
            match rows[r as usize].as_bytes()[k as usize] {
                b'.' => window.measure(cell, 0.0),
                b'v' => window.mark_drop(cell),
                b's' => window.mark_possible_drop(cell),
                _ => {}
            }
        }
        for _ in 0..2 {
            infer_drops(&mut window, &UnevenGround::TABLE_I, Cell::default(), 0.0);
        }
        let drawn = |heights: &Heights<'_>, cell: Cell| match () {
            () if heights.is_drop(cell) => 'v',
            () if heights.count(cell) > 0 => '.',
            () if heights.is_possible_drop(cell) => 's',
            () => ' ',
        };
        let heights = window.read();
        let row = |r: i32| {
            let line: String = (0..width).map(|k| drawn(&heights, place((r, k)))).collect();
            line + "\n"
        };
        (0..height).map(row).collect()
    }

    #[test]
    fn a_rim_continues_around_the_corner_along_measured_ground() {
        let seen = after_inference(&[
            "........       ",
            "........       ",
            "........       ",
            "........       ",
            "........       ",
            "........     vv",
            "...............",
            "...............",
            "...............",
            "...............",
            "...............",
        ]);
        let expected = [
            "........v      ",
            "........v      ",
            "........v      ",
            "........v      ",
            "........v      ",
            "........vvvvvvv",
            "...............",
            "...............",
            "...............",
            "...............",
            "...............",
        ];
        assert_eq!(seen, expected.map(|row| std::format!("{row}\n")).concat());
    }

    /// Beams beside the robot leave stripes of measured ground. Ground on both sides spans the
    /// cells between two stripes.
    #[test]
    fn no_rim_continues_between_stripes() {
        let rows = [
            "..............v",
            "               ",
            "               ",
            "...............",
            "               ",
            "               ",
            "...............",
            "...............",
            "...............",
        ];
        let mut expected = rows;
        expected[1..3].fill("              v");
        assert_eq!(
            after_inference(&rows),
            expected.map(|row| std::format!("{row}\n")).concat()
        );
    }

    /// A possible drop beside another does not keep the ground around both from spanning them.
    #[test]
    fn one_possible_drop_does_not_confirm_another() {
        let seen = after_inference(&[
            "...............",
            "...............",
            "...............",
            ".....      ....",
            "....  s  s ....",
            ".....      ....",
            "...............",
            "...............",
            "...............",
        ]);
        assert!(!seen.contains('v'), "{seen}");
        assert_eq!(seen.matches('s').count(), 2, "{seen}");
    }

    /// Returns the negative obstacles of a row of the window with one inferred drop (bit 3), one
    /// seen drop (bit 5) and one confirmed drop (bit 7). `known` is the row in the map.
    fn negative(known: Row) -> u64 {
        let mut owned = OwnedWindow::new(Cell { x: 32, y: 32 });
        let mut window = owned.write();
        window.infer_drop(Cell { x: 3, y: 9 });
        window.mark_drop(Cell { x: 5, y: 9 });
        window.mark_possible_drop(Cell { x: 7, y: 9 });
        window.confirm_drop(Cell { x: 7, y: 9 });
        let limits = RiseLimits::new(&UnevenGround::TABLE_I, &GroundTuning::DEFAULT);
        let heights = window.read();
        classify::row((&heights, &heights.all_rows()), &limits, 9, known).negative
    }

    /// The window of a robot that comes back or reverses holds only the strip that it stands on.
    /// But ground that is free from one side, a hole's far wall or a kerb's foot, is a drop from
    /// the other.
    #[test]
    fn free_ground_in_the_map_overrides_only_an_inferred_drop() {
        let (inferred, seen) = (1 << 3, 1 << 5 | 1 << 7);
        for (class, low, high, expected) in [
            (Class::Unknown, 0, 0, inferred | seen),
            (Class::Negative, u64::MAX, u64::MAX, inferred | seen),
            (Class::Free, u64::MAX, 0, seen),
        ] {
            let visited = 0;
            let known = negative(Row { low, high, visited });
            assert_eq!(known, expected, "{class:?}");
        }
    }

    /// Returns if a possible drop behind level ground becomes a drop, and if that is only inferred,
    /// for this slack of the attitude.
    fn inferred_behind(slack_m: f32) -> (bool, bool) {
        let mut owned = OwnedWindow::new(Cell::default());
        let mut window = owned.write();
        for (x, y) in (-8..=0).flat_map(|x| (-8..=8).map(move |y| (x, y))) {
            window.measure(Cell { x, y }, 0.0);
        }
        let behind = Cell { x: 1, y: 0 };
        window.mark_possible_drop(behind);
        infer_drops(
            &mut window,
            &UnevenGround::TABLE_I,
            Cell::default(),
            slack_m,
        );
        let heights = window.read();
        (heights.is_drop(behind), heights.is_inferred_drop(behind))
    }

    #[test]
    fn a_possible_drop_is_confirmed_whatever_the_noise_of_the_attitude() {
        for slack_m in [0.0, 0.05] {
            assert_eq!(inferred_behind(slack_m), (true, false), "{slack_m} m");
        }
    }
}

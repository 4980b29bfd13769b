//! Suspicions: ground that is held to be gone because the robot came near without measuring it.
//!
//! ```text
//! held to be gone:  suspected, or on a rim;  within NEAR_M of the robot;  nothing leads over it
//! on a rim:         nothing was ever met in it, and of the eight cells around one is gone and one is measured
//! ```
//!
//! Beams that come down too gently to tell a rim from a slope, and those that meet what may be the slope behind a brow, leave a suspicion
//! ([`super::survey`]). And at the corner of a hole beams pass
//! over what is gone and meet the other side's face just below the ground, as they would in a dip: no beam says anything of the last
//! cells before the corner, and the robot that drives along one side turns there beside ground that it never saw. A rim does not end in the
//! open, so there what goes on along measured ground is taken for gone as well.
//!
//! What is but held to be gone is no evidence against the ground beside it and gives way to the first height that is measured. What lies on
//! a rim, and no beam said anything of, is not gone in the map where ground was measured before: a robot that comes again, or backs, has in
//! the window but the strip that it stood on. What a beam told is: a hole's far wall and the foot of a kerb are measured as ground from the
//! other side. Of an attitude that errs a suspicion is worth no more than a rim. Not in [Maffei20], whose ray back to the robot marks
//! whatever was not detected. Units: metres, map cells.

use crate::config::UnevenGround;
use crate::geometry::{CELL_M, Cell};
use crate::ground::classify::{RiseLimits, is_bridged, spans_gap};
use crate::ground::elevation::Elevation;
use crate::math;

/// Ground nearer to the robot than this that was never measured will not be, metres: the steep beams met level ground farther off, and would
/// have met a slope.
const NEAR_M: f32 = 0.9;

/// Settle what is suspected around the robot at `middle`. Two heights may differ by `slack_m` for errors of the attitude alone.
pub fn infer_drops(
    elevation: &mut Elevation<'_>,
    ground: &UnevenGround,
    middle: Cell,
    slack_m: f32,
) {
    let reach = math::floor(NEAR_M / CELL_M);
    let side = 2 * reach + 1;
    let near = |k: i32| Cell {
        x: middle.x - reach + k % side,
        y: middle.y - reach + k / side,
    };
    let all = 0..side * side;
    for cell in all.clone().map(near) {
        let heights = elevation.read();
        if heights.is_possible_drop(cell) && !spans_gap(&heights, ground, cell, slack_m) {
            // Errors of the attitude raise suspicions on ground that was measured well before.
            if slack_m > 0.0 {
                elevation.infer_drop(cell);
            } else {
                elevation.confirm_drop(cell);
            }
        }
    }
    let limits = RiseLimits::new(ground);
    // There and back, so that it goes on along a rim both ways.
    for cell in all.clone().chain(all.rev()).map(near) {
        let heights = elevation.read();
        if heights.is_on_rim(cell)
            && !is_bridged(&heights, &limits, cell)
            && !spans_gap(&heights, ground, cell, slack_m)
        {
            elevation.infer_drop(cell);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::string::String;
    use std::vec;

    use super::infer_drops;
    use crate::config::UnevenGround;
    use crate::geometry::Cell;
    use crate::grid::Row;
    use crate::ground::classify::{self, RiseLimits};
    use crate::ground::elevation::{Elevation, Heights, WINDOW_CELLS};
    use crate::map::{Class, Tiles};

    /// What two steps make of rows from the north, the robot in the middle of them: `.` measured at 0, `v` seen to be gone, `s` suspected,
    /// anything else never met.
    fn after_inference(rows: &[&str]) -> String {
        let mut heights = vec![0; 2 * WINDOW_CELLS];
        let mut marks = vec![0; WINDOW_CELLS];
        let mut origin = Cell::default();
        let mut window = Elevation::new(&mut heights, &mut marks, &mut origin);
        window.follow(Cell::default());
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
    fn a_rim_goes_on_around_the_corner_along_measured_ground() {
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

    /// Beams beside the robot leave stripes; what lies between two of them is measured on both sides, and what lies beside them is not.
    #[test]
    fn between_stripes_no_rim_goes_on() {
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

    /// A suspicion that is settled says nothing of the next one, which ground on all sides leads over.
    #[test]
    fn one_suspicion_does_not_settle_another() {
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

    /// The bits of a row of the window with one cell presumed to be gone, one believed and one seen to be, where the map has this.
    fn negative(known: Row) -> u64 {
        let mut heights = vec![0; 2 * WINDOW_CELLS];
        let mut marks = vec![0; WINDOW_CELLS];
        let mut origin = Cell::default();
        let mut window = Elevation::new(&mut heights, &mut marks, &mut origin);
        window.follow(Cell { x: 32, y: 32 });
        window.infer_drop(Cell { x: 3, y: 9 });
        window.mark_drop(Cell { x: 5, y: 9 });
        window.mark_possible_drop(Cell { x: 7, y: 9 });
        window.confirm_drop(Cell { x: 7, y: 9 });
        classify::row(
            &window.read(),
            &RiseLimits::new(&UnevenGround::TABLE_I),
            9,
            known,
        )
        .negative
    }

    /// A robot that comes again, or backs, has nothing in the window but the strip that it stands on; but what was free from the other side, a
    /// hole's wall or the foot of a kerb, is gone from this one.
    #[test]
    fn what_is_inferred_drop_to_be_gone_is_not_where_ground_was_measured_before_and_what_a_beam_told_is()
     {
        let (presumed, told) = (1 << 3, 1 << 5 | 1 << 7);
        for (class, expected) in [
            (Class::Unknown, presumed | told),
            (Class::Negative, presumed | told),
            (Class::Free, told),
        ] {
            let mut tiles = Tiles::<4, 16>::new();
            tiles.reset(4, 4);
            for x in 0..64 {
                tiles.set(Cell { x, y: 9 }, class).expect("room");
            }
            assert_eq!(negative(tiles.row(0, 9)), expected, "{class:?}");
        }
    }

    /// What is suspected behind level ground in the middle, after the robot came near with this much error of the attitude: whether it is held
    /// to be gone, and whether for being on a rim alone.
    fn held(slack_m: f32) -> (bool, bool) {
        let mut heights = vec![0; 2 * WINDOW_CELLS];
        let mut marks = vec![0; WINDOW_CELLS];
        let mut origin = Cell::default();
        let mut window = Elevation::new(&mut heights, &mut marks, &mut origin);
        window.follow(Cell::default());
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
    fn a_suspicion_of_an_attitude_that_errs_is_worth_no_more_than_a_rim() {
        assert_eq!(held(0.0), (true, false));
        assert_eq!(held(0.05), (true, true));
    }
}

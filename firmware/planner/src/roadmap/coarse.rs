//! From map cells of 10 cm to coarse cells of 20 cm, and the border of the explored.
//!
//! A coarse cell is passable if any of its four map cells is. It is unexplored if two or more of
//! them were never measured, else explored.
//!
//! Units: bits; bit k of a word is column k.

use crate::grid::bits::even;
use crate::grid::{MAX_WORDS_PER_ROW, at};
use crate::roadmap::configuration_space::Strip;

/// Returns the passable coarse cells of two rows of map cells: the explored and the unexplored
/// ones.
pub(super) fn coarse(lower: Strip, upper: Strip) -> [u16; 2] {
    let (one, other) = (lower.unknown, upper.unknown);
    let one_in_each = (one | one >> 1) & (other | other >> 1);
    let unknown = (one & one >> 1) | (other & other >> 1) | one_in_each;
    let passable = lower.passable | upper.passable;
    let passable = passable | passable >> 1;
    [even(passable & !unknown), even(passable & unknown)]
}

/// Replaces the unexplored passable cells in `marks` by the border: the explored ones with an
/// unexplored cell at a side. `cells` holds at least the explored passable cells.
pub(super) fn mark_border(cells: &[u32], marks: &mut [u32], per_row: usize) {
    // The unexplored cells of the row below, whose marks are replaced already.
    let mut below = [0u32; MAX_WORDS_PER_ROW];
    for start in (0..marks.len()).step_by(per_row.max(1)) {
        let mut before = 0;
        for (word, below) in below.iter_mut().enumerate().take(per_row) {
            let index = start + word;
            let here = at(marks, index);
            let after = if word + 1 < per_row {
                at(marks, index + 1)
            } else {
                0
            };
            let sides = here << 1 | before >> 31 | here >> 1 | after << 31;
            let beside = sides | *below | at(marks, index + per_row);
            if let Some(mark) = marks.get_mut(index) {
                *mark = beside & at(cells, index) & !here;
            }
            (before, *below) = (here, here);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::string::String;
    use std::vec::Vec;

    use super::{coarse, mark_border};
    use crate::roadmap::configuration_space::Strip;

    struct Random(u64);

    impl Random {
        fn next(&mut self) -> u32 {
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (self.0 >> 32) as u32
        }
    }

    #[test]
    fn a_coarse_cell_is_what_its_four_cells_are() {
        let mut random = Random(1);
        for _ in 0..200 {
            let [lower, upper] = core::array::from_fn(|_| Strip {
                passable: random.next(),
                unknown: random.next() & random.next(),
                obstacle: 0,
            });
            let [explored, unexplored] = coarse(lower, upper);
            for k in 0..16 {
                let of = |word: u32| (word >> (2 * k) & 3).count_ones();
                let passable = of(lower.passable) + of(upper.passable) > 0;
                let known = of(lower.unknown) + of(upper.unknown) < 2;
                assert_eq!(explored >> k & 1 == 1, passable && known);
                assert_eq!(unexplored >> k & 1 == 1, passable && !known);
            }
        }
    }

    /// Marks the border in a picture of `.` explored, `?` unexplored, `#` obstacle, one word a row.
    fn border(picture: &str) -> String {
        let rows: Vec<&str> = picture.split_whitespace().collect();
        let bits = |of: &str| -> Vec<u32> {
            let row = |row: &&str| {
                (0..)
                    .zip(row.chars())
                    .map(|(k, c)| u32::from(of.contains(c)) << k)
                    .sum()
            };
            rows.iter().map(row).collect()
        };
        let mut marks = bits("?");
        mark_border(&bits(".?"), &mut marks, 1);
        let mut text = String::new();
        for (row, mark) in rows.iter().zip(marks) {
            for (k, c) in row.chars().enumerate() {
                text.push(if mark >> k & 1 == 1 { '*' } else { c });
            }
            text.push(' ');
        }
        text
    }

    #[test]
    fn the_border_is_on_the_explored_side() {
        let picture = "..... ..?.. .#??? ..##?";
        assert_eq!(border(picture), "..*.. .*?** .#??? ..##? ");
    }

    #[test]
    fn the_border_crosses_words_and_ends_at_the_rim() {
        let mut random = Random(2);
        for round in 0..200 {
            let (per_row, rows) = (1 + round % 4, 1 + round % 7);
            let columns = per_row * 32;
            let open: Vec<u32> = (0..per_row * rows)
                .map(|_| random.next() | random.next())
                .collect();
            let unexplored: Vec<u32> = open.iter().map(|word| word & random.next()).collect();
            let explored: Vec<u32> = (open.iter().zip(&unexplored))
                .map(|(open, unexplored)| open & !unexplored)
                .collect();
            for cells in [&explored, &open] {
                let mut marks = unexplored.clone();
                mark_border(cells, &mut marks, per_row);
                let at = |words: &[u32], x: usize, y: usize| {
                    x < columns && y < rows && words[y * per_row + x / 32] >> (x % 32) & 1 == 1
                };
                for (x, y) in (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y))) {
                    let is_unexplored = |x, y| at(&unexplored, x, y);
                    let is_explored = |x, y| at(&explored, x, y);
                    let sides = [(0, 1), (2, 1), (1, 0), (1, 2)]
                        .map(|(dx, dy)| ((x + dx).wrapping_sub(1), (y + dy).wrapping_sub(1)));
                    let expected =
                        is_explored(x, y) && sides.iter().any(|&(x, y)| is_unexplored(x, y));
                    assert_eq!(at(&marks, x, y), expected, "{columns} x {rows} at {x} {y}");
                }
            }
        }
    }
}

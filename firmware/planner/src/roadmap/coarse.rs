//! From map cells of 10 cm to coarse cells of 20 cm, and the border between the explored and the unexplored.
//!
//! A coarse cell is passable if any of its four map cells is; it is unexplored if two or more of them were never
//! measured, else explored.
//!
//! Units: bits; bit k of a word is column k.

use crate::grid::bits::even;
use crate::grid::{MAX_WORDS_PER_ROW, at};
use crate::roadmap::configuration_space::Strip;

/// Two rows of map cells as one row of coarse cells: the passable ones, explored and unexplored.
pub(super) fn coarse(lower: Strip, upper: Strip) -> [u16; 2] {
    let (one, other) = (lower.unknown, upper.unknown);
    let one_in_each = (one | one >> 1) & (other | other >> 1);
    let unknown = (one & one >> 1) | (other & other >> 1) | one_in_each;
    let passable = lower.passable | upper.passable;
    let passable = passable | passable >> 1;
    [even(passable & !unknown), even(passable & unknown)]
}

/// Where the explored meets the unexplored, and which side of it counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Border {
    /// Explored cells with an unexplored cell at a side.
    Explored,
    /// Unexplored cells with an explored cell at a side or a corner: a skeleton that leaves the explored, be it by a
    /// corner, enters one of them.
    Unexplored,
}

/// Turn `marks` from the unexplored passable cells into those of the border, in place; `cells` holds at least the explored
/// passable ones.
pub(super) fn mark_border(border: Border, cells: &[u32], marks: &mut [u32], per_row: usize) {
    let explored = |mark: u32, index| at(cells, index) & !mark;
    match border {
        Border::Explored => {
            touching::<false>(marks, per_row, |mark, index| (mark, explored(mark, index)));
        }
        Border::Unexplored => {
            touching::<true>(marks, per_row, |mark, index| (explored(mark, index), mark));
        }
    }
}

/// Replace every mark by the cells that touch one of the sources: `split` says of a mark and its index, as they were,
/// which cells are sources and which may touch them. `CORNERS` count as touching too.
fn touching<const CORNERS: bool>(
    marks: &mut [u32],
    per_row: usize,
    split: impl Fn(u32, usize) -> (u32, u32),
) {
    // The sources of the row below, whose marks are replaced already.
    let mut below = [0u32; MAX_WORDS_PER_ROW];
    for start in (0..marks.len()).step_by(per_row.max(1)) {
        let source = |marks: &[u32], index: usize| split(at(marks, index), index).0;
        // Three rows of sources at a word: the middle one, and all together.
        let column = |marks: &[u32], below: &[u32], word: usize| {
            if word == per_row {
                return [0; 2];
            }
            let here = source(marks, start + word);
            let beyond = start + word + per_row;
            let above = if beyond < marks.len() {
                source(marks, beyond)
            } else {
                0
            };
            [here, here | above | at(below, word)]
        };
        let mut before = [0; 2];
        let mut here = column(marks, &below, 0);
        for word in 0..per_row {
            let after = column(marks, &below, word + 1);
            let sides = |rows: [u32; 2]| if CORNERS { rows[1] } else { rows[0] };
            let [west, middle, east] = [before, here, after].map(sides);
            let beside = here[1] | middle << 1 | west >> 31 | middle >> 1 | east << 31;
            if let Some(mark) = marks.get_mut(start + word) {
                *mark = beside & split(*mark, start + word).1;
            }
            if let Some(below) = below.get_mut(word) {
                *below = here[0];
            }
            (before, here) = (here, after);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::string::String;
    use std::vec::Vec;

    use super::{Border, coarse, mark_border};
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

    /// Pictures of `.` explored, `?` unexplored, `#` obstacle as cells and marks of one word a row.
    fn border(border: Border, picture: &str) -> String {
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
        mark_border(border, &bits(".?"), &mut marks, 1);
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
    fn the_border_is_on_the_explored_side_or_on_the_unexplored_one() {
        let picture = "..... ..?.. .#??? ..##?";
        assert_eq!(
            border(Border::Explored, picture),
            "..*.. .*?** .#??? ..##? "
        );
        assert_eq!(
            border(Border::Unexplored, picture),
            "..... ..*.. .#*** ..##? "
        );
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
            for (border, cells) in [
                (Border::Explored, &explored),
                (Border::Explored, &open),
                (Border::Unexplored, &open),
            ] {
                let mut marks = unexplored.clone();
                mark_border(border, cells, &mut marks, per_row);
                let at = |words: &[u32], x: usize, y: usize| {
                    x < columns && y < rows && words[y * per_row + x / 32] >> (x % 32) & 1 == 1
                };
                for (x, y) in (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y))) {
                    let is_unexplored = |x, y| at(&unexplored, x, y);
                    let is_explored = |x, y| at(&explored, x, y);
                    let near = [
                        (0, 1),
                        (2, 1),
                        (1, 0),
                        (1, 2),
                        (0, 0),
                        (0, 2),
                        (2, 0),
                        (2, 2),
                    ]
                    .map(|(dx, dy)| ((x + dx).wrapping_sub(1), (y + dy).wrapping_sub(1)));
                    let expected = if border == Border::Explored {
                        is_explored(x, y) && near[..4].iter().any(|&(x, y)| is_unexplored(x, y))
                    } else {
                        is_unexplored(x, y) && near.iter().any(|&(x, y)| is_explored(x, y))
                    };
                    assert_eq!(
                        at(&marks, x, y),
                        expected,
                        "{border:?} {columns} x {rows} at {x} {y}"
                    );
                }
            }
        }
    }
}

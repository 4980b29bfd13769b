//! From map cells of 10 cm to coarse cells of 20 cm, and the border of the explored.
//!
//! A coarse cell is passable if any of its four map cells is. It is unexplored if two or more of
//! them were never measured, else explored.
//!
//! Units: bits; bit k of a word is column k.

use crate::grid::Block;
use crate::grid::bits::even;
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

/// Returns the border in word k of a page: its explored cells with an unexplored cell at a side.
/// `unexplored` has the unexplored cells of the page and of those around it.
pub(super) fn border(cells: u32, unexplored: &Block, k: usize) -> u32 {
    let [north, _, east, _, south, _, west, _] = unexplored.neighbours(k);
    (north | east | south | west) & cells & !unexplored.word(k)
}

#[cfg(test)]
mod tests {
    use std::string::String;
    use std::vec::Vec;

    use super::{border, coarse};
    use crate::grid::{Block, PAGE_WORDS, PlaneMut, TileKey, Tiling, draw};
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

    /// `.` is explored, `?` unexplored, `#` an obstacle, `*` the border.
    #[test]
    fn the_border_is_on_the_explored_side() {
        let picture = "..... ..?.. .#??? ..##?";
        let keys = [TileKey::of(0, 0).unwrap()];
        let tiling = Tiling::new(&keys);
        let plane = |of: &str| {
            let marked = |c: char| if of.contains(c) { '#' } else { '.' };
            let rows = picture.split_whitespace();
            let rows: Vec<String> = rows.map(|row| row.chars().map(marked).collect()).collect();
            let mut words = [0; PAGE_WORDS];
            let mut plane = PlaneMut::new(tiling, &mut words).unwrap();
            draw(&mut plane, keys[0], &rows.join("\n"));
            words
        };
        let (cells, unexplored) = (plane(".?"), plane("?"));
        let block = Block::read(tiling, &unexplored, 0);
        let marks: [u32; PAGE_WORDS] = core::array::from_fn(|k| border(cells[k], &block, k));
        let mut text = String::new();
        for (y, row) in picture.split_whitespace().enumerate() {
            for (x, c) in row.chars().enumerate() {
                let mark = marks[y / 2] >> (16 * (y % 2) + x) & 1;
                text.push(if mark == 1 { '*' } else { c });
            }
            text.push(' ');
        }
        assert_eq!(text, "..*.. .*?** .#??? ..##? ");
    }
}

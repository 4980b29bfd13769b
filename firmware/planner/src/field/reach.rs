//! Which free cells can be reached from a goal: a flood through the rows' bit masks.
//!
//! A cell without a way to any goal has q = 0 exactly, but an iteration started above zero only creeps towards it and
//! never says so. Reachability is therefore decided here, by bits, before any number is touched.
//!
//! Invariant: `reached ⊆ free ∪ goal`, and a free cell beside (4-neighbourhood) a reached one is reached.

use crate::field::window::SIDE;

/// The free cells with a way, over free cells, to some goal cell. Goals themselves are not in the answer.
pub(super) fn flood(free: &[u64; SIDE], goal: &[u64; SIDE]) -> [u64; SIDE] {
    let mut reached = *goal;
    // Rows that may still grow; a row that grew wakes its two neighbours.
    let mut awake: u64 = (1 << SIDE) - 1;
    while awake != 0 {
        let y = awake.trailing_zeros() as usize;
        awake &= awake - 1;
        let below = if y > 0 { reached[y - 1] } else { 0 };
        let above = if y + 1 < SIDE { reached[y + 1] } else { 0 };
        let seeds = reached[y] | ((below | above) & free[y]);
        let grown = seeds | fill(free[y], free[y] & (seeds | seeds << 1 | seeds >> 1));
        if grown != reached[y] {
            reached[y] = grown;
            awake |= (0b101 << y) >> 1;
            awake &= (1 << SIDE) - 1;
        }
    }
    for (row, goal) in reached.iter_mut().zip(goal) {
        *row &= !goal;
    }
    reached
}

/// Every run of `mask` that holds one of `seeds` (a subset of `mask`), whole.
fn fill(mask: u64, seeds: u64) -> u64 {
    let backward = fill_upward(mask.reverse_bits(), seeds.reverse_bits());
    fill_upward(mask, seeds) | backward.reverse_bits()
}

/// From each seed to the high end of its run: a carry started at a seed clears the run's bits up to its end.
fn fill_upward(mask: u64, seeds: u64) -> u64 {
    mask & !mask.wrapping_add(seeds) | seeds
}

#[cfg(test)]
mod tests {
    use super::{SIDE, fill, flood};

    #[test]
    fn a_run_fills_from_any_of_its_seeds() {
        assert_eq!(fill(0b0111_0110, 0b0010_0000), 0b0111_0000);
        assert_eq!(fill(0b0111_0110, 0b0101_0010), 0b0111_0110);
        assert_eq!(fill(0b0111_0110, 0), 0);
        let row = (1 << SIDE) - 1;
        assert_eq!(fill(row, 1 << 30), row);
    }

    #[test]
    fn a_meander_is_reached_to_its_end_and_a_cell_behind_a_corner_is_not() {
        // Columns 0, 2, 4 .. are corridors, joined alternately at the top and at the bottom.
        let even = 0x1555_5555_5555_5555_u64;
        let mut free = [even; SIDE];
        free[0] |= 0x0888_8888_8888_8888;
        free[SIDE - 1] |= 0x0222_2222_2222_2222;
        let mut goal = [0; SIDE];
        goal[0] = 1;
        let mut whole = free;
        whole[0] &= !1;
        assert_eq!(flood(&free, &goal), whole);

        // Touching at a corner is no way.
        let mut free = [0; SIDE];
        free[10] = 0b0111;
        free[11] = 0b1000;
        let mut goal = [0; SIDE];
        goal[10] = 0b0001;
        let reached = flood(&free, &goal);
        assert_eq!((reached[10], reached[11]), (0b0110, 0));
    }

    #[test]
    fn no_goal_reaches_nothing() {
        let free = [(1 << SIDE) - 1; SIDE];
        assert_eq!(flood(&free, &[0; SIDE]), [0; SIDE]);
    }
}

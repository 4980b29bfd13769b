//! Sets of map cells that take seconds to compute and that every run in a world needs again: what
//! can be seen from a start.
//!
//! Invariant: equal keys have equal results, so a run does not depend on which run came first.

use std::sync::{Arc, Mutex, PoisonError};

use fieldline_planner::geometry::Cell;

/// The bits of the numbers that a result depends on.
pub(crate) type Key = [u64; 5];

/// A result, with its key.
type Known = (Key, Vec<Cell>);

/// The results so far, by key. Clones share them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Memo(Arc<Mutex<Vec<Known>>>);

impl Memo {
    /// Returns the result of a key; computes it if it is the first time. Another thread that asks
    /// meanwhile waits.
    pub(crate) fn get(&self, key: Key, compute: impl FnOnce() -> Vec<Cell>) -> Vec<Cell> {
        // A panic in `compute` leaves the list as it was.
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, cells)) = known.iter().find(|(other, _)| *other == key) {
            return cells.clone();
        }
        let cells = compute();
        known.push((key, cells.clone()));
        cells
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_result_is_computed_once_for_each_key() {
        let memo = Memo::default();
        let mut computed = 0;
        for key in [1, 2, 1, 2, 1] {
            let cells = memo.clone().get([key; 5], || {
                computed += 1;
                vec![Cell {
                    x: key as i32,
                    y: 0,
                }]
            });
            assert_eq!(
                cells,
                [Cell {
                    x: key as i32,
                    y: 0
                }]
            );
        }
        assert_eq!(computed, 2);
    }
}

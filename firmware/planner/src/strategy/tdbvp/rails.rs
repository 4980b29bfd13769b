//! Rails: when the robot last visited the centre cells, and what they are charged with for it [Maffei14, eq. 3].
//!
//! ```text
//! p = (s − s_oldest) / (s_newest − s_oldest)     visited in step s: the newest 1, the oldest 0
//! p = −0.5                                       not visited yet
//! ```
//!
//! Departs from the paper, where every centre cell has its step: a skeleton changes all the time, and there is one byte for
//! 1.6 × 1.6 m of the map. No two centre lines that a wall parts share one, a corridor of 2 m has one for 1.6 m of its length,
//! and what the robot visits has its byte whatever becomes of the centre cells in it. The byte is a date; when the days run
//! out, the past is moved down if it is not used to the bottom, and otherwise halved, with days of twice the length from then on, so that the
//! robot can go on for ever.
//!
//! Invariants: 0 is not visited; no date is later than today; the order of two visits never turns about. Tiles are addressed
//! as the map's are. Units: map cells; days of a growing number of steps.

use crate::geometry::Cell;
use crate::grid::TileBox;

/// Map cells along a place that has a date, as a power of two.
const SHIFT: i32 = 4;
/// Map cells along a place that has a date.
pub const PLACE_CELLS: i32 = 1 << SHIFT;
/// A day's steps at first.
const DAY_STEPS: u16 = 4;
/// Potential of a centre cell that was not visited yet.
pub const UNVISITED: f32 = -0.5;

/// Dates of visits in a box of tiles; 4 bytes for each of its `SLOTS` places.
#[derive(Debug)]
pub struct Rails<const SLOTS: usize> {
    dates: [[u8; 4]; SLOTS],
    slots: TileBox,
    today: u8,
    oldest: u8,
    /// Steps of a day, and of today so far.
    day_steps: u16,
    steps: u16,
}

impl<const SLOTS: usize> Rails<SLOTS> {
    /// Nothing is visited; without a box.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            dates: [[0; 4]; SLOTS],
            slots: TileBox::EMPTY,
            today: 1,
            oldest: 1,
            day_steps: DAY_STEPS,
            steps: 0,
        }
    }

    /// Forget everything; the box is `width` × `height` tiles.
    pub fn reset(&mut self, (width, height): (i32, i32)) {
        self.dates.as_flattened_mut().fill(0);
        self.slots = TileBox { width, height };
        (self.today, self.oldest) = (1, 1);
        (self.day_steps, self.steps) = (DAY_STEPS, 0);
    }

    /// Another step.
    pub fn pass(&mut self) {
        self.steps += 1;
        if self.steps < self.day_steps {
            return;
        }
        self.steps = 0;
        self.find_oldest();
        if self.today == u8::MAX {
            self.make_room();
        }
        self.today += 1;
    }

    /// A centre cell is visited today; whether for the first time.
    pub fn visit(&mut self, cell: Cell) -> bool {
        let (slot, part) = self.place(cell);
        let today = self.today;
        let date = self.dates.get_mut(slot).and_then(|tile| tile.get_mut(part));
        date.is_some_and(|date| core::mem::replace(date, today) == 0)
    }

    /// A centre cell's place counts as never visited.
    pub fn forget(&mut self, cell: Cell) {
        let (slot, part) = self.place(cell);
        if let Some(date) = self.dates.get_mut(slot).and_then(|tile| tile.get_mut(part)) {
            *date = 0;
        }
    }

    /// The date of the last visit.
    fn date(&self, cell: Cell) -> Option<u8> {
        let (slot, part) = self.place(cell);
        let date = *self.dates.get(slot)?.get(part)?;
        (date != 0).then_some(date)
    }

    /// Whether it was ever visited.
    #[must_use]
    pub fn is_visited(&self, cell: Cell) -> bool {
        self.date(cell).is_some()
    }

    /// Potential of a centre cell [Maffei14, eq. 3]; where all are equally old, 1.
    #[must_use]
    pub fn potential(&self, cell: Cell) -> f32 {
        let Some(date) = self.date(cell) else {
            return UNVISITED;
        };
        match self.today - self.oldest {
            0 => 1.0,
            span => f32::from(date.saturating_sub(self.oldest)) / f32::from(span),
        }
    }

    /// The older of two centre cells has the lesser rank; what was never visited is the oldest.
    #[must_use]
    pub fn rank(&self, cell: Cell) -> u8 {
        self.date(cell).unwrap_or(0)
    }

    /// Steps since the visit of a rank; of what was never visited, since the days began.
    #[must_use]
    pub fn age_steps(&self, rank: u8) -> u32 {
        let days = u32::from(self.today.saturating_sub(rank));
        days * u32::from(self.day_steps) + u32::from(self.steps)
    }

    /// The earliest date that there is; today's if nothing was visited.
    fn find_oldest(&mut self) {
        let dates = self.dates.as_flattened().iter().copied();
        self.oldest = dates.filter(|&date| date != 0).min().unwrap_or(self.today);
    }

    /// Let the days begin earlier, or be longer.
    fn make_room(&mut self) {
        let unused = self.oldest - 1;
        let is_enough = unused >= u8::MAX / 4;
        if !is_enough {
            self.day_steps = self.day_steps.saturating_mul(2);
        }
        let earlier = |date: u8| match date {
            0 => 0,
            date if is_enough => date - unused,
            date => date.div_ceil(2),
        };
        for date in self.dates.as_flattened_mut() {
            *date = earlier(*date);
        }
        (self.today, self.oldest) = (earlier(self.today), earlier(self.oldest));
    }

    /// The tile's place of a cell, and the part in it. Beyond every place without a box.
    fn place(&self, cell: Cell) -> (usize, usize) {
        let (x, y) = (cell.x >> SHIFT, cell.y >> SHIFT);
        let slot = self.slots.slot(x >> 1, y >> 1);
        (slot, ((y & 1) << 1 | (x & 1)) as usize)
    }
}

impl<const SLOTS: usize> Default for Rails<SLOTS> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::{Rails, UNVISITED};
    use crate::geometry::Cell;

    fn place(k: i32) -> Cell {
        Cell {
            x: 16 * (k % 8) - 50,
            y: 16 * (k / 8) + 7,
        }
    }

    fn rails() -> Rails<16> {
        let mut rails = Rails::new();
        rails.reset((4, 4));
        rails
    }

    #[test]
    fn the_newest_is_one_the_oldest_nought_and_the_unvisited_below() {
        let mut rails = rails();
        assert_eq!(rails.potential(place(0)), UNVISITED);
        for k in 0..5 {
            assert!(rails.visit(place(k)), "for the first time");
            assert!(!rails.visit(place(k)));
            for _ in 0..8 {
                rails.pass();
            }
        }
        let of = |k| rails.potential(place(k));
        // Two days from one to the next; the last was two days ago.
        assert_eq!([0, 1, 2, 3, 4].map(of), [0.0, 0.2, 0.4, 0.6, 0.8]);
        assert_eq!(of(5), UNVISITED);
    }

    #[test]
    fn ages_are_counted_in_steps_whatever_the_days_are() {
        let mut rails = rails();
        rails.visit(place(0));
        for steps in 1..=4_000 {
            rails.pass();
            let age = rails.age_steps(rails.rank(place(0)));
            let day = u32::from(rails.day_steps);
            assert!(age.abs_diff(steps) <= day, "{age} after {steps} steps");
        }
        assert!(rails.day_steps > super::DAY_STEPS, "the past was pressed");
    }

    #[test]
    fn all_equally_old_are_as_the_newest() {
        let mut rails = rails();
        rails.visit(place(3));
        assert_eq!(rails.potential(place(3)), 1.0);
    }

    /// Round and round for a week: the order of visits is what it was, coarsely, however often the past was pressed.
    #[test]
    fn the_order_stands_for_ever() {
        let mut rails = rails();
        let stay = 50;
        for round in 0..1_000 {
            for k in 0..20 {
                rails.visit(place(k));
                for _ in 0..stay {
                    rails.pass();
                }
                if round > 0 && k == 19 {
                    let p = (0..20).map(|k| rails.potential(place(k)));
                    let p: std::vec::Vec<f32> = p.collect();
                    assert!(p.is_sorted(), "round {round}: {p:?}");
                    assert!(p[0] == 0.0 && p[19] > 0.85, "round {round}: {p:?}");
                }
            }
        }
        assert!(rails.day_steps < 40, "days of {} steps", rails.day_steps);
    }

    #[test]
    fn without_a_box_nothing_is_visited() {
        let mut rails: Rails<16> = Rails::new();
        assert!(!rails.visit(place(0)));
        assert_eq!(rails.potential(place(0)), UNVISITED);
    }
}

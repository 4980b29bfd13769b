//! Rails: when the robot last visited the centre cells, and the potential that follows
//! \[Maffei14, eq. 3\].
//!
//! ```text
//! p = (s − s_oldest) / (s_newest − s_oldest)     visited in step s: the newest 1, the oldest 0
//! p = −0.5                                       not visited yet
//! ```
//!
//! Departs from \[Maffei14, IV\], where every centre cell has its own step: the skeleton changes
//! all the time, so a *place* of 1.6 × 1.6 m of the map has one byte, a *stamp*, whatever centre
//! cells are in it. Centre lines that a wall parts do not share a place. A stamp counts *ticks* of
//! several steps. When the ticks run out, all stamps become lower by as much as the oldest allows,
//! or are halved and the ticks become twice as long. So the robot can go on for ever.
//!
//! The oldest is that of the centre cells of the last skeleton. A place that has none any more
//! keeps its stamp. It counts as equally old as the oldest if centre cells come back.
//!
//! Invariants: 0 is not visited; no stamp is later than now; the order of two visits never
//! reverses.
//!
//! Units: map cells; ticks of a growing number of steps.

use crate::geometry::Cell;
use crate::grid::{Shifts, TileMap, masked, masked_mut};

/// Side of a place as a power of two, cells.
const PLACE_SHIFT: i32 = 4;
/// Side of a place, which has one stamp, cells.
pub(crate) const PLACE_CELLS: i32 = 1 << PLACE_SHIFT;
/// Ticks by which the stamps must be lowered at least, or they are halved: a quarter of all, so
/// that this is rare. A bound of the stamps' range, not tuned.
const LEAST_ROOM: u8 = u8::MAX / 4;
/// Potential of a centre cell that was not visited yet.
pub(super) const UNVISITED: f32 = -0.5;

/// The stamps of up to `SLOTS` tiles, 4 bytes each: as many as the map holds.
#[derive(Debug)]
pub(crate) struct Rails<const SLOTS: usize> {
    stamps: TileMap<[u8; 4], SLOTS>,
    now: u8,
    /// The earliest stamp of a centre cell, at most now.
    oldest: u8,
    /// Steps of a tick, and of the current one so far.
    tick_steps: u16,
    steps: u16,
}

impl<const SLOTS: usize> Rails<SLOTS> {
    /// No place is visited. A tick takes `tick_ms` at first, in whole steps of `period_ms`.
    pub(crate) const fn new(tick_ms: u32, period_ms: u32) -> Self {
        let tick_steps = tick_ms.checked_div(period_ms);
        Self {
            stamps: TileMap::new([0; 4]),
            now: 1,
            oldest: 1,
            tick_steps: match tick_steps {
                None | Some(0) => 1,
                Some(steps) if steps > u16::MAX as u32 => u16::MAX,
                Some(steps) => steps as u16,
            },
            steps: 0,
        }
    }

    /// Counts a step.
    pub(super) fn step(&mut self) {
        self.steps += 1;
        if self.steps < self.tick_steps {
            return;
        }
        self.steps = 0;
        if self.now == u8::MAX {
            self.make_room();
        }
        self.now += 1;
    }

    /// Stamps the place of a centre cell. Returns true if it was never visited before.
    pub(super) fn visit(&mut self, cell: Cell) -> bool {
        let now = self.now;
        let (tile, part) = place(cell);
        let stamps = self.stamps.get_or_add(tile, [0; 4]);
        stamps.is_some_and(|stamps| core::mem::replace(masked_mut(stamps, part), now) == 0)
    }

    /// Makes the place of a centre cell count as never visited.
    pub(super) fn forget(&mut self, cell: Cell) {
        let (tile, part) = place(cell);
        if let Some(stamps) = self.stamps.get_or_add(tile, [0; 4]) {
            *masked_mut(stamps, part) = 0;
        }
    }

    /// Moves each place to the one that holds its middle then. Of several, the last visit counts.
    /// `spare` is memory.
    pub(super) fn shift(&mut self, shifts: Shifts<'_>, spare: &mut [u32]) {
        if shifts.is_empty() {
            return;
        }
        self.stamps.rebuild(spare, |stamps, (x, y), old: [u8; 4]| {
            for (k, stamp) in (0..).zip(old) {
                let middle = Cell {
                    x: (x << 1 | k & 1) * PLACE_CELLS + PLACE_CELLS / 2,
                    y: (y << 1 | k >> 1) * PLACE_CELLS + PLACE_CELLS / 2,
                };
                if stamp == 0 {
                    continue;
                }
                let (tile, part) = place(shifts.moved(middle));
                if let Some(into) = stamps.get_or_add(tile, [0; 4]) {
                    let into = masked_mut(into, part);
                    *into = stamp.max(*into);
                }
            }
        });
    }

    /// Takes the earliest stamp of a centre cell that was visited; `None` if none was.
    pub(super) fn set_oldest(&mut self, stamp: Option<u8>) {
        self.oldest = stamp.map_or(self.now, |stamp| stamp.clamp(1, self.now));
    }

    /// Returns the stamp of the last visit to a map cell's place; 0 if there was none. The older of
    /// two places has the lower stamp.
    #[must_use]
    pub(crate) fn stamp(&self, cell: Cell) -> u8 {
        let (tile, part) = place(cell);
        let stamps = self.stamps.get(tile);
        stamps.map_or(0, |stamps| *masked(stamps, part))
    }

    /// Returns true if the place of a centre cell was visited.
    pub(super) fn is_visited(&self, cell: Cell) -> bool {
        self.stamp(cell) != 0
    }

    /// Returns the potential of a centre cell \[Maffei14, eq. 3\], −0.5 or 0 to 1; 1 where all are
    /// equally old.
    pub(super) fn potential(&self, cell: Cell) -> f32 {
        match (self.stamp(cell), self.now - self.oldest) {
            (0, _) => UNVISITED,
            (_, 0) => 1.0,
            (stamp, span) => f32::from(stamp.saturating_sub(self.oldest)) / f32::from(span),
        }
    }

    /// Returns the steps since a visit with this stamp; for 0, those that the stamps reach back.
    pub(super) fn age_steps(&self, stamp: u8) -> u32 {
        let ticks = u32::from(self.now.saturating_sub(stamp));
        ticks * u32::from(self.tick_steps) + u32::from(self.steps)
    }

    /// Lowers all stamps to the bottom, or halves them and makes the ticks twice as long.
    fn make_room(&mut self) {
        let unused = self.oldest - 1;
        let is_enough = unused >= LEAST_ROOM;
        if !is_enough {
            self.tick_steps = self.tick_steps.saturating_mul(2);
        }
        let lower = |stamp: u8| match stamp {
            0 => 0,
            // Places without centre cells may be older than the oldest.
            stamp if is_enough => stamp.saturating_sub(unused).max(1),
            stamp => stamp.div_ceil(2),
        };
        for stamp in self.stamps.values_mut().as_flattened_mut() {
            *stamp = lower(*stamp);
        }
        (self.now, self.oldest) = (lower(self.now), lower(self.oldest));
    }
}

/// Returns a cell's tile and the number of the cell's place in it.
const fn place(cell: Cell) -> ((i32, i32), usize) {
    let (x, y) = (cell.x >> PLACE_SHIFT, cell.y >> PLACE_SHIFT);
    ((x >> 1, y >> 1), ((y & 1) << 1 | (x & 1)) as usize)
}

#[cfg(test)]
mod tests {
    use super::{Rails, UNVISITED};
    use crate::config::TdbvpTuning;
    use crate::geometry::Cell;
    use crate::grid::{Shifts, shift};

    const PERIOD_MS: u32 = 200;
    /// Steps of a tick at first.
    const FIRST_STEPS: u16 = (TdbvpTuning::DEFAULT.first_tick_ms / PERIOD_MS) as u16;

    fn place(k: i32) -> Cell {
        Cell {
            x: 16 * (k % 8) - 50,
            y: 16 * (k / 8) + 7,
        }
    }

    /// The centre cells are those of the places.
    fn find_oldest(rails: &mut Rails<16>, places: core::ops::Range<i32>) {
        let stamps = places.map(|k| rails.stamp(place(k)));
        rails.set_oldest(stamps.filter(|&stamp| stamp != 0).min());
    }

    fn rails() -> Rails<16> {
        Rails::new(TdbvpTuning::DEFAULT.first_tick_ms, PERIOD_MS)
    }

    #[test]
    fn the_newest_is_one_the_oldest_nought_and_the_unvisited_below() {
        let mut rails = rails();
        assert_eq!(rails.potential(place(0)), UNVISITED);
        for k in 0..5 {
            assert!(rails.visit(place(k)), "for the first time");
            assert!(!rails.visit(place(k)));
            for _ in 0..8 {
                rails.step();
            }
        }
        find_oldest(&mut rails, 0..8);
        let of = |k| rails.potential(place(k));
        // Two ticks from one to the next; the last was two ticks ago.
        assert_eq!([0, 1, 2, 3, 4].map(of), [0.0, 0.2, 0.4, 0.6, 0.8]);
        assert_eq!(of(5), UNVISITED);
    }

    #[test]
    fn ages_are_counted_in_steps_whatever_the_ticks_are() {
        let mut rails = rails();
        rails.visit(place(0));
        for steps in 1..=4_000 {
            rails.step();
            let age = rails.age_steps(rails.stamp(place(0)));
            let tick = u32::from(rails.tick_steps);
            assert!(age.abs_diff(steps) <= tick, "{age} after {steps} steps");
        }
        assert!(rails.tick_steps > FIRST_STEPS, "the stamps were halved");
    }

    #[test]
    fn a_tick_takes_as_long_at_every_period_in_whole_steps() {
        let steps = |tick_ms, period_ms| Rails::<16>::new(tick_ms, period_ms).tick_steps;
        assert_eq!(
            [100, 200, 400].map(|period_ms| steps(800, period_ms)),
            [8, 4, 2]
        );
        assert_eq!([steps(800, 300), steps(100, 400), steps(100, 0)], [2, 1, 1]);
    }

    #[test]
    fn a_place_without_centre_cells_does_not_count_for_the_oldest() {
        let mut rails = rails();
        for k in [0, 1, 2] {
            rails.visit(place(k));
            let steps = if k == 0 { 400 } else { 20 };
            (0..steps).for_each(|_| rails.step());
        }
        let of = |rails: &Rails<16>| [1, 2].map(|k| rails.potential(place(k)));
        find_oldest(&mut rails, 0..8);
        assert!(of(&rails)[0] > 0.9, "{:?}", of(&rails));
        find_oldest(&mut rails, 1..8);
        assert_eq!(of(&rails), [0.0, 0.5]);
        assert_eq!(
            rails.potential(place(0)),
            0.0,
            "centre cells that come back"
        );
    }

    #[test]
    fn a_place_without_centre_cells_does_not_make_the_ticks_longer() {
        let mut rails = rails();
        rails.visit(place(0));
        for _ in 0..1_000 {
            rails.visit(place(1));
            (0..20).for_each(|_| rails.step());
            find_oldest(&mut rails, 1..2);
        }
        assert_eq!(rails.tick_steps, FIRST_STEPS);
        assert_eq!(rails.stamp(place(0)), 1, "visited, as long ago as possible");
    }

    #[test]
    fn visits_go_with_their_tiles_and_the_last_one_counts() {
        let mut rails = rails();
        let at = |x| Cell { x, y: 20 };
        for x in [8, 40] {
            rails.visit(at(x));
            (0..40).for_each(|_| rails.step());
        }
        let [old, new] = [8, 40].map(|x| rails.stamp(at(x)));
        assert!(old < new);
        // Whole places.
        let mut moved = self::rails();
        moved.stamps.get_or_add((0, 0), [0, 0, old, 0]);
        moved.stamps.get_or_add((1, 0), [0, 0, new, 0]);
        let stamps = |rails: &Rails<16>| [8, 24, 40].map(|x| rails.stamp(at(x)));
        moved.shift(Shifts(&[shift((1, 0), (-16, 4))]), &mut [0; 9]);
        assert_eq!(stamps(&moved), [old, new, 0]);
        moved.shift(Shifts(&[shift((0, 0), (-3, 0))]), &mut [0; 9]);
        assert_eq!(stamps(&moved), [old, new, 0], "by less than half a place");
        moved.shift(Shifts(&[shift((0, 0), (16, 0))]), &mut [0; 9]);
        assert_eq!(stamps(&moved), [0, old, new]);
        moved.shift(Shifts(&[shift((1, 0), (-16, 0))]), &mut [0; 9]);
        assert_eq!(stamps(&moved), [0, new, 0], "the last visit");
    }

    #[test]
    fn all_equally_old_are_as_the_newest() {
        let mut rails = rails();
        rails.visit(place(3));
        assert_eq!(rails.potential(place(3)), 1.0);
    }

    /// Round and round for a week: the order of visits stays, coarsely, however often the stamps
    /// are lowered or halved.
    #[test]
    fn the_order_of_visits_stays_for_ever() {
        let mut rails = rails();
        let stay = 50;
        for round in 0..1_000 {
            for k in 0..20 {
                rails.visit(place(k));
                for _ in 0..stay {
                    rails.step();
                    find_oldest(&mut rails, 0..20);
                }
                if round > 0 && k == 19 {
                    let p = (0..20).map(|k| rails.potential(place(k)));
                    let p: std::vec::Vec<f32> = p.collect();
                    assert!(p.is_sorted(), "round {round}: {p:?}");
                    assert!(p[0] == 0.0 && p[19] > 0.85, "round {round}: {p:?}");
                }
            }
        }
        let steps = rails.tick_steps;
        assert!(steps < 40, "ticks of {steps} steps");
    }
}

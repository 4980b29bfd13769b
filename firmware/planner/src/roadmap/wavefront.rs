//! Breadth-first distances along the skeleton, with a queue of fixed size.
//!
//! The wave starts from any number of seeds at once and enters the set cells of the way,
//! 8-connected, level by level. It leaves distances modulo 3 in [`Residues`]: on centre cells, the
//! papers' potential of a point source amounts to these \[Jorge15, steps 3 and 5\].
//!
//! Cells wait for their turn in a ring. A cell that finds the ring full is reached all the same,
//! and its row is *noted*. After the cells of a level, the wave scans the noted rows for open cells
//! next to one of this level. That costs time and changes no distance, since a cell of an earlier
//! level with the same residue has no open neighbour left.
//!
//! Invariant between two calls: every reached cell with an open neighbour is in the ring or in a
//! noted row.
//!
//! Units: steps; sites of the plane.

use core::ops::RangeInclusive;

use crate::grid::bits::ones;
use crate::grid::{Plane, Site, at};
use crate::roadmap::residues::{Residue, Residues};

/// The memory that a wave runs on, lent for each call.
#[derive(Debug)]
pub struct WaveSpace<'a> {
    /// The cells that the wave may enter: the skeleton. A blocker is a cell taken out of it, see
    /// [`super::Barrier`].
    pub cells: Plane<'a>,
    /// The distances, in the shape of the cells.
    pub residues: Residues<'a>,
    /// The queue, an entry a word. Any length will do; more than 1,000 entries are rare.
    pub ring: &'a mut [u32],
}

/// The state of a wave.
#[derive(Clone, Debug)]
pub struct Wavefront {
    head: usize,
    len: usize,
    /// Residues of the present level and of the next.
    here: Residue,
    next: Residue,
    /// Rows with cells of the next level that found the ring full.
    noted: Rows,
}

/// A span of rows, empty when `first > last`.
#[derive(Clone, Copy, Debug)]
struct Rows {
    first: usize,
    last: usize,
}

impl Rows {
    const NONE: Self = Self {
        first: usize::MAX,
        last: 0,
    };

    const fn is_empty(self) -> bool {
        self.first > self.last
    }

    fn include(&mut self, row: usize) {
        self.first = self.first.min(row);
        self.last = self.last.max(row);
    }

    /// Returns the rows with one more at either end, of `rows` rows.
    fn widened(self, rows: usize) -> RangeInclusive<usize> {
        self.first.saturating_sub(1)..=(self.last + 1).min(rows - 1)
    }
}

impl Wavefront {
    /// Makes a wave without seeds.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            head: 0,
            len: 0,
            here: Residue::ZERO.next().next(),
            next: Residue::ZERO,
            noted: Rows::NONE,
        }
    }

    /// Starts anew: no cell is reached, and there is no seed.
    pub fn start(&mut self, space: &mut WaveSpace<'_>) {
        debug_assert_eq!(
            space.cells.shape(),
            space.residues.shape(),
            "unequal shapes"
        );
        *self = Self::new();
        space.residues.clear();
    }

    /// Lets the wave start from a cell too. Returns true if the cell is on the way and was not
    /// reached yet.
    pub fn seed(&mut self, space: &mut WaveSpace<'_>, site: Site) -> bool {
        let (row, word) = (usize::from(site.y), usize::from(site.x / 32));
        let index = space.cells.shape().index(row, word);
        index.is_some_and(|index| self.enter(space, index, site.bit(), (row, word)))
    }

    /// Runs the wave until it reaches `until` or has been everywhere.
    ///
    /// Distances are final where the wave has been, so a descent from `until` may begin at once. If
    /// `until` is not reached, no way leads there.
    pub fn run(&mut self, space: &mut WaveSpace<'_>, until: Option<Site>) {
        let is_met =
            |space: &WaveSpace<'_>| until.is_some_and(|site| space.residues.get(site).is_some());
        while !is_met(space) && !self.is_over() {
            self.run_level(space);
        }
    }

    /// Runs the wave for `levels` steps of distance. Seeds between two such calls start that much
    /// later than the first ones: a delay for goals of a higher cost.
    pub fn run_levels(&mut self, space: &mut WaveSpace<'_>, levels: u32) {
        for _ in 0..levels {
            if self.is_over() {
                return;
            }
            self.run_level(space);
        }
    }

    /// Calls `visit` with the cells of `marks` that the wave reached last, from which it goes on.
    /// After a full queue a cell may be called twice, or again with a later level.
    pub(crate) fn for_each_new(
        &self,
        space: &WaveSpace<'_>,
        marks: Plane<'_>,
        mut visit: impl FnMut(Site),
    ) {
        for offset in 0..self.len {
            let site = unpack(at(space.ring, self.place(space, offset)));
            if marks.get(site) {
                visit(site);
            }
        }
        if self.noted.is_empty() {
            return;
        }
        let shape = marks.shape();
        for row in self.noted.first..=self.noted.last {
            for word in 0..shape.words_per_row() {
                let reached = shape
                    .index(row, word)
                    .map_or(0, |index| space.residues.with(index, self.next));
                for bit in ones(reached & marks.word(row, word)) {
                    visit(Site {
                        x: (word * 32) as u16 + bit as u16,
                        y: row as u16,
                    });
                }
            }
        }
    }

    /// Expands the cells of the next level, which becomes the present one.
    fn run_level(&mut self, space: &mut WaveSpace<'_>) {
        (self.here, self.next) = (self.next, self.next.next());
        let noted = core::mem::replace(&mut self.noted, Rows::NONE);
        for _ in 0..self.len {
            let site = unpack(at(space.ring, self.head));
            self.head = self.place(space, 1);
            self.len -= 1;
            self.expand(space, site);
        }
        if noted.is_empty() {
            return;
        }
        for row in noted.widened(space.cells.shape().rows()) {
            for word in 0..space.cells.shape().words_per_row() {
                self.enter_from_around(space, row, word);
            }
        }
    }

    /// Returns true if the wave has been everywhere.
    pub(crate) const fn is_over(&self) -> bool {
        self.len == 0 && self.noted.is_empty()
    }

    /// Enters the open neighbours of a cell.
    fn expand(&mut self, space: &mut WaveSpace<'_>, site: Site) {
        let shape = space.cells.shape();
        let (per_row, rows) = (shape.words_per_row(), shape.rows());
        let (row, word) = (usize::from(site.y), usize::from(site.x / 32));
        let bit = site.bit();
        let window = bit << 1 | bit | bit >> 1;
        let index = row * per_row + word;
        if row != 0 {
            self.enter(space, index - per_row, window, (row - 1, word));
        }
        self.enter(space, index, window, (row, word));
        if row + 1 != rows {
            self.enter(space, index + per_row, window, (row + 1, word));
        }
        if bit == 1 && word != 0 {
            self.expand_into(space, (row, word - 1), 1 << 31);
        } else if bit == 1 << 31 && word + 1 != per_row {
            self.expand_into(space, (row, word + 1), 1);
        }
    }

    /// Enters the open cells in the column `mask` of the word beside a cell, in its row and those
    /// above and below.
    #[inline(never)]
    fn expand_into(&mut self, space: &mut WaveSpace<'_>, (row, word): (usize, usize), mask: u32) {
        for row in row.saturating_sub(1)..row + 2 {
            if let Some(index) = space.cells.shape().index(row, word) {
                self.enter(space, index, mask, (row, word));
            }
        }
    }

    /// Enters the open cells of `mask` in a word. Returns true if there are any.
    #[inline(always)]
    fn enter(
        &mut self,
        space: &mut WaveSpace<'_>,
        index: usize,
        mask: u32,
        place: (usize, usize),
    ) -> bool {
        let open = mask & at(space.cells.words(), index) & space.residues.unreached(index);
        if open != 0 {
            self.reach(space, index, open, place);
        }
        open != 0
    }

    /// Reaches the cells of `open` and queues them for the next level.
    #[inline(never)]
    fn reach(
        &mut self,
        space: &mut WaveSpace<'_>,
        index: usize,
        open: u32,
        (row, word): (usize, usize),
    ) {
        space.residues.reach(index, open, self.next);
        let mut rest = open;
        while rest != 0 {
            let column = word * 32 + rest.trailing_zeros() as usize;
            rest &= rest - 1;
            self.queue(space, row, column);
        }
    }

    /// Appends a cell to the ring; if that is full, notes its row.
    fn queue(&mut self, space: &mut WaveSpace<'_>, row: usize, column: usize) {
        let place = self.place(space, self.len);
        let full = self.len == space.ring.len();
        match space.ring.get_mut(place) {
            Some(entry) if !full => {
                *entry = (row << 16 | column) as u32;
                self.len += 1;
            }
            _ => self.noted.include(row),
        }
    }

    /// Returns the place of the ring's `offset`-th entry.
    fn place(&self, space: &WaveSpace<'_>, offset: usize) -> usize {
        let place = self.head + offset;
        if place < space.ring.len() {
            place
        } else {
            place - space.ring.len()
        }
    }

    /// Enters the open cells of a word that have a neighbour of the present level.
    fn enter_from_around(&mut self, space: &mut WaveSpace<'_>, row: usize, word: usize) {
        let shape = space.cells.shape();
        let index = row * shape.words_per_row() + word;
        if at(space.cells.words(), index) & space.residues.unreached(index) == 0 {
            return;
        }
        let mut near = 0;
        for row in row.saturating_sub(1)..(row + 2).min(shape.rows()) {
            let level = |word: usize| {
                let index = shape.index(row, word);
                index.map_or(0, |index| space.residues.with(index, self.here))
            };
            let here = level(word);
            near |= here | here << 1 | here >> 1;
            near |= level(word.wrapping_sub(1)) >> 31 | level(word + 1) << 31;
        }
        self.enter(space, index, near, (row, word));
    }
}

impl Default for Wavefront {
    fn default() -> Self {
        Self::new()
    }
}

const fn unpack(entry: u32) -> Site {
    Site {
        x: entry as u16,
        y: (entry >> 16) as u16,
    }
}

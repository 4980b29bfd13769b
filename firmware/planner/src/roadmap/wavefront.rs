//! Breadth-first distances along the skeleton, with a queue of fixed size.
//!
//! The wave starts from any number of seeds at once and enters the set cells of the way,
//! 8-connected, level by level. It leaves distances modulo 3 in [`Residues`]: on centre cells, the
//! papers' potential of a point source amounts to these \[Jorge15, steps 3 and 5\].
//!
//! Cells wait for their turn in a ring. A cell that finds the ring full is reached all the same,
//! and its page is *noted*. With the cells of a level, the wave expands all cells of the noted
//! pages that have the level's residue. That costs time and changes no distance, since a cell of an
//! earlier level with the same residue has no open neighbour left.
//!
//! Invariant between two calls: every reached cell with an open neighbour is in the ring or in a
//! noted page.
//!
//! Units: steps; sites of the plane.

use core::ops::Range;

use crate::grid::bits::ones;
use crate::grid::{PAGE_SIDE, PAGE_WORDS, Plane, Site, at};
use crate::roadmap::residues::{Residue, Residues};

/// The memory that a wave runs on, lent for each call.
#[derive(Debug)]
pub struct WaveSpace<'a> {
    /// The cells that the wave may enter: the skeleton. A blocker is a cell taken out of it, see
    /// [`super::Barrier`].
    pub cells: Plane<'a>,
    /// The distances, over the tiles of the cells.
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
    /// Pages with cells of the next level that found the ring full.
    noted: Pages,
}

/// A span of pages by their places, empty when `first > last`.
#[derive(Clone, Copy, Debug)]
struct Pages {
    first: usize,
    last: usize,
}

impl Pages {
    const NONE: Self = Self {
        first: usize::MAX,
        last: 0,
    };

    const fn is_empty(self) -> bool {
        self.first > self.last
    }

    fn include(&mut self, page: usize) {
        self.first = self.first.min(page);
        self.last = self.last.max(page);
    }

    /// Returns the indices of the pages' words.
    const fn words(self) -> Range<usize> {
        if self.is_empty() {
            return 0..0;
        }
        self.first * PAGE_WORDS..(self.last + 1) * PAGE_WORDS
    }
}

/// A cell: the index of its word, and its bit.
#[derive(Clone, Copy, Debug)]
struct Entry {
    index: usize,
    bit: u32,
}

impl Entry {
    const fn packed(self) -> u32 {
        (self.index as u32) << 5 | self.bit
    }

    const fn unpacked(word: u32) -> Self {
        Self {
            index: (word >> 5) as usize,
            bit: word & 31,
        }
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
            noted: Pages::NONE,
        }
    }

    /// Starts anew: no cell is reached, and there is no seed.
    pub fn start(&mut self, space: &mut WaveSpace<'_>) {
        *self = Self::new();
        space.residues.clear();
    }

    /// Lets the wave start from a cell too. Returns true if the cell is on the way and was not
    /// reached yet.
    pub fn seed(&mut self, space: &mut WaveSpace<'_>, site: Site) -> bool {
        let index = space.cells.tiling().index(site);
        index.is_some_and(|index| self.enter(space, index, site.bit()))
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
        let tiling = marks.tiling();
        let mut visit = |Entry { index, bit }| {
            if at(marks.words(), index) >> bit & 1 != 0 {
                visit(tiling.site(index, bit));
            }
        };
        for offset in 0..self.len {
            visit(Entry::unpacked(at(space.ring, self.place(space, offset))));
        }
        for index in self.noted.words() {
            for bit in ones(space.residues.with(index, self.next)) {
                visit(Entry { index, bit });
            }
        }
    }

    /// Expands the cells of the next level, which becomes the present one.
    fn run_level(&mut self, space: &mut WaveSpace<'_>) {
        (self.here, self.next) = (self.next, self.next.next());
        let noted = core::mem::replace(&mut self.noted, Pages::NONE);
        for _ in 0..self.len {
            let entry = Entry::unpacked(at(space.ring, self.head));
            self.head = self.place(space, 1);
            self.len -= 1;
            self.expand(space, entry);
        }
        for index in noted.words() {
            for bit in ones(space.residues.with(index, self.here)) {
                self.expand(space, Entry { index, bit });
            }
        }
    }

    /// Returns true if the wave has been everywhere.
    pub(crate) const fn is_over(&self) -> bool {
        self.len == 0 && self.noted.is_empty()
    }

    /// Enters the open neighbours of a cell.
    fn expand(&mut self, space: &mut WaveSpace<'_>, entry: Entry) {
        const LAST: u32 = PAGE_SIDE as u32 - 1;
        let (place, k) = (entry.index / PAGE_WORDS, entry.index % PAGE_WORDS);
        let (column, row) = (entry.bit & LAST, 2 * k as u32 + (entry.bit >> 4));
        let columns = (7 << column) >> 1 & 0xffff;
        self.enter_rows(space, place, row, columns);
        let tiling = space.cells.tiling();
        let side = match column {
            0 => Some((-1, 1 << LAST)),
            LAST => Some((1, 1)),
            _ => None,
        };
        if let Some((side, mask)) = side {
            self.enter_rows(space, tiling.beside(place, side, 0), row, mask);
        }
        // The row beyond: the last one of the tile in the north, or the first one in the south.
        let (beyond, word, shift) = match row {
            0 => (-1, PAGE_WORDS - 1, 16),
            LAST => (1, 0, 0),
            _ => return,
        };
        let there = tiling.beside(place, 0, beyond);
        self.enter(space, there * PAGE_WORDS + word, columns << shift);
        if let Some((side, mask)) = side {
            let there = tiling.beside(place, side, beyond);
            self.enter(space, there * PAGE_WORDS + word, mask << shift);
        }
    }

    /// Enters the open cells in these columns of a row of a page, and of the rows above and below
    /// it in the page.
    fn enter_rows(&mut self, space: &mut WaveSpace<'_>, place: usize, row: u32, columns: u32) {
        let k = (row / 2) as usize;
        let index = place * PAGE_WORDS + k;
        self.enter(space, index, columns | columns << 16);
        let is_lower = row & 1 == 1;
        if is_lower && k + 1 < PAGE_WORDS {
            self.enter(space, index + 1, columns);
        } else if !is_lower && k > 0 {
            self.enter(space, index - 1, columns << 16);
        }
    }

    /// Enters the open cells of `mask` in a word. Returns true if there are any.
    #[inline]
    fn enter(&mut self, space: &mut WaveSpace<'_>, index: usize, mask: u32) -> bool {
        let open = mask & at(space.cells.words(), index) & space.residues.unreached(index);
        if open != 0 {
            self.reach(space, index, open);
        }
        open != 0
    }

    /// Reaches the cells of `open` and queues them for the next level.
    #[inline(never)]
    fn reach(&mut self, space: &mut WaveSpace<'_>, index: usize, open: u32) {
        space.residues.reach(index, open, self.next);
        for bit in ones(open) {
            self.queue(space, Entry { index, bit });
        }
    }

    /// Appends a cell to the ring; if that is full, notes its page.
    fn queue(&mut self, space: &mut WaveSpace<'_>, entry: Entry) {
        let place = self.place(space, self.len);
        let full = self.len == space.ring.len();
        match space.ring.get_mut(place) {
            Some(word) if !full => {
                *word = entry.packed();
                self.len += 1;
            }
            _ => self.noted.include(entry.index / PAGE_WORDS),
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
}

impl Default for Wavefront {
    fn default() -> Self {
        Self::new()
    }
}

//! Breadth-first distances along the skeleton, in instalments and in a queue of fixed size.
//!
//! The wave starts from any number of seeds at once and enters the set cells of the way, 8-connected, level by level.
//! It leaves distances modulo 3 in [`Residues`]: what the papers' potential from a point source amounts to on centre
//! cells [Jorge15, steps 3 and 5]. Cells wait for their turn in a ring. A cell that finds the ring full is not lost:
//! it is reached, and its row noted; when the cells of its level have had their turn, the noted rows are gone through
//! for open cells next to one of this level. That costs time and changes no distance, since a cell of an earlier
//! level with the same residue has no open neighbour left.
//!
//! Invariant between two calls: every reached cell with an open neighbour is in the ring or in a noted row.

use crate::grid::{Plane, Site, at};
use crate::roadmap::Progress;
use crate::roadmap::residues::{Residue, Residues};

/// What a wave runs on, lent for each call.
#[derive(Debug)]
pub struct WaveSpace<'a> {
    /// Where the wave may go: the skeleton. A blocker is a cell taken out of it, see [`super::Barrier`].
    pub way: Plane<'a>,
    /// The distances; of the same shape as the way.
    pub residues: Residues<'a>,
    /// The queue, an entry a word. Any length is right, some 1,000 are rarely exceeded.
    pub ring: &'a mut [u32],
}

/// The state of a wave.
#[derive(Clone, Debug)]
pub struct Wavefront {
    head: usize,
    len: usize,
    /// Entries of the present level that still wait.
    left: usize,
    /// Residues of the present level and of the next.
    here: Residue,
    next: Residue,
    /// Rows still to be gone through for the present level, and the first word of the first of them.
    rescan: Rows,
    word: usize,
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

    /// With a row more at either end, within `rows` rows.
    fn widened(self, rows: usize) -> Self {
        if self.is_empty() {
            return self;
        }
        Self {
            first: self.first.saturating_sub(1),
            last: (self.last + 1).min(rows - 1),
        }
    }
}

impl Wavefront {
    /// A wave that was not started: nothing to do.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            head: 0,
            len: 0,
            left: 0,
            here: Residue::ZERO.next().next(),
            next: Residue::ZERO,
            rescan: Rows::NONE,
            word: 0,
            noted: Rows::NONE,
        }
    }

    /// Begin anew: nothing is reached, no seed yet.
    pub fn start(&mut self, space: &mut WaveSpace<'_>) {
        debug_assert_eq!(space.way.shape(), space.residues.shape(), "unequal shapes");
        *self = Self::new();
        space.residues.clear();
    }

    /// Let the wave start from a cell too; whether it is on the way and was not a seed yet. Only between
    /// [`Self::start`] and the first [`Self::advance`].
    pub fn seed(&mut self, space: &mut WaveSpace<'_>, site: Site) -> bool {
        let (row, word) = (usize::from(site.y), usize::from(site.x / 32));
        self.seed_word(space, row, word, site.bit()) == 1
    }

    /// Let the wave start from the cells of `mask` in a word of the way; how many of them were new. Only between
    /// [`Self::start`] and the first [`Self::advance`].
    pub fn seed_word(
        &mut self,
        space: &mut WaveSpace<'_>,
        row: usize,
        word: usize,
        mask: u32,
    ) -> u32 {
        match space.way.shape().index(row, word) {
            Some(index) => self.enter(space, index, mask, (row, word)),
            None => 0,
        }
    }

    /// Go on until `until` is reached, the wave has been everywhere, or `budget` units of work are done.
    ///
    /// A unit is a cell taken from the queue, or a word of a noted row. Where the wave has come, distances are final,
    /// so a descent from `until` may begin at once. Done while `until` is not reached means that no way leads there.
    pub fn advance(
        &mut self,
        space: &mut WaveSpace<'_>,
        until: Option<Site>,
        budget: u32,
    ) -> Progress {
        let mut left = budget;
        loop {
            let met = until.is_some_and(|site| space.residues.get(site).is_some());
            if met || self.is_over() {
                return Progress::Done { left };
            }
            if !self.run_queue(space, &mut left) || !self.run_rows(space, &mut left) {
                return Progress::Pending;
            }
            self.end_level(space);
        }
    }

    /// Go on for `levels` steps of distance. What is seeded between two such calls starts that much later than the first
    /// seeds: a handicap for goals that are to be preferred less.
    pub fn advance_levels(&mut self, space: &mut WaveSpace<'_>, levels: u32) {
        let mut left = u32::MAX;
        for _ in 0..levels {
            if self.is_over() {
                return;
            }
            self.run_queue(space, &mut left);
            self.run_rows(space, &mut left);
            self.end_level(space);
        }
    }

    /// Everything of the present level has had its turn.
    fn end_level(&mut self, space: &WaveSpace<'_>) {
        self.left = self.len;
        self.rescan = self.noted.widened(space.way.shape().rows());
        self.noted = Rows::NONE;
        (self.here, self.next) = (self.next, self.next.next());
    }

    /// Give up the ring: what waits in it is noted by row, so that its memory may serve elsewhere until the next call.
    pub fn park(&mut self, space: &WaveSpace<'_>) {
        let rows = space.way.shape().rows();
        let mut present = Rows::NONE;
        for place in 0..self.len {
            let row = usize::from(unpack(at(space.ring, self.place(space, place))).y);
            if place < self.left {
                present.include(row);
            } else {
                self.noted.include(row);
            }
        }
        let present = present.widened(rows);
        if !present.is_empty() {
            self.rescan.include(present.first);
            self.rescan.include(present.last);
        }
        (self.head, self.len, self.left) = (0, 0, 0);
    }

    const fn is_over(&self) -> bool {
        self.len == 0 && self.rescan.is_empty() && self.noted.is_empty()
    }

    /// Expand the present level's cells in the ring, as far as the budget lasts; whether all were.
    fn run_queue(&mut self, space: &mut WaveSpace<'_>, left: &mut u32) -> bool {
        while self.left != 0 {
            if *left == 0 {
                return false;
            }
            *left -= 1;
            let site = unpack(at(space.ring, self.head));
            self.head = self.place(space, 1);
            self.len -= 1;
            self.left -= 1;
            self.expand(space, site);
        }
        true
    }

    /// Enter what is open around a cell.
    fn expand(&mut self, space: &mut WaveSpace<'_>, site: Site) {
        let shape = space.way.shape();
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

    /// Enter what is open in the column `mask` of the word beside a cell, in its row and the rows around.
    #[inline(never)]
    fn expand_into(&mut self, space: &mut WaveSpace<'_>, (row, word): (usize, usize), mask: u32) {
        for row in row.saturating_sub(1)..row + 2 {
            if let Some(index) = space.way.shape().index(row, word) {
                self.enter(space, index, mask, (row, word));
            }
        }
    }

    /// Enter the open cells of `mask` in a word; how many.
    #[inline(always)]
    fn enter(
        &mut self,
        space: &mut WaveSpace<'_>,
        index: usize,
        mask: u32,
        place: (usize, usize),
    ) -> u32 {
        let open = mask & at(space.way.words(), index) & space.residues.unreached(index);
        if open != 0 {
            self.reach(space, index, open, place);
        }
        open.count_ones()
    }

    /// Reach the cells of `open` and queue them for the next level.
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

    /// Append a cell to the ring, or note its row.
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

    /// Where the ring has its `offset`-th entry.
    fn place(&self, space: &WaveSpace<'_>, offset: usize) -> usize {
        let place = self.head + offset;
        if place < space.ring.len() {
            place
        } else {
            place - space.ring.len()
        }
    }

    /// Go through the rows around the noted ones, as far as the budget lasts; whether all were.
    fn run_rows(&mut self, space: &mut WaveSpace<'_>, left: &mut u32) -> bool {
        while !self.rescan.is_empty() {
            while self.word < space.way.shape().words_per_row() {
                if *left == 0 {
                    return false;
                }
                *left -= 1;
                self.enter_from_around(space, self.rescan.first, self.word);
                self.word += 1;
            }
            self.rescan.first += 1;
            self.word = 0;
        }
        true
    }

    /// Enter the open cells of a word that have a neighbour of the present level.
    fn enter_from_around(&mut self, space: &mut WaveSpace<'_>, row: usize, word: usize) {
        let shape = space.way.shape();
        let index = row * shape.words_per_row() + word;
        if at(space.way.words(), index) & space.residues.unreached(index) == 0 {
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

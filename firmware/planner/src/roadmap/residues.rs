//! Distances modulo 3, two bits a cell, and the way down them.
//!
//! The distances of neighbouring reached cells differ by at most one step. So the residue of a
//! neighbour's distance says if it is nearer, as far, or farther, and two bits are enough for a
//! descent of any length. 3 means not reached.
//!
//! Units: steps along the plane, a diagonal one counting as one.

use crate::grid::{Site, Tiling, TooSmall};

/// The residue of a cell that was not reached.
const UNREACHED: u8 = 3;

/// The distances of a plane's cells modulo 3.
///
/// Word i of the plane has the pair i: low bits, then high bits. Invariant: there are as many pairs
/// as words.
#[derive(Debug)]
pub struct Residues<'a> {
    tiling: Tiling<'a>,
    pairs: &'a mut [[u32; 2]],
}

impl<'a> Residues<'a> {
    /// Makes residues over the first pairs of `pairs`, which keep their values.
    ///
    /// # Errors
    /// If there are fewer pairs than a plane of these tiles has words.
    pub fn new(tiling: Tiling<'a>, pairs: &'a mut [[u32; 2]]) -> Result<Self, TooSmall> {
        let (needs, has) = (tiling.words(), pairs.len());
        let pairs = pairs.get_mut(..needs).ok_or(TooSmall { needs, has })?;
        Ok(Self { tiling, pairs })
    }

    /// Returns the tiles of the plane.
    #[must_use]
    pub const fn tiling(&self) -> Tiling<'a> {
        self.tiling
    }

    /// Returns the distance modulo 3; `None` if the wave did not reach the cell.
    #[must_use]
    pub fn get(&self, site: Site) -> Option<u8> {
        let residue = self.residue(self.tiling.index(site)?, site);
        (residue != UNREACHED).then_some(residue)
    }

    /// Returns the residue of a site whose word has this index.
    fn residue(&self, index: usize, site: Site) -> u8 {
        let [low, high] = self.pair(index).map(|word| word & site.bit() != 0);
        u8::from(low) | u8::from(high) << 1
    }

    /// Returns the neighbour one step nearer to the wave's seeds: of several the first in the order
    /// of [`Site::neighbours`], which has sides before corners. `None` at a seed, and if the wave
    /// did not reach the cell.
    #[must_use]
    pub fn descend(&self, from: Site) -> Option<Site> {
        let mut finder = self.tiling.finder();
        let mut residue = |site| self.residue(finder.index(site), site);
        let here = residue(from);
        if here == UNREACHED {
            return None;
        }
        let nearer = (here + 2) % 3;
        from.neighbours().find(|&near| residue(near) == nearer)
    }

    /// Returns the way from a cell down to a seed, without the cell itself.
    #[must_use]
    pub fn descent(&self, from: Site) -> Descent<'_> {
        Descent {
            residues: self,
            at: from,
        }
    }

    /// Marks all cells as not reached.
    pub(super) fn clear(&mut self) {
        self.pairs.fill([u32::MAX; 2]);
    }

    /// Returns the low and high bits of a word; outside, those of cells not reached.
    #[inline(always)]
    pub(super) fn pair(&self, index: usize) -> [u32; 2] {
        self.pairs.get(index).copied().unwrap_or([u32::MAX; 2])
    }

    /// Returns the cells of a word that are not reached.
    #[inline(always)]
    pub(crate) fn unreached(&self, index: usize) -> u32 {
        let [low, high] = self.pair(index);
        low & high
    }

    /// Gives the cells of `mask` that are not reached a residue.
    #[inline(always)]
    pub(super) fn reach(&mut self, index: usize, mask: u32, residue: Residue) {
        if let Some([low, high]) = self.pairs.get_mut(index) {
            *low &= !(mask & residue.clears_low);
            *high &= !(mask & residue.clears_high);
        }
    }

    /// Returns the cells of a word with a residue.
    #[inline(always)]
    pub(super) fn with(&self, index: usize, residue: Residue) -> u32 {
        let [low, high] = self.pair(index);
        (low ^ residue.clears_low) & (high ^ residue.clears_high)
    }
}

/// A residue 0, 1 or 2, as the bits that it clears in the residue of a cell not reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Residue {
    clears_low: u32,
    clears_high: u32,
}

impl Residue {
    pub(super) const ZERO: Self = Self {
        clears_low: u32::MAX,
        clears_high: u32::MAX,
    };

    /// Returns the residue of one step more.
    pub(super) const fn next(self) -> Self {
        // 0 = (0, 0) → 1 = (1, 0) → 2 = (0, 1) → 0.
        Self {
            clears_low: !(self.clears_low & self.clears_high),
            clears_high: self.clears_low,
        }
    }
}

/// The cells of a way down, see [`Residues::descent`]: as many as the start has steps to a seed.
#[derive(Clone, Debug)]
pub struct Descent<'d> {
    residues: &'d Residues<'d>,
    at: Site,
}

impl Iterator for Descent<'_> {
    type Item = Site;

    fn next(&mut self) -> Option<Site> {
        self.at = self.residues.descend(self.at)?;
        Some(self.at)
    }
}

//! Distances modulo 3, two bits a cell, and the way down them.
//!
//! Neighbouring reached cells differ by at most one step, so the residue of a neighbour's distance tells whether it is
//! nearer, as far, or farther: two bits hold what a descent needs, however long the way. 3 means not reached.
//!
//! Units: steps along the plane, a diagonal one counting as one.

use crate::grid::{Shape, ShapeError, Site};

/// The residue of a cell not reached.
const UNREACHED: u8 = 3;

/// Distances modulo 3 of a plane's cells.
///
/// Word i of the plane has the pair i: low bits, then high bits. Invariant: there are as many pairs as words.
#[derive(Debug)]
pub struct Residues<'a> {
    shape: Shape,
    pairs: &'a mut [[u32; 2]],
}

impl<'a> Residues<'a> {
    /// Residues over the first pairs of `pairs`, which keep their values.
    ///
    /// # Errors
    /// When there are fewer pairs than the shape has words.
    pub fn new(shape: Shape, pairs: &'a mut [[u32; 2]]) -> Result<Self, ShapeError> {
        let (needs, has) = (shape.words(), pairs.len());
        let pairs = pairs
            .get_mut(..needs)
            .ok_or(ShapeError::TooLarge { needs, has })?;
        Ok(Self { shape, pairs })
    }

    /// Rows and words.
    #[must_use]
    pub const fn shape(&self) -> Shape {
        self.shape
    }

    /// The distance modulo 3, or `None` where the wave did not come.
    #[must_use]
    pub fn get(&self, site: Site) -> Option<u8> {
        let index = self
            .shape
            .index(usize::from(site.y), usize::from(site.x / 32))?;
        let [low, high] = self.pair(index);
        let bit = site.x & 31;
        let residue = (low >> bit & 1) | (high >> bit & 1) << 1;
        (residue as u8 != UNREACHED).then_some(residue as u8)
    }

    /// The neighbour one step nearer to the wave's seeds: of several the first in the order of
    /// [`Site::neighbours`], which prefers sides to corners. `None` at a seed and where the wave did not come.
    #[must_use]
    pub fn descend(&self, from: Site) -> Option<Site> {
        let nearer = (self.get(from)? + 2) % 3;
        from.neighbours()
            .find(|&near| self.get(near) == Some(nearer))
    }

    /// The way from a cell down to a seed, without the cell itself.
    #[must_use]
    pub fn descent(&self, from: Site) -> Descent<'_> {
        Descent {
            residues: self,
            at: from,
        }
    }

    /// Nothing is reached.
    pub(super) fn clear(&mut self) {
        self.pairs.fill([u32::MAX; 2]);
    }

    /// Low and high bits of a word; unreached outside.
    #[inline(always)]
    pub(super) fn pair(&self, index: usize) -> [u32; 2] {
        self.pairs.get(index).copied().unwrap_or([u32::MAX; 2])
    }

    /// The cells of a word that are not reached.
    #[inline(always)]
    pub(super) fn unreached(&self, index: usize) -> u32 {
        let [low, high] = self.pair(index);
        low & high
    }

    /// Give the unreached cells of `mask` a residue.
    #[inline(always)]
    pub(super) fn reach(&mut self, index: usize, mask: u32, residue: Residue) {
        if let Some([low, high]) = self.pairs.get_mut(index) {
            *low &= !(mask & residue.clears_low);
            *high &= !(mask & residue.clears_high);
        }
    }

    /// The cells of a word with a residue.
    #[inline(always)]
    pub(super) fn with(&self, index: usize, residue: Residue) -> u32 {
        let [low, high] = self.pair(index);
        (low ^ residue.clears_low) & (high ^ residue.clears_high)
    }
}

/// A residue 0, 1 or 2, as the bits it clears from "unreached".
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

    /// The residue of one step more.
    pub(super) const fn next(self) -> Self {
        // 0 = (0, 0) → 1 = (1, 0) → 2 = (0, 1) → 0.
        Self {
            clears_low: !(self.clears_low & self.clears_high),
            clears_high: self.clears_low,
        }
    }
}

/// The cells of a way down; see [`Residues::descent`]. As many items as the start has steps to a seed.
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

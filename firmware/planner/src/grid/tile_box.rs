//! Toroidal addresses of tiles.
//!
//! ```text
//! slot of tile (i, j) = (j mod height) · width + (i mod width)
//! ```
//!
//! The map may start anywhere; only its extent has to fit the box. The map and every layer over it
//! use the same addresses.
//!
//! Invariant: tiles of an extent of at most `width` × `height` tiles share no slot.
//! Units: tiles.

/// A box of `width` × `height` slots.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TileBox {
    pub(crate) width: i32,
    pub(crate) height: i32,
}

impl TileBox {
    /// The slot of every tile in a box without slots. No array has it.
    pub(crate) const NO_SLOT: usize = usize::MAX;
    /// A box without slots.
    pub(crate) const EMPTY: Self = Self {
        width: 0,
        height: 0,
    };

    /// Returns a tile's slot; [`Self::NO_SLOT`] in a box without slots.
    #[inline]
    pub(crate) const fn slot(self, tile_x: i32, tile_y: i32) -> usize {
        let across = tile_x.checked_rem_euclid(self.width);
        let up = tile_y.checked_rem_euclid(self.height);
        match (across, up) {
            (Some(across), Some(up)) => (up * self.width + across) as usize,
            _ => Self::NO_SLOT,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::TileBox;

    #[test]
    fn tiles_that_fit_the_box_share_no_slot_wherever_they_lie() {
        let tiles = TileBox {
            width: 4,
            height: 3,
        };
        let mut slots: [usize; 12] =
            core::array::from_fn(|k| tiles.slot(k as i32 % 4 - 7, k as i32 / 4 + 100));
        slots.sort_unstable();
        assert_eq!(slots, core::array::from_fn(|k| k));
        assert_eq!(TileBox::EMPTY.slot(0, 0), TileBox::NO_SLOT);
    }
}

//! What is known of a cell, in two bits.

/// What is known of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Class {
    /// Never measured.
    #[default]
    Unknown = 0,
    /// Traversable.
    Free = 1,
    /// Stands in the way.
    Obstacle = 2,
    /// A hole, cliff or downward slope [Terrain, III-B].
    Negative = 3,
}

impl Class {
    /// Nothing is known to stand here.
    #[must_use]
    pub const fn is_open(self) -> bool {
        matches!(self, Self::Unknown | Self::Free)
    }

    /// By its bits in the low and the high plane, each 0 or not.
    pub(super) const fn from_bits(low: u32, high: u32) -> Self {
        match (low, high) {
            (0, 0) => Self::Unknown,
            (_, 0) => Self::Free,
            (0, _) => Self::Obstacle,
            _ => Self::Negative,
        }
    }
}

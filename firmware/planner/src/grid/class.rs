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
    /// A hole, cliff or downward slope [Maffei20, III-B].
    Negative = 3,
}

impl Class {
    /// Nothing is known to stand here.
    #[must_use]
    pub const fn is_open(self) -> bool {
        matches!(self, Self::Unknown | Self::Free)
    }

    /// By its bits in the low and the high plane, each 0 or not.
    pub(crate) const fn from_bits(low: u32, high: u32) -> Self {
        match (low, high) {
            (0, 0) => Self::Unknown,
            (_, 0) => Self::Free,
            (0, _) => Self::Obstacle,
            _ => Self::Negative,
        }
    }
}

/// 64 cells of a row: bit k of each word is column x + k.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Row {
    pub(crate) low: u64,
    pub(crate) high: u64,
    pub(crate) visited: u64,
}

impl Row {
    /// Cells that stand in the way, of either sign.
    #[must_use]
    pub const fn obstacle(self) -> u64 {
        self.high
    }

    /// Negative obstacles.
    #[must_use]
    pub const fn negative(self) -> u64 {
        self.high & self.low
    }

    /// Cells known to be traversable.
    #[must_use]
    pub const fn free(self) -> u64 {
        self.low & !self.high
    }

    /// Cells on or beside the robot's way so far.
    #[must_use]
    pub const fn visited(self) -> u64 {
        self.visited
    }

    /// Cells never measured.
    #[must_use]
    pub const fn unknown(self) -> u64 {
        !(self.low | self.high)
    }
}

//! The class of a cell in two bits, and rows of 64 classes as bit masks.
//!
//! ```text
//! class       low  high
//! unknown      0    0
//! free         1    0
//! obstacle     0    1
//! negative     1    1
//! ```

/// The class of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Class {
    /// Never measured.
    #[default]
    Unknown = 0,
    /// Traversable.
    Free = 1,
    /// Something stands in it.
    Obstacle = 2,
    /// A hole, cliff or downward slope \[Maffei20, III-B\]. On flat ground an obstacle that stands
    /// where the floor was free.
    Negative = 3,
}

impl Class {
    /// Returns true if the class is neither an obstacle nor a negative obstacle.
    #[must_use]
    pub const fn is_open(self) -> bool {
        matches!(self, Self::Unknown | Self::Free)
    }

    /// Returns the class of a cell from its bits in the low and the high plane, each 0 or not.
    pub(crate) const fn from_bits(low: u32, high: u32) -> Self {
        match (low, high) {
            (0, 0) => Self::Unknown,
            (_, 0) => Self::Free,
            (0, _) => Self::Obstacle,
            _ => Self::Negative,
        }
    }
}

/// 64 cells of a row. Bit k of each word is column x + k, where x is the reader's column.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Row {
    pub(crate) low: u64,
    pub(crate) high: u64,
    pub(crate) visited: u64,
}

impl Row {
    /// Returns the obstacles, negative ones included.
    #[must_use]
    pub const fn obstacle(self) -> u64 {
        self.high
    }

    /// Returns the negative obstacles.
    #[must_use]
    pub const fn negative(self) -> u64 {
        self.high & self.low
    }

    /// Returns the traversable cells.
    #[must_use]
    pub const fn free(self) -> u64 {
        self.low & !self.high
    }

    /// Returns the cells of the robot's trail.
    #[must_use]
    pub const fn visited(self) -> u64 {
        self.visited
    }

    /// Returns the cells never measured.
    #[must_use]
    pub const fn unknown(self) -> u64 {
        !(self.low | self.high)
    }
}

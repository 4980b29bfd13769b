//! The map: occupancy of the known space.

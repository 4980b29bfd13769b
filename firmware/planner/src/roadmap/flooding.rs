//! The flood of what the robot can reach, in instalments: a part of the tiles is loaded, or some of
//! them are flooded, in each.
//!
//! Invariant: the lent memory keeps the planes from the first instalment to the last. The robot
//! stands meanwhile.
//!
//! Units: tiles.

use crate::map::Tiles;
use crate::roadmap::configuration_space::Footprint;
use crate::roadmap::reachability::Reachability;

/// Tiles that an instalment loads. What a tile costs: [`crate::roadmap::reachability`].
const TILES_PER_STEP: u16 = 120;
/// Tiles that an instalment floods.
const FLOODS_PER_STEP: u32 = 300;

/// How far a flood is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Flooding {
    /// Loads the tile at place n next.
    Load(u16),
    /// Floods from the tiles that are awake next.
    Spread,
    /// The planes hold all that can be reached.
    Over,
    /// Nothing can be reached: the disc does not fit where the robot stands.
    Tight,
}

impl Flooding {
    /// A flood that has not begun. Its planes may hold anything. All its bits are zero, so that the
    /// planner's first state takes no flash.
    pub(crate) const FIRST: Self = Self::Load(0);

    /// Runs an instalment. `start` reaches the first cells, once every tile is loaded; it returns
    /// false if there are none.
    pub(crate) fn advance<'a, const TILES: usize, const SLOTS: usize>(
        &mut self,
        tiles: &Tiles<TILES, SLOTS>,
        footprint: &Footprint,
        reachability: &mut Reachability<'a>,
        start: impl FnOnce(&mut Reachability<'a>) -> bool,
    ) {
        match *self {
            Self::Load(first) => {
                if first == 0 {
                    reachability.clear();
                }
                let next = first + TILES_PER_STEP;
                for place in first..next {
                    reachability.load(tiles, footprint, usize::from(place));
                }
                *self = if usize::from(next) <= reachability.tiles() {
                    Self::Load(next)
                } else if start(reachability) {
                    Self::Spread
                } else {
                    Self::Tight
                };
            }
            Self::Spread => {
                if reachability.spread(FLOODS_PER_STEP) {
                    *self = Self::Over;
                }
            }
            Self::Over | Self::Tight => {}
        }
    }
}

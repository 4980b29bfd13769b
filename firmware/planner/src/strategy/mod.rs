//! The strategies: what is a boundary of the window at what potential, and what counts as finished.
//!
//! Every strategy ends up going to frontiers, so [`Frontier`] is always there; what one of them has beyond it, it keeps in
//! memory that they share (`More`).

pub mod frontier;
pub mod lookout;
mod nearest;
pub mod ouroboros;
mod patience;
pub mod road;

pub use frontier::Frontier;
pub use ouroboros::Ouroboros;
pub use road::Road;

use crate::config::{Config, Strategy};
use crate::geometry::Pose;
use crate::topology::Space;
use frontier::{Lent, Outlook};
use ouroboros::Round;
use ouroboros::shield::Shield;

/// What plans in a session. `SLOTS` as the map's.
#[derive(Debug)]
pub struct Strategist<const SLOTS: usize> {
    /// What drives to frontiers: road, bars, leftovers, the second chance.
    pub frontier: Frontier,
    more: More<SLOTS>,
}

/// What a strategy remembers beyond the frontier's.
///
/// With its tag of its own, so that the value without anything is all zeros and costs no flash as a static one.
#[derive(Debug)]
#[repr(u8)]
#[allow(
    clippy::large_enum_variant,
    reason = "no heap to box into; one lives at a time"
)]
enum More<const SLOTS: usize> {
    Nothing,
    Ouroboros(Ouroboros<SLOTS>),
}

impl<const SLOTS: usize> Strategist<SLOTS> {
    /// Nothing but the frontier.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            frontier: Frontier::new(),
            more: More::Nothing,
        }
    }

    /// Forget everything, and plan as `config` says.
    pub fn reset(&mut self, config: &Config) {
        self.frontier.reset();
        self.more = match config.strategy {
            Strategy::Frontier => More::Nothing,
            Strategy::Ouroboros => More::Ouroboros(Ouroboros::new()),
        };
        if let More::Ouroboros(ouroboros) = &mut self.more {
            let (width, height) = config.box_tiles;
            ouroboros.reset((i32::from(width), i32::from(height)));
        }
    }

    /// The space whose skeleton a strategy plans on.
    #[must_use]
    pub const fn space(strategy: Strategy) -> Space {
        match strategy {
            Strategy::Frontier => Space::KnownFree,
            Strategy::Ouroboros => Space::AnchoredNotObstacle,
        }
    }

    /// What is known of loops, where the strategy closes them.
    #[must_use]
    pub const fn ouroboros(&self) -> Option<&Ouroboros<SLOTS>> {
        match &self.more {
            More::Nothing => None,
            More::Ouroboros(ouroboros) => Some(ouroboros),
        }
    }

    /// The wall behind a robot that closes a loop.
    #[must_use]
    pub const fn shield(&self) -> Option<&Shield> {
        match &self.more {
            More::Nothing => None,
            More::Ouroboros(ouroboros) => ouroboros.shield(),
        }
    }

    /// The robot is here; to be called in every step.
    pub fn note_pose(&mut self, pose: &Pose) {
        if let More::Ouroboros(ouroboros) = &mut self.more {
            ouroboros.note_pose(pose);
        }
    }

    /// Go on with a round on the published skeleton; `None` when it needs another call on the same one.
    pub fn advance<const TILES: usize>(
        &mut self,
        round: Round<'_, TILES, SLOTS>,
        lent: Lent<'_>,
    ) -> Option<Outlook> {
        self.frontier.cut(round.topology);
        match &mut self.more {
            More::Nothing => {
                let (robot, time_ms) = (round.pose.point(), round.time_ms);
                Some(self.frontier.replan(&round.known(), robot, time_ms, lent))
            }
            More::Ouroboros(ouroboros) => ouroboros.advance(&mut self.frontier, round, lent),
        }
    }
}

impl<const SLOTS: usize> Default for Strategist<SLOTS> {
    fn default() -> Self {
        Self::new()
    }
}

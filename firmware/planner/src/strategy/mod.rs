//! The strategies: what is a boundary of the window at what potential, and what counts as finished.
//!
//! Every strategy ends up going to frontiers, so [`Frontier`] is always there; what one of them has beyond it, it keeps in
//! memory that they share (`More`).

pub mod frontier;
pub mod ouroboros;
pub mod tdbvp;

pub use frontier::Frontier;
pub use ouroboros::Ouroboros;
pub use tdbvp::Tdbvp;

use crate::config::{Config, Strategy};
use crate::field::Window;
use crate::field::local_grid::LocalGrid;
use crate::geometry::Pose;
use crate::path::{PlanningScratch, RoundOutcome};
use crate::roadmap::skeleton::Space;
use crate::robot::LaserMount;
use ouroboros::Round;
use ouroboros::shield::Shield;
use tdbvp::Surroundings;

/// What plans in a session. `SLOTS` as the map's.
#[derive(Debug)]
pub struct Strategist<const SLOTS: usize> {
    /// What drives to frontiers: path, bars, leftovers, the second chance.
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
    Tdbvp(Tdbvp<SLOTS>),
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
            Strategy::Tdbvp { .. } => More::Tdbvp(Tdbvp::new()),
        };
        let (width, height) = config.box_tiles;
        let box_tiles = (i32::from(width), i32::from(height));
        match (&mut self.more, config.strategy) {
            (More::Ouroboros(ouroboros), _) => ouroboros.reset(box_tiles),
            (More::Tdbvp(tdbvp), Strategy::Tdbvp { patrol_s }) => tdbvp.reset(box_tiles, patrol_s),
            _ => {}
        }
    }

    /// The space whose skeleton a strategy plans on.
    #[must_use]
    pub const fn space(strategy: Strategy) -> Space {
        match strategy {
            Strategy::Frontier | Strategy::Tdbvp { .. } => Space::KnownFree,
            Strategy::Ouroboros => Space::AnchoredNotObstacle,
        }
    }

    /// What is known of loops, where the strategy closes them.
    #[must_use]
    pub const fn ouroboros(&self) -> Option<&Ouroboros<SLOTS>> {
        match &self.more {
            More::Ouroboros(ouroboros) => Some(ouroboros),
            More::Nothing | More::Tdbvp(_) => None,
        }
    }

    /// The wall behind a robot that closes a loop.
    #[must_use]
    pub const fn shield(&self) -> Option<&Shield> {
        match &self.more {
            More::Ouroboros(ouroboros) => ouroboros.shield(),
            More::Nothing | More::Tdbvp(_) => None,
        }
    }

    /// What is known of rails, where the strategy follows them.
    #[must_use]
    pub const fn tdbvp(&self) -> Option<&Tdbvp<SLOTS>> {
        match &self.more {
            More::Tdbvp(tdbvp) => Some(tdbvp),
            More::Nothing | More::Ouroboros(_) => None,
        }
    }

    /// The robot is here; to be called in every step, with the scan of the level laser.
    pub fn note(&mut self, pose: &Pose, time_ms: u32, scan: Option<(&LaserMount, &[u16])>) {
        match &mut self.more {
            More::Nothing => {}
            More::Ouroboros(ouroboros) => ouroboros.note_pose(pose),
            More::Tdbvp(tdbvp) => tdbvp.note(pose, time_ms, scan),
        }
    }

    /// Charge the window otherwise than with a path's local goal; `None` where the strategy has no such charge, or it leads nowhere.
    pub fn charge<const TILES: usize>(
        &mut self,
        around: &Surroundings<'_, TILES, SLOTS>,
        (window, view): (&mut Window, &LocalGrid),
    ) -> Option<()> {
        match &mut self.more {
            More::Nothing | More::Ouroboros(_) => None,
            More::Tdbvp(tdbvp) => tdbvp
                .charge(&self.frontier, around, (window, view))
                .then_some(()),
        }
    }

    /// The exploration is over; whether the robot goes on all the same.
    pub fn begin_patrol(&mut self) -> bool {
        let More::Tdbvp(tdbvp) = &mut self.more else {
            return false;
        };
        let begins = tdbvp.begin_patrol();
        if begins {
            self.frontier.go_on();
        }
        begins
    }

    /// Whether the robot went on after the exploration.
    #[must_use]
    pub fn is_patrolling(&self) -> bool {
        self.tdbvp().is_some_and(Tdbvp::is_patrolling)
    }

    /// Go on with a round on the published skeleton; `None` when it needs another call on the same one.
    pub fn advance<const TILES: usize>(
        &mut self,
        round: Round<'_, TILES, SLOTS>,
        lent: PlanningScratch<'_>,
    ) -> Option<RoundOutcome> {
        self.frontier.cut(round.topology);
        match &mut self.more {
            More::Nothing => {
                let (robot, time_ms) = (round.pose.point(), round.time_ms);
                Some(self.frontier.replan(&round.known(), robot, time_ms, lent))
            }
            More::Ouroboros(ouroboros) => ouroboros.advance(&mut self.frontier, round, lent),
            More::Tdbvp(tdbvp) => Some(tdbvp.advance(&mut self.frontier, round, lent)),
        }
    }
}

impl<const SLOTS: usize> Default for Strategist<SLOTS> {
    fn default() -> Self {
        Self::new()
    }
}

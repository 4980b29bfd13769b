//! The strategies: which cells of the window are boundaries at what potential, and when the
//! exploration is finished.
//!
//! | file | what it holds |
//! | --- | --- |
//! | [`frontier`] | drive to the frontier of the greatest utility, until none is worth its trip |
//! | [`ouroboros`] | close every loop on the way \[Jorge15, Algorithm 1\] |
//! | [`sbpf`] | follow the forces of an area's cells \[Kenealy15\] |
//! | [`tdbvp`] | follow rails of time, and patrol \[Maffei14, IV and V\] |
//!
//! Every strategy drives to frontiers in the end, so a `Strategist` always has a [`Frontier`].

pub(crate) mod frontier;
pub(crate) mod ouroboros;
pub(crate) mod sbpf;
pub(crate) mod tdbvp;

pub(crate) use frontier::Frontier;
pub(crate) use ouroboros::Ouroboros;
pub(crate) use sbpf::Sbpf;
pub(crate) use tdbvp::Tdbvp;

use crate::config::{Config, Strategy, Tuning};
use crate::field::Window;
use crate::field::local_grid::LocalGrid;
use crate::geometry::{Cell, Point, Pose};
use crate::grid::Shifts;
use crate::map::Tiles;
use crate::path::nearest::Centres;
use crate::path::{PlanningContext, PlanningScratch, RoundOutcome};
use crate::roadmap::skeleton::Space;
use crate::robot::LaserMount;
use crate::status::Status;
use crate::strategy::ouroboros::Shield;

/// The session's strategy and its state. `SLOTS` as the map's.
#[derive(Debug)]
pub(crate) struct Strategist<const SLOTS: usize> {
    /// The path to the current goal, dropped goals, blocked passages, the second chance.
    pub(crate) frontier: Frontier,
    own: Own<SLOTS>,
}

/// The state of a strategy beyond the frontier.
///
/// With an explicit tag, so that a value of `None` is all zeros and costs no flash in a static.
#[derive(Debug)]
#[repr(u8)]
#[allow(
    clippy::large_enum_variant,
    reason = "no heap to box into; one lives at a time"
)]
enum Own<const SLOTS: usize> {
    None,
    Ouroboros(Ouroboros<SLOTS>),
    Tdbvp(Tdbvp<SLOTS>),
    Sbpf(Sbpf),
}

impl<const SLOTS: usize> Strategist<SLOTS> {
    /// Strategy *frontier*, at the start.
    pub(crate) const fn new() -> Self {
        Self {
            frontier: Frontier::new(),
            own: Own::None,
        }
    }

    /// Forgets everything and begins the strategy of `config`. It is not inlined: its copy of a
    /// strategy's state would lie on the stack below every step.
    #[inline(never)]
    pub(crate) fn reset(&mut self, config: &Config) {
        self.frontier.reset();
        self.own = match config.strategy {
            Strategy::Frontier => Own::None,
            Strategy::Ouroboros => Own::Ouroboros(Ouroboros::new()),
            Strategy::Tdbvp {
                patrol_s,
                impatience_s,
            } => {
                let tuning = &config.tuning.tdbvp;
                Own::Tdbvp(Tdbvp::new(
                    config.period_ms(),
                    patrol_s,
                    impatience_s,
                    tuning,
                ))
            }
            Strategy::Sbpf(field) => Own::Sbpf(Sbpf::new(field, false, config)),
            Strategy::Esbpf(field) => Own::Sbpf(Sbpf::new(field, true, config)),
        };
    }

    /// Moves what lies in the map with its tiles, after a correction that put the robot at `robot`.
    /// `spare` is memory.
    #[inline(never)]
    pub(crate) fn correct(&mut self, shifts: Shifts<'_>, robot: Point, spare: &mut [u32]) {
        self.frontier.correct(shifts, robot);
        match &mut self.own {
            Own::None => {}
            Own::Ouroboros(ouroboros) => ouroboros.correct(shifts, spare),
            Own::Tdbvp(tdbvp) => tdbvp.correct(shifts, spare),
            Own::Sbpf(sbpf) => sbpf.correct(shifts),
        }
    }

    /// Returns the space whose skeleton a strategy plans on.
    pub(crate) const fn space(strategy: Strategy) -> Space {
        match strategy {
            Strategy::Ouroboros => Space::NotObstacle,
            _ => Space::KnownFree,
        }
    }

    /// Returns the state of strategy *ouroboros*, if it is the session's.
    pub(crate) const fn ouroboros(&self) -> Option<&Ouroboros<SLOTS>> {
        match &self.own {
            Own::Ouroboros(ouroboros) => Some(ouroboros),
            _ => None,
        }
    }

    /// Returns the shield behind a robot that closes a loop.
    pub(crate) fn shield(&self) -> Option<&Shield> {
        self.ouroboros()?.shield()
    }

    /// Returns the state of strategy *tdbvp*, if it is the session's.
    pub(crate) const fn tdbvp(&self) -> Option<&Tdbvp<SLOTS>> {
        match &self.own {
            Own::Tdbvp(tdbvp) => Some(tdbvp),
            _ => None,
        }
    }

    /// Returns the heading of the strategy's own forces, radians; `None` if the window's field
    /// leads the robot.
    pub(crate) fn heading_rad(&self) -> Option<f32> {
        match &self.own {
            Own::Sbpf(sbpf) => sbpf.heading_rad(),
            _ => None,
        }
    }

    /// Notes that a peer is at a point of the map. What the peer has seen comes with its tiles.
    pub(crate) fn note_peer(&mut self, peer: Point) {
        if let Own::Sbpf(sbpf) = &mut self.own {
            sbpf.note_peer(peer);
        }
    }

    /// Takes over what the map knows; called in every step. `places` are those of the robot and of
    /// the others that may drive. Returns the status if the strategy ends the exploration.
    pub(crate) fn note_map<const TILES: usize>(
        &mut self,
        tiles: &Tiles<TILES, SLOTS>,
        places: (Point, impl Iterator<Item = Point>),
        time_ms: u32,
        config: &Config,
    ) -> Option<Status> {
        match &mut self.own {
            Own::Sbpf(sbpf) => sbpf.note_map(tiles, places, time_ms, config),
            _ => None,
        }
    }

    /// Records the robot's pose, and the scan of the level laser; called in every step.
    pub(crate) fn note(
        &mut self,
        pose: &Pose,
        time_ms: u32,
        scan: Option<(&LaserMount, &[u16])>,
        tuning: &Tuning,
    ) {
        match &mut self.own {
            Own::None | Own::Sbpf(_) => {}
            Own::Ouroboros(ouroboros) => ouroboros.note_pose(pose, &tuning.ouroboros),
            Own::Tdbvp(tdbvp) => tdbvp.note(pose, time_ms, scan, &tuning.tdbvp),
        }
    }

    /// Charges the window with the strategy's own boundary values. `None` if it has none, or they
    /// lead nowhere: then the window has the path's local goal.
    pub(crate) fn charge<const TILES: usize>(
        &mut self,
        centres: &Centres<'_, TILES, SLOTS>,
        robot: Point,
        window: (&mut Window, &LocalGrid),
        tuning: &Tuning,
    ) -> Option<()> {
        match &mut self.own {
            Own::None | Own::Ouroboros(_) | Own::Sbpf(_) => None,
            Own::Tdbvp(tdbvp) => tdbvp
                .charge(&self.frontier, centres, robot, window, &tuning.tdbvp)
                .then_some(()),
        }
    }

    /// Ends the exploration. Returns true if the robot goes on with a patrol.
    pub(crate) fn begin_patrol(&mut self) -> bool {
        let Own::Tdbvp(tdbvp) = &mut self.own else {
            return false;
        };
        let begins = tdbvp.begin_patrol();
        if begins {
            self.frontier.go_on();
        }
        begins
    }

    /// Returns true if the exploration is over and the robot patrols.
    pub(crate) fn is_patrolling(&self) -> bool {
        self.tdbvp().is_some_and(Tdbvp::is_patrolling)
    }

    /// Begins to drive by order, or goes on exploring: what failed before may be tried again.
    pub(crate) fn begin_errand(&mut self) {
        self.frontier.go_on();
    }

    /// Plans a round to a place of the map on the published skeleton.
    pub(crate) fn go_to<const TILES: usize>(
        &mut self,
        place: Cell,
        round: PlanningContext<'_, TILES, SLOTS>,
        scratch: PlanningScratch<'_>,
    ) -> RoundOutcome {
        self.frontier.cut(round.skeleton);
        self.frontier.go_to(place, &round, scratch)
    }

    /// Continues a round on the published skeleton; `None` if it needs another call on it.
    pub(crate) fn advance<const TILES: usize>(
        &mut self,
        round: PlanningContext<'_, TILES, SLOTS>,
        scratch: PlanningScratch<'_>,
    ) -> Option<RoundOutcome> {
        self.frontier.cut(round.skeleton);
        match &mut self.own {
            Own::None => Some(self.frontier.replan(&round, scratch)),
            Own::Ouroboros(ouroboros) => ouroboros.advance(&mut self.frontier, round, scratch),
            Own::Sbpf(sbpf) => Some(sbpf.advance(&mut self.frontier, &round, scratch)),
            Own::Tdbvp(tdbvp) => Some(tdbvp.advance(&mut self.frontier, round, scratch)),
        }
    }
}

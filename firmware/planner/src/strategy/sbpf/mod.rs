//! Strategies *sbpf* and *esbpf*: a space-based potential field over an area of known size
//! \[Kenealy15\].
//!
//! Obstacles repel the robot, and cells that nothing has sensed attract it. Both forces are sums
//! over the cells of the area. They give a heading without a window, which the drive follows with
//! its own collision checks and recoveries. ESBPF adds *gates* ([`edges`]) and the *conveyor
//! belt*: the repulsion is turned, so that walls lead the robot along them ([`forces`]).
//!
//! | file | what it holds |
//! | --- | --- |
//! | [`levels`] | the area's cells and their levels |
//! | [`edges`] | the cells that attract \[eqs. 7–10\] |
//! | [`forces`] | attraction and repulsion \[eqs. 2–6, 11\] |
//!
//! Departs from the paper: a robot that has covered no new cell for the session's `impatience_s`
//! follows a path to a frontier. The paper has no way out of a minimum that the conveyor belt does
//! not open. Without `impatience_s` the robot follows forces only, and a run that gets no farther
//! ends as *trapped*.
//!
//! Units: metres, map cells, milliseconds.

mod edges;
mod forces;
mod levels;

#[cfg(test)]
mod tests;

use crate::clock::since;
use crate::config::{Config, SpaceField};
use crate::geometry::{Cell, Point};
use crate::grid::Shifts;
use crate::map::Tiles;
use crate::path::{PlanningContext, PlanningScratch, RoundOutcome};
use crate::status::{Fault, Finish, Status};
use crate::strategy::Frontier;
use crate::team::peers::MOST_PEERS;
use forces::Claims;
use levels::Levels;

/// Thousandths of the whole area.
const ALL: u16 = 1_000;

/// The state of the strategy.
#[derive(Debug)]
pub(crate) struct Sbpf {
    levels: Levels,
    field: SpaceField,
    /// ESBPF: gates and the conveyor belt.
    enhanced: bool,
    /// The most cells that had a level, since when, and the time of the last step.
    covered: u32,
    covered_ms: u32,
    now_ms: u32,
    /// The heading of the forces; `None` if nothing attracts.
    heading_rad: Option<f32>,
    /// The robot follows a path and not the forces.
    on_path: bool,
    /// The frontier for which the robot set out on a path.
    errand: Option<Cell>,
}

impl Sbpf {
    /// Returns the state at the start.
    pub(super) const fn new(field: SpaceField, enhanced: bool, config: &Config) -> Self {
        Self {
            levels: Levels::new(field.area, config.tuning.sbpf.cell),
            field,
            enhanced,
            covered: 0,
            covered_ms: 0,
            now_ms: 0,
            heading_rad: None,
            on_path: false,
            errand: None,
        }
    }

    /// Returns the heading that the robot follows, radians; `None` if it follows a path or stands.
    pub(super) fn heading_rad(&self) -> Option<f32> {
        self.heading_rad.filter(|_| !self.on_path)
    }

    /// Moves what lies in the map with its tiles, and forgets where robots were in the area.
    pub(super) fn correct(&mut self, shifts: Shifts<'_>) {
        self.errand = self.errand.map(|goal| shifts.moved_coarse(goal));
        if !shifts.is_empty() {
            self.levels.forget_visits();
        }
    }

    /// Raises the level of the cell in which a peer is. What peers covered comes with the map.
    pub(super) fn note_peer(&mut self, peer: Point) {
        self.levels.visit(peer);
    }

    /// Takes over what the map knows, and computes the forces; called in every step. `rivals` are
    /// the robots that may drive. Returns the status if the exploration ends. It is not inlined, so
    /// that other strategies do not pay for its stack.
    #[inline(never)]
    pub(super) fn note_map<const TILES: usize, const SLOTS: usize>(
        &mut self,
        tiles: &Tiles<TILES, SLOTS>,
        (robot, rivals): (Point, impl Iterator<Item = Point>),
        time_ms: u32,
        config: &Config,
    ) -> Option<Status> {
        let tuning = &config.tuning.sbpf;
        self.levels.update(tiles);
        let covered = self.levels.covered_cells();
        self.now_ms = time_ms;
        if covered > self.covered {
            (self.covered, self.covered_ms) = (covered, time_ms);
        }
        let place = self.levels.place(robot);
        let claims = Claims {
            rivals: rivals
                .map(|rival| self.levels.place(rival))
                .take(MOST_PEERS)
                .collect(),
            weight: config.tuning.order.claimed,
        };
        self.heading_rad = forces::heading_rad(&self.levels, place, &claims, self.enhanced, tuning);
        // With a path to what is left, a target of everything is everything that the map shows.
        if self.is_target_reached() && !(self.has_paths() && self.field.until_permille == ALL) {
            Some(Status::Finished(Finish::Covered))
        } else if self.has_paths() {
            None
        } else if self.heading_rad.is_none() {
            Some(Status::Finished(Finish::NothingAttracts))
        } else {
            let is_trapped = self.waited_ms() > tuning.trapped_ms;
            is_trapped.then_some(Status::Fault(Fault::Trapped))
        }
    }

    fn is_target_reached(&self) -> bool {
        let target = u32::from(self.field.until_permille) * self.levels.cells();
        u32::from(ALL) * self.covered >= target
    }

    /// Returns true if the robot may follow a path where the forces lead nowhere.
    const fn has_paths(&self) -> bool {
        self.field.impatience_s.is_some()
    }

    /// Returns the time since a cell was last covered, milliseconds.
    const fn waited_ms(&self) -> u32 {
        since(self.now_ms, self.covered_ms)
    }

    /// Plans a round on a new skeleton: the path to what is left, in case that the forces lead
    /// nowhere. The robot follows the path until it has seen that frontier.
    ///
    /// It is not inlined, so that other strategies do not pay for its stack.
    #[inline(never)]
    pub(super) fn advance<const TILES: usize, const SLOTS: usize>(
        &mut self,
        frontier: &mut Frontier,
        round: &PlanningContext<'_, TILES, SLOTS>,
        scratch: PlanningScratch<'_>,
    ) -> RoundOutcome {
        let Some(impatience_s) = self.field.impatience_s else {
            return RoundOutcome::Unsure;
        };
        let is_impatient = self.waited_ms() >= 1_000 * u32::from(impatience_s);
        let is_late = self.heading_rad.is_none() || is_impatient || self.errand.is_some();
        let (outcome, is_free) = frontier.replan_freely(round, scratch, is_late);
        self.on_path = !is_free || frontier.has_second_chance();
        let most_cells = round.tuning.sbpf.errand_cells;
        let goal = Some(frontier.path()).filter(|path| self.on_path && !path.is_empty());
        let goal = goal.map(|path| path.goal());
        self.errand = match (self.errand, goal) {
            (Some(from), Some(to)) => is_within(from, to, most_cells).then_some(from),
            (_, goal) => goal,
        };
        outcome
    }
}

/// Returns true if two cells are at most `most_cells` apart.
fn is_within(a: Cell, b: Cell, most_cells: i32) -> bool {
    let (dx, dy) = (a.x - b.x, a.y - b.y);
    dx * dx + dy * dy <= most_cells * most_cells
}

//! Closing a loop: tractor point, loop road and shield, and the drive to the tractor point
//! \[Jorge15, Algorithm 1, lines 3 to 20\].
//!
//! Units: map cells, metres.

use crate::config::OuroborosTuning;
use crate::geometry::Cell;
use crate::grid::Site;
use crate::path::context::STEP_M;
use crate::path::{PlanningContext, PlanningScratch, RoundOutcome};
use crate::roadmap::Residues;
use crate::roadmap::branches::surroundings;
use crate::strategy::Frontier;
use crate::strategy::ouroboros::closed_regions::Closed;
use crate::strategy::ouroboros::loop_budget::LoopBudget;
use crate::strategy::ouroboros::loop_road::{LoopRoad, back_to_shield, build_shield};
use crate::strategy::ouroboros::tractor::{self, Fate};
use crate::strategy::ouroboros::{Ouroboros, Shield, Stage};

/// Maximum number of centre cells on a shield that are looked at.
const MOST_CUT: usize = 9;

impl<const SLOTS: usize> Ouroboros<SLOTS> {
    /// Runs lines 3 to 18: tractor point, loop road and shield.
    #[inline(never)]
    pub(super) fn look<const TILES: usize>(
        &mut self,
        round: &mut PlanningContext<'_, TILES, SLOTS>,
        scratch: &mut PlanningScratch<'_>,
    ) -> Option<RoundOutcome> {
        self.stage = Stage::Explore;
        let robot = round.nearest(round.pose.point().cell(), scratch)?;
        if self.tractor.is_some() {
            self.move_tractor(round, scratch);
        } else {
            self.tractor = self.generate_tractor(round, scratch);
        }
        let tractor = round.skeleton.frame().site(self.tractor?)?;
        let shield = match self.shield {
            Some(previous) => renew(previous, round, scratch, robot),
            None => self.begin(round, scratch, [robot, tractor]),
        };
        match shield {
            Some(shield) => {
                self.shield = Some(shield);
                self.stage = Stage::Close(robot);
            }
            None if self.shield.is_some() => return self.lose(&round.tuning.ouroboros),
            None => {}
        }
        None
    }

    /// Moves the tractor point to the new skeleton or disables it [lines 5 to 8].
    fn move_tractor<const TILES: usize>(
        &mut self,
        round: &PlanningContext<'_, TILES, SLOTS>,
        scratch: &mut PlanningScratch<'_>,
    ) {
        let is_open = |tractor: &Cell| {
            let centres = round.centres();
            centres.is_some_and(|centres| centres.is_open(*tractor))
        };
        let centre = self
            .tractor
            .filter(is_open)
            .and_then(|tractor| round.nearest(tractor, scratch))
            .map(|site| round.skeleton.frame().cell(site));
        let is_closing = self.shield.is_some();
        let tuning = &round.tuning.ouroboros;
        match centre.map(|centre| tractor::fate(centre, &round.pose, is_closing, tuning)) {
            Some(Fate::Stays) => self.tractor = centre,
            Some(Fate::Reached) if is_closing => {
                self.tally.closed += 1;
                self.settle(Closed::Loop);
            }
            // It lies on an obstacle now, or is of no use.
            None | Some(Fate::Reached | Fate::Stale) => {
                self.regions.drop_pending();
                self.disable_tractor();
            }
        }
    }

    /// Disables the tractor point [line 8], and its shield with it.
    fn disable_tractor(&mut self) {
        (self.tractor, self.shield) = (None, None);
        (self.lost_rounds, self.loop_m) = (0, 0.0);
    }

    /// Returns a new tractor point, if there is a place for it [line 10].
    pub(super) fn generate_tractor<const TILES: usize>(
        &self,
        round: &PlanningContext<'_, TILES, SLOTS>,
        scratch: &mut PlanningScratch<'_>,
    ) -> Option<Cell> {
        let tuning = &round.tuning.ouroboros;
        let candidate = tractor::candidate(&self.crumbs, &self.regions, &round.pose, tuning)?;
        let site = round.nearest(candidate, scratch)?;
        let centre = round.skeleton.frame().cell(site);
        tractor::suits(centre, &self.regions, &round.pose, tuning).then_some(centre)
    }

    /// Begins a loop that is worth closing [lines 12, 16 and 18]: returns the shield behind the
    /// robot.
    fn begin<const TILES: usize>(
        &mut self,
        round: &mut PlanningContext<'_, TILES, SLOTS>,
        scratch: &mut PlanningScratch<'_>,
        [robot, tractor]: [Site; 2],
    ) -> Option<Shield> {
        round.propagate(tractor, surroundings(robot), None, scratch)?;
        let tuning = &round.tuning.ouroboros;
        let centres = round.centres()?;
        let residues = Residues::new(centres.cells.tiling(), scratch.residues).ok()?;
        let here = round.pose.point().cell();
        let came = self.crumbs.came_from(here)?;
        let road = LoopRoad::find(&centres, &residues, (robot, came))?;
        let meet = centres.cell(road.meet);
        let loop_m = road.steps() as f32 * STEP_M;
        if !round.limits.is_worth(loop_m, round.frontier_m()?)
            || !tractor::may_be_at(meet, &self.regions, &round.pose, tuning)
        {
            return None;
        }
        let shield = build_shield(&centres, road.back(&residues), here, tuning)?;
        self.tractor = Some(meet);
        self.loop_m = loop_m;
        self.back_m = road.back(&residues).count() as f32 * STEP_M;
        if self.lost_loops == 0 {
            self.budget = LoopBudget::NEW;
        }
        // The loop's surroundings are those of the back, and of the way that the robot will drive.
        self.regions.drop_pending();
        for site in road.back(&residues) {
            self.regions
                .add_pending(centres.cell(site), tuning.near_cells);
        }
        Some(shield)
    }

    /// Gives the loop up, and closes its regions so that it does not begin again.
    fn give_up(&mut self) {
        self.tally.given_up += 1;
        self.settle(Closed::GivenUp);
    }

    /// Ends the loop, and closes its regions.
    fn settle(&mut self, why: Closed) {
        self.regions.close_pending(why);
        self.revisit = None;
        self.lost_loops = 0;
        self.disable_tractor();
    }

    /// Counts a round without loop road or shield while a loop is being closed. For some rounds the
    /// robot keeps its path; then the loop is lost.
    fn lose(&mut self, tuning: &OuroborosTuning) -> Option<RoundOutcome> {
        self.lost_rounds += 1;
        if self.lost_rounds < tuning.lost_rounds {
            self.stage = Stage::Look;
            return Some(RoundOutcome::Path);
        }
        self.lost_loops += 1;
        if self.lost_loops > tuning.lost_rounds {
            self.give_up();
        } else {
            (self.shield, self.lost_rounds) = (None, 0);
            self.regions.drop_pending();
        }
        None
    }

    /// Follows the path to the tractor point round the shield [line 20].
    #[inline(never)]
    pub(super) fn close<const TILES: usize>(
        &mut self,
        frontier: &mut Frontier,
        round: &mut PlanningContext<'_, TILES, SLOTS>,
        scratch: &mut PlanningScratch<'_>,
        robot: Site,
    ) -> Option<RoundOutcome> {
        let frame = round.skeleton.frame();
        let tractor = self.tractor.and_then(|cell| frame.site(cell));
        let path = tractor.zip(self.shield).and_then(|(tractor, shield)| {
            let wall = shield.cells().filter_map(|cell| frame.site(cell));
            round.path([robot, tractor], wall, scratch)
        });
        let Some(path) = path else {
            self.stage = Stage::Explore;
            return self.lose(&round.tuning.ouroboros);
        };
        self.lost_rounds = 0;
        self.loop_m = self.back_m + path.steps() as f32 * STEP_M;
        let too_long = round.limits.is_too_long(self.loop_m, round.frontier_m()?);
        if too_long || self.budget.is_spent(round.limits) {
            self.stage = Stage::Explore;
            self.give_up();
            return None;
        }
        Some(frontier.follow(path, round, scratch.local_grid))
    }
}

/// Returns the shield on the way from the robot back to the previous one [lines 14 and 18]; the
/// previous one if there is no better and it is still valid.
fn renew<const TILES: usize, const SLOTS: usize>(
    mut previous: Shield,
    round: &mut PlanningContext<'_, TILES, SLOTS>,
    scratch: &mut PlanningScratch<'_>,
    robot: Site,
) -> Option<Shield> {
    spread_ahead_of(previous, round, scratch, robot)?;
    let centres = round.centres()?;
    let residues = Residues::new(centres.cells.tiling(), scratch.residues).ok()?;
    let back = back_to_shield(&centres, &residues, robot)?;
    let tuning = &round.tuning.ouroboros;
    let next = build_shield(&centres, back, round.pose.point().cell(), tuning);
    next.or_else(|| {
        let is_valid = previous.stretch(&centres, tuning).is_ok();
        is_valid.then_some(previous)
    })
}

/// Spreads a wave from the shield, with the robot's surroundings as a blocker, and the centre cells
/// behind the shield as another: each way back to it ends ahead of it.
pub(super) fn spread_ahead_of<const TILES: usize, const SLOTS: usize>(
    shield: Shield,
    round: &mut PlanningContext<'_, TILES, SLOTS>,
    scratch: &mut PlanningScratch<'_>,
    robot: Site,
) -> Option<()> {
    let centres = round.centres()?;
    let frame = centres.frame;
    let own = shield.cells().filter(|&cell| centres.is_centre(cell));
    let own: heapless::Vec<Cell, MOST_CUT> = own.take(MOST_CUT).collect();
    let from = frame.site(*own.first()?)?;
    let behind = own.iter().flat_map(|&on_it| shield.behind(on_it));
    let behind = behind.filter_map(|cell| frame.site(cell));
    round.propagate(from, surroundings(robot).chain(behind), None, scratch)
}

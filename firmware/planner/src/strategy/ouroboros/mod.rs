//! Strategy *ouroboros*: explore, and close every loop on the way [Jorge15, Algorithm 1].
//!
//! ```text
//! line 3:      update the Voronoi cells                              (topology, the space that is not obstacle)
//! line 4:      move the robot to the Voronoi                         (nearest)
//! lines 5–10:  move, disable or generate the tractor point           (tractor, marks, crumbs)
//! line 12:     propagate from it, the robot as a blocker
//! lines 13–17: the loop road, by the previous shield if there is one (loop_road)
//! line 19:     the shield                                            (shield)
//! line 21:     propagate from it, the shield as a blocker
//! line 24:     else propagate from the unexplored                    (frontier)
//! line 26:     none is left: the exploration is complete, unless a loop is open (errand)
//! ```
//!
//! A round takes up to three calls of [`Ouroboros::advance`], each with one wave at most, all on the same published
//! skeleton. Between two calls nothing of the wave is needed, so its memory may serve elsewhere.
//!
//! What is kept from round to round lies in the map's cells, not in the skeleton's: tractor point, shield, marks and path outlast any
//! number of skeletons. Departs from [Jorge15, line 18]: a loop road that is not found is missed for
//! `LOST_ROUNDS` rounds before the loop is lost, since a skeleton may grow a spur under the robot for a moment; and loops that
//! are lost again and again are given up, or the robot might begin and lose the same one for ever.
//!
//! Units: map cells, metres, milliseconds.

pub mod closed_regions;
pub mod ground;
pub mod loop_budget;
pub mod loop_road;
mod revisit;
pub mod round;
pub mod shield;
pub mod tractor;

#[cfg(test)]
mod exploring;
#[cfg(test)]
mod scenes;

use crate::geometry::{CELL_M, Cell, Pose};
use crate::grid::Site;
use crate::math;
use crate::path::breadcrumbs::Crumbs;
use crate::path::cell_path::Path;
use crate::path::{PlanningScratch, RoundOutcome};
use crate::roadmap::Residues;
use crate::roadmap::branches::surroundings;
use crate::strategy::Frontier;
use crate::strategy::ouroboros::closed_regions::Marks;
use crate::strategy::ouroboros::loop_budget::Detour;
use crate::strategy::ouroboros::loop_road::{LoopRoad, build_shield, way_back};
use crate::strategy::ouroboros::revisit::Errand;
pub use crate::strategy::ouroboros::round::Round;
use crate::strategy::ouroboros::round::STEP_M;
use crate::strategy::ouroboros::shield::Shield;
use crate::strategy::ouroboros::tractor::Fate;

/// Rounds in a row without a loop road after which the loop is lost.
const LOST_ROUNDS: u8 = 3;
/// Loops lost after which the next one that is lost is given up, since a loop was last closed or given up.
const MOST_LOST: u8 = 3;

/// What a round is at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// Lines 3 to 19.
    Look,
    /// Line 21, to the robot's cell.
    Close(Site),
    /// Line 24.
    Explore,
    /// Line 26: whether there is an errand left.
    Search,
}

/// What the strategy remembers; `SLOTS` as the map's.
#[derive(Debug)]
pub struct Ouroboros<const SLOTS: usize> {
    /// `previousTractorPoint`, a coarse cell.
    tractor: Option<Cell>,
    /// `previousShield`: a loop is being closed.
    shield: Option<Shield>,
    marks: Marks<SLOTS>,
    crumbs: Crumbs,
    detour: Detour,
    /// Nothing is left to explore, and a loop may be open here.
    errand: Option<Errand>,
    /// Length expected of the loop, and of the way back from where it was begun, metres.
    loop_m: f32,
    back_m: f32,
    lost_rounds: u8,
    lost_loops: u8,
    stage: Stage,
    robot: Option<Cell>,
    tally: Tally,
}

/// What became of loops.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Tractor points that were reached by the way ahead.
    pub closed: u16,
    /// Loops that turned out not to exist, or not to be worth the way.
    pub given_up: u16,
}

impl<const SLOTS: usize> Ouroboros<SLOTS> {
    /// At the start [Jorge15, line 1].
    #[must_use]
    pub const fn new() -> Self {
        Self {
            tractor: None,
            shield: None,
            marks: Marks::new(),
            crumbs: Crumbs::new(),
            detour: Detour::new(),
            errand: None,
            loop_m: 0.0,
            back_m: 0.0,
            lost_rounds: 0,
            lost_loops: 0,
            stage: Stage::Look,
            robot: None,
            tally: Tally {
                closed: 0,
                given_up: 0,
            },
        }
    }

    /// Forget everything; the map's box is so many tiles across and up.
    pub fn reset(&mut self, box_tiles: (i32, i32)) {
        self.marks.reset(box_tiles);
        (self.tractor, self.shield) = (None, None);
        (self.crumbs, self.detour) = (Crumbs::new(), Detour::new());
        self.errand = None;
        (self.loop_m, self.back_m) = (0.0, 0.0);
        (self.lost_rounds, self.lost_loops) = (0, 0);
        (self.stage, self.robot) = (Stage::Look, None);
        self.tally = Tally::default();
    }

    /// The tractor point, a coarse cell.
    #[must_use]
    pub const fn tractor(&self) -> Option<Cell> {
        self.tractor
    }

    /// The shield behind the robot; its cells are obstacles in the window. There is one while a loop is being closed.
    #[must_use]
    pub const fn shield(&self) -> Option<&Shield> {
        self.shield.as_ref()
    }

    /// Length expected of the loop that is being closed, metres.
    #[must_use]
    pub const fn loop_m(&self) -> f32 {
        self.loop_m
    }

    /// The surroundings of closed loops.
    #[must_use]
    pub const fn marks(&self) -> &Marks<SLOTS> {
        &self.marks
    }

    /// What became of loops.
    #[must_use]
    pub const fn tally(&self) -> Tally {
        self.tally
    }

    /// The robot is here; to be called in every step.
    pub fn note_pose(&mut self, pose: &Pose) {
        let robot = pose.point().cell();
        self.crumbs.note(robot);
        let last = self.robot.replace(robot);
        let stride_m = last.map_or(0.0, |last| distance_m(last, robot));
        if self.shield.is_some() {
            self.marks.note(robot);
            self.detour.note(stride_m, self.loop_m);
        } else if let Some(errand) = &mut self.errand {
            errand.detour.note(stride_m, 0.0);
        }
    }

    /// Go on with the round on the published skeleton; `None` when it needs another call on the same one, else what it says.
    ///
    /// The first call of a round comes when a skeleton was published, after [`Frontier::cut`]. The path, to the tractor point or to
    /// the unexplored, becomes the one of `frontier`, which bars ways and drops goals.
    pub fn advance<const TILES: usize>(
        &mut self,
        frontier: &mut Frontier,
        mut round: Round<'_, TILES, SLOTS>,
        mut lent: PlanningScratch<'_>,
    ) -> Option<RoundOutcome> {
        match core::mem::replace(&mut self.stage, Stage::Look) {
            Stage::Look => self.look(&mut round, &mut lent),
            Stage::Close(robot) => self.close(frontier, &mut round, &mut lent, robot),
            Stage::Explore if self.errand.is_some() => {
                self.go_on_errand(frontier, &mut round, &mut lent)
            }
            // Lines 24 and 26.
            Stage::Explore => {
                let robot = round.pose.point();
                let outlook = frontier.replan(&round.known(), robot, round.time_ms, lent);
                if outlook == RoundOutcome::Nothing {
                    self.stage = Stage::Search;
                    return None;
                }
                Some(outlook)
            }
            Stage::Search => self.search(&mut round, &mut lent),
        }
    }

    /// Line 26: nothing is left to explore. Look for a loop that is open, at one branch a call.
    fn search<const TILES: usize>(
        &mut self,
        round: &mut Round<'_, TILES, SLOTS>,
        lent: &mut PlanningScratch<'_>,
    ) -> Option<RoundOutcome> {
        self.stage = match revisit::find(round, &mut self.marks, lent) {
            revisit::Found::None => return Some(RoundOutcome::Nothing),
            revisit::Found::NotHere => Stage::Search,
            revisit::Found::Place(goal) => {
                self.errand = Some(Errand::to(goal));
                Stage::Explore
            }
        };
        None
    }

    /// The way to an open loop; in it a tractor point is made as anywhere.
    fn go_on_errand<const TILES: usize>(
        &mut self,
        frontier: &mut Frontier,
        round: &mut Round<'_, TILES, SLOTS>,
        lent: &mut PlanningScratch<'_>,
    ) -> Option<RoundOutcome> {
        let goal = self.errand?.goal;
        let path = path_to(goal, round, lent).filter(|path| {
            let errand = self.errand.as_mut();
            let is_over = errand.is_none_or(|errand| errand.is_over(path.steps(), round.limits));
            path.steps() > revisit::DONE_STEPS && !is_over
        });
        if let Some(path) = path {
            let (known, robot) = (round.known(), round.pose.point());
            return Some(frontier.follow(path, &known, robot, round.time_ms, lent.view));
        }
        // No loop was begun on the way here.
        revisit::settle(round, &mut self.marks, goal);
        self.errand = None;
        self.stage = Stage::Search;
        None
    }

    /// Lines 3 to 19: tractor point, loop road and shield.
    fn look<const TILES: usize>(
        &mut self,
        round: &mut Round<'_, TILES, SLOTS>,
        lent: &mut PlanningScratch<'_>,
    ) -> Option<RoundOutcome> {
        self.stage = Stage::Explore;
        let robot = round.nearest(round.pose.point().cell(), lent)?;
        if self.tractor.is_some() {
            self.move_tractor(round, lent);
        } else {
            self.tractor = self.generate_tractor(round, lent);
        }
        let tractor = round.topology.frame().site(self.tractor?)?;
        let shield = match self.shield {
            Some(previous) => renew(previous, round, lent, robot),
            None => self.begin(round, lent, [robot, tractor]),
        };
        match shield {
            Some(shield) => {
                self.shield = Some(shield);
                self.stage = Stage::Close(robot);
            }
            None if self.shield.is_some() => return self.lose(),
            None => {}
        }
        None
    }

    /// Lines 5 to 8.
    fn move_tractor<const TILES: usize>(
        &mut self,
        round: &Round<'_, TILES, SLOTS>,
        lent: &mut PlanningScratch<'_>,
    ) {
        let centre = self
            .tractor
            .filter(|&tractor| round.ground().is_some_and(|ground| ground.is_open(tractor)))
            .and_then(|tractor| round.nearest(tractor, lent))
            .map(|site| round.topology.frame().cell(site));
        let is_closing = self.shield.is_some();
        match centre.map(|centre| tractor::fate(centre, &round.pose, is_closing)) {
            Some(Fate::Stays) => self.tractor = centre,
            Some(Fate::Reached) if is_closing => {
                self.tally.closed += 1;
                self.settle();
            }
            // It has fallen on an obstacle, or is of no use.
            None | Some(Fate::Reached | Fate::Stale) => {
                self.marks.forget();
                self.disable_tractor();
            }
        }
    }

    /// Line 8.
    fn disable_tractor(&mut self) {
        (self.tractor, self.shield) = (None, None);
        (self.lost_rounds, self.loop_m) = (0, 0.0);
    }

    /// Line 10.
    fn generate_tractor<const TILES: usize>(
        &self,
        round: &Round<'_, TILES, SLOTS>,
        lent: &mut PlanningScratch<'_>,
    ) -> Option<Cell> {
        let candidate = tractor::candidate(&self.crumbs, &self.marks, &round.pose)?;
        let centre = round.topology.frame().cell(round.nearest(candidate, lent)?);
        tractor::suits(centre, candidate, &self.marks, &round.pose).then_some(centre)
    }

    /// Lines 12 and 17 to 19: a loop that is worth closing, and the shield behind the robot.
    fn begin<const TILES: usize>(
        &mut self,
        round: &mut Round<'_, TILES, SLOTS>,
        lent: &mut PlanningScratch<'_>,
        [robot, tractor]: [Site; 2],
    ) -> Option<Shield> {
        round.propagate(tractor, surroundings(robot), None, lent)?;
        let ground = round.ground()?;
        let residues = Residues::new(ground.frame.shape, lent.residues).ok()?;
        let here = round.pose.point().cell();
        let came = self.crumbs.came_from(here)?;
        let path = LoopRoad::find(&ground, &residues, (robot, came))?;
        let meet = ground.cell(path.meet);
        let loop_m = path.steps() as f32 * STEP_M;
        if !round.limits.is_worth(loop_m, round.frontier_m()?)
            || !tractor::may_be_at(meet, &self.marks, &round.pose)
        {
            return None;
        }
        let shield = build_shield(&ground, path.back(&residues), here)?;
        self.tractor = Some(meet);
        self.loop_m = loop_m;
        self.back_m = path.back(&residues).count() as f32 * STEP_M;
        if self.lost_loops == 0 {
            self.detour = Detour::new();
        }
        // The loop's surroundings are those of the way back, and of the way that the robot will come.
        self.marks.forget();
        for site in path.back(&residues) {
            self.marks.note(ground.cell(site));
        }
        Some(shield)
    }

    /// The loop is not to hold the robot; nor is another try at it.
    fn give_up(&mut self) {
        self.tally.given_up += 1;
        self.settle();
    }

    /// No other tractor point is to be made here.
    fn settle(&mut self) {
        self.marks.keep();
        self.errand = None;
        self.lost_loops = 0;
        self.disable_tractor();
    }

    /// No loop road, or no shield, although a loop was being closed: the way so far is good for some rounds more.
    fn lose(&mut self) -> Option<RoundOutcome> {
        self.lost_rounds += 1;
        if self.lost_rounds < LOST_ROUNDS {
            self.stage = Stage::Look;
            return Some(RoundOutcome::Path);
        }
        self.lost_loops += 1;
        if self.lost_loops > MOST_LOST {
            self.give_up();
        } else {
            (self.shield, self.lost_rounds) = (None, 0);
            self.marks.forget();
        }
        None
    }

    /// Line 21: the way to the tractor point, the shield behind the robot.
    fn close<const TILES: usize>(
        &mut self,
        frontier: &mut Frontier,
        round: &mut Round<'_, TILES, SLOTS>,
        lent: &mut PlanningScratch<'_>,
        robot: Site,
    ) -> Option<RoundOutcome> {
        let path = self.path_to_tractor(round, lent, robot);
        if let Some(path) = path {
            self.lost_rounds = 0;
            self.loop_m = self.back_m + path.steps() as f32 * STEP_M;
            let too_long = round.limits.is_too_long(self.loop_m, round.frontier_m()?);
            if too_long || self.detour.is_over(round.limits) {
                self.stage = Stage::Explore;
                self.give_up();
                return None;
            }
            let robot = round.pose.point();
            let known = round.known();
            return Some(frontier.follow(path, &known, robot, round.time_ms, lent.view));
        }
        self.stage = Stage::Explore;
        self.lose()
    }

    fn path_to_tractor<const TILES: usize>(
        &self,
        round: &mut Round<'_, TILES, SLOTS>,
        lent: &mut PlanningScratch<'_>,
        robot: Site,
    ) -> Option<Path> {
        let frame = round.topology.frame();
        let tractor = frame.site(self.tractor?)?;
        let shield = self.shield?;
        let cells = shield.cells().filter_map(|cell| frame.site(cell));
        round.propagate(tractor, cells, Some(robot), lent)?;
        let residues = Residues::new(frame.shape, lent.residues).ok()?;
        residues.get(robot)?;
        let way = core::iter::once(robot).chain(residues.descent(robot));
        Some(Path::along(way.map(|site| frame.cell(site))))
    }
}

impl<const SLOTS: usize> Default for Ouroboros<SLOTS> {
    fn default() -> Self {
        Self::new()
    }
}

/// Lines 14 and 19: the shield on the way from the robot back to the previous one; that one, if there is no better and it stands.
fn renew<const TILES: usize, const SLOTS: usize>(
    mut previous: Shield,
    round: &mut Round<'_, TILES, SLOTS>,
    lent: &mut PlanningScratch<'_>,
    robot: Site,
) -> Option<Shield> {
    let ground = round.ground()?;
    let on_it = previous.cells().find(|&cell| ground.is_centre(cell))?;
    let from = ground.frame.site(on_it)?;
    round.propagate(from, surroundings(robot), None, lent)?;
    let ground = round.ground()?;
    let residues = Residues::new(ground.frame.shape, lent.residues).ok()?;
    let back = way_back(ground.way, &residues, robot)?;
    let next = build_shield(&ground, back, round.pose.point().cell());
    next.or_else(|| previous.stretch(&ground).is_ok().then_some(previous))
}

/// The way along the skeleton from the robot to a centre cell, or to the one nearest to where it was.
fn path_to<const TILES: usize, const SLOTS: usize>(
    place: Cell,
    round: &mut Round<'_, TILES, SLOTS>,
    lent: &mut PlanningScratch<'_>,
) -> Option<Path> {
    let robot = round.nearest(round.pose.point().cell(), lent)?;
    let goal = round.nearest(place, lent)?;
    round.propagate(goal, core::iter::empty(), Some(robot), lent)?;
    let frame = round.topology.frame();
    let residues = Residues::new(frame.shape, lent.residues).ok()?;
    residues.get(robot)?;
    let way = core::iter::once(robot).chain(residues.descent(robot));
    Some(Path::along(way.map(|site| frame.cell(site))))
}

fn distance_m(a: Cell, b: Cell) -> f32 {
    let (dx, dy) = ((a.x - b.x) as f32, (a.y - b.y) as f32);
    math::sqrt(dx * dx + dy * dy) * CELL_M
}

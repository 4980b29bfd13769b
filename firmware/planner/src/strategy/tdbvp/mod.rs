//! Strategy *tdbvp*: time-driven rails [Maffei14, IV and V].
//!
//! The robot follows −∇p in a window in which every centre cell is charged: with the time since it was visited, or
//! as the best there is where it was not. So it prefers the unexplored to the visited and the long forgotten to the
//! fresh, turns to the side where it saw openings, and never comes to rest: explored, it patrols, for
//! as long as the session asks for.
//!
//! Where a rail vanishes from the window, or none in it attracts, the robot follows a *path* instead: to the nearest
//! unexplored along the skeleton, on patrol to the oldest rail; to the skeleton itself where it is off it, by
//! `nearest` [Maffei14, VII: the nearest rail, else the unexplored, else the skeleton].
//!
//! Departs from the paper:
//! - Unexplored cells are goals only until [`Frontier`] has given them up, and a robot that lingers follows a path for a while; there the paper
//!   has no rule, and stands before what it cannot see.
//! - A robot to which nothing new came for `PATIENCE_MS` while something is left follows a path. The paper relies on its rails to
//!   lead there in the end.
//! - On patrol a robot goes by path to a rail that is overdue: the rails lead to the oldest in the window, and what lies beyond may wait for
//!   ever. So the age of the oldest is bounded, by a tour of everything and the way there.
//!
//! Units: map cells, metres, milliseconds.

mod charges;
mod pending_visits;
pub mod rails;
pub mod sides;

#[cfg(test)]
mod scenes;

use crate::field::local_grid::LocalGrid;
use crate::field::{Preference, SIDE, Window};
use crate::geometry::{CELL_M, Cell, Point, Pose};
use crate::map::Tiles;
use crate::path::Path;
use crate::path::nearest::Centres;
use crate::path::search::PathSearch;
use crate::path::{PlanningScratch, RoundOutcome};
use crate::roadmap::skeleton::Skeleton;
use crate::robot::LaserMount;
use crate::strategy::Frontier;
use crate::strategy::ouroboros::Round;
use crate::strategy::tdbvp::charges::{CentreCells, charge_rails, prefer, unexplored};
use crate::strategy::tdbvp::pending_visits::{Fresh, VISIT_M};
pub use crate::strategy::tdbvp::rails::Rails;
use crate::strategy::tdbvp::sides::Sides;

/// Time without a first visit after which a robot that has something left to explore follows a path to it, milliseconds.
/// With a minute, three adjacent loops took 378 s instead of 343 (means of four starts), and rooms without a loop 810 s instead of 584.
const PATIENCE_MS: u32 = 15_000;
/// A robot that is within so many metres for so many milliseconds lingers.
const LINGER_M: f32 = 1.0;
const LINGER_MS: u32 = 15_000;
/// Centre cells this near are free while it explores, metres, so this is how far ahead the nearest rail attracts. At 0.5 m there is no room
/// left in the half disc for a preferred side, and at a cross 10 of 20 robots went straight on; at 1 m 10 of 100.
const ROOM_M: f32 = 1.2;
/// Where it lingered, centre cells this near count as visited, metres: what draws it cannot be got to.
const LINGER_VISIT_M: f32 = 2.0;

/// Steps that a centre cell adds to the least that a tour takes: its 20 cm, at half a metre a second and [`STEP_MS`] a step. On
/// patrol a rail that was not visited for that long is overdue.
const STEPS_PER_CELL: u32 = 2;
const STEP_MS: u32 = 200;

/// What the strategy remembers; `SLOTS` as the map's.
#[derive(Debug)]
pub struct Tdbvp<const SLOTS: usize> {
    rails: Rails<SLOTS>,
    fresh: Fresh,
    sides: Sides,
    /// A path is followed, not the rails.
    on_path: bool,
    /// When a place was visited for the first time, and what time it is.
    new_ms: u32,
    now_ms: u32,
    /// Where the robot was when it last left a place, and when.
    left: Point,
    left_ms: u32,
    lingers: bool,
    /// How long to patrol, and since when it does.
    patrol_ms: u32,
    since_ms: Option<u32>,
}

/// What the window is made of, for a charge.
#[derive(Debug)]
pub struct Surroundings<'a, const TILES: usize, const SLOTS: usize> {
    /// The published skeleton.
    pub topology: &'a Skeleton<SLOTS>,
    /// The map.
    pub tiles: &'a Tiles<TILES, SLOTS>,
    /// Where the robot is.
    pub pose: Pose,
}

impl<const SLOTS: usize> Tdbvp<SLOTS> {
    /// At the start.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            rails: Rails::new(),
            fresh: Fresh::new(),
            sides: Sides::new(),
            on_path: false,
            new_ms: 0,
            now_ms: 0,
            left: Point { x_m: 0.0, y_m: 0.0 },
            left_ms: 0,
            lingers: false,
            patrol_ms: 0,
            since_ms: None,
        }
    }

    /// Forget everything; the map's box is so many tiles across and up, and the patrol so long.
    pub fn reset(&mut self, box_tiles: (i32, i32), patrol_s: u16) {
        self.rails.reset(box_tiles);
        (self.fresh, self.sides) = (Fresh::new(), Sides::new());
        (self.on_path, self.lingers) = (false, false);
        (self.new_ms, self.now_ms) = (0, 0);
        (self.left, self.left_ms) = (Point { x_m: 0.0, y_m: 0.0 }, 0);
        (self.patrol_ms, self.since_ms) = (u32::from(patrol_s) * 1000, None);
    }

    /// When centre cells were visited.
    #[must_use]
    pub const fn rails(&self) -> &Rails<SLOTS> {
        &self.rails
    }

    /// Which side is preferred.
    #[must_use]
    pub const fn sides(&self) -> &Sides {
        &self.sides
    }

    /// Whether the exploration is over and the patrol is on.
    #[must_use]
    pub const fn is_patrolling(&self) -> bool {
        self.since_ms.is_some()
    }

    /// The exploration is over; whether a patrol begins.
    pub fn begin_patrol(&mut self) -> bool {
        let begins = self.patrol_ms > 0 && self.since_ms.is_none();
        if begins {
            self.since_ms = Some(self.now_ms);
            // The last search, for which the robot stood, is not lingering.
            (self.left_ms, self.lingers) = (self.now_ms, false);
            self.fresh.begin_patrol(&mut self.rails);
        }
        begins
    }

    /// The robot is here; to be called in every step, with the scan of the level laser.
    pub fn note(&mut self, pose: &Pose, time_ms: u32, scan: Option<(&LaserMount, &[u16])>) {
        self.now_ms = time_ms;
        self.rails.pass();
        if let Some((laser, ranges_mm)) = scan {
            self.sides.note(laser, ranges_mm);
        }
        let here = pose.point();
        self.fresh.come(here.cell());
        let (dx, dy) = (here.x_m - self.left.x_m, here.y_m - self.left.y_m);
        if dx * dx + dy * dy > LINGER_M * LINGER_M {
            (self.left, self.left_ms) = (here, time_ms);
        } else if time_ms.wrapping_sub(self.left_ms) > LINGER_MS {
            self.left_ms = time_ms;
            self.lingers = true;
        }
    }

    /// Charge the window with the rails; whether that leads the robot anywhere, or a path must.
    pub fn charge<const TILES: usize>(
        &mut self,
        frontier: &Frontier,
        around: &Surroundings<'_, TILES, SLOTS>,
        (window, view): (&mut Window, &LocalGrid),
    ) -> bool {
        let robot = around.pose.point();
        let Some(way) = around.topology.skeleton() else {
            return false;
        };
        let frame = around.topology.frame();
        let centres = CentreCells { frame, way };
        self.visit(&centres, robot);
        window.set_preferences(|_, _| Preference::NONE);
        if self.on_path {
            return false;
        }
        let goals = if self.is_patrolling() {
            [0; SIDE]
        } else {
            let given_up = frontier.dropped().iter().map(|goal| goal.cell);
            unexplored(view, around.tiles, given_up)
        };
        let dates = (&self.rails, &self.fresh);
        charge_rails(
            window,
            view,
            dates,
            &centres,
            (robot, self.room_m()),
            &goals,
        );
        let ahead = self.fresh.ahead(robot.cell());
        let front = self.sides.preferred().zip(ahead);
        if let Some(front) = front.filter(|_| charges::parts(&centres, robot)) {
            prefer(window, view, robot, front);
        }
        view.place(robot.cell())
            .is_some_and(|(x, y)| window.is_reached(x, y))
    }

    /// Centre cells this near are free, metres.
    const fn room_m(&self) -> f32 {
        if self.is_patrolling() {
            VISIT_M
        } else {
            ROOM_M
        }
    }

    /// Today the robot visits the centre cells beside it.
    fn visit(&mut self, centres: &CentreCells<'_>, robot: Point) {
        let radius_m = if self.lingers {
            LINGER_VISIT_M
        } else {
            VISIT_M
        };
        let (rails, fresh) = (&mut self.rails, &mut self.fresh);
        let is_patrolling = self.since_ms.is_some();
        fresh.leave(robot.cell(), rails, is_patrolling, |middle, half, visit| {
            centres.around(middle, half, visit);
        });
        let mut is_new = false;
        centres.around(robot.cell(), (radius_m / CELL_M) as i32 + 2, |cell| {
            if charges::distance_m(cell, robot) <= radius_m {
                is_new |= fresh.visit(cell, rails);
            }
        });
        if self.lingers {
            self.fresh.settle(&mut self.rails);
            self.new_ms = self.now_ms.wrapping_sub(PATIENCE_MS);
            self.lingers = false;
        } else if is_new {
            self.new_ms = self.now_ms;
        }
    }

    /// A round on a new skeleton: whether anything is left, and the path to it, in case the rails lead nowhere.
    pub fn advance<const TILES: usize>(
        &mut self,
        frontier: &mut Frontier,
        mut round: Round<'_, TILES, SLOTS>,
        mut lent: PlanningScratch<'_>,
    ) -> RoundOutcome {
        if let Some(since_ms) = self.since_ms {
            if round.time_ms.wrapping_sub(since_ms) >= self.patrol_ms {
                return RoundOutcome::Nothing;
            }
            return self.patrol(frontier, &mut round, &mut lent, since_ms);
        }
        let robot = round.pose.point();
        let is_late = round.time_ms.wrapping_sub(self.new_ms) >= PATIENCE_MS;
        let (outlook, is_free) =
            frontier.glance(&round.known(), robot, round.time_ms, lent, is_late);
        // What remains for the second chance is where the robot just fits through.
        self.on_path = !is_free || frontier.is_second_chance();
        outlook
    }

    /// A round of the patrol: the path to the oldest rail, which is followed where it is overdue and where the rails lead nowhere.
    fn patrol<const TILES: usize>(
        &mut self,
        frontier: &mut Frontier,
        round: &mut Round<'_, TILES, SLOTS>,
        lent: &mut PlanningScratch<'_>,
        since_ms: u32,
    ) -> RoundOutcome {
        let oldest = self.oldest(round, since_ms);
        let path = oldest.and_then(|(oldest, _)| self.path_to(oldest, round, lent));
        self.on_path = path.is_some() && oldest.is_some_and(|(_, is_overdue)| is_overdue);
        let Some(path) = path else {
            return RoundOutcome::Unsure;
        };
        let (known, robot) = (round.known(), round.pose.point());
        match frontier.follow(path, &known, robot, round.time_ms, lent.view) {
            RoundOutcome::Path => RoundOutcome::Path,
            // There is always another rail.
            _ => {
                frontier.go_on();
                RoundOutcome::Unsure
            }
        }
    }

    /// The rank of the oldest rails, and whether they are overdue: not visited for as long as a tour of all takes at least.
    fn oldest<const TILES: usize>(
        &self,
        round: &Round<'_, TILES, SLOTS>,
        since_ms: u32,
    ) -> Option<(u8, bool)> {
        let way = round.topology.skeleton()?;
        let frame = round.topology.frame();
        let tour_steps = STEPS_PER_CELL * way.count() as u32;
        // What was only seen comes first; what was not visited in a whole tour cannot be.
        let tour_ms = tour_steps.saturating_mul(STEP_MS);
        let is_first = round.time_ms.wrapping_sub(since_ms) < tour_ms;
        let ranks = way.sites().map(|site| self.rank(frame.cell(site)));
        let oldest = ranks.filter(|&rank| is_first || rank > 0).min()?;
        let is_overdue = oldest == 0 || self.rails.age_steps(oldest) > tour_steps;
        Some((oldest, is_overdue))
    }

    /// The older of two centre cells has the lesser rank; what the robot is visiting is the newest.
    fn rank(&self, cell: Cell) -> u8 {
        if self.fresh.holds(cell) {
            u8::MAX
        } else {
            self.rails.rank(cell)
        }
    }

    /// The way along the skeleton to the centre cells of a rank.
    fn path_to<const TILES: usize>(
        &self,
        oldest: u8,
        round: &mut Round<'_, TILES, SLOTS>,
        lent: &mut PlanningScratch<'_>,
    ) -> Option<Path> {
        let frame = round.topology.frame();
        let way = round.topology.skeleton()?;
        let rank = |site| self.rank(frame.cell(site));
        let centres = Centres {
            tiles: round.tiles,
            disc: round.disc,
            frame,
            way,
        };
        let mut paths = PathSearch::open(centres, lent)?;
        paths.spread(way.sites().filter(|&site| rank(site) == oldest));
        paths.path(round.pose.point().cell())
    }
}

impl<const SLOTS: usize> Default for Tdbvp<SLOTS> {
    fn default() -> Self {
        Self::new()
    }
}

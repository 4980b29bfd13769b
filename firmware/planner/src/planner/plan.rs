//! Planning on a new skeleton: one round of the strategy, and the search for viewpoints once no
//! frontier can be reached \[Jorge15, Algorithm 1, lines 4 and 23\].
//!
//! Units: metres, map cells.

use crate::geometry::Point;
use crate::path::utility::GoalOrder;
use crate::path::viewpoint::{Found, Inputs};
use crate::path::{PlanningContext, RoundOutcome};
use crate::planner::step::Step;
use crate::roadmap::configuration_space::Footprint;
use crate::status::{Fault, Status};

/// Distance ahead of the robot's centre at which unmeasured ground stops it, metres: between its
/// front and where the tilted beams meet level ground.
const FRONT_M: f32 = 0.8;

impl<const TILES: usize, const SLOTS: usize> Step<'_, TILES, SLOTS> {
    /// Plans one round on a new skeleton. Returns false if the next step must continue the round.
    #[inline(never)]
    pub(super) fn replan(&mut self) -> bool {
        let Some(outcome) = self.advance_round() else {
            return false;
        };
        if self.config.ground.is_some() {
            self.resolve_unmeasured();
        }
        match outcome {
            RoundOutcome::Nothing | RoundOutcome::Stuck if self.state.errands.is_going() => {
                self.state.give_up_errand();
            }
            RoundOutcome::Nothing if self.may_search_viewpoints() => self.state.viewpoints.begin(),
            RoundOutcome::Nothing => self.end(),
            RoundOutcome::Stuck => self.state.status = Status::Fault(Fault::Stuck),
            // The next goals are judged on the same skeleton: the next one is a second away, and
            // the robot stands.
            RoundOutcome::Unsure if self.state.strategy.frontier.judges_on() => return false,
            RoundOutcome::Path | RoundOutcome::Unsure => {}
        }
        true
    }

    /// Lets the strategy, or the errand, plan on the skeleton. Returns `None` if the next step must
    /// continue.
    fn advance_round(&mut self) -> Option<RoundOutcome> {
        let (config, state) = (self.config, &mut *self.state);
        let waits_for_peers = state.cut_peers(&self.footprint, self.input.time_ms);
        let blocked = state.strategy.frontier.blocked().clone();
        let came_past = |place, within_m| state.drive.came_past(place, within_m);
        let came_through_blocked = blocked.any(came_past);
        let disc = Footprint::new(config.robot_radius_m);
        let context = PlanningContext {
            skeleton: &mut state.skeleton,
            tiles: state.map.tiles(),
            footprint: &self.footprint,
            disc: &disc,
            blocked: &blocked,
            pose: self.input.pose,
            time_ms: self.input.time_ms,
            limits: &config.loops,
            goal_level: config.goal_level,
            order: GoalOrder::of(config),
            tuning: config.tuning,
            levels: state.ground.level_cost(config, &state.preferences),
            team: state.team.is_member().then_some(&state.team),
            must_wait: waits_for_peers || state.drive.is_retreating(),
            came_through_blocked,
            known_cells: state.map.known_cells(),
            openings_were_tried: state.strategy.frontier.has_further_chance(),
        };
        let scratch = self.workspace.planning(SLOTS);
        match state.errands.goal() {
            Some(goal) => Some(state.strategy.go_to(goal, context, scratch)),
            None => state.strategy.advance(context, scratch),
        }
    }

    /// Returns true if a look through a gap may show more. On uneven ground it does not: a look
    /// through a gap measures no ground.
    fn may_search_viewpoints(&self) -> bool {
        self.state.strategy.frontier.may_look()
            && !self.state.ground.is_uneven()
            && !self.state.strategy.is_patrolling()
    }

    /// Decides about ground that stayed unmeasured although the robot stood beside it.
    fn resolve_unmeasured(&mut self) {
        let state = &mut *self.state;
        while let Some(cell) = state.strategy.frontier.take_unobservable() {
            state.map.resolve_gaps(self.config, cell);
        }
        if state.strategy.frontier.take_stalled() {
            let front = Point {
                x_m: FRONT_M,
                y_m: 0.0,
            };
            let ahead = self.input.pose.to_map(front).cell();
            if state.map.free_gaps(self.config, ahead) {
                state.strategy.frontier.open_last_passage();
            }
        }
    }

    /// Continues the search for viewpoints: goes to the one that it found, or finishes.
    #[inline(never)]
    pub(super) fn search_viewpoints(&mut self) {
        let state = &mut *self.state;
        let disc = Footprint::new(self.config.robot_radius_m);
        let (residual, blocked) = state.strategy.frontier.given_up_mut();
        let inputs = Inputs {
            tiles: state.map.tiles(),
            // The skeleton stays the same while the search runs.
            tiling: state.skeleton.tiling(),
            frame: state.skeleton.frame(),
            footprints: [&disc, &self.footprint],
            robot: self.input.pose.point().cell(),
            blocked,
            order: GoalOrder::of(self.config),
        };
        let scratch = bytemuck::cast_slice_mut(&mut self.workspace.scratch);
        match state.viewpoints.advance(&inputs, residual, scratch) {
            Found::Pending => {}
            Found::Viewpoint(viewpoint) => {
                state.strategy.frontier.look_from(viewpoint);
                // The skeleton is still the one that the last round planned on.
                state.has_new_skeleton = true;
            }
            Found::Nothing => self.end(),
        }
    }

    /// Ends the exploration. If the map lacks room, the ways out of it are searched first.
    fn end(&mut self) {
        let (map, is_patrolling) = (&self.state.map, self.state.strategy.is_patrolling());
        if !is_patrolling && (map.out_of_box() || map.pool_full()) {
            self.state.exits.begin();
        } else {
            self.end_now(None);
        }
    }
}

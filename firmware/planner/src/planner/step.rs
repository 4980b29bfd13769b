//! The papers' algorithm box after sensing \[Jorge15, Algorithm 1, lines 3 to 29\], on what a step
//! lends to its parts.
//!
//! | the robot | it |
//! | --- | --- |
//! | searches for a recovery | stands, and the search owns the scratch |
//! | searches for viewpoints or exits | looks about, and the search owns the scratch |
//! | goes back out of a passage | drives along its own track |
//! | makes way for another robot | stands, or follows the field off the road |
//! | is on the last metre of an errand | drives straight |
//! | is led by forces of the strategy | follows their heading, without a window |
//! | has a local goal or rails | follows the window's field |
//! | has none of these | looks about, or stands |
//!
//! The first row that holds decides. Units: metres, radians, milliseconds.

use crate::config::Config;
use crate::doing::Doing;
use crate::field::{SolverConfig, Stop, solve};
use crate::geometry::{MapPose, Point, Twist};
use crate::input::Input;
use crate::planner::Output;
use crate::planner::deskew::{Moved, deskew};
use crate::planner::make_way::Way;
use crate::planner::state::State;
use crate::planner::workspace::Workspace;
use crate::profiling::{Stage, StageTimer};
use crate::roadmap::configuration_space::Footprint;

/// Thinning budget of a step, words of 32 coarse cells. It is about 1.3 million instructions
/// (`tests/golden/costs.txt`).
const THINNING_WORDS: u32 = 3_000;

/// What a step lends to its parts.
#[derive(Debug)]
pub(super) struct Step<'a, const TILES: usize, const SLOTS: usize> {
    pub(super) config: &'a Config,
    pub(super) state: &'a mut State<TILES, SLOTS>,
    pub(super) workspace: &'a mut Workspace,
    /// The disc that paths and windows are planned for.
    pub(super) footprint: Footprint,
    /// What the robot sensed; its pose is that in the map.
    pub(super) input: Input<'a>,
}

/// Runs one step, but for its status and the note of what the robot is told.
pub(super) fn explore<const TILES: usize, const SLOTS: usize>(
    config: &Config,
    state: &mut State<TILES, SLOTS>,
    workspace: &mut Workspace,
    (input, moved): (&Input<'_>, Option<&Moved>),
    timer: &mut impl StageTimer,
) -> Output {
    if !state.status.goes_on() {
        return Output::default();
    }
    let sensed = deskew(config, input, moved, &mut workspace.scans);
    let Some(MapPose(pose)) = state.sense(config, sensed, timer) else {
        return Output::default();
    };
    // No later stage reads a scan.
    let input = Input {
        pose,
        scans: [&[], &[]],
        ..*input
    };
    Step::new(config, state, workspace, input).act(timer)
}

impl<'a, const TILES: usize, const SLOTS: usize> Step<'a, TILES, SLOTS> {
    /// Lends memory to a step with this input, whose pose is that in the map.
    pub(super) fn new(
        config: &'a Config,
        state: &'a mut State<TILES, SLOTS>,
        workspace: &'a mut Workspace,
        input: Input<'a>,
    ) -> Self {
        Self {
            config,
            state,
            workspace,
            footprint: Footprint::new(config.passage_radius_m()),
            input,
        }
    }

    /// Returns the robot's place in the map.
    pub(super) fn robot(&self) -> Point {
        self.input.pose.point()
    }

    /// Plans and drives.
    fn act(&mut self, timer: &mut impl StageTimer) -> Output {
        let drive = &self.state.drive;
        let searches = drive.is_searching();
        let looks = self.state.viewpoints.is_running() || self.state.exits.is_running();
        if searches || drive.is_retreating() || looks {
            self.state.strategy.frontier.hold(self.config.period_ms());
        }
        if searches {
            let output = self.steer(self.state.lead_rad());
            timer.mark(Stage::Drive);
            return output;
        }
        if looks {
            self.search_map();
            timer.mark(Stage::Plan);
            return self.look_for_gaps();
        }
        let planned = self.advance_plan(timer);
        if !self.state.status.drives() {
            return Output::default();
        }
        if let Some(velocity) = self.go_back() {
            timer.mark(Stage::Drive);
            return Output {
                velocity,
                doing: Doing::GoesBack,
                ..Output::default()
            };
        }
        self.follow_window(planned, timer)
    }

    /// Continues the search for viewpoints, or for ways out of the map.
    fn search_map(&mut self) {
        if self.state.exits.is_running() {
            self.search_exits();
        } else {
            self.search_viewpoints();
        }
    }

    /// Returns the output of a step that searches for viewpoints, or for ways out of the map.
    fn look_for_gaps(&mut self) -> Output {
        if !self.state.status.drives() {
            return Output::default();
        }
        Output {
            velocity: self.look_about(),
            doing: Doing::LooksForGaps,
            ..Output::default()
        }
    }

    /// Plans on a new skeleton, or continues to thin the next one. Planning on a skeleton begins in
    /// the step after it is complete, so no step does both. Returns true if this step planned.
    #[inline(never)]
    fn advance_plan(&mut self, timer: &mut impl StageTimer) -> bool {
        let planned = if self.state.has_new_skeleton {
            self.state.has_new_skeleton = !self.replan();
            self.state.errands.note_planned(self.config);
            true
        } else if self.state.errands.take_due() {
            self.measure_way_home();
            true
        } else {
            self.state.has_new_skeleton = self.state.skeleton.advance(
                self.state.map.tiles(),
                &self.footprint,
                bytemuck::cast_slice_mut(&mut self.workspace.scratch),
                THINNING_WORDS,
            );
            false
        };
        timer.mark(if planned {
            Stage::Plan
        } else {
            Stage::Topology
        });
        planned
    }

    /// Returns the velocity back along the robot's own track; `None` unless it goes back.
    fn go_back(&mut self) -> Option<Twist> {
        let frontier = &mut self.state.strategy.frontier;
        if frontier.take_blocked() || frontier.goes_back() {
            self.begin_retreat();
        }
        let goes_back = self.state.drive.is_retreating();
        goes_back.then(|| self.retreat())
    }

    /// Charges and solves the window, and follows its field; or drives where no window is needed,
    /// or stands.
    fn follow_window(&mut self, planned: bool, timer: &mut impl StageTimer) -> Output {
        let way = self.way();
        match way {
            Way::Hold => {
                timer.mark(Stage::Window);
                return Output::waiting();
            }
            // The window is charged with the way already.
            Way::Retreat => {}
            Way::Free => {
                if let Some(output) = self.go_straight() {
                    timer.mark(Stage::Drive);
                    return output;
                }
                if !self.charge() {
                    timer.mark(Stage::Window);
                    return self.without_path();
                }
            }
        }
        self.prefer();
        timer.mark(Stage::Window);
        let solver = budget(self.config, planned);
        let Workspace {
            window, scratch, ..
        } = &mut *self.workspace;
        let solution = solve(window, scratch, &solver);
        self.note_flatness();
        timer.mark(Stage::Solve);
        let output = self.steer(None);
        timer.mark(Stage::Drive);
        let doing = match (way, output.doing) {
            (Way::Retreat, Doing::Explores | Doing::GoesToLook) => Doing::MakesWay,
            (_, doing) => doing,
        };
        Output {
            cycles: solution.cycles + solution.sweeps,
            budget_exhausted: solution.stop == Stop::Budget,
            doing,
            ..output
        }
    }

    /// Returns how the robot goes on beside the others of its team.
    fn way(&mut self) -> Way {
        if !self.state.team.is_member() {
            return Way::Free;
        }
        let way = self.make_way();
        if !matches!(way, Way::Free) {
            self.state.strategy.frontier.pause(self.input.time_ms);
        }
        way
    }

    /// Drives without a window: on the last metre of an errand, or along the strategy's forces.
    fn go_straight(&mut self) -> Option<Output> {
        self.approach().or_else(|| {
            let heading_rad = self.state.lead_rad()?;
            Some(self.steer(Some(heading_rad)))
        })
    }

    /// Charges the window with rails or with the local goal. Returns false if there is none.
    fn charge(&mut self) -> bool {
        if self.charge_rails().is_some() {
            return true;
        }
        let charged = self.charge_path();
        let frontier = &mut self.state.strategy.frontier;
        if charged.unwrap_or(!frontier.path().is_empty()) {
            frontier.note_closed();
        }
        charged.is_some()
    }

    /// Returns the output of a step without a path: the robot looks about, or stands.
    fn without_path(&mut self) -> Output {
        let velocity = self.look_about();
        if velocity == Twist::default() {
            return Output::waiting();
        }
        Output {
            velocity,
            doing: Doing::LooksAbout,
            ..Output::default()
        }
    }
}

/// Returns the solver's budget. A step that planned a path has spent the time of half the cycles.
const fn budget(config: &Config, planned: bool) -> SolverConfig {
    let most = config.solver.max_cycles;
    SolverConfig {
        max_cycles: if planned { most.div_ceil(2) } else { most },
        ..config.solver
    }
}

//! One step of the exploration, read as the paper's algorithm box [Ouroboros, Algorithm 1].
//!
//! ```text
//! sense:   scans + odometry → map, near field
//! line 3:  update the Voronoi cells         (topology, in instalments)
//! line 4:  move the robot to the Voronoi    (strategy)
//! line 24: propagate from the unexplored    (strategy)
//! line 26: exit when there is none          (status)
//! line 27: define the local goal            (road)
//! line 28: compute the local potential      (view, field)
//! line 29: follow it                        (descent, drive)
//! ```
//!
//! A pure function of configuration, state, workspace and input: no clock, no I/O, no globals, no logging. Same bits in, same
//! bits out, on host and target.

use crate::bits::{Adjacency, flood};
use crate::clearance::Disc;
use crate::config::{Config, Laser};
use crate::drive::{self, Drive, Ground, Incline, Place, Surround};
use crate::field::preference::p_diff;
use crate::field::{
    GOAL, Preference, SCRATCH_FLOATS, SIDE, SolverConfig, Stop, Window, descent, solve,
};
use crate::geometry::{Cell, Point, Pose, Twist};
use crate::laps::{Laps, Stage};
use crate::map::Map;
use crate::map::integrate::is_level;
use crate::map::tiles::NoRoom;
use crate::math;
use crate::near::{self, NearField};
use crate::reached;
use crate::remainder::no_room;
use crate::status::{Fault, Finish, Frontier, Status};
use crate::strategy::frontier::{Known, Lent, Outlook};
use crate::strategy::lookout::{Found, Grounds};
use crate::strategy::ouroboros::{Ouroboros, Round};
use crate::strategy::tdbvp::{Surroundings, Tdbvp};
use crate::strategy::{Road, Strategist, lookout};
use crate::terrain::sidling::{Bias, Slope, Wedge};
use crate::terrain::{Heights, Levels, Preferences, Storeys, Terrain};
use crate::topology::Topology;
use crate::view::{self, Rows, SCALES, View};

/// Range code: nothing came back, so free up to the range limit.
pub const NO_RETURN_MM: u16 = 16_383;
/// Range code: no information.
pub const INVALID_MM: u16 = 0;
/// A robot whose centre has less room than this, in cells, is boxed in: one square metre.
const BOX_CELLS: u32 = 100;
/// The robot that starts inside something sees it nearer than this everywhere, metres.
const BLOCKED_M: f32 = 0.12;
/// Where ground that stops the robot lies on uneven ground, if it was never measured: between its front and where the tilted beams meet
/// level ground, metres.
const FRONT_M: f32 = 0.8;
/// A while, milliseconds: half a turn.
const WHILE_MS: u32 = 5_000;
/// A robot that has stood for so many whiles on uneven ground looks around: two ways were barred by then.
const WHILES_AT_A_LOSS: u32 = 5;
/// A goal that is higher or lower by less lies level with the robot, metres: what a block of heights is rounded by, and as much again.
const LEVEL_M: f32 = 0.2;

/// What a step is given.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    /// The host's clock, milliseconds.
    pub time_ms: u32,
    /// Odometry.
    pub pose: Pose,
    /// Measured velocity.
    pub velocity: Twist,
    /// Ranges in millimetres of each laser of [`Config::lasers`]; [`NO_RETURN_MM`] and [`INVALID_MM`] are codes.
    pub scans: [&'a [u16]; 2],
}

/// What a step answers.
#[derive(Clone, Copy, Debug, Default)]
pub struct Output {
    /// What to drive.
    pub velocity: Twist,
    /// What the planner is doing.
    pub status: Status,
    /// Heading that the field asks for, radians.
    pub heading_rad: f32,
    /// Multigrid cycles (or sweeps) spent on the window.
    pub cycles: u16,
    /// The solver's budget ran out before its stop rule held.
    pub budget_exhausted: bool,
}

/// What a planner remembers from step to step. `TILES` map tiles in the pool, `SLOTS` tile places in the box.
#[derive(Debug)]
pub struct State<const TILES: usize, const SLOTS: usize> {
    map: Map<TILES, SLOTS>,
    around: Around<TILES>,
    topology: Topology<SLOTS>,
    strategy: Strategist<SLOTS>,
    /// What ground is preferred, where it is uneven.
    preferences: Preferences,
    /// What can only be seen is searched for, when nothing is left to drive to.
    lookouts: lookout::Search,
    drive: Drive,
    /// Up or down the slope that it is on, where it may not be crossed.
    wedge: Option<Wedge>,
    /// The one in which the drive found no way, until it searches again.
    shut: Option<Wedge>,
    status: Status,
    started: bool,
    /// A skeleton was published that no road was planned on yet.
    fresh: bool,
    /// Where the robot began.
    start: Cell,
}

/// What is kept of the space beside the map. Flat ground has no heights, and on uneven ground level beams end on slopes: what is near is
/// what the map says.
///
/// With its tag of its own, so that the value without anything is all zeros and costs no flash as a static one.
#[derive(Debug)]
#[repr(u8)]
#[allow(
    clippy::large_enum_variant,
    reason = "no heap to box into; both are about as large with the pool of an image"
)]
enum Around<const TILES: usize> {
    Near(NearField),
    Storeys(Storeys<TILES>),
}

/// Words of scratch.
const SCRATCH: usize = SCRATCH_FLOATS;
/// Words of the wave's queue.
const RING: usize = 1024;

/// Memory of a step: the field, kept as a warm start for the next one, and scratch that the wave and the multigrid use in turn.
#[derive(Debug)]
pub struct Workspace {
    window: Window,
    /// Its least map cell and its scale.
    window_at: Option<(Cell, i32)>,
    /// What stands in the window.
    view: View,
    scratch: [f32; SCRATCH],
}

impl<const TILES: usize, const SLOTS: usize> State<TILES, SLOTS> {
    const CHECK: () = {
        assert!(SLOTS * 16 + RING <= SCRATCH, "the wave fits the scratch");
        assert!(
            reached::scratch_words(SLOTS) <= SCRATCH,
            "the flood at the end fits the scratch"
        );
        assert!(
            drive::manoeuvre::SCRATCH_WORDS <= SCRATCH,
            "a search fits the scratch"
        );
    };

    /// An empty planner.
    #[must_use]
    pub const fn new() -> Self {
        let () = Self::CHECK;
        Self {
            map: Map::new(),
            around: Around::Near(NearField::new()),
            topology: Topology::new(),
            strategy: Strategist::new(),
            preferences: Preferences::new(),
            lookouts: lookout::Search::new(),
            drive: Drive::new(),
            wedge: None,
            shut: None,
            status: Status::Exploring,
            started: false,
            fresh: false,
            start: Cell { x: 0, y: 0 },
        }
    }

    /// Forget everything and take the box's shape from `config`.
    pub fn reset(&mut self, config: &Config) {
        self.map.begin(config);
        self.preferences = Preferences::new();
        self.around = match config.terrain {
            None => Around::Near(NearField::new()),
            Some(_) => Around::Storeys(Storeys::new()),
        };
        self.topology
            .reset(Strategist::<SLOTS>::space(config.strategy));
        self.strategy.reset(config);
        self.lookouts = lookout::Search::new();
        self.drive = Drive::new();
        (self.wedge, self.shut) = (None, None);
        self.status = Status::Exploring;
        self.started = false;
        self.fresh = false;
    }

    /// The map.
    #[must_use]
    pub const fn map(&self) -> &Map<TILES, SLOTS> {
        &self.map
    }

    /// The centre cells.
    #[must_use]
    pub const fn topology(&self) -> &Topology<SLOTS> {
        &self.topology
    }

    /// The way to the present goal.
    #[must_use]
    pub const fn road(&self) -> &Road {
        self.strategy.frontier.road()
    }

    /// What is known of loops, where the session's strategy closes them.
    #[must_use]
    pub const fn ouroboros(&self) -> Option<&Ouroboros<SLOTS>> {
        self.strategy.ouroboros()
    }

    /// What is known of rails, where the session's strategy follows them.
    #[must_use]
    pub const fn tdbvp(&self) -> Option<&Tdbvp<SLOTS>> {
        self.strategy.tdbvp()
    }

    /// The cells of a tile (two bits each: 0 unknown, 1 free, 2 obstacle, 3 negative obstacle), or `None` where
    /// nothing was ever seen.
    #[must_use]
    pub fn tile(&self, x: i16, y: i16) -> Option<[u8; 256]> {
        self.map.tiles().packed(i32::from(x), i32::from(y))
    }

    /// The skeleton of a tile: 16 rows of 16 coarse cells.
    #[must_use]
    pub fn tile_skeleton(&self, x: i16, y: i16) -> [u16; 16] {
        let frame = self.topology.frame();
        let mut rows = [0; 16];
        let Some(plane) = self.topology.skeleton() else {
            return rows;
        };
        for (dy, row) in rows.iter_mut().enumerate() {
            let cell = Cell {
                x: i32::from(x) * 32,
                y: i32::from(y) * 32 + 2 * dy as i32,
            };
            if let Some(site) = frame.site(cell) {
                let word = plane.word(usize::from(site.y), usize::from(site.x / 32));
                *row = (word >> (site.x & 16)) as u16;
            }
        }
        rows
    }

    /// Frontiers left over, and why.
    #[must_use]
    pub fn frontiers(&self) -> &[Frontier] {
        self.strategy.frontier.dropped()
    }
}

impl<const TILES: usize, const SLOTS: usize> Default for State<TILES, SLOTS> {
    fn default() -> Self {
        Self::new()
    }
}

impl Workspace {
    /// Cleared.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            window: Window::new(),
            window_at: None,
            view: View::new(),
            scratch: [0.0; SCRATCH],
        }
    }

    /// The last window's field.
    #[must_use]
    pub const fn window(&self) -> &Window {
        &self.window
    }
}

impl Default for Workspace {
    fn default() -> Self {
        Self::new()
    }
}

/// One row of the last step's window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldRow {
    /// Least map cell of the window.
    pub origin: Cell,
    /// Map cells along a window cell.
    pub scale: u8,
    /// q = 1 − p, scaled so that a goal is 1; 0 on obstacles and where no goal can be reached from.
    pub q: [f32; SIDE],
    /// What each cell is in the boundary-value problem.
    pub kinds: [CellKind; SIDE],
}

/// What a cell is in the window's boundary-value problem.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CellKind {
    /// Relaxed.
    Free,
    /// p = 1, or without a way to a goal.
    #[default]
    Obstacle,
    /// p = 0.
    Goal,
}

impl Workspace {
    /// One row of the last step's field, row 0 the least y; `None` before the first window and beyond the last row.
    #[must_use]
    pub fn field_row(&self, row: u8) -> Option<FieldRow> {
        let (origin, scale) = self.window_at?;
        let y = usize::from(row);
        (y < SIDE).then(|| FieldRow {
            origin,
            scale: scale as u8,
            q: core::array::from_fn(|x| self.window.q(x, y) / GOAL),
            kinds: core::array::from_fn(|x| {
                if self.window.is_goal(x, y) {
                    CellKind::Goal
                } else if self.window.is_reached(x, y) {
                    CellKind::Free
                } else {
                    CellKind::Obstacle
                }
            }),
        })
    }
}

/// One step: what was sensed in, what to drive out. `laps` hears of each stage's end.
pub fn step<const TILES: usize, const SLOTS: usize>(
    config: &Config,
    state: &mut State<TILES, SLOTS>,
    workspace: &mut Workspace,
    input: Input<'_>,
    laps: &mut impl Laps,
) -> Output {
    if state.status != Status::Exploring {
        return Output {
            status: state.status,
            ..Output::default()
        };
    }
    sense(config, state, &input);
    laps.lap(Stage::Sense);
    // A search for a manoeuvre has the scratch; until it is over the robot stands and plans nothing else.
    if state.drive.is_searching() {
        let output = steer(config, state, workspace, &input);
        laps.lap(Stage::Drive);
        return output;
    }
    if state.lookouts.is_running() {
        look_for_lookouts(config, state, workspace, &input);
        laps.lap(Stage::Plan);
        return Output {
            status: state.status,
            ..Output::default()
        };
    }
    let disc = Disc::new(if state.strategy.frontier.is_second_chance() {
        config.tight_radius_m
    } else {
        config.robot_radius_m
    });
    // A new skeleton is planned on in the step after it was finished, so that no step does both.
    let planned = state.fresh;
    if planned {
        state.fresh = !replan(config, state, workspace, &disc, &input);
        laps.lap(Stage::Plan);
    } else {
        state.fresh = state
            .topology
            .advance(state.map.tiles(), &disc, config.topology_units);
        laps.lap(Stage::Topology);
    }
    if state.status != Status::Exploring {
        return Output {
            status: state.status,
            ..Output::default()
        };
    }
    if charge_rails(state, workspace, &disc, &input).is_none() {
        let Some(goal) = local_goal(state, &disc, &input, &mut workspace.view) else {
            laps.lap(Stage::Window);
            return Output {
                velocity: look_about(config, state, &input),
                ..Output::default()
            };
        };
        charge(workspace, &goal);
    }
    if let Some(terrain) = &config.terrain {
        prefer(terrain, state, workspace, &input);
    }
    laps.lap(Stage::Window);
    // A step that planned a road has spent the time of two cycles on it.
    let most = config.solver.max_cycles;
    let solver = SolverConfig {
        max_cycles: if planned { most.div_ceil(2) } else { most },
        ..config.solver
    };
    let solution = solve(&mut workspace.window, &mut workspace.scratch, &solver);
    if config.terrain.is_some() {
        note_flatness(state, workspace, &input);
    }
    laps.lap(Stage::Solve);
    let output = Output {
        cycles: solution.cycles + solution.sweeps,
        budget_exhausted: solution.stop == Stop::Budget,
        ..steer(config, state, workspace, &input)
    };
    laps.lap(Stage::Drive);
    output
}

/// Scans and odometry into the map and the near field.
fn sense<const TILES: usize, const SLOTS: usize>(
    config: &Config,
    state: &mut State<TILES, SLOTS>,
    input: &Input<'_>,
) {
    if !state.started {
        state.started = true;
        state.start = input.pose.point().cell();
        if starts_blocked(config, input) {
            state.status = Status::Fault(Fault::StartBlocked);
        }
    }
    state.map.observe(config, input);
    let level = level_scans(config, input).find(|(_, ranges_mm)| !ranges_mm.is_empty());
    state.strategy.note(&input.pose, input.time_ms, level);
    match &mut state.around {
        Around::Near(near) => {
            for (laser, ranges_mm) in level_scans(config, input) {
                near.update(&input.pose, laser, ranges_mm);
            }
        }
        Around::Storeys(storeys) => {
            state.preferences.stand(&input.pose);
            storeys.note(&state.map.heights(), state.map.tiles());
            state.map.fold(storeys);
        }
    }
}

/// The level lasers, each with its scan.
fn level_scans<'a>(
    config: &'a Config,
    input: &Input<'a>,
) -> impl Iterator<Item = (&'a Laser, &'a [u16])> {
    let scans = config.lasers.iter().zip(input.scans);
    scans.filter(|(laser, _)| is_level(laser))
}

/// Whether the level laser sees something closer than the robot's own hull in nearly every beam.
#[must_use]
pub fn starts_blocked(config: &Config, input: &Input<'_>) -> bool {
    let level = level_scans(config, input).next();
    level.is_some_and(|(_, ranges_mm)| {
        let blocked = |&&range: &&u16| f32::from(range) * 1e-3 < BLOCKED_M;
        !ranges_mm.is_empty()
            && ranges_mm.iter().filter(blocked).count() * 10 >= ranges_mm.len() * 9
    })
}

/// A new skeleton: find the way to go, or find that there is none. Whether that is done, or the next step must go on with it.
fn replan<const TILES: usize, const SLOTS: usize>(
    config: &Config,
    state: &mut State<TILES, SLOTS>,
    workspace: &mut Workspace,
    disc: &Disc,
    input: &Input<'_>,
) -> bool {
    let words: &mut [u32] = bytemuck::cast_slice_mut(&mut workspace.scratch);
    let (residues, ring) = words.split_at_mut(SLOTS * 16);
    let (residues, _) = residues.as_chunks_mut::<2>();
    let lent = Lent {
        residues,
        ring,
        view: &mut workspace.view,
    };
    let round = Round {
        topology: &mut state.topology,
        tiles: state.map.tiles(),
        disc,
        pose: input.pose,
        time_ms: input.time_ms,
        limits: &config.loops,
        levels: levels(&state.around, config, &state.preferences),
    };
    let Some(outlook) = state.strategy.advance(round, lent) else {
        return false;
    };
    if let Some(terrain) = &config.terrain {
        give_up_ground(terrain, state, &input.pose);
    }
    let robot = input.pose.point().cell();
    match outlook {
        // On uneven ground what is seen through a gap is not measured by it.
        Outlook::Nothing
            if state.strategy.frontier.may_look()
                && config.terrain.is_none()
                && !state.strategy.is_patrolling() =>
        {
            let scratch = bytemuck::cast_slice_mut(&mut workspace.scratch);
            state.lookouts.begin(state.map.tiles().extent(), scratch);
        }
        Outlook::Nothing => finish(state, workspace, disc, robot),
        Outlook::Stuck => state.status = Status::Fault(Fault::Stuck),
        Outlook::Road | Outlook::Unsure => {}
    }
    true
}

/// Decide what to make of ground that was never measured though the robot stood by it.
fn give_up_ground<const TILES: usize, const SLOTS: usize>(
    terrain: &Terrain,
    state: &mut State<TILES, SLOTS>,
    pose: &Pose,
) {
    while let Some(cell) = state.strategy.frontier.take_unobserved() {
        state.map.give_up_ground(terrain, cell);
    }
    if state.strategy.frontier.take_stop() {
        let front = Place {
            x_m: FRONT_M,
            ..Place::default()
        };
        if state.map.trust_ground(terrain, ahead(pose, front).cell()) {
            state.strategy.frontier.lift_bar();
        }
    }
}

/// Which goals are preferred for their height.
fn levels<'a, const TILES: usize>(
    around: &'a Around<TILES>,
    config: &'a Config,
    preferences: &Preferences,
) -> Option<Levels<'a, TILES>> {
    let terrain = config.terrain.as_ref()?;
    match around {
        Around::Storeys(storeys) if terrain.mode.has_heights() => Some(Levels {
            storeys,
            terrain,
            storey_m: preferences.storey_m(),
        }),
        _ => None,
    }
}

/// Nothing is left to drive to: search on for what can be seen, and go there or be done.
fn look_for_lookouts<const TILES: usize, const SLOTS: usize>(
    config: &Config,
    state: &mut State<TILES, SLOTS>,
    workspace: &mut Workspace,
    input: &Input<'_>,
) {
    let robot = input.pose.point().cell();
    let [wide, narrow] = [config.robot_radius_m, config.tight_radius_m].map(Disc::new);
    let grounds = Grounds {
        tiles: state.map.tiles(),
        discs: [&wide, &narrow],
        robot,
    };
    let is_gone = |gap| state.strategy.frontier.is_gone(gap);
    let scratch = bytemuck::cast_slice_mut(&mut workspace.scratch);
    match state.lookouts.advance(&grounds, is_gone, scratch) {
        Found::Pending => {}
        Found::Lookout(lookout) => {
            state.strategy.frontier.look_from(lookout);
            // The skeleton was not touched meanwhile.
            state.fresh = true;
        }
        Found::Nothing => finish(state, workspace, &narrow, robot),
    }
}

/// Nothing is left to do: list what is left over, and say why.
fn finish<const TILES: usize, const SLOTS: usize>(
    state: &mut State<TILES, SLOTS>,
    workspace: &mut Workspace,
    disc: &Disc,
    robot: Cell,
) {
    const DONE: Status = Status::Finished(Finish::Explored);
    if state.strategy.is_patrolling() {
        // What was left over was listed before the patrol.
        state.status = DONE;
        return;
    }
    let wanting = list_ways_out(state, workspace, disc, robot);
    list_leftovers(state, disc);
    let status = conclude(state, &mut workspace.view, disc, robot, wanting);
    if status != DONE || !state.strategy.begin_patrol() {
        state.status = status;
    }
}

/// List what the robot can get to and cannot go on from for want of room in the map; which room that is. What lies beyond
/// the map and cannot be reached is no fault.
fn list_ways_out<const TILES: usize, const SLOTS: usize>(
    state: &mut State<TILES, SLOTS>,
    workspace: &mut Workspace,
    disc: &Disc,
    robot: Cell,
) -> Option<NoRoom> {
    let scratch = bytemuck::cast_slice_mut(&mut workspace.scratch);
    no_room(&state.map, disc, robot, scratch, |cell| {
        state.strategy.frontier.list_way_out(cell);
    })
}

/// List the frontiers that were never within reach.
fn list_leftovers<const TILES: usize, const SLOTS: usize>(
    state: &mut State<TILES, SLOTS>,
    disc: &Disc,
) {
    let known = Known {
        topology: &state.topology,
        tiles: state.map.tiles(),
        disc,
        levels: None,
    };
    state.strategy.frontier.list_leftovers(&known);
}

/// Why there is no frontier left within reach.
fn conclude<const TILES: usize, const SLOTS: usize>(
    state: &State<TILES, SLOTS>,
    view: &mut View,
    disc: &Disc,
    robot: Cell,
    wanting: Option<NoRoom>,
) -> Status {
    view.look_around(state.map.tiles(), disc, robot, 1);
    view.free_robot(robot);
    match wanting {
        Some(NoRoom::Pool) => Status::Fault(Fault::MapFull),
        Some(NoRoom::Box) => Status::Fault(Fault::OutOfBox),
        None if state.strategy.frontier.is_stuck() => Status::Fault(Fault::Stuck),
        None if room_cells(view, robot) < BOX_CELLS => Status::Finished(Finish::BoxedIn),
        None => Status::Finished(Finish::Explored),
    }
}

/// Cells of the window that the robot's centre can get to.
fn room_cells(view: &View, robot: Cell) -> u32 {
    let mut reached: Rows = [0; SIDE];
    if let Some(place) = view.place(robot) {
        View::put(&mut reached, place);
    }
    // With no target it floods everything.
    let _ = flood(&view.passable, &mut reached, &[0; SIDE], Adjacency::Four);
    reached.iter().map(|row| row.count_ones()).sum()
}

/// Follow the window's field.
fn steer<const TILES: usize, const SLOTS: usize>(
    config: &Config,
    state: &mut State<TILES, SLOTS>,
    workspace: &mut Workspace,
    input: &Input<'_>,
) -> Output {
    let Workspace {
        window,
        window_at,
        scratch,
        ..
    } = workspace;
    let Some((origin, scale)) = *window_at else {
        return Output::default();
    };
    let heights = state.map.heights();
    // A robot that found no way within the limit of its roll for so long leaves it rather than stand there for good.
    let incline = config
        .terrain
        .as_ref()
        .filter(|_| whiles_stood(state, input.time_ms) < WHILES_AT_A_LOSS)
        .and_then(|terrain| Incline::new(terrain, &heights, &input.pose));
    let bias = Bias {
        before: state.wedge,
        goal: wedge_of_goal(state, input.pose.z_m),
        shut: state.shut,
    };
    let headed = |place: Place| {
        let wanted = heading_at(window, (origin, scale), &input.pose, place)?;
        Some(match &incline {
            Some(incline) => incline.heading(place, wanted, bias),
            None => (wanted, None),
        })
    };
    let heading_at = |place: Place| headed(place).map(|(heading, _)| heading);
    let here = headed(Place::default());
    state.wedge = here.and_then(|(_, wedge)| wedge);
    let here = here.map(|(heading, _)| heading);
    let surround = surround(state, &input.pose, incline.clone());
    let velocity = if here.is_some() {
        let potential_at = |place: Place| {
            let (x, y) = view::position((origin, scale), ahead(&input.pose, place));
            potential_at(window, x, y)
        };
        let ground = Ground {
            surround: &surround,
            heading_at,
            potential_at: Some(&potential_at),
        };
        let rested = state.drive.is_resting();
        let velocity = state.drive.follow(
            config,
            &ground,
            input.velocity,
            bytemuck::cast_slice_mut(scratch),
        );
        // Where it finds no way in one wedge it goes in the other until it searches again.
        state.shut = match (rested, state.drive.is_resting()) {
            (_, false) => None,
            (false, true) => state.wedge,
            (true, true) => state.shut,
        };
        velocity
    } else if is_at_goal(window, (origin, scale), input.pose.point()) {
        // In the goal's own cell there is no slope: look around until it is explored.
        state.drive.look_around(config, &surround, input.velocity)
    } else {
        state.strategy.frontier.note_flat();
        Twist::default()
    };
    let velocity = if is_at_a_loss(state, velocity, input.time_ms) {
        state.drive.look_around(config, &surround, input.velocity)
    } else {
        velocity
    };
    Output {
        velocity: within_limits(config, velocity),
        heading_rad: math::wrap(input.pose.yaw_rad + here.unwrap_or(0.0)),
        ..Output::default()
    }
}

/// What stands around the robot, or what it keeps off.
fn surround<const TILES: usize, const SLOTS: usize>(
    state: &State<TILES, SLOTS>,
    pose: &Pose,
    incline: Option<Incline>,
) -> Surround {
    let mut surround = Surround::empty().on(incline);
    match &state.around {
        Around::Near(near) => {
            surround.see(pose, near.points());
            let cells = near::obstacle_cells(state.map.tiles(), pose.point());
            surround.remember(pose, cells);
        }
        Around::Storeys(_) => {
            let rims = near::rims(state.map.tiles(), pose.point());
            surround.keep_off(pose, rims);
        }
    }
    surround
}

/// Without a local goal: stand, or look around after long.
fn look_about<const TILES: usize, const SLOTS: usize>(
    config: &Config,
    state: &mut State<TILES, SLOTS>,
    input: &Input<'_>,
) -> Twist {
    if !is_at_a_loss(state, Twist::default(), input.time_ms) {
        return Twist::default();
    }
    let surround = surround(state, &input.pose, None);
    let wish = state.drive.look_around(config, &surround, input.velocity);
    within_limits(config, wish)
}

/// Whether the robot has stood for long and still does, on uneven ground: what it has not measured it may see when it turns. It does so every
/// second while, and searches for a manoeuvre between.
fn is_at_a_loss<const TILES: usize, const SLOTS: usize>(
    state: &State<TILES, SLOTS>,
    velocity: Twist,
    time_ms: u32,
) -> bool {
    let whiles = whiles_stood(state, time_ms);
    matches!(state.around, Around::Storeys(_))
        && velocity == Twist::default()
        && whiles >= WHILES_AT_A_LOSS
        && whiles % 2 == 1
}

/// For how many whiles the robot has stood about where it stands.
fn whiles_stood<const TILES: usize, const SLOTS: usize>(
    state: &State<TILES, SLOTS>,
    time_ms: u32,
) -> u32 {
    state.strategy.frontier.standing_ms(time_ms) / WHILE_MS
}

/// Whether the road's goal lies clearly higher or lower than the robot, as far as its height is known.
fn wedge_of_goal<const TILES: usize, const SLOTS: usize>(
    state: &State<TILES, SLOTS>,
    robot_m: f32,
) -> Option<Wedge> {
    let Around::Storeys(storeys) = &state.around else {
        return None;
    };
    let goal = state.strategy.frontier.road().goal();
    let rise_m = storeys.height_around_m(state.map.tiles(), goal)? - robot_m;
    if rise_m.abs() < LEVEL_M {
        None
    } else if rise_m > 0.0 {
        Some(Wedge::Up)
    } else {
        Some(Wedge::Down)
    }
}

/// No faster than the session allows, whatever a manoeuvre has in mind.
fn within_limits(config: &Config, wish: Twist) -> Twist {
    let (linear, angular) = (config.max_linear_mps, config.max_angular_radps);
    Twist {
        linear_mps: wish.linear_mps.min(linear).max(-linear),
        angular_radps: wish.angular_radps.min(angular).max(-angular),
    }
}

fn is_at_goal(window: &Window, (origin, scale): (Cell, i32), robot: Point) -> bool {
    let (x, y) = view::position((origin, scale), robot);
    match (
        usize::try_from(math::floor(x)),
        usize::try_from(math::floor(y)),
    ) {
        (Ok(x), Ok(y)) => window.is_goal(x, y),
        _ => false,
    }
}

/// q of the window cell at a position in cells.
fn potential_at(window: &Window, x: f32, y: f32) -> f32 {
    match (
        usize::try_from(math::floor(x)),
        usize::try_from(math::floor(y)),
    ) {
        (Ok(x), Ok(y)) => window.q(x, y),
        _ => 0.0,
    }
}

/// A place in the robot's frame as a point of the odometry frame.
fn ahead(pose: &Pose, place: Place) -> Point {
    let (sin, cos) = math::sin_cos(pose.yaw_rad);
    Point {
        x_m: pose.x_m + place.x_m * cos - place.y_m * sin,
        y_m: pose.y_m + place.x_m * sin + place.y_m * cos,
    }
}

/// The field's heading at a place near the robot, radians to the left of the robot's own.
fn heading_at(window: &Window, at: (Cell, i32), pose: &Pose, place: Place) -> Option<f32> {
    let (x, y) = view::position(at, ahead(pose, place));
    descent::heading_at(window, x, y).map(|heading| math::wrap(heading - pose.yaw_rad))
}

/// See the smallest window that holds a local goal; the goal's cells in it.
fn local_goal<const TILES: usize, const SLOTS: usize>(
    state: &State<TILES, SLOTS>,
    disc: &Disc,
    input: &Input<'_>,
    view: &mut View,
) -> Option<Rows> {
    let (robot, road) = (input.pose.point(), state.strategy.frontier.road());
    if road.is_empty() {
        return None;
    }
    SCALES.iter().find_map(|&scale| {
        view.look_around(state.map.tiles(), disc, robot.cell(), scale);
        if let Some(shield) = state.strategy.shield() {
            shield.cells().for_each(|cell| view.block(cell));
        }
        view.free_robot(robot.cell());
        keep_off_rims(state, disc, robot, view);
        road.local_goals(robot)
            .find_map(|cell| goal_cells(view, cell))
    })
}

/// What the drive keeps the robot's hull off on uneven ground, obstacles of either sign and ground that was never measured, the window keeps its
/// centre off: between two such cells the field would lead where the drive does not go.
fn keep_off_rims<const TILES: usize, const SLOTS: usize>(
    state: &State<TILES, SLOTS>,
    disc: &Disc,
    robot: Point,
    view: &mut View,
) {
    if let Around::Storeys(_) = state.around {
        let rims = near::rim_cells(state.map.tiles(), robot);
        view.keep_off(robot.cell(), rims, disc);
    }
}

/// The passable window cells of a coarse cell, if there are any.
fn goal_cells(view: &View, cell: Cell) -> Option<Rows> {
    let mut rows: Rows = [0; SIDE];
    view.mark(&mut rows, cell).then_some(rows)
}

/// Give every cell of the window its preference [Maffei-Terrain, eqs. 3 to 5], beside what the strategy prefers.
fn prefer<const TILES: usize, const SLOTS: usize>(
    terrain: &Terrain,
    state: &State<TILES, SLOTS>,
    workspace: &mut Workspace,
    input: &Input<'_>,
) {
    let heights = state.map.heights();
    let global = state.preferences.global(terrain);
    let has_sides = state.strategy.tdbvp().is_some();
    let Workspace { window, view, .. } = workspace;
    let crossed = crossed(terrain, &heights, window, view);
    window.change_preferences(|x, y, old| {
        if View::has(&crossed, (x, y)) {
            return Preference::nearest(terrain.least_preference);
        }
        let height_m = heights.height_m(view.cell(x, y));
        let difference_m = height_m.map(|height_m| height_m - input.pose.z_m);
        let epsilon = state.preferences.of_cell(terrain, global, difference_m);
        let side = if has_sides { old.get().to_num() } else { 0.0 };
        Preference::nearest(epsilon + side)
    });
}

/// Cells in which the last field leads across a slope that may not be crossed: they repel as much as cells may, whatever their height. Along its own
/// height a robot would else be drawn just there. Not in [Maffei-Terrain].
fn crossed(terrain: &Terrain, heights: &Heights<'_>, window: &Window, view: &View) -> Rows {
    let mut rows = [0; SIDE];
    let Some(most) = terrain.most_lean().filter(|_| terrain.mode.has_heights()) else {
        return rows;
    };
    for (y, row) in rows.iter_mut().enumerate() {
        for x in 0..SIDE {
            let is_crossed = Slope::at(heights, view.cell(x, y))
                .zip(descent::gradient(window, x, y))
                .is_some_and(|(slope, way)| slope.is_crossed(way, most));
            *row |= u64::from(is_crossed) << x;
        }
    }
    rows
}

/// A field was solved: how flat it is around the robot decides the next one's preferences.
fn note_flatness<const TILES: usize, const SLOTS: usize>(
    state: &mut State<TILES, SLOTS>,
    workspace: &Workspace,
    input: &Input<'_>,
) {
    let place = workspace.view.place(input.pose.point().cell());
    if let Some((x, y)) = place.filter(|&(x, y)| workspace.window.is_reached(x, y)) {
        state.preferences.note(p_diff(&workspace.window, x, y));
    }
}

/// Charge the window with what the strategy has for it beside local goals, if that leads anywhere.
fn charge_rails<const TILES: usize, const SLOTS: usize>(
    state: &mut State<TILES, SLOTS>,
    workspace: &mut Workspace,
    disc: &Disc,
    input: &Input<'_>,
) -> Option<()> {
    state.strategy.tdbvp()?;
    let robot = input.pose.point().cell();
    let view = &mut workspace.view;
    view.look_around(state.map.tiles(), disc, robot, 1);
    view.free_robot(robot);
    keep_off_rims(state, disc, input.pose.point(), view);
    slide(workspace);
    let around = Surroundings {
        topology: &state.topology,
        tiles: state.map.tiles(),
        pose: input.pose,
    };
    let window = (&mut workspace.window, &workspace.view);
    state.strategy.charge(&around, window)
}

/// Set the window's boundary, keeping the field of the last window where they overlap.
fn charge(workspace: &mut Workspace, goal: &Rows) {
    slide(workspace);
    workspace
        .window
        .set_boundary(&workspace.view.passable, goal);
}

/// Move the window to where the view is, with the field where they overlap.
fn slide(workspace: &mut Workspace) {
    let Workspace {
        window,
        window_at: at,
        view,
        ..
    } = workspace;
    match *at {
        Some((origin, scale)) if scale == view.scale => {
            let steps = |to: i32, from: i32| (to - from) / scale;
            window.shift(
                steps(view.origin.x, origin.x),
                steps(view.origin.y, origin.y),
            );
        }
        // Nothing of a field at another scale is worth keeping.
        _ => window.shift(SIDE as i32, 0),
    }
    *at = Some((view.origin, view.scale));
}

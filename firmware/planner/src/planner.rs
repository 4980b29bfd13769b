//! One step of the exploration, read as the paper's algorithm box.

use crate::config::Config;
use crate::geometry::{Pose, Twist};
use crate::status::{Frontier, Status};

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

/// Range code: nothing came back, so free up to the range limit.
pub const NO_RETURN_MM: u16 = 16_383;
/// Range code: no information.
pub const INVALID_MM: u16 = 0;

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

/// What a planner remembers from step to step. `TILES` map tiles, `SLOTS` tile places in the box.
#[derive(Debug)]
pub struct State<const TILES: usize, const SLOTS: usize> {}

/// Scratch memory of a step.
#[derive(Debug)]
pub struct Workspace {}

impl<const TILES: usize, const SLOTS: usize> State<TILES, SLOTS> {
    /// An empty planner.
    #[must_use]
    pub const fn new() -> Self {
        Self {}
    }

    /// Forget everything and take the box's shape from `config`.
    pub fn reset(&mut self, _config: &Config) {}

    /// The cells of a tile (two bits each: 0 unknown, 1 free, 2 obstacle, 3 negative obstacle), or `None` where
    /// nothing was ever seen.
    #[must_use]
    pub fn tile(&self, _x: i16, _y: i16) -> Option<&[u8; 256]> {
        None
    }

    /// The skeleton of a tile: 16 rows of 16 coarse cells.
    #[must_use]
    pub fn tile_skeleton(&self, _x: i16, _y: i16) -> [u16; 16] {
        [0; 16]
    }

    /// Frontiers left over, and why.
    #[must_use]
    pub fn frontiers(&self) -> &[Frontier] {
        &[]
    }
}

impl<const TILES: usize, const SLOTS: usize> Default for State<TILES, SLOTS> {
    fn default() -> Self {
        Self::new()
    }
}

impl Workspace {
    /// Cleared scratch.
    #[must_use]
    pub const fn new() -> Self {
        Self {}
    }
}

impl Default for Workspace {
    fn default() -> Self {
        Self::new()
    }
}

/// Where the window of the last step lies, and the boundary of one of its rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Cell column of the window's first cell, in units of the window's cell.
    pub origin_x: i16,
    /// Cell row of the window's first cell.
    pub origin_y: i16,
    /// Side of a window cell in map cells.
    pub scale: u8,
    /// What the row's cells are, two bits a cell, least x in the low bits: 0 free, 1 obstacle, 2 goal.
    pub kinds: [u8; KIND_BYTES],
}

/// Bytes of a row's cell kinds.
pub const KIND_BYTES: usize = WINDOW_SIDE.div_ceil(4);

/// Cells in a row of the window.
pub const WINDOW_SIDE: usize = 61;

impl Workspace {
    /// One row of the last step's field (row 0 has the least y) into `q`, scaled so that a goal is 1, and where the window lies;
    /// `None` before the first window and beyond the last row.
    #[must_use]
    pub fn field_row(&self, _row: u8, _q: &mut [f32; WINDOW_SIDE]) -> Option<Window> {
        None
    }
}

/// One step: what was sensed in, what to drive out.
pub fn step<const TILES: usize, const SLOTS: usize>(
    _config: &Config,
    _state: &mut State<TILES, SLOTS>,
    _workspace: &mut Workspace,
    _input: Input<'_>,
) -> Output {
    Output::default()
}

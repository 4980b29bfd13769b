//! A correction of the map while the planner runs: tiles are replaced, and the robot's pose moves.
//!
//! ```text
//! begin   the robot stands
//! tiles   each replaces the map's in place; its shift is noted
//! finish  pose ← motion ∘ pose; what is remembered moves; skeleton and plan are made anew
//! ```
//!
//! A place in the map goes by the shift of the tile in which it lay; a tile that is not listed, or
//! has no shift, leaves it where it is:
//!
//! | remembered | moves | forgotten |
//! | --- | --- | --- |
//! | robot's pose | by the motion; a lost robot searches from there | |
//! | cells | as told ([`crate::map`]) | in tiles without a known cell |
//! | evidence | | in listed tiles; elsewhere it stays |
//! | trail | by shift; what is told is added | with its tile, or if the scratch is full |
//! | arrivals | they are cells | |
//! | versions for the team | a listed tile is news, of the next era | |
//! | goals given up, blocked passages, viewpoint | by shift | |
//! | path and goal | by shift, and planned anew on the next skeleton | |
//! | progress towards goals, skeleton | | always: begun anew |
//! | chances that are spent, time without a move | they are no places | |
//! | search for viewpoints or a recovery, lane, retreat | | always: begun anew |
//! | home, goal of an errand | by shift | |
//! | drive's track | with the robot, by the motion | |
//! | breadcrumbs, tractor point, shield, revisit | by shift | |
//! | closed and pending regions | to the region that holds the moved middle | |
//! | visits and rails | to the place that holds the moved middle; the last visit counts | |
//! | pending visits | their stamps are written | which cells of a place were visited |
//! | cells of an area that robots visited (sbpf) | | if a tile is shifted; covered stay covered |
//! | peers, right of way | they stay: the next beacon is a step away | |
//! | motion into the team's coordinates | it stays: a closed loop leaves the start | |
//! | obstacle points, contacts | they stay: they lie in the odometry's frame | |
//! | heights of a tile on uneven ground | with the tile's cells | in tiles without a known cell |
//! | heights around the robot | with the robot, by whole cells | |
//! | landmarks | | always: the next scans mark them anew |
//!
//! So no correction moves a wall into the robot, and none puts the robot into a wall that its own
//! beams have not met.
//!
//! Invariant: the shifts lie in the scratch memory, which nothing else uses while a correction is
//! open, because the robot stands.
//! Units: metres, radians; map cells; tiles of 32 × 32 cells.

use crate::config::Config;
use crate::geometry::{Cell, MapFromOdom, MapPose, Point};
use crate::grid::{SPARE_WORDS, Shift, Shifts, shift};
use crate::math;
use crate::path::{map_exits, viewpoint};
use crate::planner::state::State;
use crate::planner::workspace::Workspace;
use crate::strategy::Strategist;

/// Most tiles of a correction, and most shifts in the scratch memory.
const MOST_TILES: u16 = 512;
/// Greatest coordinate of the robot after a correction, metres: as for odometry.
const MOST_M: f32 = 10_000.0;

/// A correction that begins.
///
/// ```
/// use fieldline_planner::{
///     Config, CorrectedTile, Correction, CorrectionError, CorrectionProgress, LaserMount,
///     RobotShape, State, Workspace,
/// };
///
/// let config = Config::builder(RobotShape::PIONEER_3AT)
///     .laser(LaserMount::level(0.10, 0.40))
///     .build()
///     .unwrap();
/// let mut state = Box::new(State::<16, 20>::new());
/// let mut workspace = Box::new(Workspace::new());
/// state.reset(&config);
///
/// // The robot is 1 m farther to the east than it thought, and a tile there is free.
/// let correction = Correction { epoch: 1, x_m: 1.0, tiles: 1, ..Correction::default() };
/// let free = CorrectedTile {
///     tile: (2, 0),
///     planes: [[u32::MAX; 32], [0; 32]],
///     ..CorrectedTile::default()
/// };
/// state.begin_correction(&correction)?;
/// state.correct_tile(&mut workspace, &free)?;
/// let progress: CorrectionProgress = state.finish_correction(&config, &mut workspace);
/// assert!(progress.closed);
/// assert_eq!(state.tile(2, 0), Some([0x55; 256]));
/// assert_eq!(state.location().pose.0.x_m, 1.0);
/// # Ok::<(), CorrectionError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Correction {
    /// Its number, greater than that of the last one.
    pub epoch: u16,
    /// Shift of the robot's pose after the turn, metres.
    pub x_m: f32,
    /// Metres.
    pub y_m: f32,
    /// Turn of the robot's pose about the map's origin, radians.
    pub yaw_rad: f32,
    /// Number of tiles to come, at most 512.
    pub tiles: u16,
}

/// A tile that replaces the map's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CorrectedTile {
    /// Column and row.
    pub tile: (i16, i16),
    /// Where to the places go that the planner remembers in the tile, cells.
    pub shift: (i8, i8),
    /// The low and the high plane of its cells: a word is a row, bit k of it column k.
    pub planes: [[u32; 32]; 2],
    /// Where the robot's centre was, for a device that has lost it: a word is a row of blocks of
    /// 2 × 2 cells, bit k of it block k. Zeros tell nothing.
    pub trail: [u16; 16],
}

/// How far a correction is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CorrectionProgress {
    /// Number of the correction.
    pub epoch: u16,
    /// Number of the first tile that is missing.
    pub next: u16,
    /// True if it is finished.
    pub closed: bool,
}

/// The reason why a correction is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CorrectionError {
    /// It has too many tiles, or takes the robot too far away.
    Unusable,
    /// It is not the last one, or has no more tiles.
    NotOpen,
}

/// The state of corrections.
#[derive(Debug)]
pub(super) struct Correcting {
    /// The last correction that began, and the last one that was finished.
    epoch: u16,
    finished: u16,
    /// The next tile, and the number of all.
    next: u16,
    tiles: u16,
    /// Number of shifts in the scratch memory.
    shifts: u16,
    /// Number of blocks of the trail in the scratch memory.
    trail: u16,
    motion: MapFromOdom,
}

impl Correcting {
    /// Returns the state at the start of a session.
    pub(super) const fn new() -> Self {
        Self {
            epoch: 0,
            finished: 0,
            next: 0,
            tiles: 0,
            shifts: 0,
            trail: 0,
            motion: MapFromOdom::IDENTITY,
        }
    }

    /// Returns true while a correction is open.
    pub(super) const fn is_open(&self) -> bool {
        self.epoch != self.finished
    }

    const fn progress(&self) -> CorrectionProgress {
        CorrectionProgress {
            epoch: self.epoch,
            next: self.next,
            closed: !self.is_open(),
        }
    }
}

impl<const TILES: usize, const SLOTS: usize> State<TILES, SLOTS> {
    /// Returns the last correction of the map that was finished; 0 if there was none.
    #[must_use]
    pub const fn map_epoch(&self) -> u16 {
        self.correcting.finished
    }

    /// Begins a correction: the robot stands until it is finished. One that is open and of a lower
    /// epoch is abandoned: its tiles stay, and nothing else of it acts. The same correction again
    /// changes nothing.
    ///
    /// # Errors
    /// [`CorrectionError`]. Nothing has changed then.
    #[inline(never)]
    pub fn begin_correction(
        &mut self,
        correction: &Correction,
    ) -> Result<CorrectionProgress, CorrectionError> {
        if correction.epoch <= self.correcting.epoch {
            return self.correction_progress(correction.epoch);
        }
        let motion = MapFromOdom {
            x_m: correction.x_m,
            y_m: correction.y_m,
            yaw_rad: math::wrap(correction.yaw_rad),
        };
        let MapPose(pose) = self.localiser.pose();
        let Point { x_m, y_m } = motion.point(pose.point());
        let is_near = x_m.abs() <= MOST_M && y_m.abs() <= MOST_M && motion.yaw_rad.is_finite();
        if correction.tiles > MOST_TILES || !is_near {
            return Err(CorrectionError::Unusable);
        }
        self.correcting = Correcting {
            epoch: correction.epoch,
            finished: self.correcting.finished,
            next: 0,
            tiles: correction.tiles,
            shifts: 0,
            trail: 0,
            motion,
        };
        Ok(self.correcting.progress())
    }

    /// Returns how far a correction is.
    ///
    /// # Errors
    /// [`CorrectionError::NotOpen`] if it is not the last one.
    pub fn correction_progress(&self, epoch: u16) -> Result<CorrectionProgress, CorrectionError> {
        if epoch != 0 && epoch == self.correcting.epoch {
            Ok(self.correcting.progress())
        } else {
            Err(CorrectionError::NotOpen)
        }
    }

    /// Replaces the next tile of the open correction.
    ///
    /// # Errors
    /// [`CorrectionError::NotOpen`] if none is open, or it has no more tiles.
    #[inline(never)]
    pub fn correct_tile(
        &mut self,
        workspace: &mut Workspace,
        tile: &CorrectedTile,
    ) -> Result<(), CorrectionError> {
        let correcting = &mut self.correcting;
        if !correcting.is_open() || correcting.next >= correcting.tiles {
            return Err(CorrectionError::NotOpen);
        }
        correcting.next += 1;
        let [list, _, trail] = split::<SLOTS>(workspace);
        if tile.shift != (0, 0) {
            let (list, _) = list.as_chunks_mut::<2>();
            if let Some(place) = list.get_mut(usize::from(correcting.shifts)) {
                *place = shift(tile.tile, tile.shift);
                correcting.shifts += 1;
            }
        }
        let (column, row) = (tile.tile.0.into(), tile.tile.1.into());
        let (dx, dy) = (tile.shift.0.into(), tile.shift.1.into());
        for cell in self.map.trail((column, row)) {
            if let Some(place) = trail.get_mut(usize::from(correcting.trail)) {
                *place = pack(cell.offset(dx, dy));
                correcting.trail += 1;
            }
        }
        let in_team = self.team.is_member();
        self.ground
            .replace(&mut self.map, (column, row), &tile.planes, in_team);
        self.map.add_trail((column, row), &tile.trail);
        Ok(())
    }

    /// Finishes the open correction, if it has all its tiles: moves the pose and what is
    /// remembered. Returns how far it is.
    #[inline(never)]
    pub fn finish_correction(
        &mut self,
        config: &Config,
        workspace: &mut Workspace,
    ) -> CorrectionProgress {
        let correcting = &mut self.correcting;
        if !correcting.is_open() || correcting.next != correcting.tiles {
            return correcting.progress();
        }
        correcting.finished = correcting.epoch;
        let (shifts, motion) = (usize::from(correcting.shifts), correcting.motion);
        let blocks = usize::from(correcting.trail);

        let [list, spare, trail] = split::<SLOTS>(workspace);
        let (list, _) = list.as_chunks::<2>();
        let list: &[Shift] = list.get(..shifts).unwrap_or_default();
        let shifts = Shifts(list);
        let MapPose(before) = self.localiser.pose();
        self.localiser.correct_pose(&motion);
        let MapPose(pose) = self.localiser.pose();
        self.map.end_correction(before.point(), pose.point());
        for &word in trail.iter().take(blocks) {
            self.map.mark_trail(unpack(word));
        }
        self.skeleton
            .reset(Strategist::<SLOTS>::space(config.strategy));
        self.strategy.correct(shifts, pose.point(), spare);
        self.errands.correct(shifts);
        self.viewpoints = viewpoint::Search::new();
        self.drive.correct(&motion);
        self.has_new_skeleton = false;
        self.exits = map_exits::Search::new();
        self.correcting.progress()
    }
}

/// Returns the scratch memory of the shifts, that of the strategies' tables, and that of the trail.
fn split<const SLOTS: usize>(workspace: &mut Workspace) -> [&mut [u32]; 3] {
    let words: &mut [u32] = bytemuck::cast_slice_mut(&mut workspace.scratch);
    let (list, rest) = words.split_at_mut(2 * usize::from(MOST_TILES));
    let tables = (SPARE_WORDS * SLOTS).min(rest.len());
    let (spare, trail) = rest.split_at_mut(tables);
    [list, spare, trail]
}

/// Returns a cell as a word; it wraps.
fn pack(cell: Cell) -> u32 {
    u32::from(cell.x as u16) | u32::from(cell.y as u16) << 16
}

fn unpack(word: u32) -> Cell {
    Cell {
        x: (word as i16).into(),
        y: ((word >> 16) as i16).into(),
    }
}

#[cfg(test)]
mod tests;

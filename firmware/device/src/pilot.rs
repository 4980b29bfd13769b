//! The pilot: planner and protocol joined, without bytes.
//!
//! ```text
//!          Start            Pause             planner
//!  Idle ─────────► Exploring ─────► Paused    Exploring ─────► Finished / Fault
//!                     ▲   ◄─────              any ──Stop──► Finished(Stopped)
//!                     │   Resume              any ──input──► EmergencyStop ──Resume, input released──► as before
//! ```
//!
//! Only in Exploring does an observation step the planner and may a command move; the emergency stop is latched, and neither releasing the
//! input nor a new observation ends it, only the host's word (Resume or Start) with the input released. Used directly, a
//! pilot is the link without bytes: the session calls the same functions, so the stream of commands is the same.

use fieldline_planner::field::SIDE;
use fieldline_planner::planner::{self, CellKind, Output};
use fieldline_planner::{Config, StageTimer, State, Workspace, step};
use fieldline_protocol::message::{
    Command, Control, Cost, FIELD_SIDE, Fault, FieldRow, Finish, Frontier, MAX_FRONTIERS,
    MAX_SCANS, Observation, Refusal, Road, Start, Status, Tile, Twist,
};
use heapless::Vec;

use crate::convert;
use crate::limits;
use crate::log::{info, warning};
use crate::overlay;

// What is collected into the wire's bounded lists must fit them.
const _: () = assert!(SIDE == FIELD_SIDE && MAX_SCANS == 2);

/// The planner's memories, lent by whoever has room for them.
#[derive(Debug)]
pub struct Memory<'a, const TILES: usize, const SLOTS: usize> {
    /// What the planner remembers.
    pub state: &'a mut State<TILES, SLOTS>,
    /// Scratch of a step.
    pub workspace: &'a mut Workspace,
}

/// A session's state but for the map.
///
/// Invariant: `pressed` implies `latched`.
#[derive(Debug)]
pub struct Pilot {
    config: Option<Config>,
    /// What the planner last said.
    planned: Status,
    paused: bool,
    latched: bool,
    pressed: bool,
}

impl Default for Pilot {
    fn default() -> Self {
        Self::new()
    }
}

impl Pilot {
    /// No session.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            config: None,
            planned: Status::Idle,
            paused: false,
            latched: false,
            pressed: false,
        }
    }

    /// What goes on.
    #[must_use]
    pub const fn status(&self) -> Status {
        match self.planned {
            _ if self.latched => Status::EmergencyStop,
            Status::Exploring if self.paused => Status::Paused,
            status => status,
        }
    }

    /// Whether the emergency stop input is pressed now. Once pressed, it holds until the host resumes.
    pub fn set_emergency_stop(&mut self, pressed: bool) {
        if pressed && !self.latched {
            warning!("emergency stop");
        }
        self.pressed = pressed;
        self.latched |= pressed;
    }

    /// Changes the session's state. A reset is the board's business: here it ends the session.
    ///
    /// # Errors
    /// [`Refusal`]; the state is then as before.
    pub fn control<const TILES: usize, const SLOTS: usize>(
        &mut self,
        memory: &mut Memory<'_, TILES, SLOTS>,
        control: &Control,
    ) -> Result<Status, Refusal> {
        match control {
            Control::Start(start) => self.start(memory, start)?,
            Control::Reset => {
                *self = Self {
                    pressed: self.pressed,
                    latched: self.latched,
                    ..Self::new()
                }
            }
            _ if self.config.is_none() => return Err(Refusal::NotStarted),
            Control::Pause => self.paused = true,
            Control::Resume => {
                self.paused = false;
                self.latched = self.pressed;
            }
            Control::Stop => self.planned = Status::Finished(Finish::Stopped),
        }
        Ok(self.status())
    }

    fn start<const TILES: usize, const SLOTS: usize>(
        &mut self,
        memory: &mut Memory<'_, TILES, SLOTS>,
        start: &Start,
    ) -> Result<(), Refusal> {
        limits::check_start::<TILES, SLOTS>(start)?;
        let config = convert::config(start);
        info!(
            "start: box {=u8} x {=u8} tiles, {=usize} lasers, radius {=u16} mm",
            start.box_tiles.0,
            start.box_tiles.1,
            start.lasers.len(),
            start.robot_radius_mm
        );
        memory.state.reset(&config);
        *self = Self {
            config: Some(config),
            planned: Status::Exploring,
            paused: false,
            latched: self.pressed,
            pressed: self.pressed,
        };
        Ok(())
    }

    /// One step. An observation that does not match the session's lasers steps nothing and is answered with zero
    /// velocity and [`Fault::BadObservation`]; the next good one goes on. `laps` hears of the step's stages.
    ///
    /// # Errors
    /// [`Refusal::NotStarted`] without a session.
    pub fn observe<const TILES: usize, const SLOTS: usize>(
        &mut self,
        memory: &mut Memory<'_, TILES, SLOTS>,
        observation: &Observation,
        laps: &mut impl StageTimer,
    ) -> Result<Command, Refusal> {
        let config = self.config.as_ref().ok_or(Refusal::NotStarted)?;
        if !limits::matches(observation, config.lasers.iter().map(|laser| laser.beams)) {
            warning!("observation does not match the lasers");
            return Ok(standing(Status::Fault(Fault::BadObservation)));
        }
        if self.status() != Status::Exploring {
            return Ok(standing(self.status()));
        }
        let (state, workspace) = (&mut *memory.state, &mut *memory.workspace);
        let output = step(config, state, workspace, convert::input(observation), laps);
        self.planned = convert::wire_status(output.status);
        if self.planned != Status::Exploring {
            info!("exploration ended");
        }
        Ok(Command {
            loops: overlay::loops(memory.state),
            ..command(&output, self.planned)
        })
    }

    /// One map tile; `None` where nothing was ever seen.
    #[must_use]
    pub fn tile<const TILES: usize, const SLOTS: usize>(
        memory: &Memory<'_, TILES, SLOTS>,
        x: i16,
        y: i16,
    ) -> Option<Tile> {
        let cells = memory.state.tile(x, y)?;
        let rows = memory.state.tile_skeleton(x, y);
        Some(Tile {
            x,
            y,
            cells: cells.iter().copied().collect(),
            skeleton: rows.iter().flat_map(|row| row.to_le_bytes()).collect(),
            marks: overlay::marks(memory.state, (x, y)),
            dates: overlay::dates(memory.state, (x, y)),
        })
    }

    /// One row of the last window's field; `None` before the first window and beyond the last row.
    #[must_use]
    pub fn field_row<const TILES: usize, const SLOTS: usize>(
        memory: &Memory<'_, TILES, SLOTS>,
        row: u8,
    ) -> Option<FieldRow> {
        memory
            .workspace
            .field_row(row)
            .map(|found| field_row(row, &found))
    }

    /// Where the planner is going: tractor point, shield, and the road without its first `from` cells.
    #[must_use]
    pub fn road<const TILES: usize, const SLOTS: usize>(
        memory: &Memory<'_, TILES, SLOTS>,
        from: u8,
    ) -> Road {
        overlay::road(memory.state, from)
    }

    /// The residual frontiers, the first [`MAX_FRONTIERS`] of them.
    #[must_use]
    pub fn frontiers<const TILES: usize, const SLOTS: usize>(
        memory: &Memory<'_, TILES, SLOTS>,
    ) -> Vec<Frontier, MAX_FRONTIERS> {
        let frontiers = memory.state.frontiers().iter();
        frontiers
            .take(MAX_FRONTIERS)
            .map(convert::wire_frontier)
            .collect()
    }
}

/// Window cells on the wire count in their own side, and their kinds take two bits each.
fn field_row(row: u8, found: &planner::FieldRow) -> FieldRow {
    let scale = i32::from(found.scale.max(1));
    let short = |cell: i32| cell.div_euclid(scale) as i16;
    let kind = |kind: &CellKind| match kind {
        CellKind::Free => 0,
        CellKind::Obstacle => 1,
        CellKind::Goal => 2,
    };
    let pack = |four: &[CellKind]| {
        let bits = four.iter().enumerate();
        bits.fold(0, |byte, (i, cell)| byte | kind(cell) << (2 * i))
    };
    FieldRow {
        row,
        origin_x: short(found.origin.x),
        origin_y: short(found.origin.y),
        scale: found.scale,
        q: found.q.into_iter().collect(),
        cells: found.kinds.chunks(4).map(pack).collect(),
    }
}

/// Zero velocity, and why.
fn standing(status: Status) -> Command {
    Command {
        status,
        ..Command::default()
    }
}

fn command(output: &Output, status: Status) -> Command {
    // Only an exploring planner moves, whatever else its output says.
    let velocity = if status == Status::Exploring {
        convert::wire_twist(&output.velocity)
    } else {
        Twist::default()
    };
    Command {
        velocity,
        status,
        heading: convert::quantity(output.heading_rad),
        cost: Cost {
            cycles: output.cycles,
            budget_exhausted: output.budget_exhausted,
            ..Cost::default()
        },
        ..Command::default()
    }
}

#[cfg(test)]
pub(crate) mod tests;

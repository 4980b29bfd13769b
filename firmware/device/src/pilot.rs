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
use fieldline_planner::planner::{self, CellKind, Input, Output};
use fieldline_planner::{Config, State, Workspace, step};
use fieldline_protocol::message::{
    Command, Control, Cost, FIELD_SIDE, Fault, FieldRow, Finish, Frontier, MAX_FRONTIERS,
    MAX_SCANS, Observation, Refusal, Start, Status, Tile, Twist,
};
use heapless::Vec;

use crate::convert;
use crate::limits;
use crate::log::{info, warning};

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
    /// velocity and [`Fault::BadObservation`]; the next good one goes on.
    ///
    /// # Errors
    /// [`Refusal::NotStarted`] without a session.
    pub fn observe<const TILES: usize, const SLOTS: usize>(
        &mut self,
        memory: &mut Memory<'_, TILES, SLOTS>,
        observation: &Observation,
    ) -> Result<Command, Refusal> {
        let config = self.config.as_ref().ok_or(Refusal::NotStarted)?;
        if !limits::matches(observation, config.lasers.iter().map(|laser| laser.beams)) {
            warning!("observation does not match the lasers");
            return Ok(standing(Status::Fault(Fault::BadObservation)));
        }
        if self.status() != Status::Exploring {
            return Ok(standing(self.status()));
        }
        let output = step(config, memory.state, memory.workspace, input(observation));
        self.planned = convert::wire_status(output.status);
        if self.planned != Status::Exploring {
            info!("exploration ended");
        }
        Ok(command(&output, self.planned))
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

fn input(observation: &Observation) -> Input<'_> {
    let scan = |number: usize| match observation.scans.get(number) {
        Some(scan) => scan.ranges_mm.as_slice(),
        None => &[],
    };
    Input {
        time_ms: observation.time_ms,
        pose: convert::pose(&observation.pose),
        velocity: convert::twist(&observation.velocity),
        scans: [scan(0), scan(1)],
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
pub(crate) mod tests {
    use std::boxed::Box;

    use fieldline_planner::{State, Workspace};
    use fieldline_protocol::message::{
        Control, Fault, Finish, Laser, Observation, Refusal, Scan, Start, Status, Strategy, Twist,
    };
    use fixed::types::{I4F12, I16F16};

    use super::{Memory, Pilot};

    /// The 3-AT with a level and a tilted laser of 181 beams over 180°.
    pub(crate) fn start() -> Start {
        let level = Laser {
            x: I4F12::lit("0.1"),
            y: I4F12::ZERO,
            z: I4F12::lit("0.4"),
            pitch: I4F12::ZERO,
            first_bearing: I16F16::lit("-1.5708"),
            bearing_step: I16F16::lit("0.017453"),
            beams: 181,
            range_limit_mm: 12_000,
        };
        let tilted = Laser {
            pitch: I4F12::lit("0.349"),
            ..level
        };
        Start {
            strategy: Strategy::Frontier,
            box_tiles: (20, 20),
            lasers: [level, tilted].into_iter().collect(),
            robot_radius_mm: 300,
            max_linear: I4F12::lit("0.7"),
            max_angular: I4F12::lit("2.44"),
        }
    }

    /// A matching observation in the middle of nothing.
    pub(crate) fn observation(time_ms: u32) -> Observation {
        let scan = Scan {
            ranges_mm: [4000; 181].into_iter().collect(),
        };
        Observation {
            time_ms,
            scans: [scan.clone(), scan].into_iter().collect(),
            ..Observation::default()
        }
    }

    pub(crate) struct Bench {
        state: Box<State<4, 400>>,
        workspace: Box<Workspace>,
    }

    impl Bench {
        pub(crate) fn new() -> Self {
            Self {
                state: Box::new(State::new()),
                workspace: Box::new(Workspace::new()),
            }
        }

        pub(crate) fn memory(&mut self) -> Memory<'_, 4, 400> {
            Memory {
                state: &mut self.state,
                workspace: &mut self.workspace,
            }
        }
    }

    fn started() -> (Pilot, Bench) {
        let (mut pilot, mut bench) = (Pilot::new(), Bench::new());
        let status = pilot.control(&mut bench.memory(), &Control::Start(start()));
        assert_eq!(status, Ok(Status::Exploring));
        (pilot, bench)
    }

    #[test]
    fn nothing_happens_before_a_start() {
        let (mut pilot, mut bench) = (Pilot::new(), Bench::new());
        assert_eq!(pilot.status(), Status::Idle);
        for control in [Control::Pause, Control::Resume, Control::Stop] {
            let refused = pilot.control(&mut bench.memory(), &control);
            assert_eq!(refused, Err(Refusal::NotStarted), "{control:?}");
        }
        let refused = pilot.observe(&mut bench.memory(), &observation(0));
        assert_eq!(refused, Err(Refusal::NotStarted));
    }

    #[test]
    fn a_refused_start_leaves_the_session_as_it_was() {
        let (mut pilot, mut bench) = started();
        let bad = Start {
            box_tiles: (0, 1),
            ..start()
        };
        let refused = pilot.control(&mut bench.memory(), &Control::Start(bad));
        assert_eq!(refused, Err(Refusal::BadBox));
        assert_eq!(pilot.status(), Status::Exploring);
    }

    #[test]
    fn pause_holds_and_resume_goes_on() {
        let (mut pilot, mut bench) = started();
        let paused = pilot.control(&mut bench.memory(), &Control::Pause);
        assert_eq!(paused, Ok(Status::Paused));
        let command = pilot
            .observe(&mut bench.memory(), &observation(100))
            .unwrap();
        assert_eq!(
            (command.status, command.velocity),
            (Status::Paused, Twist::default())
        );
        let resumed = pilot.control(&mut bench.memory(), &Control::Resume);
        assert_eq!(resumed, Ok(Status::Exploring));
    }

    #[test]
    fn a_stopped_session_stays_stopped() {
        let (mut pilot, mut bench) = started();
        let stopped = Status::Finished(Finish::Stopped);
        assert_eq!(
            pilot.control(&mut bench.memory(), &Control::Stop),
            Ok(stopped)
        );
        assert_eq!(
            pilot.control(&mut bench.memory(), &Control::Resume),
            Ok(stopped)
        );
        let command = pilot
            .observe(&mut bench.memory(), &observation(100))
            .unwrap();
        assert_eq!(
            (command.status, command.velocity),
            (stopped, Twist::default())
        );
    }

    #[test]
    fn the_emergency_stop_holds_until_released_and_resumed() {
        let (mut pilot, mut bench) = started();
        pilot.set_emergency_stop(true);
        let command = pilot
            .observe(&mut bench.memory(), &observation(100))
            .unwrap();
        assert_eq!(
            (command.status, command.velocity),
            (Status::EmergencyStop, Twist::default())
        );
        let held = pilot.control(&mut bench.memory(), &Control::Resume);
        assert_eq!(held, Ok(Status::EmergencyStop), "still pressed");
        let held = pilot.control(&mut bench.memory(), &Control::Start(start()));
        assert_eq!(held, Ok(Status::EmergencyStop), "still pressed");
        pilot.set_emergency_stop(false);
        assert_eq!(
            pilot.status(),
            Status::EmergencyStop,
            "released is not resumed"
        );
        let resumed = pilot.control(&mut bench.memory(), &Control::Resume);
        assert_eq!(resumed, Ok(Status::Exploring));
    }

    #[test]
    fn a_wrong_observation_is_a_fault_that_passes() {
        let (mut pilot, mut bench) = started();
        let mut wrong = observation(100);
        wrong.scans[1].ranges_mm.pop();
        let command = pilot.observe(&mut bench.memory(), &wrong).unwrap();
        assert_eq!(command.status, Status::Fault(Fault::BadObservation));
        assert_eq!(command.velocity, Twist::default());
        assert_eq!(pilot.status(), Status::Exploring);
    }

    #[test]
    fn a_reset_ends_the_session_but_not_the_emergency_stop() {
        let (mut pilot, mut bench) = started();
        pilot.set_emergency_stop(true);
        let status = pilot.control(&mut bench.memory(), &Control::Reset);
        assert_eq!(status, Ok(Status::EmergencyStop));
        pilot.set_emergency_stop(false);
        let refused = pilot.observe(&mut bench.memory(), &observation(0));
        assert_eq!(refused, Err(Refusal::NotStarted));
    }
}

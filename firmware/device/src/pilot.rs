//! The pilot: a session around the planner, without bytes.
//!
//! ```text
//!          Start            Pause             planner
//!  Idle ─────────► Exploring ─────► Paused    Exploring ─────► Finished / Fault
//!                         ◄─────              any ──Stop──► Finished(Stopped)
//!                         Resume              any ──input──► EmergencyStop
//!
//!  any ──Home, GoTo──► Going ──planner──► Arrived / Unreachable          ──Explore──► Exploring
//! ```
//!
//! Only in Exploring and Going does an observation step the planner, and only then may a command
//! move the robot. The emergency stop is latched: releasing the input does not end it, and neither
//! does a new observation. Only Resume or Start from the host ends it, and only when the input is
//! released. After Resume the session explores, also if it was paused before the stop. A session
//! that had ended stays ended.
//!
//! A pilot used directly is a link without bytes. The session calls the same functions, so both
//! give the same commands.

use fieldline_planner::{self as planner, Config, Output, StageTimer, step};
use fieldline_protocol::message::{
    self, Activity, Body, Command, Control, Correct, CorrectedTiles, CorrectionProgress, Cost,
    Events, Fault, Finish, MAX_SCANS, Observation, Packet, Recall, Refusal, Reply, Request, Start,
    Status, Twist,
};

use crate::STALE_MS;
use crate::convert;
use crate::log::{info, warning};
use crate::memory::Memory;

// The planner's scans and lists must fit into the wire's.
const _: () = assert!(MAX_SCANS == 2);
const _: () = assert!(planner::RECALLED_POINTS == message::RECALLED_POINTS);
const _: () = assert!(planner::RECALLED_TRACK == message::RECALLED_TRACK);
// A retry must fit between two observations and the end of a command.
const _: () = assert!(Config::PERIODS_S.1 * 1000.0 < STALE_MS as f32);

/// State of a session, without the map.
///
/// ```
/// use fieldline_device::{Memory, Pilot};
/// use fieldline_planner::{State, Tuning, Workspace};
/// use fieldline_protocol::message::{Control, Observation, Refusal, Status};
///
/// let mut state = Box::new(State::<4, 64>::new());
/// let mut workspace = Box::new(Workspace::new());
/// let tuning = &Tuning::DEFAULT;
/// let mut memory = Memory { state: &mut state, workspace: &mut workspace, tuning };
/// let mut pilot = Pilot::new();
/// assert_eq!(pilot.status(), Status::Idle);
/// let refused = pilot.observe(&mut memory, &Observation::default(), &mut ());
/// assert_eq!(refused, Err(Refusal::NotStarted));
/// ```
///
/// Invariant: `pressed` implies `latched`.
#[derive(Debug)]
pub struct Pilot {
    config: Option<Config>,
    /// The status after the last step.
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
    /// Returns a pilot without a session.
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

    /// Returns the status of the session.
    #[must_use]
    pub const fn status(&self) -> Status {
        match self.planned {
            _ if self.latched => Status::EmergencyStop,
            status if self.paused && status.goes_on() => Status::Paused,
            status => status,
        }
    }

    /// Sets the state of the emergency stop input. Once pressed, the stop holds until the host
    /// resumes.
    pub fn set_emergency_stop(&mut self, pressed: bool) {
        if pressed && !self.latched {
            warning!("emergency stop pressed");
        }
        self.pressed = pressed;
        self.latched |= pressed;
    }

    /// Changes the state of the session. A reset only ends the session here; the board reboots.
    ///
    /// # Errors
    /// [`Refusal`]. The state is then unchanged.
    #[inline(never)]
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
            Control::Home | Control::GoTo { .. } | Control::Explore => {
                self.order(memory, control)?;
            }
            Control::SetHome { x, y, yaw } => {
                let set = memory.state.set_home(convert::home((*x, *y), *yaw));
                set.map_err(convert::wire_task_error)?;
            }
        }
        Ok(self.status())
    }

    /// Takes an order to drive.
    fn order<const TILES: usize, const SLOTS: usize>(
        &mut self,
        memory: &mut Memory<'_, TILES, SLOTS>,
        control: &Control,
    ) -> Result<(), Refusal> {
        let config = self.config.as_ref().ok_or(Refusal::NotStarted)?;
        let is_stopped = self.planned == Status::Finished(Finish::Stopped);
        let task = convert::task(control).filter(|_| !is_stopped);
        let task = task.ok_or(Refusal::NotReady)?;
        let ordered = memory.state.order(config, task);
        self.planned = convert::wire_status(ordered.map_err(convert::wire_task_error)?);
        Ok(())
    }

    fn start<const TILES: usize, const SLOTS: usize>(
        &mut self,
        memory: &mut Memory<'_, TILES, SLOTS>,
        start: &Start,
    ) -> Result<(), Refusal> {
        let config = convert::config(start, memory.tuning).map_err(Refusal::BadParameter)?;
        memory.state.reset(&config);
        info!(
            "session started: {=usize} lasers, radius {=u16} mm",
            start.lasers.len(),
            start.robot_radius_mm
        );
        *self = Self {
            config: Some(config),
            planned: Status::Exploring,
            paused: false,
            latched: self.pressed,
            pressed: self.pressed,
        };
        Ok(())
    }

    /// Makes one step. `timer` receives the end of each stage.
    ///
    /// An observation whose scans do not match the session's lasers, or with a number that no robot
    /// reports, makes no step. Its answer has zero velocity and [`Fault::BadObservation`]. The
    /// session continues with the next correct observation.
    ///
    /// # Errors
    /// [`Refusal::NotStarted`] without a session.
    pub fn observe<const TILES: usize, const SLOTS: usize>(
        &mut self,
        memory: &mut Memory<'_, TILES, SLOTS>,
        observation: &Observation,
        timer: &mut impl StageTimer,
    ) -> Result<Command, Refusal> {
        let command = self.step(memory, observation, timer)?;
        Ok(Command {
            map_epoch: memory.state.map_epoch(),
            ..command
        })
    }

    fn step<const TILES: usize, const SLOTS: usize>(
        &mut self,
        memory: &mut Memory<'_, TILES, SLOTS>,
        observation: &Observation,
        timer: &mut impl StageTimer,
    ) -> Result<Command, Refusal> {
        let config = self.config.as_ref().ok_or(Refusal::NotStarted)?;
        let Some(input) = convert::input(observation, config.lasers()) else {
            warning!("the scans of an observation do not match the lasers");
            return Ok(stopped(Status::Fault(Fault::BadObservation)));
        };
        if !self.status().goes_on() {
            memory.state.stand(config, &input);
            return Ok(stopped(self.status()));
        }
        let (state, workspace) = (&mut *memory.state, &mut *memory.workspace);
        let output = step(config, state, workspace, input, timer);
        if output.refused.is_some() {
            warning!("an observation has a number that no robot reports");
            return Ok(Command {
                input_faults: convert::wire_input_faults(memory.state.input_faults()),
                ..stopped(Status::Fault(Fault::BadObservation))
            });
        }
        self.planned = convert::wire_status(output.status);
        if !self.planned.goes_on() {
            info!("exploration or errand ended");
        }
        let location = config.localises().then(|| memory.state.location());
        Ok(Command {
            loops: convert::wire_loops(memory.state.loops()),
            input_faults: convert::wire_input_faults(memory.state.input_faults()),
            location: location.as_ref().map(convert::wire_location),
            ..command(&output, self.planned)
        })
    }

    /// Opens a correction of the map. The robot stands until it is closed.
    ///
    /// # Errors
    /// [`Refusal::NotStarted`] without a session, [`Refusal::NoCorrection`],
    /// [`Refusal::BadCorrection`].
    pub fn correct<const TILES: usize, const SLOTS: usize>(
        &mut self,
        memory: &mut Memory<'_, TILES, SLOTS>,
        correct: &Correct,
    ) -> Result<CorrectionProgress, Refusal> {
        self.config.as_ref().ok_or(Refusal::NotStarted)?;
        let begun = memory.state.begin_correction(&convert::correction(correct));
        begun
            .map(convert::wire_progress)
            .map_err(convert::wire_refusal)
    }

    /// Takes those tiles of a part that are the next ones of the open correction, and closes it
    /// with the last part. The answer tells which tile is missing.
    ///
    /// # Errors
    /// As [`Pilot::correct`]; [`Refusal::BadTile`], and the tiles before that one are taken.
    #[inline(never)]
    pub fn tiles<const TILES: usize, const SLOTS: usize>(
        &mut self,
        memory: &mut Memory<'_, TILES, SLOTS>,
        part: &CorrectedTiles,
    ) -> Result<CorrectionProgress, Refusal> {
        let config = self.config.as_ref().ok_or(Refusal::NotStarted)?;
        let (state, workspace) = (&mut *memory.state, &mut *memory.workspace);
        let mut progress = state
            .correction_progress(part.epoch)
            .map_err(convert::wire_refusal)?;
        let mut bytes = part.cells.as_slice();
        for (number, tile) in (u32::from(part.first)..).zip(&part.tiles) {
            let (cells, rest) = bytes
                .split_at_checked(convert::corrected_bytes(tile))
                .ok_or(Refusal::BadTile)?;
            bytes = rest;
            if progress.closed || number != u32::from(progress.next) {
                continue;
            }
            let tile = convert::corrected_tile(tile, cells).ok_or(Refusal::BadTile)?;
            state
                .correct_tile(workspace, &tile)
                .map_err(convert::wire_refusal)?;
            progress.next += 1;
        }
        if part.last {
            progress = state.finish_correction(config, workspace);
        }
        Ok(convert::wire_progress(progress))
    }

    /// Takes over what a device that was reset knew of the space around its robot.
    ///
    /// # Errors
    /// [`Refusal::NotStarted`] without a session; [`Refusal::NoCorrection`] if the correction is
    /// not the last one that was closed, or the robot has made a step; [`Refusal::BadCorrection`].
    #[inline(never)]
    pub fn recall<const TILES: usize, const SLOTS: usize>(
        &mut self,
        memory: &mut Memory<'_, TILES, SLOTS>,
        recall: &Recall,
    ) -> Result<CorrectionProgress, Refusal> {
        let config = self.config.as_ref().ok_or(Refusal::NotStarted)?;
        let recalled = memory.state.recall(config, &convert::recall(recall));
        recalled
            .map(convert::wire_progress)
            .map_err(convert::wire_refusal)
    }

    /// Takes a packet that another robot of the team said. A packet whose tile is not whole is
    /// ignored.
    ///
    /// # Errors
    /// [`Refusal::NotStarted`] without a session, [`Refusal::NoTeam`] in a session without a team.
    #[inline(never)]
    pub fn hear<const TILES: usize, const SLOTS: usize>(
        &mut self,
        memory: &mut Memory<'_, TILES, SLOTS>,
        packet: &Packet,
    ) -> Result<(), Refusal> {
        let config = self.in_team()?;
        if let Some(packet) = convert::packet(packet) {
            memory.state.hear(config, &packet);
        }
        Ok(())
    }

    /// Returns the next packet for the team; `None` until the next observation.
    ///
    /// # Errors
    /// As [`Pilot::hear`].
    #[inline(never)]
    pub fn say<const TILES: usize, const SLOTS: usize>(
        &mut self,
        memory: &mut Memory<'_, TILES, SLOTS>,
    ) -> Result<Option<Packet>, Refusal> {
        let config = self.in_team()?;
        let said = memory.state.say(config);
        Ok(said.map(|packet| {
            let mut packet = convert::wire_packet(&packet);
            if let (Body::Beacon(beacon), Some(activity)) = (&mut packet.body, self.activity()) {
                beacon.activity = activity;
            }
            packet
        }))
    }

    /// Returns the configuration of a session with a team.
    fn in_team(&self) -> Result<&Config, Refusal> {
        let config = self.config.as_ref().ok_or(Refusal::NotStarted)?;
        config.team().ok_or(Refusal::NoTeam)?;
        Ok(config)
    }

    /// Returns what the robot does by order, whatever its planner would do.
    const fn activity(&self) -> Option<Activity> {
        match self.status() {
            Status::Finished(Finish::Stopped) => Some(Activity::Gone),
            Status::Paused | Status::EmergencyStop => Some(Activity::Standing),
            _ => None,
        }
    }

    /// Answers a request that is no hello and no observation.
    ///
    /// # Errors
    /// [`Refusal`], as the request says; [`Refusal::OutOfOrder`] for a hello or an observation.
    pub fn answer<const TILES: usize, const SLOTS: usize>(
        &mut self,
        memory: &mut Memory<'_, TILES, SLOTS>,
        request: &Request,
    ) -> Result<Reply, Refusal> {
        Ok(match request {
            Request::Control(control) => Reply::Control(self.control(memory, control)?),
            Request::Hear(packet) => {
                self.hear(memory, packet)?;
                Reply::Heard
            }
            Request::Say => Reply::Say(self.say(memory)?),
            Request::Correct(correct) => Reply::Corrected(self.correct(memory, correct)?),
            Request::Tiles(part) => Reply::Corrected(self.tiles(memory, part)?),
            Request::Recall(recall) => Reply::Corrected(self.recall(memory, recall)?),
            _ => return memory.show(request).ok_or(Refusal::OutOfOrder),
        })
    }
}

/// Returns a command with zero velocity and the given status.
fn stopped(status: Status) -> Command {
    Command {
        status,
        ..Command::default()
    }
}

/// Converts the output of a step for the wire.
fn command(output: &Output, status: Status) -> Command {
    // Only an exploring planner may move the robot. The velocity of another output is ignored.
    let velocity = if status.drives() {
        convert::wire_twist(&output.velocity)
    } else {
        Twist::default()
    };
    Command {
        velocity,
        status,
        doing: convert::wire_doing(output.doing),
        events: Events(output.events.bits()),
        heading: convert::quantity(output.heading_rad),
        forgot_arrivals: output.forgot_arrivals,
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

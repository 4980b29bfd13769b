//! The messages: plain data, postcard-encoded, physical quantities in `fixed` types.
//!
//! Units: metres, radians, seconds, milliseconds where the name says `_ms`, millimetres where it says `_mm`.
//! Frames: x forward (or east), y left (or north), z up, angles counter-clockwise.
//!
//! | message | from | answered by |
//! | --- | --- | --- |
//! | [`Request::Hello`] | host | [`Reply::Hello`] or [`Reply::Incompatible`] |
//! | [`Request::Control`] | host | [`Reply::Control`] or [`Reply::Refused`] |
//! | [`Request::Observation`] | host | [`Reply::Command`] or [`Reply::Refused`] |
//! | [`Request::Tile`] | host | [`Reply::Tile`] or [`Reply::Refused`] |
//! | [`Request::FieldRow`] | host | [`Reply::FieldRow`] or [`Reply::Refused`] |
//! | [`Request::Frontiers`] | host | [`Reply::Frontiers`] or [`Reply::Refused`] |
//! | [`Request::Road`] | host | [`Reply::Road`] or [`Reply::Refused`] |
//!
//! The device says two things unasked: [`Reply::Hello`] after it booted, and [`Reply::Crash`] before it reboots.
//!
//! Every quantity of 32 bits is an `I16F16` and every one of 16 bits an `I4F12`; the exact-byte tests hold that.

use fixed::types::{I4F12, I16F16};
use heapless::Vec;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Beams a scan may have at the most.
pub const MAX_BEAMS: usize = 181;
/// Laser scanners an observation may carry at the most.
pub const MAX_SCANS: usize = 2;
/// Range code of a beam that came back from nothing: free up to the range limit. It is the largest two-byte varint.
pub const NO_RETURN_MM: u16 = 16_383;
/// Range code of a beam that carries no information.
pub const INVALID_MM: u16 = 0;
/// Residual frontiers a reply lists at the most.
pub const MAX_FRONTIERS: usize = 16;
/// Bytes of a map tile: 32 × 32 cells of two bits, row by row from the least y, least x in the low bits.
pub const TILE_BYTES: usize = 256;
/// Bytes of a tile's skeleton: 16 × 16 coarse cells of one bit, row by row from the least y.
pub const TILE_SKELETON_BYTES: usize = 32;
/// Places of a tile that have a date of their own: 2 × 2 of 1.6 m, row by row from the least y.
pub const TILE_DATES: usize = 4;
/// Cells of the road that a reply lists at the most.
pub const ROAD_PAGE: usize = 32;
/// Cells in a row of the field's window.
pub const FIELD_SIDE: usize = 61;
/// Bytes of a row's cell kinds: 61 cells of two bits.
pub const FIELD_CELL_BYTES: usize = 16;
/// Bytes of a build identifier.
pub const BUILD_BYTES: usize = 24;
/// Bytes of a source file's name in a crash report.
pub const CRASH_FILE_BYTES: usize = 32;

/// A pose in the odometry frame, metres and radians.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Pose {
    /// Metres.
    pub x: I16F16,
    /// Metres.
    pub y: I16F16,
    /// Metres above the start.
    pub z: I16F16,
    /// Radians about the forward axis.
    pub roll: I16F16,
    /// Radians about the left axis; positive is nose down.
    pub pitch: I16F16,
    /// Radians about the up axis, in [−π, π].
    pub yaw: I16F16,
}

/// A planar velocity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Twist {
    /// Metres a second, forward.
    pub linear: I4F12,
    /// Radians a second, counter-clockwise.
    pub angular: I4F12,
}

/// One sweep of one laser. Its geometry is in [`Start::lasers`].
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Scan {
    /// Ranges in millimetres, or [`NO_RETURN_MM`], or [`INVALID_MM`].
    pub ranges_mm: Vec<u16, MAX_BEAMS>,
}

/// What the robot sensed at one instant.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Observation {
    /// The host's clock, milliseconds since the start of the session.
    pub time_ms: u32,
    /// Odometry.
    pub pose: Pose,
    /// Measured velocity.
    pub velocity: Twist,
    /// One scan per laser of [`Start::lasers`], in that order.
    pub scans: Vec<Scan, MAX_SCANS>,
}

/// Where a laser sits and how it sweeps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Laser {
    /// Metres ahead of the robot's centre.
    pub x: I4F12,
    /// Metres to its left.
    pub y: I4F12,
    /// Metres above the ground under it.
    pub z: I4F12,
    /// Radians; positive looks down.
    pub pitch: I4F12,
    /// Radians, bearing of the first beam (negative is to the right).
    pub first_bearing: I16F16,
    /// Radians from one beam to the next.
    pub bearing_step: I16F16,
    /// Beams in a sweep, at most [`MAX_BEAMS`].
    pub beams: u16,
    /// Nothing farther than this is reported.
    pub range_limit_mm: u16,
}

/// Which strategy plans.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Strategy {
    /// Nearest unexplored centre cell.
    #[default]
    Frontier,
    /// The same, closing loops on the way.
    Ouroboros,
    /// Rails by the time of their visit, and a patrol on them.
    Tdbvp {
        /// How long to patrol when all is explored, seconds. The status stays [`Status::Exploring`] meanwhile.
        patrol_s: u16,
    },
}

/// Which preferences shape the field on uneven ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Preference {
    /// None.
    Off,
    /// Ground at the robot's own height.
    Height,
    /// The whole window, against a field that grows flat.
    Global,
    /// Both.
    #[default]
    Both,
}

/// Parameters of uneven ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Terrain {
    /// Which preferences are used.
    pub preference: Preference,
    /// What stands higher than this over the ground around it is an obstacle, metres.
    pub obstacle: I4F12,
    /// What the level laser meets nearer than this over ground not yet measured is an obstacle, metres.
    pub near: I4F12,
    /// Ground lower than this under what is beside it is a negative obstacle, metres; negative.
    pub hole: I4F12,
    /// Least preference, from −2 to 0.
    pub least: I4F12,
    /// Greatest preference, from 0 to 2.
    pub most: I4F12,
    /// Preference lost a metre of height, at least 0.
    pub height_scale: I4F12,
    /// Preference gained an e-th part of the field's steepness, at least 0.
    pub global_scale: I16F16,
    /// Steepest slope that may be driven on, radians.
    pub climb: I4F12,
    /// Steepest slope that may be driven across, radians; as large as `climb`, there is no such limit.
    pub roll: I4F12,
    /// Highest edge that may be driven over, metres.
    pub step: I4F12,
}

/// The session's parameters.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Start {
    /// Which strategy plans.
    pub strategy: Strategy,
    /// The map's box in tiles of 3.2 m, across (an even number) and up, both at least 4; their product is at most the device's tile
    /// slots.
    pub box_tiles: (u8, u8),
    /// The laser scanners.
    pub lasers: Vec<Laser, MAX_SCANS>,
    /// Radius that the planner keeps clear, millimetres.
    pub robot_radius_mm: u16,
    /// Greatest speed, metres a second.
    pub max_linear: I4F12,
    /// Greatest turn rate, radians a second.
    pub max_angular: I4F12,
    /// Acceleration and braking that the robot can be relied on for, metres a second squared.
    pub linear_accel: I4F12,
    /// The same of its turn rate, radians a second squared.
    pub angular_accel: I4F12,
    /// Time from one observation to the next, milliseconds; a command is driven for so long.
    pub period_ms: u16,
    /// How to go about uneven ground: heights are measured, holes and edges kept off, level ground preferred. Nothing on flat
    /// ground, where the lasers see only what stands.
    pub terrain: Option<Terrain>,
}

/// What the host wants of the session.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
#[allow(
    clippy::large_enum_variant,
    reason = "no heap to box into; one lives at a time"
)]
pub enum Control {
    /// Forget the map and begin.
    Start(Start),
    /// Hold still until resumed.
    Pause,
    /// Go on after a pause.
    Resume,
    /// End the session; the map stays readable.
    Stop,
    /// Reboot the device.
    Reset,
}

/// From the host.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
#[allow(
    clippy::large_enum_variant,
    reason = "no heap to box into; one lives at a time"
)]
pub enum Request {
    /// Who are you? Its number and first two fields never change, so that any two versions can refuse each other.
    Hello {
        /// Protocol version.
        version: u16,
        /// Hash of the message schema.
        schema: u32,
        /// The host's own choice: a new one makes the device forget the sequence numbers that it answered.
        nonce: u32,
    },
    /// Change the session's state.
    Control(Control),
    /// What was sensed; asks for a command.
    Observation(Observation),
    /// Read one map tile, by tile coordinates (cell / 32, rounded down).
    Tile {
        /// Tile column.
        x: i16,
        /// Tile row.
        y: i16,
    },
    /// Read one row of the last window's field.
    FieldRow {
        /// Row, 0 is the least y.
        row: u8,
    },
    /// Read the residual frontiers.
    Frontiers,
    /// Read where the planner is going: the road from one of its cells on.
    Road {
        /// Cells of the road to leave out.
        from: u8,
    },
}

/// What the planner is doing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Status {
    /// No session yet.
    #[default]
    Idle,
    /// Driving to unexplored space.
    Exploring,
    /// Held by the host.
    Paused,
    /// Held by the e-stop input.
    EmergencyStop,
    /// Done.
    Finished(Finish),
    /// Cannot go on.
    Fault(Fault),
}

/// Why an exploration ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Finish {
    /// No reachable frontier is left.
    Explored,
    /// The robot has no free way out of where it stands.
    BoxedIn,
    /// The host stopped it.
    Stopped,
}

/// Why the planner cannot go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Fault {
    /// The start pose lies in an obstacle.
    StartBlocked,
    /// A way leads on, and every tile of the map's pool is in use.
    MapFull,
    /// A way leads out of the map's box.
    OutOfBox,
    /// An observation did not match the session's lasers.
    BadObservation,
    /// The robot did not move for too long although commanded.
    Stuck,
}

/// Counters of the device since boot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Counters {
    /// Frames received and accepted.
    pub received: u32,
    /// Frames dropped for a bad checksum.
    pub crc_errors: u32,
    /// Frames dropped for anything else: framing, length, format, order.
    pub dropped: u32,
    /// Requests answered again from the stored reply.
    pub duplicates: u32,
    /// Times that the host fell silent for longer than [`Identity::stale_ms`] while driving.
    pub stale_stops: u32,
}

/// Instructions of a step's stages; their sum is [`Cost::instructions`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Stages {
    /// Taking this request apart, and putting the reply before it together.
    pub session: u32,
    /// Scans and odometry into the map.
    pub sense: u32,
    /// An instalment of the skeleton.
    pub topology: u32,
    /// The wave over a new skeleton, and the road.
    pub plan: u32,
    /// The window's cells and boundary.
    pub window: u32,
    /// The window's field.
    pub solve: u32,
    /// Descent, drive, and the search for a manoeuvre.
    pub drive: u32,
}

/// What one step cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Cost {
    /// Instructions of the whole step (exact in the emulator, timer ticks on silicon, 0 on a host).
    pub instructions: u32,
    /// The same by stages.
    pub stages: Stages,
    /// Deepest stack so far, bytes; 0 where not measured.
    pub stack_bytes: u32,
    /// Multigrid cycles or sweeps spent on the window.
    pub cycles: u16,
    /// The solver's budget ran out before its stop rule held.
    pub budget_exhausted: bool,
}

/// What became of loops since the session began; nothing where the strategy closes none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Loops {
    /// One is being closed: there is a shield behind the robot.
    pub closing: bool,
    /// Loops closed: the tractor point was reached by the way ahead.
    pub closed: u16,
    /// Loops given up, because there is none or it is too long.
    pub given_up: u16,
}

/// The answer to an observation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Command {
    /// What to drive.
    pub velocity: Twist,
    /// What the planner is doing.
    pub status: Status,
    /// Robot heading that the field asks for, radians; meaningful while exploring.
    pub heading: I16F16,
    /// What became of loops.
    pub loops: Loops,
    /// Counters of the link.
    pub counters: Counters,
    /// Cost of the step.
    pub cost: Cost,
}

/// What ended the program before the last reboot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Cause {
    /// A panic; [`Crash::at`] is the line.
    #[default]
    Panic,
    /// A processor fault; [`Crash::at`] is the program counter.
    Fault,
    /// The stack ran out of its room; [`Crash::at`] is 0.
    StackOverflow,
    /// The main loop did not come round in time; [`Crash::at`] is 0.
    Watchdog,
}

/// A crash: the program stopped, commands zero velocity and reboots.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Crash {
    /// What happened.
    pub cause: Cause,
    /// Source line or program counter.
    pub at: u32,
    /// The last letters of the source file's path; empty for a fault.
    pub file: heapless::String<CRASH_FILE_BYTES>,
}

/// Who the device is.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Identity {
    /// Protocol version.
    pub version: u16,
    /// Hash of the message schema.
    pub schema: u32,
    /// Build identifier.
    pub build: heapless::String<BUILD_BYTES>,
    /// Boots since power-on.
    pub boots: u32,
    /// Slots of the map's box, in tiles.
    pub tile_slots: u16,
    /// Tiles in the map's pool.
    pub tile_pool: u16,
    /// Largest frame accepted, bytes.
    pub max_frame: u16,
    /// Silence after which the device considers its command stale, milliseconds.
    pub stale_ms: u16,
    /// The crash that caused the last reboot.
    pub crash: Option<Crash>,
    /// Counters since the boot.
    pub counters: Counters,
}

/// A parameter of [`Start`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Parameter {
    /// [`Start::lasers`]: one or two.
    Lasers,
    /// [`Laser::beams`]: 1 to [`MAX_BEAMS`].
    Beams,
    /// [`Laser::range_limit_mm`]: 1 to [`NO_RETURN_MM`] − 1.
    RangeLimit,
    /// [`Laser::first_bearing`] and [`Laser::bearing_step`]: within one turn, the step positive.
    Bearing,
    /// [`Laser::pitch`]: the first laser is level, the second looks down by less than 90°.
    Pitch,
    /// [`Laser::x`], [`Laser::y`] and [`Laser::z`]: at most 2 m from the centre, above the ground.
    Mount,
    /// [`Start::robot_radius_mm`]: 50 to 2000.
    Radius,
    /// [`Start::max_linear`]: positive.
    MaxLinear,
    /// [`Start::max_angular`]: positive.
    MaxAngular,
    /// [`Start::linear_accel`]: from the greatest speed to rest in 3 s at the most.
    LinearAccel,
    /// [`Start::angular_accel`]: from the greatest turn rate to rest in 3 s at the most.
    AngularAccel,
    /// [`Start::period_ms`]: 100 to 400.
    Period,
    /// [`Terrain::least`] and [`Terrain::most`]: from −2 to 0 and from 0 to 2, because beyond 2 the field diverges.
    Preference,
    /// Another of [`Terrain`]'s: a scale below 0, a height or slope of 0, a slope above 45°, or without a tilted laser.
    Terrain,
}

/// Why a request was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Refusal {
    /// No hello since the device booted.
    NotGreeted,
    /// No session is running.
    NotStarted,
    /// An older sequence number than the last one answered.
    OutOfOrder,
    /// The box's shape does not fit the device's slots.
    BadBox,
    /// A laser or limit out of range.
    BadParameter(Parameter),
    /// That strategy is not in this image.
    UnknownStrategy,
}

/// One map tile.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Tile {
    /// Tile column.
    pub x: i16,
    /// Tile row.
    pub y: i16,
    /// Two bits a cell: 0 unknown, 1 free, 2 obstacle, 3 negative obstacle.
    pub cells: Vec<u8, TILE_BYTES>,
    /// One bit a coarse cell: on the skeleton.
    pub skeleton: Vec<u8, TILE_SKELETON_BYTES>,
    /// One bit for 8 × 8 cells, row by row from the least y, least x in the lowest bit: a loop was closed near here.
    pub marks: u16,
    /// When a place of 16 × 16 cells was last visited, where the strategy keeps account: the later the greater, 0 never.
    pub dates: [u8; TILE_DATES],
}

/// One row of the last window's field.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct FieldRow {
    /// Row, 0 is the least y.
    pub row: u8,
    /// Cell column of the window's first cell, in units of the window's cell.
    pub origin_x: i16,
    /// Cell row of the window's first cell.
    pub origin_y: i16,
    /// Side of a window cell in map cells of 10 cm.
    pub scale: u8,
    /// q = 1 − p, scaled so that a goal is 1; 0 on obstacles.
    pub q: Vec<f32, FIELD_SIDE>,
    /// Two bits a cell, least x in the low bits: 0 free, 1 obstacle, 2 goal.
    pub cells: Vec<u8, FIELD_CELL_BYTES>,
}

/// Where the planner is going. Cells are map cells, the least ones of the planner's own of 20 cm.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Road {
    /// The tractor point: behind the robot, to be reached by the way ahead.
    pub tractor: Option<(i16, i16)>,
    /// The two ends of the shield, a wall across the way back while a loop is being closed.
    pub shield: Option<[(i16, i16); 2]>,
    /// Cells that the planner keeps of the road, the robot's end first.
    pub length: u8,
    /// Of them, those asked for.
    pub cells: Vec<(i16, i16), ROAD_PAGE>,
}

/// Why a frontier was left.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Residue {
    /// No way for this radius.
    Unreachable,
    /// Reached, and still not seen.
    Unobservable,
    /// Beyond the map's box.
    OutOfBounds,
    /// The robot could not get there.
    NoProgress,
}

/// A frontier left over.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Frontier {
    /// A cell of it.
    pub x: i16,
    /// A cell of it.
    pub y: i16,
    /// Cells in it.
    pub cells: u16,
    /// Why it was left.
    pub reason: Residue,
}

/// From the device.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[allow(
    clippy::large_enum_variant,
    reason = "no heap to box into; one lives at a time"
)]
pub enum Reply {
    /// Who it is. Its number and first two fields (version, schema) never change.
    Hello(Identity),
    /// It speaks another protocol and will not talk. Its number and first two fields never change.
    Incompatible {
        /// The device's protocol version.
        version: u16,
        /// Hash of the device's message schema.
        schema: u32,
    },
    /// The session changed state.
    Control(Status),
    /// What to drive.
    Command(Command),
    /// A map tile; `None` where nothing was ever seen.
    Tile(Option<Tile>),
    /// A row of the field; `None` before the first window.
    FieldRow(Option<FieldRow>),
    /// Residual frontiers.
    Frontiers(Vec<Frontier, MAX_FRONTIERS>),
    /// The request was refused.
    Refused(Refusal),
    /// The program crashed; it stands still and reboots.
    Crash(Crash),
    /// Where the planner is going.
    Road(Road),
}

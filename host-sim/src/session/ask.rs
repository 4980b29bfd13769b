//! A request of a session, and its answer.
//!
//! An [`Ask`] is a request of the wire without what belongs to the connection: version, schema and
//! nonce of a hello, sequence numbers. So it outlives a change of the schema. As text it is a line
//! of compact JSON, as in `"pause"` or `{"tile":{"x":0,"y":-1}}`.

use core::fmt;
use core::str::FromStr;

use fieldline_protocol::message::{
    Command, Control, Correct, CorrectedTiles, FieldRow, Observation, Packet, Start, Status,
};
use fixed::types::I16F16;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::compact::{pack, unpack};
use crate::link::{Link, LinkError};

/// A request.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Ask {
    /// Asks who the device is.
    Hello,
    /// Starts a session.
    Start(Box<Start>),
    /// Stands still until resumed.
    Pause,
    /// Continues.
    Resume,
    /// Ends the session.
    Stop,
    /// Reboots the device.
    Reset,
    /// Drives home.
    Home,
    /// Drives to a point.
    GoTo {
        /// Metres.
        x: I16F16,
        /// Metres.
        y: I16F16,
    },
    /// Goes on exploring.
    Explore,
    /// Says where home is.
    SetHome {
        /// Metres.
        x: I16F16,
        /// Metres.
        y: I16F16,
        /// Radians.
        yaw: I16F16,
    },
    /// Reports what the robot sensed.
    Observation(Box<Observation>),
    /// Passes on a packet of another robot.
    Hear(Box<Packet>),
    /// Asks for the next packet for the team.
    Say,
    /// Opens a correction of the map.
    Correct(Box<Correct>),
    /// Brings tiles of a correction.
    CorrectTiles(Box<CorrectedTiles>),
    /// Reads a map tile.
    Tile {
        /// Tile column.
        x: i16,
        /// Tile row.
        y: i16,
    },
    /// Reads a row of the field.
    FieldRow {
        /// Row.
        row: u8,
    },
    /// Reads the residual frontiers.
    Frontiers,
    /// Reads the path.
    Path {
        /// Number of path cells to leave out.
        from: u8,
    },
}

/// An answer. Only what a generator or a judge looks at is kept.
#[derive(Clone, Debug, PartialEq)]
pub enum Answer {
    /// The device did it.
    Done,
    /// The device refused, for this reason.
    Refused(String),
    /// The session has this status.
    Status(Status),
    /// The command.
    Command(Box<Command>),
    /// The row of the field.
    FieldRow(Box<FieldRow>),
    /// What the robot says to its team.
    Said(Box<Packet>),
}

impl Ask {
    /// Makes the request.
    ///
    /// # Errors
    /// As [`LinkError`], without a refusal, which is an answer.
    pub fn of(&self, link: &mut dyn Link) -> Result<Answer, LinkError> {
        match self.of_or_refused(link) {
            Err(LinkError::Refused(why)) => Ok(Answer::Refused(why)),
            answer => answer,
        }
    }

    fn of_or_refused(&self, link: &mut dyn Link) -> Result<Answer, LinkError> {
        let mut control = |control: &Control| link.control(control).map(Answer::Status);
        match self {
            Self::Start(start) => control(&Control::Start((**start).clone())),
            Self::Pause => control(&Control::Pause),
            Self::Resume => control(&Control::Resume),
            Self::Stop => control(&Control::Stop),
            Self::Reset => control(&Control::Reset),
            Self::Home => control(&Control::Home),
            Self::GoTo { x, y } => control(&Control::GoTo { x: *x, y: *y }),
            Self::Explore => control(&Control::Explore),
            &Self::SetHome { x, y, yaw } => control(&Control::SetHome { x, y, yaw }),
            Self::Hello => link.hello().map(|_| Answer::Done),
            Self::Observation(observation) => {
                let command = link.observe(observation)?;
                Ok(Answer::Command(Box::new(command)))
            }
            Self::Hear(packet) => link.hear(packet).map(|()| Answer::Done),
            Self::Say => Ok(link
                .say()?
                .map_or(Answer::Done, |said| Answer::Said(Box::new(said)))),
            Self::Correct(correct) => link.open_correction(correct).map(|_| Answer::Done),
            Self::CorrectTiles(part) => link.send_tiles(part).map(|_| Answer::Done),
            Self::Tile { x, y } => link.tile(*x, *y).map(|_| Answer::Done),
            Self::FieldRow { row } => Ok(link
                .field_row(*row)?
                .map_or(Answer::Done, |row| Answer::FieldRow(Box::new(row)))),
            Self::Frontiers => link.frontiers().map(|_| Answer::Done),
            Self::Path { from } => link.path(*from).map(|_| Answer::Done),
        }
    }
}

impl From<&Control> for Ask {
    fn from(control: &Control) -> Self {
        match control {
            Control::Start(start) => Self::Start(Box::new(start.clone())),
            Control::Pause => Self::Pause,
            Control::Resume => Self::Resume,
            Control::Stop => Self::Stop,
            Control::Reset => Self::Reset,
            Control::Home => Self::Home,
            &Control::GoTo { x, y } => Self::GoTo { x, y },
            Control::Explore => Self::Explore,
            &Control::SetHome { x, y, yaw } => Self::SetHome { x, y, yaw },
        }
    }
}

impl fmt::Display for Ask {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let value = serde_json::to_value(self).map_err(|_| fmt::Error)?;
        pack("", value).fmt(f)
    }
}

impl FromStr for Ask {
    type Err = String;

    /// Reads a line. The error says what is wrong, and the remedy.
    fn from_str(line: &str) -> Result<Self, String> {
        let remedy = "correct the line or leave it out";
        let value: Value = serde_json::from_str(line).map_err(|error| {
            format!("this is no JSON: {error}; write one request a line, as in \"pause\"")
        })?;
        let value = unpack("", value).map_err(|what| format!("{what}; {remedy}"))?;
        serde_json::from_value(value).map_err(|error| format!("{error}; {remedy}"))
    }
}

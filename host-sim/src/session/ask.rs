//! A request of a session, and its answer.
//!
//! An [`Ask`] is a request of the wire without what belongs to the connection: version, schema and
//! nonce of a hello, sequence numbers. So it outlives a change of the schema.

use fieldline_protocol::message::{
    Command, Control, Correct, CorrectedTiles, FieldRow, Observation, Packet, Recall, Start, Status,
};
use fixed::types::I16F16;
use serde::{Deserialize, Serialize};

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
    /// Tells what lies around the robot.
    Recall(Box<Recall>),
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
            Self::Recall(recall) => link.recall(recall).map(|()| Answer::Done),
            Self::Tile { x, y } => link.tile(*x, *y).map(|_| Answer::Done),
            Self::FieldRow { row } => Ok(link
                .field_row(*row)?
                .map_or(Answer::Done, |row| Answer::FieldRow(Box::new(row)))),
            Self::Frontiers => link.frontiers().map(|_| Answer::Done),
            Self::Path { from } => link.path(*from).map(|_| Answer::Done),
        }
    }
}

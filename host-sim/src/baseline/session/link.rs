//! What a baseline answers to the requests of a host.

use fieldline_device::convert;
use fieldline_device::session::{self, Boot};
use fieldline_device::{SLOTS, TILES};
use fieldline_protocol::message::{
    Command, Control, Fault, Finish, MAX_FRONTIERS, Observation, Path, Refusal, Reply, Request,
    ResidualFrontier, Status, TILE_SKELETON_BYTES, TILE_STAMPS, Tile,
};

use super::{Session, Strategy, refused, standing};
use crate::link::{End, Link, LinkError, LinkStats};

impl<S: Strategy> Session<S> {
    /// Changes the session's state.
    fn order(&mut self, control: &Control) -> Result<Status, LinkError> {
        match control {
            Control::Start(start) => self.start(start).map_err(refused)?,
            Control::Reset => {
                self.config = None;
                self.status = Status::Idle;
            }
            _ if self.config.is_none() => return Err(refused(Refusal::NotStarted)),
            Control::Pause => self.paused = true,
            Control::Resume => self.paused = false,
            Control::Stop => self.status = Status::Finished(Finish::Stopped),
            Control::Home | Control::GoTo { .. } | Control::Explore | Control::SetHome { .. } => {
                return Err(refused(Refusal::NotReady));
            }
        }
        Ok(self.status())
    }

    /// Answers an observation.
    fn command(&mut self, observation: &Observation) -> Result<Command, LinkError> {
        let Some(config) = self.config.take() else {
            return Err(refused(Refusal::NotStarted));
        };
        let observation = self.at_once.take(&config, observation).into_owned();
        let command = match convert::input(&observation, config.lasers()) {
            None => standing(Status::Fault(Fault::BadObservation)),
            Some(input) if matches!(self.status(), Status::Exploring | Status::NoScan) => {
                self.step(&config, &input)
            }
            Some(_) => standing(self.status()),
        };
        self.config = Some(config);
        Ok(command)
    }

    /// Returns a tile as a planner shows it: a baseline has no skeleton and no regions.
    fn shown(&self, x: i16, y: i16) -> Option<Tile> {
        let cells = self.map.shown(x.into(), y.into());
        cells.map(|cells| Tile {
            x,
            y,
            cells: cells.into_iter().collect(),
            skeleton: [0; TILE_SKELETON_BYTES].into_iter().collect(),
            closed_regions: 0,
            given_up_regions: 0,
            visit_stamps: [0; TILE_STAMPS],
        })
    }

    /// Returns the goals that were given up.
    fn dropped(&self) -> heapless::Vec<ResidualFrontier, MAX_FRONTIERS> {
        let dropped = self.strategy.dropped();
        let shown = dropped.iter().take(MAX_FRONTIERS);
        shown.map(convert::wire_frontier).collect()
    }
}

impl<S: Strategy> Link for Session<S> {
    /// A baseline has no path, no team and no map that a host may correct.
    fn ask(&mut self, request: &Request) -> Result<Reply, LinkError> {
        self.calls += u64::from(is_counted(request));
        Ok(match request {
            Request::Hello { .. } => Reply::Hello(session::identity(Boot::default(), TILES, SLOTS)),
            Request::Control(control) => Reply::Control(self.order(control)?),
            Request::Observation(observation) => Reply::Command(self.command(observation)?),
            Request::Tile { x, y } => Reply::Tile(self.shown(*x, *y)),
            Request::FieldRow { row } => Reply::FieldRow(self.strategy.field_row(*row)),
            Request::Frontiers => Reply::Frontiers(self.dropped()),
            Request::Path { .. } => Reply::Path(Path::default()),
            Request::Hear(_) | Request::Say => return Err(refused(Refusal::NoTeam)),
            Request::Correct(_) | Request::Tiles(_) | Request::Recall(_) => {
                return Err(LinkError::Refused("a baseline corrects no map".into()));
            }
        })
    }

    fn end(&self) -> &dyn End {
        self
    }
}

/// Returns true for a request that a baseline does something about.
const fn is_counted(request: &Request) -> bool {
    matches!(
        request,
        Request::Control(_)
            | Request::Observation(_)
            | Request::Tile { .. }
            | Request::FieldRow { .. }
            | Request::Frontiers
    )
}

impl<S: Strategy> End for Session<S> {
    /// Counts every call as one frame sent and one received.
    fn stats(&self) -> LinkStats {
        LinkStats {
            sent: self.calls,
            received: self.calls,
            ..LinkStats::default()
        }
    }
}

//! A link whose requests and answers go into a recording.
//!
//! Reading map, field, path and frontiers changes nothing in a device, so it is not recorded.

use core::cell::RefCell;
use std::rc::Rc;

use fieldline_protocol::message::{
    Command, Control, Correct, CorrectedTiles, CorrectionProgress, FieldRow, Identity, Observation,
    Packet, Path, ResidualFrontier, Status, Tile,
};

use super::Recording;
use super::exchange::Told;
use crate::link::inside::Inside;
use crate::link::{Link, LinkError, LinkStats};
use crate::session::ask::Ask;

/// A link that is recorded.
#[expect(missing_debug_implementations, reason = "a borrowed trait object")]
pub struct Tap<'l> {
    link: &'l mut dyn Link,
    recording: Rc<RefCell<Recording>>,
}

impl<'l> Tap<'l> {
    /// Records what goes over a link.
    pub fn new(link: &'l mut dyn Link, recording: Rc<RefCell<Recording>>) -> Self {
        Self { link, recording }
    }

    fn exchange<T>(
        &mut self,
        ask: &Ask,
        of: impl FnOnce(&mut dyn Link) -> Result<T, LinkError>,
        told: impl FnOnce(&T) -> Told,
    ) -> Result<T, LinkError> {
        let answer = of(self.link);
        let told = match &answer {
            Ok(answer) => told(answer),
            Err(LinkError::Refused(why)) => Told::Refused(why.clone()),
            Err(error) => Told::Failed(error.to_string()),
        };
        self.recording.borrow_mut().exchange(ask, &told);
        answer
    }
}

impl Link for Tap<'_> {
    fn hello(&mut self) -> Result<Identity, LinkError> {
        self.link.hello()
    }

    fn control(&mut self, control: &Control) -> Result<Status, LinkError> {
        let ask = Ask::from(control);
        self.exchange(
            &ask,
            |link| link.control(control),
            |status| Told::Status(*status),
        )
    }

    fn observe(&mut self, observation: &Observation) -> Result<Command, LinkError> {
        self.recording.borrow_mut().set_time(observation.time_ms);
        let ask = Ask::Observation(Box::new(observation.clone()));
        self.exchange(
            &ask,
            |link| link.observe(observation),
            |command| Told::Command(Box::new(*command)),
        )
    }

    fn tile(&mut self, x: i16, y: i16) -> Result<Option<Tile>, LinkError> {
        self.link.tile(x, y)
    }

    fn field_row(&mut self, row: u8) -> Result<Option<FieldRow>, LinkError> {
        self.link.field_row(row)
    }

    fn frontiers(&mut self) -> Result<Vec<ResidualFrontier>, LinkError> {
        self.link.frontiers()
    }

    fn path(&mut self, from: u8) -> Result<Path, LinkError> {
        self.link.path(from)
    }

    fn hear(&mut self, packet: &Packet) -> Result<(), LinkError> {
        let ask = Ask::Hear(Box::new(packet.clone()));
        self.exchange(&ask, |link| link.hear(packet), |()| Told::Done)
    }

    fn say(&mut self) -> Result<Option<Packet>, LinkError> {
        self.exchange(&Ask::Say, |link| link.say(), |_| Told::Done)
    }

    fn open_correction(&mut self, correct: &Correct) -> Result<CorrectionProgress, LinkError> {
        let ask = Ask::Correct(Box::new(correct.clone()));
        self.exchange(&ask, |link| link.open_correction(correct), |_| Told::Done)
    }

    fn send_tiles(&mut self, part: &CorrectedTiles) -> Result<CorrectionProgress, LinkError> {
        let ask = Ask::CorrectTiles(Box::new(part.clone()));
        self.exchange(&ask, |link| link.send_tiles(part), |_| Told::Done)
    }

    fn inside(&self) -> Option<Box<dyn Inside + '_>> {
        self.link.inside()
    }

    fn stats(&self) -> LinkStats {
        self.link.stats()
    }

    fn take_log(&mut self) -> Vec<u8> {
        self.link.take_log()
    }
}

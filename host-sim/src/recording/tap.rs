//! A link whose requests and replies go into a recording.

use core::cell::RefCell;
use std::rc::Rc;

use fieldline_protocol::message::{Reply, Request};

use super::Recording;
use super::exchange::Told;
use crate::link::{End, Link, LinkError};

/// A link that is recorded.
#[expect(missing_debug_implementations, reason = "a boxed trait object")]
pub struct Tap {
    link: Box<dyn Link>,
    recording: Rc<RefCell<Recording>>,
}

impl Tap {
    /// Records what goes over a link.
    #[must_use]
    pub fn new(link: Box<dyn Link>, recording: Rc<RefCell<Recording>>) -> Self {
        Self { link, recording }
    }
}

/// Returns true if a request changes a device. The others read map, field, path and frontiers.
const fn changes(request: &Request) -> bool {
    match request {
        Request::Control(_)
        | Request::Observation(_)
        | Request::Hear(_)
        | Request::Say
        | Request::Correct(_)
        | Request::Tiles(_)
        | Request::Recall(_) => true,
        Request::Hello { .. }
        | Request::Tile { .. }
        | Request::FieldRow { .. }
        | Request::Frontiers
        | Request::Path { .. } => false,
    }
}

impl Link for Tap {
    fn ask(&mut self, request: &Request) -> Result<Reply, LinkError> {
        let answer = self.link.ask(request);
        if changes(request) {
            let told = match &answer {
                Ok(reply) => Told::Reply(Box::new(reply.clone())),
                Err(LinkError::Refused(why)) => Told::Refused(why.clone()),
                Err(error) => Told::Failed(error.to_string()),
            };
            self.recording.borrow_mut().exchange(request, &told);
        }
        answer
    }

    fn end(&self) -> &dyn End {
        self.link.end()
    }
}
